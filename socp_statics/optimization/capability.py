"""Capability: the largest payload, and the largest push, that contacts and motors allow."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from socp_statics.certificates import MotionCertificate, force_residuals, motion_certificate, motion_of
from socp_statics.certificates.optimum import Multipliers, Optimum
from socp_statics.certificates.prices import Prices, Scale, prices_of
from socp_statics.cones.choice import ConeChoice, cone_choice
from socp_statics.contacts import Stance
from socp_statics.contacts.stance import stance_of
from socp_statics.engines import engine_names, engines_for
from socp_statics.engines.engine import Engine
from socp_statics.engines.solution import INFEASIBLE, SOLVED, Solution
from socp_statics.exceptions import EngineError
from socp_statics.models.capability import MODEL, CapabilityShape
from socp_statics.models.contact_forces_set import force_shape, force_values
from socp_statics.optimization.force_answer import ACCEPTED
from socp_statics.optimization.unit_load import UnitLoad, unit_load
from socp_statics.stability import EquilibriumAnswer, check_equilibrium
from socp_statics.statics import PointForces, StaticsData, assemble, point_forces, wrench_range
from socp_statics.statics.added_load import limit_relief, with_load
from socp_statics.statics.joint_torques import torques_by_name

# How far beyond the largest load its motion is certified, as a share of it or of W.
BEYOND = 1e-4


@dataclass(frozen=True, eq=False)
class CapabilityAnswer:
    """The largest multiple of a load.

    Attributes:
        status: "solved"; "infeasible" where not even zero load is in balance; "unbounded" where any load is.
        objective: Largest payload [kg] or push [N]; inf where unbounded, None where infeasible.
        load: The unit load.
        forces: Contact forces at the largest load, None unless solved.
        torques: Joint torques with them [N m], None without a robot or forces.
        beyond: The motion that nothing can prevent a little beyond the largest load, None unless solved.
        growth: Where unbounded, how the contact forces grow per unit of the load; added k times to forces that hold without load, they
            hold with k units.
        residuals: "balance", "cone" and "gap" in units of W.
        engine: Name of the engine that answered.
        handovers: How many programs went to another engine.
        equilibrium: Verdict, margin and certificate without the load.
        optimum: Scaled forces and multipliers that prices follow from, where solved.
    """

    status: str
    objective: float | None
    load: UnitLoad
    forces: PointForces | None
    torques: dict[str, float] | None
    beyond: MotionCertificate | None
    growth: PointForces | None
    residuals: dict[str, float]
    engine: str
    handovers: int
    equilibrium: EquilibriumAnswer
    optimum: Optimum | None = field(default=None, repr=False)

    @property
    def torque_limits(self) -> dict[str, tuple[float, float]] | None:
        """Lower and upper joint torques that were asked for [N m]."""
        return self.equilibrium.torque_limits

    @cached_property
    def prices(self) -> Prices | None:
        """What the largest load gains per unit of friction, limit, bound and contact displacement; None unless solved."""
        if self.optimum is None:
            return None
        one = self.optimum.data.units.force / self.load.newtons
        return prices_of(self.optimum, Scale(self.load.kind, self.load.unit, one))


def largest_payload(
    stance: Any,
    point: Any = None,
    *,
    link: str | None = None,
    torque_limits: bool | Mapping[str, Any] = False,
    cone: str | ConeChoice = "exact",
    sides: int | None = None,
    heading: float | None = None,
    form: str = "socp",
    engine: str | Sequence[str] = "auto",
) -> CapabilityAnswer:
    """The largest mass that can hang at a point.

    Args:
        stance: A Stance or a Posture.
        point: Where it hangs, world axes, shape (3,) [m]; with a robot by default the origin of the link.
        link: Link or other frame of the robot that carries it, by default the base; its weight needs joint torques.
        torque_limits: Whether forces have to respect joint-torque limits: the robot's own, or a mapping of limits.
        cone: "exact", "inscribed" or "circumscribed", or a ConeChoice.
        sides: Sides of the pyramids.
        heading: Heading of the pyramids [rad].
        form: "socp" or "sdp".
        engine: "auto", the name of an engine, or several to be tried in turn.

    Returns:
        The answer; its objective is in kilograms.

    Raises:
        InputError: An unknown link, a missing point, no gravity, or another number or name that is wrong.
        EngineError: No engine settled the program.
    """
    choice, posed = cone_choice(cone, sides, heading), stance_of(stance, torque_limits=torque_limits)
    return largest_load(posed, unit_load(posed, "payload", link, point, None), cone=choice, form=form, engine=engine)


def largest_push(
    stance: Any,
    direction: Any,
    point: Any = None,
    *,
    link: str | None = None,
    torque_limits: bool | Mapping[str, Any] = False,
    cone: str | ConeChoice = "exact",
    sides: int | None = None,
    heading: float | None = None,
    form: str = "socp",
    engine: str | Sequence[str] = "auto",
) -> CapabilityAnswer:
    """The largest force on the robot in a direction that it can stand.

    Args:
        stance: A Stance or a Posture.
        direction: Of the force on the robot, world axes, of any length > 0, shape (3,).
        point: Where it acts, world axes, shape (3,) [m]; with a robot by default the origin of the link.
        link: Link or other frame of the robot that is pushed, by default the base.
        torque_limits: Whether forces have to respect joint-torque limits: the robot's own, or a mapping of limits.
        cone: "exact", "inscribed" or "circumscribed", or a ConeChoice.
        sides: Sides of the pyramids.
        heading: Heading of the pyramids [rad].
        form: "socp" or "sdp".
        engine: "auto", the name of an engine, or several to be tried in turn.

    Returns:
        The answer; its objective is in newtons.

    Raises:
        InputError: An unknown link, a missing point, a zero direction, or another number or name that is wrong.
        EngineError: No engine settled the program.
    """
    choice, posed = cone_choice(cone, sides, heading), stance_of(stance, torque_limits=torque_limits)
    return largest_load(posed, unit_load(posed, "push", link, point, direction), cone=choice, form=form, engine=engine)


def largest_load(stance: Stance, load: UnitLoad, *, cone: ConeChoice, form: str, engine: str | Sequence[str]) -> CapabilityAnswer:
    """The largest multiple of a unit load.

    Args:
        stance: The stance without the load.
        load: The unit load.
        cone: Exact cones or pyramids.
        form: "socp" or "sdp".
        engine: "auto", the name of an engine, or several to be tried in turn.

    Returns:
        The answer.

    Raises:
        EngineError: No engine settled the program.
    """
    equilibrium = check_equilibrium(stance, cone=cone, form=form, engine=engine)
    question = _Question(stance, load, cone, form, equilibrium)
    if equilibrium.verdict == "unstable":
        return question.infeasible()
    details = []
    for handovers, one in enumerate(engines_for(engine, form)):
        answer, detail = question.answer(one)
        if answer is not None:
            return replace(answer, handovers=equilibrium.handovers + handovers)
        details.append(f"{one.name}: {detail}")
    raise EngineError(f"the largest {load.kind} was not settled ({'; '.join(details)})", name=engine_names(engine)[-1])


class _Question:
    """One stance with one unit load, scaled."""

    def __init__(self, stance: Stance, load: UnitLoad, cone: ConeChoice, form: str, equilibrium: EquilibriumAnswer):
        self.data: StaticsData = assemble(stance)
        self.load, self.cone, self.equilibrium = load, cone, equilibrium
        self.P, self.torque = load.scaled(stance, self.data)
        self.relief = limit_relief(self.data, self.torque)
        self.reach = wrench_range(np.hstack([self.data.wrench_map, self.P[:, None]]))
        self.form = form
        self.one = self.data.units.force / load.newtons

    def _shape(self, data: StaticsData, capped: bool) -> CapabilityShape:
        return CapabilityShape(force_shape(data, self.cone, self.form, self.reach.rank), capped)

    def _values(self, data: StaticsData) -> dict[str, Any]:
        return force_values(data, self.cone, self.reach.basis) | {"P": self.reach.basis.T @ self.P, "r": self.relief, "cap": 1.0}

    def answer(self, one: Engine) -> tuple[CapabilityAnswer | None, str]:
        """The answer by one engine; None where it does not check, with the reason."""
        solution = one.compile(MODEL, self._shape(self.data, False)).solve(self._values(self.data))
        if solution.status == INFEASIBLE:
            if self.equilibrium.stable:
                return None, f"{solution.detail} though forces balance without it"
            return self.infeasible(), solution.detail
        found = self._solved(solution) if solution.status == SOLVED else self._unbounded(one)
        return found, f"{solution.detail}, {'with an answer that does not check' if solution.status == SOLVED else 'without an optimum'}"

    def carrying(self, w: float) -> StaticsData:
        """The arrays with w scaled units of the load."""
        return with_load(self.data, self.P, self.relief, self.torque, w)

    def infeasible(self) -> CapabilityAnswer:
        """Not even zero load is in balance."""
        e = self.equilibrium
        none = {"balance": 0.0, "cone": 0.0, "gap": e.residuals["gap"]}
        return CapabilityAnswer("infeasible", None, self.load, None, None, None, None, none, e.engine, e.handovers, e)

    def _unbounded(self, one: Engine) -> CapabilityAnswer | None:
        """Any load is in balance: without stance, and with bounds and limits of zero, forces and load grow together without end."""
        bounds = np.where(np.isfinite(self.data.bounds), 0.0, self.data.bounds)
        free = replace(self.data, load=np.zeros(6), bounds=bounds, limit_values=np.zeros_like(self.data.limit_values))
        solution = one.compile(MODEL, self._shape(free, True)).solve(self._values(free))
        if solution.status != SOLVED or solution.objective < 0.5:
            return None
        x = solution.variables["x"] / float(solution.variables["w"])
        held = force_residuals(replace(free, load=self.P, limit_values=self.relief), self.cone, x)
        if max(held) > ACCEPTED * max(1.0, float(np.abs(x).max())):
            return None
        residuals = {"balance": held.balance, "cone": held.cone, "gap": solution.gap}
        growth = point_forces(self.data, x / self.one)
        return CapabilityAnswer("unbounded", np.inf, self.load, None, None, None, growth, residuals, one.name, 0, self.equilibrium)

    def _solved(self, solution: Solution) -> CapabilityAnswer | None:
        """The largest load with its forces, and what stops more."""
        w, x = float(solution.variables["w"]), solution.variables["x"]
        at, duals = self.carrying(w), solution.duals
        held = force_residuals(at, self.cone, x)
        twist = self.reach.basis @ duals["balance"]
        motion = motion_of(self.data, twist, duals.get("limits"))
        beyond = motion_certificate(self.carrying(w + BEYOND * max(1.0, w)), self.cone, motion)
        if beyond is None or max(held) > ACCEPTED * max(1.0, float(np.abs(x).max())):
            return None
        torques = torques_by_name(at.torques, at.units, x) if at.torques.names else None
        multipliers = Multipliers.read(at, twist, duals)
        optimum = Optimum(self.data, self.cone, x, 0.0, multipliers, self.P[:, None], np.zeros(1), self.relief[:, None], w)
        residuals = {"balance": held.balance, "cone": held.cone, "gap": solution.gap}
        return CapabilityAnswer(
            "solved", max(w, 0.0) * self.one, self.load, point_forces(self.data, x), torques, beyond, None, residuals, solution.engine, 0,
            self.equilibrium, optimum,
        )  # fmt: skip
