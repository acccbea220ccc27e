"""Nesterov-Todd algebra of one second-order cone ``s_0 >= |(s_1, s_2, s_3)|``, in scalars; see `cone3`."""

from __future__ import annotations

import math

from socp_statics.engines.kernel.compilation import inner
from socp_statics.engines.kernel.cone3 import TINY


@inner
def determinant(s0, s1, s2, s3):
    """``s_0^2 - |s|^2`` without cancellation near the boundary, never below the smallest positive numbers."""
    length = math.sqrt(s1 * s1 + s2 * s2 + s3 * s3)
    det = (s0 - length) * (s0 + length)
    return det if det > TINY else TINY


@inner
def inverse_square(u0, u1, u2, u3, e, d0, d1, d2, d3):
    """``W^-2 d = e (2 (J u) (J u)' - J) d`` with ``e = eta^-2``."""
    v = 2.0 * (u0 * d0 - u1 * d1 - u2 * d2 - u3 * d3)
    return e * (v * u0 - d0), e * (d1 - v * u1), e * (d2 - v * u2), e * (d3 - v * u3)


@inner
def scaled(u0, u1, u2, u3, eta, f, d0, d1, d2, d3):
    """``W d`` with ``f = 1 / (1 + u_0)``."""
    along = u1 * d1 + u2 * d2 + u3 * d3
    t = d0 + along * f
    return eta * (u0 * d0 + along), eta * (d1 + t * u1), eta * (d2 + t * u2), eta * (d3 + t * u3)


@inner
def unscaled(u0, u1, u2, u3, inverse_eta, f, d0, d1, d2, d3):
    """``W^-1 d`` with ``f = 1 / (1 + u_0)``."""
    along = u1 * d1 + u2 * d2 + u3 * d3
    t = along * f - d0
    return inverse_eta * (u0 * d0 - along), inverse_eta * (d1 + t * u1), inverse_eta * (d2 + t * u2), inverse_eta * (d3 + t * u3)


@inner
def to_boundary(s0, s1, s2, s3, d0, d1, d2, d3):
    """One over the step that takes s to the boundary along d; not positive where it never gets there."""
    length = math.sqrt(s1 * s1 + s2 * s2 + s3 * s3)
    c = (s0 - length) * (s0 + length)
    b = s0 * d0 - s1 * d1 - s2 * d2 - s3 * d3
    a = d0 * d0 - d1 * d1 - d2 * d2 - d3 * d3
    root = b * b - a * c
    root = root if root > 0.0 else 0.0
    return (math.sqrt(root) - b) / c
