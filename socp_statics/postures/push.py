"""Generator: pushing a wall or a heavy object, the two postures of Fig. 3.9."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.contacts.numbers import scalar
from socp_statics.contacts.orientation import rotation_from_rpy
from socp_statics.postures.home import home
from socp_statics.postures.posture import Posture
from socp_statics.postures.scene import LEVEL, checked_hands, feet_apart, take_places
from socp_statics.postures.wall_brace import on_the_wall
from socp_statics.robots import Robot

STRIDE = 0.3
STANDARD_GRAVITY = 9.81


def generate(
    robot: Robot,
    *,
    at: ArrayLike = (0.0, 0.0, 0.0),
    friction: float | Mapping[str, float] = 0.5,
    variant: Literal["A", "B"] = "A",
    force: float | None = None,
    hands: Sequence[str] = ("left_hand", "right_hand"),
    stride: float | None = None,
    slope: float = 0.5,
    rise: float | None = None,
    pushing_leg: Literal["left", "right"] = "right",
    distance: float | None = None,
    height: float | None = None,
    com: Sequence[float] | None = None,
) -> Posture:
    """One foot ahead of the other, the hands push with a given force.

    The force is the normal force of the hands, shared equally: what is pushed reacts with it, whatever the feet do. In A both feet are
    on the floor and only their friction answers; in B the pushing leg, the rear one, stands on an inclined surface that faces forward.

    Args:
        robot: A humanoid with feet and hands.
        at: The middle between the feet on the floor, shape (3,) [m].
        friction: Coulomb coefficient, of all or by contact.
        variant: "A" or "B" of Fig. 3.9.
        force: Pushing force of all hands, a fifth of the weight by default [N].
        hands: The hands that push.
        stride: From the rear to the front foot, 0.3 of the home height of the centre of mass by default [m].
        slope: Inclination of the surface behind the robot, B only [rad].
        rise: Height of the pushing foot above the floor, B only; its lowest corner is on the floor by default [m].
        pushing_leg: The rear leg, "left" or "right".
        distance: From ``at`` to what is pushed [m]; a little beyond the home place of the hands by default.
        height: Of the hands above the floor [m]; a little above their home place by default.
        com: Centre of mass from ``at``, over the middle of the soles by default [m].

    Returns:
        The posture; the hands' normal forces are bounded to their share of the force.

    Raises:
        InputError: A wrong number, no hand, or the posture cannot be reached.
    """
    names, size = checked_hands(robot, hands, "push"), float(home(robot).com_W[2])
    total = robot.mass * STANDARD_GRAVITY / 5 if force is None else scalar("push", "force", force, least=0.0, kind="generator")
    step = STRIDE * size if stride is None else scalar("push", "stride", stride, least=0.0, kind="generator")
    tilt = scalar("push", "slope", slope, kind="generator")
    given = {key: None if value is None else scalar("push", key, value) for key, value in (("distance", distance), ("height", height))}
    places = {}
    for name, position in feet_apart(robot).items():
        rear = name.startswith(pushing_leg)
        surface, up = LEVEL, 0.0
        if rear and variant == "B":
            surface = rotation_from_rpy(np.array([0.0, tilt, 0.0]))
            lowest = float((robot.frames[name].points_C @ surface[2, :2]).min())
            up = -lowest if rise is None else scalar("push", "rise", rise, kind="generator")
        places[name] = (position + np.array([-step / 2 if rear else step / 2, 0.0, up]), surface)
    share = total / len(names)
    loaded = {name: replace(robot.frames[name], extra={"normal_force": [share, share]}) for name in names}
    wall = on_the_wall(robot, names, given["distance"], 0.0, given["height"], 0.0)
    return take_places(robot.with_frames(loaded), {**places, **wall}, at=at, friction=friction, com=com)
