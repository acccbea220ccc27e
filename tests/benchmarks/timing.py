"""Timing several ways of answering the same questions, interleaved, so that a drift of the machine touches all of them.

Times are processor times of the whole process, all its threads together: on an idle machine and one thread they are the times of
the clock. On a busy one the clock counts what others do, and more so in long answers than in short ones, so that ratios would lie.
"""

from __future__ import annotations

import gc
import statistics
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

from socp_statics import StaticsError

# Answers shorter than this [s] are given once uncounted in every turn: the ways before have left the processor's caches full of
# their own, which costs a short answer several times what it takes in a loop, and a long one nothing.
SHORT = 0.02


class PeerFailed(Exception):
    """A peer gave no answer to a case."""


def nothing() -> None:
    """For ways that need nothing fresh."""


def itself(result: Any) -> Any:
    """The result is the answer."""
    return result


@dataclass
class Clock:
    """What all timed answers took.

    Attributes:
        processor: Processor time [s].
        wall: Time on the clock [s].
    """

    processor: float = 0.0
    wall: float = 0.0

    @property
    def share(self) -> float:
        """Processor time over time on the clock: near 1 on an idle machine."""
        return self.processor / self.wall if self.wall else 1.0


@dataclass(frozen=True)
class Trial:
    """One way of answering one case, made ready.

    Attributes:
        run: What is timed, from its argument to the finished result.
        answer: The result in the units of the question; not timed.
        fresh: Makes the argument anew for every repetition; not timed.
        count: Questions one run answers.
    """

    run: Callable[[Any], Any]
    answer: Callable[[Any], Any] = itself
    fresh: Callable[[], Any] = nothing
    count: int = 1


@dataclass(frozen=True)
class Way:
    """A way of answering a kind of question.

    Attributes:
        name: Its name, unique within a kind of question.
        solver: Who solves the programs.
        cone: What stands for the friction cones.
        ready: Makes a case ready; not timed. May raise PeerFailed where the way cannot be asked.
        side: "exact", or the side on which the cone errs, "inscribed" or "circumscribed".
        missing: Why the way is not there, or None.
    """

    name: str
    solver: str
    cone: str
    ready: Callable[[Any], Trial]
    side: str = "exact"
    missing: str | None = None

    @property
    def full_name(self) -> str:
        """Name, solver and cone."""
        return f"{self.name} ({self.solver}, {self.cone})"


@dataclass
class Measured:
    """What came of one way.

    Attributes:
        way: The way.
        times: Seconds an answer, by case and repetition.
        answers: By case.
        counts: Questions one run answered, by case.
        failures: Why a case has no answer, by case.
    """

    way: Way
    times: dict[str, list[float]] = field(default_factory=dict)
    answers: dict[str, Any] = field(default_factory=dict)
    counts: dict[str, int] = field(default_factory=dict)
    failures: dict[str, str] = field(default_factory=dict)

    def median(self, case: str) -> float:
        """Median seconds of one case."""
        return statistics.median(self.times[case])

    def medians(self) -> list[float]:
        """Median seconds of every case that was answered."""
        return [self.median(case) for case in self.times]

    def over(self, other: Measured) -> list[float]:
        """Ratios of the medians, case by case, of the cases both answered."""
        return [self.median(case) / other.median(case) for case in self.times if case in other.times]


def timed(trial: Trial, clock: Clock) -> tuple[float, Any]:
    """Seconds an answer, and the result, with the garbage collector held."""
    argument = trial.fresh()
    gc.disable()
    try:
        before = time.perf_counter()
        start = time.process_time()
        result = trial.run(argument)
        stop = time.process_time()
        after = time.perf_counter()
    finally:
        gc.enable()
    clock.processor += stop - start
    clock.wall += after - before
    return (stop - start) / trial.count, result


def interleaved(ways: Sequence[Way], cases: Iterable[Any], repetitions: int, seconds: float, clock: Clock) -> list[Measured]:
    """Ask every way about every case.

    Args:
        ways: The ways; those that are missing are left out.
        cases: The cases, with a `name` each.
        repetitions: How often each way answers each case, in turn with the others, after one run that is not counted.
        seconds: A way that has spent more than this on a case is not asked again.
        clock: Adds up what everything took.

    Returns:
        One result for every way, in order.
    """
    found = [Measured(way) for way in ways]
    for case in cases:
        trials, latest = [], {}
        for measured in found:
            if measured.way.missing is not None:
                continue
            try:
                trial = measured.way.ready(case)
                # The first run may compile, load or allocate; it is not counted.
                first, result = timed(trial, Clock())
                measured.answers[case.name] = trial.answer(result)
            # A library that is installed may still not load.
            except (StaticsError, PeerFailed, ImportError, OSError) as error:
                measured.failures[case.name] = str(error)
                continue
            measured.counts[case.name] = trial.count
            measured.times[case.name] = []
            latest[measured.way.name] = first * trial.count
            trials.append((measured, trial))
        gc.collect()
        for turn in range(repetitions):
            at = turn % max(len(trials), 1)
            for measured, trial in trials[at:] + trials[:at]:
                spent = measured.times[case.name]
                if sum(spent) * trial.count <= seconds:
                    if latest[measured.way.name] < SHORT:
                        timed(trial, Clock())
                    spent.append(timed(trial, clock)[0])
                    latest[measured.way.name] = spent[-1] * trial.count
    return found
