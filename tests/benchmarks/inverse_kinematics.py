"""Inverse kinematics over seeded random targets: how often a posture is found, and how long it takes.

Run as a program; nothing is asserted. Targets are sloped and turned feet around where the robot's reference posture has them, the centre of
mass, and for humanoids a hand on a wall; lengths are scaled by the height of the centre of mass. Nobody guarantees that a target can be
reached. Times are processor times of one thread (set OMP_NUM_THREADS and OPENBLAS_NUM_THREADS to 1).
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from socp_statics import InputError, load_robot, reach
from socp_statics.postures import inverse_kinematics
from socp_statics.postures.random_reachable import random_places
from socp_statics.robots import ROBOTS

TARGETS = 300


@dataclass
class Survey:
    """What the targets of one robot gave.

    Attributes:
        robot: Its name.
        targets: How many.
        seconds: Processor time of each that was reached [s].
        refused: Processor time of each that was not [s].
        first: How many were reached from the reference posture.
        worst: Largest distance of a contact position from its place [m].
    """

    robot: str
    targets: int
    seconds: list[float] = field(default_factory=list)
    refused: list[float] = field(default_factory=list)
    first: int = 0
    worst: float = 0.0

    def line(self) -> str:
        """The survey as one line of the table."""
        ms = sorted(1e3 * t for t in self.seconds)
        median, p95 = (statistics.median(ms), ms[int(0.95 * (len(ms) - 1))]) if ms else (float("nan"), float("nan"))
        given_up = f"{1e3 * statistics.median(self.refused):.0f}" if self.refused else ""
        reached, at_once = 100 * len(ms) / self.targets, 100 * self.first / self.targets
        return f"{self.robot:<10}{reached:>9.1f}{at_once:>10.1f}{median:>8.2f}{p95:>9.2f}{given_up:>10}{self.worst:>10.1e}"


def survey(name: str, targets: int, seed: int = 0) -> Survey:
    """Try seeded random targets of a robot."""
    robot, found, rng = load_robot(name), Survey(name, targets), np.random.default_rng(seed)
    starts: list[None] = []
    nearest = inverse_kinematics._nearest

    def counted(*arguments: Any) -> np.ndarray:
        starts.append(None)
        return nearest(*arguments)

    inverse_kinematics._nearest = counted
    try:
        for _ in range(targets):
            placements, com = random_places(robot, rng)
            starts.clear()
            begin = time.process_time()
            try:
                posture = reach(robot, placements, com=com)
            except InputError:
                found.refused.append(time.process_time() - begin)
                continue
            found.seconds.append(time.process_time() - begin)
            found.first += len(starts) == 1
            misses = [np.abs(posture.contacts[contact].position - place[0]).max() for contact, place in placements.items()]
            found.worst = max(found.worst, float(max(misses)))
    finally:
        inverse_kinematics._nearest = nearest
    return found


def main(arguments: Sequence[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("robots", nargs="*", help="names in the catalogue, all by default")
    parser.add_argument("--targets", type=int, default=TARGETS)
    chosen = parser.parse_args(arguments)
    print(f"{chosen.targets} seeded random targets a robot")
    print(f"{'robot':<10}{'reached %':>9}{'at once %':>10}{'ms':>8}{'p95 ms':>9}{'given up':>10}{'worst m':>10}")
    for name in chosen.robots or ROBOTS.names():
        print(survey(name, chosen.targets).line(), flush=True)


if __name__ == "__main__":
    main()
