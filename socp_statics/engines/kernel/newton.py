"""The linear systems of one interior-point step, reduced to the unknowns and the multipliers of equality rows.

    [P  A'  G' ] [x]   [u]
    [A  .   .  ] [y] = [v]        G, z and w are scaled by W^-1, W, W^-1
    [G  .   -E ] [z]   [w]

``H = P + G' G = L D L'`` is sparse, ``A H^-1 A'`` is small and dense.
"""

from __future__ import annotations

from socp_statics.engines.kernel import layout as at
from socp_statics.engines.kernel.blocks import add_square, add_transposed, times
from socp_statics.engines.kernel.compilation import inner
from socp_statics.engines.kernel.layout import ONE, TWO
from socp_statics.engines.kernel.skyline import backward, factor, factor_dense, forward, forward_columns, solve_dense

# Pivots of the reduced matrix are not smaller than this share of their diagonal.
PIVOT_FLOOR = 1e-15
# A solution whose residual is larger than this share of its largest term is corrected.
GOOD_ENOUGH = 1e-8
TINY = 1e-300


@inner
def factor_step(W, F):
    """Scale G by the cones' scaling points and factor both matrices, in the workspace of the plan.

    Args:
        W: Integers of the plan.
        F: Reals of the plan.
    """
    k, e, H, Y, S, first, start = W[at.KEPT], W[at.EQUAL], W[at.H_AT], W[at.Y_AT], W[at.S_AT], W[at.FIRST], W[at.START]
    P, by_pivot, by_row_pivot = W[at.VECTORS_K] + at.CURVE * k, W[at.VECTORS_K] + at.BY_PIVOT * k, W[at.VECTORS_E] + at.BY_ROW_PIVOT * e
    for t in range(W[start + k]):
        F[H + t] = 0.0
    for i in range(k):
        F[H + W[start + i + ONE] - ONE] = F[P + i]
    add_square(W, F, W[at.VECTORS_M] + at.W * W[at.M])
    factor(W, first, start, k, F, H, by_pivot, F[W[at.SCALARS] + at.FLOOR])
    A, across, scaled = W[at.A_AT], Y + k * e, Y + TWO * k * e
    for a in range(e):
        for i in range(k):
            F[Y + i * e + a] = F[A + a * k + i]
    forward_columns(W, first, start, k, F, H, Y, e)
    for a in range(e):
        for i in range(k):
            value = F[Y + i * e + a]
            F[across + a * k + i] = value
            F[scaled + a * k + i] = value * F[by_pivot + i]
        for b in range(a + ONE):
            total = 0.0
            for i in range(k):
                total += F[scaled + a * k + i] * F[across + b * k + i]
            F[S + a * e + b] = total
    factor_dense(e, F, S, by_row_pivot, PIVOT_FLOOR)


@inner
def solve_step(W, F, u, v, w, x, y, z):
    """Solve for one right-hand side.

    Args:
        W: Integers of the plan.
        F: Reals of the plan, factored; the other arguments say where in it.
        u: First part of the right-hand side.
        v: Second part.
        w: Third part, scaled.
        x: Written.
        y: Written.
        z: Written, scaled.
    """
    k, e, m, A, H, Y, first, start = W[at.KEPT], W[at.EQUAL], W[at.M], W[at.A_AT], W[at.H_AT], W[at.Y_AT], W[at.FIRST], W[at.START]
    P, off_u, off_v = W[at.VECTORS_K] + at.CURVE * k, W[at.VECTORS_K] + at.OFF_U * k, W[at.VECTORS_E] + at.OFF_V * e
    by_pivot, by_row_pivot, G = W[at.VECTORS_K] + at.BY_PIVOT * k, W[at.VECTORS_E] + at.BY_ROW_PIVOT * e, W[at.SCALED]
    scaled = Y + TWO * k * e
    for i in range(k):
        F[x + i] = 0.0
        F[off_u + i] = F[u + i]
    for a in range(e):
        F[y + a] = 0.0
        F[off_v + a] = F[v + a]
    add_transposed(W, F, G, w, off_u)
    last, turn = 1e300, 0.0
    while True:
        # H x + A' y = off_u, A x = off_v, in place.
        forward(W, first, start, k, F, H, off_u)
        for a in range(e):
            total = -F[off_v + a]
            for i in range(k):
                total += F[scaled + a * k + i] * F[off_u + i]
            F[off_v + a] = total
        solve_dense(e, F, W[at.S_AT], by_row_pivot, off_v)
        for i in range(k):
            F[off_u + i] *= F[by_pivot + i]
        for a in range(e):
            value = F[off_v + a]
            for i in range(k):
                F[off_u + i] -= F[scaled + a * k + i] * value
        backward(W, first, start, k, F, H, off_u)
        for i in range(k):
            F[x + i] += F[off_u + i]
            F[off_u + i] = 0.0
        for a in range(e):
            F[y + a] += F[off_v + a]
        times(W, F, G, x, z)
        for i in range(m):
            F[z + i] -= F[w + i]
        if turn >= F[W[at.SCALARS] + at.CORRECTIONS]:
            break
        turn += 1.0
        add_transposed(W, F, G, z, off_u)
        worst, worst_v, scale, scale_v = 0.0, 0.0, TINY, TINY
        for i in range(k):
            xi = F[x + i]
            scale = max(scale, abs(F[u + i]), abs(F[off_u + i]))
            scale_v = max(scale_v, abs(xi))
            F[off_u + i] = F[u + i] - F[P + i] * xi - F[off_u + i]
        for a in range(e):
            total, value = F[v + a], F[y + a]
            for i in range(k):
                total -= F[A + a * k + i] * F[x + i]
                F[off_u + i] -= F[A + a * k + i] * value
            F[off_v + a] = total
            worst_v = max(worst_v, abs(total))
        for i in range(k):
            worst = max(worst, abs(F[off_u + i]))
        worst = max(worst / scale, worst_v / scale_v)
        if worst <= GOOD_ENOUGH or not worst < 0.5 * last:
            break
        last = worst
