"""Orin and Oh's linear program: local power of the joints and the largest normal force, weighed against each other.

    minimise    sum_j p_j + b m
    subject to  G x + L = 0,  f_i in K_i,  bounds,  hard rows
                |rate_j (tau_0 - T x)_j| <= p_j
                f_n,i <= m

(Orin and Oh 1981; a linear program with pyramids, with exact cones here too.) Without a robot only the second term is left.
"""

from __future__ import annotations

from typing import NamedTuple

import cvxpy as cp

from socp_statics.models.contact_forces_set import ForceShape, admissible, declare_forces, load, wrench
from socp_statics.models.program import ConicModel, Program


class OrinOhShape(NamedTuple):
    """Structure of the program: forces, and the number of joints that count."""

    forces: ForceShape
    joints: int


def declare(shape: OrinOhShape) -> Program:
    """The program; rows P x + p0 are the local powers of the joints."""
    forces = declare_forces(shape.forces)
    m = cp.Variable(name="m")
    constraints = {"balance": wrench(forces) == -load(forces), **admissible(forces), "peak": m >= 0}
    variables = {**forces.variables, "m": m}
    cost = cp.Parameter(name="b", nonneg=True) * m
    if shape.forces.points:
        constraints["largest"] = forces.f_n <= m
    if shape.joints:
        variables["p"] = p = cp.Variable(shape.joints, name="p")
        power = cp.Parameter((shape.joints, shape.forces.columns), name="P") @ forces.x + cp.Parameter(shape.joints, name="p0")
        constraints["power"] = cp.hstack([power, -power]) <= cp.hstack([p, p])
        cost = cost + cp.sum(p)
    return Program(cp.Problem(cp.Minimize(cost), list(constraints.values())), variables, constraints)


MODEL = ConicModel("orin_oh", declare)
