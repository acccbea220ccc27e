"""Can balance and hard rows be met at all, whatever the cones? By how much do handle and torque limits fall short?

    minimise    e
    subject to  G x + L = 0
                |N_k - given| <= e     contacts whose bounds are equal
                H x <= d + e           handle limits, torque limits
                e >= -1

The margin program lets the cones give way but not these rows: it is infeasible exactly where e > 0, and the multipliers are then a motion
in which every contact holds and a handle or joint gives way.
"""

from __future__ import annotations

import cvxpy as cp

from socp_statics.models.contact_forces_set import ForceShape, declare_forces, hard_rows, load, wrench
from socp_statics.models.program import ConicModel, Program


def declare(shape: ForceShape) -> Program:
    """The least relaxation of the hard rows."""
    forces = declare_forces(shape)
    e = cp.Variable(name="e")
    constraints = {"balance": wrench(forces) == -load(forces), **hard_rows(forces, e), "floor": e >= -1}
    return Program(cp.Problem(cp.Minimize(e), list(constraints.values())), {"x": forces.x, "e": e}, constraints)


MODEL = ConicModel(
    name="hard_rows",
    summary="least relaxation with which balance, handle limits and torque limits can be met",
    mathematics="minimise e  subject to  G x + L = 0,  H x <= d + e",
    declare=declare,
)
