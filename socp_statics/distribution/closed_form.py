"""The distributions in closed form side by side, for one stance or a batch of stances with equal contacts.

Each is ``F = C^-W F_e`` with a diagonal W of its own. What is left of the balance, by rounding or because contacts without a share are
needed after all, is added by the scaled pseudoinverse, so that every method balances whatever the contacts can balance. All numbers are
in units of W and size about the mean contact.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from socp_statics.contacts import ContactSet
from socp_statics.contacts.joint import constraint_basis
from socp_statics.distribution.barycentric_rule import barycentric_shares
from socp_statics.distribution.friction_weights import friction_weights
from socp_statics.distribution.general_solution import OUT_OF_REACH, refuse_out_of_reach
from socp_statics.distribution.generalized_inverses import inverse_of_shares, pseudoinverse
from socp_statics.distribution.lever_rule import lever_shares
from socp_statics.distribution.load_line import LoadLine, load_line
from socp_statics.exceptions import InputError
from socp_statics.registry import nearest
from socp_statics.spatial import Array, skew
from socp_statics.statics.contact_maps import contact_maps


class Geometry(NamedTuple):
    """Where equal contacts are in a batch of stances, and what they have to balance; SI and world axes.

    Attributes:
        positions: Shape (B, k, 3) [m].
        rotations: R_WC, shape (B, k, 3, 3).
        frictions: Shape (B, k).
        wrench: Reaction wanted, about the world origin, shape (B, 6) [N, N m].
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

    def __init__(self, contacts: ContactSet, geometry: Geometry, friction_exponent: float = 1.0):
        self.contacts, self.geometry, self.exponent = contacts, geometry, friction_exponent
        bases = [constraint_basis(contact) for contact in contacts]
        self.owner: NDArray[np.int_] = np.repeat(np.arange(len(bases)), [B.shape[1] for B in bases])
        self.is_moment: NDArray[np.bool_] = np.concatenate([np.flatnonzero(B.any(axis=1)) >= 3 for B in bases])
        self.origin = origin = geometry.positions.mean(axis=1)
        self.length = _sizes(contacts, geometry)
        arms = (geometry.positions - origin[:, None]) / self.length[:, None, None]
        f, m = geometry.wrench[:, :3], geometry.wrench[:, 3:] - np.cross(origin, geometry.wrench[:, :3])
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


class ClosedForm(NamedTuple):
    """A distribution in closed form.

    Attributes:
        line: What it is, in one line.
        shares: Inverse weights of the scaled components, shape (B, c); None where all are equal.
        refusal: Why contacts do not suit it, or None.
        by_lever: Whether it shares the load among contacts by where it acts.
    """

    line: str
    shares: Callable[[DistributionQuestion], Array] | None
    refusal: Callable[[ContactSet], str | None] = lambda contacts: None
    by_lever: bool = False


def _pseudoinverse(q: DistributionQuestion) -> Array:
    return q.in_si(np.ones_like(q.unit))


def _friction_weighted(q: DistributionQuestion) -> Array:
    return q.in_si(1.0 / friction_weights(q.contacts, q.exponent, q.geometry.frictions))


def _statics_consistent(q: DistributionQuestion) -> Array:
    return q.in_si(q.of_contacts(lever_shares(q.line)))


def _barycentric(q: DistributionQuestion) -> Array:
    return q.of_contacts(barycentric_shares(q.line))


def _no_lever(contacts: ContactSet) -> str | None:
    if len(contacts) not in (2, 3):
        return f"the lever rule is for two or three contacts, here are {len(contacts)}"
    for contact in contacts:
        if constraint_basis(contact).shape[1] < 6:
            carried = constraint_basis(contact).shape[1]
            return f"the lever rule is for contacts that carry a whole wrench, '{contact.name}' has {carried} of 6 components"
    return None


CLOSED_FORMS = {
    "pseudoinverse": ClosedForm("least sum of squares in newtons and newton metres", _pseudoinverse),
    "scaled_pseudoinverse": ClosedForm("least sum of squares with moments over the size of the contacts", None),
    "friction_weighted": ClosedForm("as the pseudoinverse, friction components dear where friction is low", _friction_weighted),
    "statics_consistent": ClosedForm(
        "the lever rule for two or three contacts that carry a whole wrench", _statics_consistent, _no_lever, by_lever=True
    ),
    "barycentric": ClosedForm("the lever rule for any number of contacts", _barycentric, by_lever=True),
}


def closed_forms(question: DistributionQuestion, methods: Sequence[str] | None = None) -> dict[str, Array]:
    """Components by method.

    Args:
        question: Maps and loads.
        methods: Names of `CLOSED_FORMS`; by default all that suit the contacts.

    Returns:
        Shapes (B, c) [N, N m].

    Raises:
        InputError: An unknown method, or one that does not suit the contacts.
    """
    if methods is None:
        methods = [name for name, form in CLOSED_FORMS.items() if form.refusal(question.contacts) is None]
    out = {}
    for name in methods:
        shares = checked_form(name, question.contacts).shares
        out[name] = question.plain() if shares is None else question.solve(shares(question))
    return out


def inverses(question: DistributionQuestion, method: str) -> Array:
    """C^# of a method, to the world origin and in SI: what its components are to any wrench, the shares being those of the load.

    Args:
        question: Maps and loads.
        method: A name of `CLOSED_FORMS`.

    Returns:
        Shape (B, c, 6).
    """
    shares = checked_form(method, question.contacts).shares
    scaled = question.plain_inverse if shares is None else inverse_of_shares(question.map, shares(question))
    balanced = scaled + question.plain_inverse @ (np.eye(6) - question.map @ scaled)
    units = np.repeat(np.stack([question.force, question.force * question.length], axis=1), 3, axis=1)
    to_origin = np.tile(np.eye(6), (len(balanced), 1, 1))
    to_origin[:, 3:, :3] = -skew(question.origin)
    return question.unit[:, :, None] * balanced / units[:, None, :] @ to_origin


def checked_form(method: str, contacts: ContactSet) -> ClosedForm:
    """The closed form of a name, if it suits the contacts.

    Raises:
        InputError: An unknown method, or one that does not suit the contacts.
    """
    if method not in CLOSED_FORMS:
        raise InputError(f"method {method!r} is not known{nearest(method, CLOSED_FORMS)}", name=method, field="method")
    form = CLOSED_FORMS[method]
    reason = form.refusal(contacts)
    if reason is not None:
        raise InputError(f"method '{method}': {reason}", name=method, field="method")
    return form


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
