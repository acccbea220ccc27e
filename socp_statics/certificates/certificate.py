"""Certificates: forces for "stable", a motion that no admissible force can prevent for "unstable"."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from socp_statics.certificates.contact_motion import ContactMotion, Motion, contact_motion, least_work
from socp_statics.certificates.reading import contact_states, reading
from socp_statics.cones.choice import ConeChoice
from socp_statics.statics.statics_data import StaticsData

MOTION_TOLERANCE = 1e-7
STILL = 1e-9


@dataclass(frozen=True)
class ForcesCertificate:
    """The forces of the answer themselves: they balance the load and lie inside every cone.

    Attributes:
        balance: Norm of the wrench that they leave over, over the load.
        cone: How far they are outside a cone, bound or limit at most, over the load.
    """

    balance: float = field(default=0.0, compare=False)
    cone: float = field(default=0.0, compare=False)

    def __repr__(self) -> str:
        """What it certifies, and how well."""
        kept = f"are within {self.cone:.1e} of it of" if self.cone > 0.0 else "keep"
        return f"<ForcesCertificate: forces that balance the load to {self.balance:.1e} of it and {kept} every cone, bound and limit>"

    def as_record(self) -> dict[str, Any]:
        """The record's entry."""
        return {"kind": "forces"}


class MotionCertificate:
    """A motion on which load, admissible forces and torques do positive work whatever they are: a certificate, not a forecast.

    Attributes:
        linear: Velocity of ``point``, world axes, shape (3,) [m/s].
        angular: Angular velocity, world axes, shape (3,) [rad/s].
        point: Reference point, world axes, shape (3,) [m].
        power: Least power of load, forces and torques on the motion, > 0 [W].
        joints: Rates of the joints that move, where torque limits matter [rad/s].
    """

    def __init__(self, data: StaticsData, motion: Motion, at_contacts: ContactMotion, power: float):
        self._data, self._motion, self._at_contacts = data, motion, at_contacts
        self.linear, self.angular = data.units.twist_in_si(motion.twist)
        self.point = data.units.origin.copy()
        self.power = float(power * data.units.force)
        names, length = data.torques.names, data.units.length
        self.joints = {names[k]: float(motion.joints[k] / length) for k in np.flatnonzero(np.abs(motion.joints) > STILL)}

    def __repr__(self) -> str:
        """What it certifies: the motion in words, and the power that no admissible force takes away."""
        return f"<MotionCertificate: {self.reading}; load and forces, whatever they are, do at least {self.power:.4g} W on it>"

    @cached_property
    def reading(self) -> str:
        """The motion in words."""
        return reading(self._data, self._motion, self._at_contacts)

    @cached_property
    def contacts(self) -> dict[str, str]:
        """What each contact does: "holds", "slides" or "opens"."""
        return contact_states(self._data, self._motion, self._at_contacts)

    def as_record(self) -> dict[str, Any]:
        """The record's entry."""
        return {
            "kind": "motion",
            "linear": self.linear.tolist(),
            "angular": self.angular.tolist(),
            "point": self.point.tolist(),
            "joints": dict(self.joints),
            "power": self.power,
            "reading": self.reading,
            "contacts": dict(self.contacts),
        }


def motion_certificate(data: StaticsData, cone: ConeChoice, motion: Motion) -> MotionCertificate | None:
    """The certificate of a motion, if it is one.

    Args:
        data: The stance's arrays.
        cone: Exact cones or pyramids.
        motion: Candidate: the multipliers of the scaled balance and of the torque limits.

    Returns:
        The certificate, scaled so that the largest of |v|, |w| times the size and the joint rates times the size is one; None if
        admissible forces and torques could prevent the motion.
    """
    twist, joints = motion
    size = max(float(np.linalg.norm(twist[:3])), float(np.linalg.norm(twist[3:])), float(np.abs(joints).max(initial=0.0)))
    if not np.isfinite(size) or size == 0.0:
        return None
    motion = Motion(twist / size, joints / size)
    at_contacts = contact_motion(data, cone, motion)
    work = least_work(data, motion, at_contacts)
    if not work.power > 0.0 or work.violation > MOTION_TOLERANCE:
        return None
    return MotionCertificate(data, motion, at_contacts, work.power)
