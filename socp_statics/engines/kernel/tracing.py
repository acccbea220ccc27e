"""Whole support regions of points with friction in compiled code: preparation, directions, refinement, polygons.

The next direction is the normal of the edge with the largest uncertain triangle (Bretl and Lall 2008).
"""

from __future__ import annotations

import math

import numpy as np

from socp_statics.engines.kernel.active_set import EQUATION
from socp_statics.engines.kernel.com_distance import MOST_REFINEMENTS, OUTSIDE, nearest_edge, thin_enough
from socp_statics.engines.kernel.compilation import entry, inner
from socp_statics.engines.kernel.contact_vertices import carrying_points, contact_vertex
from socp_statics.engines.kernel.continuation import continued
from socp_statics.engines.kernel.five_unknowns import INFEASIBLE, SOLVED, UNBOUNDED
from socp_statics.engines.kernel.friction_points import centre_and_size, full_rank, prepare_support, scaled_load, set_direction
from socp_statics.engines.kernel.lanes import buffer_size, padded
from socp_statics.engines.kernel.normal_matrix import factor, with_pad
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
from socp_statics.engines.kernel.starting_point import normal_matrix_of_rows
from socp_statics.engines.kernel.supports import AREA, BOUND, CX, CY, DX, DY, NODE, support

POLYGON, EMPTY, ENDLESS, RANK, THIN, MANY, BROKEN = range(7)
# Below this area a region may be a sliver; below this width it is none of this tracer's business.
SLIVER = 1e-7
# Attained points nearer than this to the chord of their neighbours are no corners: the accuracy of the method.
CORNER = 1e-9


def most_directions(tolerance: float) -> int:
    """How many directions a region may take: a few times what a disc needs, pi over the root of the tolerance."""
    return 64 + int(12.0 / math.sqrt(tolerance))


@inner
def _why(status):
    """What a support direction that was not solved says about the region."""
    return ENDLESS if status == INFEASIBLE else EMPTY if status == UNBOUNDED else BROKEN


@inner
def widest_edge(nodes, after, order, count, inner_area):
    """The edge with the largest uncertain triangle.

    Returns:
        POLYGON, or why there is no direction to ask; the support before the edge; and the edge's normal.
    """
    i = 0
    for k in range(1, count):
        if nodes[k, AREA] > nodes[i, AREA]:
            i = k
    j = after[i]
    ex, ey = nodes[j, CX] - nodes[i, CX], nodes[j, CY] - nodes[i, CY]
    length = math.hypot(ex, ey)
    if inner_area < SLIVER and width(nodes, order, ring_order(after, order)) < SLIVER:
        return THIN, i, 0.0, 0.0
    if length == 0.0:
        return BROKEN, i, 0.0, 0.0
    dx, dy = ey / length, -ex / length
    if not between(nodes, i, dx, dy, j) or parallel(nodes, i, dx, dy) or parallel(nodes, j, dx, dy):
        return BROKEN, i, 0.0, 0.0
    return POLYGON, i, dx, dy


