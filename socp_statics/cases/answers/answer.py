"""What the answer to every model declares: its parameters, the keys of its records, and how it is computed."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal, Self

from pydantic import Field, ValidationInfo, field_validator, model_validator

from socp_statics.cases.statement import Statement
from socp_statics.cones.choice import ConeChoice
from socp_statics.contacts.contact import COMPONENTS
from socp_statics.exceptions import InputError

if TYPE_CHECKING:
    from socp_statics.cases.problem import Problem
    from socp_statics.contacts import Stance

BY_CONTACT, BY_JOINT = "*", "* joint"
VECTOR: list[Any] = [None]
CONFIGURATION_KEYS: dict[str, Any] = {"angles": {BY_JOINT: None}, "base": {"position": VECTOR, "rotation": [VECTOR]}}
_ENDS = {"lower": None, "upper": None, "equal": None}
PRICE_KEYS: dict[str, Any] = {
    "value": None,
    "unit": None,
    "friction": {BY_CONTACT: None},
    "torsional_friction": {BY_CONTACT: None},
    "normal_force": {BY_CONTACT: _ENDS},
    "handle_limits": {BY_CONTACT: {word: _ENDS for word in COMPONENTS}},
    "torque_limits": {BY_JOINT: _ENDS},
    "displacement": {BY_CONTACT: VECTOR},
    "stopped_by": [{"what": None, "price": None, "per": None}],
    "unique": None,
    "not_unique": [None],
}
RECORD_KEYS: dict[str, Any] = {
    "schema": None,
    "problem": None,
    "model": None,
    "hash": None,
    "status": None,
    "verdict": None,
    "reason": None,
    "cone": {"kind": None, "sides": None, "heading": None},
    "margin": None,
    "idle": [None],
    "idle_margin": None,
    "case": {
        "generated": {
            "contacts": [{"position": VECTOR, "rotation": [VECTOR], "friction": None, "vertices": [VECTOR]}],
            "com": VECTOR,
            "mass": None,
            "angles": {BY_JOINT: None},
        }
    },
    "wrenches": [{"contact": None, "force": VECTOR, "moment": VECTOR}],
    "forces": [{"contact": None, "point": VECTOR, "force": VECTOR, "moment": VECTOR}],
    "torques": {BY_JOINT: None},
    "torque_limits": {BY_JOINT: VECTOR},
    "certificate": {
        "kind": None,
        "linear": VECTOR,
        "angular": VECTOR,
        "point": VECTOR,
        "joints": {BY_JOINT: None},
        "power": None,
        "reading": None,
        "contacts": {BY_CONTACT: None},
    },
    "prices": {"margin": PRICE_KEYS, "shortfall": PRICE_KEYS},
    "residuals": {"balance": None, "cone": None, "gap": None},
    "engine": None,
    "handovers": None,
}


class Parameters(Statement):
    """``[parameters]`` that every model takes."""

    cone: Literal["exact", "inscribed", "circumscribed"] = Field("exact", description="'exact', 'inscribed' or 'circumscribed'")
    sides: int | None = Field(None, ge=3, description="a whole number >= 3")
    heading: float | None = Field(None, description="a finite number [rad]")
    form: Literal["socp", "sdp"] = Field("socp", description="'socp' or 'sdp'")
    torque_limits: bool = Field(False, description="true or false")

    @field_validator("torque_limits")
    @classmethod
    def _needs_a_robot(cls, value: bool, info: ValidationInfo) -> bool:
        if value and joint_names(info) == ():
            raise InputError("torque limits need a robot, and this posture has none: false is expected")
        return value

    @model_validator(mode="after")
    def _is_a_cone(self) -> Self:
        self.cone_choice()
        return self

    def cone_choice(self) -> ConeChoice:
        """The friction cone or pyramid."""
        return ConeChoice(self.cone, self.sides, self.heading)

    def stated(self) -> dict[str, Any]:
        """The parameters with defaults filled in, those of the pyramid where there is one."""
        chosen = self.cone_choice()
        pyramid = {} if chosen.kind == "exact" else {"sides": chosen.sides, "heading": chosen.heading}
        return super().stated() | pyramid


@dataclass(frozen=True)
class Many:
    """How many problems of one model are answered by one call.

    Attributes:
        kind: ``(problem, engine) -> Any``: what problems have to have in common, None for one that is answered alone.
        compute: ``(problems, stances, engine) -> list``: for each what `Answer.compute` gives it, to the last bit.
    """

    kind: Callable[[Problem, str | Sequence[str]], Any]
    compute: Callable[[Sequence[Problem], Sequence[Stance], str | Sequence[str]], list[dict[str, Any]]]


@dataclass(frozen=True)
class Answer:
    """One model of the contract.

    Attributes:
        parameters: The class of its ``[parameters]``.
        compute: ``(problem, stance, engine) -> dict`` of the model's record keys; an answer about many stances adds under
            ``"stance"`` the one its forces and certificate belong to.
        record_keys: The keys its records can have, nested; a list holds what its entries hold, `BY_CONTACT` and
            `BY_JOINT` stand for names.
        follows_com: Whether `compute` asks about the stance it is given and nothing else, and fast enough to follow a centre of mass
            that somebody drags about.
        shown: ``(problem, record) -> stance`` that the forces of a record belong to, where it is not that of the problem.
        many: How many problems are answered by one call, where that is possible.
    """

    parameters: type[Parameters]
    compute: Callable[[Problem, Stance, str | Sequence[str]], dict[str, Any]]
    record_keys: dict[str, Any] = field(default_factory=lambda: RECORD_KEYS)
    follows_com: bool = False
    shown: Callable[[Problem, Mapping[str, Any]], Stance] | None = None
    many: Many | None = None


def contact_names(info: ValidationInfo) -> tuple[str, ...] | None:
    """Names of the contacts of the problem whose parameters are validated, None where they are not known."""
    return (info.context or {}).get("contacts")


def joint_names(info: ValidationInfo) -> tuple[str, ...] | None:
    """Names of the joints of the robot, empty without a robot, None where they are not known."""
    return (info.context or {}).get("joints")
