"""Generator: feet on the floor, hands against a wall of any inclination."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.contacts.numbers import scalar
from socp_statics.postures.home import home
from socp_statics.postures.posture import Posture
from socp_statics.postures.scene import LEVEL, checked_hands, feet_apart, take_places
from socp_statics.robots import Robot
from socp_statics.spatial import Array

AHEAD, ABOVE = 0.12, 0.15


def on_the_wall(
    robot: Robot, hands: Sequence[str], distance: float | None, inclination: float, height: float | None, turn: float
) -> dict[str, tuple[Array, Array]]:
    """Where hands touch a wall: beside each other as at home, at one height.

    Args:
        robot: The robot.
        hands: Its hands.
        distance: From the origin to the wall at the height of the hands [m]; by default 0.12 of the home height of the centre of mass
            beyond the home place of the hands.
        inclination: Of the wall from the vertical, away from the robot if positive [rad].
        height: Of the hands [m]; by default 0.15 of the home height of the centre of mass above their home place.
        turn: Direction of the wall from x to the left [rad].

    Returns:
        Hand to position [m] and unit normal of the wall, which points to the robot.
    """
    standing = home(robot)
    size = float(standing.com_W[2])
    towards, across = np.array([np.cos(turn), np.sin(turn), 0.0]), np.array([-np.sin(turn), np.cos(turn), 0.0])
    up = np.array([0.0, 0.0, 1.0])
    homes = {name: standing.contacts[name].position for name in hands}
    away = max(float(place @ towards) for place in homes.values()) + AHEAD * size if distance is None else distance
    level = float(np.mean([place[2] for place in homes.values()])) + ABOVE * size if height is None else height
    normal = -np.cos(inclination) * towards + np.sin(inclination) * up
    return {name: (away * towards + (place @ across) * across + level * up, normal) for name, place in homes.items()}


def generate(
    robot: Robot,
    *,
    at: ArrayLike = (0.0, 0.0, 0.0),
    friction: float | Mapping[str, float] = 0.5,
    hands: Sequence[str] = ("left_hand",),
    distance: float | None = None,
    inclination: float = 0.0,
    height: float | None = None,
    turn: float = 0.0,
    spread: float | None = None,
    com: Sequence[float] | None = None,
) -> Posture:
    """Both feet on the floor, one or two hands against a plane wall.

    Args:
        robot: A humanoid with feet and hands.
        at: The middle between the feet, shape (3,) [m].
        friction: Coulomb coefficient, of all or by contact.
        hands: The hands that touch.
        distance: From ``at`` to the wall at the height of the hands [m]; a little beyond the home place of the hands by default.
        inclination: Of the wall from the vertical: positive leans away from the robot, negative over it [rad].
        height: Of the hands above the floor [m]; a little above their home place by default.
        turn: Direction of the wall from x to the left: 0 in front, pi/2 to the left [rad].
        spread: Distance of the feet across, that of the home posture by default [m].
        com: Centre of mass from ``at``, over the middle of the soles by default [m].

    Returns:
        The posture; the wall decides the normal of the hands.

    Raises:
        InputError: A wrong number, no hand, or the wall cannot be reached.
    """
    names = checked_hands(robot, hands, "wall_brace")
    numbers = {"distance": distance, "inclination": inclination, "height": height, "turn": turn}
    given = {key: None if value is None else scalar("wall_brace", key, value, kind="generator") for key, value in numbers.items()}
    places = {name: (position, LEVEL) for name, position in feet_apart(robot, spread).items()}
    return take_places(robot, places | on_the_wall(robot, names, **given), at=at, friction=friction, com=com)  # type: ignore[arg-type]
