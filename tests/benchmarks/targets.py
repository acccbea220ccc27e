"""What the kernel is meant to reach, as ratios of medians within one run or as times."""

from __future__ import annotations

import statistics
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from benchmarks.curves import Curve, Sharing
from benchmarks.timing import Measured

EXPONENT = 1.15
SPEEDUP = 1.8


@dataclass(frozen=True)
class Target:
    """One line of the table of targets.

    Attributes:
        question: Kind of question.
        over: The way the kernel is compared with; None where the target is a time.
        most: Largest ratio, or time [s]; None for a line that is only shown.
        text: The target in words.
    """

    question: str
    over: str | None
    most: float | None
    text: str


TARGETS = (
    Target("region", "Klampt polygon, 4 sides", 0.20, "<= 0.20"),
    Target("region", "cvxpy, solved again", 1 / 300, "<= 1/300"),
    Target("direction", None, 4e-6, "<= 4 us"),
    Target("direction", "bare Clarabel", 1 / 12, "<= 1/12"),
    Target("direction", "bare Clarabel, dual", None, "shown"),
    Target("verdict", None, 6e-6, "<= 6 us"),
    Target("verdict", "hpp DLP, 4 edges", 0.5, "<= 0.5"),
    Target("minimax", None, 40e-6, "<= 40 us"),
    Target("torque", None, 2e-3, "<= 2000 us"),
)


@dataclass(frozen=True)
class Reached:
    """What came of a target.

    Attributes:
        what: Both sides with solver and cone.
        value: Median, in words.
        worst: Worst case, in words.
        verdict: "reached", "missed", "shown", or why it was skipped.
        text: The target in words.
    """

    what: str
    value: str
    worst: str
    verdict: str
    text: str


def ratio(value: float) -> str:
    """A ratio in words; small ones as a fraction."""
    return f"1/{1 / value:.0f}" if value < 0.05 else f"{value:.2f}"


def judged(target: Target, measured: Sequence[Measured]) -> Reached:
    """A target against what was measured."""
    by_name = {m.way.name: m for m in measured}
    own = by_name["kernel"]
    peer = by_name.get(target.over or "kernel")
    what = f"{target.question}: {own.way.full_name}"
    if target.over is not None:
        what += f" / {peer.way.full_name if peer else target.over}"
    if not own.times or peer is None or not peer.times:
        reason = own.way.missing or next(iter(own.failures.values()), None)
        if reason is None:
            reason = (peer.way.missing if peer else None) or f"{target.over}: nothing measured"
        return Reached(what, "", "", f"skipped: {reason}", target.text)
    values = own.medians() if target.over is None else own.over(peer)
    show = (lambda v: f"{1e6 * v:.1f} us") if target.over is None else ratio
    median = statistics.median(values)
    verdict = "shown" if target.most is None else "reached" if median <= target.most else "missed"
    return Reached(what, show(median), show(max(values)), verdict, target.text)


def all_judged(by_question: Mapping[str, Sequence[Measured]]) -> list[Reached]:
    """Every target of the questions that were asked."""
    return [judged(t, by_question[t.question]) for t in TARGETS if t.question in by_question]


def growth_judged(curves: Sequence[Curve]) -> list[Reached]:
    """The exponent of the kernel; a target where the region stays the same, shown where it changes with the points."""
    (own,) = (c for c in curves if c.way.name == "kernel")
    what = f"growth of a {own.question} with the points, family '{own.family}': {own.way.full_name}"
    text = f"<= {EXPONENT}" if own.family == "soles" else "shown"
    if own.exponent is None:
        return [Reached(what, "", "", f"skipped: {own.note or 'fewer than three numbers of points'}", text)]
    verdict = "shown" if text == "shown" else "reached" if own.exponent <= EXPONENT else "missed"
    return [Reached(what, f"{own.exponent:.2f}", "", verdict, text)]


def threads_judged(sharing: Sharing) -> Reached:
    """Two threads over one."""
    what = f"two threads over a batch of {sharing.regions} regions: kernel, times one thread"
    if 2 not in sharing.seconds:
        return Reached(what, "", "", f"skipped: {sharing.missing}", f">= {SPEEDUP}")
    verdict = "reached" if sharing.speedup(2) >= SPEEDUP else "missed"
    return Reached(what, f"{sharing.speedup(2):.2f}", "", verdict, f">= {SPEEDUP}")
