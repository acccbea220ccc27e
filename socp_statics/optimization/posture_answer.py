"""The answer of a posture optimisation: given posture and result, both judged by the programs that judge any posture."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from socp_statics.contacts import Stance
from socp_statics.exceptions import EngineError
from socp_statics.optimization.force_answer import ForceAnswer
from socp_statics.optimization.posture_program import Question
from socp_statics.optimization.posture_search import OPTIMAL, Climb
from socp_statics.optimization.torque_use import minimise_torque_use
from socp_statics.postures import Posture
from socp_statics.regions import trace_support_region
from socp_statics.stability import EquilibriumAnswer, check_equilibrium

# How well search and judgement have to agree; a traced CoM margin is refined to a relative 1e-3 only.
AGREED, TRACED = 1e-6, 2e-3


@dataclass(frozen=True, eq=False)
class PostureAnswer:
    """A posture that was improved. Before and after are answers of the conic engine at the two postures, independent of the search.

    Attributes:
        objective: "margin", "com_margin" or "torque".
        before: The objective at the given posture: the margin [N], the CoM margin [m; nan where the region is empty], or the worst share
            of a torque limit; infinite where no forces do.
        after: The objective at the result.
        optimality: What the statics linearised in the motion still promise at the result, within a motion of length one (joints [rad],
            base over the contacts' size), in units of W, of the size, or as a share; it bounds the residual of the KKT
            conditions. None where there is nothing to linearise.
        local_optimum: Whether that is at most 1e-6.
        reason: Why it is not, or None.
        given: Verdict, margin and forces of the given posture; for "torque" its least use of torques.
        found: The same of the result.
        posture: The result.
        stance: Its stance.
        steps: How many motions were accepted.
    """

    objective: str
    before: float
    after: float
    optimality: float | None
    local_optimum: bool
    reason: str | None
    given: EquilibriumAnswer | ForceAnswer
    found: EquilibriumAnswer | ForceAnswer
    posture: Posture
    stance: Stance
    steps: int


def answer_of_climb(given: Stance, climb: Climb, form: str) -> PostureAnswer:
    """The answer with both postures judged anew.

    Args:
        given: The given stance.
        climb: Where the search ended.
        form: "socp" or "sdp", of the programs that judge.

    Raises:
        EngineError: The search and the judgement of its result disagree.
    """
    at, question = climb.at, climb.at.question
    before, first = _judged(given, question, form)
    after, last = (before, first) if climb.steps == 0 else _judged(at.stance, question, form)
    if at.settled and not at.unlimited:
        scale = {"margin": at.data.units.force, "com_margin": at.data.units.length, "torque": 1.0}[question.objective]
        expected = abs(at.value) * scale if question.objective == "torque" else at.value * scale
        allowed = AGREED * scale + (TRACED * abs(expected) if question.objective == "com_margin" else 0.0)
        if not abs(after - expected) <= allowed:
            raise EngineError(f"the optimised posture's {question.objective} is {expected:.9g} in the search and {after:.9g} judged anew")
    elif not at.settled and not at.without_edge and np.isfinite(after):
        raise EngineError(f"the statics of the posture were not settled in the search, but its {question.objective} is {after:.9g}")
    local = climb.optimality is not None and climb.optimality <= OPTIMAL
    return PostureAnswer(
        question.objective, before, after, climb.optimality, local, climb.reason, first, last, at.posture, at.stance, climb.steps
    )  # fmt: skip


def _judged(stance: Stance, question: Question, form: str) -> tuple[float, EquilibriumAnswer | ForceAnswer]:
    """The objective of a posture, and the answer that holds its verdict and forces."""
    settings = {"cone": question.cone, "form": form, "engine": question.engine}
    if question.objective == "torque":
        use = minimise_torque_use(stance, **settings)  # type: ignore[arg-type]
        return (np.inf if use.objective is None else use.objective), use
    equilibrium = check_equilibrium(stance, **settings)  # type: ignore[arg-type]
    if question.objective == "margin":
        return equilibrium.margin, equilibrium
    away = trace_support_region(stance, **settings).com_margin  # type: ignore[arg-type]
    return (np.nan if away is None else away), equilibrium
