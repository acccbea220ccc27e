"""Nesterov-Todd algebra of one second-order cone ``s_0 >= |(s_1, s_2)|``, in scalars.

With ``J = diag(1, -1, -1)`` and the scaling point w of slack s and multiplier z, ``W = eta [[w_0, w'], [w, I + w w' / (1 + w_0)]]``
maps both to one point, ``W z = W^-1 s``.
"""

from __future__ import annotations

import math

from socp_statics.engines.kernel.compilation import inner

TINY = 1e-300


@inner
def determinant(s0, s1, s2):
    """``s_0^2 - |s|^2`` without cancellation near the boundary, never below the smallest positive numbers."""
    length = math.sqrt(s1 * s1 + s2 * s2)
    det = (s0 - length) * (s0 + length)
    return det if det > TINY else TINY


@inner
def inverse_square(w0, w1, w2, e, d0, d1, d2):
    """``W^-2 d = e (2 (J w) (J w)' - J) d`` with ``e = eta^-2``."""
    u = 2.0 * (w0 * d0 - w1 * d1 - w2 * d2)
    return e * (u * w0 - d0), e * (d1 - u * w1), e * (d2 - u * w2)


@inner
def scaled(w0, w1, w2, eta, f, d0, d1, d2):
    """``W d`` with ``f = 1 / (1 + w_0)``."""
    along = w1 * d1 + w2 * d2
    t = d0 + along * f
    return eta * (w0 * d0 + along), eta * (d1 + t * w1), eta * (d2 + t * w2)


@inner
def unscaled(w0, w1, w2, inverse_eta, f, d0, d1, d2):
    """``W^-1 d`` with ``f = 1 / (1 + w_0)``."""
    along = w1 * d1 + w2 * d2
    t = along * f - d0
    return inverse_eta * (w0 * d0 - along), inverse_eta * (d1 + t * w1), inverse_eta * (d2 + t * w2)


@inner
def to_boundary(s0, s1, s2, d0, d1, d2):
    """One over the step that takes s to the boundary along d; not positive where it never gets there."""
    length = math.sqrt(s1 * s1 + s2 * s2)
    c = (s0 - length) * (s0 + length)
    b = s0 * d0 - s1 * d1 - s2 * d2
    a = d0 * d0 - d1 * d1 - d2 * d2
    # For a point inside the cone b^2 >= a c (the reversed Cauchy-Schwarz inequality); rounding alone makes it negative.
    root = b * b - a * c
    root = root if root > 0.0 else 0.0
    return (math.sqrt(root) - b) / c
