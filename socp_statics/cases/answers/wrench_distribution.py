"""``model = "wrench_distribution"``: the contact wrenches of one method, or of all of them side by side."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import Field, ValidationInfo, model_validator

from socp_statics.cases.answers.answer import BY_CONTACT, BY_JOINT, RECORD_KEYS, VECTOR, Answer, Parameters, contact_names
from socp_statics.cases.answers.equilibrium import verdict_keys
from socp_statics.exceptions import InputError
from socp_statics.registry import nearest

if TYPE_CHECKING:
    from socp_statics.cases.problem import Problem
    from socp_statics.contacts import Stance
    from socp_statics.optimization.wrench_distribution import Distribution

CLOSED = ("pseudoinverse", "scaled_pseudoinverse", "friction_weighted", "statics_consistent", "barycentric")
ALL = "all"
Method = Literal[
    "all", "pseudoinverse", "scaled_pseudoinverse", "friction_weighted", "statics_consistent", "barycentric", "qp", "least_squares",
    "minimax",
]  # fmt: skip
Reference = Annotated[list[float], Field(min_length=3, max_length=6, description="a force of 3 or a wrench of 6 finite numbers [N, N m]")]
Point = Annotated[list[float], Field(min_length=2, max_length=2, description="two finite numbers [m], in the contact plane")]
METHOD_KEYS: dict[str, Any] = {
    "status": None,
    "note": None,
    "objective": None,
    "normal_force": {BY_CONTACT: None},
    "normal_share": {BY_CONTACT: None},
    "cop": {BY_CONTACT: VECTOR},
    "friction_use": {BY_CONTACT: None},
    "reserve": None,
    "cone_violation": None,
    "inside": None,
    "worst_joint": None,
    "worst_torque": None,
    "worst_share": None,
    "torques": {BY_JOINT: None},
    "internal_forces": [{"between": [None], "force": None}],
    "balance": None,
    "wrenches": RECORD_KEYS["wrenches"],
}


class WrenchDistributionParameters(Parameters):
    """``[parameters]`` of a wrench distribution."""

    method: Method = Field(
        "all",
        description="'all', 'pseudoinverse', 'scaled_pseudoinverse', 'friction_weighted', 'statics_consistent', 'barycentric', 'qp', "
        "'least_squares' or 'minimax'",
    )
    friction_exponent: float = Field(2.0, gt=0, description="a finite number > 0: weights mu^-exponent on friction components")
    cop_weight: float = Field(1.0, ge=0, description="a finite number >= 0")
    cops: dict[str, Point] | None = Field(None, description="a table of contact = [x, y] in the contact plane [m]")
    references: dict[str, Reference] | None = Field(
        None, description="a table of contact = [fx, fy, fz] or [fx, fy, fz, mx, my, mz] about it, world axes [N, N m]"
    )

    @model_validator(mode="after")
    def _names_are_contacts(self, info: ValidationInfo) -> Self:
        known = contact_names(info)
        for key in ("cops", "references"):
            for name in getattr(self, key) or {}:
                if known is not None and name not in known:
                    raise InputError(f"{key} names {name!r}, which is no contact{nearest(name, known)}", field=key)
        for name, value in (self.references or {}).items():
            if len(value) not in (3, 6):
                message = f"references of {name!r}: a force of 3 or a wrench of 6 numbers is expected, got {len(value)}"
                raise InputError(message, field="references")
        if self.references and self.method not in (*CLOSED, ALL):
            raise InputError(f"references go with methods in closed form, not with {self.method!r}", field="references")
        if self.cops and self.method not in ("qp", ALL):
            raise InputError(f"cops go with the method 'qp', not with {self.method!r}", field="cops")
        return self


def method_keys(found: Distribution) -> dict[str, Any]:
    """The record's entry of one method."""
    keys: dict[str, Any] = {"status": found.status, "note": found.note}
    measures = found.measures
    if measures is None or found.wrenches_W is None:
        return keys
    by_contact = zip(found.contacts, found.wrenches_W, strict=True)
    wrenches = [{"contact": name, "force": F[:3].tolist(), "moment": F[3:].tolist()} for name, F in by_contact]
    return keys | {
        "objective": found.objective,
        "normal_force": measures.normal_force,
        "normal_share": measures.normal_share,
        "cop": measures.cop,
        "friction_use": measures.friction_use,
        "reserve": measures.reserve,
        "cone_violation": measures.cone_violation,
        "inside": measures.inside,
        "worst_joint": measures.worst_joint,
        "worst_torque": measures.worst_torque,
        "worst_share": measures.worst_share,
        "torques": measures.torques,
        "internal_forces": [{"between": pair.split(" - "), "force": force} for pair, force in measures.internal_forces.items()],
        "balance": found.balance,
        "wrenches": wrenches,
    }


def answer(problem: Problem, stance: Stance, engine: str | Sequence[str]) -> dict[str, Any]:
    """The distributions; verdict, margin, certificate and forces are those of the stance, of a program its own forces.

    Args:
        problem: Its parameters.
        stance: Its stance.
        engine: "auto", the name of an engine, or several to be tried in turn.
    """
    # the answers are listed and problems validated without a solver: it is imported when one is solved
    from socp_statics.optimization.wrench_distribution import compare_distributions

    stated = problem.parameters
    compared = compare_distributions(
        stance,
        None if stated["method"] == ALL else [stated["method"]],
        references=stated.get("references"),
        friction_exponent=stated["friction_exponent"],
        cop_weight=stated["cop_weight"],
        cops=stated.get("cops"),
        cone=problem.cone,
        form=stated["form"],
        engine=engine,
    )
    keys = verdict_keys(compared.equilibrium, stance) | {"status": "solved"}
    methods = {name: method_keys(found) for name, found in compared.methods.items()}
    if all(found.status != "solved" for found in compared.methods.values()):
        keys["status"] = "infeasible"
    alone = compared.methods.get(stated["method"])
    if alone is not None:
        keys["objective"] = alone.objective
        if alone.forces is not None and alone.measures is not None:
            keys |= {"wrenches": alone.forces.wrenches(), "forces": alone.forces.entries()}
            keys |= {"torques": alone.measures.torques} if stance.posture is not None else {}
    balances = [keys["residuals"]["balance"], *(found.balance for found in compared.methods.values())]
    return keys | {
        "residuals": keys["residuals"] | {"balance": max(balances)},
        "distribution": {"method": stated["method"], "methods": methods},
    }


DISTRIBUTION_KEYS: dict[str, Any] = {
    "objective": None,
    "distribution": {"method": None, "methods": {name: METHOD_KEYS for name in (*CLOSED, "qp", "least_squares", "minimax")}},
}
ANSWER = Answer(WrenchDistributionParameters, answer, RECORD_KEYS | DISTRIBUTION_KEYS, follows_com=True)
