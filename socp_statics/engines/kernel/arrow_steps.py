"""Steps of the points of a program with a common ceiling (see `ceiling`)."""

from __future__ import annotations

import math

from socp_statics.engines.kernel import cone3, cone4
from socp_statics.engines.kernel.arrow_lanes import (
    BLOCK,
    FORCE,
    FORCE_STEP,
    GRIP,
    GRIP_SCALING,
    GRIP_STEP,
    HOLD,
    HOLD_SCALING,
    HOLD_STEP,
    NORMAL,
    REACH,
    RESIDUAL,
    TANGENTIAL,
    WRENCH,
    WRENCHES,
)
from socp_statics.engines.kernel.compilation import inner
from socp_statics.engines.kernel.lanes import S2, S3, S4, S, U


@inner
def steps(X, points, t, x, keep):
    """Steps of the multipliers from their aims and the steps of forces, balance and ceiling.

    Those of the friction cones are what stationarity asks for and not what the scaling gives: the same but for rounding, which
    would add up in the residual where multipliers are large.

    Args:
        X: The buffer.
        points: Number of points.
        t: The ceiling.
        x: Steps of the balance's multipliers and of the ceiling, shape (7,).
        keep: Share of the residuals to remove.

    Returns:
        One over the longest step inside the cones, and how the gap changes: linear and quadratic part.
    """
    change, product, reach = 0.0, 0.0, 0.0
    y0, y1, y2, y3, y4, y5, dt = x[0], x[1], x[2], x[3], x[4], x[5], x[6]
    o, left = U(0), points
    while left > U(0):
        count = min(left, S)
        for c in range(3):
            g, r = o + WRENCH + U(c) * WRENCHES, o + U(c) * S
            for k in range(count):
                a = g + k
                along = X[a] * y0 + X[a + S] * y1 + X[a + S2] * y2 + X[a + S3] * y3 + X[a + S4] * y4 + X[a + U(5) * S] * y5
                X[r + GRIP_STEP + k] = along + keep * X[r + RESIDUAL + k]
        for k in range(count):
            a = o + k
            n, m = X[a + NORMAL], X[a + TANGENTIAL]
            d0, d1, d2 = X[a + FORCE_STEP], X[a + FORCE_STEP + S], X[a + FORCE_STEP + S2]
            z0, z1, z2 = X[a + FORCE], X[a + FORCE + S], X[a + FORCE + S2]
            s1, s2, s3, b1, b2, b3 = n * z0, m * z1, m * z2, n * d0, m * d1, m * d2
            u0, u1, u2, u3 = X[a + HOLD_SCALING], X[a + HOLD_SCALING + S], X[a + HOLD_SCALING + S2], X[a + HOLD_SCALING + S3]
            p0, p1, p2, p3 = cone4.inverse_square(u0, u1, u2, u3, X[a + HOLD_SCALING + S4], dt, b1, b2, b3)
            m0, m1, m2, m3 = X[a + HOLD], X[a + HOLD + S], X[a + HOLD + S2], X[a + HOLD + S3]
            v0, v1, v2, v3 = X[a + HOLD_STEP] - p0, X[a + HOLD_STEP + S] - p1, X[a + HOLD_STEP + S2] - p2, X[a + HOLD_STEP + S3] - p3
            X[a + HOLD_STEP], X[a + HOLD_STEP + S], X[a + HOLD_STEP + S2], X[a + HOLD_STEP + S3] = v0, v1, v2, v3
            l0, l1, l2 = X[a + GRIP], X[a + GRIP + S], X[a + GRIP + S2]
            e0, e1, e2 = X[a + GRIP_STEP] - n * v1, X[a + GRIP_STEP + S] - m * v2, X[a + GRIP_STEP + S2] - m * v3
            X[a + GRIP_STEP], X[a + GRIP_STEP + S], X[a + GRIP_STEP + S2] = e0, e1, e2
            force = cone3.to_boundary(z0, z1, z2, d0, d1, d2)
            grip = cone3.to_boundary(l0, l1, l2, e0, e1, e2)
            below = cone4.to_boundary(t, s1, s2, s3, dt, b1, b2, b3)
            hold = cone4.to_boundary(m0, m1, m2, m3, v0, v1, v2, v3)
            first, second = (force if force > grip else grip), (below if below > hold else hold)
            X[a + REACH] = first if first > second else second
            change += e0 * z0 + e1 * z1 + e2 * z2 + d0 * l0 + d1 * l1 + d2 * l2
            change += v0 * t + v1 * s1 + v2 * s2 + v3 * s3 + dt * m0 + b1 * m1 + b2 * m2 + b3 * m3
            product += d0 * e0 + d1 * e1 + d2 * e2 + dt * v0 + b1 * v1 + b2 * v2 + b3 * v3
        for k in range(count):
            far = X[o + REACH + k]
            reach = far if far > reach else reach
        left -= count
        o += BLOCK
    return reach, change, product


