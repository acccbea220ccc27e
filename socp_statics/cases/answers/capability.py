"""``model = "capability"``: the largest payload at a point, or the largest push, that contacts and motors allow."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Self

from pydantic import Field, ValidationInfo, field_validator, model_validator

from socp_statics.cases.answers.answer import BY_JOINT, PRICE_KEYS, RECORD_KEYS, VECTOR, Answer, Parameters, joint_names
from socp_statics.cases.answers.equilibrium import price_keys, verdict_keys
from socp_statics.cases.statement import Statement, Vector3
from socp_statics.exceptions import InputError

if TYPE_CHECKING:
    from socp_statics.cases.problem import Problem
    from socp_statics.contacts import Stance
    from socp_statics.optimization import CapabilityAnswer

LOADS = ("payload", "push")


class PayloadStatement(Statement):
    """``payload = { link = "...", point = [x, y, z] }``: where it hangs."""

    link: str | None = Field(None, min_length=1, description="the name of a link or frame of the robot")
    point: Vector3 | None = Field(None, description="three finite numbers [m], world axes")


class PushStatement(PayloadStatement):
    """``push = { link = "...", point = [x, y, z], direction = [x, y, z] }``: where and along what it acts on the robot."""

    direction: Vector3 = Field(description="three finite numbers, not all zero, world axes")

    @field_validator("direction")
    @classmethod
    def _is_a_direction(cls, value: list[float]) -> list[float]:
        if not any(value):
            raise InputError("a direction that is not zero is expected, got [0, 0, 0]")
        return value


class CapabilityParameters(Parameters):
    """``[parameters]`` of a capability: exactly one load."""

    payload: PayloadStatement | None = Field(None, description='a table { link = "...", point = [x, y, z] }')
    push: PushStatement | None = Field(None, description='a table { link = "...", point = [x, y, z], direction = [x, y, z] }')

    @model_validator(mode="after")
    def _is_one_load(self, info: ValidationInfo) -> Self:
        given = [key for key in LOADS if getattr(self, key) is not None]
        if len(given) != 1:
            raise InputError(f"exactly one of payload and push is expected, got {' and '.join(given) or 'neither'}", field="payload")
        load: PayloadStatement = getattr(self, given[0])
        if joint_names(info) == ():
            if load.link is not None:
                raise InputError(f"a link needs a robot, and this posture has none: got {load.link!r}", field=f"{given[0]}.link")
            if load.point is None:
                raise InputError("is missing: without a robot the load needs the point [x, y, z] where it acts", field=f"{given[0]}.point")
        return self


def capability_keys(found: CapabilityAnswer) -> dict[str, Any]:
    """The record's ``capability``: the load, and everything at its limit."""
    load, forces, growth = found.load, found.forces, found.growth
    return {
        "kind": load.kind,
        "unit": load.unit,
        "link": load.link,
        "point": load.point,
        "direction": load.direction,
        "newtons": load.newtons,
        "wrenches": [] if forces is None else forces.wrenches(),
        "forces": [] if forces is None else forces.entries(),
        "torques": dict(found.torques or {}),
        "beyond": None if found.beyond is None else found.beyond.as_record(),
        "growth": [] if growth is None else growth.entries(),
    }


def answer(problem: Problem, stance: Stance, engine: str | Sequence[str]) -> dict[str, Any]:
    """The largest load with its forces and what stops more; verdict, margin, forces and certificate are those without the load.

    Args:
        problem: Its parameters.
        stance: Its stance.
        engine: "auto", the name of an engine, or several to be tried in turn.
    """
    # the answers are listed and problems validated without a solver: it is imported when one is solved
    from socp_statics.optimization import largest_load, unit_load

    stated = problem.parameters
    kind = next(key for key in LOADS if key in stated)
    where = stated[kind]
    load = unit_load(stance, kind, where.get("link"), where.get("point"), where.get("direction"))
    found = largest_load(stance, load, cone=problem.cone, form=stated["form"], engine=engine)
    keys = verdict_keys(found.equilibrium, stance)
    return keys | {
        "status": found.status,
        "objective": found.objective,
        "capability": capability_keys(found),
        "prices": keys["prices"] | price_keys(found.prices),
        "residuals": dict(found.residuals),
        "engine": found.engine,
        "handovers": found.handovers,
    }


_FORCES: dict[str, Any] = {key: RECORD_KEYS[key] for key in ("wrenches", "forces")}
CAPABILITY_KEYS: dict[str, Any] = {
    "objective": None,
    "capability": {
        "kind": None,
        "unit": None,
        "link": None,
        "point": VECTOR,
        "direction": VECTOR,
        "newtons": None,
        **_FORCES,
        "torques": {BY_JOINT: None},
        "beyond": RECORD_KEYS["certificate"],
        "growth": _FORCES["forces"],
    },
    "prices": RECORD_KEYS["prices"] | {"payload": PRICE_KEYS, "push": PRICE_KEYS},
}
ANSWER = Answer(CapabilityParameters, answer, RECORD_KEYS | CAPABILITY_KEYS, follows_com=True)
