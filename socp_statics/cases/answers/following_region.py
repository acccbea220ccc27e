"""``model = "following_region"``: how far the CoM goes along rays while the posture follows, beside the region of the frozen posture."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal, Self

from pydantic import Field, ValidationInfo, field_validator, model_validator

from socp_statics.cases.answers.answer import CONFIGURATION_KEYS, RECORD_KEYS, VECTOR, Answer, Parameters, joint_names
from socp_statics.cases.answers.equilibrium import verdict_keys
from socp_statics.cases.answers.support_region import REGION_KEYS, agree
from socp_statics.exceptions import InputError

if TYPE_CHECKING:
    from socp_statics.cases.problem import Problem
    from socp_statics.contacts import Stance

FROZEN_GAP = 1e-3
END_KEYS: dict[str, Any] = {
    "distance": None,
    "position": VECTOR,
    "height": None,
    **CONFIGURATION_KEYS,
    "verdict": None,
    "margin": None,
}
BEYOND_KEYS = END_KEYS | {"certificate": RECORD_KEYS["certificate"]}
FOLLOWING_KEYS: dict[str, Any] = {
    "following": {
        "height": None,
        "step": None,
        "tolerance": None,
        "objective": None,
        "attained": None,
        "centre": VECTOR,
        "polygon": [VECTOR],
        "area": None,
        "start": BEYOND_KEYS,
        "reasons": {"equilibrium": None, "torque": None, "joint limit": None, "cannot reach": None, "step failure": None},
        "rays": [
            END_KEYS
            | {"direction": VECTOR, "stopped_at": None, "reason": None, "joints": [None], "reading": None, "steps": None}
            | {"beyond": BEYOND_KEYS}
        ],
    }
}


class FollowingRegionParameters(Parameters):
    """``[parameters]`` of a following region."""

    rays: int = Field(24, ge=3, description="a whole number >= 3", validate_default=True)
    tolerance: float = Field(1e-3, gt=0, le=0.1, description="a length > 0 and <= 0.1 [m]: between the two sides of an exit")
    step: float = Field(5e-3, gt=0, le=0.1, description="a length > 0 and <= 0.1 [m]")
    height: float | Literal["free"] = Field("free", description="'free' or a finite height [m]")

    @field_validator("rays")
    @classmethod
    def _a_robot_has_rays(cls, value: int, info: ValidationInfo) -> int:
        if joint_names(info) == ():
            raise InputError("a following region needs a robot, and this posture has none")
        return value

    @model_validator(mode="after")
    def _steps_hold_the_tolerance(self) -> Self:
        if self.step < self.tolerance:
            raise InputError(f"a length >= the tolerance ({self.tolerance:g} m) is expected, got {self.step:g}", field="step")
        return self


def answer(problem: Problem, stance: Stance, engine: str | Sequence[str]) -> dict[str, Any]:
    """Verdict, margin and region of the seed, frozen, and how far each ray gets.

    Args:
        problem: Its parameters.
        stance: Its stance.
        engine: "auto", the name of an engine, or several to be tried in turn.
    """
    # the answers are listed and problems validated without a solver: it is imported when one is solved
    from socp_statics.following import trace_following_region
    from socp_statics.regions import trace_support_region
    from socp_statics.stability import check_equilibrium

    stated, settings = problem.parameters, {"cone": problem.cone, "form": problem.parameters["form"], "engine": engine}
    height = None if stated["height"] == "free" else stated["height"]
    following = trace_following_region(stance, stated["rays"], stated["tolerance"], step=stated["step"], height=height, **settings)
    frozen = trace_support_region(stance, min(FROZEN_GAP, stated["tolerance"]), **settings)
    keys = verdict_keys(check_equilibrium(stance, **settings), stance)
    return keys | {
        "status": "solved",
        "com_margin": agree(frozen.com_margin, keys["verdict"]),
        "region": frozen.as_record(),
        "following": following.as_record(),
        "handovers": keys["handovers"] + frozen.handovers + following.handovers,
    }


ANSWER = Answer(FollowingRegionParameters, answer, RECORD_KEYS | REGION_KEYS | FOLLOWING_KEYS)
