"""Certificates: forces for "stable", a motion that no admissible force can prevent for "unstable"."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from socp_statics.certificates.contact_motion import Motion, contact_motion, least_work
from socp_statics.certificates.reading import contact_states, reading
from socp_statics.cones.choice import ConeChoice
from socp_statics.spatial import Array
from socp_statics.statics.statics_data import StaticsData

MOTION_TOLERANCE = 1e-7
STILL = 1e-9


@dataclass(frozen=True)
class ForcesCertificate:
    """The forces of the answer themselves: they balance the load and lie inside every cone."""

    def as_record(self) -> dict[str, Any]:
        """The record's entry."""
        return {"kind": "forces"}


@dataclass(frozen=True, eq=False)
class MotionCertificate:
    """A rigid motion on which load and admissible forces do positive work whatever the forces: a certificate, not a forecast.

    Attributes:
        linear: Velocity of ``point``, world axes, shape (3,) [m/s].
        angular: Angular velocity, world axes, shape (3,) [rad/s].
        point: Reference point, world axes, shape (3,) [m].
        power: Least power of load and forces on the motion, > 0 [W].
        reading: The motion in words.
        contacts: What each contact does: "holds", "slides" or "opens".
        joints: Rates of the joints that move, where torque limits matter [rad/s].
    """

    linear: Array
    angular: Array
    point: Array
    power: float
    reading: str
    contacts: dict[str, str]
    joints: dict[str, float]

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
    linear, angular = data.units.twist_in_si(motion.twist)
    moving = np.abs(motion.joints) > STILL
    return MotionCertificate(
        linear=linear,
        angular=angular,
        point=data.units.origin.copy(),
        power=work.power * data.units.force,
        reading=reading(data, motion, at_contacts),
        contacts=contact_states(data, at_contacts),
        joints={data.torques.names[k]: float(motion.joints[k] / data.units.length) for k in np.flatnonzero(moving)},
    )
