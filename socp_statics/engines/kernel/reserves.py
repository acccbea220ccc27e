"""Normal-force reserves of points with friction in compiled code: many loads on a contact set, many contact sets.

The margin is the least power ``- L' y`` of the load against a motion y that no contact resists, ``W_i' y in K_i*``, and that lifts the
contact points by one in total, ``a' y = 1`` with a the wrench of a unit normal force at every point. With ``y = y_0 + N u`` there are
five unknowns; the multipliers are the forces less their reserve.
"""

from __future__ import annotations

import math

import numpy as np

from socp_statics.engines.kernel.compilation import entry, inner
from socp_statics.engines.kernel.five_unknowns import INFEASIBLE, SOLVED
from socp_statics.engines.kernel.friction_points import centre_and_size, full_rank, pad_lanes, unit_wrench, wrench_at_com
from socp_statics.engines.kernel.lanes import RHS, ROW1, S, U, buffer_size, lane, padded
from socp_statics.engines.kernel.normal_matrix import factor
from socp_statics.engines.kernel.projection_newton import EQUATION
from socp_statics.engines.kernel.settling import settle
from socp_statics.engines.kernel.starting_point import normal_matrix_of_rows

FINITE, INFINITE, OPEN = range(3)
# Forces that grow without end are stopped here, in units of W: beyond, the rounding of their sum is no longer small beside 1e-8.
LARGEST = 1e7
# Below this length the sum of the normals' wrenches does not scale a motion.
BRACED = 1e-6
ACCEPTED, PRECISE = 1e-8, 1e-10
WRENCH = 6


@inner(inline="always")
def prepare_reserve(X, points, centre, size, a, N, wrenches):
    """Rows and right-hand sides of the margin program.

    Args:
        X: Buffer of the cones, written.
        points: Shape (n, 14).
        centre: Mean contact point.
        size: Largest distance.
        a: Written: sum of the wrenches of unit normal forces, shape (6,).
        N: Written: orthonormal basis of what is perpendicular to a, shape (6, 5).
        wrenches: Written: wrenches of the components of each cone, shape (3 * n, 6).

    Returns:
        Whether the sum is long enough.
    """
    n = points.shape[0]
    for i in range(6):
        a[i] = 0.0
    for k in range(n):
        for c in range(3):
            f0, f1, f2, m0, m1, m2 = unit_wrench(points, k, c, centre, size)
            w = wrenches[3 * k + c]
            w[0], w[1], w[2], w[3], w[4], w[5] = f0, f1, f2, m0, m1, m2
        for i in range(6):
            a[i] += points[k, 13] * wrenches[3 * k, i]
    square = 0.0
    for i in range(6):
        square += a[i] * a[i]
    length = math.sqrt(square)
    if not length > BRACED * n:
        return False
    # Householder reflection that takes a to the first axis; the other axes' images are the basis.
    lead = a[0] + (length if a[0] >= 0.0 else -length)
    tail = square - a[0] * a[0] + lead * lead
    for j in range(5):
        for i in range(6):
            v_i = lead if i == 0 else a[i]
            N[i, j] = (1.0 if i == j + 1 else 0.0) - 2.0 * v_i * a[j + 1] / tail
    for k in range(n):
        o = lane(k)
        for c in range(3):
            at = o + U(c) * ROW1
            w = wrenches[3 * k + c]
            for j in range(5):
                total = 0.0
                for i in range(6):
                    total += w[i] * N[i, j]
                X[at + U(j) * S] = -total
            total = 0.0
            for i in range(6):
                total += w[i] * a[i]
            X[o + RHS + U(c) * S] = total / square
    pad_lanes(X, n)
    return True