@inner
def aim(X, points, dt, centre):
    """What the corrector's steps aim at, ``W^-1`` of centring less second-order terms, where the multipliers' steps will be."""
    o, left = U(0), points
    while left > U(0):
        count = min(left, S)
        for k in range(count):
            a = o + k
            w0, w1, w2 = X[a + GRIP_SCALING], X[a + GRIP_SCALING + S], X[a + GRIP_SCALING + S2]
            over = math.sqrt(X[a + GRIP_SCALING + S3])
            eta, f = 1.0 / over, 1.0 / (1.0 + w0)
            d0, d1, d2 = X[a + FORCE_STEP], X[a + FORCE_STEP + S], X[a + FORCE_STEP + S2]
            l0, l1, l2 = cone3.scaled(w0, w1, w2, eta, f, X[a + GRIP], X[a + GRIP + S], X[a + GRIP + S2])
            b0, b1, b2 = cone3.scaled(w0, w1, w2, eta, f, X[a + GRIP_STEP], X[a + GRIP_STEP + S], X[a + GRIP_STEP + S2])
            a0, a1, a2 = cone3.unscaled(w0, w1, w2, over, f, d0, d1, d2)
            v0 = centre - (l0 * l0 + l1 * l1 + l2 * l2) - (a0 * b0 + a1 * b1 + a2 * b2)
            v1 = -2.0 * l0 * l1 - (a0 * b1 + b0 * a1)
            v2 = -2.0 * l0 * l2 - (a0 * b2 + b0 * a2)
            c0 = (l0 * v0 - l1 * v1 - l2 * v2) / cone3.determinant(l0, l1, l2)
            il = 1.0 / l0
            c1, c2 = (v1 - l1 * c0) * il, (v2 - l2 * c0) * il
            x0, x1, x2 = cone3.unscaled(w0, w1, w2, over, f, c0, c1, c2)
            X[a + GRIP_STEP], X[a + GRIP_STEP + S], X[a + GRIP_STEP + S2] = x0, x1, x2
            n, m = X[a + NORMAL], X[a + TANGENTIAL]
            u0, u1, u2, u3 = X[a + HOLD_SCALING], X[a + HOLD_SCALING + S], X[a + HOLD_SCALING + S2], X[a + HOLD_SCALING + S3]
            root = math.sqrt(X[a + HOLD_SCALING + S4])
            one, h = 1.0 / root, 1.0 / (1.0 + u0)
            m0, m1, m2, m3 = cone4.scaled(u0, u1, u2, u3, one, h, X[a + HOLD], X[a + HOLD + S], X[a + HOLD + S2], X[a + HOLD + S3])
            q0, q1, q2, q3 = X[a + HOLD_STEP], X[a + HOLD_STEP + S], X[a + HOLD_STEP + S2], X[a + HOLD_STEP + S3]
            r0, r1, r2, r3 = cone4.scaled(u0, u1, u2, u3, one, h, q0, q1, q2, q3)
            p0, p1, p2, p3 = cone4.unscaled(u0, u1, u2, u3, root, h, dt, n * d0, m * d1, m * d2)
            t0 = centre - (m0 * m0 + m1 * m1 + m2 * m2 + m3 * m3) - (p0 * r0 + p1 * r1 + p2 * r2 + p3 * r3)
            t1 = -2.0 * m0 * m1 - (p0 * r1 + r0 * p1)
            t2 = -2.0 * m0 * m2 - (p0 * r2 + r0 * p2)
            t3 = -2.0 * m0 * m3 - (p0 * r3 + r0 * p3)
            g0 = (m0 * t0 - m1 * t1 - m2 * t2 - m3 * t3) / cone4.determinant(m0, m1, m2, m3)
            im = 1.0 / m0
            g1, g2, g3 = (t1 - m1 * g0) * im, (t2 - m2 * g0) * im, (t3 - m3 * g0) * im
            y0, y1, y2, y3 = cone4.unscaled(u0, u1, u2, u3, root, h, g0, g1, g2, g3)
            X[a + HOLD_STEP], X[a + HOLD_STEP + S], X[a + HOLD_STEP + S2], X[a + HOLD_STEP + S3] = y0, y1, y2, y3
        left -= count
        o += BLOCK


@inner
def advance(X, points, alpha):
    """Take the steps of forces and multipliers."""
    o, left = U(0), points
    while left > U(0):
        count = min(left, S)
        for c in range(10):
            for k in range(count):
                a = o + U(c) * S + k
                X[a + FORCE] += alpha * X[a + FORCE_STEP]
        left -= count
        o += BLOCK


@inner
def rest(X, points):
    """Aims and residuals of zero: forces may then move to take up what is missing of the load, and nothing else."""
    o, left = U(0), points
    while left > U(0):
        count = min(left, S)
        for c in range(10):
            for k in range(count):
                X[o + FORCE_STEP + U(c) * S + k] = 0.0
        for c in range(3):
            for k in range(count):
                X[o + RESIDUAL + U(c) * S + k] = 0.0
        left -= count
        o += BLOCK
