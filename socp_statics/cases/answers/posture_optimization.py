"""``model = "posture_optimization"``: a better posture on the same contacts, beside the verdict of the given one."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import Field, ValidationInfo, model_validator

from socp_statics.cases.answers.answer import CONFIGURATION_KEYS, RECORD_KEYS, VECTOR, Answer, Parameters, contact_names, joint_names
from socp_statics.cases.answers.contact_forces import force_answer_keys
from socp_statics.cases.answers.equilibrium import verdict_keys
from socp_statics.cases.dotted import key_text
from socp_statics.exceptions import InputError
from socp_statics.registry import nearest

if TYPE_CHECKING:
    from socp_statics.cases.problem import Problem
    from socp_statics.contacts import Stance
    from socp_statics.optimization import ForceAnswer, PostureAnswer
    from socp_statics.stability import EquilibriumAnswer

OF_THE_RESULT = ("verdict", "margin", "wrenches", "forces", "torques", "certificate", "residuals")
OPTIMIZED_KEYS: dict[str, Any] = {
    "objective": None,
    "objective_before": None,
    "objective_after": None,
    "optimality": None,
    "local_optimum": None,
    "reason": None,
    "steps": None,
    **CONFIGURATION_KEYS,
    "com": VECTOR,
    "contacts": [{"position": VECTOR, "rotation": [VECTOR]}],
} | {key: RECORD_KEYS[key] for key in OF_THE_RESULT}

Slide = Annotated[list[str], Field(description="a list of contacts that may slide in their plane")]


class PostureOptimizationParameters(Parameters):
    """``[parameters]`` of a posture optimisation."""

    objective: Literal["margin", "com_margin", "torque"] = Field("margin", description="'margin', 'com_margin' or 'torque'")
    slide: Slide = []

    @model_validator(mode="after")
    def _can_be_improved(self, info: ValidationInfo) -> Self:
        if joint_names(info) == ():
            raise InputError("a posture can only be optimised with a robot, and this one has none", field="objective")
        if self.objective == "torque" and not self.torque_limits:
            raise InputError("objective 'torque' is about the torque limits: torque_limits = true is expected", field="objective")
        known = contact_names(info)
        for number, name in enumerate(self.slide):
            if known is not None and name not in known:
                raise InputError(f"{name!r} is no contact of the posture{nearest(name, known)}", field=key_text(("slide", number)))
        return self


def answer(problem: Problem, stance: Stance, engine: str | Sequence[str]) -> dict[str, Any]:
    """Verdict and forces of the given posture, and the posture that was found.

    Args:
        problem: Its parameters.
        stance: Its stance.
        engine: "auto", the name of an engine, or several to be tried in turn.
    """
    # the answers are listed and problems validated without a solver: it is imported when one is solved
    from socp_statics.optimization import optimise_posture

    stated = problem.parameters
    found = optimise_posture(stance, stated["objective"], slide=stated["slide"], cone=problem.cone, form=stated["form"], engine=engine)
    keys = _keys(found.given, stance)
    solved = {} if found.steps == 0 else {"status": "solved"}
    return keys | solved | {"objective": found.after, "optimized": optimized_keys(found)}


def _keys(answer: EquilibriumAnswer | ForceAnswer, stance: Stance) -> dict[str, Any]:
    from socp_statics.optimization import ForceAnswer

    return force_answer_keys(answer, stance) if isinstance(answer, ForceAnswer) else verdict_keys(answer, stance)


def optimized_keys(found: PostureAnswer) -> dict[str, Any]:
    """The record's ``optimized``.

    Args:
        found: Of `socp_statics.optimization.optimise_posture`.
    """
    posture, keys = found.posture, _keys(found.found, found.stance)
    return {
        "objective": found.objective,
        "objective_before": found.before,
        "objective_after": found.after,
        "optimality": found.optimality,
        "local_optimum": found.local_optimum,
        "reason": found.reason,
        "steps": found.steps,
        **posture.as_record(),
        "com": posture.com_W,
        "contacts": [contact.statement() for contact in posture.contacts],
    } | {key: keys[key] for key in OF_THE_RESULT}


ANSWER = Answer(PostureOptimizationParameters, answer, RECORD_KEYS | {"objective": None, "optimized": OPTIMIZED_KEYS})
