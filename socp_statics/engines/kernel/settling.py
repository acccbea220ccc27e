"""A program of five unknowns, settled: roughly by the interior-point method, then to rounding by Newton's where it takes hold."""

from __future__ import annotations

from socp_statics.engines.kernel.compilation import inner
from socp_statics.engines.kernel.five_unknowns import NEW, SOLVED, solve
from socp_statics.engines.kernel.lanes import BLOCK, MULTIPLIER, S2, S3, S4, S, U, column, lane, padded, row
from socp_statics.engines.kernel.normal_matrix import solve_factored
from socp_statics.engines.kernel.projection_newton import optimum

TOLERANCE = 1e-12
# Of the interior-point iterates that Newton's method starts from, the second one where it does not take hold at the first.
ROUGH, FINE = 1e-2, 1e-5


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
def settle(X, cones, points, pad, factors, q, rows, equations, guess, y, kept):
    """Solve one program.

    Args:
        X: Buffer of the cones with its right-hand sides.
        cones: Number of cones.
        points: Shape (n, 14).
        pad: Diagonal term of an unused fifth unknown, 0 or 1.
        factors: Of the normal matrix of the rows.
        q: Cost, shape (5,).
        rows: Scratch of `projection_newton.optimum`.
        equations: Scratch of `projection_newton.optimum`.
        guess: Scratch, shape (5,).
        y: Written: the unknowns, shape (5,).
        kept: Written: the multipliers, shape (3 * cones,).

    Returns:
        Status of the program, and whether unknowns and multipliers are exact but for rounding.
    """
    tolerance, begun = ROUGH, NEW
    while True:
        status, _, begun = solve(X, padded(cones), float(cones), pad, factors, q, guess, tolerance, begun)
        if status != SOLVED:
            break
        keep_multipliers(X, cones, kept)
        for j in range(5):
            y[j] = guess[j]
        # What is left for the interior-point method after this Newton's method does in a fraction of the time, and to rounding.
        if optimum(X, cones, points, q, rows, equations, y, kept):
            return SOLVED, True
        if tolerance == TOLERANCE:
            break
        tolerance = FINE if tolerance == ROUGH else TOLERANCE
    balance_multipliers(X, cones, factors, q)
    keep_multipliers(X, cones, kept)
    for j in range(5):
        y[j] = guess[j]
    return status, False
