"""The feasible set of two internal forces: a convex set of the plane, traced by support programs between an inner and an outer polygon."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from socp_statics.engines.solution import INFEASIBLE, SOLVED, UNBOUNDED
from socp_statics.exceptions import EngineError
from socp_statics.regions.sandwich import START, Sandwich, Support
from socp_statics.spatial import Array

NARROW = 1e-9
# Supports reach this far inside the clip where nothing but the clip stopped them.
CLIPPED = 1e-6

# (direction, clip or None) -> status, attained point and height; scaled.
Farthest = Callable[[Array, float | None], tuple[str, Array | None, float]]


class WindowSet(NamedTuple):
    """A feasible set.

    Attributes:
        kind: "polygon", "segment", "point", "empty" or "unbounded"; unbounded ones are cut off at 10 W.
        inner: Attained points, counter-clockwise, shape (k, 2), in units of the two directions (newtons for members).
        outer: Corners of the supporting lines, shape (l, 2); the inner points of a segment, a point or an empty set.
        inner_area: Area of the inner polygon.
        relative_gap: (outer area - inner area) / outer area.
        solves: Number of programs.
    """

    kind: str
    inner: Array
    outer: Array
    inner_area: float
    relative_gap: float
    solves: int

    def in_newtons(self, W: float) -> WindowSet:
        """The set of scaled forces in newtons."""
        return self._replace(inner=W * self.inner, outer=W * self.outer, inner_area=W * W * self.inner_area)


def empty_set(solves: int) -> WindowSet:
    """The set of no forces.

    Args:
        solves: How many programs said so.
    """
    return WindowSet("empty", np.zeros((0, 2)), np.zeros((0, 2)), 0.0, 0.0, solves)


def flat_set(farthest: Farthest, clip: float) -> WindowSet | None:
    """The set where it is empty, a point or a segment; None where it has an area.

    Args:
        farthest: The support programs.
        clip: Half side of the square that cuts off a set without end.

    Raises:
        EngineError: A program of a set that is not empty has no answer.
    """
    points: list[Array] = []
    for start in START:
        status, point, _ = farthest(np.array(start), clip)
        if status == INFEASIBLE:
            return empty_set(len(points) + 1)
        points.append(_attained(status, point))
    spread = np.array(points)
    i, j = max(((i, j) for i in range(4) for j in range(i)), key=lambda pair: float(np.linalg.norm(spread[pair[0]] - spread[pair[1]])))
    along = spread[i] - spread[j]
    length = float(np.linalg.norm(along))
    if length <= NARROW:
        return WindowSet("point", spread[:1], spread[:1], 0.0, 0.0, 4)
    across = np.array([-along[1], along[0]]) / length
    heights = []
    for sign in (1.0, -1.0):
        status, point, _ = farthest(sign * across, clip)
        heights.append(float(across @ _attained(status, point)))
    if heights[0] - heights[1] > NARROW * max(1.0, length):
        return None
    ends = []
    for sign in (1.0, -1.0):
        status, point, _ = farthest(sign * along / length, clip)
        ends.append(_attained(status, point))
    segment = np.array(ends)
    reaches = bool(np.abs(segment).max() > clip * (1 - CLIPPED))
    return WindowSet("unbounded" if reaches else "segment", segment, segment, 0.0, 0.0, 8)


def traced_set(farthest: Farthest, clip: float, tolerance: float) -> WindowSet:
    """The set where it has an area.

    Args:
        farthest: The support programs.
        clip: Half side of the square that cuts off a set without end.
        tolerance: Of the relative gap.

    Raises:
        EngineError: The set was not enclosed.
    """
    unbounded = any(farthest(np.array(start), None)[0] == UNBOUNDED for start in START)

    def oracle(direction: tuple[float, float]) -> Support:
        status, point, height = farthest(np.array(direction), clip if unbounded else None)
        c = _attained(status, point)
        return Support(direction, (float(c[0]), float(c[1])), height, None)

    sandwich = Sandwich(oracle, [oracle(start) for start in START])
    sandwich.refine(tolerance, lambda _: False)
    inner = np.array([s.c for s in sandwich.supports()])
    keep = np.linalg.norm(inner - np.roll(inner, 1, axis=0), axis=1) > NARROW
    _, outer = sandwich.outer_polygon()
    kind = "unbounded" if unbounded else "polygon"
    return WindowSet(kind, inner[keep], outer, sandwich.inner_area, sandwich.gap, sandwich.queries + 4)


def _attained(status: str, point: Array | None) -> Array:
    if status != SOLVED or point is None:
        raise EngineError(f"the internal-force window was not enclosed: a support program is {status}", name="internal_force_window")
    return point
