"""The least use of joint torques: minimum of the worst share, and Orin and Oh's power."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from socp_statics.cones.choice import ConeChoice, cone_choice
from socp_statics.contacts import Stance
from socp_statics.contacts.numbers import scalar
from socp_statics.contacts.stance import stance_of
from socp_statics.engines.engine import Engine
from socp_statics.engines.solution import SOLVED, Solution
from socp_statics.exceptions import InputError
from socp_statics.models.contact_forces_set import force_shape, force_values
from socp_statics.models.orin_oh import MODEL as ORIN_OH
from socp_statics.models.orin_oh import OrinOhShape
from socp_statics.models.torque_feasibility import MODEL, TorqueShape
from socp_statics.optimization.force_answer import ForceAnswer, answer_of, infeasible, settled
from socp_statics.spatial import Array
from socp_statics.stability import EquilibriumAnswer, check_equilibrium
from socp_statics.statics import StaticsData, assemble, wrench_range


def minimise_torque_use(
    stance: Any,
    *,
    torque_limits: bool | Mapping[str, Any] = True,
    cone: str | ConeChoice = "exact",
    sides: int | None = None,
    heading: float | None = None,
    form: str = "socp",
    engine: str | Sequence[str] = "auto",
) -> ForceAnswer:
    """Balancing forces whose worst share of the joint-torque limits is least, the corrected test (3.78).

    Args:
        stance: A Posture, or a Stance with one.
        torque_limits: True for the robot's own limits (or those the stance has), or a mapping of limits.
        cone: "exact", "inscribed" or "circumscribed", or a ConeChoice.
        sides: Sides of the pyramids.
        heading: Heading of the pyramids [rad].
        form: "socp" or "sdp".
        engine: "auto", the name of an engine, or several to be tried in turn.

    Returns:
        The forces; the objective is max tau_i / limit_i, the posture is feasible exactly where it is <= 1. Status "infeasible" where
        no forces balance even without shared limits.

    Raises:
        InputError: No robot, or limits that are wrong or placeholders.
        EngineError: No engine settled the program.
    """
    choice = cone_choice(cone, sides, heading)
    kept = isinstance(stance, Stance) and stance.torque_limits is not None and torque_limits is True
    limited = stance if kept else stance_of(stance, torque_limits=torque_limits)
    if limited.torque_limits is None:
        raise InputError("torque_limits must be given for a torque test, not false", name="torque_limits", field="torque_limits")
    equilibrium = check_equilibrium(limited, cone=choice, form=form, engine=engine)
    data = assemble(limited)
    shared, values, hard = _shares(data)
    reach = wrench_range(data.wrench_map)
    shape = TorqueShape(force_shape(hard, choice, form, reach.rank), len(shared))
    values |= force_values(hard, choice, reach.basis)
    if equilibrium.verdict == "unstable" and equilibrium.reason != "torque" and not _balanced_without(limited, choice, form, engine):
        return infeasible(equilibrium)

    def solve(one: Engine) -> Solution:
        return one.compile(MODEL, shape).solve(values)

    solution, handovers = settled(hard, choice, engine, solve, "the least use of torques", form, balances=equilibrium.stable)
    if solution.status != SOLVED:
        return infeasible(equilibrium)
    x = solution.variables["x"]
    share, gap = max(solution.objective, 0.0), solution.gap
    return answer_of(data, choice, x, "solved", share, gap, solution.engine, handovers, equilibrium, promised=hard)


def _balanced_without(stance: Stance, cone: ConeChoice, form: str, engine: str | Sequence[str]) -> bool:
    return check_equilibrium(replace(stance, torque_limits=None), cone=cone, form=form, engine=engine).verdict != "unstable"


def _shares(data: StaticsData) -> tuple[Array, dict[str, Array], StaticsData]:
    """Finite limits that are shared, as rows ``U x <= s u - v``, and the data with the zero limits alone as torque rows."""
    rows, ends = data.limit_rows[data.handle_limits :], data.limit_values[data.handle_limits :]
    lower, upper = data.torques.limits[:, 0], data.torques.limits[:, 1]
    above, below = np.flatnonzero(np.isfinite(upper)), np.flatnonzero(np.isfinite(lower))
    limit = np.concatenate([upper[above], -lower[below]])
    zero = limit == 0.0
    passive = limit - ends
    values = {"U": rows[~zero], "u": limit[~zero], "v": passive[~zero]}
    kept = np.concatenate([np.ones(data.handle_limits, dtype=bool), zero])
    return rows[~zero], values, replace(data, limit_rows=data.limit_rows[kept], limit_values=data.limit_values[kept])


def minimise_power_and_peak(
    stance: Stance, rates: Mapping[str, float] | None, b: float, *, cone: ConeChoice, form: str, engine: str | Sequence[str]
) -> ForceAnswer:
    """Orin and Oh's objective: sum of |tau_i rate_i| over the joints plus b times the largest normal force.

    Args:
        stance: The stance; with a posture its joints count.
        rates: Joint to rate [rad/s], joints left out count nothing; None for 1 rad/s on every joint.
        b: Weight of the largest normal force [m/s].
        cone: Exact cones or pyramids.
        form: "socp" or "sdp".
        engine: "auto", the name of an engine, or several to be tried in turn.

    Returns:
        The forces; the objective is in watts.

    Raises:
        InputError: An unknown joint, rates without a robot, or a weight that is negative.
        EngineError: No engine settled the program.
    """
    weight = scalar("orin_oh", "b", b, least=0.0, kind="objective")
    equilibrium: EquilibriumAnswer = check_equilibrium(stance, cone=cone, form=form, engine=engine)
    data = assemble(stance)
    rate = _rates(stance, rates)
    if equilibrium.verdict == "unstable":
        return infeasible(equilibrium)
    reach = wrench_range(data.wrench_map)
    counted = np.flatnonzero(rate)
    shape = OrinOhShape(force_shape(data, cone, form, reach.rank), len(counted))
    length = data.units.length
    values = force_values(data, cone, reach.basis) | {
        "b": np.array(weight / length),
        "P": -rate[counted, None] * data.torques.map[counted] if len(counted) else np.zeros((0, data.wrench_map.shape[1])),
        "p0": rate[counted] * data.torques.passive[counted],
    }

    def solve(one: Engine) -> Solution:
        return one.compile(ORIN_OH, shape).solve(values)

    solution, handovers = settled(data, cone, engine, solve, "objective 'orin_oh'", form, balances=equilibrium.stable)
    if solution.status != SOLVED:
        return infeasible(equilibrium)
    value = solution.objective * data.units.force * length
    return answer_of(
        data, cone, solution.variables["x"], "solved", value, solution.gap, solution.engine, handovers, equilibrium
    )  # fmt: skip


def _rates(stance: Stance, rates: Mapping[str, float] | None) -> Array:
    if stance.posture is None:
        if rates:
            raise InputError("rates need a robot, this stance has no joints", name="rates", field="rates")
        return np.zeros(0)
    robot = stance.posture.robot
    if rates is None:
        return np.ones(len(robot.joints))
    out = np.zeros(len(robot.joints))
    for joint, value in rates.items():
        out[robot.joint_index(joint, "rates")] = scalar(joint, "rates", value, kind="joint")
    return out
