"""Minimax forces of points that nothing but friction limits, by the kernel's compiled program."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from socp_statics.cones.choice import ConeChoice
from socp_statics.contacts import ContactSet, Stance
from socp_statics.spatial import Array
from socp_statics.statics import StaticsData
from socp_statics.statics.units import loads_row

# What normal force and friction of a point count.
COUNTS = {"force": (1.0, 1.0), "normal": (1.0, 0.0), "tangential": (0.0, 1.0)}


class LargestForces(NamedTuple):
    """Minimax forces of many loads.

    Attributes:
        settled: Whether the kernel settled each load, shape (b,).
        value: Largest measure of the forces, the least possible one, in units of W, shape (b,).
        gap: Complementarity gap over the ceiling and 1 / points, shape (b,).
        multipliers: Of the scaled balance, shape (b, 6).
        forces: Components of the forces of each set's points, scaled, shape (rows, 3), one load after the other.
    """

    settled: NDArray[np.bool_]
    value: Array
    gap: Array
    multipliers: Array
    forces: Array


def compiled_largest_forces(sets: list[ContactSet], items: NDArray[np.int_], loads: Array, measure: str = "force") -> LargestForces:
    """Forces whose largest measure is least, of many loads on many contact sets.

    Args:
        sets: Contact sets with ``friction_points``.
        items: Where the loads of each set start, and the end, shape (s + 1,).
        loads: Shape (b, 13): see `engines.kernel.reserves`.
        measure: "force", "normal" or "tangential", of each point.
    """
    from socp_statics.engines.kernel.largest_forces import largest_forces

    rows = [s.friction_points for s in sets]
    points = np.concatenate(rows) if len(rows) > 1 else rows[0]  # type: ignore[arg-type]
    starts = np.cumsum([0, *(len(r) for r in rows)])  # type: ignore[arg-type]
    return LargestForces(*largest_forces(points, starts, items, np.ascontiguousarray(loads), *COUNTS[measure]))


class Minimax(NamedTuple):
    """Minimax forces of one stance.

    Attributes:
        x: Scaled unknowns.
        value: Largest measure, in units of W.
        gap: Difference to the dual objective over 1 + value.
    """

    x: Array
    value: float
    gap: float


def compiled_minimax(stance: Stance, data: StaticsData, measure: str) -> Minimax | None:
    """The minimax forces of one stance.

    Args:
        stance: A stance.
        data: Its arrays.
        measure: "force", "normal" or "tangential", of each point.

    Returns:
        The forces; None where the compiled program does not apply or settle.
    """
    from socp_statics.engines.kernel.pyramids import unknowns

    points = stance.contacts.friction_points
    if points is None or stance.torque_limits is not None:
        return None
    load = np.array([*loads_row(stance), *stance.com])
    found = compiled_largest_forces([stance.contacts], np.array([0, 1]), load[None], measure)
    if not found.settled[0]:
        return None
    value = float(found.value[0])
    gap = abs(value - float(data.load @ found.multipliers[0])) / (1.0 + value)
    return Minimax(unknowns(points, ConeChoice(), found.forces[None])[0], value, gap)
