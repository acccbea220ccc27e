"""What a report says, gathered in one pass over the records, whatever their number."""

from __future__ import annotations

import heapq
import itertools
import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from socp_statics.runner import Results
from socp_statics.runner.results import row_of

MOST_SLOWEST, MOST_FAILURES, MOST_THUMBNAILS, MOST_PROBLEMS = 10, 50, 60, 400
VERDICTS = ("stable", "unstable", "undecided", "failed")


@dataclass
class Family:
    """The records of one problem.

    Attributes:
        verdicts: How many of each verdict; failed ones apart.
        unmet: How many are not what their file expects.
        margins: Finite margins over the weight.
        seconds: Time of all of them [s]; what is not known counts as nothing.
    """

    verdicts: Counter[str] = field(default_factory=Counter)
    unmet: int = 0
    margins: list[float] = field(default_factory=list)
    seconds: float = 0.0


@dataclass
class Thumbnail:
    """A region to be drawn small.

    Attributes:
        label: The case.
        verdict: Its verdict.
        region: The record's region.
        com: Horizontal position of the centre of mass [m].
    """

    label: str
    verdict: str
    region: Mapping[str, Any]
    com: tuple[float, float]


@dataclass
class Gathered:
    """Everything a report says.

    Attributes:
        name: Of the folder.
        records: Number of records that hold.
        stale: Number of records that no longer do.
        problems: Problem to its records.
        verdicts: How many of each verdict.
        slowest: Time [s] and case, the slowest first.
        failures: Case and reason.
        failed: How many failed; more than there are reasons listed.
        unmet: Case and expectation that does not hold.
        braced: How many margins are inf: the robot can brace itself at will.
        unheld: How many margins are -inf: no forces balance the load, whatever the cones.
        com_margins: Finite CoM margins [m].
        thumbnails: Regions, one a problem first.
        engines: How many records each engine answered.
        handovers: How many programs went to another engine than the first.
        versions: Library to its versions.
        timed: How many records have a time.
    """

    name: str
    records: int = 0
    stale: int = 0
    problems: dict[str, Family] = field(default_factory=dict)
    verdicts: Counter[str] = field(default_factory=Counter)
    slowest: list[tuple[float, str]] = field(default_factory=list)
    failures: list[tuple[str, str]] = field(default_factory=list)
    failed: int = 0
    unmet: list[tuple[str, str]] = field(default_factory=list)
    braced: int = 0
    unheld: int = 0
    com_margins: list[float] = field(default_factory=list)
    thumbnails: list[Thumbnail] = field(default_factory=list)
    engines: Counter[str] = field(default_factory=Counter)
    handovers: int = 0
    versions: dict[str, set[str]] = field(default_factory=dict)
    timed: int = 0

    @property
    def margins(self) -> list[float]:
        """Finite margins over the weight, of all problems."""
        return list(itertools.chain.from_iterable(family.margins for family in self.problems.values()))


def gather(results: Results, name: str) -> Gathered:
    """Read a results folder for a report.

    Args:
        results: Its records.
        name: What to call it.
    """
    found = Gathered(name, stale=results.stale_count)
    slowest: list[tuple[float, str]] = []
    first_of: set[str] = set()
    others: list[Thumbnail] = []
    for record, seconds in results.timed():
        row = row_of(record, seconds)
        label = f"{row['problem']} case {row['case']}" if "sweep" in record else str(row["problem"])
        family = found.problems.setdefault(row["problem"], Family())
        _count(found, family, record, row, label)
        if seconds is not None:
            found.timed += 1
            family.seconds += seconds
            (heapq.heappush if len(slowest) < MOST_SLOWEST else heapq.heappushpop)(slowest, (seconds, label))
        region = record.get("region")
        if region and region.get("inner") and row["com_x"] is not None:
            new = Thumbnail(label, row["verdict"], region, (row["com_x"], row["com_y"]))
            target = found.thumbnails if row["problem"] not in first_of else others
            first_of.add(row["problem"])
            if len(target) < MOST_THUMBNAILS:
                target.append(new)
    found.thumbnails += others[: MOST_THUMBNAILS - len(found.thumbnails)]
    found.slowest = sorted(slowest, key=lambda entry: (-entry[0], entry[1]))
    return found


def _count(found: Gathered, family: Family, record: Mapping[str, Any], row: Mapping[str, Any], label: str) -> None:
    found.records += 1
    verdict = "failed" if row["status"] == "failed" else row["verdict"]
    family.verdicts[verdict] += 1
    found.verdicts[verdict] += 1
    found.engines[row["engine"]] += 1
    found.handovers += row["handovers"]
    for library, version in record["versions"].items():
        found.versions.setdefault(library, set()).add(version)
    if verdict == "failed":
        found.failed += 1
        if len(found.failures) < MOST_FAILURES:
            found.failures.append((label, str(row["failure"] or "")))
    wrong = [entry for entry in record["expect"] if not entry["ok"]]
    if wrong:
        family.unmet += 1
        if len(found.unmet) < MOST_FAILURES:
            entry = wrong[0]
            found.unmet.append((label, f"{entry['key']} is {entry['value']!r}, expected {entry['expected']!r}"))
    margin, mass = row["margin"], row["mass"]
    if margin is not None and math.isinf(margin):
        found.braced += margin > 0.0
        found.unheld += margin < 0.0
    elif margin is not None and mass:
        family.margins.append(margin / (mass * _gravity(record)))
    if row["com_margin"] is not None and math.isfinite(row["com_margin"]):
        found.com_margins.append(row["com_margin"])


def _gravity(record: Mapping[str, Any]) -> float:
    gravity = record["case"]["posture"].get("gravity") or (0.0, 0.0, -9.81)
    return math.hypot(*gravity) or 9.81
