"""The same questions with a pyramid by HiGHS, for their times: the programs of `models`, without the checks of an answer."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from socp_statics.cones.choice import ConeChoice
from socp_statics.contacts import Stance
from socp_statics.engines.linear import LinearEngine
from socp_statics.engines.solution import SOLVED
from socp_statics.exceptions import EngineError
from socp_statics.models.contact_forces import MODEL as CONTACT_FORCES
from socp_statics.models.contact_forces import ContactForcesShape
from socp_statics.models.contact_forces_set import force_shape, force_values
from socp_statics.models.equilibrium import MODEL as EQUILIBRIUM
from socp_statics.models.minimax_wrench import MODEL as MINIMAX
from socp_statics.models.minimax_wrench import MinimaxShape
from socp_statics.models.program import ConicModel
from socp_statics.optimization.contact_forces import measured_forces
from socp_statics.optimization.minimax_wrench import measured
from socp_statics.regions.directions import com_plane
from socp_statics.regions.tracer import Tracer
from socp_statics.statics import assemble, wrench_range


class Linear(NamedTuple):
    """A value by HiGHS: what it is, None where it has no end, and the seconds inside the solver."""

    value: float | None
    inside: float


@cache
def _engine() -> LinearEngine:
    return LinearEngine()


def by_linear_programs(quantity: str, stance: Stance, parameters: Mapping[str, Any], cone: ConeChoice, tolerance: float) -> Linear:
    """One quantity with a pyramid by HiGHS.

    Args:
        quantity: "margin", "region", "contact_forces" or "minimax_wrench".
        stance: The stance.
        parameters: Of the problem: objective, measure, level, length.
        cone: A pyramid.
        tolerance: Of a region.

    Raises:
        EngineError: The question is no linear (or, with highspy, convex quadratic) program, or HiGHS failed.
    """
    engine = _engine()
    engine.spent.clear()
    data = assemble(stance)
    if quantity == "region":
        region = Tracer(data, com_plane(data), cone, "socp", engine, tolerance, None, 0).region()
        return Linear(region.inner_area if region.kind != "unbounded" else None, sum(engine.spent))
    reach = wrench_range(data.wrench_map)
    forces, values = force_shape(data, cone, "socp", reach.rank), force_values(data, cone, reach.basis)
    model: ConicModel
    shape: Any
    W = data.units.force
    if quantity == "margin":
        model, shape, scale = EQUILIBRIUM, forces, W
        values["cap"] = np.array(1.0)
    elif quantity == "contact_forces":
        objective = parameters.get("objective", "least_squares")
        if objective == "orin_oh":
            raise EngineError("orin_oh is compared by the conic engines only", name="highs")
        F, reference = measured_forces(data, objective, parameters.get("reference_forces") or {})
        model, shape, scale = CONTACT_FORCES, ContactForcesShape(forces, objective, len(F)), W if objective == "normal_force" else W * W
        values |= {"F": F, "reference": reference}
    else:
        measure = parameters.get("measure", "force")
        if measure not in ("normal", "component"):
            raise EngineError(f"measure {measure!r} is not linear", name="highs")
        what = measured(data, cone, measure, parameters.get("level", "point"), parameters.get("length", 0.1) / data.units.length)
        model, shape, scale = MINIMAX, MinimaxShape(forces, measure, what.groups), W
        values |= {"F": what.rows}
    solution = engine.compile(model, shape).solve(values)
    inside = sum(engine.spent)
    if solution.status != SOLVED:
        return Linear(None, inside)
    capped = quantity == "margin" and solution.objective >= 1.0 - 1e-6
    return Linear(None if capped else scale * solution.objective, inside)
