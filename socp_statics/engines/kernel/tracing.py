"""Whole support regions of points with friction in compiled code: preparation, directions, refinement, polygons."""

from __future__ import annotations

import numpy as np

from socp_statics.engines.kernel.borrowed import borrowed
from socp_statics.engines.kernel.compilation import entry, inner
from socp_statics.engines.kernel.contact_vertices import carrying_points, contact_vertex
from socp_statics.engines.kernel.continuation import continued
from socp_statics.engines.kernel.five_unknowns import INFEASIBLE, SOLVED, UNBOUNDED
from socp_statics.engines.kernel.friction_points import centre_and_size, full_rank, prepare_support, scaled_load, set_direction
from socp_statics.engines.kernel.lanes import buffer_size, padded
from socp_statics.engines.kernel.normal_matrix import factor, with_pad
from socp_statics.engines.kernel.projection_newton import EQUATION
from socp_statics.engines.kernel.refinement import (
    AFTER,
    ASK,
    BROKEN,
    EMPTY,
    ENDLESS,
    FRONT,
    INNER,
    KEEP,
    MARGIN,
    POLYGON,
    RANK,
    USED,
    begin_front,
    grown,
    insert,
    next_direction,
    polygons,
)
from socp_statics.engines.kernel.starting_point import normal_matrix_of_rows
from socp_statics.engines.kernel.supports import BOUND, CX, CY, DX, DY, NODE, support


@inner
def _why(status):
    """What a support direction that was not solved says about the region."""
    return ENDLESS if status == INFEASIBLE else EMPTY if status == UNBOUNDED else BROKEN


@inner
def trace_one(points, load13, tolerance, X, ints, nodes, motions, forces, alone, equations, small):
    """Trace one region into work arrays.

    Args:
        points: Shape (n, 14).
        load13: See `trace`.
        tolerance: Of (outer area - inner area) / outer area.
        X: Buffer of the cones.
        ints: Rows of indices: those of `refinement`, then two for contacts.
        nodes: Written: supports, shape (most, 8).
        motions: Written: their motions, shape (most, 5).
        forces: Written: their forces, shape (most, 3 * n).
        alone: Scratch, shape (n, 5).
        equations: Scratch of `projection_newton.optimum`.
        small: Scratch; rows 0 to 3 are written: mean contact point, then `lift` of `prepare_support`.

    Returns:
        What it is, number of supports, inner area, CoM margin and size.
    """
    cones = points.shape[0]
    after, rows, carrying = ints[AFTER], ints[4], ints[5]
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
    front = np.empty(FRONT)
    count = begin_front(front)
    while True:
        kind, i, dx, dy = next_direction(front, nodes, ints, count, tolerance, x, y)
        if kind != ASK:
            return kind, count, front[INNER], front[MARGIN] * size, size
        node, motion, held = nodes[count], motions[count], forces[count]
        if not contact_vertex(X, points, centre, size, lift, carrying, alone, carriers, dx, dy, node, motion, held):
            set_direction(X, cones, dx, dy)
            if count < 4 or not continued(
                X, points, q, reference, nodes, motions, forces, i, after[i], dx, dy, rows, equations, node, motion, held
            ):
                status = support(X, cones, points, factors, q, reference, dx, dy, rows, equations, small[8], node, motion, held)
                if status != SOLVED:
                    return _why(status), count + 1, 0.0, 0.0, size
        insert(front, nodes, ints, count, i)
        count += 1


def work_arrays(cones, most):
    """Memory that `trace` works in.

    Args:
        cones: Largest number of points of a set.
        most: Number of directions that may be asked: a row a support, so that a trace which asks few directions touches little memory.

    Returns:
        Rows of indices; supports, their motions and forces; corners; scratch of `trace_one`.
    """
    shapes = ((most, NODE), (most, 5), (most, 3 * cones), (most, 2), (cones, 5), (3 * cones, EQUATION), (15, 6))
    return np.empty((6, max(most, cones)), np.int64), *map(np.empty, shapes)


