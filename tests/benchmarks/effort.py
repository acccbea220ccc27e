"""How much is asked and how often."""

from __future__ import annotations

from dataclasses import dataclass

from benchmarks.suite import GROWTH_POINTS, SUITE, BenchmarkStance, eight_points

HALF_SQUATS = tuple(f"hoap2/half_squat_{limit}" for limit in ("4", "3", "2", "1_5"))


@dataclass(frozen=True)
class Effort:
    """Settings of one run.

    Attributes:
        stances: Whose regions are traced.
        eight: Stances of eight points, for single programs.
        torque_problems: Named problems with torque limits.
        repetitions: How often everything is repeated.
        seconds: What takes longer than this is not repeated.
        directions: Directions asked about in each stance.
        coms: Centres of mass asked about in each stance.
        forces: Centres of mass whose contact forces are asked for in each stance.
        growth_points: Numbers of contact points of the growth table.
        growth_coms: Centres of mass asked about in each stance of the growth table.
        copies: How often the stances are repeated in the batch that threads share.
        peers: Whether peers are asked.
    """

    stances: tuple[BenchmarkStance, ...] = SUITE
    eight: tuple[BenchmarkStance, ...] = eight_points()
    torque_problems: tuple[str, ...] = HALF_SQUATS
    repetitions: int = 7
    seconds: float = 2.0
    directions: int = 1000
    coms: int = 1000
    forces: int = 250
    growth_points: tuple[int, ...] = GROWTH_POINTS
    growth_coms: int = 256
    copies: int = 64
    peers: bool = True


def full() -> Effort:
    """Everything."""
    return Effort()


def quick() -> Effort:
    """A few stances of every family, a few repetitions."""
    return Effort(
        stances=SUITE[2::4],
        eight=eight_points()[2::3],
        torque_problems=HALF_SQUATS[::2],
        repetitions=3,
        seconds=0.1,
        directions=100,
        coms=100,
        forces=25,
        growth_points=(3, 8, 16, 32, 64),
        growth_coms=100,
        copies=4,
    )
