"""Friction pyramids: the friction cone with its circle replaced by a polygon, inside or outside it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from socp_statics.cones.choice import ConeChoice
from socp_statics.cones.convex_cone import ConvexCone, finite_coefficient, resolvable
from socp_statics.cones.polyhedral_cone import PolyhedralCone, ring
from socp_statics.exceptions import InputError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FrictionPyramid(ConvexCone):
    """Forces with ``n_j . (f_x, f_y) <= m f_n`` for every face j, in contact axes (t1, t2, n).

    Implements (3.12), corrected: the last column is -mu; the printed +mu would exclude every compressive force.

    ``m = mu`` circumscribed, ``m = mu cos(pi / sides)`` inscribed. Both pyramids printed with (3.12), the general one and the
    four-sided one, are circumscribed and so on the unsafe side: with four sides they accept ``|f_t| = sqrt(2) mu f_n``.
    The printed rows start at the heading -pi/2.

    Args:
        mu: Coefficient of friction, finite and >= 0; with 0 the pyramid is the ray of the normal.
        choice: An inscribed or circumscribed choice with its sides and heading.

    Raises:
        InputError: A wrong coefficient (field ``friction``) or the exact cone (field ``cone``).
    """

    mu: float
    choice: ConeChoice

    def __post_init__(self) -> None:
        object.__setattr__(self, "mu", finite_coefficient(self.mu, "friction"))
        if not isinstance(self.choice, ConeChoice) or self.choice.is_exact:
            raise InputError(f"cone must be an inscribed or circumscribed choice for a pyramid, got {self.choice!r}", field="cone")

    @property
    def dimension(self) -> int:
        """3: (f_x, f_y, f_n)."""
        return 3

    @property
    def slope(self) -> float:
        """``m``: the largest tangential force straight at a face, per unit of normal force."""
        return self.mu * self.choice.slope_factor()

    def faces(self) -> Array:
        """``A`` of ``A f <= 0``.

        Returns:
            Outward normals ``(n_j, -m)``, not of unit length, shape (sides, 3); without friction the row ``(0, 0, -1)`` follows,
            because ``f_n >= 0`` is then no longer implied.
        """
        return self._polyhedron.faces()

    def generators(self) -> Array:
        """The edges; edge j lies between the faces j and j + 1.

        Returns:
            Forces of unit normal component, shape (sides, 3); the normal alone, shape (1, 3), without friction.
        """
        return self._polyhedron.generators()

    def dual(self) -> PolyhedralCone:
        """The velocities on which no force of the pyramid does negative work: ``g . v >= 0`` for every edge g."""
        return self._polyhedron.dual()

    @cached_property
    def _polyhedron(self) -> PolyhedralCone:
        mu, normals = resolvable(self.mu), self.choice.face_normals()
        sides, corners = len(normals), polygon_corners(mu, self.choice)
        faces = np.column_stack([normals, np.full(sides, -mu * self.choice.slope_factor())])
        if mu == 0.0:
            return PolyhedralCone(np.vstack([faces, [0.0, 0.0, -1.0]]), [[0.0, 0.0, 1.0]], [(0,)], ring(sides))
        return PolyhedralCone(faces, np.column_stack([corners, np.ones(sides)]), ring(sides), ring(sides))

    def _signed_distance(self, rows: Array) -> Array:
        return self._polyhedron._signed_distance(rows)

    def _nearest(self, rows: Array) -> Array:
        return self._polyhedron._nearest(rows)


def polygon_corners(mu: float, choice: ConeChoice) -> Array:
    """Corners of the polygon that stands for the circle of radius ``mu``, one between each face and the next.

    Args:
        mu: Radius of the circle: the tangential force per unit of normal force.
        choice: An inscribed or circumscribed choice.

    Returns:
        Shape (sides, 2), in contact axes t1, t2; on the circle if inscribed, at ``mu / cos(pi / sides)`` if circumscribed.
    """
    directions = choice.edge_directions()
    return directions * (mu if choice.kind == "inscribed" else mu / math.cos(math.pi / len(directions)))
