"""One ray: a homotopy in the centre of mass, judged on the way, bracketed at its first exit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from socp_statics.certificates import MotionCertificate
from socp_statics.cones.choice import ConeChoice
from socp_statics.contacts import Stance
from socp_statics.exceptions import EngineError
from socp_statics.following.region import CANNOT_REACH, EQUILIBRIUM, JOINT_LIMIT, STEP_FAILURE, TORQUE, FollowingRay, RayEnd
from socp_statics.postures.continuation import QUICK, THOROUGH, Approach, Continuation, Followed
from socp_statics.spatial import Array
from socp_statics.stability import EquilibriumAnswer, check_equilibrium

MOST_STEPS = 5000
SMALLEST = 1.0 / 64.0
MOST_JOINTS = 3


@dataclass(frozen=True, eq=False)
class Follower:
    """What does not change along a ray.

    Attributes:
        stance: The seed's stance: contacts and loads stay.
        continuation: Postures by their centre of mass.
        cone: Exact cones or pyramids.
        form: "socp" or "sdp".
        engine: "auto", the name of an engine, or several to be tried in turn.
        step: Longest step [m].
        tolerance: Longest distance between the two sides of an exit [m].
    """

    stance: Stance
    continuation: Continuation
    cone: ConeChoice
    form: str
    engine: str | Sequence[str]
    step: float
    tolerance: float

    def end(self, at: Followed, distance: float) -> RayEnd:
        """The posture with everything that is known of it."""
        posture = self.continuation.posture(at.x)
        stance = replace(self.stance, com=posture.com_W, posture=posture)
        return RayEnd(distance, posture, check_equilibrium(stance, cone=self.cone, form=self.form, engine=self.engine))

    def stands(self, at: Followed) -> bool:
        """Whether the posture is stable; its joints are looked at only where their torques are limited."""
        if self.stance.torque_limits is not None:
            return self.end(at, 0.0).answer.stable
        bare = replace(self.stance, com=self.continuation.com(at.x), posture=None)
        return check_equilibrium(bare, cone=self.cone, form=self.form, engine=self.engine).stable


def follow(follower: Follower, start: Followed, centre: Array, direction: Array) -> FollowingRay:
    """Follow one ray to its first exit.

    Args:
        follower: What does not change.
        start: The posture the ray starts from, which is stable.
        centre: Its centre of mass, shape (3,) [m].
        direction: Unit vector in the plane, shape (2,).

    Returns:
        The ray with the two sides of its exit.

    Raises:
        EngineError: No engine settled a verdict, or no exit was found within 5000 steps.
    """
    along = np.array([direction[0], direction[1], 0.0])
    s, at, step, probed = 0.0, start, follower.step, -1.0
    smallest, follows = SMALLEST * follower.tolerance, follower.continuation
    for steps in range(1, MOST_STEPS):
        com = centre + (s + step) * along
        there = follows.step(at, com)
        if there is None:
            last, beyond = step <= smallest, s + follower.tolerance
            if last or (step <= follower.tolerance and probed < s):
                approach, probed = follows.approach(at.x, centre + beyond * along, THOROUGH if last else QUICK), s
                if approach.out_of_reach:
                    return _unreachable(follower, at, s, beyond, direction, approach, steps)
            if not last:
                step = step / 2
                continue
            there = follows.resumed(at, com)
            if there is None:
                return _broken(follower, at, s, s + step, direction, steps)
        if not follower.stands(there):
            return _bracketed(follower, (s, at), (s + step, there), centre, along, steps)
        s, at, step = s + step, there, min(follower.step, 2 * step)
    raise EngineError(f"no exit along the ray {direction.tolist()} within {MOST_STEPS} steps of at most {follower.step:g} m", name="step")


def _bracketed(
    follower: Follower, inside: tuple[float, Followed], outside: tuple[float, Followed], centre: Array, along: Array, steps: int
) -> FollowingRay:
    """Bisection between a posture that stands and one that does not."""
    while outside[0] - inside[0] > follower.tolerance:
        s = 0.5 * (inside[0] + outside[0])
        com = centre + s * along
        follows = follower.continuation
        middle = follows.step(inside[1], com) or follows.step(outside[1], com) or follows.resumed(inside[1], com)
        steps += 1
        if middle is None:
            return _broken(follower, inside[1], inside[0], s, along[:2], steps)
        if follower.stands(middle):
            inside = (s, middle)
        else:
            outside = (s, middle)
    beyond = follower.end(outside[1], outside[0])
    reason, joints, reading = _why(beyond.answer)
    return FollowingRay(along[:2], follower.end(inside[1], inside[0]), beyond, outside[0], reason, joints, reading, steps)


def _why(answer: EquilibriumAnswer) -> tuple[str, tuple[str, ...], str]:
    """Reason, joints and sentence of a posture that does not hold."""
    certificate = answer.certificate
    if not isinstance(certificate, MotionCertificate):
        return EQUILIBRIUM, (), "on the boundary of what can be held"
    if answer.reason != TORQUE:
        return EQUILIBRIUM, (), certificate.reading
    rates = certificate.joints
    return TORQUE, tuple(sorted(rates, key=lambda joint: -round(abs(rates[joint]), 6))), certificate.reading


def _unreachable(
    follower: Follower, at: Followed, s: float, beyond: float, direction: Array, approach: Approach, steps: int
) -> FollowingRay:
    what = "the centre of mass" if approach.farthest == "com" else f"contact '{approach.farthest}'"
    miss = f"{what} stays {1e3 * approach.miss:.2g} m{approach.unit}"
    limits = f" with {', '.join(approach.joints[:MOST_JOINTS])} at the joint limit" if approach.joints else ""
    reading = f"cannot reach: {miss} from its place{limits}"
    reason = JOINT_LIMIT if approach.joints else CANNOT_REACH
    return FollowingRay(direction, follower.end(at, s), None, beyond, reason, approach.joints, reading, steps)


def _broken(follower: Follower, at: Followed, s: float, beyond: float, direction: Array, steps: int) -> FollowingRay:
    reading = "the continuation breaks down: the posture nearest to the seed jumps or ceases to be a minimum; no exit of the region"
    return FollowingRay(direction, follower.end(at, s), None, beyond, STEP_FAILURE, (), reading, steps)
