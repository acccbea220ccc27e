"""The 5 x 5 normal matrix: its factors and its solutions, in scalars."""

from __future__ import annotations

from socp_statics.engines.kernel.compilation import inner
from socp_statics.engines.kernel.cone3 import TINY

# Degenerate optima, one contact carrying everything, leave pivots that are rounding alone.
PIVOT = 1e-15


@inner
def factor(matrix):
    """``L D L'`` of a symmetric matrix given by rows of its lower triangle; pivots are floored at a share of the diagonal."""
    m00, m10, m11, m20, m21, m22, m30, m31, m32, m33, m40, m41, m42, m43, m44 = matrix
    i0 = 1.0 / max(m00, TINY)
    l10, l20, l30, l40 = m10 * i0, m20 * i0, m30 * i0, m40 * i0
    i1 = 1.0 / max(m11 - l10 * m10, PIVOT * m11, TINY)
    c21, c31, c41 = m21 - l20 * m10, m31 - l30 * m10, m41 - l40 * m10
    l21, l31, l41 = c21 * i1, c31 * i1, c41 * i1
    i2 = 1.0 / max(m22 - l20 * m20 - l21 * c21, PIVOT * m22, TINY)
    c32, c42 = m32 - l30 * m20 - l31 * c21, m42 - l40 * m20 - l41 * c21
    l32, l42 = c32 * i2, c42 * i2
    i3 = 1.0 / max(m33 - l30 * m30 - l31 * c31 - l32 * c32, PIVOT * m33, TINY)
    c43 = m43 - l40 * m30 - l41 * c31 - l42 * c32
    l43 = c43 * i3
    i4 = 1.0 / max(m44 - l40 * m40 - l41 * c41 - l42 * c42 - l43 * c43, PIVOT * m44, TINY)
    return l10, l20, l30, l40, l21, l31, l41, l32, l42, l43, i0, i1, i2, i3, i4


@inner
def solve_factored(factors, r0, r1, r2, r3, r4):
    """Solution of ``L D L' x = r``."""
    l10, l20, l30, l40, l21, l31, l41, l32, l42, l43, i0, i1, i2, i3, i4 = factors
    r1 -= l10 * r0
    r2 -= l20 * r0 + l21 * r1
    r3 -= l30 * r0 + l31 * r1 + l32 * r2
    r4 -= l40 * r0 + l41 * r1 + l42 * r2 + l43 * r3
    r4 *= i4
    r3 = r3 * i3 - l43 * r4
    r2 = r2 * i2 - l32 * r3 - l42 * r4
    r1 = r1 * i1 - l21 * r2 - l31 * r3 - l41 * r4
    r0 = r0 * i0 - l10 * r1 - l20 * r2 - l30 * r3 - l40 * r4
    return r0, r1, r2, r3, r4


@inner
def with_pad(m):
    """A matrix with 1 added to its last diagonal term, which holds an unused fifth unknown at zero."""
    return m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7], m[8], m[9], m[10], m[11], m[12], m[13], m[14] + 1.0
