"""The homogeneous embedding of a scaled program, its residuals and one step of the interior-point method.

    P x + A' y + G' z + q tau = 0        A x = b tau        G x + s = h tau
    x' P x / tau + q' x + b' y + h' z + kappa = 0        s, z in their cones, tau, kappa >= 0

With tau > 0 it is a solution, with tau = 0 a certificate (Goulart and Chen 2024). Functions take the two arrays of a `layout.Plan`.
"""

from __future__ import annotations

from socp_statics.engines.kernel import layout as at
from socp_statics.engines.kernel.blocks import add_transposed, times
from socp_statics.engines.kernel.compilation import inner
from socp_statics.engines.kernel.layout import THREE
from socp_statics.engines.kernel.newton import factor_step, solve_step
from socp_statics.engines.kernel.second_order import advance_all, correct_all, rate_of_all, scale_cones, unscale_all

# Share of the way to the boundary of the cones that a step may go.
TO_BOUNDARY = 0.99
# How much of the largest slack and of the largest multiplier counts as the size that a residual is compared with.
SHARE = 1e-2


@inner
def _dot(n, F, v, w):
    total = 0.0
    for i in range(n):
        total += F[v + i] * F[w + i]
    return total


@inner
def _most(n, F, v, w):
    """Largest size of v times w."""
    most = 0.0
    for i in range(n):
        most = max(most, abs(F[v + i] * F[w + i]))
    return most


@inner
def _largest(v):
    most = 0.0
    for i in range(len(v)):
        most = max(most, abs(v[i]))
    return most


@inner
def begin(W, F, q, b, h, constant):
    """Choose units of unknowns and of cost, and the first iterate; the transformed right-hand sides are in the plan.

    Args:
        W: Integers of the plan.
        F: Reals of the plan.
        q: Cost, shape (n,).
        b: Right-hand side of the equality rows, shape (p,).
        h: Right-hand side of the cone rows, shape (m,).
        constant: Constant of the objective.
    """
    k, e, m, orthant, t = W[at.KEPT], W[at.EQUAL], W[at.M], W[at.L], W[at.SCALARS]
    K, E, M = W[at.VECTORS_K], W[at.VECTORS_E], W[at.VECTORS_M]
    beta = 0.0
    for a in range(e):
        beta = max(beta, abs(F[E + at.LOAD * e + a]))
    if beta == 0.0:
        for i in range(m):
            beta = max(beta, abs(F[M + at.LIMIT * m + i]))
    if beta == 0.0:
        beta = 1.0
    gamma = 0.0
    for i in range(k):
        gamma = max(gamma, abs(F[K + at.COST * k + i]), beta * F[W[at.DIAGONAL] + i])
    if gamma == 0.0:
        gamma = 1.0
    for i in range(k):
        F[K + at.CURVE * k + i] = F[W[at.DIAGONAL] + i] * beta / gamma
        F[K + at.COST * k + i] /= gamma
        F[K + at.X * k + i] = 0.0
        F[K + at.UNIT_DUAL * k + i] = gamma / F[W[at.BY_COLUMN] + W[W[at.KEPT_AT] + i]]
    for a in range(e):
        F[E + at.LOAD * e + a] /= beta
        F[E + at.Y * e + a] = 0.0
        F[E + at.UNIT_EQUAL * e + a] = beta / F[W[at.BY_ROW] + W[W[at.ROW_AT] + W[at.PIVOTS] + a]]
    for i in range(m):
        F[M + at.LIMIT * m + i] /= beta
        F[M + at.S * m + i] = F[M + at.Z * m + i] = 1.0 if i < orthant else 0.0
        F[M + at.UNIT_CONE * m + i] = beta / F[W[at.BY_CONE] + i]
    for c in range(W[at.CONES]):
        a = W[W[at.CONE] + THREE * c]
        F[M + at.S * m + a] = F[M + at.Z * m + a] = 1.0
    F[t + at.TAU] = F[t + at.KAPPA] = 1.0
    F[t + at.UNIT_X], F[t + at.UNIT_COST], F[t + at.CONSTANT] = beta, gamma, constant
    F[t + at.DEGREE] = 1.0 + float(W[at.CONES])
    F[t + at.SIZE_B], F[t + at.SIZE_Q] = max(1.0, _largest(b), _largest(h)), max(1.0, _largest(q))


