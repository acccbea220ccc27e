"""Generator: legs apart by hip roll, feet flat (the posture of 3.6.5)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from numpy.typing import ArrayLike

from socp_statics.postures.joint_roles import SIDES, angles_by_role, arm_angles
from socp_statics.postures.level_ground import on_level_ground
from socp_statics.postures.posture import Posture, pose
from socp_statics.robots import Robot


def generate(
    robot: Robot,
    *,
    support: Sequence[str] = ("left_foot", "right_foot"),
    at: ArrayLike = (0.0, 0.0, 0.0),
    friction: float | Mapping[str, float] = 0.5,
    angle: float = 0.08726646259971647,
    arms: str = "down",
) -> Posture:
    """Hips rolled outward and ankles back, so that the soles are level and further apart.

    Args:
        robot: A robot whose joint roles are known.
        support: Feet that touch.
        at: Position of the first contact, shape (3,) [m].
        friction: Coulomb coefficient, of all or by contact.
        angle: Roll of each hip, outward; 5 degrees in the chapter [rad].
        arms: "down" or "forward".

    Returns:
        The posture.

    Raises:
        InputError: A contact off the level ground, or as `pose`.
    """
    angles = arm_angles(robot, arms)
    for side, outward in zip(SIDES, (1.0, -1.0), strict=True):
        angles |= angles_by_role(robot, {f"{side}_hip_roll": outward * angle, f"{side}_ankle_roll": -outward * angle})
    return on_level_ground(pose(robot, angles, support, friction, at), "rolled_feet")
