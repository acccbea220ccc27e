"""How much can be carried, how hard can be pushed? The largest multiple of a load that contacts and motors allow.

    maximise    w
    subject to  G x + w P + L = 0
                f_i in K_i,  bounds
                H x <= d + w r               handle limits; torque limits with r = -+J_P' of the unit load
                0 <= w <= cap                the cap only in the program of directions without end

P is the wrench of a unit of the load about the origin. The multipliers of the balance are the motion that nothing can prevent beyond
the largest load.
"""

from __future__ import annotations

from typing import NamedTuple

import cvxpy as cp

from socp_statics.models.contact_forces_set import ForceShape, admissible, declare_forces, load, wrench
from socp_statics.models.program import ConicModel, Program


class CapabilityShape(NamedTuple):
    """Structure of the program: forces, and whether the load has a cap."""

    forces: ForceShape
    capped: bool


def declare(shape: CapabilityShape) -> Program:
    """The largest load program."""
    forces = declare_forces(shape.forces)
    w = cp.Variable(name="w")
    relief = cp.Parameter(shape.forces.limits, name="r") * w if shape.forces.limits else 0.0
    P = cp.Parameter(shape.forces.rows, name="P")
    constraints = {"balance": wrench(forces) + P * w == -load(forces), **admissible(forces, relief=relief), "load": w >= 0}
    if shape.capped:
        constraints["cap"] = w <= cp.Parameter(name="cap")
    return Program(cp.Problem(cp.Maximize(w), list(constraints.values())), {**forces.variables, "w": w}, constraints)


MODEL = ConicModel("capability", declare)
