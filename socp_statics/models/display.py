"""A model's program in readable mathematics, with the sizes it has for a stance."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from socp_statics.cones.choice import ConeChoice
from socp_statics.contacts import Stance
from socp_statics.models.contact_forces_set import ForceShape, force_shape
from socp_statics.spatial import Array
from socp_statics.statics import StaticsData, assemble, wrench_range

QUESTIONS = {
    "equilibrium": ("maximise", "t", "the normal-force reserve of every contact point"),
    "keyframes": ("maximise", "t", "the normal-force reserve of every contact point, of every contact state and along the ways between"),
    "support_region": ("maximise", "d' c", "one program for each direction d of the plane; c is the horizontal CoM position"),
    "following_region": ("maximise", "t", "the reserve of each posture on the way; shown: the seed, whose contacts stay"),
    "minimax_wrench": ("minimise", "s", "the largest measure"),
    "capability": ("maximise", "w", "the load: a payload (its weight) or a push"),
    "torque_feasibility": ("minimise", "s", "the worst share of a torque limit; feasible exactly where s <= 1"),
    "wrench_distribution": ("minimise", "sum_k |F_k|^2_W", "closed forms ignore the cones; programs keep them"),
    "internal_force_window": ("maximise", "d' s", "one program for each direction d; s are the internal forces"),
    "robustness": ("maximise", "d' z", "one program for each direction d of disturbances z of the load, between an inner and an outer set"),
    "posture_optimization": ("maximise", "t", "the margin over forces and postures; here at the given posture, then step by step"),
}
OBJECTIVES = {
    "least_squares": ("sum_i |f_i|^2", "points and handles"),
    "normal_force": ("sum_i f_n,i", "all contact points"),
    "reference": ("sum_k |F_k - F_ref,k|^2", "contacts with a reference"),
    "orin_oh": ("sum_j |tau_j rate_j| + b max_i f_n,i", "joints and contact points"),
}
LOADS = {
    "payload": "P is the wrench of a unit force along gravity where the payload hangs",
    "push": "P is the wrench of a unit force along the push",
}
MEASURES = {
    "normal": "N_g <= s",
    "force": "|F_g| <= s",
    "tangential": "|F_t,g| <= s",
    "component": "-s <= components of the wrench of g (moments over length) <= s",
    "friction_use": "|F_t,g| <= s mu_g N_g",
}


def describe(model: str, stance: Stance, parameters: Mapping[str, Any]) -> str:
    """The program that will be solved.

    Args:
        model: Name of the model.
        stance: The stance it is asked about.
        parameters: The model's parameters with defaults filled in.

    Returns:
        Several lines of text.
    """
    cone = ConeChoice(parameters["cone"], parameters.get("sides"), parameters.get("heading"))
    data = assemble(stance)
    reach = wrench_range(data.wrench_map)
    shape = force_shape(data, cone, parameters["form"], reach.rank)
    verb, objective, meaning = _question(model, parameters)
    moving = model == "posture_optimization"
    easing = moving and parameters["objective"] == "torque"
    reserve = model in ("equilibrium", "keyframes", "following_region") or (moving and not easing)
    rows = [_balance(model, shape, data), *_cone_rows(shape, data, cone, reserve), *_other_rows(shape, data, reserve)]
    if data.torques.limited:
        share = "s " if model == "torque_feasibility" or easing else ""
        joints = int(np.isfinite(data.torques.limits).any(axis=1).sum())
        pushed = " - w J_P' d" if model == "capability" else ""
        rows.append((f"{share}lower_j <= tau_j = (g_theta - J' F{pushed})_j <= {share}upper_j", f"{joints} joints with torque limits"))
    if model == "capability":
        rows.append(("w >= 0", LOADS["payload" if "payload" in parameters else "push"]))
    if model == "minimax_wrench":
        rows.append((MEASURES[parameters["measure"]], f"every {parameters['level']} g"))
    if model == "internal_force_window":
        rows.append(_internal(parameters))
    if moving:
        rows.append(("contacts(q) = given, lower <= theta <= upper", _movable(stance, parameters)))
    if parameters.get("simple_test"):
        rows.append(("also F = C^-W G_C", "the simple test: two generalised inverses, checked against the contacts' wrench cones"))
    width = max(len(left) for left, _ in [(objective, ""), *rows]) + 3
    lines = [f"{verb:<12}{objective:<{width}}{meaning}"]
    for i, (left, right) in enumerate(rows):
        lines.append(f"{'subject to' if i == 0 else '':<12}{left:<{width}}{right}")
    units = data.units
    lines += [
        "",
        f"unknowns    x = (f_t, f_n, m_n, h) in contact frames: {2 * shape.slipping} tangential forces, {shape.points} normal forces, "
        f"{shape.box + shape.elliptic} torsional moments, {shape.handle} handle components",
        f"units       force {units.force:.6g} N, length {units.length:.6g} m, moments about "
        f"[{', '.join(f'{v:.6g}' for v in _without_dust(units.origin, units.length))}] m; rank of G {reach.rank} of 6",
    ]
    return "\n".join(lines)


def _without_dust(position: Array, length: float) -> Array:
    """A position with coordinates that are rounding errors of this length, or of the position's distance, replaced by zero."""
    return np.where(np.abs(position) > 1e-13 * (length + np.linalg.norm(position)), position, 0.0)


