"""Generator: both knees bent, trunk upright."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from numpy.typing import ArrayLike

from socp_statics.postures.joint_roles import SIDES, angles_by_role, arm_angles
from socp_statics.postures.level_ground import on_level_ground
from socp_statics.postures.posture import Posture, pose
from socp_statics.robots import Robot


def bent_leg(robot: Robot, side: str, knee: float) -> dict[str, float]:
    """Angles of a leg bent at the knee with hip and ankle at minus half of it: the sole stays parallel to the pelvis.

    Args:
        robot: A robot whose joint roles are known.
        side: "left" or "right".
        knee: Knee angle [rad].

    Returns:
        Joint to angle [rad].
    """
    bent = {f"{side}_hip_pitch": -knee / 2, f"{side}_knee_pitch": knee, f"{side}_ankle_pitch": -knee / 2}
    return angles_by_role(robot, bent)


def generate(
    robot: Robot,
    *,
    support: Sequence[str] = ("left_foot", "right_foot"),
    at: ArrayLike = (0.0, 0.0, 0.0),
    friction: float | Mapping[str, float] = 0.5,
    knee: float = 1.0,
    arms: str = "down",
) -> Posture:
    """Both knees bent, hips and ankles at minus half the knee angle.

    Args:
        robot: A robot whose joint roles are known.
        support: Feet that touch.
        at: Position of the first contact, shape (3,) [m].
        friction: Coulomb coefficient, of all or by contact.
        knee: Knee angle: 1.0 is a half squat of HOAP-2, 2.0 a deep one [rad].
        arms: "down" or "forward".

    Returns:
        The posture.

    Raises:
        InputError: A contact off the level ground, or as `pose`.
    """
    angles = arm_angles(robot, arms)
    for side in SIDES:
        angles |= bent_leg(robot, side, knee)
    return on_level_ground(pose(robot, angles, support, friction, at), "squat")
