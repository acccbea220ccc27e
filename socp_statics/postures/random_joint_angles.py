"""Generator: seeded random joint angles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.contacts.numbers import scalar
from socp_statics.exceptions import InputError
from socp_statics.postures.posture import Posture, pose
from socp_statics.robots import Robot


def generate(
    robot: Robot,
    *,
    support: Sequence[str] = ("left_foot", "right_foot"),
    at: ArrayLike = (0.0, 0.0, 0.0),
    friction: float | Mapping[str, float] = 0.5,
    seed: int = 0,
    spread: float = 0.3,
) -> Posture:
    """A posture whose joint angles are drawn evenly around the neutral ones, for populations of any size.

    Args:
        robot: Any robot with contacts.
        support: Contacts that touch; the first is placed at ``at``, level, the others are where the kinematics put them.
        at: Position of the first contact, shape (3,) [m].
        friction: Coulomb coefficient, of all or by contact.
        seed: A whole number >= 0.
        spread: Largest deviation from the neutral angle, cut off at the joint limits [rad].

    Returns:
        The posture; nobody says that it is stable, or that contacts other than the first are level.

    Raises:
        InputError: A wrong number, or as `pose`.
    """
    if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
        raise InputError(f"random_joint_angles: seed must be a whole number >= 0, got {seed!r}", name="random_joint_angles", field="seed")
    reach = scalar("random_joint_angles", "spread", spread, least=0.0, kind="generator")
    drawn = np.random.default_rng(seed).uniform(-reach, reach, len(robot.joints))
    return pose(robot, np.clip(robot.neutral + drawn, robot.lower, robot.upper), support, friction, at)
