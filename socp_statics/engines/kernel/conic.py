"""Second-order cone programs with a diagonal quadratic cost, of a few to a few dozen unknowns.

    minimise 1/2 x' P x + q' x   subject to   A x = b,   G x + s = h,   s in R+^l x second-order cones

A primal-dual interior-point method with Nesterov-Todd scaling and Mehrotra's corrector (Mehrotra 1992, Nesterov and Todd 1997) on the
homogeneous embedding of a program with quadratic cost (Goulart and Chen 2024), so that infeasible and unbounded programs end with
certificates.

Compiled code prepares a program once and solves it for many right-hand sides:

    start, column, value = sparse_rows(G)
    W, F = plan_rows(P, A, start, column, value, orthant, soc)
    status, steps = solve_plan(W, F, q, b, h, ITERATIONS, x, y, z, s)
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from socp_statics.engines.kernel import layout as at
from socp_statics.engines.kernel.compilation import entry, inner
from socp_statics.engines.kernel.embedding import advance, begin, measure
from socp_statics.engines.kernel.plan import plan_rows
from socp_statics.engines.kernel.right_sides import (
    CONTRADICTION,
    FREE_DESCENT,
    NORMAL,
    enter,
    leave_contradiction,
    leave_descent,
    leave_dual,
    leave_primal,
)

SOLVED, INFEASIBLE, UNBOUNDED, ITERATION_LIMIT, STALLED = range(5)

AIM = 1e-10
ACCEPTED = 1e-8
CERTIFIED = 1e-9
ITERATIONS = 100
# Directions are corrected where the iterate is as close as this; farther away rounding does no harm.
CLOSE = 1e-5
# Steps without a better iterate after which nothing better is expected: of an answer that is not good enough, and of one that is.
PATIENCE, ENOUGH = 10, 3
# Least pivots of the largest matrix as shares of its diagonal, one after the other.
FLOORS = (1e-13, 1e-12, 1e-15)


@inner
def _keep(W, F, primal, dual):
    """Keep the current iterate and its two objectives."""
    k, e, m, t = W[at.KEPT], W[at.EQUAL], W[at.M], W[at.SCALARS]
    F[t + at.PRIMAL], F[t + at.DUAL], F[t + at.BEST_TAU] = primal, dual, F[t + at.TAU]
    K, E, M = W[at.VECTORS_K], W[at.VECTORS_E], W[at.VECTORS_M]
    for i in range(k):
        F[K + at.BEST_X * k + i] = F[K + at.X * k + i]
    for i in range(e):
        F[E + at.BEST_Y * e + i] = F[E + at.Y * e + i]
    for i in range(m):
        F[M + at.BEST_S * m + i] = F[M + at.S * m + i]
        F[M + at.BEST_Z * m + i] = F[M + at.Z * m + i]


@inner
def solve_plan(W, F, q, b, h, limit, x, y, z, s):
    """Solve a prepared program for one set of right-hand sides.

    Args:
        W: Integers of the plan, from `plan.plan_rows`.
        F: Reals of the plan; its workspace is overwritten.
        q: Cost, shape (n,).
        b: Right-hand side of the equality rows, shape (p,).
        h: Right-hand side of the cone rows, shape (m,).
        limit: Largest number of steps, ITERATIONS as a rule.
        x: Unknowns, written, shape (n,).
        y: Multipliers of the equality rows, written, shape (p,).
        z: Multipliers of the cone rows, inside their cones, written, shape (m,).
        s: Slacks, inside their cones, written, shape (m,).

    Returns:
        Status and number of steps. SOLVED: ``P x + q + A' y + G' z = 0``, ``A x = b``, ``G x + s = h`` and the gap hold to AIM, or to
        ACCEPTED where rounding allows no more. INFEASIBLE: y and z with ``A' y + G' z = 0`` and ``b' y + h' z = -1``, x and s zero.
        UNBOUNDED: x and s with ``P x = 0``, ``A x = 0``, ``G x + s = 0`` and ``q' x = -1``, y and z zero. ITERATION_LIMIT and STALLED:
        the best iterate and the last one, which are no answers. `objective` and `bound` tell the values of the two objectives.
    """
    k, e, m, t = W[at.KEPT], W[at.EQUAL], W[at.M], W[at.SCALARS]
    K, E, M = W[at.VECTORS_K], W[at.VECTORS_E], W[at.VECTORS_M]
    x[:] = 0.0
    y[:] = 0.0
    z[:] = 0.0
    s[:] = 0.0
    status, steps, attempt, outcome = STALLED, 0, 0, NORMAL
    worst, primal, dual = 1e300, 0.0, 0.0
    # What one floor of the pivots loses in rounding, another hardly ever does.
    while status == STALLED and attempt < len(FLOORS):
        outcome, constant = enter(W, F, q, b, h, K + at.COST * k, E + at.LOAD * e, M + at.LIMIT * m)
        if outcome != NORMAL:
            break
        begin(W, F, q, b, h, constant)
        F[t + at.FLOOR] = FLOORS[attempt]
        attempt += 1
        best, nearest, waited = 1e300, 1e300, 0
        while True:
            primal_off, dual_off, gap, primal, dual = measure(W, F)
            worst = max(primal_off, dual_off, gap)
            if worst < best:
                best = worst
                _keep(W, F, primal, dual)
            # What is left over of a certificate of size 1.
            unbalanced = F[t + at.UNBALANCED] / -F[t + at.LOAD_VALUE] if F[t + at.LOAD_VALUE] < 0.0 else 1e300
            unmet = F[t + at.UNMET] / -F[t + at.COST_VALUE] if F[t + at.COST_VALUE] < 0.0 else 1e300
            waited += 1
            if min(worst, unbalanced, unmet) < 0.9 * nearest:
                nearest = min(worst, unbalanced, unmet)
                waited = 0
            if worst <= AIM:
                status = SOLVED
            elif unbalanced <= CERTIFIED:
                status = INFEASIBLE
            elif unmet <= CERTIFIED:
                status = UNBOUNDED
            elif steps >= limit or waited > (PATIENCE if best > ACCEPTED else ENOUGH):
                status = SOLVED if best <= ACCEPTED else (ITERATION_LIMIT if steps >= limit else STALLED)
            else:
                F[t + at.CORRECTIONS] = 6.0 if nearest < CLOSE else 0.0
                advance(W, F)
                steps += 1
                continue
            break
    if status == STALLED and outcome == NORMAL and worst < 1e300:
        # Nearer to the end than the best one: where sets have hardly any interior residuals rise before multipliers are large enough.
        _keep(W, F, primal, dual)
    if outcome == CONTRADICTION:
        status = INFEASIBLE
        leave_contradiction(W, F, y)
    elif outcome == FREE_DESCENT:
        status = UNBOUNDED
        leave_descent(W, F, q, x)
    else:
        beta, gamma = F[t + at.UNIT_X], F[t + at.UNIT_COST]
        if status == INFEASIBLE:
            leave_dual(W, F, 0.0, -1.0 / (beta * F[t + at.LOAD_VALUE]), E + at.Y * e, M + at.Z * m, y, z)
        elif status == UNBOUNDED:
            leave_primal(W, F, 0.0, -1.0 / (gamma * F[t + at.COST_VALUE]), K + at.X * k, M + at.S * m, x, s)
        else:
            leave_primal(W, F, 1.0, beta / F[t + at.BEST_TAU], K + at.BEST_X * k, M + at.BEST_S * m, x, s)
            leave_dual(W, F, 1.0, gamma / F[t + at.BEST_TAU], E + at.BEST_Y * e, M + at.BEST_Z * m, y, z)
    return status, steps


@inner
def objective(W, F):
    """Objective of the last solution."""
    return F[W[at.SCALARS] + at.PRIMAL]


@inner
def bound(W, F):
    """Dual objective of the last solution: no feasible point is better."""
    return F[W[at.SCALARS] + at.DUAL]


def values(W: NDArray[np.uint64], F: NDArray[np.float64]) -> tuple[float, float]:
    """Objective and dual objective of the last solution, for Python."""
    begin = int(W[at.SCALARS])
    return float(F[begin + int(at.PRIMAL)]), float(F[begin + int(at.DUAL)])


# For Python: the same two functions. An entry made of a function is compiled once less than one that calls it.
prepare = entry(
    "Tuple((uint64[::1], float64[::1]))(float64[::1], float64[:, ::1], int64[::1], int64[::1], float64[::1], int64, int64[::1])"
)(getattr(plan_rows, "py_func", plan_rows))


solve = entry(
    "UniTuple(int64, 2)(uint64[::1], float64[::1], float64[::1], float64[::1], float64[::1], int64, "
    "float64[::1], float64[::1], float64[::1], float64[::1])"
)(getattr(solve_plan, "py_func", solve_plan))
