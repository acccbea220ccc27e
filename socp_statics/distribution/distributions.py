"""Closed-form distributions of stances: one at a time, or thousands with equal contacts at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.contacts import ContactSet, Stance
from socp_statics.contacts.joint import constraint_basis
from socp_statics.contacts.stance import GRAVITY_W, as_contact_set, stance_of
from socp_statics.distribution.closed_form import closed_forms
from socp_statics.distribution.scaled_question import DistributionQuestion, Geometry
from socp_statics.exceptions import InputError
from socp_statics.spatial import Array, cross


@dataclass(frozen=True, eq=False)
class Distributions:
    """Contact wrenches of a batch by method.

    Attributes:
        contacts: Their structure.
        components: By method, contact components in contact frames, shape (B, c) [N, N m].
        balance: By method, largest share of W that is missing from the balance, shape (B,).
        rotations: R_WC, shape (B, k, 3, 3).
    """

    contacts: ContactSet
    components: Mapping[str, Array]
    balance: Mapping[str, Array]
    rotations: Array

    def wrenches(self, method: str) -> Array:
        """``[force; moment]`` of every contact about its position, world axes, shape (B, k, 6) [N, N m]."""
        return wrenches_W(self.contacts, self.components[method], self.rotations)


def wrenches_W(contacts: ContactSet, components: Array, rotations: Array) -> Array:
    """Contact components as wrenches about the contacts' positions in world axes.

    Args:
        contacts: The contacts.
        components: Shape (..., c) [N, N m].
        rotations: R_WC, shape (..., k, 3, 3).

    Returns:
        Shape (..., k, 6).
    """
    local = wrenches_C(contacts, components)
    turned = rotations[..., None, :, :] @ local.reshape(*local.shape[:-1], 2, 3)[..., None]
    return turned.reshape(local.shape)


def wrenches_C(contacts: ContactSet, components: Array) -> Array:
    """Contact components as wrenches in contact frames, zero where a contact transmits nothing, shape (..., k, 6)."""
    out = np.zeros((*components.shape[:-1], len(contacts), 6))
    start = 0
    for k, contact in enumerate(contacts):
        rows = np.flatnonzero(constraint_basis(contact).any(axis=1))
        out[..., k, rows] = components[..., start : start + len(rows)]
        start += len(rows)
    return out


def load_reaction(stance: Stance, point_W: Array) -> Array:
    """Reaction to gravity and external wrenches: what the contacts have to add up to.

    Args:
        stance: The stance.
        point_W: What moments are about, shape (3,) [m]; far from the contacts they lose digits.

    Returns:
        Shape (6,) [N, N m].
    """
    weight = stance.mass * stance.gravity
    out = -np.concatenate([weight, cross(stance.com - point_W, weight)])
    for wrench in stance.external_wrenches:
        out[:3] -= wrench.force
        out[3:] -= wrench.moment_about(point_W)
    return out


def question_of(stances: Sequence[Stance], friction_exponent: float = 2.0) -> DistributionQuestion:
    """The question of stances with equal contacts.

    Args:
        stances: At least one.
        friction_exponent: Of the friction weights.

    Raises:
        InputError: No stance, contacts that differ, or a load out of reach.
    """
    if not stances:
        raise InputError("stances: at least one is expected, got none", name="stances", field="stances")
    first = [(c.structure, c.friction == 0.0) for c in stances[0].contacts]
    for stance in stances[1:]:
        if [(c.structure, c.friction == 0.0) for c in stance.contacts] != first:
            names = ", ".join(stances[0].contacts.names)
            message = f"stances: all must have the contacts of the first ({names}), one has {', '.join(stance.contacts.names)}"
            raise InputError(message, name="stances", field="stances")
    sets = [list(stance.contacts) for stance in stances]
    positions = np.array([[c.position for c in contacts] for contacts in sets])
    geometry = Geometry(
        positions=positions,
        rotations=np.array([[c.rotation for c in contacts] for contacts in sets]),
        frictions=np.array([[c.friction for c in contacts] for contacts in sets]),
        wrench=np.array([load_reaction(stance, centre) for stance, centre in zip(stances, positions.mean(axis=1), strict=True)]),
        up=np.array([-stance.gravity for stance in stances]),
    )
    return DistributionQuestion(stances[0].contacts, geometry, friction_exponent)


def distribute_many(
    stances: Any,
    coms: ArrayLike | None = None,
    mass: float = 1.0,
    *,
    positions: ArrayLike | None = None,
    rotations: ArrayLike | None = None,
    methods: Sequence[str] | None = None,
    friction_exponent: float = 2.0,
    gravity: ArrayLike = GRAVITY_W,
) -> Distributions:
    """The closed-form distributions of many stances with equal contacts.

    Args:
        stances: Stances or postures; or contacts, whose placement ``positions`` and ``rotations`` may change from stance to stance.
        coms: With contacts, centres of mass, shape (B, 3) [m].
        mass: With contacts, the mass [kg].
        positions: With contacts, their positions, shape (B, k, 3) [m]; their own by default.
        rotations: With contacts, R_WC, shape (B, k, 3, 3); their own by default.
        methods: Closed-form methods; by default all that suit the contacts.
        friction_exponent: Of the friction weights, 1 or 2.
        gravity: With contacts, shape (3,) [m/s^2].

    Returns:
        Components and balance by method.

    Raises:
        InputError: Stances that differ in their contacts, arrays that do not fit, an unknown method, or a load out of reach.
    """
    if coms is None:
        given = [stances] if isinstance(stances, Stance) or hasattr(stances, "com_jacobian") else list(stances)
        question = question_of([stance_of(stance) for stance in given], friction_exponent)
    else:
        contacts = as_contact_set(stances)
        geometry = _geometry(contacts, np.asarray(coms, dtype=float), mass, positions, rotations, np.asarray(gravity, dtype=float))
        question = DistributionQuestion(contacts, geometry, friction_exponent)
    components = closed_forms(question, methods)
    balance = {name: question.balance(F) for name, F in components.items()}
    return Distributions(question.contacts, components, balance, question.geometry.rotations)


def _geometry(
    contacts: ContactSet, coms: Array, mass: float, positions: ArrayLike | None, rotations: ArrayLike | None, gravity: Array
) -> Geometry:
    if coms.ndim != 2 or coms.shape[1] != 3 or not len(coms):
        raise InputError(f"coms: shape (B, 3) is expected, got {coms.shape}", name="coms", field="coms")
    B, k = len(coms), len(contacts)
    own_r, own_R = np.array([c.position for c in contacts]), np.array([c.rotation for c in contacts])
    r = np.broadcast_to(own_r, (B, k, 3)) if positions is None else np.asarray(positions, dtype=float)
    R = np.broadcast_to(own_R, (B, k, 3, 3)) if rotations is None else np.asarray(rotations, dtype=float)
    for word, array, shape in (("positions", r, (B, k, 3)), ("rotations", R, (B, k, 3, 3))):
        if array.shape != shape:
            raise InputError(f"{word}: shape {shape} is expected, got {array.shape}", name=word, field=word)
    force = np.broadcast_to(-mass * gravity, (B, 3))
    mu = np.broadcast_to(np.array([c.friction for c in contacts]), (B, k))
    return Geometry(r, R, mu, np.hstack([force, cross(coms - r.mean(axis=1), force)]), np.broadcast_to(-gravity, (B, 3)))
