"""The exact Coulomb friction cone of a point contact."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from socp_statics.cones.choice import ConeChoice
from socp_statics.cones.convex_cone import ConvexCone, finite_coefficient
from socp_statics.cones.polyhedral_cone import normal_ray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FrictionCone(ConvexCone):
    """Reaction forces that do not slide: ``|(f_x, f_y)| <= mu f_n`` with ``f_n >= 0``, in contact axes (t1, t2, n).

    Implements (3.9).

    Always the exact, round cone. The line above (3.9) in the print shows ``>``: that is sliding, the cone is its complement. The
    cone is closed: friction fully used, also the zero force, belongs to it.

    Args:
        mu: Coefficient of friction, finite and >= 0; with 0 the cone is the ray of the normal.

    Raises:
        InputError: A wrong coefficient (field ``friction``).
    """

    mu: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "mu", finite_coefficient(self.mu, "friction"))

    @property
    def dimension(self) -> int:
        """3: (f_x, f_y, f_n)."""
        return 3

    def dual(self) -> ConvexCone:
        """The velocities v with ``v_n >= mu |v_t|``, on which no force of the cone does negative work.

        Returns:
            The friction cone of ``1 / mu``; without friction the half-space ``v_n >= 0``.
        """
        if self.mu == 0.0 or not math.isfinite(1.0 / self.mu):
            return normal_ray(3).dual()
        return FrictionCone(1.0 / self.mu)

    def generators(self, sides: int = 16, heading: float = 0.0) -> Array:
        """Rays on the boundary; they span the inscribed pyramid of the same sides and heading.

        Args:
            sides: Number of rays, >= 3.
            heading: Angle from t1 to the normal of the first face of that pyramid [rad].

        Returns:
            Forces of unit normal component, shape (sides, 3); the normal alone, shape (1, 3), without friction.

        Raises:
            InputError: A wrong ``sides`` or ``heading``.
        """
        directions = ConeChoice("inscribed", sides, heading).edge_directions()
        if self.mu == 0.0:
            return np.array([[0.0, 0.0, 1.0]])
        return np.column_stack([self.mu * directions, np.ones(len(directions))])

    def _signed_distance(self, rows: Array) -> Array:
        f_t, f_n = np.hypot(rows[:, 0], rows[:, 1]), rows[:, 2]
        to_side = (f_t - self.mu * f_n) / math.hypot(1.0, self.mu)
        return np.where(self._below(f_t, f_n), np.hypot(f_t, f_n), to_side)

    def _nearest(self, rows: Array) -> Array:
        f_t, f_n = np.hypot(rows[:, 0], rows[:, 1]), rows[:, 2]
        cosine, sine = 1.0 / math.hypot(1.0, self.mu), self.mu / math.hypot(1.0, self.mu)
        along = np.maximum(sine * f_t + cosine * f_n, 0.0)
        shrink = np.divide(sine * along, f_t, out=np.zeros_like(f_t), where=f_t > 0.0)
        on_side = np.column_stack([shrink[:, None] * rows[:, :2], cosine * along])
        inside = (f_t <= self.mu * f_n) & (f_n >= 0.0)
        return np.where(inside[:, None], rows, on_side)

    def _below(self, f_t: Array, f_n: Array) -> NDArray[np.bool_]:
        """Whether the apex is the nearest point: the polar cone."""
        return (self.mu * f_t + f_n <= 0.0) & (f_n < 0.0)
