"""What the sweep keeps of a stance: answers, how far they were from every bound, and what did not hold."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import AbstractContextManager
from dataclasses import dataclass, field

import numpy as np
from sweeps.population import Case

# Every check, and what it asks for.
CHECKS = {
    "verdict": "no verdict contradicts the sign of its bracket; nothing is raised",
    "margin": "margin between the programs over inscribed and circumscribed pyramids",
    "idle": "contacts said to be idle carry nothing anywhere; the margin of the others in its own bracket",
    "undecided": "only planted, or where the two programs do not agree on a verdict",
    "forces": 'forces of "stable" balance to 1e-8 W inside their cones to 1e-7 W',
    "motion": 'no admissible force prevents the motion of "unstable"',
    "programs": "both linear programs settled",
    "region": "traced without an error; empty ones hold no CoM",
    "rays": "endless regions can grow along their rays",
    "inner forces": "forces of every inner corner balance to 1e-8 W inside their cones to 1e-7 W",
    "inner inside outer": "no inner corner outside the outer polygon",
    "half-planes": "the outer half-planes leave out no inner corner",
    "outer motions": "every outer edge has a motion that rules out what is beyond it",
    "com margin": "sign of the margin in metres agrees with the verdict",
    "process": "no stance takes its process with it",
    "batch": "batch calls say what single ones say",
}


class Phase(AbstractContextManager):
    """Part of the work on a stance: its time is taken, and whatever it raises becomes a violation of a check."""

    def __init__(self, out: Outcome, what: str, check: str):
        self._out, self._what, self._check = out, what, check

    def __enter__(self) -> Phase:
        self._start = time.perf_counter()
        return self

    def __exit__(self, kind, error, trace) -> bool:
        seconds = self._out.seconds
        seconds[self._what] = seconds.get(self._what, 0.0) + time.perf_counter() - self._start
        if isinstance(error, Exception):
            self._out.require(False, self._check, f"{kind.__name__}: {error}")
            return True
        return False


@dataclass
class Outcome:
    """One stance put to the checks; margins in units of W.

    Attributes:
        low: Margin over inscribed pyramids.
        high: Margin over circumscribed ones.
        doubt: How far these may be off by their own residuals, relative.
        excess: How far the toolkit's margin lies outside, relative, whatever is forgiven.
        expected: The verdict on which both programs agree, or "open".
        open_because: Why an undecided stance is undecided.
        largest: Largest value seen of each quantity that has a tolerance.
        counts: How often each check was made.
    """

    case: Case
    planted: bool
    contacts: int
    points: int
    size: float
    mass: float
    offset: float
    frictions: tuple[float, float]
    verdict: str = "none"
    reason: str | None = None
    expected: str = "open"
    margin: float = np.nan
    low: float = np.nan
    high: float = np.nan
    doubt: float = 0.0
    excess: float = 0.0
    engine: str = ""
    handovers: int = 0
    region: str = "none"
    region_engine: str = ""
    region_handovers: int = 0
    widened: bool = False
    open_because: str = ""
    largest: dict[str, float] = field(default_factory=dict)
    counts: dict[str, int] = field(default_factory=dict)
    violations: list[tuple[str, str]] = field(default_factory=list)
    seconds: dict[str, float] = field(default_factory=dict)

    def phase(self, what: str, check: str) -> Phase:
        """Part of the work, by the name its time is kept under, and the check that fails where it raises."""
        return Phase(self, what, check)

    def made(self, check: str, times: int = 1) -> None:
        """Count checks that were made."""
        self.counts[check] = self.counts.get(check, 0) + times

    def note(self, what: str, value: float) -> float:
        """Keep the largest value of a quantity."""
        self.largest[what] = max(self.largest.get(what, 0.0), float(value))
        return float(value)

    def require(self, holds: bool, check: str, message: str) -> None:
        """Keep a violation where something does not hold."""
        if not holds:
            self.violations.append((check, message))

    def lines(self) -> Iterator[str]:
        """The stance in a few words, and its violations."""
        where = f"size {self.size:.3g} m, mass {self.mass:.3g} kg, {self.offset:.3g} m away"
        answer = f"{self.verdict}, margin {self.margin:.9g} W of {self.low:.9g} to {self.high:.9g}, region {self.region}"
        yield f"{self.case}  {self.contacts} contacts, {self.points} points, {where}: {answer}"
        for check, message in self.violations:
            yield f"    {check}: {message}"
