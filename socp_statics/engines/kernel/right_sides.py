"""Right-hand sides into the scaled space of a plan, and solutions and certificates back from it."""

from __future__ import annotations

from socp_statics.engines.kernel import layout as at
from socp_statics.engines.kernel.compilation import inner
from socp_statics.engines.kernel.layout import ONE

# Rows that repeat others agree with them, and cost along unseen directions is none, to this share of what they are made of.
CONSISTENT = 1e-9

NORMAL, CONTRADICTION, FREE_DESCENT = 0, 1, 2


@inner
def _express_free(W, F, load, x, values):
    """The free unknowns that pivot rows express, by back substitution: ``U values = load b - B x``.

    Args:
        W: Integers of the plan.
        F: Reals of the plan, the transformed b at its VECTORS_P; the other arguments say where in it.
        load: 1 for a solution, 0 for a direction.
        x: Kept unknowns, scaled.
        values: All unknowns by original index, scaled; those without a pivot row are given, the others written.
    """
    k, rank, lost, U, B = W[at.KEPT], W[at.PIVOTS], W[at.FREE], W[at.U_AT], W[at.B_AT]
    for t in range(rank):
        F[values + W[W[at.FREE_AT] + W[W[at.PIVOT_AT] + t]]] = 0.0
    for turn in range(rank):
        t = rank - ONE - turn
        total = load * F[W[at.VECTORS_P] + t]
        for i in range(k):
            total -= F[B + t * k + i] * F[x + i]
        for f in range(lost):
            total -= F[U + t * lost + f] * F[values + W[W[at.FREE_AT] + f]]
        which = W[W[at.PIVOT_AT] + t]
        F[values + W[W[at.FREE_AT] + which]] = total / F[U + t * lost + which]


@inner
def _leave_unknowns(W, F, values, x):
    """Scaled unknowns by original index into their own columns and units."""
    n, share, first = W[at.N], W[at.SHARE], W[at.FREE_AT] + W[at.FREE] - W[at.SHARED]
    for turn in range(W[at.SHARED]):
        d = W[at.SHARED] - ONE - turn
        weight = F[values + W[first + d]]
        for j in range(n):
            F[values + j] -= F[share + d * n + j] * weight
    for j in range(n):
        x[j] = F[W[at.BY_COLUMN] + j] * F[values + j]


@inner
def _enter_rows(W, F, b):
    """Transform the right-hand side of the equality rows into VECTORS_P; whether repeated rows agree.

    If they do not, the multipliers that show it follow there.
    """
    p, expected, values, mix = W[at.P], W[at.PIVOTS] + W[at.EQUAL], W[at.VECTORS_P], W[at.MIX]
    if W[at.PIVOTS] == 0 and expected == p:
        for j in range(p):
            F[values + j] = F[W[at.BY_ROW] + j] * b[j]
        return True
    for i in range(p):
        row = mix + W[W[at.ROW_AT] + i] * p
        total, scale = 0.0, 0.0
        for j in range(p):
            part = F[row + j] * F[W[at.BY_ROW] + j] * b[j]
            total += part
            scale = max(scale, abs(part))
        F[values + i] = total
        if i >= expected and abs(total) > CONSISTENT * scale:
            for j in range(p):
                F[values + p + j] = -F[W[at.BY_ROW] + j] * F[row + j] / total
            return False
    return True


@inner
def _enter_cost(W, F, q):
    """Transform the cost into VECTORS_N; multipliers of the pivot rows follow b.

    The result is the index of a free unknown that lowers the cost, or their number.
    """
    n, rank, lost, U = W[at.N], W[at.PIVOTS], W[at.FREE], W[at.U_AT]
    cost, multiplier, share, first = W[at.VECTORS_N], W[at.VECTORS_P] + W[at.P], W[at.SHARE], W[at.FREE_AT] + lost - W[at.SHARED]
    for j in range(n):
        F[cost + j] = F[W[at.BY_COLUMN] + j] * q[j]
    for d in range(W[at.SHARED]):
        for j in range(n):
            F[cost + W[first + d]] -= F[share + d * n + j] * F[cost + j]
    for t in range(rank):
        which = W[W[at.PIVOT_AT] + t]
        total = -F[cost + W[W[at.FREE_AT] + which]]
        for i in range(t):
            total -= F[U + i * lost + which] * F[multiplier + i]
        F[multiplier + t] = total / F[U + t * lost + which]
    if rank == lost:
        return lost
    for f in range(lost):
        expressed = False
        for t in range(rank):
            expressed |= W[W[at.PIVOT_AT] + t] == f
        total = F[cost + W[W[at.FREE_AT] + f]]
        scale = abs(total)
        for t in range(rank):
            part = F[U + t * lost + f] * F[multiplier + t]
            total += part
            scale = max(scale, abs(part))
        if not expressed and abs(total) > CONSISTENT * scale:
            return f
    return lost


