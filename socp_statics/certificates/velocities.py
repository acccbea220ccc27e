"""How fast contact points and the centre of mass move in a certificate motion."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from socp_statics.contacts import ContactSet
from socp_statics.spatial import Array


def velocities(motion: Mapping[str, Any], contacts: ContactSet, com: Array, posture: Any = None) -> Array:
    """Velocities of the contact points, on the robot's side, and of the centre of mass.

    Args:
        motion: The certificate of a record: "linear" [m/s], "angular" [rad/s] and "point" [m], and "joints" [rad/s] where joints move.
        contacts: The contacts.
        com: Centre of mass, shape (3,) [m].
        posture: The posture (`socp_statics.postures.Posture`) whose joints move; without it their rates are left out.

    Returns:
        World axes, contact points in order and the centre of mass last, shape (n + 1, 3) [m/s].
    """
    linear, angular, point = (np.asarray(motion[key], dtype=float) for key in ("linear", "angular", "point"))
    out = linear + np.cross(angular, np.vstack([contacts.points_W, com]) - point)
    joints = motion.get("joints") or {}
    if posture is None or not joints:
        return out
    rates = np.array([joints.get(joint, 0.0) for joint in posture.robot.joints])
    parts = []
    for contact in contacts:
        frame = posture.jacobian[contact.name] @ rates
        parts.append(frame[:3] + np.cross(frame[3:], contact.points_W - contact.position))
    return out + np.vstack([*parts, posture.com_jacobian @ rates])
