"""``model = "equilibrium"``: verdict, margin and certificate of one stance."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from pydantic import Field, ValidationInfo, field_validator

from socp_statics.cases.answers.answer import RECORD_KEYS, Answer, Many
from socp_statics.cases.answers.robustness_keys import ROBUSTNESS_KEYS
from socp_statics.cases.answers.safety import SAFETY_KEYS, SafetyParameters, safety_verdict
from socp_statics.cases.answers.simple_test import SIMPLE_TEST_KEYS, simple_tests
from socp_statics.cases.answers.strong_stability import STRONG_KEYS, strong_keys
from socp_statics.exceptions import InputError

if TYPE_CHECKING:
    from socp_statics.cases.problem import Problem
    from socp_statics.certificates.prices import Prices
    from socp_statics.contacts import Stance
    from socp_statics.optimization import ForceAnswer
    from socp_statics.stability import EquilibriumAnswer


class EquilibriumParameters(SafetyParameters):
    """``[parameters]`` of an equilibrium problem."""

    simple_test: bool | None = Field(None, description="true or false")
    strong: bool | None = Field(None, description="true or false")
    robustness: bool | None = Field(None, description="true or false")
    prices: bool | None = Field(None, description="true or false: whether the record says what friction, limits and places are worth")

    @field_validator("strong")
    @classmethod
    def _is_of_one_body_on_exact_cones(cls, value: bool | None, info: ValidationInfo) -> bool | None:
        if value and info.data.get("cone", "exact") != "exact":
            raise InputError("strong stability is judged on the exact cones: cone = 'exact' is expected with it")
        if value and info.data.get("torque_limits"):
            raise InputError("strong stability is that of one body with locked joints: torque_limits = false is expected with it")
        return value


def torque_keys(answer: EquilibriumAnswer | ForceAnswer | None, stance: Stance) -> dict[str, Any]:
    """The record keys of the joints; none without a robot.

    Args:
        answer: Whose forces the torques belong to; None where there is no answer.
        stance: Its stance.

    Returns:
        "torques", empty where there are no forces, and "torque_limits", empty where none are in force.
    """
    if stance.posture is None:
        return {}
    limits = {} if stance.torque_limits is None else dict(zip(stance.posture.robot.joints, stance.torque_limits, strict=True))
    return {"torques": dict(answer.torques or {}) if answer is not None else {}, "torque_limits": limits}


def price_keys(prices: Prices | None) -> dict[str, Any]:
    """The record's ``prices``: the entry of one objective, none where there are no prices."""
    return {} if prices is None else {prices.objective: prices.as_record()}


def verdict_keys(answer: EquilibriumAnswer, stance: Stance, prices: bool = True) -> dict[str, Any]:
    """The record keys that every model shares with the verdict of its stance.

    Args:
        answer: Of `socp_statics.stability`.
        stance: Its stance.
        prices: Whether prices are among them.
    """
    return {
        "status": answer.status,
        "verdict": answer.verdict,
        "reason": answer.reason,
        "cone": answer.cone.as_record(),
        "objective": None,
        "margin": answer.margin,
        "idle": list(answer.idle),
        "idle_margin": answer.idle_margin,
        "wrenches": [] if answer.forces is None else answer.forces.wrenches(),
        "forces": [] if answer.forces is None else answer.forces.entries(),
        **torque_keys(answer, stance),
        "certificate": None if answer.certificate is None else answer.certificate.as_record(),
        "prices": price_keys(answer.prices) if prices else {},
        "residuals": dict(answer.residuals),
        "engine": answer.engine,
        "handovers": answer.handovers,
    }


def answer(problem: Problem, stance: Stance, engine: str | Sequence[str]) -> dict[str, Any]:
    """Verdict, margin and certificate; also, where asked for, against a ``safety`` offset, a ``simple_test`` by inverses, ``robustness``.

    With ``strong`` also strong stability.

    Args:
        problem: Its parameters.
        stance: Its stance.
        engine: "auto", the name of an engine, or several to be tried in turn.
    """
    # the answers are listed and problems validated without a solver: it is imported when one is solved
    from socp_statics.stability import check_equilibrium

    return _keys(problem, stance, engine, check_equilibrium(stance, cone=problem.cone, form=problem.parameters["form"], engine=engine))


def _keys(problem: Problem, stance: Stance, engine: str | Sequence[str], found: EquilibriumAnswer) -> dict[str, Any]:
    stated, cone = problem.parameters, problem.cone
    keys = verdict_keys(found, stance, stated.get("prices", True))
    if stated.get("strong"):
        from socp_statics.stability.strong import strong_answer

        keys |= strong_keys(strong_answer(stance, found, engine))
    if "safety" in stated:
        from socp_statics.regions import trace_support_region

        region = trace_support_region(stance, cone=cone, form=stated["form"], engine=engine)
        keys["safety"] = safety_verdict(stance, region.com_margin, stated["safety"])
    if stated.get("simple_test"):
        keys["simple_test"] = simple_tests(stance, cone)
    if stated.get("robustness"):
        from socp_statics.stability.robustness import measure_robustness

        measured = measure_robustness(stance, cone=cone, form=stated["form"], engine=engine)
        keys["robustness"] = measured.as_record()
    return keys


def friction_only(problem: Problem, engine: str | Sequence[str]) -> Any:
    """What problems share whose margins or regions one call of the kernel finds: the parameters; None where limits count, or no kernel."""
    from socp_statics.engines import compiled_first

    stated = problem.parameters
    if stated["torque_limits"] or not compiled_first(engine, stated["form"]):
        return None
    return (problem.model, tuple(sorted(stated.items())))


def answers(problems: Sequence[Problem], stances: Sequence[Stance], engine: str | Sequence[str]) -> list[dict[str, Any]]:
    """What `answer` says of many problems with the same parameters.

    Args:
        problems: The problems.
        stances: Their stances.
        engine: "auto", the name of an engine, or several to be tried in turn.
    """
    from socp_statics.stability.equilibrium import check_equilibria

    found = check_equilibria(stances, problems[0].cone, problems[0].parameters["form"], engine)
    return [_keys(problem, stance, engine, one) for problem, stance, one in zip(problems, stances, found, strict=True)]


ANSWER = Answer(
    EquilibriumParameters,
    answer,
    RECORD_KEYS | SAFETY_KEYS | SIMPLE_TEST_KEYS | STRONG_KEYS | ROBUSTNESS_KEYS,
    follows_com=True,
    many=Many(friction_only, answers),
)
