"""Which joint does what: the names that the generators need of a robot."""

from __future__ import annotations

from collections.abc import Mapping

from socp_statics.exceptions import InputError
from socp_statics.robots import Robot

SIDES = ("left", "right")
HOAP2 = {
    f"{side}_{role}": joint.format(letter)
    for side, letter in (("left", "L"), ("right", "R"))
    for role, joint in (
        ("hip_roll", "{}LEG_JOINT2"),
        ("hip_pitch", "{}LEG_JOINT3"),
        ("knee_pitch", "{}LEG_JOINT4"),
        ("ankle_pitch", "{}LEG_JOINT5"),
        ("ankle_roll", "{}LEG_JOINT6"),
        ("shoulder_pitch", "{}ARM_JOINT1"),
    )
}
# In the zero pose HOAP-2 stretches its arms forward.
HOAP2_ARMS = {"forward": 0.0, "down": 1.5707963267948966}
ROLES: dict[str, tuple[Mapping[str, str], Mapping[str, float]]] = {"hoap2": (HOAP2, HOAP2_ARMS)}


def joint_roles(robot: Robot) -> Mapping[str, str]:
    """Joints by what they do, such as "left_knee_pitch".

    Args:
        robot: The robot.

    Raises:
        InputError: The roles of this robot's joints are not known.
    """
    return _of(robot)[0]


def arm_angles(robot: Robot, arms: str) -> dict[str, float]:
    """Shoulder angles that let the arms hang or stretch them forward.

    Args:
        robot: The robot.
        arms: "down" or "forward".

    Returns:
        Joint to angle [rad].

    Raises:
        InputError: Neither word, or a robot whose joints are not known.
    """
    roles, angles = _of(robot)
    if arms not in angles:
        raise InputError(f"arms must be {' or '.join(repr(word) for word in angles)}, got {arms!r}", name="arms", field="arms")
    return {roles[f"{side}_shoulder_pitch"]: angles[arms] for side in SIDES}


def _of(robot: Robot) -> tuple[Mapping[str, str], Mapping[str, float]]:
    if robot.name not in ROLES:
        known = ", ".join(ROLES)
        message = f"robot '{robot.name}': this generator does not know which joint is which; it knows {known}; joint_angles takes any robot"
        raise InputError(message, name=robot.name, field="generator")
    return ROLES[robot.name]
