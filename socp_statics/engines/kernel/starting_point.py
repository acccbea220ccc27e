"""The starting point of a program with five unknowns: a least-squares slack and least-norm multipliers, moved into the cones."""

from __future__ import annotations

import math

from socp_statics.engines.kernel.compilation import inner
from socp_statics.engines.kernel.lanes import (
    BLOCK,
    MULTIPLIER,
    REACH,
    RESIDUAL,
    RHS,
    ROW0,
    ROW1,
    ROW2,
    S2,
    S3,
    S4,
    SLACK,
    S,
    U,
    column,
    row,
)
from socp_statics.engines.kernel.normal_matrix import solve_factored


@inner
def normal_matrix_of_rows(X, lanes):
    """``G' G``: the normal matrix of the starting point, lower triangle by rows."""
    m00 = m10 = m11 = m20 = m21 = m22 = m30 = m31 = m32 = m33 = m40 = m41 = m42 = m43 = m44 = 0.0
    o, left = U(0), lanes
    while left > U(0):
        count = min(left, S)
        for c in range(3):
            g = o + U(c) * ROW1
            for k in range(count):
                a = g + k
                g0, g1, g2, g3, g4 = X[a], X[a + S], X[a + S2], X[a + S3], X[a + S4]
                m00 += g0 * g0
                m10 += g1 * g0
                m11 += g1 * g1
                m20 += g2 * g0
                m21 += g2 * g1
                m22 += g2 * g2
                m30 += g3 * g0
                m31 += g3 * g1
                m32 += g3 * g2
                m33 += g3 * g3
                m40 += g4 * g0
                m41 += g4 * g1
                m42 += g4 * g2
                m43 += g4 * g3
                m44 += g4 * g4
        left -= count
        o += BLOCK
    return m00, m10, m11, m20, m21, m22, m30, m31, m32, m33, m40, m41, m42, m43, m44


@inner
def largest(X, o, count, field, value):
    """The largest number of a field, or the value given if that is larger."""
    for k in range(count):
        x = X[o + field + k]
        value = x if x > value else value
    return value


@inner
def start(X, lanes, factors, q, y):
    """Least-squares slack and least-norm multipliers, moved into the cones; returns the norm of the right-hand side."""
    r0 = r1 = r2 = r3 = r4 = 0.0
    size = 0.0
    o, left = U(0), lanes
    while left > U(0):
        count = min(left, S)
        for k in range(count):
            a = o + k
            h0, h1, h2 = X[a + RHS], X[a + RHS + S], X[a + RHS + S2]
            size += h0 * h0 + h1 * h1 + h2 * h2
            r0 += column(X, a, h0, h1, h2)
            r1 += column(X, a + S, h0, h1, h2)
            r2 += column(X, a + S2, h0, h1, h2)
            r3 += column(X, a + S3, h0, h1, h2)
            r4 += column(X, a + S4, h0, h1, h2)
        left -= count
        o += BLOCK
    y0, y1, y2, y3, y4 = solve_factored(factors, r0, r1, r2, r3, r4)
    r0, r1, r2, r3, r4 = solve_factored(factors, -q[0], -q[1], -q[2], -q[3], -q[4])
    low_s = low_z = -math.inf
    o, left = U(0), lanes
    while left > U(0):
        count = min(left, S)
        for k in range(count):
            a = o + k
            s0 = X[a + RHS] - row(X, a + ROW0, y0, y1, y2, y3, y4)
            s1 = X[a + RHS + S] - row(X, a + ROW1, y0, y1, y2, y3, y4)
            s2 = X[a + RHS + S2] - row(X, a + ROW2, y0, y1, y2, y3, y4)
            z0 = row(X, a + ROW0, r0, r1, r2, r3, r4)
            z1 = row(X, a + ROW1, r0, r1, r2, r3, r4)
            z2 = row(X, a + ROW2, r0, r1, r2, r3, r4)
            X[a + SLACK], X[a + SLACK + S], X[a + SLACK + S2] = s0, s1, s2
            X[a + MULTIPLIER], X[a + MULTIPLIER + S], X[a + MULTIPLIER + S2] = z0, z1, z2
            X[a + REACH] = math.sqrt(s1 * s1 + s2 * s2) - s0
            X[a + RESIDUAL] = math.sqrt(z1 * z1 + z2 * z2) - z0
        low_s = largest(X, o, count, REACH, low_s)
        low_z = largest(X, o, count, RESIDUAL, low_z)
        left -= count
        o += BLOCK
    size = math.sqrt(size)
    more_s = max(1.0, size) + max(low_s, 0.0) if low_s > -1e-8 else 0.0
    more_z = 1.0 + max(low_z, 0.0) if low_z > -1e-8 else 0.0
    o, left = U(0), lanes
    while left > U(0):
        count = min(left, S)
        for k in range(count):
            X[o + SLACK + k] += more_s
            X[o + MULTIPLIER + k] += more_z
        left -= count
        o += BLOCK
    y[0], y[1], y[2], y[3], y[4] = y0, y1, y2, y3, y4
    return size
