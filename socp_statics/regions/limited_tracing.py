"""Regions of stances that more than friction limits, by the kernel's compiled tracer of general programs."""

from __future__ import annotations

import math
from functools import cache
from typing import Any

import numpy as np

from socp_statics.cones.choice import ConeChoice
from socp_statics.regions.com_margin import on_edge_or
from socp_statics.regions.question import RegionQuestion
from socp_statics.regions.support_region import SupportRegion
from socp_statics.regions.witnesses import LimitedWitnesses
from socp_statics.statics import assemble


@cache
def _kernel() -> tuple[Any, ...]:
    """The compiled tracer and what goes with it, imported when it is first used."""
    from socp_statics.engines.kernel import conic
    from socp_statics.engines.kernel.plan_tracing import trace_plan
    from socp_statics.engines.kernel.refinement import POLYGON, most_directions
    from socp_statics.engines.kernel.side_by_side import load_side_by_side
    from socp_statics.engines.kernel.support_rows import point_rows, support_rows

    load_side_by_side((trace_plan, conic.prepare, conic.solve))
    return conic, trace_plan, point_rows, support_rows, most_directions, POLYGON


def trace_limited(question: RegionQuestion, cone: ConeChoice, tolerance: float) -> SupportRegion | None:
    """The region of a stance with limits, bounds, handles or soft fingers.

    Args:
        question: What is asked.
        cone: Exact cones or pyramids.
        tolerance: Of (outer area - inner area) / outer area.

    Returns:
        The region; None where the compiled tracer leaves it to the others: no polygon, or not settled.
    """
    conic, trace_plan, point_rows, support_rows, most_directions, polygon = _kernel()
    stance = question.stance()
    if stance.torque_limits is not None and stance.contacts.friction_points is not None:
        rows = point_rows(stance, question.load(), cone)
    elif any(contact.unilateral for contact in stance.contacts):
        rows = support_rows(assemble(stance), cone)
    else:
        return None
    n = rows.A.shape[1]
    W, F = conic.prepare(np.zeros(n), rows.A, rows.start, rows.column, rows.value, rows.orthant, rows.soc)
    x, y = stance.com[:2].tolist() if question.with_com else (math.nan, math.nan)
    counts, numbers, inner, forces, outer, motions = trace_plan(
        conic.solve.address(), W, F, rows.A, rows.start, rows.column, rows.value, rows.orthant, rows.soc, rows.b, rows.h,
        rows.wrench_map, rows.position, rows.origin, rows.size, x, y, tolerance, most_directions(tolerance),
    )  # fmt: skip
    kind, solves = counts.tolist()
    if kind != polygon:
        return None
    gap, margin, inner_area, outer_area = numbers.tolist()
    com_margin = on_edge_or(margin, rows.size) if question.with_com else None
    witnesses = LimitedWitnesses(stance, forces[:, : rows.wrench_map.shape[1]], motions, rows.lift, rows.joints)
    return SupportRegion.polygon(
        inner, outer, motions[:, -3:], witnesses, cone, gap, solves, com_margin, rows.size, inner_area, outer_area, len(rows.joints) > 0
    )
