"""Which joint does what: the names that the generators of angles need of a humanoid."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from socp_statics.exceptions import InputError
from socp_statics.robots import Robot

SIDES = ("left", "right")
LEG = ("hip_roll", "hip_pitch", "knee_pitch", "ankle_pitch", "ankle_roll")
QUARTER = 1.5707963267948966


@dataclass(frozen=True)
class JointRoles:
    """What the joints of a humanoid do.

    Attributes:
        joints: Role such as "left_knee_pitch" to joint and sign: times the sign, its angle counts about the forward axis (roll) or the
            axis to the left (pitch) of the upright robot.
        arms: "down" and "forward" to joint angles [rad].
        lean: Roll of both legs that brings the robot over one foot [rad].
    """

    joints: Mapping[str, tuple[str, float]]
    arms: Mapping[str, Mapping[str, float]]
    lean: float


Signs = tuple[float, ...]


def _legs(left: tuple[str, ...], right: tuple[str, ...], left_signs: Signs, right_signs: Signs) -> dict[str, tuple[str, float]]:
    sides = (("left", left, left_signs), ("right", right, right_signs))
    return {f"{side}_{role}": (joint, sign) for side, names, signs in sides for role, joint, sign in zip(LEG, names, signs, strict=True)}


def _plain(pattern: str, names: tuple[str, ...], left: str, right: str) -> dict[str, tuple[str, float]]:
    """Roles of legs whose joints turn about the forward and the left axis."""
    ones = (1.0,) * len(LEG)
    on_the_left, on_the_right = (tuple(pattern.format(side, name) for name in names) for side in (left, right))
    return _legs(on_the_left, on_the_right, ones, ones)


def _arms(
    left: str, right: str, down: Mapping[str, float], forward: Mapping[str, float], opposite: tuple[str, ...] = ()
) -> dict[str, dict[str, float]]:
    """Angles of both arms from those of the left; joints in ``opposite`` turn the other way on the right."""
    return {
        word: {name.format(left): angle for name, angle in angles.items()}
        | {name.format(right): -angle if name in opposite else angle for name, angle in angles.items()}
        for word, angles in (("down", down), ("forward", forward))
    }


ROLES = {
    # In the zero pose HOAP-2 stretches its arms forward.
    "hoap2": JointRoles(
        _plain("{}LEG_JOINT{}", ("2", "3", "4", "5", "6"), "L", "R"),
        _arms("L", "R", {"{}ARM_JOINT1": QUARTER}, {"{}ARM_JOINT1": 0.0}),
        0.2,
    ),
    "talos": JointRoles(
        _plain("leg_{}_{}_joint", ("2", "3", "4", "5", "6"), "left", "right"),
        _arms(
            "left",
            "right",
            {"arm_{}_2_joint": 0.15, "arm_{}_4_joint": -0.2},
            {"arm_{}_1_joint": -QUARTER, "arm_{}_2_joint": QUARTER},
            ("arm_{}_1_joint", "arm_{}_2_joint"),
        ),
        0.1,
    ),
    "g1": JointRoles(
        _plain("{}_{}_joint", ("hip_roll", "hip_pitch", "knee", "ankle_pitch", "ankle_roll"), "left", "right"),
        _arms(
            "left",
            "right",
            {"{}_shoulder_roll_joint": 0.1, "{}_elbow_joint": 1.4},
            {"{}_shoulder_pitch_joint": -QUARTER, "{}_elbow_joint": QUARTER},
            ("{}_shoulder_roll_joint",),
        ),
        0.22,
    ),
    # Its base looks backwards and its sides are mirrored.
    "icub": JointRoles(
        _legs(
            tuple(f"l_{name}" for name in ("hip_roll", "hip_pitch", "knee", "ankle_pitch", "ankle_roll")),
            tuple(f"r_{name}" for name in ("hip_roll", "hip_pitch", "knee", "ankle_pitch", "ankle_roll")),
            (1.0, -1.0, -1.0, 1.0, 1.0),
            (-1.0, -1.0, -1.0, 1.0, -1.0),
        ),
        _arms("l", "r", {"{}_shoulder_roll": 0.15, "{}_elbow": 0.2}, {"{}_shoulder_pitch": -1.5, "{}_elbow": 0.1}),
        0.12,
    ),
    "romeo": JointRoles(
        _plain("{}{}", ("HipRoll", "HipPitch", "KneePitch", "AnklePitch", "AnkleRoll"), "L", "R"),
        _arms("L", "R", {"{}ShoulderPitch": QUARTER, "{}ShoulderYaw": 0.1}, {"{}ShoulderPitch": 0.0}, ("{}ShoulderYaw",)),
        0.12,
    ),
}


def angles_by_role(robot: Robot, angles: Mapping[str, float]) -> dict[str, float]:
    """Joint angles from what the joints do.

    Args:
        robot: A humanoid whose joint roles are known.
        angles: Role such as "left_knee_pitch" to angle about the forward axis (roll) or the axis to the left (pitch) [rad].

    Returns:
        Joint to angle [rad].

    Raises:
        InputError: The roles of this robot's joints are not known.
    """
    joints = joint_roles(robot).joints
    return {joints[role][0]: joints[role][1] * angle for role, angle in angles.items()}


def arm_angles(robot: Robot, arms: str) -> dict[str, float]:
    """Angles that let the arms hang or stretch them forward.

    Args:
        robot: The robot.
        arms: "down" or "forward".

    Returns:
        Joint to angle [rad].

    Raises:
        InputError: Neither word, or a robot whose joints are not known.
    """
    known = joint_roles(robot).arms
    if arms not in known:
        raise InputError(f"arms must be {' or '.join(repr(word) for word in known)}, got {arms!r}", name="arms", field="arms")
    return dict(known[arms])


def joint_roles(robot: Robot) -> JointRoles:
    """What the joints of a robot do.

    Args:
        robot: The robot.

    Raises:
        InputError: The roles of this robot's joints are not known.
    """
    if robot.name not in ROLES:
        known = ", ".join(ROLES)
        message = f"robot '{robot.name}': this generator does not know which joint is which; it knows {known}; joint_angles takes any robot"
        raise InputError(message, name=robot.name, field="generator")
    return ROLES[robot.name]
