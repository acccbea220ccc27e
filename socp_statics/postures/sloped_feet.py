"""Generator: each foot on a plane of its own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.contacts.numbers import vector
from socp_statics.contacts.orientation import rotation_from_rpy
from socp_statics.postures.posture import Posture
from socp_statics.postures.scene import feet_apart, take_places
from socp_statics.robots import Robot


def generate(
    robot: Robot,
    *,
    at: ArrayLike = (0.0, 0.0, 0.0),
    friction: float | Mapping[str, float] = 0.5,
    left: Sequence[float] = (0.2, 0.0),
    right: Sequence[float] = (-0.2, 0.0),
    spread: float | None = None,
    com: Sequence[float] | None = None,
) -> Posture:
    """Two feet on planes that are rolled and pitched.

    Args:
        robot: A humanoid with left_foot and right_foot.
        at: The middle between the feet, shape (3,) [m].
        friction: Coulomb coefficient, of all or by contact.
        left: Roll about x and pitch about y of the left foot; the default tilts both inward, like the sides of a valley [rad].
        right: The same of the right foot [rad].
        spread: Distance of the feet across, that of the home posture by default [m].
        com: Centre of mass from ``at``, over the middle of the soles by default [m].

    Returns:
        The posture.

    Raises:
        InputError: A wrong number, or the planes cannot be reached with the joint limits.
    """
    slopes = {"left_foot": vector("left_foot", "left", left, 2), "right_foot": vector("right_foot", "right", right, 2)}
    places = {name: (position, rotation_from_rpy(np.array([*slopes[name], 0.0]))) for name, position in feet_apart(robot, spread).items()}
    return take_places(robot, places, at=at, friction=friction, com=com)
