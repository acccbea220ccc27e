"""Which constraint stops a stance? The prices of its margin, or of what its hard rows fall short of."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from socp_statics.certificates.optimum import Multipliers, Optimum
from socp_statics.certificates.prices import Prices, Scale, prices_of
from socp_statics.cones.choice import ConeChoice
from socp_statics.engines.solution import Solution
from socp_statics.spatial import Array
from socp_statics.statics.statics_data import StaticsData

COUNTS = 1e-6


def margin_optimum(data: StaticsData, cone: ConeChoice, x: Array, reserve: float, multipliers: Multipliers) -> Optimum:
    """The optimum of the margin program: its further unknown is the reserve itself.

    Args:
        data: The stance's arrays.
        cone: Exact cones or pyramids.
        x: Optimal forces, scaled.
        reserve: The margin, scaled.
        multipliers: Optimal multipliers.
    """
    none = np.zeros((len(data.limit_values), 1))
    return Optimum(data, cone, x, reserve, multipliers, np.zeros((6, 1)), np.ones(1), none, reserve)


def shortfall_optimum(
    data: StaticsData, cone: ConeChoice, basis: Array, values: Mapping[str, Array], solution: Solution
) -> Optimum | None:
    """The optimum of the program `models.hard_rows`: its further unknown is by how much every limit has to give way.

    Args:
        data: The stance's arrays.
        cone: Exact cones or pyramids.
        basis: Basis of the balance rows kept, shape (6, r).
        values: Numbers of the program.
        solution: Its solution.

    Returns:
        The optimum; None where a fixed normal force is among the rows: it gives way in newtons both ways, which no limit does.
    """
    if "equal_bound" in solution.duals:
        return None
    z, e = solution.variables["z"], float(solution.objective)
    rows = np.vstack([basis.T @ data.wrench_map, data.limit_rows])
    x = np.linalg.lstsq(rows, np.concatenate([values["G"] @ z, values["H"] @ z]), rcond=None)[0]
    multipliers = Multipliers.read(data, basis @ solution.duals["balance"], solution.duals)
    ones = np.ones((len(data.limit_values), 1))
    return Optimum(data, cone, x, 0.0, multipliers, np.zeros((6, 1)), np.zeros(1), ones, e, coned=False)


def optimum_prices(optimum: Optimum) -> Prices | None:
    """What an optimum of this room gains per unit of friction, bound, limit and contact displacement.

    With a robot, a displaced contact moves on its link, joints and centre of mass stay where they are.

    Args:
        optimum: Of `margin_optimum` or `shortfall_optimum`.

    Returns:
        The prices of the margin [N]; or of the shortfall of limits, in N m or N, None where limits of both units stop it.
    """
    data, W = optimum.data, optimum.data.units.force
    if optimum.coned:
        return prices_of(optimum, Scale("margin", "N", W))
    counts = optimum.multipliers.limits > COUNTS
    handles = counts[: data.handle_limits]
    limited = [data.component_of_handle[row[data.handle] != 0.0][0] for row in data.limit_rows[: data.handle_limits]]
    forces = np.array(limited, dtype=int) < 3
    moments = counts[data.handle_limits :].any() or (handles & ~forces).any()
    if moments and (handles & forces).any():
        return None
    return prices_of(optimum, Scale("shortfall", "N m", W * data.units.length) if moments else Scale("shortfall", "N", W))
