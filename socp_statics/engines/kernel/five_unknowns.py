"""A conic program with at most five unknowns and many cones of dimension three.

    minimise    q' y                                     multipliers z in K:   G' z + q = 0
    subject to  s = h - G y in K                         maximise - h' z

Support directions and margins of point forces have this form: their duals, whose unknowns are a motion and whose cones say that
no contact force can prevent it. The multipliers are the contact forces. An inequality ``s_0 >= 0`` is a cone whose other rows are zero.

Primal-dual interior-point method: Nesterov-Todd scaling, Mehrotra's predictor and corrector (Nesterov and Todd 1997; Vandenberghe,
"The CVXOPT linear and quadratic cone program solvers", 2010), from an infeasible start.
"""

from __future__ import annotations

import math

from socp_statics.engines.kernel.compilation import inner
from socp_statics.engines.kernel.cone3 import determinant, inverse_square, scaled, to_boundary, unscaled
from socp_statics.engines.kernel.lanes import (
    BLOCK,
    MULTIPLIER,
    MULTIPLIER_STEP,
    REACH,
    RESIDUAL,
    RHS,
    ROW0,
    ROW1,
    ROW2,
    S2,
    S3,
    S4,
    SCALING,
    SLACK,
    SLACK_STEP,
    S,
    U,
    column,
    row,
)
from socp_statics.engines.kernel.normal_matrix import factor, solve_factored
from socp_statics.engines.kernel.starting_point import largest, start

SOLVED, INFEASIBLE, UNBOUNDED, UNSETTLED = 0, 1, 2, 3
MOST_ITERATIONS = 40
STEP = 0.99
CERTIFICATE = 1e-9
ACCEPTED = 1e-8
NEW = -1.0


@inner(inline="always")
def _scale(X, lanes):
    """Scaling points; returns the gap and ``h' z``."""
    gap = hz = 0.0
    o, left = U(0), lanes
    while left > U(0):
        count = min(left, S)
        for k in range(count):
            a = o + k
            s0, s1, s2 = X[a + SLACK], X[a + SLACK + S], X[a + SLACK + S2]
            z0, z1, z2 = X[a + MULTIPLIER], X[a + MULTIPLIER + S], X[a + MULTIPLIER + S2]
            det_z = determinant(z0, z1, z2)
            root_s, root_z = 1.0 / math.sqrt(determinant(s0, s1, s2)), 1.0 / math.sqrt(det_z)
            sz = s0 * z0 + s1 * z1 + s2 * z2
            gap += sz
            hz += X[a + RHS] * z0 + X[a + RHS + S] * z1 + X[a + RHS + S2] * z2
            f = 1.0 / math.sqrt(2.0 + 2.0 * sz * root_s * root_z)
            X[a + SCALING] = (s0 * root_s + z0 * root_z) * f
            X[a + SCALING + S] = (s1 * root_s - z1 * root_z) * f
            X[a + SCALING + S2] = (s2 * root_s - z2 * root_z) * f
            X[a + SCALING + S3] = root_s * det_z * root_z
        left -= count
        o += BLOCK
    return gap, hz


@inner(inline="always")
def _slack_residual(X, lanes, y0, y1, y2, y3, y4):
    """``s - h + G y``, its square, and ``W^-2`` of it where the multiplier's step will be."""
    square = 0.0
    o, left = U(0), lanes
    while left > U(0):
        count = min(left, S)
        for k in range(count):
            a = o + k
            t0 = X[a + SLACK] - X[a + RHS] + row(X, a + ROW0, y0, y1, y2, y3, y4)
            t1 = X[a + SLACK + S] - X[a + RHS + S] + row(X, a + ROW1, y0, y1, y2, y3, y4)
            t2 = X[a + SLACK + S2] - X[a + RHS + S2] + row(X, a + ROW2, y0, y1, y2, y3, y4)
            X[a + RESIDUAL], X[a + RESIDUAL + S], X[a + RESIDUAL + S2] = t0, t1, t2
            square += t0 * t0 + t1 * t1 + t2 * t2
            t0, t1, t2 = inverse_square(X[a + SCALING], X[a + SCALING + S], X[a + SCALING + S2], X[a + SCALING + S3], t0, t1, t2)
            X[a + MULTIPLIER_STEP], X[a + MULTIPLIER_STEP + S], X[a + MULTIPLIER_STEP + S2] = t0, t1, t2
        left -= count
        o += BLOCK
    return square


