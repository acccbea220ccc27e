"""Force optimisation: the best contact forces of a stance (3.7.2)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from socp_statics.cones.choice import ConeChoice, cone_choice
from socp_statics.contacts.numbers import vector
from socp_statics.contacts.stance import stance_of
from socp_statics.engines.engine import Engine
from socp_statics.engines.solution import SOLVED, Solution
from socp_statics.exceptions import InputError
from socp_statics.models.contact_forces import MODEL, ContactForcesShape
from socp_statics.models.contact_forces_set import force_shape, force_values
from socp_statics.optimization.force_answer import ForceAnswer, answer_of, infeasible, settled
from socp_statics.optimization.force_rows import force_rows, groups
from socp_statics.optimization.torque_use import minimise_power_and_peak
from socp_statics.spatial import Array
from socp_statics.stability import check_equilibrium
from socp_statics.statics import StaticsData, assemble, wrench_range

OBJECTIVES = ("least_squares", "normal_force", "reference", "orin_oh")


def optimise_contact_forces(
    stance: Any,
    objective: str = "least_squares",
    *,
    reference_forces: Mapping[str, Any] | None = None,
    rates: Mapping[str, float] | None = None,
    b: float | None = None,
    cone: str | ConeChoice = "exact",
    sides: int | None = None,
    heading: float | None = None,
    form: str = "socp",
    engine: str | Sequence[str] = "auto",
    torque_limits: bool | Mapping[str, Any] = False,
) -> ForceAnswer:
    """Balancing contact forces that minimise an objective, with exact cones or pyramids.

    Args:
        stance: A Stance or a Posture.
        objective: "least_squares", sum of |f_i|^2 over points and handles [N^2]; "normal_force", sum of the normal forces [N];
            "reference", sum of |F_k - F_ref,k|^2 over the contacts named in ``reference_forces`` [N^2]; "orin_oh", sum of
            |tau_i rate_i| over the joints plus b times the largest normal force [W].
        reference_forces: Resultant contact forces in world axes by contact, shape (3,) each [N].
        rates: Of "orin_oh": joint to rate, joints left out count nothing; by default 1 rad/s on every joint.
        b: Of "orin_oh": weight of the largest normal force, by default 1 [m/s].
        cone: "exact", "inscribed" or "circumscribed", or a ConeChoice.
        sides: Sides of the pyramids.
        heading: Heading of the pyramids [rad].
        form: "socp" or "sdp".
        engine: "auto", the name of an engine, or several to be tried in turn.
        torque_limits: Whether forces have to respect joint-torque limits: the robot's own, or a mapping of limits.

    Returns:
        The forces; status "infeasible" with the motion behind it where nothing balances.

    Raises:
        InputError: Unknown objective or contact, or references that do not fit.
        EngineError: No engine settled the program.
    """
    if objective not in OBJECTIVES:
        raise InputError(f"objective must be one of {', '.join(OBJECTIVES)}, got {objective!r}", name="objective", field="objective")
    if (objective == "reference") != bool(reference_forces):
        raise InputError("reference_forces must be given for the objective 'reference' and for no other", field="reference_forces")
    if objective != "orin_oh" and (rates is not None or b is not None):
        raise InputError("rates and b go with the objective 'orin_oh' only", name="rates", field="rates" if rates is not None else "b")
    choice = cone_choice(cone, sides, heading)
    stance = stance_of(stance, torque_limits=torque_limits)
    if objective == "orin_oh":
        return minimise_power_and_peak(stance, rates, 1.0 if b is None else b, cone=choice, form=form, engine=engine)
    data = assemble(stance)
    F, reference = measured_forces(data, objective, reference_forces or {})
    equilibrium = check_equilibrium(stance, cone=choice, form=form, engine=engine)
    if equilibrium.verdict == "unstable":
        return infeasible(equilibrium)
    reach = wrench_range(data.wrench_map)
    shape = ContactForcesShape(force_shape(data, choice, form, reach.rank), objective, len(F))
    values = force_values(data, choice, reach.basis) | {"F": F, "reference": reference}

    def solve(one: Engine) -> Solution:
        return one.compile(MODEL, shape).solve(values)

    solution, handovers = settled(data, choice, engine, solve, f"objective '{objective}'", form, balances=equilibrium.stable)
    if solution.status != SOLVED:
        return infeasible(equilibrium)
    W = data.units.force
    value = solution.objective * (W if objective == "normal_force" else W**2)
    x, gap = solution.variables["x"], solution.gap
    return answer_of(data, choice, x, "solved", value, gap, solution.engine, handovers, equilibrium)


def measured_forces(data: StaticsData, objective: str, references: Mapping[str, Any]) -> tuple[Array, Array]:
    """What an objective measures.

    Args:
        data: The stance's arrays.
        objective: "least_squares", "normal_force" or "reference".
        references: Resultant contact forces in world axes by contact [N], for "reference".

    Returns:
        Rows of the measured force components over x, and their reference values, scaled.

    Raises:
        InputError: A reference names no contact, or is no force.
    """
    if objective == "normal_force":
        return np.zeros((0, data.wrench_map.shape[1])), np.zeros(0)
    if objective == "least_squares":
        F = np.vstack([force_rows(data, g) for g in groups(data, "point")])
        F = F[np.abs(F).sum(axis=1) > 0]
        return F, np.zeros(len(F))
    by_name = {data.names[g.contact]: g for g in groups(data, "contact")}
    rows, wanted = [], []
    for name, force in references.items():
        if name not in by_name:
            known = ", ".join(by_name)
            raise InputError(f"reference_forces: contact '{name}' is not known; known: {known}", name=name, field="reference_forces")
        wanted.append(vector(name, "reference_forces", force, 3) / data.units.force)
        rows.append(data.rotation[by_name[name].contact] @ force_rows(data, by_name[name]))
    return np.vstack(rows), np.concatenate(wanted)
