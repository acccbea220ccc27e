"""The way to a better posture: conic steps within a trust radius, each brought back onto the contacts.

Why not a nonlinear program in posture, forces and margin at once: an optimal margin loads points at the apex of their cones, where a
smooth inequality has no gradient. SciPy's SLSQP on smoothed cones needs 111 to 185 iterations for HOAP-2 with its hands on a wall and
stops at 7.14 N; these steps need 5 and reach 7.60 N.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from socp_statics.optimization.posture_program import AtPosture
from socp_statics.spatial import Array

OPTIMAL = 1e-6
FIRST_TRUST, LARGEST_TRUST = 0.3, 1.0
# Most steps and smallest trust radius. A CoM margin sees curved edges through a few directions, whose promises are rougher: small steps
# are not worth their many programs there.
STEPS, SMALLEST_TRUST = 60, 1e-7
STEPS_BY_COM, SMALLEST_TRUST_BY_COM = 25, 1e-3
WORTHLESS, POOR, GOOD = 0.1, 0.25, 0.75


@dataclass(frozen=True, eq=False)
class Climb:
    """Where a search ended.

    Attributes:
        at: The program at the last posture.
        optimality: What the linearised statics still promise there, None where there is nothing to linearise.
        reason: Why that is no local optimum, or None.
        steps: How many motions were accepted.
    """

    at: AtPosture
    optimality: float | None
    reason: str | None
    steps: int


def climbed(at: AtPosture, enough: float = np.inf) -> Climb:
    """Steps within a trust radius until nothing more is promised, or the value is enough.

    Args:
        at: The program at the first posture.
        enough: A value with which to stop.
    """
    trust, steps = FIRST_TRUST, 0
    most = STEPS if at.directions is None else STEPS_BY_COM
    while True:
        if at.without_edge:
            return Climb(at, None, "the support region is no bounded polygon", steps)
        if not at.settled:
            within = " within the torque limits" if at.data.torques.limited else ""
            return Climb(at, None, f"no contact forces balance the load{within}", steps)
        if at.unlimited:
            return Climb(at, None, "nothing limits the margin", steps)
        optimality = at.optimality()
        if optimality <= OPTIMAL or at.value >= enough:
            return Climb(at, optimality, None, steps)
        if steps == most:
            return Climb(at, optimality, f"{most} steps were not enough", steps)
        found, trust = _better(at, trust)
        if found is None:
            return Climb(at, optimality, "no smaller step keeps what the linearised statics promise", steps)
        at, steps = found, steps + 1


def _better(at: AtPosture, trust: float) -> tuple[AtPosture | None, float]:
    """The next posture and the next trust radius."""
    while trust > (SMALLEST_TRUST if at.directions is None else SMALLEST_TRUST_BY_COM):
        step = at.step(trust)
        if step is None or step[1] <= at.value:
            trust /= 4.0
            continue
        motion, promised = step
        length = float(np.linalg.norm(motion / at.question.held.scale))
        gain = promised - at.value
        found = _reached(at, motion)
        kept = -np.inf if found is None else (found.value - at.value) / gain
        if found is not None and found.settled and found.directions is None and kept < GOOD:
            # the slopes kept, the numbers new: what the motion's curvature cost is made good where that is possible
            again = found.step(trust / 2.0, at.slopes)
            better = None if again is None else _reached(found, again[0])
            if better is not None and better.value > found.value:
                found, kept = better, (better.value - at.value) / gain
        if kept > WORTHLESS:
            if kept > GOOD and length > 0.8 * trust:
                trust = min(2.0 * trust, LARGEST_TRUST)
            elif kept < POOR:
                trust = length / 2.0
            return found, trust
        trust = min(trust, length) / 4.0
    return None, trust


def _reached(at: AtPosture, motion: Array) -> AtPosture | None:
    posture = at.question.held.closed(at.posture, motion)
    return None if posture is None else AtPosture(at.question, posture)
