"""``model = "torque_feasibility"``: balancing forces whose worst share of the joint-torque limits is least; <= 1 is feasible."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from pydantic import Field, ValidationInfo, field_validator

from socp_statics.cases.answers.answer import RECORD_KEYS, Answer, Parameters, joint_names
from socp_statics.cases.answers.contact_forces import force_answer_keys
from socp_statics.exceptions import InputError

if TYPE_CHECKING:
    from socp_statics.cases.problem import Problem
    from socp_statics.contacts import Stance


class TorqueFeasibilityParameters(Parameters):
    """``[parameters]`` of a torque test, which is about the limits: they are always in force."""

    torque_limits: bool = Field(True, description="true", validate_default=True)

    @field_validator("torque_limits")
    @classmethod
    def _needs_a_robot(cls, value: bool, info: ValidationInfo) -> bool:
        if joint_names(info) == ():
            raise InputError("a torque test needs a robot, and this posture has none")
        if not value:
            raise InputError("a torque test is about the torque limits: true is expected, got False")
        return value


def answer(problem: Problem, stance: Stance, engine: str | Sequence[str]) -> dict[str, Any]:
    """The forces whose worst share of the torque limits is least; the objective is that share.

    Args:
        problem: Its parameters.
        stance: Its stance.
        engine: "auto", the name of an engine, or several to be tried in turn.
    """
    # the answers are listed and problems validated without a solver: it is imported when one is solved
    from socp_statics.optimization import minimise_torque_use

    found = minimise_torque_use(stance, cone=problem.cone, form=problem.parameters["form"], engine=engine)
    return force_answer_keys(found, stance)


ANSWER = Answer(TorqueFeasibilityParameters, answer, RECORD_KEYS | {"objective": None}, follows_com=True)