@inner(inline="always")
def _normal_matrix(X, lanes, pad):
    """``G' W^-2 G``, lower triangle by rows."""
    m00 = m10 = m11 = m20 = m21 = m22 = m30 = m31 = m32 = m33 = m40 = m41 = m42 = m43 = 0.0
    m44 = pad
    o, left = U(0), lanes
    while left > U(0):
        count = min(left, S)
        for k in range(count):
            a = o + k
            w0, w1, w2, e = X[a + SCALING], X[a + SCALING + S], X[a + SCALING + S2], X[a + SCALING + S3]
            a0, b0, c0 = X[a], X[a + ROW1], X[a + ROW2]
            a1, b1, c1 = X[a + S], X[a + S + ROW1], X[a + S + ROW2]
            a2, b2, c2 = X[a + S2], X[a + S2 + ROW1], X[a + S2 + ROW2]
            a3, b3, c3 = X[a + S3], X[a + S3 + ROW1], X[a + S3 + ROW2]
            a4, b4, c4 = X[a + S4], X[a + S4 + ROW1], X[a + S4 + ROW2]
            p0, r0, v0 = inverse_square(w0, w1, w2, e, a0, b0, c0)
            p1, r1, v1 = inverse_square(w0, w1, w2, e, a1, b1, c1)
            p2, r2, v2 = inverse_square(w0, w1, w2, e, a2, b2, c2)
            p3, r3, v3 = inverse_square(w0, w1, w2, e, a3, b3, c3)
            p4, r4, v4 = inverse_square(w0, w1, w2, e, a4, b4, c4)
            m00 += a0 * p0 + b0 * r0 + c0 * v0
            m10 += a1 * p0 + b1 * r0 + c1 * v0
            m11 += a1 * p1 + b1 * r1 + c1 * v1
            m20 += a2 * p0 + b2 * r0 + c2 * v0
            m21 += a2 * p1 + b2 * r1 + c2 * v1
            m22 += a2 * p2 + b2 * r2 + c2 * v2
            m30 += a3 * p0 + b3 * r0 + c3 * v0
            m31 += a3 * p1 + b3 * r1 + c3 * v1
            m32 += a3 * p2 + b3 * r2 + c3 * v2
            m33 += a3 * p3 + b3 * r3 + c3 * v3
            m40 += a4 * p0 + b4 * r0 + c4 * v0
            m41 += a4 * p1 + b4 * r1 + c4 * v1
            m42 += a4 * p2 + b4 * r2 + c4 * v2
            m43 += a4 * p3 + b4 * r3 + c4 * v3
            m44 += a4 * p4 + b4 * r4 + c4 * v4
        left -= count
        o += BLOCK
    return m00, m10, m11, m20, m21, m22, m30, m31, m32, m33, m40, m41, m42, m43, m44


