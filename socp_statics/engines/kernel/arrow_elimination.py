"""Elimination of the points of a program with a common ceiling (see `ceiling`): 3 x 3 blocks, and 7 x 7 that are left."""

from __future__ import annotations

import math

from socp_statics.engines.kernel.arrow_lanes import (
    BLOCK,
    FACTORS,
    FORCE_STEP,
    GRIP_SCALING,
    GRIP_STEP,
    HEADING,
    HOLD_SCALING,
    HOLD_STEP,
    LAST,
    LEAN,
    NEXT,
    NORMAL,
    PIVOTS,
    REDUCED,
    RESIDUAL,
    SIDE,
    TANGENTIAL,
    WRENCH,
    WRENCHES,
)
from socp_statics.engines.kernel.compilation import inner
from socp_statics.engines.kernel.lanes import S2, S3, S4, S, U
from socp_statics.engines.kernel.normal_matrix import PIVOT

HALF = math.sqrt(0.5)
STILL = 1e-150


@inner
def eliminate(X, points):
    """Factors of each point's 3 x 3 block and what it leaves; returns the ceiling's own term.

    The block is ``W^-2`` of the friction cone and that of the ceiling's on the force. It is formed along axes that keep its small
    eigenvalues from drowning in its large ones: those of the friction cone's scaling, on which its ``W^-2`` is diagonal, where
    friction is the stiffer, else normal and friction. The ceiling's term is its quadratic form at the force that follows it best,
    for the same reason.
    """
    ceiling = 0.0
    o, left = U(0), points
    while left > U(0):
        count = min(left, S)
        for k in range(count):
            a = o + k
            w0, w1, w2, e = X[a + GRIP_SCALING], X[a + GRIP_SCALING + S], X[a + GRIP_SCALING + S2], X[a + GRIP_SCALING + S3]
            u0, u1, u2, u3 = X[a + HOLD_SCALING], X[a + HOLD_SCALING + S], X[a + HOLD_SCALING + S2], X[a + HOLD_SCALING + S3]
            b = X[a + HOLD_SCALING + S4]
            n, m = X[a + NORMAL], X[a + TANGENTIAL]
            slide = math.sqrt(w1 * w1 + w2 * w2)
            moves = slide > STILL
            over = 1.0 / (slide if moves else 1.0)
            c, s = (w1 * over if moves else 1.0), w2 * over
            square = (w0 + slide) * (w0 + slide)
            ahead, aside = c * u2 + s * u3, c * u3 - s * u2
            f0, f1, q2 = n * u1, m * ahead, m * aside
            leans = e * square > 2.0 * b * (f0 * f0 + f1 * f1)
            x, y = (HALF, HALF) if leans else (1.0, 0.0)
            a00 = e * square if leans else e * (2.0 * w0 * w0 - 1.0)
            a10 = 0.0 if leans else -2.0 * e * w0 * slide
            a11 = e / square if leans else e * (2.0 * slide * slide + 1.0)
            q0, q1 = x * f0 - y * f1, y * f0 + x * f1
            h00, h10 = a00 + b * (2.0 * q0 * q0 + x * x * n * n + y * y * m * m), a10 + b * (2.0 * q0 * q1 + x * y * (n * n - m * m))
            h11 = a11 + b * (2.0 * q1 * q1 + y * y * n * n + x * x * m * m)
            h20, h21, h22 = 2.0 * b * q0 * q2, 2.0 * b * q1 * q2, e + b * (2.0 * q2 * q2 + m * m)
            i0 = 1.0 / h00
            l10, l20 = h10 * i0, h20 * i0
            i1 = 1.0 / max(h11 - l10 * h10, PIVOT * h11)
            c21 = h21 - l20 * h10
            l21 = c21 * i1
            i2 = 1.0 / max(h22 - l20 * h20 - l21 * c21, PIVOT * h22)
            X[a + HEADING], X[a + HEADING + S], X[a + LEAN], X[a + LEAN + S] = c, s, x, y
            X[a + FACTORS], X[a + FACTORS + S], X[a + FACTORS + S2] = l10, l20, l21
            X[a + PIVOTS], X[a + PIVOTS + S], X[a + PIVOTS + S2] = i0, i1, i2
            v = -2.0 * b * u0
            g0 = v * q0
            g1 = v * q1 - l10 * g0
            g2 = v * q2 - l20 * g0 - l21 * g1
            at = a + REDUCED + U(6) * S
            X[at], X[at + NEXT], X[at + LAST] = g0, g1, g2
            x2 = -g2 * i2
            x1 = -g1 * i1 - l21 * x2
            x0 = -g0 * i0 - l10 * x1 - l20 * x2
            d0, d1, d2 = n * (x * x0 + y * x1), m * (x * x1 - y * x0), m * x2
            length = math.sqrt(u1 * u1 + u2 * u2 + u3 * u3)
            along = (u1 * d0 + ahead * d1 + aside * d2) / max(length, STILL)
            k2 = (u0 + length) * (u0 + length)
            apart, with_it = 1.0 - along, 1.0 + along
            across = max(d0 * d0 + d1 * d1 + d2 * d2 - along * along, 0.0)
            own = b * (0.5 * (k2 * apart * apart + with_it * with_it / k2) + across)
            ceiling += own + a00 * x0 * x0 + 2.0 * a10 * x0 * x1 + a11 * x1 * x1 + e * x2 * x2
        for i in range(6):
            g = o + U(i) * S
            for k in range(count):
                a, at = g + k, o + k
                g0, g1, g2 = X[a + WRENCH], X[a + WRENCH + WRENCHES], X[a + WRENCH + WRENCHES + WRENCHES]
                c, s, x, y = X[at + HEADING], X[at + HEADING + S], X[at + LEAN], X[at + LEAN + S]
                ahead = c * g1 + s * g2
                v0 = x * g0 - y * ahead
                v1 = y * g0 + x * ahead - X[at + FACTORS] * v0
                X[a + REDUCED] = v0
                X[a + REDUCED + NEXT] = v1
                X[a + REDUCED + LAST] = c * g2 - s * g1 - X[at + FACTORS + S] * v0 - X[at + FACTORS + S2] * v1
        left -= count
        o += BLOCK
    return ceiling


