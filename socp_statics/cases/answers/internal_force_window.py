"""``model = "internal_force_window"``: how much internal force keeps every contact in its cone and every torque in its limit."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import Field, ValidationInfo, model_validator

from socp_statics.cases.answers.answer import RECORD_KEYS, VECTOR, Answer, Parameters, contact_names
from socp_statics.cases.answers.equilibrium import verdict_keys
from socp_statics.exceptions import InputError
from socp_statics.registry import nearest

if TYPE_CHECKING:
    from socp_statics.cases.problem import Problem
    from socp_statics.contacts import Stance
    from socp_statics.optimization.internal_force_window import InternalForceWindow
    from socp_statics.optimization.window_programs import WindowEnd

Wrench = Annotated[list[float], Field(min_length=3, max_length=6, description="a force of 3 or a wrench of 6 finite numbers")]
Direction = list[str] | dict[str, Wrench]
END_KEYS: dict[str, Any] = {"value": None, "stopped_by": [None], "wrenches": RECORD_KEYS["wrenches"]}
WINDOW_KEYS: dict[str, Any] = {
    "objective": None,
    "window": {
        "kind": None,
        "lower": END_KEYS,
        "upper": END_KEYS,
        "width": None,
        "others": None,
        "particular": RECORD_KEYS["wrenches"],
        "set": {"inner": [VECTOR], "outer": [VECTOR], "inner_area": None, "relative_gap": None, "solves": None},
    },
}


class InternalForceWindowParameters(Parameters):
    """``[parameters]`` of an internal-force window."""

    directions: Annotated[list[Direction], Field(min_length=1, max_length=2)] = Field(
        description="one or two directions: pairs of contacts, or tables of contact = [fx, fy, fz] or [fx, fy, fz, mx, my, mz]"
    )
    particular: Literal["pseudoinverse", "scaled_pseudoinverse", "friction_weighted", "statics_consistent", "barycentric"] = Field(
        "barycentric", description="'pseudoinverse', 'scaled_pseudoinverse', 'friction_weighted', 'statics_consistent' or 'barycentric'"
    )
    others: Literal["fixed", "free"] = Field("fixed", description="'fixed' or 'free'")
    tolerance: float = Field(1e-3, gt=0, lt=1, description="a finite number between 0 and 1")

    @model_validator(mode="after")
    def _names_are_contacts(self, info: ValidationInfo) -> Self:
        known = contact_names(info)
        for direction in self.directions:
            if isinstance(direction, list) and len(direction) != 2:
                raise InputError(f"directions: a pair of contacts is expected, got {direction!r}", field="directions")
            for name in direction:
                if known is not None and name not in known:
                    raise InputError(f"directions names {name!r}, which is no contact{nearest(name, known)}", field="directions")
        return self


def _wrenches(contacts: Sequence[str], wrenches: Any) -> list[dict[str, Any]]:
    return [{"contact": name, "force": F[:3].tolist(), "moment": F[3:].tolist()} for name, F in zip(contacts, wrenches, strict=True)]


def _end(end: WindowEnd | None, contacts: Sequence[str]) -> dict[str, Any] | None:
    if end is None:
        return None
    wrenches = [] if end.wrenches_W is None else _wrenches(contacts, end.wrenches_W)
    return {"value": end.value, "stopped_by": list(end.stopped_by), "wrenches": wrenches}


def window_keys(found: InternalForceWindow, contacts: Sequence[str]) -> dict[str, Any]:
    """The record's ``window``."""
    keys: dict[str, Any] = {
        "kind": found.kind,
        "lower": _end(found.lower, contacts),
        "upper": _end(found.upper, contacts),
        "width": found.width,
        "others": found.others,
        "particular": [] if found.particular_W is None else _wrenches(contacts, found.particular_W),
    }
    if found.set is not None:
        s = found.set
        keys["set"] = {"inner": s.inner, "outer": s.outer, "inner_area": s.inner_area, "relative_gap": s.relative_gap, "solves": s.solves}
    return keys


def answer(problem: Problem, stance: Stance, engine: str | Sequence[str]) -> dict[str, Any]:
    """The window; verdict, margin, certificate and forces are those of the stance.

    Args:
        problem: Its parameters.
        stance: Its stance.
        engine: "auto", the name of an engine, or several to be tried in turn.
    """
    # the answers are listed and problems validated without a solver: it is imported when one is solved
    from socp_statics.optimization.internal_force_window import internal_force_window

    stated = problem.parameters
    found = internal_force_window(
        stance,
        stated["directions"],
        particular=stated["particular"],
        others=stated["others"],
        tolerance=stated["tolerance"],
        cone=problem.cone,
        form=stated["form"],
        engine=engine,
    )
    keys = verdict_keys(found.equilibrium, stance)
    return keys | {"status": "solved", "objective": found.width, "window": window_keys(found, stance.contacts.names)}


ANSWER = Answer(InternalForceWindowParameters, answer, RECORD_KEYS | WINDOW_KEYS, follows_com=True)
