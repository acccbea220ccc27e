"""How far can a small motion of the posture raise a margin? The statics of a posture, linearised in the motion, exact in the forces.

    maximise    t - rho/2 |z|^2                     the margin; or  -s, the worst share of a torque limit; or  r, the CoM margin
    subject to  G x + L + A z = 0
                f_i - t n_i in K_i,  lo + t <= N_k <= hi - t,  handle limits
                H x + V z <= d                      torque limits;  for -s:  H x + V z <= d + (s - 1) u
                lower <= angles + Q z <= upper      joint limits
                |z| <= trust

For r, forces x_k and a displacement s_k of the CoM are asked for in each of some directions d_k: G x_k + L + D s_k + A_k z = 0 with
d_k . s_k >= r and the cones and limits of all x_k.

z are coordinates of the motions that keep the contacts in place. The unknown forces stay unknown: only products of motion and forces are
linearised, so that a friction cone keeps its apex, where no nonlinear program has a gradient. With A, V and Q zero its value is the
margin of the posture as it is; with trust one its gain bounds the residual of the conditions of optimality.
"""

from __future__ import annotations

from typing import NamedTuple

import cvxpy as cp

from socp_statics.models.contact_forces_set import ForceShape, admissible, declare_forces
from socp_statics.models.program import ConicModel, Program


class PostureStepShape(NamedTuple):
    """Structure: forces with their handle limits only, coordinates of the motion, torque rows, joint-limit rows, objective, directions."""

    forces: ForceShape
    coordinates: int
    torques: int
    joints: int
    objective: str
    directions: int = 0


def declare(shape: PostureStepShape) -> Program:
    """The program of one step."""
    s = shape
    forces = declare_forces(s.forces)
    z, t = cp.Variable(s.coordinates, name="z"), cp.Variable(name="t")
    G = cp.Parameter((s.forces.rows, s.forces.columns), name="G")
    moved = cp.Parameter((s.forces.rows, s.coordinates), name="A") @ z
    variables = {**forces.variables, "z": z, "t": t}
    if s.directions:
        variables["s"] = away = cp.Variable(2 * s.directions, name="s")
        moved = moved + cp.Parameter((s.forces.rows, 2 * s.directions), name="D") @ away
    constraints = {
        "balance": G @ forces.x + moved == -cp.Parameter(s.forces.rows, name="load"),
        **admissible(forces, reserve=t if s.objective == "margin" else 0.0),
        "trust": cp.SOC(cp.Parameter(name="trust"), z),
        "cap": t <= cp.Parameter(name="cap"),
    }
    if s.directions:
        constraints["reach"] = cp.Parameter((s.directions, 2 * s.directions), name="d") @ away >= t
    if s.joints:
        constraints["joints"] = cp.Parameter((s.joints, s.coordinates), name="Q") @ z <= cp.Parameter(s.joints, name="room")
    if s.torques:
        rows = cp.Parameter((s.torques, s.forces.columns), name="H_torque") @ forces.x
        rows = rows + cp.Parameter((s.torques, s.coordinates), name="V") @ z
        limit = cp.Parameter(s.torques, name="d_torque")
        if s.objective == "torque":
            # t = -s: the share that the limits are scaled by
            limit = limit - cp.multiply(cp.Parameter(s.torques, name="u_torque"), t + 1)
        constraints["torques"] = rows <= limit
    cost = t - 0.5 * cp.Parameter(name="rho", nonneg=True) * cp.sum_squares(z)
    return Program(cp.Problem(cp.Maximize(cost), list(constraints.values())), variables, constraints)


MODEL = ConicModel("posture_optimization", declare, only_steps=True)
