"""Is any horizontal CoM position in balance, and with what reserve? The margin program with a free centre of mass.

    maximise    t
    subject to  G x + L + D s = 0
                f_i - t n_i in K_i,  lo + t <= N_k <= hi - t,  H x <= d,  t <= cap

Unlike a support direction it has an interior even where the region is about to vanish.
"""

from __future__ import annotations

import cvxpy as cp

from socp_statics.models.contact_forces_set import admissible, declare_forces, load, wrench
from socp_statics.models.program import ConicModel, Program
from socp_statics.models.support_region import RegionShape


def declare(shape: RegionShape) -> Program:
    """The largest reserve over the plane."""
    forces = declare_forces(shape.forces)
    s, t = cp.Variable(shape.coordinates, name="s"), cp.Variable(name="t")
    D = cp.Parameter((shape.forces.rows, shape.coordinates), name="D")
    constraints = {
        "balance": wrench(forces) + D @ s == -load(forces),
        **admissible(forces, reserve=t),
        "cap": t <= cp.Parameter(name="cap"),
    }
    return Program(cp.Problem(cp.Maximize(t), list(constraints.values())), {**forces.variables, "s": s, "t": t}, constraints)


MODEL = ConicModel("largest_reserve", declare)
