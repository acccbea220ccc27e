"""How far given contact wrenches are inside their exact cones: the normal-force reserve of each contact."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from socp_statics.cones.choice import ConeChoice
from socp_statics.engines.engine import Engine
from socp_statics.engines.solution import SOLVED, Solution
from socp_statics.models.contact_forces_set import force_shape, force_values
from socp_statics.models.equilibrium import MODEL
from socp_statics.optimization.force_answer import settled
from socp_statics.optimization.force_rows import groups, wrench_rows
from socp_statics.spatial import Array
from socp_statics.statics import StaticsData, wrench_range

# In units of W, tried in turn: the tightest cap conditions the program best, a reserve above the last is not told from an infinite one.
CAPS = (1.0, 1e3)
OUT_OF_REACH = 1e-7


def contact_wrench_rows(data: StaticsData) -> Array:
    """Wrenches of all contacts about their positions in contact frames as rows over x, scaled, shape (6 k, nx)."""
    return np.vstack([wrench_rows(data, group, about_position=True) for group in groups(data, "contact")])


def wrench_reserve(data: StaticsData, wrenches_C: Array, cone: ConeChoice, form: str, engine: str | Sequence[str]) -> float:
    """Largest t for which forces with ``f - t n`` in every cone make the given wrenches, by the program of the margin.

    Bounds of normal forces shift with t as they do there; limits of joint torques are not asked, limits of handles are hard.

    Args:
        data: The stance's arrays.
        wrenches_C: ``[force; moment]`` of every contact in its frame, shape (k, 6) [N, N m].
        cone: Exact cones or pyramids.
        form: "socp" or "sdp".
        engine: "auto", the name of an engine, or several to be tried in turn.

    Returns:
        The reserve [N]: negative by how much the worst contact point lacks; -inf where no t will do, inf where nothing limits it.

    Raises:
        EngineError: No engine settled the program.
    """
    rows = contact_wrench_rows(data)
    wanted = (wrenches_C / data.units.wrench).ravel()
    reach = wrench_range(rows)
    if reach.outside(wanted) > OUT_OF_REACH * max(1.0, float(np.abs(wanted).max(initial=0.0))):
        return -np.inf
    given = replace(without_torque_limits(data), wrench_map=rows, load=-wanted)
    shape = force_shape(given, cone, form, reach.rank)
    values = force_values(given, cone, reach.basis)
    for cap in CAPS:

        def solve(one: Engine, cap: float = cap) -> Solution:
            return one.compile(MODEL, shape).solve(values | {"cap": np.array(cap)})

        solution, _ = settled(given, cone, engine, solve, "the reserve of given wrenches", form, check=False)
        if solution.status != SOLVED:
            return -np.inf
        t = float(solution.objective)
        if t < cap * (1 - 1e-6):
            return t * data.units.force
    return np.inf


def without_torque_limits(data: StaticsData) -> StaticsData:
    """The arrays without the rows of torque limits; those of handles stay."""
    n = data.handle_limits
    torques = data.torques._replace(limits=np.full_like(data.torques.limits, np.inf) * [-1.0, 1.0])
    rows, values, names = data.limit_rows[:n], data.limit_values[:n], data.limit_names[:n]
    return replace(data, limit_rows=rows, limit_values=values, limit_names=names, torques=torques)
