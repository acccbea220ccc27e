"""Margins of points that nothing but friction limits, by the kernel's compiled program."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from socp_statics.certificates import Motion, force_residuals, motion_certificate
from socp_statics.certificates.optimum import Multipliers
from socp_statics.cones.choice import ConeChoice
from socp_statics.contacts import ContactSet, Stance
from socp_statics.spatial import Array
from socp_statics.stability.margin import FORCE_TOLERANCE, Margin, balanced
from socp_statics.stability.prices import margin_optimum
from socp_statics.statics.statics_data import StaticsData
from socp_statics.statics.units import BOUNDARY, loads_row


class Reserves(NamedTuple):
    """Margins of many loads.

    Attributes:
        settled: Whether the kernel settled each load, shape (b,).
        margin: In units of W, shape (b,); inf where forces can grow without end.
        motion: Scaled motion of the multipliers, shape (b, 6).
        forces: Components of the forces of each set's rows, scaled, shape (rows, 3), one load after the other.
    """

    settled: NDArray[np.bool_]
    margin: Array
    motion: Array
    forces: Array


def compiled_reserves(sets: list[ContactSet], cone: ConeChoice, items: NDArray[np.int_], loads: Array) -> Reserves:
    """Margins of many loads on many contact sets.

    Args:
        sets: Contact sets with ``friction_points``.
        cone: Exact cones or pyramids.
        items: Where the loads of each set start, and the end, shape (s + 1,).
        loads: Shape (b, 13): see `engines.kernel.reserves`.
    """
    from socp_statics.engines.kernel.pyramids import cone_rows
    from socp_statics.engines.kernel.reserves import OPEN, reserves

    rows = [cone_rows(s.friction_points, cone) for s in sets]  # type: ignore[arg-type]
    points = rows[0] if len(rows) == 1 else np.concatenate(rows)
    kinds, margin, motion, forces = reserves(points, np.cumsum([0, *map(len, rows)]), items, np.ascontiguousarray(loads))
    return Reserves(kinds != OPEN, margin, motion, forces)


def compiled_margin(stance: Stance, data: StaticsData, cone: ConeChoice) -> Margin | None:
    """The margin of one stance with what stands behind it.

    Args:
        stance: A stance.
        data: Its arrays.
        cone: Exact cones or pyramids.

    Returns:
        The margin; None where the kernel's compiled program does not apply, or its answer does not check.
    """
    from socp_statics.engines.kernel.pyramids import unknowns

    points = stance.contacts.friction_points
    if points is None or stance.torque_limits is not None:
        return None
    load = np.array([*loads_row(stance), *stance.com])
    found = compiled_reserves([stance.contacts], cone, np.array([0, 1]), load[None])
    value = float(found.margin[0])
    if not found.settled[0]:
        return None
    motion = Motion(found.motion[0], np.zeros(len(data.torques.names)))
    x = unknowns(points, cone, found.forces[None])[0]
    optimum = margin_optimum(data, cone, x, value, Multipliers.read(data, motion.twist, {})) if np.isfinite(value) else None
    if value <= -BOUNDARY:
        certificate = motion_certificate(data, cone, motion)
        return None if certificate is None else Margin(value, None, None, certificate, motion, 0.0, "kernel", 0, optimum)
    if value < BOUNDARY:
        return None
    if value == np.inf:
        x = balanced(data, x)
    held = force_residuals(data, cone, x)
    return Margin(value, x, held, None, None, 0.0, "kernel", 0, optimum) if max(held) <= FORCE_TOLERANCE else None
