"""The home posture of a robot: its reference posture on level ground, facing x, the origin between its feet."""

from __future__ import annotations

import numpy as np

from socp_statics.exceptions import InputError
from socp_statics.postures.posture import Posture, posture_at
from socp_statics.robots import Robot


def feet_of(robot: Robot) -> tuple[str, ...]:
    """Names of the contacts that are feet, in the order of the robot's contact frames.

    Raises:
        InputError: The robot has none.
    """
    feet = tuple(name for name in robot.frames if name.endswith("foot"))
    if not feet:
        message = f"robot '{robot.name}': it needs contacts whose names end in 'foot', it has {', '.join(robot.frames) or 'none'}"
        raise InputError(message, name=robot.name, field="frames")
    return feet


def hands_of(robot: Robot) -> tuple[str, ...]:
    """Names of the contacts that are hands, in the order of the robot's contact frames; empty where there are none."""
    return tuple(name for name in robot.frames if name.endswith("hand"))


def home(robot: Robot) -> Posture:
    """The reference posture with every contact of the robot, where the kinematics put it.

    Soles are level and look along x; a robot with point feet keeps its base upright. The lowest foot is on the ground z = 0.

    Args:
        robot: A robot with contacts whose names end in "foot".

    Returns:
        The posture; friction of its contacts is 0.

    Raises:
        InputError: The robot has no feet.
    """
    feet, names = feet_of(robot), tuple(robot.frames)
    apart = posture_at(robot, robot.configuration(robot.reference), names, dict.fromkeys(names, 0.0))
    R_WB = np.eye(3) if robot.frames[feet[0]].at_a_point else apart.contacts[feet[0]].rotation.T
    places = np.array([R_WB @ apart.contacts[name].position for name in feet])
    origin = np.array([*places.mean(axis=0)[:2], places[:, 2].min()])
    return posture_at(robot, robot.configuration(robot.reference, -origin, R_WB), names, dict.fromkeys(names, 0.0))
