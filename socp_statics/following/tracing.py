"""Tracing a following region: rays from the seed's centre of mass, each followed to its first exit."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import ceil
from typing import Any

import numpy as np

from socp_statics.cones.choice import ConeChoice, cone_choice
from socp_statics.contacts import ExternalWrench, Stance
from socp_statics.contacts.numbers import scalar
from socp_statics.contacts.stance import stance_of
from socp_statics.exceptions import InputError
from socp_statics.following.ray import Follower, follow
from socp_statics.following.region import FollowingRegion
from socp_statics.postures.continuation import Continuation, Followed
from socp_statics.postures.moved import require_free_hands

LONGEST = 0.1


def trace_following_region(
    posture: Any,
    rays: int = 24,
    tolerance: float = 1e-3,
    *,
    step: float = 5e-3,
    height: float | None = None,
    cone: str | ConeChoice = "exact",
    sides: int | None = None,
    heading: float | None = None,
    form: str = "socp",
    engine: str | Sequence[str] = "auto",
    gravity: Any = None,
    external_wrenches: Iterable[ExternalWrench | dict[str, Any]] = (),
    torque_limits: bool | Mapping[str, Any] = False,
) -> FollowingRegion:
    """How far a robot can shift its centre of mass while its posture follows: contacts fixed, inverse kinematics re-solved on the way.

    Along each horizontal ray from the seed's centre of mass the posture nearest to the seed is continued step by step, within the joint
    limits; each posture is judged with its own centre of mass, Jacobians and gravity torques. The first exit is bisected to the
    tolerance. Exits and returns shorter than a step can be missed; what lies behind the first exit is not claimed, nor what lies
    between the rays. Bodies may cross each other and the environment: nothing checks collisions.

    Args:
        posture: The seed: a Posture, or a Stance with one. It has to be stable.
        rays: How many, evenly spread from the world's x axis, at least 3.
        tolerance: Longest distance between the two sides of an exit, at most 0.1 m [m].
        step: Longest step along a ray, at least the tolerance, at most 0.1 m [m].
        height: Height of the centre of mass [m]; None leaves it to the posture.
        cone: "exact", "inscribed" or "circumscribed", or a ConeChoice.
        sides: Sides of the pyramids.
        heading: Heading of the pyramids [rad].
        form: "socp" or "sdp".
        engine: "auto", the name of an engine, or several to be tried in turn.
        gravity: Acceleration of gravity in world axes, shape (3,) [m/s^2].
        external_wrenches: Wrenches impressed on the robot; they stay where they are in the world while their links move.
        torque_limits: Whether forces have to respect joint-torque limits: the robot's own, or a mapping of limits.

    Returns:
        The region, attained along its rays only.

    Raises:
        InputError: There is no robot, it holds an object, a number is wrong, the seed is not stable, or no stable posture has the height.
        EngineError: No engine settled a verdict.
    """
    stance = stance_of(posture, None, None, gravity, external_wrenches, torque_limits) if _has_robot(posture) else None
    if stance is None:
        message = "a following region needs a robot: a posture, or a stance with one, is expected"
        raise InputError(message, name="posture", field="posture")
    require_free_hands(stance.posture)
    _checked(rays, tolerance, step)
    if height is not None:
        height = scalar("following region", "height", height, kind="region")
    continuation = Continuation(stance.posture, height is not None)
    follower = Follower(stance, continuation, cone_choice(cone, sides, heading), form, engine, float(step), float(tolerance))
    seed = follower.end(continuation.start, 0.0)
    if not seed.answer.stable:
        reading = getattr(seed.answer.certificate, "reading", None) or "on the boundary of what can be held"
        what = f"the seed of a following region must be stable, it is {seed.answer.verdict}: {reading}"
        message = f"robot '{stance.posture.robot.name}': {what}"
        raise InputError(message, name="posture", field="posture")
    start = continuation.start if height is None else _at_height(follower, height)
    begin = seed if height is None else follower.end(start, 0.0)
    if not begin.answer.stable:
        message = f"height: the posture with its centre of mass at {height:g} m above the seed's place is {begin.answer.verdict}"
        raise InputError(message, name="height", field="height")
    centre = np.array([*stance.com[:2], begin.posture.com_W[2]])
    angles = 2.0 * np.pi * np.arange(rays) / rays
    directions = np.round(np.column_stack([np.cos(angles), np.sin(angles)]), 15) + 0.0
    found = tuple(follow(follower, start, centre, direction) for direction in directions)
    return FollowingRegion(stance.posture, begin, found, height, float(step), float(tolerance))


def _has_robot(posture: Any) -> bool:
    return posture.posture is not None if isinstance(posture, Stance) else hasattr(posture, "com_jacobian")


def _checked(rays: int, tolerance: float, step: float) -> None:
    if isinstance(rays, bool) or not isinstance(rays, int | np.integer) or rays < 3:
        raise InputError(f"rays must be a whole number >= 3, got {rays!r}", name="rays", field="rays")
    if not 0.0 < tolerance <= LONGEST:
        raise InputError(f"tolerance must be a length > 0 and <= {LONGEST:g} m, got {tolerance!r}", name="tolerance", field="tolerance")
    if not tolerance <= step <= LONGEST:
        message = f"step must be a length from the tolerance ({tolerance:g} m) to {LONGEST:g} m, got {step!r}"
        raise InputError(message, name="step", field="step")


def _at_height(follower: Follower, height: float) -> Followed:
    """The posture whose centre of mass is straight above or below the seed's, followed there from the seed."""
    continuation, com = follower.continuation, follower.stance.com
    at, z = continuation.start, float(com[2])
    for goal in np.linspace(z, height, 1 + max(1, ceil(abs(height - z) / follower.step)))[1:]:
        there = continuation.step(at, (com[0], com[1], goal))
        if there is None:
            approach = continuation.approach(at.x, (com[0], com[1], goal))
            limits = f" with {', '.join(approach.joints)} at the joint limit" if approach.joints else ""
            ends = f"it ends at {continuation.com(at.x)[2]:.4g} m{limits}"
            message = f"height: the posture cannot be followed from {z:.4g} m to {height:g} m, {ends}"
            raise InputError(message, name="height", field="height")
        at = there
    return at