@inner(inline="always")
def motion_holds(wrenches, y):
    """Largest way in which a unit force of a point could work against a motion of size one."""
    size = max(math.sqrt(y[0] * y[0] + y[1] * y[1] + y[2] * y[2]), math.sqrt(y[3] * y[3] + y[4] * y[4] + y[5] * y[5]))
    worst = 0.0
    for k in range(wrenches.shape[0] // 3):
        u0 = u1 = u2 = 0.0
        for i in range(6):
            u0 += wrenches[3 * k, i] * y[i]
            u1 += wrenches[3 * k + 1, i] * y[i]
            u2 += wrenches[3 * k + 2, i] * y[i]
        worst = max(worst, math.sqrt(u1 * u1 + u2 * u2) - u0)
    return worst / size


@inner(inline="always")
def reserve(X, points, wrenches, a, N, factors, load, q, rows, equations, guess, u, motion, forces):
    """The margin of one load.

    Args:
        X: Buffer of the cones, prepared.
        points: Shape (n, 14).
        wrenches: Of the components of each cone, shape (3 * n, 6).
        a: Sum of the normals' wrenches, shape (6,).
        N: Basis of the free motions, shape (6, 5).
        factors: Of the normal matrix.
        load: Scaled impressed wrench, shape (6,).
        q: Scratch, shape (5,).
        rows: Scratch of `projection_newton.optimum`.
        equations: Scratch of `projection_newton.optimum`.
        guess: Scratch, shape (5,).
        u: Scratch, shape (5,).
        motion: Written: y, shape (6,).
        forces: Written: components of each cone, shape (n, 3).

    Returns:
        FINITE, INFINITE or OPEN (not settled), the margin, and how far forces or motion are from keeping their promise.
    """
    n = points.shape[0]
    square = 0.0
    for i in range(6):
        square += a[i] * a[i]
    start = 0.0
    for i in range(6):
        start -= load[i] * a[i] / square
    for j in range(5):
        q[j] = 0.0
        for i in range(6):
            q[j] -= N[i, j] * load[i]
    status, exact = settle(X, n, points, 0.0, factors, q, rows, equations, guess, u, forces.reshape(3 * n))
    if status != SOLVED and status != INFEASIBLE:
        return OPEN, 0.0, 0.0
    bound = start
    for j in range(5):
        bound += q[j] * u[j]
    for i in range(6):
        motion[i] = a[i] / square
        for j in range(5):
            motion[i] += N[i, j] * u[j]
    along = 0.0
    for i in range(6):
        along += load[i] * a[i]
    for k in range(n):
        z0, z1, z2 = forces[k, 0], forces[k, 1], forces[k, 2]
        for i in range(6):
            along += (z0 * wrenches[3 * k, i] + z1 * wrenches[3 * k + 1, i] + z2 * wrenches[3 * k + 2, i]) * a[i]
    margin = -along / square
    worst, largest = 0.0, 1.0
    for k in range(n):
        forces[k, 0] += margin * points[k, 13]
        z0, z1, z2 = forces[k, 0], forces[k, 1], forces[k, 2]
        worst = max(worst, math.sqrt(z1 * z1 + z2 * z2) - z0)
        largest = max(largest, z0)
    if status == INFEASIBLE:
        # Forces that grow without end and stay inside: they prove themselves.
        settled = margin > 1.0 and worst <= 0.0 and largest < LARGEST
        return (INFINITE if settled else OPEN), math.inf, worst
    # What Newton's method did not take to rounding has to say how near it is.
    near = ACCEPTED if exact else PRECISE
    if not abs(margin - bound) <= near * (1.0 + abs(bound)):
        return OPEN, margin, worst
    if margin < 0.0:
        held = motion_holds(wrenches, motion)
        return (FINITE if held <= near else OPEN), margin, held
    return (FINITE if worst <= near else OPEN), margin, worst


@entry("Tuple((int64[::1], float64[::1], float64[:,::1], float64[:,::1]))(float64[:,::1], int64[::1], int64[::1], float64[:,::1])")
def reserves(points, starts, items, loads):
    """Margins of loads on sets of points with friction.

    Args:
        points: Rows of all sets, shape (n, 14), see `friction_points`.
        starts: Where each set starts, and the end, shape (s + 1,).
        items: Where the loads of each set start, and the end, shape (s + 1,).
        loads: Force of gravity (3) [N]; other impressed wrenches about the mean contact point (6) [N, N m]; W [N]; centre of mass (3)
            [m], shape (b, 13).

    Returns:
        Of each load: FINITE, INFINITE or OPEN, shape (b,); the margin in units of W, shape (b,); the motion, shape (b, 6); and, all
        loads one after the other, the components of each row's force in units of W, shape (rows, 3).
    """
    sets, batch = starts.shape[0] - 1, loads.shape[0]
    widest, rows = 0, 0
    for s in range(sets):
        n = starts[s + 1] - starts[s]
        widest = max(widest, n)
        rows += n * (items[s + 1] - items[s])
    X = np.empty(buffer_size(widest))
    kinds, margins, motions, forces = np.empty(batch, np.int64), np.empty(batch), np.empty((batch, 6)), np.empty((rows, 3))
    centre, a, N, gram, q, u, load = np.empty(3), np.empty(6), np.empty((6, 5)), np.empty((6, 6)), np.empty(5), np.empty(5), np.empty(6)
    every, equations = np.empty((3 * widest, WRENCH)), np.empty((3 * widest, EQUATION))
    taken, guess = np.empty(widest, np.int64), np.empty(5)
    at = 0
    for s in range(sets):
        mine = points[starts[s] : starts[s + 1]]
        n = mine.shape[0]
        wrenches = every[: 3 * n]
        size = centre_and_size(mine, centre)
        known = full_rank(mine, centre, size, gram) and prepare_reserve(X, mine, centre, size, a, N, wrenches)
        factors = factor(normal_matrix_of_rows(X, padded(n)))
        for b in range(items[s], items[s + 1]):
            kinds[b], margins[b] = OPEN, 0.0
            if not known:
                for i in range(6):
                    motions[b, i] = 0.0
                for k in range(n):
                    forces[at + k, 0], forces[at + k, 1], forces[at + k, 2] = 0.0, 0.0, 0.0
            else:
                wrench_at_com(loads[b], centre, size, load)
                kinds[b], margins[b], _ = reserve(
                    X, mine, wrenches, a, N, factors, load, q, taken, equations, guess, u, motions[b], forces[at : at + n]
                )
            at += n
    return kinds, margins, motions, forces
