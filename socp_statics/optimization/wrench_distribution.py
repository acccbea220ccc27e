"""Wrench distribution by any method, and what each does to friction, centre of pressure and torque (3.5.4, 5.10.4, 5.14)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from socp_statics.cones.choice import ConeChoice, cone_choice
from socp_statics.contacts import Stance
from socp_statics.contacts.stance import stance_of
from socp_statics.distribution.closed_form import CLOSED_FORMS, closed_forms
from socp_statics.distribution.closed_loops import closure_wrench
from socp_statics.distribution.distributions import load_reaction, question_of, wrenches_C
from socp_statics.distribution.general_solution import OutOfReachError
from socp_statics.distribution.given_wrenches import distribute_around
from socp_statics.distribution.scaled_question import DistributionQuestion
from socp_statics.exceptions import EngineError, InputError
from socp_statics.optimization.contact_forces import optimise_contact_forces
from socp_statics.optimization.force_answer import ForceAnswer
from socp_statics.optimization.minimax_wrench import minimise_largest_wrench
from socp_statics.optimization.wrench_measures import Measures, measures_of
from socp_statics.optimization.wrench_quadratic import distribute_by_quadratic_program
from socp_statics.registry import nearest
from socp_statics.spatial import Array
from socp_statics.stability import EquilibriumAnswer, check_equilibrium
from socp_statics.statics import PointForces, assemble

PROGRAMS = {
    "qp": "the quadratic program of Section 5.14: small wrenches and centred pressure inside exact cones",
    "least_squares": "least sum of squares of the point forces inside exact cones",
    "minimax": "least largest point force inside exact cones",
}
METHODS: dict[str, str] = {**{name: form.line for name, form in CLOSED_FORMS.items()}, **PROGRAMS}


@dataclass(frozen=True, eq=False)
class Distribution:
    """One distribution of a stance's load.

    Attributes:
        method: Its name.
        status: "solved"; "infeasible" where no forces, or none inside the cones, balance; "unsuitable" where the method does not apply.
        note: Why it is unsuitable, or what was not met; empty otherwise.
        contacts: Names of the contacts.
        wrenches_W: ``[force; moment]`` about each contact's position, world axes, shape (k, 6) [N, N m]; None unless solved.
        wrenches_C: The same in contact frames.
        balance: Largest share of W missing from the balance.
        measures: What the wrenches do to the contacts and joints; None unless solved.
        objective: Of a program, as it defines it; None of a closed form.
        forces: The point forces of a program, None of a closed form.
    """

    method: str
    status: str
    note: str
    contacts: tuple[str, ...]
    wrenches_W: Array | None = None
    wrenches_C: Array | None = None
    balance: float = 0.0
    measures: Measures | None = None
    objective: float | None = None
    forces: PointForces | None = field(default=None, repr=False)

    @property
    def holds(self) -> bool:
        """Whether the wrenches are inside their cones, to 1e-7 of the load."""
        return self.measures is not None and self.measures.inside


@dataclass(frozen=True, eq=False)
class ComparedDistributions:
    """Distributions of one stance by several methods.

    Attributes:
        methods: By name, in the order asked.
        equilibrium: Verdict, margin and certificate of the stance.
    """

    methods: Mapping[str, Distribution]
    equilibrium: EquilibriumAnswer

    def __getitem__(self, method: str) -> Distribution:
        return self.methods[method]


def distribute(
    stance: Any,
    method: str = "barycentric",
    *,
    references: Mapping[str, Any] | None = None,
    friction_exponent: float = 2.0,
    cop_weight: float = 1.0,
    cops: Mapping[str, Any] | None = None,
    cone: str | ConeChoice = "exact",
    sides: int | None = None,
    heading: float | None = None,
    form: str = "socp",
    engine: str | Sequence[str] = "auto",
    torque_limits: bool | Mapping[str, Any] = False,
) -> Distribution:
    """The contact wrenches of a stance by one method.

    Args:
        stance: A Stance or a Posture.
        method: "pseudoinverse", "scaled_pseudoinverse", "friction_weighted", "statics_consistent", "barycentric" in closed form;
            "qp", "least_squares", "minimax" inside the cones.
        references: Of closed forms: contacts whose wrench is given, a force (3) or wrench (6) in world axes about the contact [N, N m].
        friction_exponent: Of "friction_weighted": weights mu^-1 or mu^-2 on f_x, f_y, m_z.
        cop_weight: Of "qp": weight of the distance of the centres of pressure from where they are wished.
        cops: Of "qp": wished centres of pressure by contact, in the contact plane, shape (2,) [m]; the middle of the sole by default.
        cone: Of programs and of what is judged: "exact", "inscribed" or "circumscribed", or a ConeChoice.
        sides: Sides of the pyramids.
        heading: Heading of the pyramids [rad].
        form: "socp" or "sdp".
        engine: "auto", the name of an engine, or several to be tried in turn.
        torque_limits: Whether programs have to respect joint-torque limits: the robot's own, or a mapping of limits.

    Returns:
        The distribution; infeasible where the contacts cannot balance the load whatever their cones, its note says in which directions.

    Raises:
        InputError: An unknown method, one that does not suit the contacts, or references that do not fit.
        EngineError: No engine settled a program.
    """
    _refuse_unknown(method)
    options = {"references": references, "friction_exponent": friction_exponent, "cop_weight": cop_weight, "cops": cops}
    settings = {"cone": cone_choice(cone, sides, heading), "form": form, "engine": engine}
    question = _Question(stance_of(stance, torque_limits=torque_limits), options, settings)
    return question.by(method, refuse=True)


def compare_distributions(
    stance: Any,
    methods: Sequence[str] | None = None,
    *,
    references: Mapping[str, Any] | None = None,
    friction_exponent: float = 2.0,
    cop_weight: float = 1.0,
    cops: Mapping[str, Any] | None = None,
    cone: str | ConeChoice = "exact",
    sides: int | None = None,
    heading: float | None = None,
    form: str = "socp",
    engine: str | Sequence[str] = "auto",
    torque_limits: bool | Mapping[str, Any] = False,
) -> ComparedDistributions:
    """The contact wrenches of a stance by several methods, side by side; arguments as of `distribute`.

    Args:
        stance: A Stance or a Posture.
        methods: Their names, all by default; one that does not suit the contacts is kept with the reason.
        references: As of `distribute`.
        friction_exponent: As of `distribute`.
        cop_weight: As of `distribute`.
        cops: As of `distribute`.
        cone: As of `distribute`.
        sides: As of `distribute`.
        heading: As of `distribute`.
        form: As of `distribute`.
        engine: As of `distribute`.
        torque_limits: As of `distribute`.

    Returns:
        The distributions with the verdict of the stance.

    Raises:
        InputError: An unknown method, or references that do not fit.
        EngineError: No engine settled a program.
    """
    names = list(METHODS) if methods is None else list(methods)
    for name in names:
        _refuse_unknown(name)
    choice = cone_choice(cone, sides, heading)
    posed = stance_of(stance, torque_limits=torque_limits)
    options = {"references": references, "friction_exponent": friction_exponent, "cop_weight": cop_weight, "cops": cops}
    question = _Question(posed, options, {"cone": choice, "form": form, "engine": engine})
    refuse = len(names) == 1
    found = {name: question.by(name, refuse=refuse) for name in names}
    return ComparedDistributions(found, check_equilibrium(posed, cone=choice, form=form, engine=engine))


def _refuse_unknown(method: Any) -> None:
    if not isinstance(method, str) or method not in METHODS:
        raise InputError(f"method {method!r} is not known{nearest(str(method), METHODS)}", name=str(method), field="method")


class _Question:
    """One stance, asked by several methods."""

    def __init__(self, stance: Stance, options: dict[str, Any], settings: dict[str, Any]):
        self.stance, self.settings = stance, settings
        self.references = options["references"] or {}
        self.exponent, self.cop_weight, self.cops = options["friction_exponent"], options["cop_weight"], options["cops"]
        self.data = assemble(stance)
        self.question: DistributionQuestion | None = None
        self.out_of_reach = ""
        try:
            self.question = question_of([stance], self.exponent)
        except OutOfReachError as error:
            self.out_of_reach = str(error)

    def by(self, method: str, refuse: bool) -> Distribution:
        """The distribution of a method; one that does not suit raises or says so."""
        reason = self._unsuitable(method)
        if reason is not None and refuse:
            raise InputError(f"method '{method}': {reason}", name=method, field="references" if "references" in reason else "method")
        if reason is not None:
            return Distribution(method, "unsuitable", reason, self.stance.contacts.names)
        if self.question is None:
            return self._infeasible(method, self.out_of_reach)
        return self._closed_form(method, self.question, refuse) if method in CLOSED_FORMS else self._program(method)

    def _infeasible(self, method: str, note: str) -> Distribution:
        return Distribution(method, "infeasible", note, self.stance.contacts.names)

    def _unsuitable(self, method: str) -> str | None:
        if method in PROGRAMS:
            return "it takes no references: closed forms do" if self.references else None
        if not load_reaction(self.stance, self.data.units.origin)[:3].any() and CLOSED_FORMS[method].by_lever:
            return "the load has no force, so there is no lever rule"
        if self.references and method == "statics_consistent":
            return None
        return CLOSED_FORMS[method].refusal(self.stance.contacts)

    def _closed_form(self, method: str, question: DistributionQuestion, refuse: bool) -> Distribution:
        note = ""
        if self.references:
            try:
                given = distribute_around(self.stance, method, self.references, self.exponent)
            except OutOfReachError as error:
                return self._infeasible(method, f"with the references met, {error}")
            except InputError as error:
                if error.field != "method" or refuse:
                    raise
                return Distribution(method, "unsuitable", str(error), self.stance.contacts.names)
            components = given.components
            if not given.met:
                note = f"references missed by {given.missed:.3g}: the other contacts do not make up for {given.words}"
        else:
            components = closed_forms(question, [method])[method][0]
        return self._judged(Distribution(method, "solved", note, self.stance.contacts.names), wrenches_C(self.stance.contacts, components))

    def _program(self, method: str) -> Distribution:
        answer: ForceAnswer
        if method == "qp":
            answer = distribute_by_quadratic_program(self.stance, self.data, self.cop_weight, self.cops, **self.settings)
        elif method == "least_squares":
            answer = optimise_contact_forces(self.stance, "least_squares", **self.settings)
        else:
            answer = minimise_largest_wrench(self.stance, "force", "point", **self.settings)
        if answer.forces is None:
            return self._infeasible(method, "no forces inside the cones balance the load")
        entries = answer.forces.wrenches()
        W = np.array([[*entry["force"], *entry["moment"]] for entry in entries])
        turned = np.array([np.kron(np.eye(2), c.rotation.T) @ F for c, F in zip(self.stance.contacts, W, strict=True)])
        found = Distribution(method, "solved", "", self.stance.contacts.names, objective=answer.objective, forces=answer.forces)
        return self._judged(found, turned)

    def _judged(self, found: Distribution, local: Array) -> Distribution:
        contacts = self.stance.contacts
        world = np.array([np.kron(np.eye(2), c.rotation) @ F for c, F in zip(contacts, local, strict=True)])
        centre = self.data.units.origin
        left = closure_wrench(centre, [c.position for c in contacts], world) - load_reaction(self.stance, centre)
        balance = float(np.abs(left / self.data.units.wrench).max())
        measures = measures_of(self.stance, self.data, world, local, **self.settings)
        if found.forces is not None and measures.reserve < -1e-6 * self.data.units.force:
            raise EngineError(f"method '{found.method}': its forces leave their cones by {-measures.reserve:.3g} N", name=found.method)
        return replace(found, wrenches_W=world, wrenches_C=local, balance=balance, measures=measures)
