"""The answer of a force optimisation, and how it is settled by the engines in turn."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from socp_statics.certificates import force_residuals
from socp_statics.cones.choice import ConeChoice
from socp_statics.engines import engine_names, engines_for
from socp_statics.engines.engine import Engine
from socp_statics.engines.solution import FAILED, INFEASIBLE, SOLVED, Solution
from socp_statics.exceptions import EngineError
from socp_statics.spatial import Array
from socp_statics.stability import EquilibriumAnswer
from socp_statics.statics import PointForces, StaticsData, point_forces
from socp_statics.statics.joint_torques import torques_by_name

ACCEPTED = 1e-7


@dataclass(frozen=True, eq=False)
class ForceAnswer:
    """Optimal contact forces of a stance.

    Attributes:
        status: "solved"; "infeasible" where nothing balances; "unbounded" where the infimum is not attained.
        objective: Value of the objective in SI, None where infeasible.
        forces: Optimal forces (near the infimum where it is not attained), or None.
        residuals: "balance", "cone" and "gap" in units of W.
        engine: Name of the engine that answered.
        handovers: How many programs went to another engine.
        equilibrium: Verdict, margin and certificate of the stance.
        torques: Joint torques of the forces [N m], None without a robot.
    """

    status: str
    objective: float | None
    forces: PointForces | None
    residuals: dict[str, float]
    engine: str
    handovers: int
    equilibrium: EquilibriumAnswer
    torques: dict[str, float] | None = None

    @property
    def torque_limits(self) -> dict[str, tuple[float, float]] | None:
        """Lower and upper joint torques that were asked for [N m]."""
        return self.equilibrium.torque_limits


def infeasible(equilibrium: EquilibriumAnswer) -> ForceAnswer:
    """The answer where nothing balances."""
    none = {"balance": 0.0, "cone": 0.0, "gap": equilibrium.residuals["gap"]}
    return ForceAnswer("infeasible", None, None, none, equilibrium.engine, equilibrium.handovers, equilibrium)


def settled(
    data: StaticsData, cone: ConeChoice, engine: str | Sequence[str], solve: Callable[[Engine], Solution], what: str, form: str, *,
    check: bool = True, balances: bool = False,
) -> tuple[Solution, int]:
    """One program by the first engine whose answer checks.

    Args:
        data: The stance's arrays.
        cone: Exact cones or pyramids.
        engine: "auto", the name of an engine, or several to be tried in turn.
        solve: Compiles and solves with an engine.
        what: What is being solved, for the error sentence.
        form: "socp" or "sdp".
        check: Whether the forces have to lie inside the set.
        balances: Whether there are forces in the set for certain: an engine that says there are none has not settled the program.

    Returns:
        A solution that is solved with forces inside the set, or infeasible; and the number of handovers.

    Raises:
        EngineError: No engine settled it.
    """
    details = []
    for handovers, one in enumerate(engines_for(engine, form)):
        solution = solve(one)
        details.append(f"{one.name}: {solution.detail}")
        if solution.status == INFEASIBLE and not balances:
            return solution, handovers
        if solution.status == SOLVED:
            x = solution.variables["x"]
            if not check or max(force_residuals(data, cone, x)) <= ACCEPTED * max(1.0, float(abs(x).max())):
                return solution, handovers
            details[-1] += " with forces outside the set"
        elif solution.status == INFEASIBLE:
            details[-1] += " though forces balance"
        elif solution.status != FAILED:
            details[-1] += " without an optimum"
    raise EngineError(f"{what} was not settled ({'; '.join(details)})", name=engine_names(engine)[-1])


def answer_of(
    data: StaticsData, cone: ConeChoice, x: Array, status: str, objective: float, gap: float, engine: str, handovers: int,
    equilibrium: EquilibriumAnswer, promised: StaticsData | None = None,
) -> ForceAnswer:  # fmt: skip
    """The answer behind scaled forces; its residuals are those of the set that was promised, the whole one by default."""
    held = force_residuals(promised or data, cone, x)
    residuals = {"balance": held.balance, "cone": held.cone, "gap": gap}
    torques = torques_by_name(data.torques, data.units, x) if data.torques.names else None
    return ForceAnswer(status, objective, point_forces(data, x), residuals, engine, equilibrium.handovers + handovers, equilibrium, torques)
