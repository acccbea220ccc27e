"""The quadratic program for contact wrenches of Section 5.14, with the exact cones where the book has linear rows.

    minimise    sum_k |F_k|^2 + weight sum_k |p_k - p_k,wished|^2
    subject to  the balance and the cones at all contact points

in units of W and size. A centre of pressure ``p_k = (-m_y, m_x) / f_n`` is linear in the wrench only where f_n is frozen in its
denominator: it is, at the normal force of the barycentric rule (of the pseudoinverse without a load), and the numerator is the moment
about the wished point, so that the minimum is zero exactly where the centre of pressure is wished.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from socp_statics.cones.choice import ConeChoice
from socp_statics.contacts import Stance
from socp_statics.contacts.numbers import scalar, vector
from socp_statics.distribution.closed_form import closed_forms
from socp_statics.distribution.distributions import question_of, wrenches_C
from socp_statics.engines.engine import Engine
from socp_statics.engines.solution import SOLVED, Solution
from socp_statics.exceptions import InputError
from socp_statics.models.contact_forces import MODEL, ContactForcesShape
from socp_statics.models.contact_forces_set import force_shape, force_values
from socp_statics.optimization.force_answer import ForceAnswer, answer_of, infeasible, settled
from socp_statics.optimization.wrench_reserve import contact_wrench_rows
from socp_statics.registry import nearest
from socp_statics.spatial import Array
from socp_statics.stability import check_equilibrium
from socp_statics.statics import StaticsData, wrench_range

# A contact that the barycentric rule hardly loads has its centre of pressure measured with this share of the load.
LEAST_SHARE = 0.01


def distribute_by_quadratic_program(
    stance: Stance, data: StaticsData, cop_weight: float, cops: Mapping[str, Any] | None, *, cone: ConeChoice, form: str,
    engine: str | Sequence[str],
) -> ForceAnswer:  # fmt: skip
    """Contact forces of the quadratic program.

    Args:
        stance: The stance.
        data: Its arrays.
        cop_weight: Weight of the centres of pressure, >= 0.
        cops: Wished centres of pressure by contact, in the contact plane, shape (2,) [m]; the middle of the contact's points by default.
        cone: Exact cones or pyramids.
        form: "socp" or "sdp".
        engine: "auto", the name of an engine, or several to be tried in turn.

    Returns:
        The forces; the objective in W^2.

    Raises:
        InputError: A weight that is negative, or a wished point of a contact that is not there or has no extent.
        EngineError: No engine settled the program.
    """
    weight = scalar("wrench_distribution", "cop_weight", cop_weight, least=0.0, kind="model")
    wished = _wished(stance, cops or {})
    equilibrium = check_equilibrium(stance, cone=cone, form=form, engine=engine)
    if equilibrium.verdict == "unstable":
        return infeasible(equilibrium)
    rows = _cost_rows(stance, data, weight, wished)
    reach = wrench_range(data.wrench_map)
    shape = ContactForcesShape(force_shape(data, cone, form, reach.rank), "least_squares", len(rows))
    values = force_values(data, cone, reach.basis) | {"F": rows, "reference": np.zeros(len(rows))}

    def solve(one: Engine) -> Solution:
        return one.compile(MODEL, shape).solve(values)

    solution, handovers = settled(data, cone, engine, solve, "the quadratic program of the wrenches", form, balances=equilibrium.stable)
    if solution.status != SOLVED:
        return infeasible(equilibrium)
    x, gap = solution.variables["x"], solution.gap
    return answer_of(data, cone, x, "solved", solution.objective, gap, solution.engine, handovers, equilibrium)


def _cost_rows(stance: Stance, data: StaticsData, weight: float, wished: Mapping[int, Array]) -> Array:
    """Rows over x whose squares add up to the cost."""
    wrenches = contact_wrench_rows(data)
    question = question_of([stance])
    rule = "barycentric" if question.wrench[0, :3].any() else "scaled_pseudoinverse"
    frozen = wrenches_C(stance.contacts, closed_forms(question, [rule])[rule])[0] / data.units.force
    rows = [wrenches[np.abs(wrenches).sum(axis=1) > 0]]
    for k, point in wished.items():
        F = wrenches[6 * k : 6 * k + 6]
        x, y = point / data.units.length
        f_n = max(float(frozen[k, 2]), LEAST_SHARE)
        rows.append(np.sqrt(weight) / f_n * np.array([-(F[4] + x * F[2]), F[3] - y * F[2]]))
    return np.vstack(rows)


def _wished(stance: Stance, cops: Mapping[str, Any]) -> dict[int, Array]:
    """Wished centres of pressure by index of the contact."""
    extended = {c.name: (k, c) for k, c in enumerate(stance.contacts) if c.unilateral and len(c.points_C) > 1}
    for name in cops:
        if name not in extended:
            what = "has no extent" if name in stance.contacts.names else f"is not there{nearest(name, extended)}"
            raise InputError(f"cops: contact '{name}' {what}, no centre of pressure can be wished for it", name=name, field="cops")
    return {k: vector(name, "cops", cops.get(name, c.points_C.mean(axis=0)), 2) for name, (k, c) in extended.items()}
