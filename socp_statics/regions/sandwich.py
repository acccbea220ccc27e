"""A convex region of the plane between what is attained and what is ruled out, refined by support queries.

Directions d with an attained point c and a bound h (d . x <= h on the region) are kept in angular order. Between neighbours
lies an uncertain triangle: the two points and the crossing of the two lines. The next query is the normal of the edge with the
largest triangle (Bretl and Lall 2008); areas are kept up to date.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from socp_statics.exceptions import EngineError
from socp_statics.spatial import Array

PARALLEL = 1e-9
ROUNDING = 1e-10
START = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))
MOST_QUERIES = 5000


class Support(NamedTuple):
    """One query: unit direction, attained point, bound of d . x, and whatever the oracle keeps of it."""

    d: tuple[float, float]
    c: tuple[float, float]
    h: float
    kept: Any


Oracle = Callable[[tuple[float, float]], Support]


class _Node:
    """A support in the ring, with its neighbour to the left (counter-clockwise)."""

    __slots__ = ("support", "next", "area", "p", "alive")

    def __init__(self, support: Support):
        self.support = support
        self.next: _Node = self
        self.area = 0.0
        self.p = support.c
        self.alive = 0


class Sandwich:
    """The region between its inner and outer polygon.

    Args:
        oracle: Answers support queries.
        start: Initial supports, counter-clockwise, successive directions less than a half turn apart.
    """

    def __init__(self, oracle: Oracle, start: list[Support]):
        self._oracle = oracle
        nodes = [_Node(s) for s in start]
        for node, following in zip(nodes, nodes[1:] + nodes[:1], strict=True):
            node.next = following
        self._first = nodes[0]
        self.queries = 0
        self._heap: list[tuple[float, int, int, _Node]] = []
        self._count = 0
        self._uncertain = 0.0
        self._inner = 0.0
        for node in nodes:
            self._measure(node)
        points = [node.support.c for node in nodes]
        self._inner = 0.5 * sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(points, points[1:] + points[:1], strict=True))

    def _measure(self, node: _Node) -> None:
        """Crossing of the lines of a node and its neighbour, and the triangle it leaves uncertain."""
        c, b = node.support.c, node.next.support.c
        node.p = _crossing(node.support, node.next.support) or (0.5 * (c[0] + b[0]), 0.5 * (c[1] + b[1]))
        px, py = node.p[0] - c[0], node.p[1] - c[1]
        self._uncertain -= node.area
        node.area = max(0.0, 0.5 * (px * (b[1] - c[1]) - py * (b[0] - c[0])))
        self._uncertain += node.area
        node.alive = self._count = self._count + 1
        heapq.heappush(self._heap, (-node.area, node.alive, node.alive, node))

    @property
    def inner_area(self) -> float:
        """Area of the polygon of attained points."""
        return max(self._inner, 0.0)

    @property
    def gap(self) -> float:
        """(outer area - inner area) / outer area."""
        outer = self.inner_area + self._uncertain
        return self._uncertain / outer if outer > 0.0 else 0.0

    def supports(self) -> list[Support]:
        """All supports, counter-clockwise."""
        return [node.support for node in self._ring()]

    def crossings(self) -> list[tuple[float, float]]:
        """Crossing of each support's line with that of the next, in the order of `supports`."""
        return [node.p for node in self._ring()]

    def _ring(self) -> list[_Node]:
        nodes, node = [], self._first
        while True:
            nodes.append(node)
            node = node.next
            if node is self._first:
                return nodes

    def query(self, direction: tuple[float, float]) -> Support:
        """Ask the oracle and insert the answer at its angle."""
        if self.queries >= MOST_QUERIES:
            raise EngineError(f"the region was not enclosed within {MOST_QUERIES} directions, gap {self.gap:.1e}")
        self.queries += 1
        support = self._oracle(direction)
        node = self._first
        while not _between(node.support.d, support.d, node.next.support.d):
            node = node.next
            if node is self._first:
                raise EngineError(f"direction {support.d} has no place among the supports")
        self._insert(node, support)
        return support

    def _insert(self, node: _Node, support: Support) -> None:
        a, b, c = node.support.c, node.next.support.c, support.c
        self._inner += 0.5 * ((c[0] - a[0]) * (b[1] - a[1]) - (c[1] - a[1]) * (b[0] - a[0]))
        new = _Node(support)
        new.next, node.next = node.next, new
        self._measure(node)
        self._measure(new)

    def refine(self, tolerance: float, thin: Callable[[Sandwich], bool]) -> bool:
        """Query until the relative gap is below the tolerance.

        Args:
            tolerance: Of (outer - inner) / outer area.
            thin: Asked now and then while the inner area is tiny; True stops the refinement.

        Returns:
            False if the region turned out to be thin.
        """
        while self.gap > tolerance:
            while self._heap and self._heap[0][3].alive != self._heap[0][2]:
                heapq.heappop(self._heap)
            node = self._heap[0][3]
            a, b = node.support, node.next.support
            ex, ey = b.c[0] - a.c[0], b.c[1] - a.c[1]
            length = float(np.hypot(ex, ey))
            if self.inner_area < 1e-7 and thin(self):
                return False
            if length == 0.0:
                raise EngineError(f"the region was not enclosed, gap {self.gap:.1e} at a vertex")
            direction = (ey / length, -ex / length)
            if not _between(a.d, direction, b.d) or _parallel(a.d, direction) or _parallel(direction, b.d):
                raise EngineError(f"the region was not enclosed to {tolerance:g}, the gap stays at {self.gap:.1e}")
            if self.queries >= MOST_QUERIES:
                raise EngineError(f"the region was not enclosed within {MOST_QUERIES} directions, gap {self.gap:.1e}")
            self.queries += 1
            self._insert(node, self._oracle(direction))
        return True

    def outer_polygon(self) -> tuple[list[int], Array]:
        """The polygon of the supporting lines, without lines that cut off nothing.

        Every line is first moved out to the attained points it should hold, which rounding may have left outside by 1e-16; leaving
        out a line never cuts into the region.

        Returns:
            Indices of the supports whose lines are edges, and the corners, shape (l, 2); edge k, on the line of support k, runs
            from corner k to corner k + 1.
        """
        supports = self.supports()
        points = np.array([s.c for s in supports])
        lines = [s._replace(h=max(s.h, float((points @ np.array(s.d)).max()))) for s in supports]
        # In units of the region: a sliver's sides are told apart more finely.
        rounding = ROUNDING * min(1.0, self.inner_area)
        used = list(range(len(lines)))
        at, settled = 0, 0
        while settled < len(used) and len(used) > 3:
            before, here, after = (used[(at + k) % len(used)] for k in (-1, 0, 1))
            if _cuts_nothing(lines[before], lines[here], lines[after], rounding):
                del used[at % len(used)]
                at, settled = at - 1, 0
            else:
                at, settled = at + 1, settled + 1
        corners = [_crossing(lines[j], lines[k]) for j, k in zip(used[-1:] + used[:-1], used, strict=True)]
        if None in corners:
            raise EngineError("the supporting lines do not enclose the region", name="region")
        return used, np.array(corners)

    def polygon(self) -> Array:
        """The crossings as an array: the outer polygon with repeated vertices, shape (n, 2)."""
        return np.array(self.crossings())


