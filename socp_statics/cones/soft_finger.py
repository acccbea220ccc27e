"""The cone of a soft fingertip: a friction force together with a torsional moment about the normal."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from socp_statics.cones.choice import ConeChoice
from socp_statics.cones.convex_cone import NARROWEST, ConvexCone, finite_coefficient, resolvable
from socp_statics.cones.elliptic_cone import EllipticCone
from socp_statics.cones.friction_pyramid import polygon_corners
from socp_statics.cones.polyhedral_cone import PolyhedralCone, bipyramid, normal_ray, prism, ring
from socp_statics.cones.revolved_cone import RevolvedCone
from socp_statics.exceptions import InputError

Array = NDArray[np.float64]

SHAPES = ("elliptic", "box")


@dataclass(frozen=True)
class SoftFingerCone(ConvexCone):
    """Reactions (f_x, f_y, f_n, m_z) of a soft fingertip that neither slides nor spins, in contact axes (t1, t2, n).

    Implements (3.11).

    Shape ``"box"`` is (3.11) as printed, ``|f_t| <= mu f_n`` and ``|m_z| <= gamma f_n``: it lets friction be used up twice, by the
    force and by the moment. Shape ``"elliptic"`` lies inside it: ``|(f_x, f_y, (mu / gamma) m_z)| <= mu f_n``.

    The linearised forms keep, for every face j of the choice,
    ``n_j . f_t <= mu f_n`` and ``|m_z| <= gamma f_n`` circumscribed, either shape;
    ``n_j . f_t <= mu cos(pi / sides) f_n`` and ``|m_z| <= gamma f_n`` inscribed, box;
    ``n_j . f_t / (mu cos(pi / sides)) + |m_z| / gamma <= f_n`` inscribed, elliptic.

    Args:
        mu: Coefficient of friction, finite and >= 0; with 0 no moment is left either, only the ray of the normal.
        gamma: Coefficient of torsional friction, finite and > 0 [m].
        shape: ``"elliptic"`` or ``"box"``.
        choice: The exact cone, or a pyramid inside or outside it.

    Raises:
        InputError: Wrong coefficient, shape or choice (fields ``friction``, ``torsional_friction``, ``shape``, ``cone``).
    """

    mu: float
    gamma: float
    shape: str = "elliptic"
    choice: ConeChoice = field(default_factory=ConeChoice)

    def __post_init__(self) -> None:
        object.__setattr__(self, "mu", finite_coefficient(self.mu, "friction"))
        object.__setattr__(self, "gamma", finite_coefficient(self.gamma, "torsional_friction", positive=True))
        if self.shape not in SHAPES:
            raise InputError(f"shape must be one of {', '.join(SHAPES)}, got {self.shape!r}", field="shape")
        if not isinstance(self.choice, ConeChoice):
            raise InputError(f"cone must be a ConeChoice, got {self.choice!r}", field="cone")

    @property
    def dimension(self) -> int:
        """4: (f_x, f_y, f_n, m_z)."""
        return 4

    def dual(self) -> ConvexCone:
        """The twists (v_x, v_y, v_n, w_z) on which no reaction of the cone does negative work."""
        return self._cone.dual()

    def faces(self) -> Array:
        """``A`` of ``A f <= 0`` of a linearised cone: outward normals, not of unit length.

        Returns:
            Circumscribed, or inscribed box: ``(n_j, -m, 0)``, then ``(0, 0, -gamma, 1)`` and ``(0, 0, -gamma, -1)``, shape (sides + 2, 4).
            Inscribed elliptic: ``(n_j, -m, m / gamma)``, then ``(n_j, -m, -m / gamma)``, shape (2 sides, 4).
            Without friction: the seven faces of the normal ray.

        Raises:
            InputError: The cone is exact and has no faces (field ``cone``).
        """
        if self.choice.is_exact or not isinstance(self._cone, PolyhedralCone):
            raise InputError("cone must be inscribed or circumscribed to have faces, got 'exact'", field="cone")
        return self._cone.faces()

    def generators(self, sides: int = 16, heading: float = 0.0) -> Array:
        """Rays of unit normal component.

        Args:
            sides: Number of rays round the normal of an exact cone, >= 3. A linearised cone ignores it: its rays are exact.
            heading: Angle from t1 to the normal of the first face between those rays [rad]; ignored likewise.

        Returns:
            Shape (r, 4). Of an exact cone points on its boundary, which span a cone inside it: the rays of the inscribed form for
            the box, and those with further rings of latitude between its waist and its two apexes for the elliptic cone.

        Raises:
            InputError: A wrong ``sides`` or ``heading``.
        """
        if isinstance(self._cone, PolyhedralCone):
            return self._cone.generators()
        directions = ConeChoice("inscribed", sides, heading).edge_directions()
        # Whole steps from the waist keep the rays of the contract's inscribed form among these.
        steps = np.arange(1, (len(directions) + 1) // 2)
        upward = np.pi * steps / len(directions)
        latitudes = np.array([np.pi / 2, -np.pi / 2]) if self.shape == "box" else np.concatenate([[0.0], upward, -upward])
        reach = np.ones(2) if self.shape == "box" else np.cos(latitudes)
        rings = [_ring_of_rays(self.mu * r * directions, self.gamma * np.sin(angle)) for r, angle in zip(reach, latitudes, strict=True)]
        if self.shape == "elliptic":
            rings.append(_apexes(self.gamma))
        return np.vstack(rings)

    @cached_property
    def _cone(self) -> ConvexCone:
        if self.mu == 0.0:
            return normal_ray(4)
        # However small, a coefficient that is not zero leaves the torsional moment its room.
        mu, gamma = max(resolvable(self.mu), NARROWEST), max(resolvable(self.gamma), NARROWEST)
        if not self.choice.is_exact:
            return _pyramid(mu, gamma, self.shape, self.choice)
        return EllipticCone(mu, gamma) if self.shape == "elliptic" else RevolvedCone(_box_profile(mu, gamma))

    def _signed_distance(self, rows: Array) -> Array:
        return self._cone._signed_distance(rows)

    def _nearest(self, rows: Array) -> Array:
        return self._cone._nearest(rows)


def _pyramid(mu: float, gamma: float, shape: str, choice: ConeChoice) -> PolyhedralCone:
    normals, corners = choice.face_normals(), polygon_corners(mu, choice)
    sides, slope = len(normals), mu * choice.slope_factor()
    if shape == "elliptic" and choice.kind == "inscribed":
        faces = np.vstack([_face_rows(normals, slope, sign * slope / gamma) for sign in (1.0, -1.0)])
        rays = np.vstack([_ring_of_rays(corners, 0.0), _apexes(gamma)])
        return PolyhedralCone(faces, rays, bipyramid(sides), prism(sides))
    faces = np.vstack([_face_rows(normals, slope, 0.0), [[0.0, 0.0, -gamma, 1.0], [0.0, 0.0, -gamma, -1.0]]])
    rays = np.vstack([_ring_of_rays(corners, gamma), _ring_of_rays(corners, -gamma)])
    return PolyhedralCone(faces, rays, prism(sides), bipyramid(sides))


def _box_profile(mu: float, gamma: float) -> PolyhedralCone:
    """``|f_t| <= mu f_n`` and ``|m_z| <= gamma f_n`` in the components (f_t, f_n, m_z)."""
    faces = [[1.0, -mu, 0.0], [0.0, -gamma, 1.0], [-1.0, -mu, 0.0], [0.0, -gamma, -1.0]]
    rays = [[mu, 1.0, gamma], [-mu, 1.0, gamma], [-mu, 1.0, -gamma], [mu, 1.0, -gamma]]
    return PolyhedralCone(faces, rays, ring(4), ring(4))


def _face_rows(normals: Array, slope: float, torsion: float) -> Array:
    ones = np.ones(len(normals))
    return np.column_stack([normals, -slope * ones, torsion * ones])


def _ring_of_rays(tangential: Array, torsion: float) -> Array:
    ones = np.ones(len(tangential))
    return np.column_stack([tangential, ones, torsion * ones])


def _apexes(gamma: float) -> Array:
    return np.array([[0.0, 0.0, 1.0, gamma], [0.0, 0.0, 1.0, -gamma]])