@inner
def gather(X, points, ceiling, A):
    """The matrix that is left for balance (6) and ceiling, lower triangle of shape (7, 7), written."""
    for i in range(7):
        for j in range(7):
            A[i, j] = 0.0
    o, left = U(0), points
    while left > U(0):
        count = min(left, S)
        p = o + PIVOTS
        for i in range(7):
            g = o + REDUCED + U(i) * S
            for j in range(i + 1):
                h = o + REDUCED + U(j) * S
                total = 0.0
                for k in range(count):
                    total += X[g + k] * X[p + k] * X[h + k]
                    total += X[g + NEXT + k] * X[p + S + k] * X[h + NEXT + k]
                    total += X[g + LAST + k] * X[p + S2 + k] * X[h + LAST + k]
                A[i, j] += total
        left -= count
        o += BLOCK
    A[6, 6] = -ceiling


@inner
def condense(X, points, keep, r):
    """Right-hand side that the aims of the multipliers leave for balance and ceiling, shape (7,), written.

    Args:
        X: The buffer; the aims stand where the multipliers' steps will be.
        points: Number of points.
        keep: Share of the residuals to remove.
        r: Written.
    """
    for i in range(7):
        r[i] = 0.0
    o, left = U(0), points
    while left > U(0):
        count = min(left, S)
        held = 0.0
        for k in range(count):
            a = o + k
            n, m, c, s = X[a + NORMAL], X[a + TANGENTIAL], X[a + HEADING], X[a + HEADING + S]
            r0 = X[a + GRIP_STEP] + n * X[a + HOLD_STEP + S] - keep * X[a + RESIDUAL]
            r1 = X[a + GRIP_STEP + S] + m * X[a + HOLD_STEP + S2] - keep * X[a + RESIDUAL + S]
            r2 = X[a + GRIP_STEP + S2] + m * X[a + HOLD_STEP + S3] - keep * X[a + RESIDUAL + S2]
            x, y, ahead = X[a + LEAN], X[a + LEAN + S], c * r1 + s * r2
            v0 = x * r0 - y * ahead
            v1 = y * r0 + x * ahead - X[a + FACTORS] * v0
            X[a + SIDE], X[a + SIDE + S] = v0, v1
            X[a + SIDE + S2] = c * r2 - s * r1 - X[a + FACTORS + S] * v0 - X[a + FACTORS + S2] * v1
            held += X[a + HOLD_STEP]
        p, v = o + PIVOTS, o + SIDE
        for i in range(7):
            g = o + REDUCED + U(i) * S
            total = 0.0
            for k in range(count):
                total += X[g + k] * X[p + k] * X[v + k]
                total += X[g + NEXT + k] * X[p + S + k] * X[v + S + k]
                total += X[g + LAST + k] * X[p + S2 + k] * X[v + S2 + k]
            r[i] += total
        r[6] -= held
        left -= count
        o += BLOCK


@inner
def expand(X, points, x):
    """Steps of the forces from those of the balance's multipliers and of the ceiling, x, shape (7,)."""
    o, left = U(0), points
    while left > U(0):
        count = min(left, S)
        for i in range(7):
            g, v = o + REDUCED + U(i) * S, o + SIDE
            x_i = x[i]
            for k in range(count):
                X[v + k] -= X[g + k] * x_i
                X[v + S + k] -= X[g + NEXT + k] * x_i
                X[v + S2 + k] -= X[g + LAST + k] * x_i
        for k in range(count):
            a = o + k
            c, s, p, q = X[a + HEADING], X[a + HEADING + S], X[a + LEAN], X[a + LEAN + S]
            x2 = X[a + SIDE + S2] * X[a + PIVOTS + S2]
            x1 = X[a + SIDE + S] * X[a + PIVOTS + S] - X[a + FACTORS + S2] * x2
            x0 = X[a + SIDE] * X[a + PIVOTS] - X[a + FACTORS] * x1 - X[a + FACTORS + S] * x2
            ahead = p * x1 - q * x0
            X[a + FORCE_STEP] = p * x0 + q * x1
            X[a + FORCE_STEP + S] = c * ahead - s * x2
            X[a + FORCE_STEP + S2] = s * ahead + c * x2
        left -= count
        o += BLOCK
