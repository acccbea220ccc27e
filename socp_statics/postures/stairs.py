"""Generator: one foot a step above the other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.contacts.numbers import scalar
from socp_statics.postures.home import home
from socp_statics.postures.posture import Posture
from socp_statics.postures.scene import LEVEL, feet_apart, take_places
from socp_statics.robots import Robot

RISE, TREAD = 0.12, 0.22


def generate(
    robot: Robot,
    *,
    at: ArrayLike = (0.0, 0.0, 0.0),
    friction: float | Mapping[str, float] = 0.5,
    rise: float | None = None,
    tread: float | None = None,
    upper: Literal["left", "right"] = "right",
    com: Sequence[float] | None = None,
) -> Posture:
    """On stairs, both soles level, the upper foot one tread ahead and one rise above the lower.

    Args:
        robot: A humanoid with left_foot and right_foot.
        at: The middle between the feet at the height of the lower one, shape (3,) [m].
        friction: Coulomb coefficient, of all or by contact.
        rise: Height of the step, 0.12 of the home height of the centre of mass by default [m].
        tread: Depth of the step, 0.22 of that height by default [m].
        upper: Which foot is up, "left" or "right".
        com: Centre of mass from ``at``, over the middle of the soles by default [m].

    Returns:
        The posture.

    Raises:
        InputError: A wrong number, or the step cannot be reached.
    """
    height = float(home(robot).com_W[2])
    up = RISE * height if rise is None else scalar("stairs", "rise", rise, kind="generator")
    ahead = TREAD * height if tread is None else scalar("stairs", "tread", tread, kind="generator")
    step = np.array([ahead / 2, 0.0, 0.0])
    places = {}
    for name, position in feet_apart(robot).items():
        raised = name.startswith(upper)
        places[name] = (position + (step + [0.0, 0.0, up] if raised else -step), LEVEL)
    return take_places(robot, places, at=at, friction=friction, com=com)
