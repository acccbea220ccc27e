"""Whole support regions of any stance in compiled code, one program of the general method a direction.

    maximise  d' (r + C x)   subject to   A x = b,   G x + s = h,   s in the cones

x are the contact forces and the torques of limited joints, ``r + C x`` is the position of the centre of mass. Only the cost changes from
direction to direction. Of each answer it is the data that say how good it is, not the method: forces count as attained where they keep
every row, and the bound allows for what the multipliers miss.
"""

from __future__ import annotations

import math

import numpy as np

from socp_statics.engines.kernel.by_address import solve_at
from socp_statics.engines.kernel.compilation import entry, inner
from socp_statics.engines.kernel.conic import INFEASIBLE, ITERATIONS, SOLVED, UNBOUNDED
from socp_statics.engines.kernel.friction_points import eliminated
from socp_statics.engines.kernel.refinement import (
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
    insert,
    next_direction,
    polygons,
)
from socp_statics.engines.kernel.supports import BOUND, CX, CY, DX, DY, NODE

# By how much forces may miss a row, in units of the load.
HOLDS = 5e-9


@inner
def _why(status):
    """What a program that was not solved says about the region."""
    return EMPTY if status == INFEASIBLE else ENDLESS if status == UNBOUNDED else BROKEN


@inner
def reaches_all(rows, gram):
    """Whether the first six rows are independent beyond doubt.

    Args:
        rows: The wrench map, shape (6, nx).
        gram: Scratch, shape (6, 6).
    """
    for i in range(6):
        for j in range(i + 1):
            total = 0.0
            for k in range(rows.shape[1]):
                total += rows[i, k] * rows[j, k]
            gram[i, j] = total
    return eliminated(gram)


@inner
def missed_rows(A, b, x):
    """By how much unknowns miss the equality rows."""
    worst = 0.0
    for i in range(len(b)):
        total = -b[i]
        for j in range(len(x)):
            total += A[i, j] * x[j]
        worst = max(worst, abs(total))
    return worst


@inner
def missed_cones(start, column, value, orthant, soc, h, x):
    """By how much unknowns are outside of the cones: of each, the tail longer than the head."""
    worst, row = -math.inf, 0
    for c in range(orthant + len(soc)):
        d = 1 if c < orthant else soc[c - orthant]
        head, square = 0.0, 0.0
        for i in range(d):
            slack = h[row]
            for t in range(start[row], start[row + 1]):
                slack -= value[t] * x[column[t]]
            row += 1
            if i == 0:
                head = slack
            else:
                square += slack * slack
        worst = max(worst, math.sqrt(square) - head)
    return worst


@inner
def bound_of(A, start, column, value, b, h, q, x, y, z, off):
    """Lower bound of ``q' x`` from multipliers, less what x gains where they miss the cost.

    Args:
        A: Equality rows, shape (p, n).
        start: Where each row of G begins.
        column: Columns of G's entries.
        value: Values of G's entries.
        b: Right-hand side of the equality rows.
        h: Right-hand side of the cone rows.
        q: Cost.
        x: Unknowns.
        y: Multipliers of the equality rows.
        z: Multipliers of the cone rows, in their cones.
        off: Scratch, shape (n,).
    """
    total = 0.0
    for j in range(len(q)):
        off[j] = q[j]
    for i in range(len(y)):
        total -= b[i] * y[i]
        for j in range(len(q)):
            off[j] += A[i, j] * y[i]
    for i in range(len(z)):
        total -= h[i] * z[i]
        for t in range(start[i], start[i + 1]):
            off[column[t]] += value[t] * z[i]
    for j in range(len(q)):
        total -= abs(off[j] * x[j])
    return total


