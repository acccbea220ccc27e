"""What spans a wrench cone: forces at points inside their cones, half-lines and lines of handles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from socp_statics.cones import ConeChoice, FrictionPyramid, SoftFingerCone
from socp_statics.contacts import Contact, Handle, SoftFingerContact
from socp_statics.contacts.contact import COMPONENTS
from socp_statics.exceptions import InputError
from socp_statics.spatial import Array, skew


@dataclass(frozen=True, eq=False)
class Generators:
    """``{sum_i M_i c_i + H' a + N' b : c_i in K_i, a >= 0}`` with c_i = (f_x, f_y, f_n, m_z) at point i.

    Attributes:
        columns: M, wrench of a unit of each component of each point, shape (n, 6, 4).
        friction: mu of the points, shape (n,).
        torsion: gamma of the points, 0 where they transmit no moment, shape (n,) [m].
        box: Whether force and moment of a soft finger are limited one by one, shape (n,).
        sections: Corners of each point's pyramid at unit normal force, shapes (m_i, 4); none where cones are exact.
        half_lines: H, shape (h, 6).
        lines: N, shape (l, 6).
    """

    columns: Array
    friction: Array
    torsion: Array
    box: Array
    sections: tuple[Array, ...]
    half_lines: Array
    lines: Array

    @property
    def polyhedral(self) -> bool:
        """Whether finitely many rays span the cone."""
        return bool(self.sections) or not self.friction.any()

    @cached_property
    def edges(self) -> Array:
        """Wrenches of the pyramids' edges, each of unit normal force, shape (r, 6)."""
        if self.sections:
            return np.vstack([corners @ M.T for corners, M in zip(self.sections, self.columns, strict=True)])
        return np.array(self.columns[:, :, 2])

    def rays(self) -> Array:
        """The edges of the pyramids and the half-lines, shape (r + h, 6); the pyramids' only where cones are not exact."""
        return np.vstack([self.edges, self.half_lines])

    def best(self, y: Array) -> Array:
        """Of each point the force of unit normal component that a twist does most work on, inside the exact cone.

        Args:
            y: Twist, shape (6,).

        Returns:
            Components (f_x, f_y, 1, m_z), shape (n, 4).
        """
        a = np.einsum("nij,i->nj", self.columns, y)
        work = np.column_stack([self.friction[:, None] * a[:, :2], self.torsion * a[:, 3]])
        return self._sharing(work, np.ones(len(a)))

    def on_boundary(self, f: Array) -> Array:
        """Forces pushed away from the normal until friction is used up.

        Args:
            f: Components (f_x, f_y, f_n, m_z) of each point inside its cone, shape (n, 4).
        """
        return self._sharing(np.column_stack([_over(f[:, :2], self.friction[:, None]), _over(f[:, 3], self.torsion)]), f[:, 2])

    def _sharing(self, use: Array, normal: Array) -> Array:
        """Forces of given normal components that use friction up in proportion to (x, y, spin); a box does not share it."""
        slide, spin = np.hypot(use[:, 0], use[:, 1]), np.abs(use[:, 2])
        both = np.hypot(slide, spin)
        force, moment = np.where(self.box, slide, both), np.where(self.box, spin, both)
        return np.column_stack([
            (self.friction * normal)[:, None] * _over(use[:, :2], force[:, None]),
            normal,
            self.torsion * normal * _over(use[:, 2], moment),
        ])  # fmt: skip

    def support(self, y: Array) -> float:
        """Largest ``y . F`` of unit normal force, inf where half-lines or lines add to it alone.

        Args:
            y: Twist, shape (6,).
        """
        if (self.half_lines @ y > 0.0).any() or (self.lines @ y != 0.0).any():
            return np.inf
        wrenches = self.edges if self.polyhedral else np.einsum("nij,nj->ni", self.columns, self.best(y))
        return float((wrenches @ y).max(initial=-np.inf))

    def scaled(self, unit: Array) -> Generators:
        """The generators of wrenches that are divided by a unit of each component.

        Args:
            unit: Shape (6,).
        """
        return replace(self, columns=self.columns / unit[:, None], half_lines=self.half_lines / unit, lines=self.lines / unit)


