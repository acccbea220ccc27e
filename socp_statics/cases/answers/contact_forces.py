"""``model = "contact_forces"``: the best of the contact forces that balance the load."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import Field, ValidationInfo, model_validator

from socp_statics.cases.answers.answer import RECORD_KEYS, Answer, Parameters, contact_names, joint_names
from socp_statics.cases.answers.equilibrium import torque_keys, verdict_keys
from socp_statics.cases.dotted import key_text
from socp_statics.cases.statement import Vector3
from socp_statics.exceptions import InputError
from socp_statics.registry import nearest

if TYPE_CHECKING:
    from socp_statics.cases.problem import Problem
    from socp_statics.contacts import Stance
    from socp_statics.optimization import ForceAnswer


Rate = Annotated[float, Field(description="a finite number [rad/s]")]


class ContactForcesParameters(Parameters):
    """``[parameters]`` of a force optimisation."""

    objective: Literal["least_squares", "normal_force", "reference", "orin_oh"] = Field(
        "least_squares", description="'least_squares', 'normal_force', 'reference' or 'orin_oh'"
    )
    reference_forces: dict[str, Vector3] | None = Field(
        None, description="a table of contact = [fx, fy, fz], finite numbers [N], world axes"
    )
    rates: dict[str, Rate] | None = Field(None, description="a table of joint = rate [rad/s]")
    b: float | None = Field(None, ge=0, description="a finite number >= 0 [m/s]")

    @model_validator(mode="after")
    def _reference_is_complete(self, info: ValidationInfo) -> Self:
        wanted = self.objective == "reference"
        if wanted and not self.reference_forces:
            raise InputError("reference_forces is missing, objective 'reference' needs it", field="reference_forces")
        if self.reference_forces and not wanted:
            raise InputError(f"reference_forces goes with objective 'reference', not with {self.objective!r}", field="reference_forces")
        known = contact_names(info)
        for name in self.reference_forces or {}:
            if known is not None and name not in known:
                raise InputError(f"reference_forces names {name!r}, which is no contact{nearest(name, known)}", field="reference_forces")
        return self

    @model_validator(mode="after")
    def _rates_are_of_joints(self, info: ValidationInfo) -> Self:
        for key in ("rates", "b"):
            if getattr(self, key) is not None and self.objective != "orin_oh":
                raise InputError(f"{key} goes with objective 'orin_oh', not with {self.objective!r}", field=key)
        joints = joint_names(info)
        if self.rates is not None and joints == ():
            raise InputError("rates need a robot, and this posture has none", field="rates")
        for joint in self.rates or {}:
            if joints is not None and joint not in joints:
                message = f"rates names {joint!r}, which is no joint of the robot{nearest(joint, joints)}"
                raise InputError(message, field=key_text(("rates", joint)))
        return self

    def stated(self) -> dict[str, Any]:
        """The parameters with defaults filled in; without ``rates`` every joint counts with 1 rad/s."""
        weight = {"b": 1.0 if self.b is None else self.b} if self.objective == "orin_oh" else {}
        return super().stated() | weight


def force_answer_keys(found: ForceAnswer, stance: Stance) -> dict[str, Any]:
    """The record keys of an optimised choice of forces: the verdict's, with the optimal forces in place of the certificate's.

    Args:
        found: Of `socp_statics.optimization`.
        stance: Its stance.
    """
    keys = verdict_keys(found.equilibrium, stance)
    return keys | {
        "status": found.status,
        "objective": found.objective,
        "wrenches": [] if found.forces is None else found.forces.wrenches(),
        "forces": [] if found.forces is None else found.forces.entries(),
        **torque_keys(found, stance),
        "residuals": dict(found.residuals),
        "engine": found.engine,
        "handovers": found.handovers,
    }


def answer(problem: Problem, stance: Stance, engine: str | Sequence[str]) -> dict[str, Any]:
    """The forces with the least objective.

    Args:
        problem: Its parameters.
        stance: Its stance.
        engine: "auto", the name of an engine, or several to be tried in turn.
    """
    # the answers are listed and problems validated without a solver: it is imported when one is solved
    from socp_statics.optimization import optimise_contact_forces

    stated = problem.parameters
    found = optimise_contact_forces(
        stance,
        stated["objective"],
        reference_forces=stated.get("reference_forces"),
        rates=stated.get("rates"),
        b=stated.get("b"),
        cone=problem.cone,
        form=stated["form"],
        engine=engine,
    )
    return force_answer_keys(found, stance)


ANSWER = Answer(ContactForcesParameters, answer, RECORD_KEYS | {"objective": None}, follows_com=True)
