"""Support directions of the centre of mass in compiled code: one program each, an attained point and a line that holds the region."""

from __future__ import annotations

import math

from socp_statics.engines.kernel.compilation import inner
from socp_statics.engines.kernel.five_unknowns import SOLVED, solve
from socp_statics.engines.kernel.lanes import BLOCK, MULTIPLIER, RHS, RHS_X, RHS_Y, ROW0, ROW1, ROW2, S2, S3, S4, S, U, column, row
from socp_statics.engines.kernel.normal_matrix import solve_factored

TOLERANCE = 1e-10

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
        a = U(k // 16) * BLOCK + U(k % 16) + MULTIPLIER
        kept[3 * k], kept[3 * k + 1], kept[3 * k + 2] = X[a], X[a + S], X[a + S2]


@inner
def support(X, cones, factors, q, reference, dx, dy, node, y, kept):
    """One support direction.

    Args:
        X: Buffer of the cones with the direction set.
        cones: Number of cones.
        factors: Of their normal matrix.
        q: Cost, shape (5,).
        reference: Position without contact forces, shape (2,).
        dx: First coordinate of the unit direction.
        dy: Second coordinate.
        node: Written: direction, attained point, bound, shape (8,).
        y: Written: the motion, shape (5,).
        kept: Written: the forces, shape (3 * cones,).

    Returns:
        Status of the program.
    """
    lanes = U((cones + 3) // 4 * 4)
    status, _ = solve(X, lanes, float(cones), 1.0, factors, q, y, TOLERANCE)
    if status != SOLVED:
        return status
    balance_multipliers(X, cones, factors, q)
    x, z = reference[0], reference[1]
    o, left = U(0), U(cones)
    while left > U(0):
        count = min(left, S)
        for k in range(count):
            a = o + k
            z0, z1, z2 = X[a + MULTIPLIER], X[a + MULTIPLIER + S], X[a + MULTIPLIER + S2]
            x -= X[a + RHS_X] * z0 + X[a + RHS_X + S] * z1 + X[a + RHS_X + S2] * z2
            z -= X[a + RHS_Y] * z0 + X[a + RHS_Y + S] * z1 + X[a + RHS_Y + S2] * z2
        left -= count
        o += BLOCK
    bound = dx * reference[0] + dy * reference[1]
    for j in range(5):
        bound += q[j] * y[j]
    # A motion that misses a cone by rounding bounds the region a little farther out: by what the forces could gain there.
    misses, carried = 0.0, 0.0
    for k in range(cones):
        a = U(k // 16) * BLOCK + U(k % 16)
        s0 = X[a + RHS] - row(X, a + ROW0, y[0], y[1], y[2], y[3], y[4])
        s1 = X[a + RHS + S] - row(X, a + ROW1, y[0], y[1], y[2], y[3], y[4])
        s2 = X[a + RHS + S2] - row(X, a + ROW2, y[0], y[1], y[2], y[3], y[4])
        misses = max(misses, math.sqrt(s1 * s1 + s2 * s2) - s0)
        carried += X[a + MULTIPLIER]
    bound += misses * carried
    node[DX], node[DY], node[CX], node[CY] = dx, dy, x, z
    node[BOUND] = max(bound, dx * x + dy * z)
    keep_multipliers(X, cones, kept)
    return status
