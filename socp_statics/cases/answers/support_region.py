"""``model = "support_region"``: where the CoM may be, and the verdict, margin and certificate where it is."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from pydantic import Field

from socp_statics.cases.answers.answer import BY_JOINT, PRICE_KEYS, RECORD_KEYS, VECTOR, Answer, Many
from socp_statics.cases.answers.equilibrium import friction_only, price_keys, verdict_keys
from socp_statics.cases.answers.safety import SAFETY_KEYS, SafetyParameters, safety_verdict

if TYPE_CHECKING:
    from socp_statics.cases.problem import Problem
    from socp_statics.contacts import Stance
    from socp_statics.regions import SupportRegion
    from socp_statics.stability import EquilibriumAnswer

REGION_KEYS: dict[str, Any] = {
    "com_margin": None,
    "region": {
        "posture": None,
        "kind": None,
        "inner": [VECTOR],
        "outer": [VECTOR],
        "inner_area": None,
        "outer_area": None,
        "relative_gap": None,
        "rays": [VECTOR],
        "solves": None,
        "widened": None,
        "points": [{"contact": None, "point": VECTOR}],
        "inner_forces": [None],
        "outer_multipliers": [None],
        "outer_joint_rates": [{BY_JOINT: None}],
    },
    "prices": RECORD_KEYS["prices"] | {"com_margin": PRICE_KEYS},
}


class SupportRegionParameters(SafetyParameters):
    """``[parameters]`` of a support region."""

    prices: bool | None = Field(None, description="true or false: whether the record says what friction, limits and places are worth")
    tolerance: float = Field(1e-3, gt=0, lt=1, description="a number > 0 and < 1: (outer area - inner area) / outer area")


def agree(com_margin: float | None, verdict: str) -> float | None:
    """The CoM margin with a sign that does not contradict the verdict, which is the sharper of the two.

    Args:
        com_margin: Distance to the edge of the region, negative outside, None if the region is empty [m].
        verdict: Of the stance.
    """
    if com_margin is None or verdict == "undecided":
        return com_margin
    return max(com_margin, 0.0) if verdict == "stable" else min(com_margin, 0.0)


def answer(problem: Problem, stance: Stance, engine: str | Sequence[str]) -> dict[str, Any]:
    """The region with its certificates, and the verdict at the posture's CoM.

    Args:
        problem: Its parameters.
        stance: Its stance.
        engine: "auto", the name of an engine, or several to be tried in turn.
    """
    from socp_statics.regions import trace_support_region
    from socp_statics.stability import check_equilibrium

    settings = {"cone": problem.cone, "form": problem.parameters["form"], "engine": engine}
    region = trace_support_region(stance, problem.parameters["tolerance"], **settings)
    return _keys(problem, stance, engine, region, check_equilibrium(stance, **settings))


def answers(problems: Sequence[Problem], stances: Sequence[Stance], engine: str | Sequence[str]) -> list[dict[str, Any]]:
    """What `answer` says of many problems with the same parameters.

    Args:
        problems: The problems.
        stances: Their stances.
        engine: "auto", the name of an engine, or several to be tried in turn.
    """
    from socp_statics.regions import trace_support_regions
    from socp_statics.stability.equilibrium import check_equilibria

    cone, stated = problems[0].cone, problems[0].parameters
    regions = trace_support_regions(stances, stated["tolerance"], cone=cone, form=stated["form"], engine=engine)
    found = check_equilibria(stances, cone, stated["form"], engine)
    return [_keys(p, s, engine, region, one) for p, s, region, one in zip(problems, stances, regions, found, strict=True)]


def _keys(
    problem: Problem, stance: Stance, engine: str | Sequence[str], region: SupportRegion, found: EquilibriumAnswer
) -> dict[str, Any]:
    from socp_statics.regions import com_margin_prices

    stated = problem.parameters
    priced = stated.get("prices", True)
    keys = verdict_keys(found, stance, priced)
    com_margin = agree(region.com_margin, keys["verdict"])
    prices = com_margin_prices(stance, region, form=stated["form"], engine=engine) if priced else None
    keys |= {
        "status": "solved",
        "com_margin": com_margin,
        "region": region.as_record(),
        "prices": keys["prices"] | price_keys(prices),
        "engine": region.engine if region.handovers else keys["engine"],
        "handovers": keys["handovers"] + region.handovers,
    }
    if "safety" in stated:
        keys["safety"] = safety_verdict(stance, com_margin, stated["safety"])
    return keys


ANSWER = Answer(
    SupportRegionParameters, answer, RECORD_KEYS | REGION_KEYS | SAFETY_KEYS, many=Many(friction_only, answers)
)
