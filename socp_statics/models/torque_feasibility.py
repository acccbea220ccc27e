"""Can the motors hold the posture? The least share of its torque limits that the worst joint has to use.

    minimise    s
    subject to  G x + L = 0,  f_i in K_i,  bounds,  handle limits
                s lower <= tau_0 - T x <= s upper      limits that are finite and not zero
                tau_0 - T x <= 0  or  >= 0             limits that are zero: hard rows

The posture is feasible exactly where s <= 1.

Implements (3.78), corrected: in statics the torque of given forces is unique, tau = g_theta - J^T F, and the term tau^n of the printed
test must be zero, since it would accelerate the joints; the only freedom is in the forces.
"""

from __future__ import annotations

from typing import NamedTuple

import cvxpy as cp

from socp_statics.models.contact_forces_set import ForceShape, admissible, declare_forces, load, wrench
from socp_statics.models.program import ConicModel, Program


class TorqueShape(NamedTuple):
    """Structure of a torque test: forces (with handle limits and zero torque limits as hard rows) and number of shared limits."""

    forces: ForceShape
    shared: int


def declare(shape: TorqueShape) -> Program:
    """The torque test; rows U x <= s u - v are limits that are shared."""
    forces = declare_forces(shape.forces)
    s = cp.Variable(name="s")
    constraints = {"balance": wrench(forces) == -load(forces), **admissible(forces), "share": s >= 0}
    if shape.shared:
        rows = cp.Parameter((shape.shared, shape.forces.columns), name="U") @ forces.x
        limit = cp.Parameter(shape.shared, name="u", nonneg=True)
        constraints["torques"] = rows <= s * limit - cp.Parameter(shape.shared, name="v")
    return Program(cp.Problem(cp.Minimize(s), list(constraints.values())), {**forces.variables, "s": s}, constraints)


MODEL = ConicModel("torque_feasibility", declare)