@entry(
    "Tuple((int64[:,::1], float64[:,::1], float64[:,::1], float64[:,::1], float64[:,::1], float64[:,::1], float64[:,::1]))"
    "(float64[:,::1], int64[::1], float64[:,::1], float64, Tuple((int64[:,::1], float64[:,::1], float64[:,::1], "
    "float64[:,::1], float64[:,::1], float64[:,::1], float64[:,::1], float64[:,::1])))"
)
def trace(points, starts, loads, tolerance, work):
    """Trace the support regions of sets of points with friction.

    Args:
        points: Rows of all sets, shape (n, 14), see `friction_points`.
        starts: Where each set starts, and the end, shape (b + 1,).
        loads: Of each set, shape (b, 13): force of gravity (3) [N]; other impressed wrenches about the mean contact point (6) [N, N m];
            W [N]; height of the centre of mass, its position along x and y, or nan where no margin is asked for [m].
        tolerance: Of (outer area - inner area) / outer area.
        work: Of `work_arrays`, for no fewer points than any set has.

    Returns:
        Of each set: what its region is (POLYGON, or why this tracer does not say), number of inner corners, of outer edges and of
        programs, shape (b, 4); relative gap, CoM margin [m], size [m], inner and outer area [m^2], shape
        (b, 5). Then, all sets one after the other: inner
        corners [m], outer corners [m], scaled multipliers of each row and inner corner (three numbers), of each outer edge
        its scaled motion (6), then its unit normal (2) and offset [m].
    """
    batch, widest = starts.shape[0] - 1, 1
    for b in range(batch):
        widest = max(widest, starts[b + 1] - starts[b])
    X = np.empty(buffer_size(widest))
    ints, nodes, motions, forces, corners, alone, equations, small = work
    counts, numbers = np.empty((batch, 4), np.int64), np.empty((batch, 5))
    inner_xy, held = np.empty((16 * batch, 2)), np.empty((16 * batch * widest, 3))
    outer_xy, moving, lines = np.empty((16 * batch, 2)), np.empty((16 * batch, 6)), np.empty((16 * batch, 3))
    inners = outers = rows = 0
    keep, used = ints[KEEP], ints[USED]
    for b in range(batch):
        mine = points[starts[b] : starts[b + 1]]
        cones = mine.shape[0]
        kind, count, inner_area, margin, size = trace_one(
            borrowed(mine), loads[b], tolerance, borrowed(X), borrowed(ints), borrowed(nodes), borrowed(motions),
            borrowed(forces), borrowed(alone), borrowed(equations), borrowed(small),
        )  # fmt: skip
        k = m = 0
        gap, area, outer_area = 1.0, 0.0, 0.0
        if kind == POLYGON:
            kind, k, m, gap, area, outer_area = polygons(borrowed(nodes), borrowed(ints), inner_area, borrowed(corners))
        if kind == POLYGON:
            inner_xy, held = grown(inner_xy, inners, k), grown(held, rows, k * cones)
            outer_xy, moving, lines = grown(outer_xy, outers, m), grown(moving, outers, m), grown(lines, outers, m)
            for a in range(k):
                i = keep[a]
                inner_xy[inners + a, 0], inner_xy[inners + a, 1] = small[0, 0] + size * nodes[i, CX], small[0, 1] + size * nodes[i, CY]
                for c in range(cones):
                    for j in range(3):
                        held[rows + a * cones + c, j] = forces[i, 3 * c + j]
            for e in range(m):
                i = used[e]
                outer_xy[outers + e, 0], outer_xy[outers + e, 1] = small[0, 0] + size * corners[e, 0], small[0, 1] + size * corners[e, 1]
                for c in range(3):
                    moving[outers + e, c] = motions[i, c]
                    turn = small[3, c] * motions[i, 3] + nodes[i, DX] * small[1, c] + nodes[i, DY] * small[2, c]
                    moving[outers + e, 3 + c] = turn
                dx, dy = nodes[i, DX], nodes[i, DY]
                lines[outers + e, 0], lines[outers + e, 1] = dx, dy
                lines[outers + e, 2] = dx * small[0, 0] + dy * small[0, 1] + size * nodes[i, BOUND]
        inners, outers, rows = inners + k, outers + m, rows + k * cones
        counts[b, 0], counts[b, 1], counts[b, 2], counts[b, 3] = kind, k, m, count
        numbers[b, 0], numbers[b, 1], numbers[b, 2] = gap, margin, size
        numbers[b, 3], numbers[b, 4] = size * size * area, size * size * outer_area
    return counts, numbers, inner_xy[:inners], outer_xy[:outers], held[:rows], moving[:outers], lines[:outers]
