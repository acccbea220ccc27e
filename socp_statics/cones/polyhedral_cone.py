"""Polyhedral cones in R^3 and R^4, known by their faces and by their rays at once.

The boundary is given as simplicial pieces, tuples of rays. The nearest point of the cone lies in the span of one of these pieces
or of a part of one, so that projection is a comparison of linear maps: no iteration, no tolerance.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from itertools import combinations, product

import numpy as np
from numpy.typing import ArrayLike, NDArray

from socp_statics.cones.convex_cone import ConvexCone

Array = NDArray[np.float64]
Pieces = tuple[tuple[int, ...], ...]


class PolyhedralCone(ConvexCone):
    """``{f : A f <= 0}``, which is also the set of non-negative combinations of the rays.

    Args:
        faces: ``A``, one outward normal a row (not necessarily unit), shape (k, d).
        rays: Edges, one a row (not necessarily unit), shape (r, d).
        boundary: Tuples of ray indices whose simplicial cones cover the boundary.
        dual_boundary: The same for the dual cone, whose rays are the negated faces.
    """

    def __init__(
        self, faces: ArrayLike, rays: ArrayLike, boundary: Iterable[tuple[int, ...]], dual_boundary: Iterable[tuple[int, ...]]
    ) -> None:
        self._faces = np.array(faces, dtype=float)
        self._rays = np.array(rays, dtype=float)
        self._boundary: Pieces = tuple(boundary)
        self._dual_boundary: Pieces = tuple(dual_boundary)

    @property
    def dimension(self) -> int:
        """Number of components of a vector of this cone."""
        return int(self._faces.shape[1])

    def faces(self) -> Array:
        """``A`` of ``A f <= 0``: outward normals, not necessarily of unit length, shape (k, d)."""
        return np.array(self._faces)

    def generators(self) -> Array:
        """Rays that span the cone, not necessarily of unit length, shape (r, d)."""
        return np.array(self._rays)

    def dual(self) -> PolyhedralCone:
        """The dual cone: rays and faces change places and sign."""
        return PolyhedralCone(-self._rays, -self._faces, self._dual_boundary, self._boundary)

    def _signed_distance(self, rows: Array) -> Array:
        # Beside one face this is the distance itself; elsewhere outside it is a lower bound, exactly zero on the boundary.
        height = (rows @ self._unit_faces.T).max(axis=1)
        outside = self._is_outside(rows)
        distance: Array = np.where(outside, np.maximum(height, 0.0), np.minimum(height, 0.0))
        beyond = rows[outside]
        distance[outside] = np.maximum(distance[outside], np.linalg.norm(beyond - self._nearest_on_boundary(beyond), axis=1))
        return distance

    def _nearest(self, rows: Array) -> Array:
        nearest = rows.copy()
        outside = self._is_outside(rows)
        nearest[outside] = self._nearest_on_boundary(rows[outside])
        return nearest

    def _is_outside(self, rows: Array) -> NDArray[np.bool_]:
        outside: NDArray[np.bool_] = (rows @ self._faces.T > 0.0).any(axis=1)
        return outside

    def _nearest_on_boundary(self, rows: Array) -> Array:
        """Projection of rows outside the cone: the point that violates the optimality conditions least.

        Comparing distances instead would not tell points apart that are closer to each other than the square root of the precision.
        """
        nearest = np.zeros_like(rows)
        violation = (rows @ self._unit_rays.T).max(axis=1)
        for span, conditions in self._pieces:
            candidate = (rows @ conditions.T).max(axis=1)
            better = candidate < violation
            nearest[better] = rows[better] @ span @ span.T
            violation[better] = candidate[better]
        return nearest

    @cached_property
    def _unit_faces(self) -> Array:
        unit: Array = self._faces / np.linalg.norm(self._faces, axis=1, keepdims=True)
        return unit

    @cached_property
    def _unit_rays(self) -> Array:
        unit: Array = self._rays / np.linalg.norm(self._rays, axis=1, keepdims=True)
        return unit

    @cached_property
    def _pieces(self) -> list[tuple[Array, Array]]:
        """Orthonormal span of every part of the boundary, and the rows c with ``c . f <= 0`` where f projects into it.

        The conditions are those of Moreau: the projection is a non-negative combination of the rays of the part, and what is left
        over points away from every ray of the cone.
        """
        # Rays of different length would be compared by different measures; a power of two rounds none of them.
        _, exponent = np.frexp(np.linalg.norm(self._rays, axis=1, keepdims=True))
        rays = np.ldexp(self._rays, -exponent)
        parts = {part for piece in self._boundary for k in range(len(piece)) for part in combinations(sorted(piece), k + 1)}
        by_size = [np.array(sorted(part for part in parts if len(part) == size)) for size in sorted({len(part) for part in parts})]
        return [piece for chosen in by_size for piece in _spans_and_conditions(rays, chosen)]


def _spans_and_conditions(rays: Array, parts: NDArray[np.int_]) -> Iterable[tuple[Array, Array]]:
    """What ``PolyhedralCone._pieces`` holds, for parts of equal size, shape (p, k)."""
    others = np.array([np.setdiff1d(np.arange(len(rays)), part) for part in parts], dtype=int)
    first = rays[parts[:, :1]]
    # However slender the cone is, differences of its rays keep their directions while the rays themselves become parallel.
    basis = np.concatenate([first, rays[parts[:, 1:]] - first], axis=1)
    length = np.linalg.norm(basis, axis=2, keepdims=True)
    span, triangle = np.linalg.qr(np.swapaxes(basis / length, 1, 2))
    steps = np.linalg.solve(triangle, np.swapaxes(span, 1, 2))
    amounts = steps.copy()
    if parts.shape[1] > 1:
        shortest = length[:, 1:].min(axis=1)
        amounts[:, 0] = shortest * (steps[:, 0] / length[:, 0] - (steps[:, 1:] / length[:, 1:]).sum(axis=1))
    away = rays[others] - first
    away /= np.linalg.norm(away, axis=2, keepdims=True)
    left_over = away - away @ span @ np.swapaxes(span, 1, 2)
    return zip(span, np.concatenate([-amounts, left_over], axis=1), strict=True)


def normal_ray(dimension: int) -> PolyhedralCone:
    """The forces along the contact normal, which is component 2: what is left of a friction cone without friction.

    Args:
        dimension: 3 or 4.

    Returns:
        ``f_n >= 0`` and all else zero; its dual is the half-space ``v_n >= 0``.
    """
    axes = np.eye(dimension)
    others = [i for i in range(dimension) if i != 2]
    faces = np.vstack([axes[others], -axes[others], -axes[2]])
    return PolyhedralCone(faces, axes[2:3], [(0,)], product(*[(i, i + len(others)) for i in range(len(others))]))


def ring(sides: int) -> Pieces:
    """Boundary of a cone over a polygon whose rays are numbered round it: the pairs of neighbours."""
    return tuple((j, (j + 1) % sides) for j in range(sides))


def prism(sides: int) -> Pieces:
    """Boundary of a cone over a prism: rays 0 to sides - 1 round the top, then sides to 2 sides - 1 below them."""
    walls = [piece for i, j in ring(sides) for piece in ((i, j, j + sides), (i, i + sides, j + sides))]
    lids = [(first, first + j, first + j + 1) for first in (0, sides) for j in range(1, sides - 1)]
    return tuple(walls + lids)


def bipyramid(sides: int) -> Pieces:
    """Boundary of a cone over a double pyramid: rays 0 to sides - 1 round the waist, then the upper and the lower apex."""
    return tuple((i, j, apex) for apex in (sides, sides + 1) for i, j in ring(sides))
