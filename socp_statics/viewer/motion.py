"""Where everything is while the motion that proves "unstable" goes on."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from socp_statics.certificates.velocities import velocities
from socp_statics.contacts import Stance
from socp_statics.postures import Posture
from socp_statics.spatial import Array

REACH, TURN = 0.2, 0.35
NOTHING = 0.02
BODY = "body"


class Placement(NamedTuple):
    """Where a body is: its axes in the world, shape (3, 3), and its origin, shape (3,) [m]."""

    rotation: Array
    position: Array


def joint_placements(posture: Posture, q: Array) -> dict[str, Placement]:
    """Where the bodies behind the joints of a robot are.

    Args:
        posture: The posture, whose robot it is.
        q: Configuration of the Pinocchio model, shape (nq,).

    Returns:
        Joint name to placement; the free flyer is the first.
    """
    import pinocchio

    model = posture.robot.pin_model
    data = model.createData()
    pinocchio.forwardKinematics(model, data, q)
    return {model.names[k]: Placement(data.oMi[k].rotation.copy(), data.oMi[k].translation.copy()) for k in range(1, model.njoints)}


def still_bodies(stance: Stance) -> dict[str, Placement]:
    """Where the bodies of a stance are: those of its robot by joint; without a robot one `BODY`, its origin at the mean contact point.

    Args:
        stance: The stance.
    """
    if stance.posture is None:
        return {BODY: Placement(np.eye(3), stance.contacts.centre)}
    return joint_placements(stance.posture, stance.posture.q)


class CertifiedMotion:
    """A certificate motion followed from the stance on; a first-order motion, drawn as far as one can see it.

    The body as a whole follows the constant twist of the certificate, joints turn at their constant rates. A proof is about the
    first instant only: how far it is drawn says nothing.

    Args:
        motion: Mapping with "linear" [m/s], "angular" [rad/s] and "point" [m], world axes, and "joints" [rad/s].
        stance: What moves.

    Attributes:
        points: Contact points and the centre of mass, shape (n + 1, 3) [m].
        velocities: Theirs, on the robot's side, shape (n + 1, 3) [m/s].
        duration: How long the motion is followed [s]: 0.2 of the contacts' size, or 0.35 rad.
    """

    def __init__(self, motion: Mapping[str, Any], stance: Stance):
        self._linear, self._angular, self._point = (np.asarray(motion[key], dtype=float) for key in ("linear", "angular", "point"))
        self._posture: Posture | None = stance.posture
        self._com, self._centre = stance.com, stance.contacts.centre
        self.points = np.vstack([stance.contacts.points_W, stance.com])
        self.velocities = velocities(motion, stance.contacts, stance.com, stance.posture)
        self._rates = np.zeros(0)
        if self._posture is not None:
            rates = motion.get("joints") or {}
            self._rates = np.array([rates.get(joint, 0.0) for joint in self._posture.robot.joints])
        fastest = float(np.linalg.norm(self.velocities, axis=1).max())
        turning = max(float(np.linalg.norm(self._angular)), float(np.abs(self._rates).max(initial=0.0)))
        size = stance.contacts.size
        self.duration = min(REACH * size / fastest if fastest > 0.0 else np.inf, TURN / turning if turning > 0.0 else np.inf)

    @property
    def turns(self) -> bool:
        """Whether the body as a whole turns, so that there is an axis to see."""
        around = float(np.linalg.norm(self._angular)) * float(np.ptp(self.points, axis=0).max())
        return not self._rates.any() and around > NOTHING * float(np.linalg.norm(self.velocities, axis=1).max())

    def axis(self) -> tuple[Array, Array]:
        """A point of the axis of rotation [m] and its direction, shapes (3,); only of a motion that turns."""
        speed = float(np.linalg.norm(self._angular))
        along = self._angular / speed
        through = self._point + np.cross(self._angular, self._linear) / speed**2
        return through + float((self.points.mean(axis=0) - through) @ along) * along, along

    def base(self, share: float) -> Placement:
        """How the body as a whole has moved: ``p -> rotation p + position``.

        Args:
            share: Of the motion that is drawn, 0 to 1.
        """
        import pinocchio

        at_origin = self._linear - np.cross(self._angular, self._point)
        moved = pinocchio.exp6(pinocchio.Motion(share * self.duration * at_origin, share * self.duration * self._angular))
        return Placement(moved.rotation.copy(), moved.translation.copy())

    def bodies(self, share: float) -> dict[str, Placement]:
        """Where the bodies of `still_bodies` have moved to.

        Args:
            share: Of the motion that is drawn, 0 to 1.
        """
        moved = self.base(share)
        if self._posture is None:
            return {BODY: Placement(moved.rotation, moved.rotation @ self._centre + moved.position)}
        return joint_placements(self._posture, self._configuration(share, moved))

    def com(self, share: float) -> Array:
        """Where the centre of mass is, shape (3,) [m].

        Args:
            share: Of the motion that is drawn, 0 to 1.
        """
        moved = self.base(share)
        com = moved.rotation @ self._com + moved.position
        if self._posture is None or not self._rates.any():
            return com
        import pinocchio

        model = self._posture.robot.pin_model
        own = pinocchio.centerOfMass(model, model.createData(), self._configuration(share, moved))
        return com + own - (moved.rotation @ self._posture.com_W + moved.position)

    def _configuration(self, share: float, moved: Placement) -> Array:
        posture = self._posture
        assert posture is not None
        angles = posture.angles + share * self.duration * self._rates
        return posture.robot.configuration(angles, moved.rotation @ posture.p_WB + moved.position, moved.rotation @ posture.R_WB)
