"""Tracing support regions: by the kernel's compiled tracer where it applies, else one program at a time by any engine."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from itertools import accumulate
from typing import Any

import numpy as np

from socp_statics.cones.choice import ConeChoice, cone_choice
from socp_statics.contacts import ExternalWrench
from socp_statics.engines import compiled_first, engines_for
from socp_statics.engines.threads import checked_threads, in_chunks
from socp_statics.engines.work_memory import kept
from socp_statics.exceptions import EngineError, InputError
from socp_statics.regions.com_margin import on_edge_or
from socp_statics.regions.directions import com_plane
from socp_statics.regions.limited_tracing import trace_limited
from socp_statics.regions.question import RegionQuestion, region_question
from socp_statics.regions.support_region import SupportRegion
from socp_statics.regions.tracer import Tracer
from socp_statics.regions.witnesses import TracedWitnesses
from socp_statics.statics import assemble

# Regions in a piece of a batch, at most: what a thread waits for the interpreter while another one makes regions of a long one is lost.
PIECE = 16


def trace_support_region(
    contacts: Any,
    tolerance: float = 1e-3,
    *,
    height: float = 0.0,
    mass: float | None = None,
    cone: str | ConeChoice = "exact",
    sides: int | None = None,
    heading: float | None = None,
    form: str = "socp",
    engine: str | Sequence[str] = "auto",
    gravity: Any = None,
    external_wrenches: Iterable[ExternalWrench | dict[str, Any]] = (),
    torque_limits: bool | Mapping[str, Any] = False,
) -> SupportRegion:
    """The horizontal CoM positions in balance (Bretl and Lall 2008, with exact cones).

    Args:
        contacts: Contacts; a Stance, which brings height, mass, gravity and external wrenches and gets its CoM margin; or a Posture.
        tolerance: Of (outer area - inner area) / outer area, between 0 and 1.
        height: Height of the centre of mass; matters only where gravity is not vertical [m].
        mass: Mass [kg]; may be left out where no bound, limit or external wrench makes it matter.
        cone: "exact", "inscribed" or "circumscribed", or a ConeChoice.
        sides: Sides of the pyramids.
        heading: Heading of the pyramids [rad].
        form: "socp" or "sdp".
        engine: "auto", the name of an engine, or several to be tried in turn.
        gravity: Acceleration of gravity in world axes, shape (3,) [m/s^2].
        external_wrenches: Wrenches impressed on the robot; they stay where they are.
        torque_limits: Whether forces have to respect joint-torque limits: the robot's own, or a mapping of limits. The posture is
            frozen: gravity torques and Jacobians stay those of the posture while the centre of mass moves.

    Returns:
        The region.

    Raises:
        InputError: A number, name or choice is wrong; gravity is zero or horizontal.
        EngineError: No engine settled the region.
    """
    choice = cone_choice(cone, sides, heading)
    question = region_question(contacts, height, mass, gravity, external_wrenches, torque_limits)
    _checked_tolerance(tolerance)
    if compiled_first(engine, form):
        region = _by_the_kernel([question], choice, tolerance)[0] if question.compiled else trace_limited(question, choice, tolerance)
        if region is not None:
            return region
    return _one_by_one(question, choice, form, engine, tolerance)


def trace_support_regions(
    sets: Iterable[Any],
    tolerance: float = 1e-3,
    *,
    threads: int = 1,
    height: float = 0.0,
    mass: float | None = None,
    cone: str | ConeChoice = "exact",
    sides: int | None = None,
    heading: float | None = None,
    form: str = "socp",
    engine: str | Sequence[str] = "auto",
    gravity: Any = None,
    external_wrenches: Iterable[ExternalWrench | dict[str, Any]] = (),
    torque_limits: bool | Mapping[str, Any] = False,
) -> list[SupportRegion]:
    """The support regions of many sets of contacts, one after the other or in threads; each is what `trace_support_region` says.

    Args:
        sets: Of each region: contacts, a Stance, or a Posture.
        tolerance: Of (outer area - inner area) / outer area, between 0 and 1.
        threads: How many threads trace at the same time; the answers do not depend on it.
        height: Height of the centre of mass; matters only where gravity is not vertical [m].
        mass: Mass [kg]; may be left out where no bound, limit or external wrench makes it matter.
        cone: "exact", "inscribed" or "circumscribed", or a ConeChoice.
        sides: Sides of the pyramids.
        heading: Heading of the pyramids [rad].
        form: "socp" or "sdp".
        engine: "auto", the name of an engine, or several to be tried in turn.
        gravity: Acceleration of gravity in world axes, shape (3,) [m/s^2].
        external_wrenches: Wrenches impressed on the robot; they stay where they are.
        torque_limits: Whether forces have to respect joint-torque limits: the robot's own, or a mapping of limits. The posture is
            frozen: gravity torques and Jacobians stay those of the posture while the centre of mass moves.

    Returns:
        The regions, in order.

    Raises:
        InputError: A number, name or choice is wrong; gravity is zero or horizontal.
        EngineError: No engine settled the region.
    """
    choice = cone_choice(cone, sides, heading)
    _checked_tolerance(tolerance)
    checked_threads(threads)
    compiled = compiled_first(engine, form)

    def asked(part: Sequence[Any]) -> list[SupportRegion | RegionQuestion]:
        questions = [region_question(one, height, mass, gravity, external_wrenches, torque_limits) for one in part]
        return _free_ones(questions, choice, tolerance) if compiled else [*questions]

    def limited(part: Sequence[RegionQuestion]) -> list[SupportRegion | None]:
        return [None if q.compiled else trace_limited(q, choice, tolerance) for q in part]

    answers = in_chunks(asked, list(sets), PIECE, threads)
    open_ones = [i for i, answer in enumerate(answers) if isinstance(answer, RegionQuestion)]
    questions = [answers[i] for i in open_ones]
    found = in_chunks(limited, questions, 1, threads) if compiled else [None] * len(questions)
    for i, question, region in zip(open_ones, questions, found, strict=True):
        answers[i] = _one_by_one(question, choice, form, engine, tolerance) if region is None else region
    return answers


def _free_ones(questions: list[RegionQuestion], cone: ConeChoice, tolerance: float) -> list[SupportRegion | RegionQuestion]:
    """Regions of the questions that the compiled tracer of points with friction answers, and the other questions as they are."""
    answers: list[SupportRegion | RegionQuestion] = list(questions)
    free = [i for i, question in enumerate(questions) if question.compiled]
    if free:
        for i, region in zip(free, _by_the_kernel([questions[i] for i in free], cone, tolerance), strict=True):
            answers[i] = questions[i] if region is None else region
    return answers


def _checked_tolerance(tolerance: float) -> None:
    if not 0.0 < tolerance < 1.0:
        raise InputError(f"tolerance must be between 0 and 1, got {tolerance!r}", name="tolerance", field="tolerance")


@cache
def _kernel() -> tuple[Any, Any, Any, Any, int]:
    """The compiled tracer and what goes with it, imported when it is first used."""
    from socp_statics.engines.kernel.pyramids import cone_rows
    from socp_statics.engines.kernel.refinement import POLYGON, most_directions
    from socp_statics.engines.kernel.tracing import trace, work_arrays

    return trace, work_arrays, cone_rows, most_directions, POLYGON


def _by_the_kernel(questions: Sequence[RegionQuestion], cone: ConeChoice, tolerance: float) -> list[SupportRegion | None]:
    """Regions of points that nothing but friction limits; None where the compiled tracer leaves the question to the others."""
    trace, work_arrays, cone_rows, most_directions, polygon = _kernel()
    sets = [cone_rows(q.contacts.friction_points, cone) for q in questions]
    cones = list(map(len, sets))
    if len(sets) == 1:
        points, loads = sets[0], questions[0].load()[None]
    else:
        points, loads = np.concatenate(sets), np.array([q.load() for q in questions])
    work = kept(work_arrays, max(cones), most_directions(tolerance))
    counts, numbers, inner, outer, multipliers, motions, lines = trace(points, np.array([0, *accumulate(cones)]), loads, tolerance, work)
    regions: list[SupportRegion | None] = []
    at = edges = rows = 0
    for question, n, (kind, k, m, solves), (gap, margin, size, inner_area, outer_area) in zip(
        questions, cones, counts.tolist(), numbers.tolist(), strict=True
    ):
        if kind != polygon:
            regions.append(None)
            continue
        com_margin = on_edge_or(margin, size) if question.with_com else None
        corner, edge, row = at + k, edges + m, rows + k * n
        witnesses = TracedWitnesses(question.stance, cone, multipliers[rows:row], motions[edges:edge])
        regions.append(
            SupportRegion.polygon(
                inner[at:corner], outer[edges:edge], lines[edges:edge], witnesses, cone, gap, solves, com_margin, size,
                inner_area, outer_area,
            )
        )  # fmt: skip
        at, edges, rows = corner, edge, row
    return regions


def _one_by_one(question: RegionQuestion, cone: ConeChoice, form: str, engine: str | Sequence[str], tolerance: float) -> SupportRegion:
    """One region, one program at a time, by the first engine that settles it."""
    data = assemble(question.stance())
    plane = com_plane(data)
    com = data.com[:2] if question.with_com else None
    broken = None
    for handovers, one in enumerate(engines_for(engine, form)):
        try:
            return Tracer(data, plane, cone, form, one, tolerance, com, handovers).region()
        except EngineError as error:
            broken = error
    assert broken is not None
    raise broken
