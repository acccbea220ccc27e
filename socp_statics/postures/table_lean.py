"""Generator: leaning on a table with the hands."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.contacts.numbers import scalar
from socp_statics.postures.home import home
from socp_statics.postures.posture import Posture
from socp_statics.postures.scene import LEVEL, checked_hands, feet_apart, take_places
from socp_statics.robots import Robot

AHEAD = 0.1
UP = np.array([0.0, 0.0, 1.0])


def generate(
    robot: Robot,
    *,
    at: ArrayLike = (0.0, 0.0, 0.0),
    friction: float | Mapping[str, float] = 0.5,
    hands: Sequence[str] = ("left_hand", "right_hand"),
    distance: float | None = None,
    height: float | None = None,
    com: Sequence[float] | None = None,
) -> Posture:
    """Both feet on the floor, hands on a level table top.

    Args:
        robot: A humanoid with feet and hands.
        at: The middle between the feet, shape (3,) [m].
        friction: Coulomb coefficient, of all or by contact.
        hands: The hands that lean.
        distance: Of the hands ahead of ``at`` [m]; by default 0.1 of the home height of the centre of mass beyond their home place.
        height: Of the table above the floor, the home height of the hands by default [m].
        com: Centre of mass from ``at``, over the middle of the soles by default [m].

    Returns:
        The posture.

    Raises:
        InputError: A wrong number, no hand, or the table cannot be reached.
    """
    names, standing = checked_hands(robot, hands, "table_lean"), home(robot)
    homes = [standing.contacts[name].position for name in names]
    away = max(place[0] for place in homes) + AHEAD * standing.com_W[2] if distance is None else scalar("table_lean", "distance", distance)
    level = min(place[2] for place in homes) if height is None else scalar("table_lean", "height", height, above=0.0, kind="generator")
    places = {name: (position, LEVEL) for name, position in feet_apart(robot).items()}
    table = {name: (np.array([away, place[1], level]), UP) for name, place in zip(names, homes, strict=True)}
    return take_places(robot, {**places, **table}, at=at, friction=friction, com=com)
