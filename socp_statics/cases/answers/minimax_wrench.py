"""``model = "minimax_wrench"``: balancing contact forces whose largest measure is least."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal

from pydantic import Field

from socp_statics.cases.answers.answer import RECORD_KEYS, Answer, Parameters
from socp_statics.cases.answers.contact_forces import force_answer_keys

if TYPE_CHECKING:
    from socp_statics.cases.problem import Problem
    from socp_statics.contacts import Stance


class MinimaxWrenchParameters(Parameters):
    """``[parameters]`` of a minimax problem."""

    measure: Literal["normal", "force", "component", "tangential", "friction_use"] = Field(
        "force", description="'normal', 'force', 'component', 'tangential' or 'friction_use'"
    )
    level: Literal["contact", "point"] = Field("point", description="'contact' or 'point'")
    length: float = Field(0.1, gt=0, description="a finite length > 0 [m] that divides moments")


def answer(problem: Problem, stance: Stance, engine: str | Sequence[str]) -> dict[str, Any]:
    """The forces whose largest measure is least.

    Args:
        problem: Its parameters.
        stance: Its stance.
        engine: "auto", the name of an engine, or several to be tried in turn.
    """
    # the answers are listed and problems validated without a solver: it is imported when one is solved
    from socp_statics.optimization import minimise_largest_wrench

    stated = problem.parameters
    found = minimise_largest_wrench(
        stance,
        stated["measure"],
        stated["level"],
        length=stated["length"],
        cone=problem.cone,
        form=stated["form"],
        engine=engine,
    )
    return force_answer_keys(found, stance)


ANSWER = Answer(MinimaxWrenchParameters, answer, RECORD_KEYS | {"objective": None}, follows_com=True)
