"""Margins of points that nothing but friction limits, by the kernel's compiled program."""

from __future__ import annotations

from collections.abc import Sequence
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


def row_count(points: Array, cone: ConeChoice) -> int:
    """Number of rows of the compiled program of a set of points: one a point, or one an edge of the pyramids."""
    slipping = int((points[:, 12] > 0.0).sum())
    return len(points) if cone.sides is None else len(points) + slipping * (cone.sides - 1)


def compiled_margin(stance: Stance, data: StaticsData, cone: ConeChoice) -> Margin | None:
    """The margin of one stance with what stands behind it.

    Args:
        stance: A stance.
        data: Its arrays.
        cone: Exact cones or pyramids.

    Returns:
        The margin; None where the kernel's compiled program does not apply, or its answer does not check.
    """
    return compiled_margins([stance], [data], cone)[0]


def compiled_margins(stances: Sequence[Stance], data: Sequence[StaticsData], cone: ConeChoice) -> list[Margin | None]:
    """The margins of many stances, by one call of the compiled program.

    Args:
        stances: The stances.
        data: Their arrays.
        cone: Exact cones or pyramids.

    Returns:
        For each what `compiled_margin` says of it.
    """
    margins: list[Margin | None] = [None] * len(stances)
    mine = [i for i, s in enumerate(stances) if s.contacts.friction_points is not None and s.torque_limits is None]
    if not mine:
        return margins
    loads = np.array([[*loads_row(stances[i]), *stances[i].com] for i in mine])
    sets = [stances[i].contacts for i in mine]
    found = compiled_reserves(sets, cone, np.arange(len(mine) + 1), loads)
    at = 0
    for k, (i, contacts) in enumerate(zip(mine, sets, strict=True)):
        points = contacts.friction_points
        assert points is not None
        rows = row_count(points, cone)
        if found.settled[k]:
            margins[i] = _margin(data[i], points, cone, float(found.margin[k]), found.motion[k], found.forces[at : at + rows])
        at += rows
    return margins


def _margin(data: StaticsData, points: Array, cone: ConeChoice, value: float, twist: Array, forces: Array) -> Margin | None:
    """A settled margin, if what stands behind it checks."""
    from socp_statics.engines.kernel.pyramids import unknowns

    motion = Motion(twist, np.zeros(len(data.torques.names)))
    x = unknowns(points, cone, forces[None])[0]
    optimum = margin_optimum(data, cone, x, value, Multipliers.read(data, motion.twist, {})) if np.isfinite(value) else None
    if value <= -BOUNDARY:
        certificate = motion_certificate(data, cone, motion)
        return None if certificate is None else Margin(value, None, None, certificate, motion, 0.0, "kernel", 0, optimum)
    if value < BOUNDARY:
        return None
    if value == np.inf:
        x = balanced(data, cone, x)
    held = force_residuals(data, cone, x)
    return Margin(value, x, held, None, None, 0.0, "kernel", 0, optimum) if max(held) <= FORCE_TOLERANCE else None
