"""Can a contact be loaded at all, wherever the centre of mass is moved horizontally?

    maximise    N = c' x
    subject to  G x + L + D s = 0,  f_i in K_i,  bounds,  hard rows,  N <= cap

A contact whose largest N is zero is idle: no balance ever loads it, and it cannot lose normal force that it never has. The
multipliers of the balance are then a motion that opens the contact without work of the load.
"""

from __future__ import annotations

import cvxpy as cp

from socp_statics.models.contact_forces_set import admissible, declare_forces, load, wrench
from socp_statics.models.program import ConicModel, Program
from socp_statics.models.support_region import RegionShape


def declare(shape: RegionShape) -> Program:
    """The largest normal force of one contact."""
    forces = declare_forces(shape.forces)
    s = cp.Variable(shape.coordinates, name="s")
    D = cp.Parameter((shape.forces.rows, shape.coordinates), name="D")
    normal = cp.Parameter(shape.forces.columns, name="c") @ forces.x
    constraints = {
        "balance": wrench(forces) + D @ s == -load(forces),
        **admissible(forces),
        "cap": normal <= cp.Parameter(name="cap"),
    }
    return Program(cp.Problem(cp.Maximize(normal), list(constraints.values())), {**forces.variables, "s": s}, constraints)


MODEL = ConicModel("contact_load", declare)