def _crossing(a: Support, b: Support) -> tuple[float, float] | None:
    """Where the lines of two supports cross, None where they are parallel."""
    cross = a.d[0] * b.d[1] - a.d[1] * b.d[0]
    if cross <= PARALLEL:
        return None
    # Along the first line: where the two are nearly parallel, rounding moves their crossing along both and off neither.
    along = (b.h - a.h * (a.d[0] * b.d[0] + a.d[1] * b.d[1])) / cross
    return a.h * a.d[0] - along * a.d[1], a.h * a.d[1] + along * a.d[0]


def _cuts_nothing(before: Support, here: Support, after: Support, rounding: float) -> bool:
    """Whether a line leaves the corner of its neighbours as it is (or moves it by less than rounding)."""
    if _parallel(before.d, here.d):
        return here.h >= before.h
    if _parallel(here.d, after.d):
        return here.h > after.h
    corner = _crossing(before, after)
    return corner is not None and here.d[0] * corner[0] + here.d[1] * corner[1] <= here.h + rounding


def _between(a: tuple[float, float], d: tuple[float, float], b: tuple[float, float]) -> bool:
    """Whether d lies in the counter-clockwise sector from a to b (less than a half turn)."""
    return a[0] * d[1] - a[1] * d[0] >= 0.0 and d[0] * b[1] - d[1] * b[0] >= 0.0 and a[0] * d[0] + a[1] * d[1] > -1.0 + 1e-15


def _parallel(a: tuple[float, float], b: tuple[float, float]) -> bool:
    return abs(a[0] * b[1] - a[1] * b[0]) < PARALLEL and a[0] * b[0] + a[1] * b[1] > 0.0
