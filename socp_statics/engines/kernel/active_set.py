"""Newton's method on the optimality conditions of a program with five unknowns, what every contact does being guessed and repaired.

A contact at an optimum is free (no force), at rest (its slack is zero, any force in the cone) or slides (slack and force on the
boundary, the force ``t (1, -u)`` against the sliding direction u). With that known for all of them the conditions are equations:
``G' z + q = 0`` and ``s_0 = |(s_1, s_2)|`` or ``s = 0`` for each loaded contact, solved by Newton's method with multipliers (a step of
the multipliers costs DAMPING times its square, so that only the 5 x 5 matrix of the unknowns is factored and forces that are not unique
do no harm). What leaves its cone changes its state, a few times. The result counts only if every force and every slack lies in its
cone: then it is an optimum, wherever the steps came from.
"""

from __future__ import annotations

import math

from socp_statics.engines.kernel.compilation import inner
from socp_statics.engines.kernel.lanes import MULTIPLIER, RHS, ROW1, ROW2, S2, SLACK, S, U, lane, row
from socp_statics.engines.kernel.normal_matrix import factor, solve_factored

FREE, RESTS, SLIDES = 0, 1, 2
MOST_STEPS, MOST_REPAIRS = 12, 3
CONVERGED = 1e-12
HOLDS = 1e-11
DAMPING = 1e-7
# Residuals of a guess that is worth following are not larger than this.
FAR = 10.0
# A step that leaves more than this share of the residual is not Newton's quadratic convergence: the guess is wrong.
SLOW = 0.5
# Numbers of a row of the equations: five coefficients, right-hand side, weight in the normal equations, multiplier.
OFF, WEIGHT, FORCE = 5, 6, 7
EQUATION = 8
AT_REST = 1e-10


@inner
def classify(X, cones, points, clear, states):
    """What each contact seems to do at an interior-point iterate, written.

    Args:
        X: Buffer of the cones.
        cones: Number of cones.
        points: Shape (n, 14).
        clear: Ratio of distances to the boundary below which there is no doubt.
        states: Written, shape (cones,).

    Returns:
        Whether there is no doubt about any of them.
    """
    beyond_doubt = True
    for k in range(cones):
        a = lane(k)
        s0, s1, s2 = X[a + SLACK], X[a + SLACK + S], X[a + SLACK + S2]
        z0, z1, z2 = X[a + MULTIPLIER], X[a + MULTIPLIER + S], X[a + MULTIPLIER + S2]
        st, zt = math.sqrt(s1 * s1 + s2 * s2), math.sqrt(z1 * z1 + z2 * z2)
        # The largest of: force inside with slack near zero, slack inside with force near zero, both on the boundary.
        inside_s, inside_z = s0 - st, z0 - zt
        if z0 + zt < inside_s:
            states[k] = FREE
            beyond_doubt = beyond_doubt and z0 + zt < clear * inside_s
        elif s0 + st < inside_z:
            states[k] = RESTS if points[k, 12] > 0.0 else SLIDES
            beyond_doubt = beyond_doubt and s0 + st < clear * inside_z
        else:
            states[k] = SLIDES
            beyond_doubt = beyond_doubt and inside_s < clear * (z0 + zt) and inside_z < clear * (s0 + st)
    return beyond_doubt


@inner
def slack(X, a, y):
    """``h - G y`` of one cone."""
    y0, y1, y2, y3, y4 = y[0], y[1], y[2], y[3], y[4]
    return (
        X[a + RHS] - row(X, a, y0, y1, y2, y3, y4),
        X[a + RHS + S] - row(X, a + ROW1, y0, y1, y2, y3, y4),
        X[a + RHS + S2] - row(X, a + ROW2, y0, y1, y2, y3, y4),
    )


@inner
def _write_equations(X, cones, states, y, kept, equations):
    """Linearise what every loaded contact promises.

    Args:
        X: Buffer of the cones with its right-hand sides.
        cones: Number of cones.
        states: What each contact does, shape (cones,).
        y: The unknowns, shape (5,).
        kept: The multipliers, shape (3 * cones,); those of sliding contacts are turned against their slack.
        equations: Written, shape (3 * cones, EQUATION): rows ``g dy = off`` with their weights and multipliers; behind that of a
            sliding contact one for the curvature of its cone, which has neither.

    Returns:
        Number of rows and largest residual.
    """
    e, worst = 0, 0.0
    for k in range(cones):
        if states[k] == FREE:
            continue
        a = lane(k)
        s0, s1, s2 = slack(X, a, y)
        worst = max(worst, abs(s0 - math.sqrt(s1 * s1 + s2 * s2)))
        if states[k] == RESTS:
            for c in range(3):
                for j in range(5):
                    equations[e + c, j] = X[a + U(5 * c + j) * S]
                equations[e + c, WEIGHT], equations[e + c, FORCE] = 1.0 / DAMPING, kept[3 * k + c]
            equations[e, OFF], equations[e + 1, OFF], equations[e + 2, OFF] = s0, s1, s2
            worst = max(worst, abs(s0), abs(s1), abs(s2))
            e += 3
            continue
        length = math.sqrt(s1 * s1 + s2 * s2)
        inverse = 1.0 / length if length > 0.0 else 0.0
        u1, u2, t = s1 * inverse, s2 * inverse, kept[3 * k]
        kept[3 * k + 1], kept[3 * k + 2] = -t * u1, -t * u2
        for j in range(5):
            at = a + U(j) * S
            g, p, v = X[at], X[at + ROW1], X[at + ROW2]
            equations[e, j], equations[e + 1, j] = g - u1 * p - u2 * v, u1 * v - u2 * p
        equations[e, OFF], equations[e, WEIGHT], equations[e, FORCE] = s0 - length, 1.0 / DAMPING, t
        equations[e + 1, OFF], equations[e + 1, WEIGHT], equations[e + 1, FORCE] = 0.0, max(t, 0.0) * inverse, 0.0
        e += 2
    return e, worst


