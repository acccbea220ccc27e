"""The following region: what was attained along rays from a seed posture, and what stopped each ray."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from typing import Any

import numpy as np

from socp_statics.postures import Posture
from socp_statics.regions import polygon as polygons
from socp_statics.spatial import Array
from socp_statics.stability import EquilibriumAnswer

EQUILIBRIUM, TORQUE, JOINT_LIMIT, CANNOT_REACH, STEP_FAILURE = "equilibrium", "torque", "joint limit", "cannot reach", "step failure"
REASONS = (EQUILIBRIUM, TORQUE, JOINT_LIMIT, CANNOT_REACH, STEP_FAILURE)
OBJECTIVE = "least half squared distance to the seed posture: joints [rad, m] and base [m, rad] in the tangent space at the seed"
ATTAINED = "along the rays, up to the first exit of each; nothing is claimed between or beyond them"


@dataclass(frozen=True, eq=False)
class RayEnd:
    """One side of the exit of a ray.

    Attributes:
        distance: From the seed's centre of mass along the ray [m].
        posture: The posture there.
        answer: Its verdict, margin and certificate.
    """

    distance: float
    posture: Posture
    answer: EquilibriumAnswer

    def as_record(self) -> dict[str, Any]:
        """The record's entry."""
        posture, certificate = self.posture, self.answer.certificate
        return {
            "distance": self.distance,
            "position": posture.com_W,
            "height": float(posture.com_W[2]),
            **posture.as_record(),
            "verdict": self.answer.verdict,
            "margin": self.answer.margin,
            "certificate": None if certificate is None else certificate.as_record(),
        }


@dataclass(frozen=True, eq=False)
class FollowingRay:
    """How far the posture follows its centre of mass along one ray.

    Attributes:
        direction: Unit vector in the plane, shape (2,).
        attained: The last posture that holds.
        beyond: The first that does not, at most the tolerance further; None where none was found further on.
        stopped_at: How far along the ray the next step was tried: that of ``beyond``, or the one without a posture [m].
        reason: "equilibrium": cones and load, whatever the motors do; "torque": only because of torque limits; "joint limit" and
            "cannot reach": no posture nearby has its contacts and centre of mass there, with or without joints at their limits;
            "step failure": the continuation broke down, which is no exit of the region.
        joints: The joints that stop it: those that give way, or those at their limits.
        reading: One sentence.
        steps: Number of postures that were tried.
    """

    direction: Array
    attained: RayEnd
    beyond: RayEnd | None
    stopped_at: float
    reason: str
    joints: tuple[str, ...]
    reading: str
    steps: int

    @property
    def distance(self) -> float:
        """How far it gets [m]."""
        return self.attained.distance

    @property
    def exit(self) -> bool:
        """Whether the ray was followed to an exit."""
        return self.reason != STEP_FAILURE

    def as_record(self) -> dict[str, Any]:
        """The record's entry."""
        found = self.attained.as_record()
        del found["certificate"]
        return {
            "direction": self.direction,
            **found,
            "stopped_at": self.stopped_at,
            "reason": self.reason,
            "joints": list(self.joints),
            "reading": self.reading,
            "beyond": None if self.beyond is None else self.beyond.as_record(),
            "steps": self.steps,
        }


@dataclass(frozen=True, eq=False)
class FollowingRegion:
    """Horizontal centre-of-mass positions that a posture follows to along rays, its contacts staying where they are.

    Attributes:
        seed: The posture it starts from.
        start: Where the rays start: the seed, or the posture below or above it where a height was asked for.
        rays: The rays, counter-clockwise from the world's x axis.
        height: Height of the centre of mass [m], or None where it is free.
        step: Longest step along a ray [m].
        tolerance: Longest distance between the two sides of an exit [m].
    """

    seed: Posture
    start: RayEnd
    rays: tuple[FollowingRay, ...]
    height: float | None
    step: float
    tolerance: float

    @property
    def centre(self) -> Array:
        """Where the rays start, shape (2,) [m]."""
        return self.start.posture.com_W[:2]

    @property
    def distances(self) -> Array:
        """How far each ray gets, shape (rays,) [m]."""
        return np.array([ray.distance for ray in self.rays])

    @property
    def polygon(self) -> Array:
        """The attained ends joined, star-shaped about the centre; attained along the rays only, shape (rays, 2) [m]."""
        return self.centre + np.array([ray.distance * ray.direction for ray in self.rays])

    @property
    def area(self) -> float:
        """Area of the polygon [m^2]."""
        return max(polygons.area(self.polygon), 0.0)

    @property
    def handovers(self) -> int:
        """How many programs behind the ends of the rays went to another engine."""
        ends = [end for ray in self.rays for end in (ray.attained, ray.beyond) if end is not None]
        return sum(end.answer.handovers for end in ends)

    @property
    def reasons(self) -> dict[str, int]:
        """How many rays each reason stops, in the order of the reasons."""
        counted = Counter(ray.reason for ray in self.rays)
        return {reason: counted[reason] for reason in REASONS if counted[reason]}

    def as_record(self) -> dict[str, Any]:
        """The record's entry."""
        return {
            "height": "free" if self.height is None else self.height,
            "step": self.step,
            "tolerance": self.tolerance,
            "objective": OBJECTIVE,
            "attained": ATTAINED,
            "centre": self.centre,
            "polygon": self.polygon,
            "area": self.area,
            "start": self.start.as_record(),
            "reasons": self.reasons,
            "rays": [ray.as_record() for ray in self.rays],
        }