@inner
def aimed(area):
    """The uncertain area to reach, for at most ``area`` after the points that are no corners were left out."""
    return area - min(4.0 * CORNER, 0.5 * area)


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
def trace_one(points, load13, tolerance, X, ints, states, nodes, motions, forces, alone, equations, small):
    """Trace one region into work arrays.

    Args:
        points: Shape (n, 14).
        load13: See `trace`.
        tolerance: Of (outer area - inner area) / outer area.
        X: Buffer of the cones.
        ints: Rows of indices: ring, order, known, carrying, corners.
        states: What each contact does at each support, where that is known, shape (most, n).
        nodes: Written: supports, shape (most, 8).
        motions: Written: their motions, shape (most, 5).
        forces: Written: their forces, shape (most, 3 * n).
        alone: Scratch, shape (n, 5).
        equations: Scratch of `active_set.optimum`.
        small: Scratch; rows 0 to 3 are written: mean contact point, then `lift` of `prepare_support`.

    Returns:
        What it is, number of supports, inner area, CoM margin and size.
    """
    cones, most = points.shape[0], nodes.shape[0]
    after, order, known, carrying, keep = ints[0], ints[1], ints[2], ints[3], ints[4]
    centre, lift, load, pull, q, reference = small[0], small[1:4], small[4], small[5], small[6], small[7]
    gram = small[9:15]
    size = centre_and_size(points, centre)
    scaled_load(load13, centre, size, load, pull)
    if not full_rank(points, centre, size, gram):
        return RANK, 0, 0.0, 0.0, size
    prepare_support(X, points, load, pull, centre, size, lift, q, reference)
    factors = factor(with_pad(normal_matrix_of_rows(X, padded(cones))))
    carriers, pushed = 0, False
    for k in range(3, 9):
        pushed = pushed or load13[k] != 0.0
    if not pushed:
        carriers = carrying_points(X, points, load, reference, carrying, alone)
    x, y = (load13[11] - centre[0]) / size, (load13[12] - centre[1]) / size
    asked_margin, refined, found = x == x, 0, False
    margin, edge = math.inf, OUTSIDE
    count, i, inner_area, uncertain = 0, 0, 0.0, 0.0
    # The four axes first, then the edge with the largest uncertain triangle, at last the edge nearest to the centre of mass.
    while True:
        if count < 4:
            dx, dy = (1.0 - count) * (1 - count % 2), (2.0 - count) * (count % 2)
        elif refined == 0 and uncertain > aimed(tolerance * (max(inner_area, 0.0) + uncertain)):
            kind, i, dx, dy = widest_edge(nodes, after, order, count, inner_area)
            if kind != POLYGON:
                return kind, count, 0.0, 0.0, size
        elif asked_margin and not found and refined < MOST_REFINEMENTS:
            ring = ring_order(after, order)
            corners = inner_corners(nodes, order, ring, CORNER, keep)
            found, margin, edge, dx, dy = nearest_edge(nodes, order, ring, keep, corners, x, y)
            refined += 1
            if found:
                break
            i = sector(nodes, after, dx, dy)
        else:
            break
        if count >= most:
            return MANY, count, 0.0, 0.0, size
        node, motion, held = nodes[count], motions[count], forces[count]
        known[count] = 0
        if not contact_vertex(X, points, centre, size, lift, carrying, alone, carriers, dx, dy, node, motion, held):
            set_direction(X, cones, dx, dy)
            mine = states[count]
            if count >= 4 and continued(
                X, points, q, reference, nodes, motions, forces, states, known, i, after[i], dx, dy, mine, equations, node, motion, held
            ):
                known[count] = 1
            else:
                status, known[count] = support(
                    X, cones, points, factors, q, reference, dx, dy, mine, equations, small[8], node, motion, held
                )
                if status != SOLVED:
                    return _why(status), count + 1, 0.0, 0.0, size
        if count < 3:
            after[count] = count + 1
        elif count == 3:
            after[3] = 0
            inner_area = triangle(nodes, 0, 1, 2) + triangle(nodes, 0, 2, 3)
            for k in range(4):
                measure(nodes, after, k)
                uncertain += nodes[k, AREA]
        else:
            uncertain -= nodes[i, AREA]
            inner_area += triangle(nodes, i, count, after[i])
            after[count], after[i] = after[i], count
            measure(nodes, after, i)
            measure(nodes, after, count)
            uncertain += nodes[i, AREA] + nodes[count, AREA]
            found = refined > 0 and edge != OUTSIDE and thin_enough(nodes, edge, count, margin)
        count += 1
    return POLYGON, count, inner_area, margin * size, size


@inner
def area_of(nodes, order, count, x, y):
    """Area of a polygon of some rows and two columns of an array."""
    total = 0.0
    for k in range(count):
        i, j = order[k], order[(k + 1) % count]
        total += 0.5 * (nodes[i, x] * nodes[j, y] - nodes[i, y] * nodes[j, x])
    return total


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


