"""A scene around a robot: places of its contacts relative to an origin between its feet, and the posture that takes them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.contacts.numbers import scalar, vector
from socp_statics.exceptions import InputError
from socp_statics.postures.home import feet_of, hands_of, home
from socp_statics.postures.inverse_kinematics import reach
from socp_statics.postures.posture import Posture
from socp_statics.robots import Robot
from socp_statics.spatial import Array

FEET = ("left_foot", "right_foot")
Places = Mapping[str, tuple[Array, Any]]
LEVEL = np.eye(3)


def feet_apart(robot: Robot, spread: float | None = None, names: Sequence[str] = FEET) -> dict[str, Array]:
    """Where the feet of a robot are at home, relative to the origin between them.

    Args:
        robot: The robot.
        spread: Distance of the feet across, that of the home posture by default [m].
        names: The feet.

    Returns:
        Foot to position, shape (3,) [m].

    Raises:
        InputError: The robot has no such foot, or the spread is not a number > 0.
    """
    for name in names:
        robot.contact_frame(name)
    standing = home(robot)
    places = {name: np.array(standing.contacts[name].position) for name in names}
    if spread is not None:
        half = scalar(robot.name, "spread", spread, above=0.0, kind="robot") / 2
        for place in places.values():
            place[1] = np.copysign(half, place[1])
    return places


def checked_hands(robot: Robot, hands: Sequence[str], generator: str, *, least: int = 1) -> tuple[str, ...]:
    """The hands that touch.

    Args:
        robot: The robot.
        hands: Their names; a single one may be a word.
        generator: Who asks, for the error sentence.
        least: How many are needed.

    Raises:
        InputError: Too few, one that is no hand of the robot, or one named twice.
    """
    names, known = (hands,) if isinstance(hands, str) else tuple(hands), hands_of(robot)
    for name in names:
        if name not in known:
            has = f"it has {', '.join(known)}" if known else "it has none"
            raise InputError(f"{generator}: {name!r} is not a hand of the robot '{robot.name}', {has}", name=str(name), field="hands")
    if len(names) < least or len(set(names)) < len(names):
        words = f"{'two' if least == 2 else 'at least one'} of {', '.join(known) or 'none'}"
        raise InputError(f"{generator}: hands must name {words}, got {list(names)}", name=generator, field="hands")
    return names


def take_places(
    robot: Robot,
    places: Places,
    *,
    at: ArrayLike,
    friction: float | Mapping[str, float],
    com: Sequence[float] | None = None,
    aligned: Sequence[str] = (),
) -> Posture:
    """The posture with its contacts in their places and its centre of mass over its feet.

    Args:
        robot: The robot.
        places: Contact to position relative to ``at`` [m] and orientation, as `reach` takes them.
        at: The origin between the feet, world axes, shape (3,) [m].
        friction: Coulomb coefficient of all contacts, or by contact.
        com: Centre of mass relative to ``at``: (x, y) or (x, y, z) [m]; over the middle of the soles by default.
        aligned: As in `reach`.

    Returns:
        The posture.

    Raises:
        InputError: A number is wrong or the places cannot be reached.
    """
    origin = vector(robot.name, "at", at, 3, kind="robot")
    if com is None:
        target = _middle_of_the_soles(robot, places)
    else:
        if np.size(com) not in (2, 3):
            raise InputError(f"robot '{robot.name}': com must be two or three numbers, got {com!r}", name=robot.name, field="com")
        target = np.array(vector(robot.name, "com", com, int(np.size(com)), kind="robot"))
    world = {name: (origin + position, orientation) for name, (position, orientation) in places.items()}
    return reach(robot, world, friction=friction, com=target + origin[: len(target)], aligned=aligned)


def _middle_of_the_soles(robot: Robot, places: Places) -> Array:
    """Mean of the middles of the soles, seen from above, shape (2,) [m]."""
    feet = [name for name in places if name in feet_of(robot)]
    middles = []
    for name in feet:
        position, orientation = places[name]
        turned = orientation if np.ndim(orientation) == 2 else LEVEL
        middles.append(position + turned @ np.array([*robot.frames[name].points_C.mean(axis=0), 0.0]))
    return np.mean(middles, axis=0)[:2]
