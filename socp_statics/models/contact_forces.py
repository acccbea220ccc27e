"""Which contact forces are best? Force optimisation with exact cones.

    minimise    sum_i |f_i|^2            objective "least_squares"
                sum_i f_n,i              objective "normal_force"
                sum_k |F_k - F_ref,k|^2  objective "reference"
    subject to  G x + L = 0,  f_i in K_i,  bounds,  hard rows

F_k are resultant forces of the contacts that have a reference. (3.79)-(3.80) are this program's standard form.
"""

from __future__ import annotations

from typing import NamedTuple

import cvxpy as cp

from socp_statics.models.contact_forces_set import ForceShape, admissible, declare_forces, load, wrench
from socp_statics.models.program import ConicModel, Program


class ContactForcesShape(NamedTuple):
    """Structure of a force optimisation: forces, objective, and number of force components in the objective."""

    forces: ForceShape
    objective: str
    components: int


def declare(shape: ContactForcesShape) -> Program:
    """The force optimisation program."""
    forces = declare_forces(shape.forces)
    constraints = {"balance": wrench(forces) == -load(forces), **admissible(forces)}
    variables = forces.variables
    if shape.objective == "normal_force":
        cost = cp.sum(forces.f_n) if shape.forces.points else cp.Constant(0.0)
    else:
        variables["e"] = e = cp.Variable(shape.components, name="e")
        F = cp.Parameter((shape.components, shape.forces.columns), name="F")
        constraints["objective"] = e == F @ forces.x - cp.Parameter(shape.components, name="reference")
        cost = cp.sum_squares(e)
    return Program(cp.Problem(cp.Minimize(cost), list(constraints.values())), variables, constraints)


MODEL = ConicModel("contact_forces", declare)
