"""The cone over an ellipsoid of tangential force and torsional moment: exact projection and distance.

With t = |f_t| and semi-axes e = (mu, gamma) for x = (t, m_z), the nearest boundary point is ``x_i e_i^2 / (e_i^2 + s)`` where the
multiplier s is the root of ``(1 - s) |e_i x_i / (e_i^2 + s)| = f_n``. The left side falls and is convex from the pole at ``-min e_i^2``
to 1, so that Newton's method started to the left of the root climbs to it and needs no safeguard.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from socp_statics.cones.convex_cone import NARROWEST, WIDEST, ConvexCone, finite_coefficient

Array = NDArray[np.float64]

EPSILON = float(np.finfo(float).eps)
# Components below this part of the vector move no result, but would slow Newton's method down next to the pole.
NEGLIGIBLE = 1e-30
MAX_STEPS = 200


@dataclass(frozen=True)
class EllipticCone(ConvexCone):
    """``|(f_x / mu, f_y / mu, m_z / gamma)| <= f_n`` for vectors (f_x, f_y, f_n, m_z).

    Args:
        mu: Semi-axis of the tangential force, > 0.
        gamma: Semi-axis of the torsional moment, > 0 [m].

    Raises:
        InputError: A wrong semi-axis (fields ``friction``, ``torsional_friction``).
    """

    mu: float
    gamma: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "mu", finite_coefficient(self.mu, "friction", positive=True))
        object.__setattr__(self, "gamma", finite_coefficient(self.gamma, "torsional_friction", positive=True))

    @property
    def dimension(self) -> int:
        """4: (f_x, f_y, f_n, m_z)."""
        return 4

    def dual(self) -> EllipticCone:
        """The elliptic cone of the inverse semi-axes."""
        mu, gamma = self._axes
        return EllipticCone(1.0 / mu, 1.0 / gamma)

    @property
    def _axes(self) -> Array:
        return np.clip([self.mu, self.gamma], NARROWEST, WIDEST)

    def _signed_distance(self, rows: Array) -> Array:
        x, f_n = _tangential(rows), rows[:, 2]
        excess = self._excess(x, f_n)
        outside = excess > 0.0
        distance: Array = np.linalg.norm(rows - self._nearest(rows), axis=1)
        # The excess over its steepest slope is a lower bound of the distance that keeps its sign next to the boundary.
        mu, gamma = self._axes
        steepest = np.hypot(max(1.0, mu / gamma), mu)
        distance[outside] = np.maximum(distance[outside], excess[outside] / steepest)
        inside = ~outside & (f_n > 0.0)
        distance[inside] = -_depth(x[inside], f_n[inside], self._axes)
        return distance

    def _nearest(self, rows: Array) -> Array:
        x, f_n, axes = _tangential(rows), rows[:, 2], self._axes
        outside = self._excess(x, f_n) > 0.0
        polar = (np.linalg.norm(x * axes, axis=1) <= -f_n) & outside
        nearest = np.where(polar[:, None], 0.0, rows)
        beside = outside & ~polar
        shrink, normal = _shrink(x[beside], f_n[beside], axes)
        nearest[beside] = np.column_stack([shrink[:, :1] * rows[beside, :2], normal, shrink[:, 1] * rows[beside, 3]])
        return nearest

    def _excess(self, x: Array, f_n: Array) -> Array:
        """Left side minus right side of the defining inequality, times mu [N]."""
        mu, gamma = self._axes
        excess: Array = np.hypot(x[:, 0], (mu / gamma) * x[:, 1]) - mu * f_n
        return excess


def _tangential(rows: Array) -> Array:
    x = np.column_stack([np.hypot(rows[:, 0], rows[:, 1]), np.abs(rows[:, 3])])
    return np.where(x < NEGLIGIBLE, 0.0, x)


def _shrink(x: Array, f_n: Array, axes: Array) -> tuple[Array, Array]:
    """Factors of (t, m_z), shape (n, 2), and normal component of the projection of vectors neither inside nor in the polar cone."""
    pulled = f_n < 0.0
    # Below the contact plane the root s exceeds 1; 1/s is then the root of the same equation for the dual cone.
    e = np.where(pulled[:, None], 1.0 / axes, axes)
    # Rounding next to the boundary of the cone or its polar can push the root just outside its interval.
    root = np.clip(_root(e * x, e**2, np.ones(len(x)), np.abs(f_n)), 0.0, 1.0)[:, None]
    square = axes**2
    shrink = np.where(pulled[:, None], square * root / (square * root + 1.0), square / (square + root))
    return shrink, np.linalg.norm(shrink * x / axes, axis=1)


def _depth(x: Array, f_n: Array, axes: Array) -> Array:
    """Distance from vectors inside the cone to its boundary, shape (n,)."""
    square = axes**2
    # Taken from the squares themselves: the gap of the short axis must be exactly zero at the pole.
    smallest = float(square.min())
    first_guess = _left_of_root(axes * x, np.broadcast_to(square, x.shape), np.ones(len(x)), f_n)
    # The root is found as its distance from the nearer of zero (the boundary) and the pole (the axis), so that neither is blurred.
    shift = np.where(first_guess < -0.5 * smallest, smallest, 0.0)
    gap = square - shift[:, None]
    delta = _root(axes * x, gap, 1.0 + shift, f_n)
    multiplier = delta - shift
    normal = f_n / (1.0 - multiplier)
    slope = np.divide(x, gap + delta[:, None], out=np.zeros_like(x), where=x > 0.0)
    # At the pole the short axis drops out of the equation: the nearest points lie on both sides and the cone itself says where.
    at_pole = (shift > 0.0) & (delta == 0.0)
    short = int(np.argmin(axes))
    other = slope[at_pole, 1 - short] * axes[1 - short]
    slope[at_pole, short] = np.sqrt(np.maximum(normal[at_pole] ** 2 - other**2, 0.0)) / axes[short]
    depth: Array = np.abs(multiplier) * np.sqrt((slope**2).sum(axis=1) + normal**2)
    return depth


def _left_of_root(numerator: Array, gap: Array, limit: Array, target: Array) -> Array:
    """The larger of the two roots that the components of the norm in ``_root`` have alone."""
    top = limit[:, None] * numerator - gap * target[:, None]
    roots: Array = top / (target[:, None] + numerator + np.finfo(float).tiny)
    return np.asarray(roots.max(axis=1))


def _root(numerator: Array, gap: Array, limit: Array, target: Array) -> Array:
    """Root z of ``(limit - z) |numerator_i / (gap_i + z)| = target``, by Newton's method from the left; shapes (n, 2) and (n,)."""
    z = _left_of_root(numerator, gap, limit, target)
    # Where the norm stays below the target up to its pole there is no root, and the pole itself is the answer.
    active = np.flatnonzero((numerator > 0.0).all(axis=1))
    for _ in range(MAX_STEPS):
        if not active.size:
            break
        here, reach = z[active], gap[active] + z[active, None]
        parts = numerator[active] / reach
        size = np.linalg.norm(parts, axis=1)
        excess = (limit[active] - here) * size - target[active]
        slope = size + (limit[active] - here) * (parts / size[:, None] * (parts / reach)).sum(axis=1)
        step = excess / slope
        z[active] = here + np.maximum(step, 0.0)
        active = active[step > EPSILON * (np.abs(here) + reach.min(axis=1))]
    return z
