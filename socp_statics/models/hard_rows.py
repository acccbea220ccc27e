"""Can balance and hard rows be met at all, whatever the cones? By how much do handle and torque limits fall short?

    minimise    e
    subject to  G x + L = 0
                |N_k - given| <= e     contacts whose bounds are equal
                H x <= d + e           handle limits, torque limits
                e >= -1

The margin program lets the cones give way but not these rows: it is infeasible exactly where e > 0, and the multipliers are then a motion
in which every contact holds and a handle or joint gives way. Only what the rows see of x counts, ``x = Q z`` with Q an orthonormal
basis of their row space: forces that no row sees would leave the solver without a scale.
"""

from __future__ import annotations

from typing import NamedTuple

import cvxpy as cp
import numpy as np

from socp_statics.models.contact_forces_set import bound_rows
from socp_statics.models.program import ConicModel, Program
from socp_statics.spatial import Array
from socp_statics.statics.statics_data import StaticsData

UNSEEN = 1e-9


class HardShape(NamedTuple):
    """Structure of the program: balance rows, components of x that the rows see, limits, and equal bounds."""

    rows: int
    columns: int
    limits: int
    equal: int


def hard_values(
    data: StaticsData, basis: Array, load: Array | None = None, free: Array | None = None
) -> tuple[HardShape, dict[str, Array]]:
    """Structure and numbers of the program of a stance.

    Args:
        data: The stance's arrays.
        basis: Basis of the balance rows kept, shape (6, rows).
        load: The load instead of the stance's own, shape (6,).
        free: Wrenches of further unknowns that no hard row sees, such as coordinates of the centre of mass, shape (6, k).

    Returns:
        The shape, and values by parameter name.
    """
    bounds = bound_rows(data)
    more = np.zeros((6, 0)) if free is None else free
    G = basis.T @ np.hstack([data.wrench_map, more])
    H = np.hstack([data.limit_rows, np.zeros((len(data.limit_rows), more.shape[1]))])
    N = np.zeros((len(bounds.equal), G.shape[1]))
    N[:, data.normal] = bounds.equal
    _, s, Vt = np.linalg.svd(np.vstack([G, H, N]), full_matrices=False)
    Q = Vt[s > UNSEEN].T
    values = {
        "G": G @ Q,
        "load": basis.T @ (data.load if load is None else load),
        "H": H @ Q,
        "limit": data.limit_values,
        "N": N @ Q,
        "given": bounds.equal_values,
    }
    return HardShape(len(G), Q.shape[1], len(H), len(N)), values


def declare(shape: HardShape) -> Program:
    """The least relaxation of the hard rows."""
    z, e = cp.Variable(shape.columns, name="z"), cp.Variable(name="e")
    load = cp.Parameter(shape.rows, name="load")
    constraints = {"balance": cp.Parameter((shape.rows, shape.columns), name="G") @ z == -load, "floor": e >= -1}
    if shape.limits:
        H = cp.Parameter((shape.limits, shape.columns), name="H")
        constraints["limits"] = H @ z <= cp.Parameter(shape.limits, name="limit") + e
    if shape.equal:
        off = cp.Parameter((shape.equal, shape.columns), name="N") @ z - cp.Parameter(shape.equal, name="given")
        constraints["equal_bound"] = cp.hstack([off, -off]) <= e
    return Program(cp.Problem(cp.Minimize(e), list(constraints.values())), {"z": z, "e": e}, constraints)


MODEL = ConicModel("hard_rows", declare)
