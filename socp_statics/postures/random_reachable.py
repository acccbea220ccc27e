"""Generator: seeded random places that the robot reaches."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.contacts.numbers import scalar, vector
from socp_statics.contacts.orientation import rotation_from_rpy
from socp_statics.exceptions import InputError
from socp_statics.postures.home import feet_of, hands_of, home
from socp_statics.postures.inverse_kinematics import reach
from socp_statics.postures.posture import Posture
from socp_statics.robots import Robot
from socp_statics.spatial import Array

SHIFT, STEP, TURN, LEAN, CROUCH = 0.15, 0.05, 0.3, 0.08, 0.1
HAND_FROM, HAND_TO = (0.0, -0.2, -0.15), (0.25, 0.2, 0.4)
DRAWS = 20


def random_places(robot: Robot, rng: np.random.Generator, slope: float = 0.3, hand: bool = True) -> tuple[dict[str, Any], Array]:
    """Random places around the home posture, and a random centre of mass; nobody says that they can be reached.

    Args:
        robot: The robot.
        rng: The source of the numbers.
        slope: Largest roll and pitch of what the feet stand on [rad].
        hand: Whether the first hand of a robot with two feet leans on a wall in front.

    Returns:
        Contact to position [m] and orientation, and the centre of mass, shape (3,) [m].
    """
    standing, feet, hands = home(robot), feet_of(robot), hands_of(robot)
    height = float(standing.com_W[2])
    places: dict[str, Any] = {}
    for name in feet:
        position = standing.contacts[name].position
        outward = float(np.sign(position[1]))
        moved = height * np.array([*rng.uniform(-SHIFT, SHIFT, 2), rng.uniform(-STEP, STEP)])
        moved[1] = outward * abs(moved[1]) / 2
        roll, pitch, yaw = *rng.uniform(-slope, slope, 2), rng.uniform(0.0, TURN)
        places[name] = (position + moved, rotation_from_rpy(np.array([roll, pitch, outward * yaw])))
    if hand and hands and len(feet) == 2:
        moved = height * rng.uniform(HAND_FROM, HAND_TO)
        places[hands[0]] = (standing.contacts[hands[0]].position + moved, (-1.0, 0.0, 0.0))
    com = standing.com_W + height * np.array([*rng.uniform(-LEAN, LEAN, 2), rng.uniform(-CROUCH, 0.0)])
    return places, com


def generate(
    robot: Robot,
    *,
    at: ArrayLike = (0.0, 0.0, 0.0),
    friction: float | Mapping[str, float] = 0.5,
    seed: int = 0,
    slope: float = 0.3,
    hand: bool = True,
) -> Posture:
    """Feet on random slopes, a hand on a wall, the centre of mass somewhere above: the first of 20 draws that can be reached.

    Feet are shifted by at most 0.15 (apart) and 0.05 (up and down) of the home height of the centre of mass, turned out by at most 0.3 rad.

    Args:
        robot: A robot with feet.
        at: The middle between the home places of the feet, shape (3,) [m].
        friction: Coulomb coefficient, of all or by contact.
        seed: A whole number >= 0.
        slope: Largest roll and pitch of what the feet stand on [rad].
        hand: Whether the first hand of a robot with two feet leans on a wall in front.

    Returns:
        The posture; nobody says that it is stable.

    Raises:
        InputError: A wrong number, or no draw can be reached.
    """
    if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
        raise InputError(f"random_reachable: seed must be a whole number >= 0, got {seed!r}", name="random_reachable", field="seed")
    origin = vector(robot.name, "at", at, 3, kind="robot")
    tilt, rng = scalar("random_reachable", "slope", slope, least=0.0, kind="generator"), np.random.default_rng(seed)
    for _ in range(DRAWS):
        places, com = random_places(robot, rng, tilt, hand)
        world = {name: (origin + position, orientation) for name, (position, orientation) in places.items()}
        try:
            return reach(robot, world, friction=friction, com=com + origin, restarts=1)
        except InputError as error:
            if error.field != "placements":
                raise
    message = f"random_reachable: none of {DRAWS} draws with seed {seed} can be reached by the robot '{robot.name}'"
    raise InputError(message, name="random_reachable", field="seed")