@inner
def measure(W, F):
    """Residuals of the current iterate, judged in the units of the data.

    Args:
        W: Integers of the plan.
        F: Reals of the plan; its residuals and scalars are written.

    Returns:
        Relative residual of the constraints, of the dual constraints, and relative gap; objective and dual objective.
    """
    k, e, m, t = W[at.KEPT], W[at.EQUAL], W[at.M], W[at.SCALARS]
    K, E, M, A = W[at.VECTORS_K], W[at.VECTORS_E], W[at.VECTORS_M], W[at.A_AT]
    x, y, s, z = K + at.X * k, E + at.Y * e, M + at.S * m, M + at.Z * m
    gz, r_dual, r_equal, r_cone = K + at.OFF_U * k, K + at.R_DUAL * k, E + at.R_EQUAL * e, M + at.R_CONE * m
    unit_dual, unit_equal, unit_cone = K + at.UNIT_DUAL * k, E + at.UNIT_EQUAL * e, M + at.UNIT_CONE * m
    tau = F[t + at.TAU]
    for i in range(k):
        F[gz + i] = 0.0
    add_transposed(W, F, W[at.VALUE], z, gz)
    size_gz, unmet, primal_off = _most(k, F, gz, unit_dual), 0.0, 0.0
    for a in range(e):
        total, value = 0.0, F[y + a]
        for i in range(k):
            total += F[A + a * k + i] * F[x + i]
            F[gz + i] += F[A + a * k + i] * value
        off, unit = total - F[E + at.LOAD * e + a] * tau, F[unit_equal + a]
        unmet = max(unmet, abs(total * unit))
        primal_off = max(primal_off, abs(off * unit))
        F[r_equal + a] = off
    curved, unbalanced, px, dual_off = 0.0, 0.0, 0.0, 0.0
    for i in range(k):
        total, unit = F[gz + i], F[unit_dual + i]
        part = F[K + at.CURVE * k + i] * F[x + i]
        off = total + part + F[K + at.COST * k + i] * tau
        curved += part * F[x + i]
        unbalanced = max(unbalanced, abs(total * unit))
        px = max(px, abs(part * unit))
        dual_off = max(dual_off, abs(off * unit))
        F[r_dual + i] = off
    times(W, F, W[at.VALUE], x, r_cone)
    size_s = 0.0
    for i in range(m):
        total, unit = F[r_cone + i] + F[s + i], F[unit_cone + i]
        off = total - F[M + at.LIMIT * m + i] * tau
        unmet = max(unmet, abs(total * unit))
        size_s = max(size_s, abs(F[s + i] * unit))
        primal_off = max(primal_off, abs(off * unit))
        F[r_cone + i] = off
    qx = _dot(k, F, K + at.COST * k, x)
    loads = _dot(e, F, E + at.LOAD * e, y) + _dot(m, F, M + at.LIMIT * m, z)
    beta, gamma = F[t + at.UNIT_X], F[t + at.UNIT_COST]
    F[t + at.LOAD_VALUE], F[t + at.COST_VALUE] = loads, qx
    F[t + at.UNBALANCED] = unbalanced * max(1.0, beta) / (beta * gamma)
    F[t + at.UNMET] = max(px * max(1.0, beta), unmet * max(1.0, gamma)) / (beta * gamma)
    primal = beta * gamma * (0.5 * curved / tau + qx) / tau + F[t + at.CONSTANT]
    dual = -beta * gamma * (0.5 * curved / tau + loads) / tau + F[t + at.CONSTANT]
    primal_off /= max(tau * F[t + at.SIZE_B], SHARE * size_s)
    dual_off /= max(tau * F[t + at.SIZE_Q], SHARE * size_gz, px)
    return primal_off, dual_off, abs(primal - dual) / (1.0 + min(abs(primal), abs(dual))), primal, dual


