"""Maps and loads of one stance or a batch of stances with equal contacts, made once for all methods of distribution.

Everything is in units of W and size about the mean contact, so that conditioning depends neither on mass nor on place.
"""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from socp_statics.contacts import ContactSet
from socp_statics.contacts.joint import constraint_basis
from socp_statics.distribution.general_solution import OUT_OF_REACH, refuse_out_of_reach
from socp_statics.distribution.generalized_inverses import inverse_of_shares, pseudoinverse
from socp_statics.distribution.load_line import LoadLine, load_line
from socp_statics.spatial import Array
from socp_statics.statics.contact_maps import contact_maps


class Geometry(NamedTuple):
    """Where equal contacts are in a batch of stances, and what they have to balance; SI and world axes.

    Attributes:
        positions: Shape (B, k, 3) [m].
        rotations: R_WC, shape (B, k, 3, 3).
        frictions: Shape (B, k).
        wrench: Reaction wanted, about the mean of the positions, shape (B, 6) [N, N m].
        up: Against gravity, shape (B, 3), of any length, zero without gravity.
    """

    positions: Array
    rotations: Array
    frictions: Array
    wrench: Array
    up: Array


class DistributionQuestion:
    """Maps and loads of a batch in scaled units, made once for all methods.

    Args:
        contacts: Whose structure all stances share.
        geometry: Where they are and what they balance.
        friction_exponent: Of the friction weights.

    Raises:
        InputError: A load that the contacts cannot balance, with the directions that they do not give.
    """

    def __init__(self, contacts: ContactSet, geometry: Geometry, friction_exponent: float = 2.0):
        self.contacts, self.geometry, self.exponent = contacts, geometry, friction_exponent
        bases = [constraint_basis(contact) for contact in contacts]
        self.owner: NDArray[np.int_] = np.repeat(np.arange(len(bases)), [B.shape[1] for B in bases])
        self.is_moment: NDArray[np.bool_] = np.concatenate([np.flatnonzero(B.any(axis=1)) >= 3 for B in bases])
        self.origin = origin = geometry.positions.mean(axis=1)
        self.length = _sizes(contacts, geometry)
        arms = (geometry.positions - origin[:, None]) / self.length[:, None, None]
        f, m = geometry.wrench[:, :3], geometry.wrench[:, 3:]
        self.force = np.maximum(np.linalg.norm(f, axis=1), np.linalg.norm(m, axis=1) / self.length)
        self.force = np.where(self.force > 0.0, self.force, 1.0)
        self.map = contact_maps(arms, geometry.rotations, bases)
        self.wrench = np.hstack([f / self.force[:, None], m / (self.force * self.length)[:, None]])
        self._arms = arms
        self._refuse_out_of_reach()

    @cached_property
    def plain_inverse(self) -> Array:
        """The pseudoinverse of the scaled maps, shape (B, c, 6)."""
        return pseudoinverse(self.map)

    @cached_property
    def unit(self) -> Array:
        """SI per scaled unit of each component, shape (B, c)."""
        return np.where(self.is_moment, (self.force * self.length)[:, None], self.force[:, None])

    @cached_property
    def line(self) -> LoadLine:
        """The line of the load among the contacts, scaled."""
        return load_line(self.wrench, self._arms, self.geometry.up)

    def solve(self, shares: Array) -> Array:
        """Components with the least ``y^T S^-1 y`` of diagonal S, balanced.

        Args:
            shares: Diagonals of S for the scaled components, each >= 0, shape (B, c).

        Returns:
            Shape (B, c) [N, N m].
        """
        y = _times(inverse_of_shares(self.map, shares), self.wrench)
        return self.unit * self._balanced(y)

    def plain(self) -> Array:
        """Components of the scaled pseudoinverse, shape (B, c) [N, N m]."""
        return self.unit * self._balanced(_times(self.plain_inverse, self.wrench))

    def balance(self, components: Array) -> Array:
        """What the components miss of the balance, relative to W, shape (B,)."""
        return np.abs(self.wrench - _times(self.map, components / self.unit)).max(axis=1)

    def in_si(self, shares: Array) -> Array:
        """Shares of components in newtons and newton metres as shares of scaled components."""
        return np.where(self.is_moment, shares / self.length[:, None] ** 2, shares)

    def of_contacts(self, alpha: Array) -> Array:
        """Shares of contacts as shares of their components, shape (B, c)."""
        return alpha[:, self.owner]

    def _balanced(self, y: Array) -> Array:
        return y + _times(self.plain_inverse, self.wrench - _times(self.map, y))

    def _refuse_out_of_reach(self) -> None:
        y = _times(self.plain_inverse, self.wrench)
        left = np.abs(self.wrench - _times(self.map, y)).max(axis=1)
        for i in np.flatnonzero(left > OUT_OF_REACH):
            refuse_out_of_reach(self.map[i], self.wrench[i])


def _times(M: Array, v: Array) -> Array:
    return (M @ v[..., None])[..., 0]


def _sizes(contacts: ContactSet, geometry: Geometry) -> Array:
    """Largest distance between contact points of each stance, 1 m if there is none, shape (B,)."""
    axes = geometry.rotations[..., :2].swapaxes(-1, -2)
    points = np.concatenate([geometry.positions[:, k, None] + c.points_C @ axes[:, k] for k, c in enumerate(contacts)], axis=1)
    largest = np.zeros(len(points))
    for shift in range(1, points.shape[1] // 2 + 1):
        d = points - np.roll(points, shift, axis=1)
        largest = np.maximum(largest, (d * d).sum(axis=2).max(axis=1))
    return np.where(largest > 0.0, np.sqrt(largest), 1.0)