@entry(
    "Tuple((int64[:,::1], float64[:,::1], float64[:,::1], float64[:,::1], float64[:,::1], float64[:,::1]))"
    "(float64[:,::1], int64[::1], float64[:,::1], float64, int64)"
)
def trace(points, starts, loads, tolerance, most):
    """Trace the support regions of sets of points with friction.

    Args:
        points: Rows of all sets, shape (n, 14), see `friction_points`.
        starts: Where each set starts, and the end, shape (b + 1,).
        loads: Of each set, shape (b, 13): force of gravity (3) [N]; other impressed wrenches about the mean contact point (6) [N, N m];
            W [N]; height of the centre of mass, its position along x and y, or nan where no margin is asked for [m].
        tolerance: Of (outer area - inner area) / outer area.
        most: Number of directions that may be asked.

    Returns:
        Of each set: what its region is (POLYGON, or why this tracer does not say), number of inner corners, of outer edges and of
        programs, shape (b, 4); relative gap, CoM margin [m], size [m], inner and outer area [m^2], shape
        (b, 5). Then, all sets one after the other: inner
        corners [m], outer corners [m], scaled multipliers of each row and inner corner (three numbers), of each outer edge
        its scaled motion (6), unit normal (2) and offset [m].
    """
    batch, widest = starts.shape[0] - 1, 1
    for b in range(batch):
        widest = max(widest, starts[b + 1] - starts[b])
    X = np.empty(buffer_size(widest))
    # A row a support: a trace that asks few directions touches little memory.
    ints, states = np.empty((5, max(most, widest)), np.int64), np.empty((most, widest), np.int64)
    nodes, motions, alone, small = np.empty((most, NODE)), np.empty((most, 5)), np.empty((widest, 5)), np.empty((15, 6))
    equations = np.empty((3 * widest, EQUATION))
    store, corners = np.empty((most, 3 * widest)), np.empty((most, 2))
    counts, numbers = np.empty((batch, 4), np.int64), np.empty((batch, 5))
    inner_xy, outer_xy, moving = np.empty((16 * batch, 2)), np.empty((16 * batch, 2)), np.empty((16 * batch, 9))
    held = np.empty((16 * batch * widest, 3))
    inners = outers = rows = 0
    order, keep, used = ints[1], ints[2], ints[4]
    for b in range(batch):
        mine = points[starts[b] : starts[b + 1]]
        cones = mine.shape[0]
        kind, count, inner_area, margin, size = trace_one(
            mine, loads[b], tolerance, X, ints, states, nodes, motions, store, alone, equations, small
        )
        k = m = 0
        gap, area, outer_area = 1.0, 0.0, 0.0
        if kind == POLYGON:
            ring = ring_order(ints[0], order)
            k = inner_corners(nodes, order, ring, CORNER, keep)
            m = outer_polygon(nodes, order, ring, ROUNDING * min(1.0, inner_area), used, corners)
            if m == 0 or k < 3:
                kind, k, m = BROKEN, 0, 0
        if kind == POLYGON:
            inner_xy, held = grown(inner_xy, inners, k), grown(held, rows, k * cones)
            outer_xy, moving = grown(outer_xy, outers, m), grown(moving, outers, m)
            for e in range(m):
                order[e] = e
            outer_area, area = area_of(corners, order, m, 0, 1), area_of(nodes, keep, k, CX, CY)
            gap = max(0.0, (outer_area - area) / outer_area)
            for a in range(k):
                i = keep[a]
                inner_xy[inners + a, 0], inner_xy[inners + a, 1] = small[0, 0] + size * nodes[i, CX], small[0, 1] + size * nodes[i, CY]
                for c in range(cones):
                    for j in range(3):
                        held[rows + a * cones + c, j] = store[i, 3 * c + j]
            for e in range(m):
                i = used[e]
                outer_xy[outers + e, 0], outer_xy[outers + e, 1] = small[0, 0] + size * corners[e, 0], small[0, 1] + size * corners[e, 1]
                for c in range(3):
                    moving[outers + e, c] = motions[i, c]
                    turn = small[3, c] * motions[i, 3] + nodes[i, DX] * small[1, c] + nodes[i, DY] * small[2, c]
                    moving[outers + e, 3 + c] = turn
                dx, dy = nodes[i, DX], nodes[i, DY]
                moving[outers + e, 6], moving[outers + e, 7] = dx, dy
                moving[outers + e, 8] = dx * small[0, 0] + dy * small[0, 1] + size * nodes[i, BOUND]
        inners, outers, rows = inners + k, outers + m, rows + k * cones
        counts[b, 0], counts[b, 1], counts[b, 2], counts[b, 3] = kind, k, m, count
        numbers[b, 0], numbers[b, 1], numbers[b, 2] = gap, margin, size
        numbers[b, 3], numbers[b, 4] = size * size * area, size * size * outer_area
    return counts, numbers, inner_xy[:inners], outer_xy[:outers], held[:rows], moving[:outers]
