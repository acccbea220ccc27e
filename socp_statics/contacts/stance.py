"""A stance: contacts, centre of mass, mass and loads; all that statics needs to know when no motor matters."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from socp_statics.contacts.contact import Contact
from socp_statics.contacts.contact_set import ContactSet
from socp_statics.contacts.numbers import scalar, vector
from socp_statics.exceptions import InputError
from socp_statics.spatial import Array, moment_about

GRAVITY_W = (0.0, 0.0, -9.81)


@dataclass(frozen=True, eq=False)
class ExternalWrench:
    """A wrench impressed on the robot, in world axes.

    Args:
        force: Force on the robot, shape (3,) [N].
        moment: Moment on the robot about ``point``, shape (3,) [N m].
        point: Where the force acts, shape (3,) [m]; required with a force.
        link: The link of the robot it acts on, the base by default; matters for joint torques only.
        name: What to call it in an error sentence.
    """

    force: Any = (0.0, 0.0, 0.0)
    moment: Any = (0.0, 0.0, 0.0)
    point: Any = None
    link: str | None = None
    name: str = "external wrench"

    def __post_init__(self) -> None:
        f = vector(self.name, "force", self.force, 3, kind="load")
        m = vector(self.name, "moment", self.moment, 3, kind="load")
        if self.point is None and f.any():
            raise InputError(f"load '{self.name}': point is missing, a force needs the point where it acts", name=self.name, field="point")
        p = vector(self.name, "point", (0.0, 0.0, 0.0) if self.point is None else self.point, 3, kind="load")
        object.__setattr__(self, "force", f)
        object.__setattr__(self, "moment", m)
        object.__setattr__(self, "point", None if self.point is None else p)

    def moment_about(self, o: Array) -> Array:
        """Moment of the wrench about ``o``, world axes, shape (3,) [N m]."""
        return self.moment if self.point is None else moment_about(o, self.point, self.force, self.moment)


def as_external_wrench(wrench: Any) -> ExternalWrench:
    """A load given as an object or as a mapping of its fields.

    Raises:
        InputError: Neither, or a key that a load does not have.
    """
    if isinstance(wrench, ExternalWrench):
        return wrench
    known = {"force", "moment", "point", "link", "name"}
    if not isinstance(wrench, Mapping) or set(wrench) - known:
        message = f"load 'external wrench': a table of {', '.join(sorted(known))} is expected, got {wrench!r}"
        raise InputError(message, name="external wrench", field="external_wrenches")
    return ExternalWrench(**wrench)


@dataclass(frozen=True, eq=False)
class Stance:
    """Contacts and the load they have to carry; immutable.

    Args:
        contacts: The contacts.
        com: Centre of mass ``com_W``, shape (3,) [m].
        mass: Mass > 0 [kg].
        gravity: Acceleration of gravity in world axes, shape (3,) [m/s^2].
        external_wrenches: Wrenches impressed on the robot beside gravity.
        inertia: Inertia about the centre of mass in world axes, shape (3, 3) [kg m^2], or None.
        posture: The posture behind the stance where there is a robot (`socp_statics.postures.Posture`), or None.
        torque_limits: Lower and upper joint torques that the forces have to respect, shape (n, 2) [N m], or None.

    Raises:
        InputError: A number is not finite, the mass is not positive, or the inertia is not positive definite.
    """

    contacts: ContactSet
    com: Any
    mass: float
    gravity: Any = GRAVITY_W
    external_wrenches: tuple[ExternalWrench, ...] = field(default=())
    inertia: Any = None
    posture: Any = None
    torque_limits: Array | None = None

    def __post_init__(self) -> None:
        set_ = object.__setattr__
        set_(self, "contacts", as_contact_set(self.contacts))
        set_(self, "com", vector("posture", "com", self.com, 3, kind="stance"))
        set_(self, "mass", scalar("posture", "mass", self.mass, above=0.0, kind="stance"))
        set_(self, "gravity", vector("posture", "gravity", self.gravity, 3, kind="stance"))
        set_(self, "external_wrenches", tuple(as_external_wrench(w) for w in self.external_wrenches))
        if self.inertia is not None:
            inertia = vector("posture", "inertia", self.inertia, 9, shape=(3, 3), kind="stance")
            if not np.allclose(inertia, inertia.T) or np.linalg.eigvalsh(inertia)[0] <= 0:
                raise InputError("stance 'posture': inertia must be symmetric and positive definite", name="posture", field="inertia")
            set_(self, "inertia", inertia)

    @property
    def weight(self) -> float:
        """Mass times the magnitude of gravity [N]."""
        return self.mass * math.hypot(*self.gravity.tolist())


def as_contact_set(contacts: ContactSet | Iterable[Contact]) -> ContactSet:
    """The contacts as a ContactSet, whether they are one already or any iterable of contacts."""
    return contacts if isinstance(contacts, ContactSet) else ContactSet(contacts)


def stance_of(
    contacts: Any,
    com: Any = None,
    mass: float | None = None,
    gravity: Any = None,
    external_wrenches: Iterable[ExternalWrench | dict[str, Any]] = (),
    torque_limits: bool | Mapping[str, Any] = False,
) -> Stance:
    """The stance of a question's arguments.

    Args:
        contacts: Contacts; a Stance, which brings everything else; or a posture, which brings centre of mass and mass.
        com: Centre of mass in world axes, shape (3,) [m].
        mass: Mass [kg]; 1 kg where neither a bound, a limit nor an external wrench makes it matter.
        gravity: Acceleration of gravity, shape (3,) [m/s^2].
        external_wrenches: Wrenches impressed on the robot, as objects or as mappings of their fields.
        torque_limits: True or a mapping of limits, where a robot is given.

    Returns:
        The stance.

    Raises:
        InputError: Something is missing or given twice.
    """
    wrenches = tuple(as_external_wrench(w) for w in external_wrenches)
    posed = not isinstance(contacts, Stance) and hasattr(contacts, "com_jacobian")
    if posed:
        _refuse_twice({"com": com, "mass": mass}, "the posture")
        return contacts.stance(gravity, wrenches, torque_limits)
    if isinstance(contacts, Stance):
        _refuse_twice({"com": com, "mass": mass, "gravity": gravity, "external_wrenches": wrenches or None}, "the stance")
        return contacts if torque_limits is False else _limited(contacts, torque_limits)
    if torque_limits is not False:
        message = "stance 'posture': torque_limits need a robot, contacts alone have no joints"
        raise InputError(message, name="posture", field="torque_limits")
    contact_set = as_contact_set(contacts)
    if com is None:
        raise InputError("stance 'posture': com is missing, give the centre of mass [x, y, z]", name="posture", field="com")
    if mass is None:
        limited = [c.name for c in contact_set if c.normal_force is not None or getattr(c, "limits", None)]
        what = f"contact '{limited[0]}' has limits in newtons" if limited else "there are external wrenches" if wrenches else None
        if what:
            raise InputError(f"stance 'posture': mass is missing, it matters because {what}", name="posture", field="mass")
        mass = 1.0
    return Stance(contact_set, com, mass, GRAVITY_W if gravity is None else gravity, wrenches)


def _refuse_twice(given: dict[str, Any], owner: str) -> None:
    for key, value in given.items():
        if value is not None:
            raise InputError(f"stance 'posture': {key} is given twice, {owner} already has it", name="posture", field=key)


def _limited(stance: Stance, torque_limits: bool | Mapping[str, Any]) -> Stance:
    if stance.posture is None:
        raise InputError("stance 'posture': torque_limits need a robot, this stance has none", name="posture", field="torque_limits")
    return replace(stance, torque_limits=stance.posture.torque_limits(torque_limits))
