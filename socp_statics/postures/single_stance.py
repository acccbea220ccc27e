"""Generator: on one foot, the other leg beside it or lifted."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from numpy.typing import ArrayLike

from socp_statics.exceptions import InputError
from socp_statics.postures.joint_roles import SIDES, angles_by_role, arm_angles, joint_roles
from socp_statics.postures.level_ground import on_level_ground
from socp_statics.postures.posture import Posture, pose
from socp_statics.postures.squat import bent_leg
from socp_statics.robots import Robot


def generate(
    robot: Robot,
    *,
    support: Sequence[str] = ("left_foot",),
    at: ArrayLike = (0.0, 0.0, 0.0),
    friction: float | Mapping[str, float] = 0.5,
    knee: float = 0.0,
    lean: float | None = None,
    lift: float = 0.8,
    arms: str = "down",
) -> Posture:
    """On one foot, leaning over it, the free foot lifted.

    Args:
        robot: A robot whose joint roles are known.
        support: The one foot that touches, "left_foot" or "right_foot".
        at: Position of its contact, shape (3,) [m].
        friction: Coulomb coefficient.
        knee: Knee angle of both legs, hip and ankle at minus half of it [rad].
        lean: Roll of both legs towards the supporting side at the ankles, undone at the hips [rad]; by default what brings the
            robot over its foot, 0.2 for HOAP-2.
        lift: Further knee angle of the free leg, hip and ankle at minus half of it as far as the ankle goes [rad].
        arms: "down" or "forward".

    Returns:
        The posture. Without lean the centre of mass stays between the feet and the robot tips.

    Raises:
        InputError: Not exactly one foot, or as `pose`.
    """
    feet = {f"{side}_foot": side for side in SIDES}
    names = (support,) if isinstance(support, str) else tuple(support)
    if len(names) != 1 or names[0] not in feet:
        message = f"single_stance: support must be one of {', '.join(feet)}, got {list(names)}"
        raise InputError(message, name="single_stance", field="support")
    angles, roles = arm_angles(robot, arms), joint_roles(robot)
    lean = roles.lean if lean is None else lean
    towards = 1.0 if feet[names[0]] == "left" else -1.0
    for foot, side in feet.items():
        angles |= bent_leg(robot, side, knee if foot == names[0] else knee + lift)
        # Parallel legs keep the free sole level, beside the other and, with any lift, above the ground.
        angles |= angles_by_role(robot, {f"{side}_hip_roll": -towards * lean, f"{side}_ankle_roll": towards * lean})
    ankle = roles.joints[f"{'right' if towards > 0 else 'left'}_ankle_pitch"][0]
    place = robot.joint_index(ankle)
    angles[ankle] = min(max(angles[ankle], float(robot.lower[place])), float(robot.upper[place]))
    return on_level_ground(pose(robot, angles, names, friction, at), "single_stance")
