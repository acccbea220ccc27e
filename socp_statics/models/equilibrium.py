"""Is the posture stable, and by how much? The normal-force reserve of all contact points.

    maximise    t
    subject to  G x + L = 0
                f_i - t n_i in K_i          every unilateral point
                lo + t <= N_k <= hi - t     bounded contacts
                H x <= d                    hard rows
                t <= cap

The multipliers of the balance are the motion that no admissible force can prevent where t < 0. The cap keeps the program
bounded where an internal force could grow without end.
"""

from __future__ import annotations

import cvxpy as cp

from socp_statics.models.contact_forces_set import ForceShape, admissible, declare_forces, load, wrench
from socp_statics.models.program import ConicModel, Program


def declare(shape: ForceShape) -> Program:
    """The margin program."""
    forces = declare_forces(shape)
    t = cp.Variable(name="t")
    constraints = {
        "balance": wrench(forces) == -load(forces),
        **admissible(forces, reserve=t),
        "cap": t <= cp.Parameter(name="cap"),
    }
    return Program(cp.Problem(cp.Maximize(t), list(constraints.values())), {**forces.variables, "t": t}, constraints)


MODEL = ConicModel("equilibrium", declare)