@inner
def enter(W, F, q, b, h, q_in, b_in, h_in):
    """Transform right-hand sides.

    Args:
        W: Integers of the plan.
        F: Reals of the plan.
        q: Cost, shape (n,).
        b: Right-hand side of the equality rows, shape (p,).
        h: Right-hand side of the cone rows, shape (m,).
        q_in: Where in F the scaled cost of the kept unknowns is written.
        b_in: Where the scaled right-hand side of the kept rows is written.
        h_in: Where the scaled h is written.

    Returns:
        NORMAL; CONTRADICTION where rows that repeat others contradict them; FREE_DESCENT where the cost falls along unknowns that no
        cone sees. With it, the constant of the objective.
    """
    k, e, rank, values = W[at.KEPT], W[at.EQUAL], W[at.PIVOTS], W[at.VECTORS_P]
    multiplier = values + W[at.P]
    if not _enter_rows(W, F, b):
        return CONTRADICTION, 0.0
    f = _enter_cost(W, F, q)
    if f < W[at.FREE]:
        n, direction = W[at.N], W[at.VECTORS_N] + W[at.N]
        for j in range(n):
            F[direction + j] = 0.0
        for i in range(k):
            F[q_in + i] = 0.0
        F[direction + W[W[at.FREE_AT] + f]] = 1.0
        _express_free(W, F, 0.0, q_in, direction)
        return FREE_DESCENT, 0.0
    for i in range(W[at.M]):
        F[h_in + i] = F[W[at.BY_CONE] + i] * h[i]
    for a in range(e):
        F[b_in + a] = F[values + rank + a]
    constant = 0.0
    for i in range(k):
        F[q_in + i] = F[W[at.VECTORS_N] + W[W[at.KEPT_AT] + i]]
    for t in range(rank):
        constant -= F[multiplier + t] * F[values + t]
        for i in range(k):
            F[q_in + i] += F[W[at.B_AT] + t * k + i] * F[multiplier + t]
    return NORMAL, constant


@inner
def leave_primal(W, F, load, scale, x_in, s_in, x, s):
    """Unknowns and slacks of a solution, or of a direction.

    Args:
        W: Integers of the plan.
        F: Reals of the plan.
        load: 1 for a solution, 0 for a direction.
        scale: Factor of x_in and s_in.
        x_in: Where in F the kept unknowns are; they are scaled in place.
        s_in: Where the slacks are.
        x: Written, shape (n,).
        s: Written, shape (m,).
    """
    values = W[at.VECTORS_N] + W[at.N]
    for j in range(W[at.N]):
        F[values + j] = 0.0
    for i in range(W[at.KEPT]):
        F[x_in + i] *= scale
        F[values + W[W[at.KEPT_AT] + i]] = F[x_in + i]
    _express_free(W, F, load, x_in, values)
    _leave_unknowns(W, F, values, x)
    for i in range(W[at.M]):
        s[i] = scale * F[s_in + i] / F[W[at.BY_CONE] + i]


@inner
def leave_dual(W, F, load, scale, y_in, z_in, y, z):
    """Multipliers of a solution (load 1) or of a certificate (load 0); otherwise as `leave_primal`, y has shape (p,), z (m,)."""
    p, rank, e, multiplier = W[at.P], W[at.PIVOTS], W[at.EQUAL], W[at.VECTORS_P] + W[at.P]
    y[:] = 0.0
    for i in range(rank + e):
        weight = load * F[multiplier + i] if i < rank else scale * F[y_in + i - rank]
        row = W[at.MIX] + W[W[at.ROW_AT] + i] * p
        for j in range(p):
            y[j] += weight * F[row + j]
    for j in range(p):
        y[j] *= F[W[at.BY_ROW] + j]
    for i in range(W[at.M]):
        z[i] = scale * F[z_in + i] * F[W[at.BY_CONE] + i]


@inner
def leave_contradiction(W, F, y):
    """Multipliers of equality rows that contradict each other, ``b' y = -1``."""
    for j in range(W[at.P]):
        y[j] = F[W[at.VECTORS_P] + W[at.P] + j]


@inner
def leave_descent(W, F, q, x):
    """Direction of the unknowns that no cone sees along which the cost falls, ``q' x = -1``."""
    _leave_unknowns(W, F, W[at.VECTORS_N] + W[at.N], x)
    cost = 0.0
    for j in range(len(x)):
        cost += q[j] * x[j]
    for j in range(len(x)):
        x[j] /= -cost
