"""Generator: straddling a chimney, feet on its sloping sides, hands against its walls."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.contacts.numbers import scalar
from socp_statics.contacts.orientation import rotation_from_rpy
from socp_statics.postures.home import home
from socp_statics.postures.posture import Posture
from socp_statics.postures.scene import checked_hands, feet_apart, take_places
from socp_statics.robots import Robot

WIDER, ABOVE = 1.1, 0.1


def generate(
    robot: Robot,
    *,
    at: ArrayLike = (0.0, 0.0, 0.0),
    friction: float | Mapping[str, float] = 0.5,
    hands: Sequence[str] = ("left_hand", "right_hand"),
    slope: float = 0.2,
    width: float | None = None,
    height: float | None = None,
    spread: float | None = None,
    com: Sequence[float] | None = None,
) -> Posture:
    """Feet on two planes that slope inward, hands against two upright walls to the sides.

    Args:
        robot: A humanoid with feet and hands.
        at: The middle between the feet, shape (3,) [m].
        friction: Coulomb coefficient, of all or by contact.
        hands: The hands that touch, each its own wall.
        slope: Inclination of what the feet stand on, inward: the left normal points to the right [rad].
        width: Between the walls [m]; 1.1 of the home distance of the hands across by default.
        height: Of the hands [m]; by default 0.1 of the home height of the centre of mass above their home place.
        spread: Distance of the feet across, that of the home posture by default [m].
        com: Centre of mass from ``at``, over the middle of the soles by default [m].

    Returns:
        The posture.

    Raises:
        InputError: A wrong number, no hand, or the walls cannot be reached.
    """
    names, standing = checked_hands(robot, hands, "chimney"), home(robot)
    tilt = scalar("chimney", "slope", slope, kind="generator")
    places = {}
    for name, position in feet_apart(robot, spread).items():
        places[name] = (position, rotation_from_rpy(np.array([np.sign(position[1]) * tilt, 0.0, 0.0])))
    for name in names:
        x, y, z = standing.contacts[name].position
        beside = WIDER * abs(y) if width is None else scalar("chimney", "width", width, above=0.0, kind="generator") / 2
        level = z + ABOVE * standing.com_W[2] if height is None else scalar("chimney", "height", height, above=0.0, kind="generator")
        side = np.sign(y)
        places[name] = (np.array([x, side * beside, level]), np.array([0.0, -side, 0.0]))
    return take_places(robot, places, at=at, friction=friction, com=com)
