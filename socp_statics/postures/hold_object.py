"""Generator: holding an object between the two hands."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.contacts import ExternalWrench
from socp_statics.contacts.numbers import scalar
from socp_statics.exceptions import InputError
from socp_statics.postures.home import home
from socp_statics.postures.posture import Posture, posture_at
from socp_statics.postures.scene import LEVEL, checked_hands, feet_apart, take_places
from socp_statics.robots import Robot
from socp_statics.spatial import Array

STANDARD_GRAVITY = 9.81
SAFE = 1.2


def generate(
    robot: Robot,
    *,
    at: ArrayLike = (0.0, 0.0, 0.0),
    friction: float | Mapping[str, float] = 0.5,
    hands: Sequence[str] = ("left_hand", "right_hand"),
    mass: float = 1.0,
    width: float | None = None,
    forward: float | None = None,
    height: float | None = None,
    grip_friction: float = 0.5,
    squeeze: float | None = None,
    spread: float | None = None,
    com: Sequence[float] | None = None,
) -> Posture:
    """Both feet on the floor, an object pressed between the hands.

    Each hand carries half of the object: its mass counts as two point masses at the hands, in the mass and the centre of mass of
    the posture as well. The hands press against each other through the object, which the arms feel and the feet do not.

    Args:
        robot: A humanoid with feet and two hands.
        at: The middle between the feet, shape (3,) [m].
        friction: Coulomb coefficient of the feet, of both or by contact.
        hands: The two hands that hold.
        mass: Of the object [kg].
        width: Of the object, the home distance of the hands across by default [m].
        forward: Of the object from ``at``, the home place of the hands by default [m].
        height: Of the object above the floor, the home place of the hands by default [m].
        grip_friction: Coulomb coefficient between hands and object.
        squeeze: Force of each hand on the object, 1.2 times the least that holds it by default [N].
        spread: Distance of the feet across, that of the home posture by default [m].
        com: Centre of mass of robot and object from ``at``, over the middle of the soles by default [m].

    Returns:
        The posture; its robot carries the object.

    Raises:
        InputError: The object is held by nothing or slips, a number is wrong, or its place cannot be reached.
    """
    if not len(hands):
        raise InputError("hold_object: the object is held by nothing, hands must name two", name="hold_object", field="hands")
    names, standing = checked_hands(robot, hands, "hold_object", least=2), home(robot)
    load = scalar("hold_object", "mass", mass, least=0.0, kind="generator")
    mu = scalar("hold_object", "grip_friction", grip_friction, above=0.0, kind="generator")
    needed = load * STANDARD_GRAVITY / (2 * mu)
    press = SAFE * needed if squeeze is None else scalar("hold_object", "squeeze", squeeze, least=0.0, kind="generator")
    if press < needed:
        message = f"hold_object: the object slips, squeeze must be at least mass x 9.81 / (2 grip_friction) = {needed:.6g} N, got {press:g}"
        raise InputError(message, name="hold_object", field="squeeze")
    x, y, z = np.mean([np.abs(standing.contacts[name].position) for name in names], axis=0)
    half = y if width is None else scalar("hold_object", "width", width, above=0.0, kind="generator") / 2
    x = x if forward is None else scalar("hold_object", "forward", forward, kind="generator")
    z = z if height is None else scalar("hold_object", "height", height, kind="generator")
    places: dict[str, tuple[Array, Any]] = {name: (position, LEVEL) for name, position in feet_apart(robot, spread).items()}
    feet = tuple(places)
    for name in names:
        places[name] = (np.array([x, np.copysign(half, standing.contacts[name].position[1]), z]), None)
    laden = robot.with_masses(dict.fromkeys(names, load / 2))
    rough = friction if isinstance(friction, Mapping) else dict.fromkeys(feet, friction)
    held = take_places(laden, places, at=at, friction={**rough, **dict.fromkeys(names, 0.0)}, com=com)
    points = {name: held.contacts[name].position for name in names}
    middle = sum(points.values()) / 2
    loads = [
        ExternalWrench(press * (points[name] - middle) / np.linalg.norm(points[name] - middle), point=points[name],
                       link=laden.frames[name].frame, name=f"squeeze at {name}")
        for name in names
    ]  # fmt: skip
    return replace(posture_at(laden, held.q, feet, rough), loads=tuple(loads))
