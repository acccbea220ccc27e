"""The margin program of one stance, settled: a number with forces or a motion behind it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from socp_statics.certificates import ForceResiduals, Motion, MotionCertificate, force_residuals, motion_certificate, motion_of
from socp_statics.certificates.bracing import least_braced
from socp_statics.certificates.optimum import Multipliers, Optimum
from socp_statics.cones.choice import ConeChoice
from socp_statics.engines import engines_for
from socp_statics.engines.engine import Engine
from socp_statics.engines.solution import SOLVED, Solution
from socp_statics.exceptions import EngineError
from socp_statics.models.contact_forces_set import force_shape, force_values
from socp_statics.models.equilibrium import MODEL
from socp_statics.models.hard_rows import MODEL as HARD_ROWS
from socp_statics.models.hard_rows import hard_values
from socp_statics.spatial import Array
from socp_statics.stability.prices import margin_optimum, shortfall_optimum
from socp_statics.statics.statics_data import StaticsData
from socp_statics.statics.units import BOUNDARY
from socp_statics.statics.wrench_range import INSIDE, OUTSIDE, WrenchRange, wrench_range

FORCE_TOLERANCE = 1e-8
# Forces beyond this, in units of W, do not balance to the tolerance once they are numbers in newtons: their sum is rounded.
LARGEST_FORCE = 1e7
# Reserves that are tried, in units of W: where walls hardly close, one of W takes forces of millions, and a smaller one says as much.
CAPS = (1.0, 1e-2, 1e3, 1e6)
# What forces that brace keep of them where they would be too large.
RESERVE = 1e-3


@dataclass(frozen=True, eq=False)
class Margin:
    """Normal-force reserve of a stance, in units of W.

    Attributes:
        value: The margin; inf, -inf, or nan where the load is out of reach by too little to tell.
        x: Scaled forces that attain it (or exceed the boundary, where it is infinite), or None.
        certificate: The motion behind a negative margin, or None.
        held: How well the forces keep their promises, or None.
        motion: Motion of the multipliers, or None.
        gap: Difference of primal and dual objective, relative.
        engine: Name of the engine that answered.
        handovers: How many engines did not settle before; the compiled programs of the kernel and its general method are one engine.
        optimum: Forces and multipliers that prices follow from: of a finite margin, or of the hard rows where they cannot be met.
    """

    value: float
    x: Array | None
    held: ForceResiduals | None
    certificate: MotionCertificate | None
    motion: Motion | None
    gap: float
    engine: str
    handovers: int
    optimum: Optimum | None = None


def normal_force_margin(data: StaticsData, cone: ConeChoice, form: str, engine: str | Sequence[str]) -> Margin:
    """Largest reserve t for which balancing forces exist with ``f - t n`` in every cone.

    Args:
        data: The stance's arrays.
        cone: Exact cones or pyramids.
        form: "socp" or "sdp".
        engine: "auto", the name of an engine, or several to be tried in turn.

    Returns:
        The margin with its certificate.

    Raises:
        EngineError: No engine settled the program.
        InputError: There is no such engine.
    """
    reach = wrench_range(data.wrench_map)
    engines = engines_for(engine, form)
    outside = reach.outside(data.load)
    if outside > OUTSIDE:
        motion = motion_of(data, reach.null @ (reach.null.T @ data.load))
        return Margin(-np.inf, None, None, motion_certificate(data, cone, motion), motion, 0.0, engines[0].name, 0)
    if outside > INSIDE:
        return Margin(np.nan, None, None, None, None, 0.0, engines[0].name, 0)
    for handovers, one in enumerate(engines):
        margin = _settled(data, cone, form, one, reach)
        if margin is not None:
            return replace(margin, handovers=handovers)
    raise EngineError(f"the margin was not settled to {FORCE_TOLERANCE:g} by {', '.join(e.name for e in engines)}", name=engines[-1].name)


def _settled(data: StaticsData, cone: ConeChoice, form: str, engine: Engine, reach: WrenchRange) -> Margin | None:
    """The margin by one engine, or None where its answer does not check."""
    compiled = engine.compile(MODEL, force_shape(data, cone, form, reach.rank))
    values = force_values(data, cone, reach.basis)
    braced: Margin | None = None
    for cap in CAPS:
        solution = compiled.solve({**values, "cap": cap})
        if solution.status != SOLVED:
            blocked = _blocked(data, cone, engine, reach)
            if blocked is not None:
                return blocked
            continue
        x, (t,) = solution.variables["x"], solution.variable("t")
        if t < cap * (1 - 1e-6):
            return _finite(data, cone, engine, reach, solution, x, t)
        x = balanced(data, cone, x)
        held = force_residuals(data, cone, x)
        if braced is None and max(held) <= FORCE_TOLERANCE and float(np.abs(x).max(initial=0.0)) <= LARGEST_FORCE:
            braced = Margin(np.inf, x, held, None, None, solution.gap, engine.name, 0)
        if braced is not None and _internal_force_inside(data, cone, form, engine, reach):
            return braced
    return None


def _blocked(data: StaticsData, cone: ConeChoice, engine: Engine, reach: WrenchRange) -> Margin | None:
    """The margin -inf where balance and hard rows cannot be met for any reserve, with the motion that shows it."""
    shape, values = hard_values(data, reach.basis)
    solution = engine.compile(HARD_ROWS, shape).solve(values)
    if solution.status != SOLVED or solution.objective <= FORCE_TOLERANCE:
        return None
    motion = motion_of(data, reach.basis @ solution.duals["balance"], solution.duals.get("limits"))
    certificate = motion_certificate(data, cone, motion)
    if certificate is None:
        return None
    optimum = shortfall_optimum(data, cone, reach.basis, values, solution)
    return Margin(-np.inf, None, None, certificate, motion, solution.gap, engine.name, 0, optimum)


def _finite(
    data: StaticsData, cone: ConeChoice, engine: Engine, reach: WrenchRange, solution: Solution, x: Array, t: float
) -> Margin | None:
    """A margin below the cap, if its certificate checks."""
    gap = solution.gap
    if gap > FORCE_TOLERANCE:
        return None
    duals, twist = solution.duals, reach.basis @ solution.duals["balance"]
    optimum = margin_optimum(data, cone, x, t, Multipliers.read(data, twist, duals))
    motion = motion_of(data, twist, duals.get("limits")) if t < BOUNDARY else None
    if motion is not None and t <= -BOUNDARY:
        # There are no forces to check: what is left of the constraints moves the margin by as much as the multipliers say.
        error = solution.residuals.primal * (1.0 + max(float(np.abs(y).max(initial=0.0)) for y in solution.duals.values()))
        if error > BOUNDARY * max(1.0, -t):
            return None
        certificate = motion_certificate(data, cone, motion)
        return None if certificate is None else Margin(t, None, None, certificate, motion, gap, engine.name, 0, optimum)
    held = force_residuals(data, cone, x)
    # Where t is negative within the boundary, the forces leave their cones by t times slopes and numbers of points.
    lacking = max(-t, 0.0) * (1.0 + data.friction.max(initial=0.0)) * max(data.points, 1)
    if held.balance > FORCE_TOLERANCE or held.cone > FORCE_TOLERANCE + lacking:
        return None
    return Margin(t, x, held, None, motion, gap, engine.name, 0, optimum)


def balanced(data: StaticsData, cone: ConeChoice, x: Array) -> Array:
    """Forces that brace with their balance restored: the least correction, which their reserve of cone absorbs; no larger than need be."""
    x = x - np.linalg.lstsq(data.wrench_map, data.wrench_map @ x + data.load, rcond=None)[0]
    return least_braced(data, cone, x, RESERVE)


def _internal_force_inside(data: StaticsData, cone: ConeChoice, form: str, engine: Engine, reach: WrenchRange) -> bool:
    """Whether an internal force lies strictly inside every cone with no bound or limit to stop it.

    The margin program without load, with zero bounds and limits, is a cone: its value is 0 or whatever the cap allows.
    """
    if np.isfinite(data.bounds[:, 1]).any():
        return False
    free = replace(
        data,
        load=np.zeros(6),
        bounds=np.where(np.isfinite(data.bounds), 0.0, data.bounds),
        limit_values=np.zeros_like(data.limit_values),
    )
    compiled = engine.compile(MODEL, force_shape(data, cone, form, reach.rank))
    values = force_values(free, cone, reach.basis)
    solution = compiled.solve({**values, "cap": 1.0})
    return solution.status == SOLVED and float(solution.objective) > 0.5
