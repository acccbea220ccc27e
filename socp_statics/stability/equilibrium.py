"""Is the posture stable? Verdict, margin, reason and certificate of a stance (weak stability, 3.7.1)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from socp_statics.certificates import ForcesCertificate, Motion, MotionCertificate, motion_certificate
from socp_statics.certificates.contact_motion import contact_motion
from socp_statics.certificates.optimum import Optimum
from socp_statics.certificates.prices import Prices
from socp_statics.cones.choice import ConeChoice, cone_choice
from socp_statics.contacts import ContactSet, ExternalWrench, Stance
from socp_statics.contacts.stance import stance_of
from socp_statics.engines import compiled_first
from socp_statics.spatial import Array
from socp_statics.stability.compiled_margin import compiled_margin, compiled_margins
from socp_statics.stability.idle import idle_contacts
from socp_statics.stability.margin import Margin, normal_force_margin
from socp_statics.stability.prices import optimum_prices
from socp_statics.statics import PointForces, StaticsData, assemble, point_forces
from socp_statics.statics.joint_torques import limits_by_name, torques_by_name
from socp_statics.statics.units import BOUNDARY
from socp_statics.statics.wrench_range import INSIDE


@dataclass(frozen=True, eq=False)
class EquilibriumAnswer:
    """The answer to "is it stable?".

    Attributes:
        verdict: "stable", "unstable" or "undecided"; weak stability.
        reason: None, "boundary", "rank", or "torque" where a posture is unstable only because of its torque limits.
        margin: Normal-force reserve [N]; inf, -inf, or nan where the rank leaves it open.
        idle: Contacts that cannot be loaded, wherever the centre of mass (asked only at the boundary).
        idle_margin: Reserve of the other contacts where some are idle [N], else None.
        forces: Balancing forces, or None.
        certificate: Forces for "stable", a motion for "unstable", None for "undecided".
        status: Of the margin program: "solved", "infeasible" (margin -inf) or "unbounded" (margin inf).
        residuals: "balance", "cone" and "gap" in units of W.
        engine: Name of the engine that answered.
        handovers: How many programs went to another engine.
        cone: Exact cones or pyramids.
        torques: Joint torques of the forces [N m], where there are forces and a robot.
        torque_limits: Lower and upper joint torques that were respected [N m], where they were asked for.
        optimum: Scaled forces and multipliers that prices follow from, where there are any.
        stance: The stance that was asked about.
    """

    verdict: str
    reason: str | None
    margin: float
    idle: tuple[str, ...]
    idle_margin: float | None
    forces: PointForces | None
    certificate: ForcesCertificate | MotionCertificate | None
    status: str
    residuals: dict[str, float]
    engine: str
    handovers: int
    cone: ConeChoice
    torques: dict[str, float] | None = None
    torque_limits: dict[str, tuple[float, float]] | None = None
    optimum: Optimum | None = field(default=None, repr=False)
    stance: Stance | None = field(default=None, repr=False)

    @cached_property
    def prices(self) -> Prices | None:
        """What the margin gains per unit of friction, limit, bound and contact displacement.

        Where the margin is -inf because handle or torque limits cannot be met, what the least relaxation that all of them need would
        lose; None where no number stops the margin (infinite, or the load is out of reach).
        """
        return None if self.optimum is None else optimum_prices(self.optimum)

    @property
    def stable(self) -> bool:
        """True where the verdict is "stable"."""
        return self.verdict == "stable"


def check_equilibrium(
    contacts: Any,
    com: Any = None,
    mass: float | None = None,
    *,
    cone: str | ConeChoice = "exact",
    sides: int | None = None,
    heading: float | None = None,
    form: str = "socp",
    engine: str | Sequence[str] = "auto",
    gravity: Any = None,
    external_wrenches: Iterable[ExternalWrench | dict[str, Any]] = (),
    torque_limits: bool | Mapping[str, Any] = False,
) -> EquilibriumAnswer:
    """Verdict, margin and certificate of a stance.

    Args:
        contacts: Contacts; a Stance, which brings everything else; or a Posture, which brings centre of mass and mass.
        com: Centre of mass in world axes, shape (3,) [m].
        mass: Mass [kg]; may be left out where only its sign matters, the margin is then per kilogram.
        cone: "exact", "inscribed" or "circumscribed", or a ConeChoice.
        sides: Sides of the pyramids.
        heading: Heading of the pyramids [rad].
        form: "socp" or "sdp".
        engine: "auto", the name of an engine, or several to be tried in turn.
        gravity: Acceleration of gravity in world axes, shape (3,) [m/s^2].
        external_wrenches: Wrenches impressed on the robot.
        torque_limits: Whether forces have to respect joint-torque limits: the robot's own, or a mapping of limits.

    Returns:
        The answer.

    Raises:
        InputError: A number, name or choice is wrong.
        EngineError: No engine settled the program.
    """
    stance = stance_of(contacts, com, mass, gravity, external_wrenches, torque_limits)
    choice = cone_choice(cone, sides, heading)
    answer = _with(_checked(stance, choice, form, engine), stance=stance)
    if answer.verdict == "unstable" and stance.torque_limits is not None:
        unlimited = _checked(replace(stance, torque_limits=None), choice, form, engine)
        if unlimited.verdict == "stable":
            return _with(answer, reason="torque", handovers=answer.handovers + unlimited.handovers)
    return answer


def check_equilibria(stances: Sequence[Stance], cone: ConeChoice, form: str, engine: str | Sequence[str]) -> list[EquilibriumAnswer]:
    """The whole answers of many stances, margins of friction points by one call of the compiled program.

    Args:
        stances: The stances.
        cone: Exact cones or pyramids.
        form: "socp" or "sdp".
        engine: As for `check_equilibrium`.

    Returns:
        For each what `check_equilibrium` says of it, to the last bit.

    Raises:
        EngineError: No engine settled a program.
    """
    if any(stance.torque_limits is not None for stance in stances) or not compiled_first(engine, form):
        return [check_equilibrium(stance, cone=cone, form=form, engine=engine) for stance in stances]
    data = [assemble(stance) for stance in stances]
    margins = compiled_margins(stances, data, cone)
    return [_judged(*one, cone, form, engine) for one in zip(stances, data, margins, strict=True)]


def _checked(stance: Stance, choice: ConeChoice, form: str, engine: str | Sequence[str]) -> EquilibriumAnswer:
    data = assemble(stance)
    return _judged(stance, data, compiled_margin(stance, data, choice) if compiled_first(engine, form) else None, choice, form, engine)


def _judged(
    stance: Stance, data: StaticsData, margin: Margin | None, choice: ConeChoice, form: str, engine: str | Sequence[str]
) -> EquilibriumAnswer:
    if margin is None:
        margin = normal_force_margin(data, choice, form, engine)
    if np.isnan(margin.value):
        return _answer(data, choice, margin, "undecided", "rank")
    if margin.value >= BOUNDARY:
        return _answer(data, choice, margin, "stable", None)
    if margin.value <= -BOUNDARY:
        return _answer(data, choice, margin, "unstable", None)
    return _at_the_boundary(stance, data, choice, margin, form, engine)


def _answer(data: StaticsData, cone: ConeChoice, margin: Margin, verdict: str, reason: str | None) -> EquilibriumAnswer:
    W = data.units.force
    forces: PointForces | None = None
    certificate: ForcesCertificate | MotionCertificate | None = None
    residuals = {"balance": 0.0, "cone": 0.0, "gap": margin.gap}
    if margin.x is not None and margin.held is not None and verdict != "unstable":
        forces = point_forces(data, margin.x)
        residuals |= {"balance": margin.held.balance, "cone": margin.held.cone}
        certificate = ForcesCertificate(*margin.held) if verdict == "stable" else None
    elif verdict == "unstable":
        certificate = margin.certificate
    status = "unbounded" if margin.value == np.inf else "infeasible" if margin.value == -np.inf else "solved"
    value = margin.value * W if np.isfinite(margin.value) else margin.value
    torques = None if forces is None or margin.x is None else joint_torques_of(data, margin.x)
    limits = limits_by_name(data.torques, data.units) if data.torques.limited else None
    return EquilibriumAnswer(
        verdict, reason, value, (), None, forces, certificate, status, residuals, margin.engine, margin.handovers, cone, torques, limits,
        margin.optimum,
    )  # fmt: skip


def joint_torques_of(data: StaticsData, x: Array) -> dict[str, float] | None:
    """Joint torques of scaled forces [N m], None without a robot."""
    return torques_by_name(data.torques, data.units, x) if data.torques.names else None


def _at_the_boundary(
    stance: Stance, data: StaticsData, cone: ConeChoice, margin: Margin, form: str, engine: str | Sequence[str]
) -> EquilibriumAnswer:
    """A margin of zero: idle contacts get no force, the reserve of the others decides."""
    undecided = _answer(data, cone, margin, "undecided", "boundary")
    idle = idle_contacts(data, cone, form, engine, margin.x)
    rest = [c for c in stance.contacts if c.name not in idle.names]
    if not idle.names:
        return undecided
    if not rest:
        return _without_contacts(stance, data, undecided, idle.names)
    others = replace(stance, contacts=ContactSet(rest))
    part = assemble(others)
    reserve = normal_force_margin(part, cone, form, engine)
    scale = part.units.force / data.units.force
    value = reserve.value * part.units.force
    handovers = margin.handovers + reserve.handovers
    found: dict[str, Any] = {"idle": idle.names, "idle_margin": None if np.isnan(value) else value, "handovers": handovers}
    if reserve.value * scale >= BOUNDARY and reserve.x is not None and reserve.held is not None:
        held = reserve.held
        forces = _with_idle_zero(stance, point_forces(part, reserve.x))
        residuals = {"balance": held.balance * scale, "cone": held.cone * scale, "gap": reserve.gap}
        found |= {"forces": forces, "torques": joint_torques_of(part, reserve.x), "residuals": residuals}
        certified = ForcesCertificate(residuals["balance"], residuals["cone"])
        return _with(undecided, verdict="stable", reason=None, certificate=certified, **found)
    if reserve.value * scale <= -BOUNDARY and reserve.motion is not None:
        motion = _moved_to(data, part, reserve.motion)
        share = _opening(data, cone, motion, idle.names)
        both = Motion(motion.twist + share * idle.motion.twist, motion.joints + share * idle.motion.joints)
        certificate = motion_certificate(data, cone, both)
        if certificate is not None:
            found |= {"forces": None, "torques": None, "residuals": {"balance": 0.0, "cone": 0.0, "gap": reserve.gap}}
            return _with(undecided, verdict="unstable", reason=None, certificate=certificate, **found)
    return _with(undecided, **found)


def _without_contacts(stance: Stance, data: StaticsData, undecided: EquilibriumAnswer, idle: tuple[str, ...]) -> EquilibriumAnswer:
    """No contact can be loaded: the load balances itself, or it is too near to that to tell."""
    if np.linalg.norm(data.load) > INSIDE:
        return _with(undecided, idle=idle)
    forces = point_forces(data, np.zeros(data.wrench_map.shape[1]))
    none = {"balance": 0.0, "cone": 0.0, "gap": 0.0}
    found = {"verdict": "stable", "reason": None, "idle": idle, "idle_margin": np.inf, "residuals": none}
    return _with(undecided, **found, forces=forces, certificate=ForcesCertificate())


def _with(answer: EquilibriumAnswer, **changes: Any) -> EquilibriumAnswer:
    return replace(answer, **changes)


def _with_idle_zero(stance: Stance, forces: PointForces) -> PointForces:
    """The forces of the other contacts together with zero forces at the idle ones, in the order of the contacts."""
    zeros = [(c.name, p) for c in stance.contacts if c.name not in forces.position_W for p in c.points_W]
    names = (*forces.contact, *(name for name, _ in zeros))
    rank = {name: i for i, name in enumerate(stance.contacts.names)}
    order = sorted(range(len(names)), key=lambda i: rank[names[i]])
    none = np.zeros((len(zeros), 3))
    return PointForces(
        contact=tuple(names[i] for i in order),
        point_W=np.vstack([forces.point_W, [p for _, p in zeros]])[order],
        force_W=np.vstack([forces.force_W, none])[order],
        moment_W=np.vstack([forces.moment_W, none])[order],
        moment_carrying=np.concatenate([forces.moment_carrying, np.zeros(len(zeros), dtype=bool)])[order],
        position_W={c.name: c.position for c in stance.contacts},
    )


def _moved_to(data: StaticsData, part: StaticsData, motion: Motion) -> Motion:
    """A motion of a part of the stance in the units and about the origin of the whole."""
    linear, angular = part.units.twist_in_si(motion.twist)
    linear = linear + np.cross(angular, data.units.origin - part.units.origin)
    length = data.units.length
    return Motion(np.concatenate([linear, angular * length]), motion.joints * length / part.units.length)


def _opening(data: StaticsData, cone: ConeChoice, motion: Motion, idle: tuple[str, ...]) -> float:
    """How much of the opening motion it takes to keep idle contacts from working against a motion; it opens them at >= 1."""
    mine = np.isin(data.contact_of_point, [data.names.index(name) for name in idle])
    worst = float(-contact_motion(data, cone, motion).grip[mine].min(initial=0.0))
    return max(worst, 0.0)
