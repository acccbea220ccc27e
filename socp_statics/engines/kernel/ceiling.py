"""The least ceiling under which point forces in their friction cones balance a load: Boyd and Wegbreit's objective (2007).

    minimise    t                                                multipliers
    subject to  sum_i G_i z_i + L = 0                            y
                z_i in K_3                                       l_i = G_i' y - D_i m_i in K_3
                (t, D_i z_i) in K_4                              (v_i, m_i) in K_4,  sum_i v_i = 1
                                                                 maximise L' y

z_i are a point's normal force and its friction over mu, D_i = diag(1, mu, mu) makes them the force; zeros in D_i leave components
out of the measure. A solver of any accuracy needs no forces to start with: y = 0, v_i = 1 / n and m_i along minus the normal
are strictly inside.

Primal-dual interior-point method: Nesterov-Todd scaling, Mehrotra's predictor and corrector, as in `five_unknowns`. Its matrix is
block-arrow: a 3 x 3 block for each point, and balance and ceiling in common, so that the cost is linear in the points.
"""

from __future__ import annotations

import math

from socp_statics.engines.kernel.arrow_elimination import condense, eliminate, expand, gather
from socp_statics.engines.kernel.arrow_lanes import FORCE, GRIP, HOLD, NORMAL, TANGENTIAL, WRENCH, WRENCHES, place
from socp_statics.engines.kernel.arrow_scaling import residuals, scale
from socp_statics.engines.kernel.arrow_steps import advance, aim, rest, steps
from socp_statics.engines.kernel.compilation import inner
from socp_statics.engines.kernel.cone3 import TINY
from socp_statics.engines.kernel.five_unknowns import STEP
from socp_statics.engines.kernel.lanes import S2, S, U
from socp_statics.engines.kernel.normal_matrix import PIVOT

TOLERANCE = 1e-9
ACCEPTED = 1e-8
MOST_ITERATIONS = 60
CEILING = 6


@inner
def factor(A, size):
    """``L D L'`` of the lower triangle of a symmetric matrix in place; the ceiling's pivot, the seventh, is negative."""
    for j in range(size):
        least = max(PIVOT * abs(A[j, j]), TINY)
        for i in range(j):
            A[j, j] -= A[j, i] * A[j, i] * A[i, i]
        A[j, j] = min(A[j, j], -least) if j == CEILING else max(A[j, j], least)
        for i in range(j + 1, size):
            value = A[i, j]
            for m in range(j):
                value -= A[i, m] * A[j, m] * A[m, m]
            A[i, j] = value / A[j, j]


@inner
def solve_factored(A, size, r):
    """Solution of ``L D L' x = r`` in place of r."""
    for i in range(size):
        for j in range(i):
            r[i] -= A[i, j] * r[j]
    for i in range(size):
        r[i] /= A[i, i]
    for i in range(size - 1, -1, -1):
        for j in range(i + 1, size):
            r[i] -= A[j, i] * r[j]


@inner
def gram(X, n, A):
    """Factors of ``sum G_i G_i'``, written."""
    for i in range(7):
        for j in range(7):
            A[i, j] = 0.0
    for k in range(n):
        a = place(k) + WRENCH
        for c in range(3):
            for i in range(6):
                for j in range(i + 1):
                    A[i, j] += X[a + U(c) * WRENCHES + U(i) * S] * X[a + U(c) * WRENCHES + U(j) * S]
    factor(A, 6)


@inner
def start(X, n, A, load, y):
    """Least forces that balance the load, moved into their cones, and multipliers inside theirs; returns the ceiling above them."""
    for i in range(6):
        y[i] = load[i]
    solve_factored(A, 6, y)
    low, largest = 0.0, 1.0 / n
    for k in range(n):
        a = place(k)
        for c in range(3):
            z = 0.0
            for i in range(6):
                z -= X[a + WRENCH + U(c) * WRENCHES + U(i) * S] * y[i]
            X[a + FORCE + U(c) * S] = z
            largest = max(largest, abs(z))
        z0, z1, z2 = X[a + FORCE], X[a + FORCE + S], X[a + FORCE + S2]
        low = max(low, math.sqrt(z1 * z1 + z2 * z2) - z0)
    ceiling, share = 0.0, 0.5 / n
    for k in range(n):
        a = place(k)
        X[a + FORCE] += low + largest
        z0, z1, z2 = X[a + NORMAL] * X[a + FORCE], X[a + TANGENTIAL] * X[a + FORCE + S], X[a + TANGENTIAL] * X[a + FORCE + S2]
        ceiling = max(ceiling, z0 * z0 + z1 * z1 + z2 * z2)
        X[a + GRIP], X[a + GRIP + S], X[a + GRIP + S2] = share, 0.0, 0.0
        X[a + HOLD], X[a + HOLD + S] = 2.0 * share, -share * X[a + NORMAL]
        X[a + HOLD + S2], X[a + HOLD + U(3) * S] = 0.0, 0.0
    for i in range(6):
        y[i] = 0.0
    return math.sqrt(ceiling) + largest


@inner(inline="always")
def solve(X, n, load, grams, A, y, r, missing):
    """The least ceiling of one load.

    Args:
        X: The buffer of the points (see `arrow_lanes`): wrenches and measures are read, forces and multipliers written.
        n: Number of points.
        load: Impressed wrench, shape (6,).
        grams: Factors of ``sum G_i G_i'``, shape (7, 7).
        A: Scratch, shape (7, 7).
        y: Written: multipliers of the balance, shape (6,).
        r: Scratch, shape (7,).
        missing: Scratch, shape (6,).

    Returns:
        Whether it is settled, the gap over the ceiling and the number of iterations. The forces balance the load to rounding.
    """
    points = U(n)
    t = start(X, n, grams, load, y)
    error, iterations = math.inf, 0
    while True:
        gap, total = scale(X, points, t)
        for i in range(6):
            missing[i] = load[i]
        dual = max(residuals(X, points, y, missing), abs(1.0 - total))
        primal = 0.0
        for i in range(6):
            primal = max(primal, abs(missing[i]))
        relative = gap / (t + 1.0 / n)
        last, error = error, max(relative, dual, primal / max(1.0, t))
        # A degenerate optimum keeps the residuals from falling as far as the gap does.
        settled = relative <= ACCEPTED and (error <= TOLERANCE or (error <= ACCEPTED and error > 0.5 * last))
        if not settled and (iterations >= MOST_ITERATIONS or not gap < math.inf):
            return False, relative, iterations
        gather(X, points, eliminate(X, points), A)
        factor(A, 7)
        iterations += 1
        keep, alpha = 1.0, 1.0
        if settled:
            rest(X, points)
        for phase in range(1 if settled else 2):
            condense(X, points, keep, r)
            for i in range(6):
                r[i] += keep * missing[i]
            r[CEILING] += keep * (1.0 - total)
            solve_factored(A, 7, r)
            expand(X, points, r)
            reach, change, product = steps(X, points, t, r, keep)
            if settled:
                break
            if phase == 0:
                alpha = 1.0 / reach if reach > 1.0 else 1.0
                sigma = min(max((gap + alpha * (change + alpha * product)) / gap, 0.0), 1.0)
                sigma = sigma * sigma * sigma
                keep = 1.0 - sigma
                aim(X, points, r[CEILING], sigma * gap / (2.0 * n))
            else:
                alpha = min(STEP / reach, 1.0) if reach > 0.0 else 1.0
        if not settled:
            t += alpha * r[CEILING]
            for i in range(6):
                y[i] += alpha * r[i]
        advance(X, points, alpha)
        if settled:
            return True, relative, iterations - 1