def generators_of(contacts: Sequence[Contact], choice: ConeChoice, transports: Sequence[Array]) -> Generators:
    """What some contacts span together.

    Args:
        contacts: The contacts.
        choice: Exact cones or pyramids.
        transports: One a contact: takes a wrench in its contact frame about its position to where the sum is taken, shape (6, 6).

    Raises:
        InputError: Bounds or limits in newtons, which leave no cone.
    """
    columns: list[Array] = []
    friction: list[float] = []
    torsion: list[float] = []
    box: list[bool] = []
    sections: list[Array] = []
    half_lines: list[Array] = [np.zeros((0, 6))]
    lines: list[Array] = [np.zeros((0, 6))]
    for contact, X in zip(contacts, transports, strict=True):
        if isinstance(contact, Handle):
            one_way, both_ways = _handle(contact)
            half_lines.append(one_way @ X.T)
            lines.append(both_ways @ X.T)
            continue
        _refuse_bounds(contact)
        soft = isinstance(contact, SoftFingerContact) and not contact.frictionless
        section = None if choice.is_exact else _section(contact, choice)
        for x, y in contact.points_C:
            M = np.zeros((6, 4))
            M[:3, :3] = np.eye(3)
            M[3:, :3] = skew((x, y, 0.0))
            M[5, 3] = 1.0
            columns.append(X @ M)
            friction.append(contact.friction)
            torsion.append(contact.torsional_friction if soft else 0.0)  # type: ignore[attr-defined]
            box.append(soft and contact.shape == "box")  # type: ignore[attr-defined]
            if section is not None:
                sections.append(section)
    return Generators(
        np.array(columns).reshape(-1, 6, 4), np.array(friction), np.array(torsion), np.array(box, dtype=bool), tuple(sections),
        np.vstack(half_lines), np.vstack(lines),
    )  # fmt: skip


def _over(a: Array, b: Array) -> Array:
    """``a / b``, zero where b is zero."""
    return np.divide(a, b, out=np.zeros_like(a), where=b > 0.0)


def _section(contact: Contact, choice: ConeChoice) -> Array:
    """Corners (f_x, f_y, 1, m_z) of a contact point's pyramid, shape (m, 4)."""
    if isinstance(contact, SoftFingerContact):
        return SoftFingerCone(contact.friction, contact.torsional_friction, contact.shape, choice).generators()
    edges = FrictionPyramid(contact.friction, choice).generators()
    return np.column_stack([edges, np.zeros(len(edges))])


def _handle(contact: Handle) -> tuple[Array, Array]:
    """Wrenches that a handle transmits one way only, and both ways, in its contact frame, shapes (h, 6) and (l, 6)."""
    one_way, both_ways = [], []
    for word in contact.transmits:
        lo, hi = contact.limits.get(word, (-np.inf, np.inf))
        if not {lo, hi} <= {-np.inf, 0.0, np.inf}:
            message = f"contact '{contact.name}': limits.{word} makes no cone of its wrenches, 0 or infinite limits are expected"
            raise InputError(message, name=contact.name, field=f"limits.{word}")
        axis = np.eye(6)[COMPONENTS.index(word)]
        if lo < 0.0 < hi:
            both_ways.append(axis)
        elif lo < hi:
            one_way.append(axis if hi > 0.0 else -axis)
    return np.array(one_way).reshape(-1, 6), np.array(both_ways).reshape(-1, 6)


def _refuse_bounds(contact: Contact) -> None:
    if contact.normal_force not in (None, (0.0, np.inf)):
        message = f"contact '{contact.name}': normal_force bounds make no cone of its wrenches, none or [0, inf] is expected"
        raise InputError(message, name=contact.name, field="normal_force")
