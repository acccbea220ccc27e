"""Generator: a quadruped on point feet, on sloping ground or steps, on three or four feet."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.contacts.numbers import scalar, vector
from socp_statics.contacts.orientation import rotation_from_rpy
from socp_statics.exceptions import InputError
from socp_statics.postures.home import feet_of, home
from socp_statics.postures.inverse_kinematics import reach
from socp_statics.postures.posture import Posture, posture_at
from socp_statics.postures.support import checked_support
from socp_statics.robots import Robot
from socp_statics.spatial import Array

LIFT = 0.12


def generate(
    robot: Robot,
    *,
    support: Sequence[str] = ("left_front_foot", "right_front_foot", "left_hind_foot", "right_hind_foot"),
    at: ArrayLike = (0.0, 0.0, 0.0),
    friction: float | Mapping[str, float] = 0.5,
    slope: Sequence[float] = (0.0, 0.0),
    steps: Mapping[str, float] | None = None,
    stretch: float = 1.0,
    lift: float | None = None,
    com: Sequence[float] | None = None,
) -> Posture:
    """A quadruped whose feet stand below their home places on a plane or on level steps.

    Args:
        robot: A quadruped whose contacts are named like "left_front_foot".
        support: Feet that touch; the others are lifted straight up.
        at: The middle between the feet on the ground, shape (3,) [m].
        friction: Coulomb coefficient, of all or by contact.
        slope: Roll and pitch of the ground about x and y [rad].
        steps: Foot to height above the ground under it [m].
        stretch: Distances of the feet from the middle, over those at home.
        lift: Height of feet that do not touch, 0.12 of the home height of the centre of mass by default [m].
        com: Centre of mass from ``at``, over the mean of the feet that touch by default [m].

    Returns:
        The posture; the ground decides the normals.

    Raises:
        InputError: An unknown foot, a wrong number, or the places cannot be reached.
    """
    names, feet, standing = checked_support(robot, support), feet_of(robot), home(robot)
    for name in (*names, *(steps or {})):
        if name not in feet:
            message = f"quadruped_stance: {name!r} is not a foot of the robot '{robot.name}', it has {', '.join(feet)}"
            raise InputError(message, name=name, field="support" if name in names else "steps")
    origin = vector(robot.name, "at", at, 3, kind="robot")
    ground = rotation_from_rpy(np.array([*vector(robot.name, "slope", slope, 2, kind="robot"), 0.0]))
    wide = scalar("quadruped_stance", "stretch", stretch, above=0.0, kind="generator")
    raised = LIFT * standing.com_W[2] if lift is None else scalar("quadruped_stance", "lift", lift, least=0.0, kind="generator")
    places: dict[str, tuple[Array, Array]] = {}
    for name in feet:
        x, y = wide * standing.contacts[name].position[:2]
        level = -(ground[0, 2] * x + ground[1, 2] * y) / ground[2, 2]
        level += scalar(name, "steps", (steps or {}).get(name, 0.0)) + (0.0 if name in names else raised)
        places[name] = (origin + [x, y, level], ground)
    if com is None:
        target = np.mean([places[name][0] for name in names], axis=0)[:2]
    else:
        target = np.array(vector(robot.name, "com", com, 2 if np.size(com) == 2 else 3, kind="robot")) + origin[: np.size(com)]
    held = reach(robot, places, friction=0.0, com=target)
    return posture_at(robot, held.q, names, friction, dict.fromkeys(names, ground))
