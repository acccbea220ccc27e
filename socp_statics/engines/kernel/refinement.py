"""Refining a region between what is attained and what is ruled out, in compiled code: which direction to ask next, and what it changes.

The next direction is the normal of the edge with the largest uncertain triangle (Bretl and Lall 2008); at last that of the edge nearest to
the centre of mass. Whoever traces asks `next_direction`, answers it with a support of its own making, and tells `insert`.
"""

from __future__ import annotations

import math

import numpy as np

from socp_statics.engines.kernel.com_distance import MOST_REFINEMENTS, OUTSIDE, nearest_edge, thin_enough
from socp_statics.engines.kernel.compilation import inner
from socp_statics.engines.kernel.ring import (
    ROUNDING,
    between,
    inner_corners,
    measure,
    outer_polygon,
    parallel,
    ring_order,
    triangle,
    width,
)
from socp_statics.engines.kernel.supports import AREA, CX, CY, DX, DY

# What a tracing says of its region; ASK: another direction is wanted.
POLYGON, EMPTY, ENDLESS, RANK, THIN, MANY, BROKEN, ASK = range(8)
# Below this area a region may be a sliver; below this width it is none of a compiled tracer's business.
SLIVER = 1e-7
# Attained points nearer than this to the chord of their neighbours are no corners: the accuracy of the methods.
CORNER = 1e-9

# State of a refinement: inner and uncertain area; how often the CoM margin was refined, whether it is known; margin, and nearest edge.
INNER, UNCERTAIN, REFINED, FOUND, MARGIN, EDGE = range(6)
FRONT = 6
# Rows of indices: ring, its order, corners, edges.
AFTER, ORDER, KEEP, USED = range(4)


def most_directions(tolerance: float) -> int:
    """How many directions a region may take: a few times what a disc needs, pi over the root of the tolerance."""
    return 64 + int(12.0 / math.sqrt(tolerance))


@inner
def begin_front(front):
    """Nothing is known; returns the number of supports so far."""
    front[:] = 0.0
    front[MARGIN], front[EDGE] = math.inf, OUTSIDE
    # A literal has a type of its own, for which everything that takes it would be compiled once more.
    return np.int64(0)


@inner(inline="always")
def widest_edge(nodes, after, order, count, inner_area):
    """The edge with the largest uncertain triangle.

    Returns:
        ASK, or why there is no direction to ask; the support before the edge; and the edge's normal.
    """
    i = 0
    for k in range(1, count):
        if nodes[k, AREA] > nodes[i, AREA]:
            i = k
    j = after[i]
    ex, ey = nodes[j, CX] - nodes[i, CX], nodes[j, CY] - nodes[i, CY]
    length = math.sqrt(ex * ex + ey * ey)
    if inner_area < SLIVER and width(nodes, order, ring_order(after, order)) < SLIVER:
        return THIN, i, 0.0, 0.0
    if length == 0.0:
        return BROKEN, i, 0.0, 0.0
    dx, dy = ey / length, -ex / length
    if not between(nodes, i, dx, dy, j) or parallel(nodes, i, dx, dy) or parallel(nodes, j, dx, dy):
        return BROKEN, i, 0.0, 0.0
    return ASK, i, dx, dy


@inner
def sector(nodes, after, dx, dy):
    """The support before a direction."""
    # Rounding may put a direction that repeats another outside of both its sectors: the one it misses least is meant.
    i, best, chosen = 0, -math.inf, 0
    while True:
        j = after[i]
        ahead = nodes[i, DX] * dx + nodes[i, DY] * dy + nodes[j, DX] * dx + nodes[j, DY] * dy > 0.0
        inside = min(nodes[i, DX] * dy - nodes[i, DY] * dx, dx * nodes[j, DY] - dy * nodes[j, DX])
        if ahead and inside > best:
            best, chosen = inside, i
        i = j
        if i == 0:
            return chosen


@inner
def aimed(area):
    """The uncertain area to reach, for at most ``area`` after the points that are no corners were left out."""
    return area - min(4.0 * CORNER, 0.5 * area)