@inner
def _step(X, cones, q, states, equations, y, kept):
    """One Newton step of unknowns and multipliers; returns the largest residual before it."""
    count, worst = _write_equations(X, cones, states, y, kept, equations)
    m00 = m10 = m11 = m20 = m21 = m22 = m30 = m31 = m32 = m33 = m40 = m41 = m42 = m43 = m44 = 0.0
    r0 = r1 = r2 = r3 = r4 = 0.0
    b0, b1, b2, b3, b4 = q[0], q[1], q[2], q[3], q[4]
    for e in range(count):
        g0, g1, g2, g3, g4 = equations[e, 0], equations[e, 1], equations[e, 2], equations[e, 3], equations[e, 4]
        weight, force, off = equations[e, WEIGHT], equations[e, FORCE], equations[e, OFF]
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
        r0 += w0 * off
        r1 += w1 * off
        r2 += w2 * off
        r3 += w3 * off
        r4 += w4 * off
        b0 += g0 * force
        b1 += g1 * force
        b2 += g2 * force
        b3 += g3 * force
        b4 += g4 * force
    worst = max(worst, abs(b0), abs(b1), abs(b2), abs(b3), abs(b4))
    if worst <= CONVERGED:
        return worst
    factors = factor((m00, m10, m11, m20, m21, m22, m30, m31, m32, m33, m40, m41, m42, m43, m44))
    d0, d1, d2, d3, d4 = solve_factored(factors, r0 - b0, r1 - b1, r2 - b2, r3 - b3, r4 - b4)
    y[0] += d0
    y[1] += d1
    y[2] += d2
    y[3] += d3
    y[4] += d4
    e = 0
    for k in range(cones):
        if states[k] != FREE:
            resting = states[k] == RESTS
            for c in range(3 if resting else 1):
                at = e + c
                moved = equations[at, 0] * d0 + equations[at, 1] * d1 + equations[at, 2] * d2 + equations[at, 3] * d3
                kept[3 * k + c] += (moved + equations[at, 4] * d4 - equations[at, OFF]) * equations[at, WEIGHT]
            e += 3 if resting else 2
    return worst


@inner
def _repair(X, cones, points, states, y, kept):
    """Change the state of every contact that left its cone; returns how many there are, -1 where no state is known that would mend it."""
    wrong = 0
    for k in range(cones):
        s0, s1, s2 = slack(X, lane(k), y)
        length = math.sqrt(s1 * s1 + s2 * s2)
        if states[k] == FREE:
            if s0 - length < -HOLDS:
                states[k] = SLIDES
                wrong += 1
            continue
        z0, z1, z2 = kept[3 * k], kept[3 * k + 1], kept[3 * k + 2]
        reach = math.sqrt(z1 * z1 + z2 * z2)
        if states[k] == SLIDES:
            if z0 < -HOLDS:
                states[k] = FREE
                kept[3 * k] = kept[3 * k + 1] = kept[3 * k + 2] = 0.0
                wrong += 1
            elif points[k, 12] > 0.0 and length < AT_REST and s0 > AT_REST:
                return -1
        elif z0 - reach < -HOLDS:
            # A contact that would have to pull opens; one that would have to hold too much slides, but where to is not known.
            if z0 > 0.0:
                return -1
            states[k] = FREE
            kept[3 * k] = kept[3 * k + 1] = kept[3 * k + 2] = 0.0
            wrong += 1
    return wrong


@inner
def optimum(X, cones, points, q, states, equations, y, kept):
    """Try to get an optimum from a guess.

    Args:
        X: Buffer of the cones with its right-hand sides.
        cones: Number of cones.
        points: Shape (n, 14).
        q: Cost, shape (5,).
        states: What each contact does: a guess, then what it does at the optimum, shape (cones,).
        equations: Scratch, shape (3 * cones, EQUATION).
        y: The unknowns: where to start, then the answer, shape (5,).
        kept: The multipliers, likewise, shape (3 * cones,).

    Returns:
        Whether it succeeded.
    """
    for k in range(cones):
        if states[k] == FREE:
            kept[3 * k] = kept[3 * k + 1] = kept[3 * k + 2] = 0.0
    for _ in range(MOST_REPAIRS + 1):
        last, settled = math.inf, False
        for step in range(MOST_STEPS):
            off = _step(X, cones, q, states, equations, y, kept)
            if off <= CONVERGED:
                settled = True
                break
            if not off < FAR or (step > 1 and off > SLOW * last):
                break
            last = off
        if not settled:
            return False
        wrong = _repair(X, cones, points, states, y, kept)
        if wrong <= 0:
            return wrong == 0
    return False
