"""Generator: joint angles as they are given."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from numpy.typing import ArrayLike

from socp_statics.postures.posture import Posture, pose
from socp_statics.robots import Robot


def generate(
    robot: Robot,
    *,
    support: Sequence[str] = ("left_foot", "right_foot"),
    at: ArrayLike = (0.0, 0.0, 0.0),
    friction: float | Mapping[str, float] = 0.5,
    angles: Mapping[str, float] | None = None,
) -> Posture:
    """A posture from joint angles.

    Args:
        robot: Any robot with contacts.
        support: Contacts that touch; the first is placed at ``at``, level, the others are where the kinematics put them.
        at: Position of the first contact, shape (3,) [m].
        friction: Coulomb coefficient, of all or by contact.
        angles: Joint to angle, the others neutral [rad].

    Returns:
        The posture.

    Raises:
        InputError: As `pose`.
    """
    return pose(robot, angles or {}, support, friction, at)