@inner(inline="always")
def _gradients(X, lanes):
    """``G' z``, and ``G'`` times what stands where the multiplier's step will be."""
    x0 = x1 = x2 = x3 = x4 = g0 = g1 = g2 = g3 = g4 = 0.0
    o, left = U(0), lanes
    while left > U(0):
        count = min(left, S)
        for k in range(count):
            a = o + k
            z0, z1, z2 = X[a + MULTIPLIER], X[a + MULTIPLIER + S], X[a + MULTIPLIER + S2]
            t0, t1, t2 = X[a + MULTIPLIER_STEP], X[a + MULTIPLIER_STEP + S], X[a + MULTIPLIER_STEP + S2]
            x0 += column(X, a, z0, z1, z2)
            g0 += column(X, a, t0, t1, t2)
            x1 += column(X, a + S, z0, z1, z2)
            g1 += column(X, a + S, t0, t1, t2)
            x2 += column(X, a + S2, z0, z1, z2)
            g2 += column(X, a + S2, t0, t1, t2)
            x3 += column(X, a + S3, z0, z1, z2)
            g3 += column(X, a + S3, t0, t1, t2)
            x4 += column(X, a + S4, z0, z1, z2)
            g4 += column(X, a + S4, t0, t1, t2)
        left -= count
        o += BLOCK
    return x0, x1, x2, x3, x4, g0, g1, g2, g3, g4


@inner(inline="always")
def _target_gradient(X, lanes):
    """``G'`` times the corrector's target."""
    x0 = x1 = x2 = x3 = x4 = 0.0
    o, left = U(0), lanes
    while left > U(0):
        count = min(left, S)
        for k in range(count):
            a = o + k
            v0, v1, v2 = X[a + MULTIPLIER_STEP], X[a + MULTIPLIER_STEP + S], X[a + MULTIPLIER_STEP + S2]
            x0 += column(X, a, v0, v1, v2)
            x1 += column(X, a + S, v0, v1, v2)
            x2 += column(X, a + S2, v0, v1, v2)
            x3 += column(X, a + S3, v0, v1, v2)
            x4 += column(X, a + S4, v0, v1, v2)
        left -= count
        o += BLOCK
    return x0, x1, x2, x3, x4


@inner(inline="always")
def _steps(X, lanes, share, keep, r0, r1, r2, r3, r4):
    """Steps of slacks and multipliers from the step r of the unknowns.

    Args:
        X: The buffer; MULTIPLIER_STEP holds ``W^-1`` of the complementarity's right-hand side when ``share`` is 0.
        lanes: Number of lanes.
        share: 1 for the predictor, whose right-hand side is minus the multiplier, else 0.
        keep: Share of the slack's residual to remove.
        r0: Step of the first unknown.
        r1: Of the second.
        r2: Of the third.
        r3: Of the fourth.
        r4: Of the fifth.

    Returns:
        One over the longest step inside the cones, and how the gap changes: linear and quadratic part.
    """
    change, product, reach = 0.0, 0.0, 0.0
    o, left = U(0), lanes
    while left > U(0):
        count = min(left, S)
        for k in range(count):
            a = o + k
            d0 = -keep * X[a + RESIDUAL] - row(X, a + ROW0, r0, r1, r2, r3, r4)
            d1 = -keep * X[a + RESIDUAL + S] - row(X, a + ROW1, r0, r1, r2, r3, r4)
            d2 = -keep * X[a + RESIDUAL + S2] - row(X, a + ROW2, r0, r1, r2, r3, r4)
            p0, p1, p2 = inverse_square(X[a + SCALING], X[a + SCALING + S], X[a + SCALING + S2], X[a + SCALING + S3], d0, d1, d2)
            s0, s1, s2 = X[a + SLACK], X[a + SLACK + S], X[a + SLACK + S2]
            z0, z1, z2 = X[a + MULTIPLIER], X[a + MULTIPLIER + S], X[a + MULTIPLIER + S2]
            other = 1.0 - share
            e0 = other * X[a + MULTIPLIER_STEP] - share * z0 - p0
            e1 = other * X[a + MULTIPLIER_STEP + S] - share * z1 - p1
            e2 = other * X[a + MULTIPLIER_STEP + S2] - share * z2 - p2
            X[a + SLACK_STEP], X[a + SLACK_STEP + S], X[a + SLACK_STEP + S2] = d0, d1, d2
            X[a + MULTIPLIER_STEP], X[a + MULTIPLIER_STEP + S], X[a + MULTIPLIER_STEP + S2] = e0, e1, e2
            reach_s = to_boundary(s0, s1, s2, d0, d1, d2)
            reach_z = to_boundary(z0, z1, z2, e0, e1, e2)
            X[a + REACH] = reach_s if reach_s > reach_z else reach_z
            change += e0 * s0 + e1 * s1 + e2 * s2 + d0 * z0 + d1 * z1 + d2 * z2
            product += d0 * e0 + d1 * e1 + d2 * e2
        reach = largest(X, o, count, REACH, reach)
        left -= count
        o += BLOCK
    return reach, change, product


