"""``model = "robustness"``: how much may go wrong before the posture no longer holds, in units a person understands."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field, ValidationInfo, field_validator

from socp_statics.cases.answers.answer import RECORD_KEYS, Answer, contact_names, joint_names
from socp_statics.cases.answers.equilibrium import verdict_keys
from socp_statics.cases.answers.robustness_keys import DEFAULT_MEASURES, MEASURES, ROBUSTNESS_KEYS
from socp_statics.cases.answers.safety import SAFETY_KEYS, SafetyParameters, safety_verdict
from socp_statics.cases.statement import Pair, Vector3
from socp_statics.exceptions import InputError
from socp_statics.registry import nearest

if TYPE_CHECKING:
    from socp_statics.cases.problem import Problem
    from socp_statics.contacts import Stance

INTERVAL = "a pair [lo, hi] of friction coefficients, 0 <= lo <= hi"
Row4 = Annotated[list[float], Field(min_length=4, max_length=4)]
Matrix4 = Annotated[list[Row4], Field(min_length=4, max_length=4)]


class RobustnessParameters(SafetyParameters):
    """``[parameters]`` of a robustness problem."""

    measures: list[str] = Field(list(DEFAULT_MEASURES), min_length=1, description=f"a list of {', '.join(MEASURES)}")
    point: Vector3 | None = Field(None, description="three finite numbers [m], world axes: where pushes act, the CoM by default")
    link: str | None = Field(None, min_length=1, description="the name of a link or frame of the robot")
    length: float = Field(1.0, gt=0, description="a finite length > 0 [m]: a moment of 1 N m counts as 1 / length newtons")
    ellipsoid: Row4 | Matrix4 | None = Field(
        None, description="four semi-axes [kg, kg m, kg m, kg m], or a symmetric 4 x 4 matrix, of the errors of (m, m c)"
    )
    friction_intervals: dict[str, Annotated[Pair, Field(description=INTERVAL)]] | None = Field(
        None, description=f"a table of {INTERVAL}, by contact, or 'default' for the others"
    )
    tolerance: float = Field(1e-3, gt=0, lt=1, description="a number > 0 and < 1: the relative width of a bracket that counts as exact")

    @field_validator("measures")
    @classmethod
    def _are_known(cls, value: list[str]) -> list[str]:
        for name in value:
            if name not in MEASURES:
                raise InputError(f"measure {name!r} is not known{nearest(name, MEASURES)}")
        return value

    @field_validator("link")
    @classmethod
    def _is_on_a_robot(cls, value: str | None, info: ValidationInfo) -> str | None:
        if value is not None and joint_names(info) == ():
            raise InputError(f"a link needs a robot, and this posture has none: got {value!r}")
        return value

    @field_validator("friction_intervals")
    @classmethod
    def _name_contacts(cls, value: dict[str, Any] | None, info: ValidationInfo) -> dict[str, Any] | None:
        names = contact_names(info)
        for key in value or {}:
            if names is not None and key not in (*names, "default"):
                raise InputError(f"contact {key!r} is not known{nearest(key, (*names, 'default'))}")
        return value


def answer(problem: Problem, stance: Stance, engine: str | Sequence[str]) -> dict[str, Any]:
    """The measures, with verdict, margin, forces and certificate of the posture as it is.

    Args:
        problem: Its parameters.
        stance: Its stance.
        engine: "auto", the name of an engine, or several to be tried in turn.
    """
    # the answers are listed and problems validated without a solver: it is imported when one is solved
    from socp_statics.stability.robustness import measure_robustness

    stated, cone = problem.parameters, problem.cone
    found = measure_robustness(
        stance, measures=stated["measures"], point=stated.get("point"), link=stated.get("link"), length=stated["length"],
        ellipsoid=stated.get("ellipsoid"), friction_intervals=stated.get("friction_intervals"), tolerance=stated["tolerance"],
        cone=cone, form=stated["form"], engine=engine,
    )  # fmt: skip
    keys = verdict_keys(found.equilibrium, stance) | {"status": "solved", "robustness": found.as_record()}
    if "safety" in stated:
        from socp_statics.regions import trace_support_region

        region = trace_support_region(stance, cone=cone, form=stated["form"], engine=engine)
        keys["safety"] = safety_verdict(stance, region.com_margin, stated["safety"])
    return keys


ANSWER = Answer(RobustnessParameters, answer, RECORD_KEYS | SAFETY_KEYS | ROBUSTNESS_KEYS)
