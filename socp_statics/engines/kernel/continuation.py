"""The next vertex from its neighbour: Newton's method on the optimality conditions with a known set of loaded contacts.

A contact at an optimum is free (no force), at rest (its slack is zero, any force in the cone) or slides (slack and force on the
boundary, the force ``t (1, -u)`` against the sliding direction u). Where two neighbours agree about every contact, a few Newton
steps from their combination give motion and forces. The result counts only if every force and every slack lies in its cone: then
it is an optimum, wherever the steps came from.
"""

from __future__ import annotations

import math

from socp_statics.engines.kernel.compilation import inner
from socp_statics.engines.kernel.lanes import MULTIPLIER, RHS, RHS_X, RHS_Y, ROW1, ROW2, S2, S3, SLACK, S, U, lane
from socp_statics.engines.kernel.supports import BOUND, CX, CY, DX, DY

FREE, RESTS, SLIDES = 0, 1, 2
MOST_STEPS = 6
MOST_ROWS = 7
SIZE = 4 + MOST_ROWS
CONVERGED = 1e-12
HOLDS = 1e-11
SINGULAR = 1e-9
CLEAR = 1e-3


@inner
def classify(X, cones, points, states):
    """What each contact does at an interior-point solution, written; False where that is not clear."""
    for k in range(cones):
        a = lane(k)
        s0, s1, s2 = X[a + SLACK], X[a + SLACK + S], X[a + SLACK + S2]
        z0, z1, z2 = X[a + MULTIPLIER], X[a + MULTIPLIER + S], X[a + MULTIPLIER + S2]
        st, zt = math.hypot(s1, s2), math.hypot(z1, z2)
        if z0 + zt < CLEAR * (s0 - st):
            states[k] = FREE
        elif s0 + st < CLEAR * (z0 - zt):
            states[k] = RESTS if points[k, 12] > 0.0 else SLIDES
        elif s0 - st < CLEAR * (z0 + zt) and z0 - zt < CLEAR * (s0 + st):
            states[k] = SLIDES
        else:
            return False
    return True


@inner
def _eliminate(K, n):
    """Solve K x = b in place, b in the last column, by elimination with row pivoting; False where K is singular."""
    for j in range(n):
        pivot = j
        for i in range(j + 1, n):
            if abs(K[i, j]) > abs(K[pivot, j]):
                pivot = i
        if not abs(K[pivot, j]) > SINGULAR:
            return False
        if pivot != j:
            for c in range(j, n + 1):
                K[j, c], K[pivot, c] = K[pivot, c], K[j, c]
        inverse = 1.0 / K[j, j]
        for i in range(j + 1, n):
            share = K[i, j] * inverse
            if share != 0.0:
                for c in range(j + 1, n + 1):
                    K[i, c] -= share * K[j, c]
    for i in range(n - 1, -1, -1):
        value = K[i, n]
        for c in range(i + 1, n):
            value -= K[i, c] * K[c, n]
        K[i, n] = value / K[i, i]
    return True


@inner
def _slack(X, a, y):
    """``h - G y`` of one cone."""
    b, c = a + ROW1, a + ROW2
    s0 = X[a + RHS] - X[a] * y[0] - X[a + S] * y[1] - X[a + S2] * y[2] - X[a + S3] * y[3]
    s1 = X[a + RHS + S] - X[b] * y[0] - X[b + S] * y[1] - X[b + S2] * y[2] - X[b + S3] * y[3]
    s2 = X[a + RHS + S2] - X[c] * y[0] - X[c + S] * y[1] - X[c + S2] * y[2] - X[c + S3] * y[3]
    return s0, s1, s2


