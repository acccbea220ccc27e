"""Certificates: forces for "stable", a motion that no admissible force can prevent for "unstable"."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from socp_statics.certificates.contact_motion import contact_motion, least_work
from socp_statics.certificates.reading import contact_states, reading
from socp_statics.cones.choice import ConeChoice
from socp_statics.spatial import Array
from socp_statics.statics.statics_data import StaticsData

MOTION_TOLERANCE = 1e-7


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
    """

    linear: Array
    angular: Array
    point: Array
    power: float
    reading: str
    contacts: dict[str, str]

    def as_record(self) -> dict[str, Any]:
        """The record's entry."""
        return {
            "kind": "motion",
            "linear": self.linear.tolist(),
            "angular": self.angular.tolist(),
            "point": self.point.tolist(),
            "joints": {},
            "power": self.power,
            "reading": self.reading,
            "contacts": dict(self.contacts),
        }


def motion_certificate(data: StaticsData, cone: ConeChoice, twist: Array) -> MotionCertificate | None:
    """The certificate of a twist, if it is one.

    Args:
        data: The stance's arrays.
        cone: Exact cones or pyramids.
        twist: Candidate ``[v; w]`` about the origin, the multipliers of the scaled balance, shape (6,).

    Returns:
        The certificate, scaled so that the larger of |v| and |w| times the size is one; None if admissible forces could prevent the motion.
    """
    size = float(np.abs(twist).max())
    if not np.isfinite(size) or size == 0.0:
        return None
    twist = twist / max(float(np.linalg.norm(twist[:3])), float(np.linalg.norm(twist[3:])))
    motion = contact_motion(data, cone, twist)
    work = least_work(data, motion, twist)
    if not work.power > 0.0 or work.violation > MOTION_TOLERANCE:
        return None
    linear, angular = data.units.twist_in_si(twist)
    com_velocity = twist[:3] + np.cross(twist[3:], data.com)
    turning = float(np.linalg.norm(twist[3:])) > 1e-6
    return MotionCertificate(
        linear=linear,
        angular=angular,
        point=data.units.origin.copy(),
        power=work.power * data.units.force,
        reading=reading(data, motion, com_velocity, turning),
        contacts=contact_states(data, motion),
    )
