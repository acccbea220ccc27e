"""The internal-force window: how much internal force keeps every contact in its exact cone and every torque in its limit.

    maximise    d' s
    subject to  F(x) = F_0 + sum_i s_i D_i      contact by contact            others "fixed"
                G x + L = 0,  s_i = D_i+ (F(x) - F_0)                         others "free"
                f_i in K_i,  bounds,  hard rows

F_0 is a particular solution that balances the load, D_i are directions of internal force. Two programs give the interval of one
direction, support programs in turn the feasible set of two: it is the program of a support region with s in place of the centre of mass.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from socp_statics.cones.choice import ConeChoice, cone_choice
from socp_statics.contacts import ContactSet, Stance
from socp_statics.contacts.numbers import scalar
from socp_statics.contacts.stance import stance_of
from socp_statics.distribution.closed_form import CLOSED_FORMS
from socp_statics.engines import engine_names, engines_for
from socp_statics.engines.solution import INFEASIBLE, SOLVED, UNBOUNDED, Solution
from socp_statics.exceptions import EngineError, InputError
from socp_statics.models.contact_forces_set import force_shape, force_values
from socp_statics.models.support_region import MODEL, RegionShape
from socp_statics.optimization.null_directions import independent, null_direction
from socp_statics.optimization.window_set import WindowSet, flat_set, traced_set
from socp_statics.optimization.wrench_distribution import distribute
from socp_statics.optimization.wrench_measures import torques_of
from socp_statics.optimization.wrench_reserve import contact_wrench_rows, wrench_reserve
from socp_statics.spatial import Array
from socp_statics.stability import EquilibriumAnswer, check_equilibrium
from socp_statics.statics import StaticsData, assemble, wrench_range

OTHERS = ("fixed", "free")
# Where there is no end, the set is drawn to this many W of internal force.
CLIP = 10.0
AT_THE_END = 1e-6


@dataclass(frozen=True, eq=False)
class WindowEnd:
    """One end of an interval of internal force.

    Attributes:
        value: Internal force there, per unit of the direction [N]; inf or -inf where there is no end.
        wrenches_W: Contact wrenches there, world axes, shape (k, 6); None without an end.
        stopped_by: Contacts that are on the edge of their cones there, and joints at their limits; empty without an end.
    """

    value: float
    wrenches_W: Array | None
    stopped_by: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class InternalForceWindow:
    """The window of a stance.

    Attributes:
        kind: "interval", "point" or "empty" of one direction, of two also "segment" and "polygon"; "unbounded" where there is an end
        missing. lower: The least internal force along the first direction, others as they are asked for; None where empty.
        upper: The largest.
        particular_W: Contact wrenches of the particular solution, world axes, shape (k, 6) [N, N m].
        directions: Contact wrenches per unit in contact frames, shape (1 or 2, k, 6).
        set: Of two directions, the feasible set between an inner and an outer polygon [N]; None of one.
        others: "fixed" or "free".
        engine: Name of the engine.
        equilibrium: Verdict of the stance.
    """

    kind: str
    lower: WindowEnd | None
    upper: WindowEnd | None
    particular_W: Array
    directions: Array
    set: WindowSet | None
    others: str
    engine: str
    equilibrium: EquilibriumAnswer = field(repr=False)

    @property
    def width(self) -> float:
        """Upper less lower end [N], 0 where empty."""
        return 0.0 if self.lower is None or self.upper is None else self.upper.value - self.lower.value

    def holds(self, internal_force: float) -> bool:
        """Whether an internal force along the first direction is inside the window."""
        return self.lower is not None and self.upper is not None and self.lower.value <= internal_force <= self.upper.value


def internal_force_window(
    stance: Any,
    directions: Sequence[Any],
    *,
    particular: str = "barycentric",
    others: str = "fixed",
    tolerance: float = 1e-3,
    cone: str | ConeChoice = "exact",
    sides: int | None = None,
    heading: float | None = None,
    form: str = "socp",
    engine: str | Sequence[str] = "auto",
    torque_limits: bool | Mapping[str, Any] = False,
) -> InternalForceWindow:
    """How much internal force keeps every contact in its cone and every torque in its limit.

    Args:
        stance: A Stance or a Posture.
        directions: One or two directions of internal force: each two names of contacts, for the member between them, tension positive; or
            a mapping of contact to force (3) or wrench (6) in world axes about the contact, per unit, without net wrench.
        particular: The closed-form method whose solution the internal force is added to.
        others: "fixed": nothing else changes; "free": all other internal forces may be chosen to keep the contacts in their cones.
        tolerance: Of two directions: (outer area - inner area) / outer area.
        cone: "exact", "inscribed" or "circumscribed", or a ConeChoice.
        sides: Sides of the pyramids.
        heading: Heading of the pyramids [rad].
        form: "socp" or "sdp".
        engine: "auto", the name of an engine, or several to be tried in turn.
        torque_limits: Whether joint-torque limits have to be respected: the robot's own, or a mapping of limits.

    Returns:
        The window. With two directions the interval is that of the first with the second at zero.

    Raises:
        InputError: Not one or two directions, one with a net wrench, an unknown word, or a load that the contacts cannot balance.
        EngineError: No engine settled a program.
    """
    if others not in OTHERS:
        raise InputError(f"others must be one of {', '.join(OTHERS)}, got {others!r}", name="others", field="others")
    if particular not in CLOSED_FORMS:
        known = ", ".join(CLOSED_FORMS)
        raise InputError(f"particular must be one of {known}, got {particular!r}", name=str(particular), field="particular")
    if isinstance(directions, str | Mapping) or len(directions) not in (1, 2):
        raise InputError("directions: one or two directions of internal force are expected", name="directions", field="directions")
    scalar("internal_force_window", "tolerance", tolerance, above=0.0, kind="model")
    choice, posed = cone_choice(cone, sides, heading), stance_of(stance, torque_limits=torque_limits)
    given = [null_direction(posed.contacts, stated) for stated in directions]
    independent(posed.contacts, given)
    base = distribute(posed, particular, cone=choice, form=form, engine=engine)
    equilibrium = check_equilibrium(posed, cone=choice, form=form, engine=engine)
    question = WindowQuestion(posed, np.array(given), base.wrenches_C, others, choice, form, engine)
    ends = question.ends()
    found = question.set(tolerance) if len(given) == 2 else None
    kind = _kind(ends, question.data.units.force) if found is None else found.kind
    lower, upper = (None, None) if ends is None else ends
    assert base.wrenches_W is not None
    return InternalForceWindow(kind, lower, upper, base.wrenches_W, np.array(given), found, others, question.engine_used, equilibrium)


def _kind(ends: tuple[WindowEnd, WindowEnd] | None, W: float) -> str:
    if ends is None:
        return "empty"
    lower, upper = (end.value for end in ends)
    if not (np.isfinite(lower) and np.isfinite(upper)):
        return "unbounded"
    return "point" if upper - lower <= 1e-9 * W else "interval"


class WindowQuestion:
    """The support programs of a window, scaled: s in units of W."""

    def __init__(
        self, stance: Stance, directions: Array, particular: Array | None, others: str, cone: ConeChoice, form: str,
        engine: str | Sequence[str],
    ):  # fmt: skip
        assert particular is not None
        self.stance, self.cone, self.form, self.engine = stance, cone, form, engine
        self.data: StaticsData = assemble(stance)
        units = self.data.units
        self.rows = contact_wrench_rows(self.data)
        self.start = (particular / units.wrench).ravel()
        self.D = np.array([(d * units.force / units.wrench).ravel() for d in directions]).T
        self.others, self.engine_used = others, ""

    def _program(self, D: Array) -> tuple[StaticsData, Array]:
        """Arrays whose balance rows tie x to s, and the columns of s on them."""
        if self.others == "fixed":
            return replace(self.data, wrench_map=self.rows, load=-self.start), -D
        inverse = np.linalg.pinv(D)
        rows = np.vstack([self.data.wrench_map, inverse @ self.rows])
        load = np.concatenate([self.data.load, -inverse @ self.start])
        return replace(self.data, wrench_map=rows, load=load), np.vstack([np.zeros((6, D.shape[1])), -np.eye(D.shape[1])])

    def support(self, direction: Array, D: Array, clip: float | None = None) -> Solution:
        """The farthest s along a direction: solved, infeasible or unbounded.

        Raises:
            EngineError: No engine settled it.
        """
        data, columns = self._program(D)
        reach = wrench_range(np.hstack([data.wrench_map, columns]))
        shape = RegionShape(force_shape(data, self.cone, self.form, reach.rank), D.shape[1], clip is not None)
        values: dict[str, Any] = force_values(data, self.cone, reach.basis)
        values |= {"D": reach.basis.T @ columns, "direction": direction, "box": np.full(D.shape[1], clip or 1.0)}
        details = []
        for one in engines_for(self.engine, self.form):
            solution = one.compile(MODEL, shape).solve(values)
            if solution.status in (SOLVED, INFEASIBLE, UNBOUNDED):
                self.engine_used = self.engine_used or one.name
                return solution
            details.append(f"{one.name}: {solution.detail}")
        raise EngineError(f"the internal-force window was not settled ({'; '.join(details)})", name=engine_names(self.engine)[-1])

    def ends(self) -> tuple[WindowEnd, WindowEnd] | None:
        """The ends of the interval along the first direction, None where it is empty."""
        D = self.D[:, :1]
        found = []
        for sign in (-1.0, 1.0):
            solution = self.support(np.array([sign]), D)
            if solution.status == INFEASIBLE:
                return None
            if solution.status == UNBOUNDED:
                found.append(WindowEnd(sign * np.inf, None, ()))
                continue
            local = (self.rows @ solution.variables["x"]).reshape(-1, 6) * self.data.units.wrench
            world = np.array([np.kron(np.eye(2), c.rotation) @ F for c, F in zip(self.stance.contacts, local, strict=True)])
            value = float(solution.variable("s")[0]) * self.data.units.force
            found.append(WindowEnd(value, world, self._stopped_by(local, world)))
        return found[0], found[1]

    def _stopped_by(self, local: Array, world: Array) -> tuple[str, ...]:
        """Contacts without reserve and joints at a limit."""
        least = AT_THE_END * self.data.units.force
        names = [c.name for k, c in enumerate(self.stance.contacts) if c.unilateral and self._reserve_of(k, local[k]) < least]
        if self.stance.torque_limits is not None:
            tau, limits = torques_of(self.stance, world), self.stance.torque_limits
            near = AT_THE_END * self.data.units.force * self.data.units.length
            at = (tau > limits[:, 1] - near) | (tau < limits[:, 0] + near)
            names += [joint for joint, there in zip(self.stance.posture.robot.joints, at, strict=True) if there]
        return tuple(names)

    def _reserve_of(self, k: int, wrench: Array) -> float:
        contact = self.stance.contacts[k]
        alone = assemble(replace(self.stance, contacts=ContactSet([contact]), posture=None, torque_limits=None))
        return wrench_reserve(alone, wrench[None], self.cone, self.form, self.engine)

    def set(self, tolerance: float) -> WindowSet:
        """The feasible set of both directions [N]."""
        W = self.data.units.force

        def farthest(direction: Array, clip: float | None) -> tuple[str, Array | None, float]:
            solution = self.support(direction, self.D, clip)
            if solution.status != SOLVED:
                return solution.status, None, 0.0
            return SOLVED, np.asarray(solution.variable("s"), dtype=float), float(solution.objective)

        flat = flat_set(farthest, CLIP)
        return (flat if flat is not None else traced_set(farthest, CLIP, tolerance)).in_newtons(W)
