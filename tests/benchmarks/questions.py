"""The kinds of question the benchmarks ask: cases, exact answers, and how far an answer is from them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

import socp_statics as ss
from benchmarks.suite import MASS, Array, BenchmarkStance
from benchmarks.timing import Measured
from socp_statics.cones import ConeChoice
from socp_statics.engines import engines_for
from socp_statics.regions import polygon
from socp_statics.regions.directions import Directions, com_plane
from socp_statics.regions.sandwich import START, Sandwich
from socp_statics.statics import StaticsData, assemble

GAP = 1e-3
EXACT_GAP = 1e-5
BEYOND = 1e-7
EXACT = ConeChoice()
REFERENCE = "clarabel"


@dataclass(frozen=True)
class Case:
    """One instance of a question.

    Attributes:
        name: Its name.
        stance: Makes the stance anew, a ContactSet or a Stance.
        origin: The stance of the suite behind it; None for a posture of a robot.
        directions: Unit vectors asked about, shape (k, 2).
        coms: Centres of mass asked about, shape (k, 3) [m].
    """

    name: str
    stance: Callable[[], Any]
    origin: BenchmarkStance | None = None
    directions: Array | None = None
    coms: Array | None = None

    @cached_property
    def data(self) -> StaticsData:
        """The arrays of the stance."""
        stance = self.stance()
        return assemble(stance if isinstance(stance, ss.Stance) else ss.Stance(stance, (0.0, 0.0, 0.0), MASS))

    def points(self) -> tuple[Array, Array, Array]:
        """Positions, normals and friction of the contact points."""
        assert self.origin is not None
        return self.origin.point_contacts()

    @cached_property
    def traced(self) -> Array:
        """The directions a tracer asks about to enclose the region, counter-clockwise, shape (k, 2)."""
        (engine,) = engines_for(REFERENCE)
        directions = Directions(self.data, com_plane(self.data), EXACT, "socp", engine)
        sandwich = Sandwich(directions.support, [directions.support(d) for d in START])
        sandwich.refine(GAP, lambda _: False)
        return np.array([s.d for s in sandwich.supports()])

    @cached_property
    def exact_area(self) -> float:
        """Area of the exact region [m^2], within half of 1e-5."""
        region = ss.trace_support_region(self.stance(), EXACT_GAP, engine=REFERENCE)
        return 0.5 * (region.inner_area + region.outer_area)

    @cached_property
    def exact_heights(self) -> Array:
        """How far the centre of mass can go in each direction, from the mean contact point [m], shape (k,)."""
        assert self.directions is not None
        (engine,) = engines_for(REFERENCE)
        directions = Directions(self.data, com_plane(self.data), EXACT, "socp", engine)
        return self.data.units.length * np.array([directions.support(tuple(d)).h for d in self.directions.tolist()])

    @cached_property
    def exact_verdicts(self) -> tuple[Array, Array]:
        """Whether each centre of mass is stable, and its margin [N], shapes (k,)."""
        assert self.coms is not None
        contacts = self.stance()
        answers = [ss.check_equilibrium(contacts, c, MASS, engine=REFERENCE) for c in self.coms]
        return np.array([a.stable for a in answers]), np.array([a.margin for a in answers])

    @cached_property
    def exact_forces(self) -> Array:
        """The least possible largest force of each centre of mass [N], shape (k,)."""
        assert self.coms is not None
        contacts = self.stance()
        return np.array([ss.minimise_largest_wrench(ss.Stance(contacts, c, MASS), engine=REFERENCE).objective for c in self.coms])


def region_cases(stances: Sequence[BenchmarkStance]) -> list[Case]:
    """Support regions."""
    return [Case(s.name, s.contacts, s) for s in stances]


def direction_cases(stances: Sequence[BenchmarkStance], count: int) -> list[Case]:
    """Single directions, in no order."""
    angles = np.random.default_rng(7).uniform(0.0, 2 * np.pi, count)
    ways = np.column_stack([np.cos(angles), np.sin(angles)])
    return [Case(s.name, s.contacts, s, directions=ways) for s in stances]


def verdict_cases(stances: Sequence[BenchmarkStance], count: int) -> list[Case]:
    """Many centres of mass over one set of contacts."""
    return [Case(s.name, s.contacts, s, coms=s.coms(count)) for s in stances]


def minimax_cases(stances: Sequence[BenchmarkStance], count: int) -> list[Case]:
    """Stable centres of mass."""
    cases = []
    for s in stances:
        coms = s.coms(4 * count)
        cases.append(Case(s.name, s.contacts, s, coms=coms[ss.check_equilibrium_many(s.contacts(), coms, mass=MASS).stable][:count]))
    return cases


def torque_cases(names: Sequence[str]) -> list[Case]:
    """Torque-limited regions of named problems."""
    return [Case(name, ss.load_problem(name).stance) for name in names]


def in_order(points: Array) -> float:
    """Area of a polygon of corners in order [m^2]."""
    return float(polygon.area(np.asarray(points, dtype=float)))


def area_errors(cases: Sequence[Case], measured: Measured) -> str:
    """How far areas are from the exact ones, in percent; every way gives polygons from inside."""
    errors = np.array([100.0 * (measured.answers[c.name] / c.exact_area - 1.0) for c in cases if c.name in measured.answers])
    too_large = int((errors > 100.0 * EXACT_GAP).sum())
    note = f", {too_large} LARGER than the exact region" if too_large else ""
    return f"area {np.median(errors):+.2f} % median, {errors[np.argmax(np.abs(errors))]:+.2f} % worst{note}"


def height_errors(cases: Sequence[Case], measured: Measured) -> str:
    """How far supporting lines are from the exact ones, over the size."""
    errors = []
    for c in cases:
        if c.name in measured.answers:
            heights = np.asarray(measured.answers[c.name])
            errors.append((heights - c.exact_heights[: len(heights)]) / c.data.units.length)
    every = np.concatenate(errors)
    beyond = int((every > BEYOND).sum()) if measured.way.side == "inscribed" else 0
    note = f", {beyond} BEYOND the exact line" if beyond else ""
    return f"{every[np.argmax(np.abs(every))]:+.1e} of the size at worst{note}"


def verdict_errors(cases: Sequence[Case], measured: Measured) -> str:
    """How many verdicts differ, how many on the side the cone does not allow, and the error of margins."""
    different = unexpected = asked = 0
    margins = [0.0]
    for c in cases:
        if c.name not in measured.answers:
            continue
        stable, margin = measured.answers[c.name]
        exact, exact_margin = (a[: len(stable)] for a in c.exact_verdicts)
        wrong = np.asarray(stable) != exact
        allowed = {"exact": np.zeros(len(stable), dtype=bool), "inscribed": exact, "circumscribed": ~exact}[measured.way.side]
        asked += len(stable)
        different += int(wrong.sum())
        unexpected += int((wrong & ~allowed).sum())
        if margin is not None:
            finite = np.isfinite(exact_margin)
            margins.append(float(np.abs(np.asarray(margin) - exact_margin)[finite].max(initial=0.0) / c.data.units.force))
    text = f"{different} of {asked} verdicts differ"
    if different and measured.way.side != "exact":
        text += f", {unexpected} on the {'unsafe' if measured.way.side == 'inscribed' else 'safe'} side"
    return text + (f"; margin off by {max(margins):.0e} W" if len(margins) > 1 else "; no margin")


def force_errors(cases: Sequence[Case], measured: Measured) -> str:
    """How far the largest force is from the least possible one."""
    errors = [
        np.abs(np.asarray(measured.answers[c.name]) / c.exact_forces[: len(measured.answers[c.name])] - 1.0).max()
        for c in cases
        if c.name in measured.answers
    ]
    return f"largest force off by {max(errors):.0e}"
