"""Newton's method on the optimality conditions of a program with five unknowns, its cones met by projection.

Slack ``s`` and multiplier ``z`` of a contact are complementary exactly if ``z`` is the projection of ``w = z - s`` onto the cone: w
inside means a contact at rest (no slack, any force in the cone), inside the negative of the cone one that is free (no force),
elsewhere one that slides (slack and force on the boundary, the force ``t (1, u)`` against the sliding direction). Newton's
method on that equation and on ``G' z + q = 0`` (semismooth: Qi and Sun, "A nonsmooth version of Newton's method", 1993) needs no guess of
what every contact does, and changes its mind at every step. A step of the multipliers costs DAMPING times its square, so that only
the 5 x 5 matrix of the unknowns is factored and forces that are not unique do no harm. Where it converges the result is an optimum,
wherever the steps came from.
"""

from __future__ import annotations

import math

from socp_statics.engines.kernel.compilation import inner
from socp_statics.engines.kernel.lanes import RHS, ROW1, ROW2, S2, S3, S4, S, U, lane, row
from socp_statics.engines.kernel.normal_matrix import factor, solve_factored

# Steps need not bring the residual down every time while contacts change their minds.
MOST_STEPS, PATIENCE = 20, 6
CONVERGED = 1e-12
# Residuals of a start that is worth following are not larger than this.
FAR = 10.0
# A step that leaves more than this share of the least residual so far tries the patience.
SLOW = 0.7
# Price of a step of the multipliers: the residual, between these. Where more contacts slide or rest than there are unknowns, a low price
# lets forces grow without bound; far from the optimum a high one keeps them.
DAMPING, DAMPED = 1e-7, 0.03
# Numbers of a row of the equations: five coefficients, right-hand side, weight in the normal equations (HARD: 1 over the price), and for a
# contact that slides the direction of its force.
OFF, WEIGHT, TURN = 5, 6, 7
EQUATION = 9
HARD = -1.0


@inner
def slack(X, a, y):
    """``h - G y`` of one cone."""
    y0, y1, y2, y3, y4 = y[0], y[1], y[2], y[3], y[4]
    return (
        X[a + RHS] - row(X, a, y0, y1, y2, y3, y4),
        X[a + RHS + S] - row(X, a + ROW1, y0, y1, y2, y3, y4),
        X[a + RHS + S2] - row(X, a + ROW2, y0, y1, y2, y3, y4),
    )


@inner(inline="always")
def _linearised(X, cones, points, q, rows, equations, y, kept):
    """The equations of every loaded contact at an iterate.

    Args:
        X: Buffer of the cones with its right-hand sides.
        cones: Number of cones.
        points: Shape (n, 14).
        q: Cost, shape (5,).
        rows: Written: how many equations each contact has, shape (cones,).
        equations: Written: rows ``g dy = off`` with their weights, shape (3 * cones, EQUATION).
        y: The unknowns.
        kept: The multipliers; what a step would take from them whatever its length is taken from them now.

    Returns:
        Number of equations, largest residual, what residuals may be worth in the cost, and the residual of ``G' z + q = 0``.
    """
    e, worst, carried = 0, 0.0, 0.0
    b0, b1, b2, b3, b4 = q[0], q[1], q[2], q[3], q[4]
    for k in range(cones):
        a = lane(k)
        s0, s1, s2 = slack(X, a, y)
        z0, z1, z2 = kept[3 * k], kept[3 * k + 1], kept[3 * k + 2]
        w0, w1, w2 = z0 - s0, z1 - s1, z2 - s2
        length = math.sqrt(w1 * w1 + w2 * w2)
        if w0 + length <= 0.0:
            rows[k] = 0
            worst = max(worst, abs(z0), abs(z1), abs(z2))
            kept[3 * k] = kept[3 * k + 1] = kept[3 * k + 2] = 0.0
            continue
        if points[k, 12] == 0.0:
            rows[k] = 1
            for j in range(5):
                equations[e, j] = X[a + U(j) * S]
            equations[e, OFF], equations[e, WEIGHT] = s0, HARD
            worst = max(worst, abs(s0))
        elif w0 >= length:
            rows[k] = 3
            for j in range(5):
                at = a + U(j) * S
                g, p, v = X[at], X[at + ROW1], X[at + ROW2]
                equations[e, j], equations[e + 1, j], equations[e + 2, j] = g, p, v
            equations[e, WEIGHT] = equations[e + 1, WEIGHT] = equations[e + 2, WEIGHT] = HARD
            equations[e, OFF], equations[e + 1, OFF], equations[e + 2, OFF] = s0, s1, s2
            worst = max(worst, abs(s0), abs(s1), abs(s2))
        else:
            rows[k] = 2
            inverse = 1.0 / length
            u1, u2 = w1 * inverse, w2 * inverse
            for j in range(5):
                at = a + U(j) * S
                g, p, v = X[at], X[at + ROW1], X[at + ROW2]
                equations[e, j], equations[e + 1, j] = g + u1 * p + u2 * v, u1 * v - u2 * p
            off, across = s0 + u1 * s1 + u2 * s2, u1 * s2 - u2 * s1
            equations[e, OFF], equations[e, WEIGHT] = off, HARD
            equations[e + 1, OFF], equations[e + 1, WEIGHT] = across, (length + w0) / (length - w0)
            equations[e, TURN], equations[e, TURN + 1] = u1, u2
            worst = max(worst, abs(off), abs(across))
            z0 = 0.5 * (z0 + u1 * z1 + u2 * z2)
            z1, z2 = z0 * u1, z0 * u2
            kept[3 * k], kept[3 * k + 1], kept[3 * k + 2] = z0, z1, z2
        b0 += X[a] * z0 + X[a + ROW1] * z1 + X[a + ROW2] * z2
        b1 += X[a + S] * z0 + X[a + ROW1 + S] * z1 + X[a + ROW2 + S] * z2
        b2 += X[a + S2] * z0 + X[a + ROW1 + S2] * z1 + X[a + ROW2 + S2] * z2
        b3 += X[a + S3] * z0 + X[a + ROW1 + S3] * z1 + X[a + ROW2 + S3] * z2
        b4 += X[a + S4] * z0 + X[a + ROW1 + S4] * z1 + X[a + ROW2 + S4] * z2
        carried += abs(z0)
        e += rows[k]
    # Residuals count by what they face: those of the slacks by the forces, those of the balance by the motion.
    missed, moving = abs(b0) + abs(b1) + abs(b2) + abs(b3) + abs(b4), abs(y[0]) + abs(y[1]) + abs(y[2]) + abs(y[3]) + abs(y[4])
    gap = worst * carried + missed * moving
    # The larger of a number and none is the number: what is not finite is looked for by itself.
    if not gap < math.inf:
        worst = math.inf
    return e, max(worst, abs(b0), abs(b1), abs(b2), abs(b3), abs(b4)), gap, b0, b1, b2, b3, b4