@inner
def _newton_system(X, q, active, states, count, y, kept, K, n):
    """Matrix and right-hand side of one step; returns the largest residual."""
    for i in range(n):
        for j in range(n + 1):
            K[i, j] = 0.0
    for j in range(4):
        K[j, n] = -q[j]
    worst, row = 0.0, 4
    for i in range(count):
        k = active[i]
        a = lane(k)
        s0, s1, s2 = _slack(X, a, y)
        if states[k] == RESTS:
            for c in range(3):
                slack = s0 if c == 0 else s1 if c == 1 else s2
                for j in range(4):
                    g = X[a + U(5 * c + j) * S]
                    K[row, j] = K[j, row] = g
                    K[j, n] -= g * kept[3 * k + c]
                K[row, n] = slack
                worst = max(worst, abs(slack))
                row += 1
            continue
        length = math.hypot(s1, s2)
        u1, u2 = (s1 / length, s2 / length) if length > 0.0 else (0.0, 0.0)
        t = kept[3 * k]
        kept[3 * k + 1], kept[3 * k + 2] = -t * u1, -t * u2
        bend = t / length if length > 0.0 else 0.0
        for j in range(4):
            g = X[a + U(j) * S] - u1 * X[a + U(5 + j) * S] - u2 * X[a + U(10 + j) * S]
            K[row, j] = K[j, row] = g
            K[j, n] -= t * g
            across = u1 * X[a + U(10 + j) * S] - u2 * X[a + U(5 + j) * S]
            for i2 in range(4):
                K[j, i2] += bend * across * (u1 * X[a + U(10 + i2) * S] - u2 * X[a + U(5 + i2) * S])
        K[row, n] = s0 - length
        worst = max(worst, abs(s0 - length))
        row += 1
    for j in range(4):
        worst = max(worst, abs(K[j, n]))
    return worst


@inner
def continued(X, cones, q, reference, dx, dy, states, active, K, node, y, kept):
    """Try to get the support of a direction from two neighbours with the same loaded contacts.

    Args:
        X: Buffer of the cones with the direction set.
        cones: Number of cones.
        q: Cost, shape (5,).
        reference: Position without contact forces, shape (2,).
        dx: First coordinate of the unit direction.
        dy: Second coordinate.
        states: What each contact does at the neighbours, shape (cones,).
        active: Scratch, shape (cones,).
        K: Scratch, shape (SIZE, SIZE + 1).
        node: Written where it succeeds, as by `supports.support`.
        y: The motion: where to start, then the answer.
        kept: The forces, likewise.

    Returns:
        Whether it succeeded.
    """
    count, n = 0, 4
    for k in range(cones):
        if states[k] == FREE:
            kept[3 * k], kept[3 * k + 1], kept[3 * k + 2] = 0.0, 0.0, 0.0
        else:
            active[count] = k
            count += 1
            n += 3 if states[k] == RESTS else 1
            if n > SIZE:
                return False
    # With one force the motion is not unique: its closed form is better.
    if count < 2:
        return False
    settled = False
    for _ in range(MOST_STEPS):
        worst = _newton_system(X, q, active, states, count, y, kept, K, n)
        if worst <= CONVERGED:
            settled = True
            break
        if not _eliminate(K, n):
            return False
        for j in range(4):
            y[j] += K[j, n]
        row = 4
        for i in range(count):
            k = active[i]
            for c in range(3 if states[k] == RESTS else 1):
                kept[3 * k + c] += K[row, n]
                row += 1
    if not settled:
        return False
    x, z = reference[0], reference[1]
    for i in range(count):
        k = active[i]
        z0, z1, z2 = kept[3 * k], kept[3 * k + 1], kept[3 * k + 2]
        if not z0 - math.hypot(z1, z2) >= -HOLDS or z0 < 0.0:
            return False
        a = lane(k)
        x -= X[a + RHS_X] * z0 + X[a + RHS_X + S] * z1 + X[a + RHS_X + S2] * z2
        z -= X[a + RHS_Y] * z0 + X[a + RHS_Y + S] * z1 + X[a + RHS_Y + S2] * z2
    for k in range(cones):
        s0, s1, s2 = _slack(X, lane(k), y)
        if not s0 - math.hypot(s1, s2) >= -HOLDS:
            return False
    bound = dx * reference[0] + dy * reference[1] + q[0] * y[0] + q[1] * y[1] + q[2] * y[2] + q[3] * y[3]
    node[DX], node[DY], node[CX], node[CY], node[BOUND] = dx, dy, x, z, max(bound, dx * x + dy * z)
    return True
