"""Time against the number of contact points, and against the number of threads."""

from __future__ import annotations

import gc
import os
import statistics
import time
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

import socp_statics as ss
from benchmarks import own
from benchmarks.effort import Effort
from benchmarks.peers import all_ways
from benchmarks.questions import GAP, direction_cases, region_cases, verdict_cases
from benchmarks.suite import GROWING, growth
from benchmarks.timing import Clock, Way, interleaved

FIT_FROM = 8
# (kind of question, family): which ways are followed.
FOLLOWED = {
    ("region", "soles"): ("kernel", "Clarabel compiled", "bare Clarabel", "Klampt polygon, 4 sides", "HiGHS LP, 4 sides"),
    ("region", "oval"): ("kernel", "Clarabel compiled", "Klampt polygon, 4 sides", "HiGHS LP, 4 sides"),
    ("direction", "soles"): ("kernel", "Clarabel compiled", "bare Clarabel", "bare Clarabel, dual", "HiGHS LP, 4 sides"),
    ("verdict", "soles"): ("kernel", "Clarabel compiled", "hpp DLP, 4 edges", "HiGHS LP, 4 sides"),
}


@dataclass
class Curve:
    """Times of one way.

    Attributes:
        question: Kind of question.
        family: Family of stances.
        way: The way.
        points: Numbers of contact points asked about.
        seconds: Median seconds an answer.
        note: Why the curve ends, has gaps or is not there.
        ended: Whether more points are not asked about.
    """

    question: str
    family: str
    way: Way
    points: list[int] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)
    note: str = ""
    ended: bool = False

    @property
    def exponent(self) -> float | None:
        """Slope of log time over log number of points, from 8 points on; None with fewer than three numbers."""
        pairs = [(n, t) for n, t in zip(self.points, self.seconds, strict=True) if n >= FIT_FROM]
        if len(pairs) < 3:
            return None
        n, t = np.log(np.array(pairs)).T
        return float(np.polyfit(n, t, 1)[0])


def _cases(question: str, family: str, points: int, effort: Effort) -> list:
    stances = [growth(family, points)]
    if question == "region":
        return region_cases(stances)
    if question == "direction":
        return direction_cases(stances, effort.growth_coms)
    return verdict_cases(stances, effort.growth_coms)


def grow(effort: Effort, clock: Clock) -> Iterable[list[Curve]]:
    """One table after another: every way of one kind of question and one family."""
    assert set(GROWING) >= {family for _, family in FOLLOWED}
    for (question, family), names in FOLLOWED.items():
        ways = own.ways(question) + (all_ways(question) if effort.peers else [])
        curves = [Curve(question, family, w, note=w.missing or "", ended=w.missing is not None) for w in ways if w.name in names]
        for points in effort.growth_points:
            asked = [c for c in curves if not c.ended]
            cases = _cases(question, family, points, effort)
            (name,) = (c.name for c in cases)
            found = interleaved([c.way for c in asked], cases, effort.repetitions, effort.seconds, clock)
            for curve, measured in zip(asked, found, strict=True):
                if name in measured.failures:
                    curve.note += f"{'; ' if curve.note else ''}at {points} points: {measured.failures[name]}"
                    continue
                curve.points.append(points)
                curve.seconds.append(measured.median(name))
                if measured.median(name) * measured.counts[name] > effort.seconds and points < max(effort.growth_points):
                    curve.note += f"{'; ' if curve.note else ''}not asked beyond {points} points"
                    curve.ended = True
        yield curves


@dataclass(frozen=True)
class Sharing:
    """A batch of regions on several threads.

    Attributes:
        regions: Number of regions in the batch.
        seconds: Median seconds of the batch on the clock, by number of threads.
        busy: Processor time over time on the clock: how many processors the batch really had, by number of threads.
        same: Whether the regions are the same on every number of threads.
        missing: Why it was not measured, or None.
    """

    regions: int
    seconds: dict[int, float]
    busy: dict[int, float] = field(default_factory=dict)
    same: bool = True
    missing: str | None = None

    def speedup(self, threads: int) -> float:
        """Times one thread."""
        return self.seconds[1] / self.seconds[threads]


def numbers_of_threads() -> list[int]:
    """1, 2 and further powers of two up to the number of processors."""
    count = max(os.cpu_count() or 1, 2)
    return [n for n in (1, 2, 4, 8, 16, 32, 64) if n <= count]


def share(effort: Effort) -> Sharing:
    """The stances of the suite as one batch of regions, on one thread and on more."""
    missing = own.function_missing("trace_support_regions")
    threads = numbers_of_threads()
    stances = effort.stances * effort.copies
    if missing is not None:
        return Sharing(len(stances), {}, missing=missing)
    clocks = {n: Clock() for n in threads}
    times: dict[int, list[float]] = {n: [] for n in threads}
    areas: dict[int, list[float]] = {}
    for turn in range(effort.repetitions + 1):
        for n in threads[turn % len(threads) :] + threads[: turn % len(threads)]:
            batch = [s.contacts() for s in stances]
            gc.disable()
            start, worked = time.perf_counter(), time.process_time()
            regions = ss.trace_support_regions(batch, tolerance=GAP, threads=n)
            stop, done = time.perf_counter(), time.process_time()
            gc.enable()
            # The first turn may compile; it is not counted.
            if turn:
                times[n].append(stop - start)
                clocks[n].wall += stop - start
                clocks[n].processor += done - worked
            areas[n] = [r.inner_area for r in regions]
            # Else the next turn would give their memory back on its time.
            del regions
    same = all(a == areas[1] for a in areas.values())
    return Sharing(len(stances), {n: statistics.median(t) for n, t in times.items()}, {n: c.share for n, c in clocks.items()}, same)
