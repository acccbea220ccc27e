"""How large a disturbance of the load can be balanced in one direction? One supporting plane of the disturbances that can.

    maximise    d' z
    subject to  G x + B z + L = 0
                f_i in K_i,  bounds
                H x <= d + R z               handle limits; torque limits, where the disturbance acts on the robot's joints too
                sum_k |F_k| <= total         only where contacts may be misplaced; F_k the force of contact k
                |z| <= clip

z are coordinates of a disturbance: a push, an error of the centre of mass, a change of gravity; B their wrenches. The disturbances that
can be balanced are a convex set; each program gives a point of it, with forces, and a half-space that holds all of it, with a motion.
The clip keeps sets without end bounded, far from where anything is read off them.
"""

from __future__ import annotations

from typing import NamedTuple

import cvxpy as cp

from socp_statics.models.contact_forces_set import ForceShape, admissible, declare_forces, load, wrench
from socp_statics.models.program import ConicModel, Program


class DisturbanceShape(NamedTuple):
    """Structure of the program: forces, coordinates of the disturbance, and contacts whose forces are limited in sum (0: none)."""

    forces: ForceShape
    coordinates: int
    contacts: int


def declare(shape: DisturbanceShape) -> Program:
    """The support program of the disturbances."""
    forces = declare_forces(shape.forces)
    z = cp.Variable(shape.coordinates, name="z")
    direction = cp.Parameter(shape.coordinates, name="direction")
    B = cp.Parameter((shape.forces.rows, shape.coordinates), name="B")
    relief = cp.Parameter((shape.forces.limits, shape.coordinates), name="R") @ z if shape.forces.limits else 0.0
    constraints = {
        "balance": wrench(forces) + B @ z == -load(forces),
        **admissible(forces, relief=relief),
        "clip": cp.SOC(cp.Parameter(name="clip"), z),
    }
    variables = {**forces.variables, "z": z}
    if shape.contacts:
        s = cp.Variable(shape.contacts, name="s")
        F = cp.Parameter((3 * shape.contacts, shape.forces.columns), name="F_contact") @ forces.x
        constraints["resultant"] = cp.SOC(s, cp.reshape(F, (3, shape.contacts), order="F"), axis=0)
        constraints["total"] = cp.sum(s) <= cp.Parameter(name="total")
        variables["s"] = s
    return Program(cp.Problem(cp.Maximize(direction @ z), list(constraints.values())), variables, constraints)


MODEL = ConicModel("disturbance", declare)