@inner(inline="always")
def _corrector(X, lanes, centre):
    """``W^-1`` of the corrector's right-hand side where the multiplier's step will be: centring less second-order terms."""
    o, left = U(0), lanes
    while left > U(0):
        count = min(left, S)
        for k in range(count):
            a = o + k
            w0, w1, w2 = X[a + SCALING], X[a + SCALING + S], X[a + SCALING + S2]
            inverse_eta = math.sqrt(X[a + SCALING + S3])
            eta, f = 1.0 / inverse_eta, 1.0 / (1.0 + w0)
            z0, z1, z2 = X[a + MULTIPLIER], X[a + MULTIPLIER + S], X[a + MULTIPLIER + S2]
            d0, d1, d2 = X[a + SLACK_STEP], X[a + SLACK_STEP + S], X[a + SLACK_STEP + S2]
            e0, e1, e2 = X[a + MULTIPLIER_STEP], X[a + MULTIPLIER_STEP + S], X[a + MULTIPLIER_STEP + S2]
            l0, l1, l2 = scaled(w0, w1, w2, eta, f, z0, z1, z2)
            b0, b1, b2 = scaled(w0, w1, w2, eta, f, e0, e1, e2)
            a0, a1, a2 = unscaled(w0, w1, w2, inverse_eta, f, d0, d1, d2)
            v0 = centre - (l0 * l0 + l1 * l1 + l2 * l2) - (a0 * b0 + a1 * b1 + a2 * b2)
            v1 = -2.0 * l0 * l1 - (a0 * b1 + b0 * a1)
            v2 = -2.0 * l0 * l2 - (a0 * b2 + b0 * a2)
            c0 = (l0 * v0 - l1 * v1 - l2 * v2) / determinant(l0, l1, l2)
            il = 1.0 / l0
            c1, c2 = (v1 - l1 * c0) * il, (v2 - l2 * c0) * il
            c0, c1, c2 = unscaled(w0, w1, w2, inverse_eta, f, c0, c1, c2)
            X[a + MULTIPLIER_STEP], X[a + MULTIPLIER_STEP + S], X[a + MULTIPLIER_STEP + S2] = c0, c1, c2
        left -= count
        o += BLOCK


@inner(inline="always")
def _advance(X, lanes, alpha):
    """Take the steps."""
    o, left = U(0), lanes
    while left > U(0):
        count = min(left, S)
        for c in range(3):
            for k in range(count):
                a = o + U(c) * S + k
                X[a + SLACK] += alpha * X[a + SLACK_STEP]
                X[a + MULTIPLIER] += alpha * X[a + MULTIPLIER_STEP]
        left -= count
        o += BLOCK


