"""The tables as text."""

from __future__ import annotations

import statistics
from collections.abc import Callable, Sequence

from benchmarks.curves import FIT_FROM, Curve, Sharing
from benchmarks.targets import Reached, ratio
from benchmarks.timing import Measured


def microseconds(seconds: float) -> str:
    """A time with three digits or more."""
    value = 1e6 * seconds
    return f"{value:.2f}" if value < 10 else f"{value:.1f}" if value < 1000 else f"{value:.0f}"


def table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """Columns aligned: the first and the last to the left, numbers to the right."""
    widths = [max(len(str(row[k])) for row in (head, *rows)) for k in range(len(head))]
    left = (0, len(head) - 1)

    def line(row: Sequence[str]) -> str:
        cells = (str(c).ljust(w) if k in left else str(c).rjust(w) for k, (c, w) in enumerate(zip(row, widths, strict=True)))
        return "  ".join(cells).rstrip()

    return [line(row) for row in (head, *rows)]


def question_table(title: str, found: Sequence[Measured], error: Callable[[Measured], str]) -> list[str]:
    """One kind of question: medians over the cases, ratios to the first way that was measured, errors."""
    measured = [m for m in found if m.times]
    lines = ["", title]
    if measured:
        first = measured[0]
        rows = []
        for m in measured:
            times = m.medians()
            over = first.over(m)
            ratios = ("1", "1") if m is first else (ratio(statistics.median(over)), ratio(max(over))) if over else ("", "")
            note = error(m) + (f"; no answer to {len(m.failures)} of {len(m.times) + len(m.failures)}" if m.failures else "")
            rows.append((m.way.full_name, microseconds(statistics.median(times)), microseconds(max(times)), *ratios, note))
        lines += table(("way", "median us", "worst us", f"{first.way.name} / it", "worst", "error against the exact answer"), rows)
    for m in found:
        if m.way.missing is not None:
            lines.append(f"skipped  {m.way.name}: {m.way.missing}")
        elif not m.times:
            lines.append(f"skipped  {m.way.name}: {next(iter(m.failures.values()), 'no case')}")
        for case, why in list(m.failures.items())[:3] if m.times else []:
            lines.append(f"note     {m.way.name}, {case}: {why}")
    return lines


def growth_table(curves: Sequence[Curve]) -> list[str]:
    """Times of the ways against the number of contact points."""
    points = sorted({n for c in curves for n in c.points})
    rows = []
    for c in curves:
        if c.points:
            times = dict(zip(c.points, c.seconds, strict=True))
            exponent = "" if c.exponent is None else f"{c.exponent:.2f}"
            rows.append((c.way.full_name, *(microseconds(times[n]) if n in times else "" for n in points), exponent, c.note))
    lines = table(("points", *map(str, points), f"exponent from {FIT_FROM}", ""), rows) if rows else []
    return lines + [f"skipped  {c.way.name}: {c.note}" for c in curves if not c.points]


def threads_table(sharing: Sharing) -> list[str]:
    """Time of a batch against the number of threads."""
    if sharing.missing is not None:
        return [f"skipped  kernel: {sharing.missing}"]
    rows = [
        (str(n), microseconds(t / sharing.regions), f"{sharing.speedup(n):.2f}", f"{sharing.busy[n]:.2f}")
        for n, t in sharing.seconds.items()
    ]
    same = "the same regions on every number of threads" if sharing.same else "REGIONS DEPEND ON THE NUMBER OF THREADS"
    return [*table(("threads", "us a region", "times one thread", "processors it had"), rows), same]


def targets_table(reached: Sequence[Reached]) -> list[str]:
    """The targets, with both sides named."""
    asked = [r for r in reached if r.value]
    rows = [(r.text, r.verdict, r.value, r.worst, r.what) for r in asked]
    lines = table(("target", "", "median", "worst", "over the suite"), rows) if rows else []
    return lines + [f"{r.verdict}; target {r.text}, {r.what}" for r in reached if not r.value]
