"""Cones of R^4 that a turn about the contact normal maps to themselves, with a polyhedral profile."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from socp_statics.cones.convex_cone import ConvexCone
from socp_statics.cones.polyhedral_cone import PolyhedralCone

Array = NDArray[np.float64]


@dataclass(frozen=True)
class RevolvedCone(ConvexCone):
    """All (f_x, f_y, f_n, m_z) for which (|f_t|, f_n, m_z) lies in the profile.

    Distances and projections are those of the profile: the nearest point keeps the direction of the tangential part.

    Args:
        profile: Cone in R^3 with components (f_t, f_n, m_z) that holds (-f_t, f_n, m_z) with every (f_t, f_n, m_z).
    """

    profile: PolyhedralCone

    @property
    def dimension(self) -> int:
        """4: (f_x, f_y, f_n, m_z)."""
        return 4

    def dual(self) -> RevolvedCone:
        """The dual cone: the profile is replaced by its dual."""
        return RevolvedCone(self.profile.dual())

    def _signed_distance(self, rows: Array) -> Array:
        return self.profile._signed_distance(_half_plane(rows))

    def _nearest(self, rows: Array) -> Array:
        flat = _half_plane(rows)
        nearest = self.profile._nearest(flat)
        ratio = np.divide(nearest[:, 0], flat[:, 0], out=np.zeros(len(flat)), where=flat[:, 0] > 0.0)
        return np.column_stack([ratio[:, None] * rows[:, :2], nearest[:, 1:]])


def _half_plane(rows: Array) -> Array:
    return np.column_stack([np.hypot(rows[:, 0], rows[:, 1]), rows[:, 2:]])
