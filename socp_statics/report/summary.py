"""A report as Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from socp_statics.report.gathering import MOST_PROBLEMS, VERDICTS, Family, Gathered

Row = Sequence[Any]


class Table:
    """A table of a report.

    Args:
        title: What it is about.
        head: Column names.
        rows: Rows of words and numbers.
    """

    def __init__(self, title: str, head: Row, rows: Iterable[Row]):
        self.title, self.head, self.rows = title, head, [tuple(map(str, row)) for row in rows]


def tables(found: Gathered) -> list[Table]:
    """The tables of a report, those that say nothing left out.

    Args:
        found: What was gathered.
    """
    families = list(found.problems.items())
    counts = [(verdict, found.verdicts[verdict]) for verdict in VERDICTS if found.verdicts[verdict]]
    failed, problems = f"Failed ({found.failed})", f"Problems ({len(families)})"
    if found.failed > len(found.failures):
        failed = f"Failed (the first {len(found.failures)} of {found.failed})"
    if len(families) > MOST_PROBLEMS:
        problems = f"Problems (the first {MOST_PROBLEMS} of {len(families)})"
    every = [
        Table("Verdicts", ("verdict", "records"), counts),
        Table(failed, ("case", "reason"), found.failures),
        Table("Not as expected", ("case", "what"), found.unmet),
        Table(problems, ("problem", "cases", *VERDICTS, "not as expected", "median margin", "time"),
              [_problem_row(name, family) for name, family in families[:MOST_PROBLEMS]]),
        Table("Slowest", ("case", "time"), [(label, time_text(seconds)) for seconds, label in found.slowest]),
        Table("Margins", ("what", "records", "least", "5 %", "median", "95 %", "largest"), [
            _spread("margin over the weight", found.margins, "%", 100.0),
            _spread("CoM margin", found.com_margins, "mm", 1000.0),
        ]),
        Table("Engines", ("engine", "records"), sorted(found.engines.items())),
        Table("Versions", ("library", "version"), [(library, ", ".join(sorted(some))) for library, some in found.versions.items()]),
    ]  # fmt: skip
    return [table for table in every if any(any(row) for row in table.rows)]


def _problem_row(name: str, family: Family) -> Row:
    counts = [family.verdicts[verdict] or "" for verdict in VERDICTS]
    median = f"{round(100.0 * float(np.median(family.margins)), 6) + 0.0:.3g} %" if family.margins else ""
    seconds = time_text(family.seconds) if family.seconds else ""
    return (name, sum(family.verdicts.values()), *counts, family.unmet or "", median, seconds)


def _spread(what: str, values: Sequence[float], unit: str, factor: float) -> Row:
    if not len(values):
        return ()
    ends = np.percentile(np.asarray(values) * factor, [0.0, 5.0, 50.0, 95.0, 100.0])
    return (what, len(values), *(f"{round(end, 6) + 0.0:.4g} {unit}" for end in ends.tolist()))


def time_text(seconds: float) -> str:
    """A time as words."""
    return f"{seconds:.3g} s" if seconds >= 1.0 else f"{1e3 * seconds:.3g} ms"


def opening(found: Gathered) -> str:
    """The sentence a report begins with.

    Args:
        found: What was gathered.
    """
    plural = "s" if len(found.problems) != 1 else ""
    words = [f"{found.records} records of {len(found.problems)} problem{plural}"]
    words += [f"{found.verdicts[verdict]} {verdict}" for verdict in VERDICTS if found.verdicts[verdict]]
    if found.unmet:
        words.append(f"{sum(family.unmet for family in found.problems.values())} not as expected")
    if found.stale:
        words.append(f"{found.stale} stale records not counted")
    if found.braced or found.unheld:
        ends = ((found.braced, "inf (braced at will)"), (found.unheld, "-inf (no balance)"))
        counts = " and ".join(f"{count} margin{'s' if count != 1 else ''} of {end}" for count, end in ends if count)
        words.append(f"{counts} left out of medians and percentiles")
    if found.handovers:
        words.append(f"{found.handovers} programs handed to another engine")
    return ", ".join(words) + "."


def markdown(found: Gathered) -> str:
    """The summary.

    Args:
        found: What was gathered.
    """
    parts = [f"# Results: {found.name}", opening(found)]
    for table in tables(found):
        lines = [table.head, ["---"] * len(table.head), *(row for row in table.rows if row)]
        parts += [f"## {table.title}", "\n".join("| " + " | ".join(_cell(cell) for cell in line) + " |" for line in lines)]
    return "\n\n".join(parts) + "\n"


def _cell(text: str) -> str:
    return " ".join(text.replace("|", "\\|").split())