@inner(inline="always")
def _step(X, cones, points, q, rows, equations, y, kept, last):
    """One Newton step of unknowns and multipliers, unless none is needed or worth it.

    Returns:
        Largest residual before it, what residuals may be worth in the cost, and whether there was none because nothing is left to do.
    """
    count, worst, gap, b0, b1, b2, b3, b4 = _linearised(X, cones, points, q, rows, equations, y, kept)
    # Large motions and forces ask for smaller residuals, as far as rounding lets them fall.
    done = worst <= CONVERGED and (gap <= CONVERGED or gap > SLOW * last)
    if done or not worst < FAR:
        return worst, gap, done
    hard = 1.0 / max(DAMPING, min(worst, DAMPED))
    m00 = m10 = m11 = m20 = m21 = m22 = m30 = m31 = m32 = m33 = m40 = m41 = m42 = m43 = m44 = 0.0
    for e in range(count):
        g0, g1, g2, g3, g4 = equations[e, 0], equations[e, 1], equations[e, 2], equations[e, 3], equations[e, 4]
        weight, off = equations[e, WEIGHT], equations[e, OFF]
        weight = hard if weight == HARD else min(weight, hard)
        equations[e, WEIGHT] = weight
        w0, w1, w2, w3, w4 = weight * g0, weight * g1, weight * g2, weight * g3, weight * g4
        m00 += g0 * w0
        m10 += g1 * w0
        m11 += g1 * w1
        m20 += g2 * w0
        m21 += g2 * w1
        m22 += g2 * w2
        m30 += g3 * w0
        m31 += g3 * w1
        m32 += g3 * w2
        m33 += g3 * w3
        m40 += g4 * w0
        m41 += g4 * w1
        m42 += g4 * w2
        m43 += g4 * w3
        m44 += g4 * w4
        b0 -= w0 * off
        b1 -= w1 * off
        b2 -= w2 * off
        b3 -= w3 * off
        b4 -= w4 * off
    factors = factor((m00, m10, m11, m20, m21, m22, m30, m31, m32, m33, m40, m41, m42, m43, m44))
    d0, d1, d2, d3, d4 = solve_factored(factors, -b0, -b1, -b2, -b3, -b4)
    y[0] += d0
    y[1] += d1
    y[2] += d2
    y[3] += d3
    y[4] += d4
    e = 0
    for k in range(cones):
        for c in range(rows[k]):
            at = e + c
            moved = equations[at, 0] * d0 + equations[at, 1] * d1 + equations[at, 2] * d2 + equations[at, 3] * d3
            more = (moved + equations[at, 4] * d4 - equations[at, OFF]) * equations[at, WEIGHT]
            if rows[k] != 2:
                kept[3 * k + c] += more
            elif c == 0:
                kept[3 * k] += more
                kept[3 * k + 1] += more * equations[e, TURN]
                kept[3 * k + 2] += more * equations[e, TURN + 1]
            else:
                kept[3 * k + 1] -= more * equations[e, TURN + 1]
                kept[3 * k + 2] += more * equations[e, TURN]
        e += rows[k]
    return worst, gap, False


@inner
def optimum(X, cones, points, q, rows, equations, y, kept):
    """Try to get an optimum from a start.

    Args:
        X: Buffer of the cones with its right-hand sides.
        cones: Number of cones.
        points: Shape (n, 14).
        q: Cost, shape (5,).
        rows: Scratch, shape (cones,).
        equations: Scratch, shape (3 * cones, EQUATION).
        y: The unknowns: where to start, then the answer, shape (5,).
        kept: The multipliers, likewise, shape (3 * cones,).

    Returns:
        Whether it succeeded.
    """
    least, tried, gap = math.inf, 0, math.inf
    for _ in range(MOST_STEPS):
        off, gap, done = _step(X, cones, points, q, rows, equations, y, kept, gap)
        if done:
            return True
        tried += 1 if off > SLOW * least else 0
        if not off < FAR or tried >= PATIENCE:
            return False
        least = min(least, off)
    return False
