"""The simple static test: does a generalised inverse, which knows no friction, happen to find forces inside the cones?"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.cones import ConeChoice, FrictionCone, FrictionPyramid, SoftFingerCone
from socp_statics.cones.choice import cone_choice
from socp_statics.contacts import Contact, ContactSet, ExternalWrench, Handle, SoftFingerContact, Stance, contact_from_statement
from socp_statics.contacts.contact import COMPONENTS
from socp_statics.contacts.joint import constraint_basis, soft_basis
from socp_statics.contacts.numbers import scalar, vector
from socp_statics.contacts.stance import stance_of
from socp_statics.distribution import weighted_inverse
from socp_statics.exceptions import InputError
from socp_statics.spatial import Array
from socp_statics.statics.contact_maps import contact_map, gravity_wrench
from socp_statics.statics.units import units_of
from socp_statics.wrench_cones import contact_wrench_cone

INVERSES = ("pseudoinverse", "friction_weighted")
# Share of W that a contact wrench may lie outside its cone, and that the sum of the wrenches may miss the load.
INSIDE = 1e-8


@dataclass(frozen=True, eq=False)
class ContactCheck:
    """The wrench that the inverse gives to one contact.

    Attributes:
        contact: Name.
        force: World axes, shape (3,) [N].
        moment: About the contact's position, world axes, shape (3,) [N m].
        distance: From the contact's wrench cone, bounds and limits, ``|(f, m / length)|`` with the length of `contact_wrench_cone` [N].
        failure: In words, None inside.
    """

    contact: str
    force: Array
    moment: Array
    distance: float
    failure: str | None


@dataclass(frozen=True, eq=False)
class SimpleTest:
    """The answer of the simple static test.

    Attributes:
        holds: Every contact wrench lies in its cone and they balance the load: the posture is weakly stable. False says nothing
            about stability, only that this inverse fails.
        inverse: "pseudoinverse", "friction_weighted" or "weighted".
        balance: What the wrenches leave of the load, in units of W.
        contacts: One check a contact.
        cone: Exact cones or pyramids.
    """

    holds: bool
    inverse: str
    balance: float
    contacts: tuple[ContactCheck, ...]
    cone: ConeChoice

    @property
    def reading(self) -> str:
        """The answer in words."""
        if self.holds:
            return "every contact wrench lies in its cone"
        said = [f"{check.contact} {check.failure}" for check in self.contacts if check.failure]
        missed = [f"the contacts cannot balance {self.balance:.2g} W of the load"] if self.balance > INSIDE else []
        return "; ".join(missed + said)

    def as_record(self) -> dict[str, Any]:
        """The entry of a record."""
        return {
            "holds": self.holds,
            "balance": self.balance,
            "reading": self.reading,
            "contacts": [
                {"contact": c.contact, "force": c.force, "moment": c.moment, "distance": c.distance, "failure": c.failure}
                for c in self.contacts
            ],
        }


def simple_static_test(
    contacts: Any,
    com: Any = None,
    mass: float | None = None,
    *,
    inverse: str = "pseudoinverse",
    weights: ArrayLike | None = None,
    length: float = 1.0,
    cone: str | ConeChoice = "exact",
    sides: int | None = None,
    heading: float | None = None,
    gravity: Any = None,
    external_wrenches: Iterable[ExternalWrench | dict[str, Any]] = (),
) -> SimpleTest:
    """Contact wrenches ``F = C_cC^-W G_C`` of a generalised inverse, checked against the contacts' wrench cones.

    Implements (3.76), with a correction of what is said about it: it does not "usually" succeed at high friction. The pseudoinverse
    shares the weight evenly, whatever the CoM, and moves both centres of pressure with it: it leaves the soles sideways, not by
    sliding, on a flat floor with HOAP-2's soles for a CoM 31.5 mm from the middle, whose feet stand at 39 mm. Its answer depends
    on the unit of length.

    A test that holds proves weak stability by its forces; one that fails proves nothing. Joint-torque limits are not looked at.

    Args:
        contacts: Contacts; a Stance; or a Posture.
        com: Centre of mass in world axes, shape (3,) [m].
        mass: [kg].
        inverse: "pseudoinverse"; or "friction_weighted", which makes friction components dear, weights 1 / mu^2 (weights mu, as in
            print with (3.53), would make them cheap just where friction is low).
        weights: Weights of the transmitted components instead, contact by contact in the order (fx, fy, fz, mx, my, mz), > 0.
        length: Length that counts as one for moments [m]; 1 m is the chapter's plain pseudoinverse in SI units.
        cone: "exact", "inscribed" or "circumscribed", or a ConeChoice.
        sides: Sides of the pyramids.
        heading: Heading of the pyramids [rad].
        gravity: Acceleration of gravity, shape (3,) [m/s^2].
        external_wrenches: Wrenches impressed on the robot.

    Returns:
        The answer.

    Raises:
        InputError: A number, name or choice is wrong.
    """
    stance = stance_of(contacts, com, mass, gravity, external_wrenches)
    choice = cone_choice(cone, sides, heading)
    unit = scalar("simple test", "length", length, above=0.0, kind="argument")
    bases = [constraint_basis(contact) for contact in stance.contacts]
    C = contact_map(stance.contacts, stance.com, bases)
    word, W = _weights(stance.contacts, bases, inverse, weights)
    moments = np.concatenate([np.argmax(B, axis=0) >= 3 for B in bases])
    in_length = np.array([1.0, 1.0, 1.0, *[1.0 / unit] * 3])[:, None]
    components = weighted_inverse(in_length * C, W / np.where(moments, unit**2, 1.0)) @ (in_length[:, 0] * _reaction(stance))
    units = units_of(stance)
    rest = (C @ components - _reaction(stance)) / units.wrench
    starts = np.cumsum([0, *[B.shape[1] for B in bases]])
    checks = tuple(
        _check(contact, B @ components[a:b], choice, INSIDE * units.force)
        for contact, B, a, b in zip(stance.contacts, bases, starts, starts[1:], strict=False)
    )
    balance = float(np.linalg.norm(rest))
    return SimpleTest(balance <= INSIDE and not any(c.failure for c in checks), word, balance, checks, choice)


def _reaction(stance: Stance) -> Array:
    """G_C: what the contacts have to supply about the centre of mass, world axes, shape (6,)."""
    wrench = gravity_wrench(stance.mass, stance.gravity, stance.com, stance.com)
    for load in stance.external_wrenches:
        wrench = wrench - np.concatenate([load.force, load.moment_about(stance.com)])
    return wrench


def _weights(contacts: ContactSet, bases: list[Array], inverse: str, weights: ArrayLike | None) -> tuple[str, Array]:
    count = sum(B.shape[1] for B in bases)
    if weights is not None:
        values = vector("simple test", "weights", weights, count, kind="argument")
        if (values <= 0.0).any():
            raise InputError("argument 'simple test': weights must be > 0", name="simple test", field="weights")
        return "weighted", values
    if inverse not in INVERSES:
        raise InputError(f"inverse must be one of {', '.join(INVERSES)}, got {inverse!r}", name="simple test", field="inverse")
    if inverse == "pseudoinverse":
        return inverse, np.ones(count)
    rows = []
    for contact, B in zip(contacts, bases, strict=True):
        rubbing = soft_basis(contact).sum(axis=1) @ B > 0.0
        rows.append(np.where(rubbing, 1.0 / contact.friction**2, 1.0) if contact.friction else np.ones(B.shape[1]))
    return inverse, np.concatenate(rows)


def _check(contact: Contact, wrench_C: Array, choice: ConeChoice, allowed: float) -> ContactCheck:
    cone = contact_wrench_cone(_without_bounds(contact), cone=choice)
    outside = float(cone.distance(wrench_C))
    short, words = _beyond_bounds(contact, wrench_C, cone.length)
    failure = _failure(contact, wrench_C, choice, allowed) if outside > allowed else words if short > allowed else None
    rotated = np.kron(np.eye(2), contact.rotation) @ wrench_C
    distance = max(outside, short)
    return ContactCheck(contact.name, rotated[:3], rotated[3:], distance if failure else 0.0, failure)


def _without_bounds(contact: Contact) -> Contact:
    statement = contact.statement()
    if statement.keys().isdisjoint(("normal_force", "limits")):
        return contact
    return contact_from_statement({key: value for key, value in statement.items() if key not in ("normal_force", "limits")})


def _beyond_bounds(contact: Contact, F: Array, length: float) -> tuple[float, str]:
    """How far a bound or limit in newtons is missed [N], and in which words."""
    limits = dict(contact.limits) if isinstance(contact, Handle) else {}
    if contact.normal_force is not None:
        limits["fz"] = contact.normal_force
    worst, words = 0.0, ""
    for component, (lo, hi) in limits.items():
        i = COMPONENTS.index(component)
        missed = max(lo - F[i], F[i] - hi) / (1.0 if i < 3 else length)
        if missed > worst:
            worst, words = missed, f"carries {component} = {F[i]:.4g} {'N' if i < 3 else 'N m'}, outside [{lo:g}, {hi:g}]"
    return worst, words


def _failure(contact: Contact, F: Array, choice: ConeChoice, allowed: float) -> str:
    """Why a wrench lies outside the cone of its contact: the first of pulling, tipping, sliding, turning."""
    f, m = F[:3], F[3:]
    if f[2] < -allowed:
        return f"would have to pull with {-f[2]:.4g} N"
    if len(contact.points_C) > 1 and f[2] > allowed:
        beyond = _outside(contact.points_C, np.array([-m[1], m[0]]) / f[2])
        if beyond * f[2] > allowed:
            return f"has its centre of pressure {1e3 * beyond:.4g} mm outside the contact"
    point = FrictionCone(contact.friction) if choice.is_exact else FrictionPyramid(contact.friction, choice)
    if float(np.asarray(point.distance(f))) > allowed:
        needed = float(np.hypot(f[0], f[1])) / f[2] if f[2] > allowed else np.inf
        return f"slides: needs friction {needed:.4g}, has {contact.friction:g}" + ("" if choice.is_exact else " in a pyramid")
    if isinstance(contact, SoftFingerContact):
        distance = SoftFingerCone(contact.friction, contact.torsional_friction, contact.shape, choice).distance(F[[0, 1, 2, 5]])
        return f"spins: force and moment {m[2]:.4g} N m about its normal exceed its friction by {float(np.asarray(distance)):.4g} N"
    beside = float(np.hypot(f[0], f[1]))
    return f"turns about its normal: moment {m[2]:.4g} N m beside {beside:.4g} N of friction is more than its points hold"


def _outside(points: Array, p: Array) -> float:
    """Distance of a point from a convex polygon or segment, 0 inside [m]."""
    edges = np.roll(points, -1, axis=0) - points
    r = p - points
    along = np.clip((r * edges).sum(axis=1) / (edges * edges).sum(axis=1), 0.0, 1.0)
    away = float(np.linalg.norm(r - along[:, None] * edges, axis=1).min())
    inside = len(points) > 2 and bool((edges[:, 0] * r[:, 1] - edges[:, 1] * r[:, 0] >= 0.0).all())
    return 0.0 if inside else away
