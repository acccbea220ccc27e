"""The counts of a sweep, and how they are printed."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator
from typing import Any

import numpy as np
from sweeps.outcome import CHECKS, Outcome

LEAST_SHARE = 0.3
HANDOVERS_AIM = 1e-3
SHOWN = 60
WIDTHS = (8, 9, 10, 11, 7, 7, 13, 8)


class Summary:
    """Counts of outcomes, one at a time.

    Args:
        title: What was swept.
        sides: Of the pyramids of the linear programs.
    """

    def __init__(self, title: str, sides: int):
        self.title, self.sides = title, sides
        self.wall = 0.0
        self.stances = self.contacts = 0
        self.families: dict[str, Counter[str]] = defaultdict(Counter)
        self.counts: Counter[str] = Counter()
        self.broken: Counter[str] = Counter()
        self.largest: dict[str, tuple[float, str]] = {}
        self.open: Counter[str] = Counter()
        self.kinds: Counter[str] = Counter()
        self.engines: Counter[str] = Counter()
        self.seconds: Counter[str] = Counter()
        self.violations: list[dict[str, str]] = []
        self.handed_over: list[str] = []
        self.undecided: list[str] = []
        self.gaps: list[float] = []
        self.excess: list[float] = []
        self.ranges: dict[str, tuple[float, float]] = {}

    def add(self, out: Outcome) -> None:
        """Count one stance."""
        family, name = self.families[out.case.family], str(out.case)
        self.stances += 1
        family["stances"] += 1
        family[out.verdict] += 1
        family["inf"] += out.margin == np.inf
        family["-inf"] += out.margin == -np.inf
        family["violations"] += bool(out.violations)
        family["handed over"] += out.handovers > 0
        family["regions"] += out.region != "none"
        family["regions handed over"] += out.region_handovers > 0
        self.counts.update(out.counts)
        self.seconds.update(out.seconds)
        for what, value in out.largest.items():
            self.largest[what] = max(self.largest.get(what, (-1.0, "")), (value, name))
        for check, message in out.violations:
            self.broken[check] += 1
            self.violations.append({"stance": name, "check": check, "message": message})
        if out.handovers or out.region_handovers:
            self.handed_over.append(name)
        if out.open_because:
            self.open[out.open_because] += 1
            self.undecided.append(f"{name} {out.open_because}")
        self.kinds[out.region + (", cones widened" if out.widened else "")] += 1
        self.engines.update({f"verdict {out.engine}": 1, f"region {out.region_engine or 'none'}": 1})
        self.excess.append(out.excess)
        if np.isfinite(out.low) and np.isfinite(out.high):
            self.gaps.append((out.high - out.low) / max(1.0, abs(out.high)))
            self.largest["doubt of the linear programs [relative]"] = max(
                self.largest.get("doubt of the linear programs [relative]", (-1.0, "")), (out.doubt, name)
            )
        spans = {"size [m]": (out.size,) * 2, "mass [kg]": (out.mass,) * 2, "offset [m]": (out.offset,) * 2, "friction": out.frictions}
        for what, (low, high) in (spans | {"contacts": (out.contacts,) * 2, "points": (out.points,) * 2}).items():
            before = self.ranges.get(what, (np.inf, -np.inf))
            self.ranges[what] = (min(before[0], low), max(before[1], high))

    @property
    def total(self) -> Counter[str]:
        """Counts over all families."""
        total: Counter[str] = Counter()
        for family in self.families.values():
            total.update(family)
        return total

    @property
    def lopsided(self) -> bool:
        """Whether stable or unstable stances are too few to say anything."""
        return min(self.total["stable"], self.total["unstable"]) < LEAST_SHARE * self.stances

    def lines(self) -> Iterator[str]:
        """The summary as text."""
        yield self.title
        yield "ranges: " + ", ".join(f"{what} {low:.3g} to {high:.3g}" for what, (low, high) in self.ranges.items())
        yield from self._by_family()
        yield from self._by_check()
        yield from self._handovers()
        yield from self._brackets()
        yield "seconds: " + ", ".join(f"{what} {t:.0f}" for what, t in self.seconds.most_common()) + f"; {self.wall:.0f} in all"
        yield f"violations: {len(self.violations)} on {self.total['violations']} stances"
        for found in self.violations[:SHOWN]:
            yield f"  {found['stance']}  {found['check']}: {found['message']}"
        if len(self.violations) > SHOWN:
            yield f"  and {len(self.violations) - SHOWN} more (--json has them all)"
        if self.lopsided:
            yield f"too few stable or unstable stances: at least {LEAST_SHARE:.0%} of each are needed"

    def _by_family(self) -> Iterator[str]:
        yield ""
        head = ("stances", "stable", "unstable", "undecided", "inf", "-inf", "handed over", "broken")
        yield f"{'family':<12}" + "".join(f"{word:>{width}}" for word, width in zip(head, WIDTHS, strict=True))
        for name, n in [*sorted(self.families.items()), ("all", self.total)]:
            shares = [f"{n[v] / n['stances']:.1%}" for v in ("stable", "unstable", "undecided")]
            over = f"{n['handed over']}+{n['regions handed over']}"
            row = (n["stances"], *shares, n["inf"], n["-inf"], over, n["violations"])
            yield f"{name:<12}" + "".join(f"{value:>{width}}" for value, width in zip(row, WIDTHS, strict=True))
        yield "undecided: " + (", ".join(f"{count} {why}" for why, count in self.open.most_common()) or "none")
        yield "regions: " + ", ".join(f"{count} {kind}" for kind, count in self.kinds.most_common())

    def _by_check(self) -> Iterator[str]:
        yield ""
        for check, asks in CHECKS.items():
            yield f"{check:<20}{self.counts[check]:>9} checked {self.broken[check]:>6} broken   {asks}"
        yield ""
        for what, (value, name) in self.largest.items():
            yield f"largest {what:<48}{value:>10.2e}   {name}"

    def _handovers(self) -> Iterator[str]:
        n = self.total
        yield ""
        yield "engines: " + ", ".join(f"{what} {count}" for what, count in self.engines.most_common())
        asked = n["stances"] + n["regions"]
        rate = (n["handed over"] + n["regions handed over"]) / max(asked, 1)
        of = f"{n['handed over']} of {n['stances']} verdicts and {n['regions handed over']} of {n['regions']} regions"
        yield f"handed over: {of}, {rate:.3%} (aim: below {HANDOVERS_AIM:.1%})"
        if self.handed_over:
            yield "  " + " ".join(self.handed_over[:20]) + (" ..." if len(self.handed_over) > 20 else "")

    def _brackets(self) -> Iterator[str]:
        finite = np.array(self.gaps) if self.gaps else np.zeros(1)
        yield ""
        yield (
            f"brackets: inscribed and circumscribed pyramids of {self.sides} sides on every stance, every ray priced;"
            f" {len(self.gaps)} finite, width median {np.median(finite):.1e}, largest {finite.max():.1e}"
        )
        excess = np.array(self.excess) if self.excess else np.zeros(1)
        beyond = int((excess > 1e-11).sum())
        yield f"margins outside their bracket: by {excess.max():.1e} at most, {beyond} by more than 1e-11 (over the larger of margin and W)"

    def record(self) -> dict[str, Any]:
        """The summary for a file."""
        return {
            "title": self.title,
            "sides": self.sides,
            "seconds": {"in all": self.wall, **self.seconds},
            "ranges": self.ranges,
            "families": {name: dict(n) for name, n in sorted(self.families.items())},
            "total": dict(self.total),
            "checks": {check: {"checked": self.counts[check], "broken": self.broken[check]} for check in CHECKS},
            "largest": {what: {"value": value, "stance": name} for what, (value, name) in self.largest.items()},
            "undecided": self.undecided,
            "regions": dict(self.kinds),
            "engines": dict(self.engines),
            "handed over": self.handed_over,
            "violations": self.violations,
        }