def _question(model: str, parameters: Mapping[str, Any]) -> tuple[str, str, str]:
    if model == "posture_optimization" and parameters["objective"] == "torque":
        return ("minimise", "s", "the worst share of a torque limit, over forces and postures")
    if model != "contact_forces":
        return QUESTIONS[model]
    objective, meaning = OBJECTIVES[parameters["objective"]]
    return "minimise", objective, meaning


def _internal(parameters: Mapping[str, Any]) -> tuple[str, str]:
    count = len(parameters["directions"])
    if parameters["others"] == "fixed":
        return "F(x) = F_0 + sum_i s_i D_i", f"{count} directions of internal force beside F_0 of {parameters['particular']}"
    return "s = D+ (F(x) - F_0)", f"{count} directions of internal force, all others free; F_0 of {parameters['particular']}"


def _movable(stance: Stance, parameters: Mapping[str, Any]) -> str:
    joints = len(stance.posture.robot.joints)
    sliding = f"; free to slide in their planes: {', '.join(parameters['slide'])}" if parameters["slide"] else ""
    return f"base and {joints} joints{sliding}"


def _balance(model: str, shape: ForceShape, data: StaticsData) -> tuple[str, str]:
    load = {"support_region": "L + D c", "capability": "w P + L", "robustness": "L + B z"}.get(model, "L")
    dropped = f", {6 - shape.rows} that no contact force reaches left out" if shape.rows < 6 else ""
    return f"G x + {load} = 0", f"{shape.rows} balance rows{dropped}"


def _cone_rows(shape: ForceShape, data: StaticsData, cone: ConeChoice, reserve: bool) -> list[tuple[str, str]]:
    t = " - t" if reserve else ""
    left = "(f_n,i - t)" if reserve else "f_n,i"
    mu = f"mu {_range(data.friction)}" if len(data.friction) else ""
    rows = []
    if shape.circular:
        if shape.sides:
            m = "mu cos(pi/sides)" if shape.inscribed else "mu"
            rows.append((f"n_j . f_t,i <= {m} {left}", f"{shape.circular} {cone.kind} pyramids of {shape.sides} sides, {mu}"))
        elif shape.form == "sdp":
            rows.append((f"[[r_i + f_x, f_y], [f_y, r_i - f_x]] >= 0, r_i = mu_i {left}", f"{shape.circular} matrices, 2 x 2, {mu}"))
        else:
            rows.append((f"|f_t,i| <= mu_i {left}", f"{shape.circular} second-order cones of dimension 3, {mu}"))
    if shape.box:
        rows.append((f"|m_n,i| <= gamma_i {left}", f"{shape.box} soft fingers (box)"))
    if shape.elliptic:
        rows.append((f"|(f_t,i, (mu_i/gamma_i) m_n,i)| <= mu_i {left}", f"{shape.elliptic} soft fingers (elliptic)"))
    if shape.frictionless:
        rows.append((f"f_n,i{t} >= 0", f"{shape.frictionless} frictionless points"))
    return rows


def _other_rows(shape: ForceShape, data: StaticsData, reserve: bool) -> list[tuple[str, str]]:
    rows = []
    if shape.lower or shape.upper:
        lower, upper = ("lo + t", "hi - t") if reserve else ("lo", "hi")
        rows.append((f"{lower} <= N_k <= {upper}", f"{shape.lower} lower and {shape.upper} upper bounds"))
    if shape.equal:
        rows.append(("N_k = given", f"{shape.equal} contacts"))
    if data.handle_limits:
        rows.append(("H x <= d", f"{data.handle_limits} handle limits"))
    return rows


def _range(values: np.ndarray) -> str:
    low, high = float(values.min()), float(values.max())
    return f"{low:g}" if low == high else f"{low:g} to {high:g}"