@entry(
    "Tuple((int64[::1], float64[::1], float64[:,::1], float64[:,::1], float64[:,::1], float64[:,::1]))"
    "(int64, uint64[::1], float64[::1], float64[:,::1], int64[::1], int64[::1], float64[::1], int64, int64[::1], float64[::1], "
    "float64[::1], float64[:,::1], float64[:,::1], float64[::1], float64, float64, float64, float64, int64)"
)
def trace_plan(
    address, W, F, A, start, column, value, orthant, soc, b, h, wrench_map, position, origin, size, com_x, com_y, tolerance, most
):
    """Trace the support region of a stance.

    Args:
        address: Of `conic.solve`.
        W: Integers of the plan of the rows below.
        F: Reals of the plan.
        A: Equality rows, shape (p, n); the first three balance forces, the next moments about the direction of gravity, the last p - 4 have
            multipliers worth returning.
        start: Where each row of G begins.
        column: Columns of G's entries.
        value: Values of G's entries.
        orthant: Number of rows of the orthant.
        soc: Dimensions of the second-order cones.
        b: Right-hand side of the equality rows.
        h: Right-hand side of the cone rows.
        wrench_map: Wrenches of unit forces, shape (6, nx).
        position: ``[C r]``, shape (2, n + 1).
        origin: Mean contact point, shape (3,) [m].
        size: Largest distance between contact points [m].
        com_x: Position of the centre of mass along x, nan where no margin is asked for [m].
        com_y: Along y [m].
        tolerance: Of (outer area - inner area) / outer area.
        most: Number of directions that may be asked.

    Returns:
        What the region is (POLYGON, or why this tracer does not say) and number of programs, shape (2,); relative gap, CoM margin [m],
        inner and outer area [m^2], shape (4,). Inner corners, shape (k, 2) [m], and their unknowns, scaled, (k, n). Outer corners, (m, 2)
        [m], and of each outer edge multipliers of the equality rows, scaled, unit normal and offset [m], (m, p + 3).
    """
    n, p = len(position[0]) - 1, len(b)
    nodes, ints, corners, front = np.empty((most, NODE)), np.empty((4, most), np.int64), np.empty((most, 2)), np.empty(FRONT)
    forces, motions = np.empty((most, n)), np.empty((most, p))
    q, z, s, off = np.empty(n), np.empty(len(h)), np.empty(len(h)), np.empty(n)
    kind, count, k, m, gap, area, outer_area = RANK, begin_front(front), 0, 0, 1.0, 0.0, 0.0
    x0, y0 = (com_x - origin[0]) / size, (com_y - origin[1]) / size
    if reaches_all(wrench_map, np.empty((6, 6))):
        kind = ASK
    while kind == ASK:
        kind, i, dx, dy = next_direction(front, nodes, ints, count, tolerance, x0, y0)
        if kind != ASK:
            break
        x, y, node = forces[count], motions[count], nodes[count]
        for j in range(n):
            q[j] = -dx * position[0, j] - dy * position[1, j]
        status, _ = solve_at(address, W, F, q, b, h, ITERATIONS, x, y, z, s)
        if status != SOLVED:
            kind = _why(status)
        elif missed_rows(A, b, x) > HOLDS or missed_cones(start, column, value, orthant, soc, h, x) > HOLDS:
            kind = BROKEN
        else:
            cx, cy = position[0, n], position[1, n]
            for j in range(n):
                cx += position[0, j] * x[j]
                cy += position[1, j] * x[j]
            bound = dx * position[0, n] + dy * position[1, n] - bound_of(A, start, column, value, b, h, q, x, y, z, off)
            node[DX], node[DY], node[CX], node[CY], node[BOUND] = dx, dy, cx, cy, max(bound, dx * cx + dy * cy)
            insert(front, nodes, ints, count, i)
        count += 1
    if kind == POLYGON:
        kind, k, m, gap, area, outer_area = polygons(nodes, ints, front[INNER], corners)
    inner_xy, held, outer_xy, moving = np.empty((k, 2)), np.empty((k, n)), np.empty((m, 2)), np.empty((m, p + 3))
    for a in range(k):
        i = ints[KEEP, a]
        inner_xy[a, 0], inner_xy[a, 1] = origin[0] + size * nodes[i, CX], origin[1] + size * nodes[i, CY]
        for j in range(n):
            held[a, j] = forces[i, j]
    for a in range(m):
        i = ints[USED, a]
        outer_xy[a, 0], outer_xy[a, 1] = origin[0] + size * corners[a, 0], origin[1] + size * corners[a, 1]
        for j in range(p):
            moving[a, j] = motions[i, j]
        moving[a, p], moving[a, p + 1] = nodes[i, DX], nodes[i, DY]
        moving[a, p + 2] = nodes[i, DX] * origin[0] + nodes[i, DY] * origin[1] + size * nodes[i, BOUND]
    numbers = np.array([gap, size * front[MARGIN], size * size * area, size * size * outer_area])
    return np.array([kind, count]), numbers, inner_xy, held, outer_xy, moving
