"""Scaling and residuals of the points of a program with a common ceiling (see `ceiling`)."""

from __future__ import annotations

import math

from socp_statics.engines.kernel import cone3, cone4
from socp_statics.engines.kernel.arrow_lanes import (
    BLOCK,
    FORCE,
    GRIP,
    GRIP_SCALING,
    GRIP_STEP,
    HOLD,
    HOLD_SCALING,
    HOLD_STEP,
    NORMAL,
    RESIDUAL,
    TANGENTIAL,
    WRENCHES,
)
from socp_statics.engines.kernel.compilation import inner
from socp_statics.engines.kernel.lanes import S2, S3, S4, S, U


@inner
def scale(X, points, t):
    """Scaling points of both cones; the predictor's aims are set, minus the multipliers. Returns the gap and the sum of the ceiling's."""
    gap = total = 0.0
    o, left = U(0), points
    while left > U(0):
        count = min(left, S)
        for k in range(count):
            a = o + k
            z0, z1, z2 = X[a + FORCE], X[a + FORCE + S], X[a + FORCE + S2]
            l0, l1, l2 = X[a + GRIP], X[a + GRIP + S], X[a + GRIP + S2]
            det = cone3.determinant(l0, l1, l2)
            root_s, root_z = 1.0 / math.sqrt(cone3.determinant(z0, z1, z2)), 1.0 / math.sqrt(det)
            product = z0 * l0 + z1 * l1 + z2 * l2
            f = 1.0 / math.sqrt(2.0 + 2.0 * product * root_s * root_z)
            X[a + GRIP_SCALING] = (z0 * root_s + l0 * root_z) * f
            X[a + GRIP_SCALING + S] = (z1 * root_s - l1 * root_z) * f
            X[a + GRIP_SCALING + S2] = (z2 * root_s - l2 * root_z) * f
            X[a + GRIP_SCALING + S3] = root_s * det * root_z
            X[a + GRIP_STEP], X[a + GRIP_STEP + S], X[a + GRIP_STEP + S2] = -l0, -l1, -l2
            s1, s2, s3 = X[a + NORMAL] * z0, X[a + TANGENTIAL] * z1, X[a + TANGENTIAL] * z2
            m0, m1, m2, m3 = X[a + HOLD], X[a + HOLD + S], X[a + HOLD + S2], X[a + HOLD + S3]
            det = cone4.determinant(m0, m1, m2, m3)
            root_s, root_z = 1.0 / math.sqrt(cone4.determinant(t, s1, s2, s3)), 1.0 / math.sqrt(det)
            other = t * m0 + s1 * m1 + s2 * m2 + s3 * m3
            f = 1.0 / math.sqrt(2.0 + 2.0 * other * root_s * root_z)
            X[a + HOLD_SCALING] = (t * root_s + m0 * root_z) * f
            X[a + HOLD_SCALING + S] = (s1 * root_s - m1 * root_z) * f
            X[a + HOLD_SCALING + S2] = (s2 * root_s - m2 * root_z) * f
            X[a + HOLD_SCALING + S3] = (s3 * root_s - m3 * root_z) * f
            X[a + HOLD_SCALING + S4] = root_s * det * root_z
            X[a + HOLD_STEP], X[a + HOLD_STEP + S], X[a + HOLD_STEP + S2], X[a + HOLD_STEP + S3] = -m0, -m1, -m2, -m3
            gap += product + other
            total += m0
        left -= count
        o += BLOCK
    return gap, total


@inner
def residuals(X, points, y, missing):
    """Residual of each point's stationarity, and of the balance; returns the largest of the former.

    Args:
        X: The buffer.
        points: Number of points.
        y: Multipliers of the balance, shape (6,).
        missing: The load, shape (6,); what the forces leave of it, written.
    """
    worst = 0.0
    y0, y1, y2, y3, y4, y5 = y[0], y[1], y[2], y[3], y[4], y[5]
    w0 = w1 = w2 = w3 = w4 = w5 = 0.0
    o, left = U(0), points
    while left > U(0):
        count = min(left, S)
        for c in range(3):
            g, f, h = o + U(c) * WRENCHES, o + U(c) * S, o + U(c + 1) * S
            d = o + (NORMAL if c == 0 else TANGENTIAL)
            for k in range(count):
                a = g + k
                g0, g1, g2, g3, g4, g5 = X[a], X[a + S], X[a + S2], X[a + S3], X[a + S4], X[a + U(5) * S]
                z = X[f + FORCE + k]
                w0 += g0 * z
                w1 += g1 * z
                w2 += g2 * z
                w3 += g3 * z
                w4 += g4 * z
                w5 += g5 * z
                r = g0 * y0 + g1 * y1 + g2 * y2 + g3 * y3 + g4 * y4 + g5 * y5 - X[f + GRIP + k] - X[d + k] * X[h + HOLD + k]
                X[f + RESIDUAL + k] = r
                worst = max(worst, abs(r))
        left -= count
        o += BLOCK
    missing[0] += w0
    missing[1] += w1
    missing[2] += w2
    missing[3] += w3
    missing[4] += w4
    missing[5] += w5
    return worst
