"""Regions of stances that more than friction limits, by the kernel's compiled tracer of general programs."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from socp_statics.cones.choice import ConeChoice
from socp_statics.regions.question import RegionQuestion
from socp_statics.regions.support_region import SupportRegion
from socp_statics.regions.tracer import ON_EDGE
from socp_statics.regions.witnesses import LimitedWitnesses
from socp_statics.statics import assemble


@cache
def _kernel() -> tuple[Any, Any, Any, Any, int]:
    """The compiled tracer and what goes with it, imported when it is first used."""
    from socp_statics.engines.kernel import conic
    from socp_statics.engines.kernel.plan_tracing import trace_plan
    from socp_statics.engines.kernel.refinement import POLYGON, most_directions
    from socp_statics.engines.kernel.support_rows import support_rows

    return conic, trace_plan, support_rows, most_directions, POLYGON


def trace_limited(question: RegionQuestion, cone: ConeChoice, tolerance: float) -> SupportRegion | None:
    """The region of a stance with limits, bounds, handles or soft fingers.

    Args:
        question: What is asked.
        cone: Exact cones or pyramids.
        tolerance: Of (outer area - inner area) / outer area.

    Returns:
        The region; None where the compiled tracer leaves it to the others: no polygon, or not settled.
    """
    conic, trace_plan, support_rows, most_directions, polygon = _kernel()
    data = assemble(question.stance())
    if not data.points:
        return None
    units, rows = data.units, support_rows(data, cone)
    n = rows.A.shape[1]
    W, F = conic.prepare(np.zeros(n), rows.A, rows.start, rows.column, rows.value, rows.orthant, rows.soc)
    com = data.com[:2] if question.with_com else np.full(2, np.nan)
    counts, numbers, inner, forces, outer, motions = trace_plan(
        conic.solve.address(), W, F, rows.A, rows.start, rows.column, rows.value, rows.orthant, rows.soc, rows.b, rows.h,
        data.wrench_map, rows.position, com, tolerance, most_directions(tolerance),
    )  # fmt: skip
    kind, solves = counts.tolist()
    if kind != polygon:
        return None
    gap, margin, inner_area, outer_area = numbers.tolist()
    origin, length = units.origin[:2], units.length
    lines = motions[:, -3:]
    lines[:, 2] = length * lines[:, 2] + lines[:, :2] @ origin
    return SupportRegion.polygon(
        origin + length * inner, origin + length * outer, inner_area=length**2 * inner_area, outer_area=length**2 * outer_area,
        relative_gap=gap, solves=solves, cone=cone, size=length, frozen=data.torques.limited, lines=lines,
        com_margin=None if not question.with_com else 0.0 if -ON_EDGE < margin <= 0.0 else length * margin,
        witnesses=LimitedWitnesses(data, forces[:, : data.wrench_map.shape[1]], motions, rows.lift, rows.joints),
    )  # fmt: skip
