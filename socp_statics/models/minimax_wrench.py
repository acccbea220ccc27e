"""How small can the largest contact load be? Minimax contact wrench (Boyd and Wegbreit's objective and its kin).

    minimise    s
    subject to  G x + L = 0,  f_i in K_i,  bounds,  hard rows
                N_g <= s                      measure "normal"
                |F_g| <= s                    measure "force"
                |F_t,g| <= s                  measure "tangential"
                -s <= every component <= s    measure "component"

g runs over contact points or over contacts (level). Measure "friction_use", |F_t| <= s mu N, is not convex in forces and s
together: s is given instead, and the reserve of the set tells by its sign whether s is large enough.

    maximise    t
    subject to  G x + L = 0,  f_i - t n_i in K_i,  bounds,  hard rows,  |F_t,g| <= s mu_g (N_g - n_g t),  t <= cap

n_g counts the points of a group.
"""

from __future__ import annotations

from typing import NamedTuple

import cvxpy as cp
import numpy as np

from socp_statics.models.contact_forces_set import (
    Forces,
    ForceShape,
    admissible,
    arrow_matrix,
    declare_forces,
    disc_matrix,
    load,
    wrench,
)
from socp_statics.models.program import ConicModel, Program


class MinimaxShape(NamedTuple):
    """Structure of a minimax program: forces, measure and number of groups."""

    forces: ForceShape
    measure: str
    groups: int


def declare(shape: MinimaxShape) -> Program:
    """The minimax program, or the reserve under a given use of friction."""
    forces = declare_forces(shape.forces)
    balance = {"balance": wrench(forces) == -load(forces)}
    if shape.measure == "friction_use":
        t = cp.Variable(name="t")
        limit = {"cap": t <= cp.Parameter(name="cap")}
        constraints = {**balance, **admissible(forces, reserve=t), **_friction_use(forces, shape, t), **limit}
        return Program(cp.Problem(cp.Maximize(t), list(constraints.values())), {**forces.variables, "t": t}, constraints)
    s = cp.Variable(name="s")
    constraints = {**balance, **admissible(forces), **_ceiling(forces, shape, s)}
    return Program(cp.Problem(cp.Minimize(s), list(constraints.values())), {**forces.variables, "s": s}, constraints)


def _measured(forces: Forces, shape: MinimaxShape, size: int) -> cp.Expression:
    """The measured vectors, one column a group; rows F are stacked group by group."""
    value = cp.Parameter((size * shape.groups, shape.forces.columns), name="F") @ forces.x
    return cp.reshape(value, (size, shape.groups), order="F")


def _below(form: str, radius: cp.Expression, value: cp.Expression) -> dict[str, cp.Constraint]:
    """Norms of the columns below their radii."""
    if form == "sdp":
        matrix = disc_matrix if value.shape[0] == 2 else arrow_matrix
        return {f"largest[{g}]": matrix(radius[g], value[:, g]) >> 0 for g in range(value.shape[1])}
    return {"largest": cp.SOC(radius, value, axis=0)}


def _ceiling(forces: Forces, shape: MinimaxShape, s: cp.Variable) -> dict[str, cp.Constraint]:
    """The measured quantity of every group below s."""
    if shape.measure == "component":
        value = _measured(forces, shape, 1)[0]
        return {"largest": cp.hstack([value, -value]) <= s}
    if shape.measure == "normal":
        return {"largest": _measured(forces, shape, 1)[0] <= s}
    value = _measured(forces, shape, 3 if shape.measure == "force" else 2)
    return _below(shape.forces.form, s * np.ones(shape.groups), value)


def _friction_use(forces: Forces, shape: MinimaxShape, t: cp.Variable) -> dict[str, cp.Constraint]:
    """Tangential forces below a given share of mu times the normal force, in reserve."""
    used = cp.Parameter((shape.groups, shape.forces.columns), name="s_mu_N") @ forces.x
    radius = used - cp.Parameter(shape.groups, name="s_mu_n") * t
    return _below(shape.forces.form, radius, _measured(forces, shape, 2))


MODEL = ConicModel("minimax_wrench", declare)
