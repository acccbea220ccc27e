"""What is asked about a region: contacts and load, checked, as cheaply as a batch needs it."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from socp_statics.contacts import ContactSet, Stance
from socp_statics.contacts.stance import as_contact_set, stance_of
from socp_statics.exceptions import InputError
from socp_statics.spatial import Array
from socp_statics.statics.units import loads_row

UNIT_LOAD = np.array([0.0, 0.0, -9.81, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 9.81, 0.0, np.nan, np.nan])


class RegionQuestion(NamedTuple):
    """What is asked about one set of contacts; ``given`` is the stance where there is one, else its arguments."""

    contacts: ContactSet
    given: Stance | None
    height: float
    mass: float | None
    with_com: bool

    @property
    def compiled(self) -> bool:
        """Whether nothing but friction limits the forces, so that the kernel's compiled programs apply."""
        return self.contacts.friction_points is not None and (self.given is None or self.given.torque_limits is None)

    def stance(self) -> Stance:
        """The stance."""
        return self.given or stance_of(self.contacts, (0.0, 0.0, self.height), self.mass)

    def load(self) -> Array:
        """The load as the compiled programs read it, shape (13,); the last two are nan where no CoM margin is asked for."""
        if self.given is None:
            return UNIT_LOAD
        x, y, z = self.given.com.tolist()
        return np.array([*loads_row(self.given), z, *((x, y) if self.with_com else (math.nan, math.nan))])


def region_question(contacts: Any, height: float, mass: float | None, gravity: Any, wrenches: Any, torque_limits: Any) -> RegionQuestion:
    """Check the arguments of a question; contacts alone, for which neither mass nor height matters, are not made a stance.

    Args:
        contacts: Contacts, a Stance, or a Posture.
        height: Of the centre of mass, where contacts alone are given [m].
        mass: Mass [kg], or None.
        gravity: Acceleration of gravity, or None.
        wrenches: Wrenches impressed on the robot.
        torque_limits: Whether joint torques are limited, and how.

    Raises:
        InputError: A number is wrong; gravity is zero or horizontal.
    """
    with_com = isinstance(contacts, Stance) or hasattr(contacts, "com_jacobian")
    if not with_com:
        contacts = as_contact_set(contacts)
        free = contacts.friction_points is not None and height == 0.0
        if free and mass is None and gravity is None and torque_limits is False and not wrenches:
            return RegionQuestion(contacts, None, height, mass, False)
    stance = stance_of(contacts, None if with_com else (0.0, 0.0, height), mass, gravity, wrenches, torque_limits)
    if abs(stance.gravity[2]) <= 1e-9 * math.hypot(*stance.gravity.tolist()):
        raise InputError("gravity must not be zero or horizontal for a support region", name="posture", field="gravity")
    return RegionQuestion(stance.contacts, stance, height, mass, with_com)
