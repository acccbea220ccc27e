"""Robots of the package example-robot-data (extra ``robots``): their URDFs; meshes are never opened."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

from socp_statics.exceptions import InputError
from socp_statics.robots.contact_frame import ContactFrame
from socp_statics.robots.robot import Robot
from socp_statics.robots.urdf import robot_from_urdf

PACKAGE = "example-robot-data 5"


def urdf_path(robot: str, file: str) -> Path:
    """Where the package keeps the URDF of a robot.

    Args:
        robot: Name of the robot, for the error sentence.
        file: The URDF, relative to the package's folder of robots.

    Raises:
        InputError: The package is not installed; the sentence has the pip command.
    """
    try:
        from example_robot_data.robots_loader import getModelPath
    except ImportError as error:
        message = f"robot '{robot}' needs the extra robots: pip install 'socp-statics[robots]'"
        raise InputError(message, name=robot, field="robot") from error
    return Path(getModelPath(f"/{file}")) / file


def robot_from_data(
    name: str,
    file: str,
    frames: Iterable[ContactFrame],
    *,
    source: str,
    licence: str,
    reference: Mapping[str, float],
    torque_limits_real: bool = True,
    torque_limits_note: str = "",
) -> Robot:
    """A robot of the package.

    Args:
        name: Its name in the catalogue.
        file: The URDF, relative to the package's folder of robots.
        frames: What it can touch with.
        source: Where the model comes from.
        licence: Licence of the model.
        reference: Joint angles from which inverse kinematics starts, the others neutral [rad].
        torque_limits_real: False where the effort limits are known not to be those of the motors.
        torque_limits_note: Why.

    Returns:
        The robot.

    Raises:
        InputError: The package is not installed.
    """
    return robot_from_urdf(
        urdf_path(name, file),
        {frame.name: frame for frame in frames},
        name=name,
        source=f"{source}, {file} of {PACKAGE}",
        licence=licence,
        reference=reference,
        torque_limits_real=torque_limits_real,
        torque_limits_note=torque_limits_note,
    )


def mirrored(reference: Mapping[str, float], left: str, right: str, opposite: Iterable[str] = ()) -> dict[str, float]:
    """The joint angles of a left side, and the same of the right side.

    Args:
        reference: Joint to angle of the left side [rad].
        left: What marks the left side in a joint's name.
        right: What takes its place on the right side.
        opposite: Joints of the left side whose partner turns the other way.
    """
    turning = set(opposite)
    partner = {joint.replace(left, right): -angle if joint in turning else angle for joint, angle in reference.items()}
    return {**reference, **partner}