@inner
def advance(W, F):
    """One predictor and corrector step from the iterate that was measured.

    Args:
        W: Integers of the plan.
        F: Reals of the plan, updated.
    """
    k, e, m, orthant, t = W[at.KEPT], W[at.EQUAL], W[at.M], W[at.L], W[at.SCALARS]
    K, E, M, run, runs, eta = W[at.VECTORS_K], W[at.VECTORS_E], W[at.VECTORS_M], W[at.RUN], W[at.RUNS], W[at.ETA]
    s, z, w, lam, ds, dz = M + at.S * m, M + at.Z * m, M + at.W * m, M + at.LAMBDA * m, M + at.DS * m, M + at.DZ * m
    u, v, target, r_scaled = K + at.U_SIDE * k, E + at.V_SIDE * e, M + at.W_SIDE * m, M + at.R_SCALED * m
    x, x1, x2, y1, y2 = K + at.X * k, K + at.X_STEP * k, K + at.X_FIXED * k, E + at.Y_STEP * e, E + at.Y_FIXED * e
    z1, z2, tau, kappa = M + at.Z_STEP * m, M + at.Z_FIXED * m, F[t + at.TAU], F[t + at.KAPPA]
    scale_cones(W, run, runs, orthant, F, s, z, w, lam, eta)
    factor_step(W, F)
    unscale_all(W, run, runs, orthant, F, w, eta, M + at.R_CONE * m, r_scaled)

    # The direction along the right-hand sides is the iterate and a correction as small as the residuals: solved for as a whole, its
    # multipliers would be differences of large numbers.
    for i in range(k):
        F[u + i] = -F[K + at.R_DUAL * k + i]
    for a in range(e):
        F[v + a] = -F[E + at.R_EQUAL * e + a]
    for i in range(m):
        F[target + i] = 2.0 * F[lam + i] - F[r_scaled + i]
    solve_step(W, F, u, v, target, x2, y2, z2)
    slope, square = kappa / tau, 0.0
    for i in range(k):
        part = F[x2 + i] / tau
        slope += F[K + at.CURVE * k + i] * part * part
        F[x2 + i] = F[x + i] / tau + part
    for a in range(e):
        F[y2 + a] = (F[E + at.Y * e + a] + F[y2 + a]) / tau
    for i in range(m):
        F[z2 + i] = (F[lam + i] + F[z2 + i]) / tau
        slope += F[z2 + i] * F[z2 + i]
        square += F[lam + i] * F[lam + i]
        F[ds + i] = F[lam + i]

    # The predictor aims at the solution itself.
    rest, mu, product = 1.0, (square + tau * kappa) / F[t + at.DEGREE], tau * kappa
    d_tau, d_kappa, rate = 0.0, 0.0, 0.0
    for turn in range(2):
        fall = rest * (square + tau * kappa) - product
        for i in range(m):
            F[target + i] = F[ds + i] - rest * F[r_scaled + i]
            fall -= F[lam + i] * F[ds + i]
        for i in range(k):
            F[u + i] = -rest * F[K + at.R_DUAL * k + i]
        for a in range(e):
            F[v + a] = -rest * F[E + at.R_EQUAL * e + a]
        solve_step(W, F, u, v, target, x1, y1, z1)
        fall += _dot(k, F, K + at.R_DUAL * k, x1) - _dot(e, F, E + at.R_EQUAL * e, y1) - _dot(m, F, r_scaled, z1)
        d_tau = fall / (slope * tau)
        d_kappa = -(product + kappa * d_tau) / tau
        for i in range(m):
            F[dz + i] = F[z1 + i] + d_tau * F[z2 + i]
            F[ds + i] = -F[ds + i] - F[dz + i]
        rate = max(rate_of_all(W, run, runs, orthant, F, lam, ds, dz), -d_tau / tau, -d_kappa / kappa)
        if turn == 0:
            # The corrector aims as far as the predictor could go, and at what its second order would have missed.
            step = 1.0 / max(rate, 1.0)
            sigma = (1.0 - step) * (1.0 - step) * (1.0 - step)
            rest = 1.0 - sigma
            product += d_tau * d_kappa - sigma * mu
            correct_all(W, run, runs, orthant, F, lam, ds, dz, sigma * mu, ds)
    step = TO_BOUNDARY / max(rate, TO_BOUNDARY)
    for i in range(k):
        F[x1 + i] += d_tau * F[x2 + i]
        F[x + i] += step * F[x1 + i]
    # Slacks follow the unknowns: by way of the scaled space they would lose as many digits as the scaling has.
    times(W, F, W[at.VALUE], x1, ds)
    for i in range(m):
        F[s + i] += step * (F[M + at.LIMIT * m + i] * d_tau - F[ds + i] - rest * F[M + at.R_CONE * m + i])
    advance_all(W, run, runs, orthant, F, w, eta, step, dz, z)
    for a in range(e):
        F[E + at.Y * e + a] += step * (F[y1 + a] + d_tau * F[y2 + a])
    F[t + at.TAU] += step * d_tau
    F[t + at.KAPPA] += step * d_kappa
