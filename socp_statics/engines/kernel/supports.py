"""Support directions of the centre of mass in compiled code: one program each, an attained point and a line that holds the region."""

from __future__ import annotations

import math

from socp_statics.engines.kernel.active_set import classify, optimum, slack
from socp_statics.engines.kernel.compilation import inner
from socp_statics.engines.kernel.five_unknowns import NEW, SOLVED, solve
from socp_statics.engines.kernel.lanes import BLOCK, MULTIPLIER, RHS_X, RHS_Y, S2, S3, S4, S, U, column, lane, padded, row
from socp_statics.engines.kernel.normal_matrix import solve_factored

TOLERANCE = 1e-10
# Of the interior-point iterate that Newton's method starts from.
ROUGH = 1e-3
# An interior-point solution says beyond doubt what a contact does if distances to the boundary differ by this much.
CLEAR = 1e-3

# Columns of a node of the traced region: direction, attained point, bound, crossing with the next line, uncertain area.
DX, DY, CX, CY, BOUND, PX, PY, AREA = range(8)
NODE = 8


@inner
def balance_multipliers(X, cones, factors, q):
    """Correct the contact forces so that they balance the load to rounding: the least change, far below the accuracy of the cones."""
    x0, x1, x2, x3, x4 = q[0], q[1], q[2], q[3], q[4]
    o, left = U(0), U(cones)
    while left > U(0):
        count = min(left, S)
        for k in range(count):
            a = o + k
            z0, z1, z2 = X[a + MULTIPLIER], X[a + MULTIPLIER + S], X[a + MULTIPLIER + S2]
            x0 += column(X, a, z0, z1, z2)
            x1 += column(X, a + S, z0, z1, z2)
            x2 += column(X, a + S2, z0, z1, z2)
            x3 += column(X, a + S3, z0, z1, z2)
            x4 += column(X, a + S4, z0, z1, z2)
        left -= count
        o += BLOCK
    r0, r1, r2, r3, r4 = solve_factored(factors, x0, x1, x2, x3, x4)
    o, left = U(0), U(cones)
    while left > U(0):
        count = min(left, S)
        for c in range(3):
            for k in range(count):
                a = o + k
                X[a + MULTIPLIER + U(c) * S] -= row(X, a + U(5 * c) * S, r0, r1, r2, r3, r4)
        left -= count
        o += BLOCK


@inner
def keep_multipliers(X, cones, kept):
    """Copy the forces of a solution, three numbers a cone."""
    for k in range(cones):
        a = lane(k) + MULTIPLIER
        kept[3 * k], kept[3 * k + 1], kept[3 * k + 2] = X[a], X[a + S], X[a + S2]


@inner
def finish(X, cones, q, reference, dx, dy, node, y, kept):
    """Attained point and bound of a solution, written into its node.

    Args:
        X: Buffer of the cones with the direction set.
        cones: Number of cones.
        q: Cost, shape (5,).
        reference: Position without contact forces, shape (2,).
        dx: First coordinate of the unit direction.
        dy: Second coordinate.
        node: Written: direction, attained point, bound, shape (8,).
        y: The motion, shape (5,).
        kept: The forces, shape (3 * cones,).
    """
    x, z = reference[0], reference[1]
    bound = dx * x + dy * z
    for j in range(5):
        bound += q[j] * y[j]
    # A motion that misses a cone by rounding bounds the region a little farther out: by what the forces could gain there.
    misses, carried = 0.0, 0.0
    for k in range(cones):
        a = lane(k)
        z0, z1, z2 = kept[3 * k], kept[3 * k + 1], kept[3 * k + 2]
        x -= X[a + RHS_X] * z0 + X[a + RHS_X + S] * z1 + X[a + RHS_X + S2] * z2
        z -= X[a + RHS_Y] * z0 + X[a + RHS_Y + S] * z1 + X[a + RHS_Y + S2] * z2
        s0, s1, s2 = slack(X, a, y)
        misses = max(misses, math.sqrt(s1 * s1 + s2 * s2) - s0)
        carried += z0
    bound += misses * carried
    node[DX], node[DY], node[CX], node[CY] = dx, dy, x, z
    node[BOUND] = max(bound, dx * x + dy * z)


@inner
def support(X, cones, points, factors, q, reference, dx, dy, states, equations, guess, node, y, kept):
    """One support direction.

    Args:
        X: Buffer of the cones with the direction set.
        cones: Number of cones.
        points: Shape (n, 14).
        factors: Of their normal matrix.
        q: Cost, shape (5,).
        reference: Position without contact forces, shape (2,).
        dx: First coordinate of the unit direction.
        dy: Second coordinate.
        states: Written where they are known: what each contact does, shape (cones,).
        equations: Scratch of `active_set.optimum`.
        guess: Scratch, shape (5,).
        node: Written: direction, attained point, bound, shape (8,).
        y: Written: the motion, shape (5,).
        kept: Written: the forces, shape (3 * cones,).

    Returns:
        Status of the program, and whether the states are known.
    """
    lanes, known = padded(cones), False
    status, _, begun = solve(X, lanes, float(cones), 1.0, factors, q, guess, ROUGH, NEW)
    if status == SOLVED:
        # What is left for the interior-point method after this Newton's method does in a fraction of the time, and to rounding.
        classify(X, cones, points, CLEAR, states)
        keep_multipliers(X, cones, kept)
        for j in range(5):
            y[j] = guess[j]
        known = optimum(X, cones, points, q, states, equations, y, kept)
        if not known:
            status, _, _ = solve(X, lanes, float(cones), 1.0, factors, q, guess, TOLERANCE, begun)
    if status != SOLVED:
        return status, False
    if not known:
        known = classify(X, cones, points, CLEAR, states)
        balance_multipliers(X, cones, factors, q)
        keep_multipliers(X, cones, kept)
        for j in range(5):
            y[j] = guess[j]
    finish(X, cones, q, reference, dx, dy, node, y, kept)
    return status, known