@inner
def solve(X, lanes, cones, pad, factors, q, y, tolerance, begun):
    """Solve one program.

    Args:
        X: The buffer of the cones (see `lanes`): rows and right-hand sides are read, slacks and multipliers written.
        lanes: Number of lanes, a multiple of four; those behind the last cone have zero rows and right-hand side (1, 0, 0).
        cones: Number of cones, a float.
        pad: Diagonal term of an unused fifth unknown, 0 or 1.
        factors: Of the normal matrix of the rows.
        q: Cost, shape (5,).
        y: The unknowns, shape (5,), written.
        tolerance: Of both residuals and of the gap, relative; ten to the minus eighth is accepted where it goes no further.
        begun: What the last call returned, to go on from the iterate it left; NEW to begin.

    Returns:
        Status, number of iterations, and what to pass to go on. INFEASIBLE: z proves it (``G' z = 0``, ``h' z < 0``). UNBOUNDED: y
        proves it (``- G y`` in K, ``q' y < 0``).
    """
    h_size = start(X, lanes, factors, q, y) if begun == NEW else begun
    q0, q1, q2, q3, q4 = q[0], q[1], q[2], q[3], q[4]
    h_unit = max(1.0, h_size)
    q_unit = max(1.0, math.sqrt(q0 * q0 + q1 * q1 + q2 * q2 + q3 * q3 + q4 * q4))
    y0, y1, y2, y3, y4 = y[0], y[1], y[2], y[3], y[4]
    status, iterations, error = UNSETTLED, 0, math.inf
    while True:
        gap, hz = _scale(X, lanes)
        slack_residual = math.sqrt(_slack_residual(X, lanes, y0, y1, y2, y3, y4))
        x0, x1, x2, x3, x4, g0, g1, g2, g3, g4 = _gradients(X, lanes)
        growth = abs(x0) + abs(x1) + abs(x2) + abs(x3) + abs(x4)
        x0, x1, x2, x3, x4 = x0 + q0, x1 + q1, x2 + q2, x3 + q3, x4 + q4
        cost = q0 * y0 + q1 * y1 + q2 * y2 + q3 * y3 + q4 * y4
        cost_residual = math.sqrt(x0 * x0 + x1 * x1 + x2 * x2 + x3 * x3 + x4 * x4)
        last, error = error, max(cost_residual / q_unit, slack_residual / h_unit, gap / (1.0 + abs(cost)))
        # A degenerate optimum keeps the residuals from falling as far as the gap does.
        if error <= tolerance or (error <= ACCEPTED and error > 0.5 * last):
            status = SOLVED
            break
        if -hz * CERTIFICATE > growth:
            status = INFEASIBLE
            break
        if -cost * CERTIFICATE > h_size + slack_residual:
            status = UNBOUNDED
            break
        if iterations >= MOST_ITERATIONS or not gap < math.inf:
            break
        iterations += 1
        factors = factor(_normal_matrix(X, lanes, pad))
        r0, r1, r2, r3, r4 = solve_factored(factors, -q0 - g0, -q1 - g1, -q2 - g2, -q3 - g3, -q4 - g4)
        reach, change, product = _steps(X, lanes, 1.0, 1.0, r0, r1, r2, r3, r4)
        alpha = 1.0 / reach if reach > 1.0 else 1.0
        sigma = max((gap + alpha * (change + alpha * product)) / gap, 0.0)
        sigma = sigma * sigma * sigma
        keep = 1.0 - sigma
        _corrector(X, lanes, sigma * gap / cones)
        p0, p1, p2, p3, p4 = _target_gradient(X, lanes)
        r0, r1, r2, r3, r4 = solve_factored(
            factors,
            -keep * (x0 + g0) - p0,
            -keep * (x1 + g1) - p1,
            -keep * (x2 + g2) - p2,
            -keep * (x3 + g3) - p3,
            -keep * (x4 + g4) - p4,
        )
        reach, change, product = _steps(X, lanes, 0.0, keep, r0, r1, r2, r3, r4)
        alpha = min(STEP / reach, 1.0) if reach > 0.0 else 1.0
        y0 += alpha * r0
        y1 += alpha * r1
        y2 += alpha * r2
        y3 += alpha * r3
        y4 += alpha * r4
        _advance(X, lanes, alpha)
    y[0], y[1], y[2], y[3], y[4] = y0, y1, y2, y3, y4
    return status, iterations, h_size