@inner(inline="always")
def next_direction(front, nodes, ints, count, tolerance, x, y):
    """The direction to ask next: the four axes first.

    Args:
        front: State of the refinement, shape (FRONT,).
        nodes: Supports so far.
        ints: Rows of indices.
        count: How many supports there are.
        tolerance: Of (outer area - inner area) / outer area.
        x: First coordinate of the centre of mass, scaled; nan where no margin is asked for.
        y: Second coordinate.

    Returns:
        ASK, POLYGON when nothing more is to be asked, or why the region is not for this tracer; the support before the direction; and
        the unit direction.
    """
    after, order = ints[AFTER], ints[ORDER]
    if count < 4:
        return ASK, count - 1, (1.0 - count) * (1 - count % 2), (2.0 - count) * (count % 2)
    kind, i, dx, dy = POLYGON, 0, 0.0, 0.0
    if front[REFINED] == 0.0 and front[UNCERTAIN] > aimed(tolerance * (max(front[INNER], 0.0) + front[UNCERTAIN])):
        kind, i, dx, dy = widest_edge(nodes, after, order, count, front[INNER])
    elif x == x and front[FOUND] == 0.0 and front[REFINED] < MOST_REFINEMENTS:
        ring = ring_order(after, order)
        corners = inner_corners(nodes, order, ring, CORNER, ints[KEEP])
        found, front[MARGIN], edge, dx, dy = nearest_edge(nodes, order, ring, ints[KEEP], corners, x, y)
        front[REFINED] += 1.0
        front[EDGE], front[FOUND] = edge, 1.0 if found else 0.0
        if not found:
            kind, i = ASK, sector(nodes, after, dx, dy)
    if kind == ASK and count >= nodes.shape[0]:
        kind = MANY
    return kind, i, dx, dy


@inner(inline="always")
def insert(front, nodes, ints, count, i):
    """Take in the support that was written behind the others.

    Args:
        front: State of the refinement.
        nodes: Supports, the new one at ``count``.
        ints: Rows of indices.
        count: How many there were.
        i: The support before the new one.
    """
    after = ints[AFTER]
    if count < 3:
        after[count] = count + 1
    elif count == 3:
        after[3] = 0
        front[INNER] = triangle(nodes, 0, 1, 2) + triangle(nodes, 0, 2, 3)
        for k in range(4):
            measure(nodes, after, k)
            front[UNCERTAIN] += nodes[k, AREA]
    else:
        front[UNCERTAIN] -= nodes[i, AREA]
        front[INNER] += triangle(nodes, i, count, after[i])
        after[count], after[i] = after[i], count
        measure(nodes, after, i)
        measure(nodes, after, count)
        front[UNCERTAIN] += nodes[i, AREA] + nodes[count, AREA]
        if front[REFINED] > 0.0 and front[EDGE] != OUTSIDE:
            front[FOUND] = 1.0 if thin_enough(nodes, int(front[EDGE]), count, front[MARGIN]) else 0.0


@inner
def area_of(nodes, order, count, x, y):
    """Area of a polygon of some rows and two columns of an array."""
    total = 0.0
    for k in range(count):
        i, j = order[k], order[(k + 1) % count]
        total += 0.5 * (nodes[i, x] * nodes[j, y] - nodes[i, y] * nodes[j, x])
    return total


@inner
def polygons(nodes, ints, inner_area, corners):
    """The polygons of an enclosed region.

    Args:
        nodes: Supports.
        ints: Rows of indices; KEEP gets the supports that are inner corners, USED those whose lines are outer edges.
        inner_area: Area of the attained polygon.
        corners: Written: outer corners, scaled; edge k runs from corner k to corner k + 1.

    Returns:
        POLYGON or BROKEN, number of inner corners and of outer edges, (outer area - inner area) / outer area, inner and outer area.
    """
    ring = ring_order(ints[AFTER], ints[ORDER])
    k = inner_corners(nodes, ints[ORDER], ring, CORNER, ints[KEEP])
    m = outer_polygon(nodes, ints[ORDER], ring, ROUNDING * min(1.0, inner_area), ints[USED], corners)
    if m == 0 or k < 3:
        return BROKEN, 0, 0, 1.0, 0.0, 0.0
    for e in range(m):
        ints[ORDER, e] = e
    outer, area = area_of(corners, ints[ORDER], m, 0, 1), area_of(nodes, ints[KEEP], k, CX, CY)
    return POLYGON, k, m, max(0.0, (outer - area) / outer), area, outer


@inner
def grown(old, used, more):
    """An array of rows with room for more: itself, or a copy twice as long."""
    if used + more <= old.shape[0]:
        return old
    new = np.empty((max(2 * old.shape[0], used + more), old.shape[1]))
    for i in range(used):
        for j in range(old.shape[1]):
            new[i, j] = old[i, j]
    return new
