"""How far can the centre of mass go in one direction? One supporting line of the support region.

    maximise    d' s
    subject to  G x + L + D s = 0
                f_i in K_i,  bounds,  hard rows
                |s| <= box                   only for regions without end

s are coordinates of the centre of mass in the horizontal plane (one or two, as many as the range of G leaves free).
Bretl and Lall 2008 trace the region from such programs; the multipliers of the balance certify the supporting line.
"""

from __future__ import annotations

from typing import NamedTuple

import cvxpy as cp

from socp_statics.models.contact_forces_set import ForceShape, admissible, declare_forces, load, wrench
from socp_statics.models.program import ConicModel, Program


class RegionShape(NamedTuple):
    """Structure of a support direction: forces, free coordinates of the centre of mass, and whether a box clips them."""

    forces: ForceShape
    coordinates: int
    clipped: bool


def declare(shape: RegionShape) -> Program:
    """The support direction program."""
    forces = declare_forces(shape.forces)
    s = cp.Variable(shape.coordinates, name="s")
    direction = cp.Parameter(shape.coordinates, name="direction")
    D = cp.Parameter((shape.forces.rows, shape.coordinates), name="D")
    constraints = {"balance": wrench(forces) + D @ s == -load(forces), **admissible(forces)}
    if shape.clipped:
        box = cp.Parameter(shape.coordinates, name="box", nonneg=True)
        constraints["clip"] = cp.hstack([s, -s]) <= cp.hstack([box, box])
    return Program(cp.Problem(cp.Maximize(direction @ s), list(constraints.values())), {**forces.variables, "s": s}, constraints)


MODEL = ConicModel("support_region", declare)
