"""Generator: upright with straight legs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from numpy.typing import ArrayLike

from socp_statics.postures.joint_roles import arm_angles
from socp_statics.postures.level_ground import on_level_ground
from socp_statics.postures.posture import Posture, pose
from socp_statics.robots import Robot


def generate(
    robot: Robot,
    *,
    support: Sequence[str] = ("left_foot", "right_foot"),
    at: ArrayLike = (0.0, 0.0, 0.0),
    friction: float | Mapping[str, float] = 0.5,
    arms: str = "down",
) -> Posture:
    """Upright with straight legs.

    Args:
        robot: A robot whose joint roles are known.
        support: Feet that touch.
        at: Position of the first contact, shape (3,) [m].
        friction: Coulomb coefficient, of all or by contact.
        arms: "down" or "forward".

    Returns:
        The posture.

    Raises:
        InputError: A contact off the level ground, or as `pose`.
    """
    return on_level_ground(pose(robot, arm_angles(robot, arms), support, friction, at), "standing")
