"""Minimax contact wrench: the least possible largest contact load of a stance (3.7.2, Boyd and Wegbreit 2007)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from socp_statics.certificates import force_residuals
from socp_statics.cones.choice import ConeChoice, cone_choice
from socp_statics.contacts import Stance
from socp_statics.contacts.numbers import scalar
from socp_statics.contacts.stance import stance_of
from socp_statics.engines import compiled_first
from socp_statics.engines.engine import Engine
from socp_statics.engines.solution import SOLVED, Solution
from socp_statics.exceptions import InputError
from socp_statics.models.contact_forces_set import ForceShape, force_shape, force_values
from socp_statics.models.equilibrium import MODEL as EQUILIBRIUM
from socp_statics.models.minimax_wrench import MODEL, MinimaxShape
from socp_statics.models.program import ConicModel
from socp_statics.optimization.compiled_minimax import COUNTS, compiled_minimax
from socp_statics.optimization.force_answer import ACCEPTED, ForceAnswer, answer_of, infeasible, settled
from socp_statics.optimization.force_rows import force_rows, groups, normal_row, slipping, tangential_rows, wrench_rows
from socp_statics.spatial import Array
from socp_statics.stability import EquilibriumAnswer, check_equilibrium
from socp_statics.statics import StaticsData, assemble, wrench_range

MEASURES = ("normal", "force", "component", "tangential", "friction_use")
LEVELS = ("contact", "point")
BISECTION = 1e-6
FEASIBLE = -1e-8
NOTHING = 1e-8
JUMP = -1e-4
# Within the solver's 1e-11 of an infimum that needs infinite forces, they have grown beyond this many W.
DIVERGES = 1e4


class Measured(NamedTuple):
    """What a measure looks at.

    Attributes:
        rows: Measured components over x, group by group.
        grip: For "friction_use", mu times the normal force of each group over x.
        points: For "friction_use", the number of points of each group.
        scaled: For "friction_use", the points whose own friction cone is the measure: their mu is scaled instead.
        groups: Number of groups with rows.
    """

    rows: Array
    grip: Array
    points: Array
    scaled: Array
    groups: int


def measured(data: StaticsData, cone: ConeChoice, measure: str, level: str, length: float) -> Measured:
    """What a measure looks at.

    Args:
        data: The stance's arrays.
        cone: Exact cones or pyramids.
        measure: "normal", "force", "component", "tangential" or "friction_use".
        level: "contact" or "point".
        length: Divides moments in "component", scaled.

    Returns:
        Rows over x. "normal", "tangential" and "friction_use" look at unilateral contacts only.
    """
    columns = data.wrench_map.shape[1]
    none = np.zeros((0, columns))
    chosen = groups(data, level)
    scaled = np.zeros(0, dtype=int)
    if measure == "force":
        rows = np.vstack([force_rows(data, g) for g in chosen])
    elif measure == "component":
        scale = np.repeat([1.0, 1.0 / length], 3)[:, None]
        rows = np.vstack([scale * wrench_rows(data, g, about_position=level == "contact") for g in chosen])
        rows = rows[np.abs(rows).sum(axis=1) > 0]
        return Measured(rows, none, np.zeros(0), scaled, len(rows))
    elif measure == "normal":
        chosen = [g for g in chosen if len(g.points)]
        rows = np.vstack([none, *(normal_row(data, g)[None] for g in chosen)])
    else:
        chosen = [g for g in chosen if slipping(data, g)]
        if measure == "friction_use":
            own = [cone.is_exact and len(g.points) == 1 and g.points[0] < data.circular for g in chosen]
            scaled = np.array([g.points[0] for g, alone in zip(chosen, own, strict=True) if alone], dtype=int)
            chosen = [g for g, alone in zip(chosen, own, strict=True) if not alone]
        rows = np.vstack([none, *(tangential_rows(data, g) for g in chosen)])
    grip = np.vstack([none, *(data.friction[g.points[0]] * normal_row(data, g)[None] for g in chosen if measure == "friction_use")])
    return Measured(rows, grip, np.array([len(g.points) for g in chosen], dtype=float), scaled, len(chosen))


def of_single_points(data: StaticsData, level: str) -> bool:
    """Whether every group that is measured is one point: at the level of points, or where no contact has several."""
    return level == "point" or len(set(data.contact_of_point.tolist())) == data.points


def attains(data: StaticsData, cone: ConeChoice, measure: str, level: str) -> bool:
    """Whether some forces attain the least measure for certain.

    Bounded normal forces bound all others but those of handles, which are limited by half-spaces. Bounded tangential forces of single
    points leave a bounded set plus a cone with flat faces, the normal forces; not so those of a whole sole or of an elliptic soft
    finger, whose sum or share may come as near to its limit as normal forces grow.

    Args:
        data: The stance's arrays.
        cone: Exact cones or pyramids.
        measure: One of `MEASURES`.
        level: "contact" or "point".
    """
    if measure == "tangential":
        return not data.elliptic and (not cone.is_exact or of_single_points(data, level))
    return measure != "friction_use"


def minimise_largest_wrench(
    stance: Any,
    measure: str = "force",
    level: str = "point",
    *,
    length: float = 0.1,
    cone: str | ConeChoice = "exact",
    sides: int | None = None,
    heading: float | None = None,
    form: str = "socp",
    engine: str | Sequence[str] = "auto",
    torque_limits: bool | Mapping[str, Any] = False,
) -> ForceAnswer:
    """Balancing contact forces whose largest measure is least.

    Args:
        stance: A Stance or a Posture.
        measure: "normal", the largest normal force [N]; "force", the largest force [N]; "tangential", the largest tangential
            force [N]; "component", the largest absolute component of the wrench in the contact frame [N], moments divided by
            ``length``; "friction_use", the least s with |f_t| <= s mu f_n wherever mu > 0 [1].
        level: "point", where each corner of a surface counts, or "contact", where resultants count.
        length: Divides moments [m].
        cone: "exact", "inscribed" or "circumscribed", or a ConeChoice.
        sides: Sides of the pyramids.
        heading: Heading of the pyramids [rad].
        form: "socp" or "sdp".
        engine: "auto", the name of an engine, or several to be tried in turn.
        torque_limits: Whether forces have to respect joint-torque limits: the robot's own, or a mapping of limits.

    Returns:
        The forces; status "unbounded" where the infimum is not attained because forces grow without end.

    Raises:
        InputError: Unknown measure or level, or a length that is not positive.
        EngineError: No engine settled a program.
    """
    for field, word, known in (("measure", measure, MEASURES), ("level", level, LEVELS)):
        if word not in known:
            raise InputError(f"{field} must be one of {', '.join(known)}, got {word!r}", name=field, field=field)
    length = scalar("minimax_wrench", "length", length, above=0.0, kind="model")
    choice = cone_choice(cone, sides, heading)
    stance = stance_of(stance, torque_limits=torque_limits)
    equilibrium = check_equilibrium(stance, cone=choice, form=form, engine=engine)
    if equilibrium.verdict == "unstable":
        return infeasible(equilibrium)
    data = assemble(stance)
    what = measured(data, choice, measure, level, length / data.units.length)
    question = _Question(data, choice, form, engine, measure, what, equilibrium)
    if not question.what.groups and not len(question.what.scaled):
        return question.nothing_to_measure()
    if measure == "friction_use":
        return question.least_friction_use()
    if measure in COUNTS and of_single_points(data, level) and choice.is_exact and compiled_first(engine, form):
        answer = question.compiled(stance)
        if answer is not None:
            return answer
    return question.minimax(attains(data, choice, measure, level))


class _Question:
    """The programs of one minimax question."""

    def __init__(
        self, data: StaticsData, cone: ConeChoice, form: str, engine: str | Sequence[str], measure: str, what: Measured,
        equilibrium: EquilibriumAnswer,
    ):
        self.data, self.cone, self.form, self.engine = data, cone, form, engine
        self.measure, self.what, self.equilibrium = measure, what, equilibrium
        self.reach = wrench_range(data.wrench_map)
        self.values = force_values(data, cone, self.reach.basis) | {"F": what.rows}
        self.handovers = 0

    def _settled(self, model: ConicModel, shape: Any, values: dict[str, Any], check: bool) -> Solution:
        def solve(one: Engine) -> Solution:
            return one.compile(model, shape).solve(values)

        solution, handovers = settled(self.data, self.cone, self.engine, solve, f"measure '{self.measure}'", self.form, check=check,
                                      balances=check and self.equilibrium.stable)  # fmt: skip
        self.handovers += handovers
        return solution

    def _forces(self, rank: int) -> ForceShape:
        return force_shape(self.data, self.cone, self.form, rank)

    def _answer(self, solution: Solution, status: str, objective: float) -> ForceAnswer:
        x = solution.variables["x"]
        gap = solution.gap
        return answer_of(self.data, self.cone, x, status, objective, gap, solution.engine, self.handovers, self.equilibrium)

    def nothing_to_measure(self) -> ForceAnswer:
        """No contact has what the measure looks at: any balancing forces will do."""
        e = self.equilibrium
        return ForceAnswer("solved", 0.0, e.forces, e.residuals, e.engine, e.handovers, e, e.torques)

    def compiled(self, stance: Stance) -> ForceAnswer | None:
        """The kernel's program for the points of a stance, None where it does not apply or its answer does not check."""
        found = compiled_minimax(stance, self.data, self.measure)
        if found is None or max(force_residuals(self.data, self.cone, found.x)) > ACCEPTED:
            return None
        W = self.data.units.force
        return answer_of(self.data, self.cone, found.x, "solved", found.value * W, found.gap, "kernel", 0, self.equilibrium)

    def minimax(self, attained: bool) -> ForceAnswer:
        """The measures that are convex in forces and level together; whether the least one is attained for certain."""
        shape = MinimaxShape(self._forces(self.reach.rank), self.measure, self.what.groups)
        solution = self._settled(MODEL, shape, self.values, check=True)
        if solution.status != SOLVED:
            return infeasible(self.equilibrium)
        value = max(solution.objective, 0.0)
        diverges = not attained and float(np.abs(solution.variables["x"]).max()) > DIVERGES
        return self._answer(solution, "unbounded" if diverges else "solved", value * self.data.units.force)

    def _reserve(self, use: float) -> Solution:
        """The reserve of the set with a share of the friction cones: negative where the share is too low."""
        what = self.what
        mu = self.values["mu"].copy()
        mu[what.scaled] *= use
        values = {**self.values, "mu": mu, "cap": 1.0}
        if not what.groups:
            return self._settled(EQUILIBRIUM, self._forces(self.reach.rank), values, check=False)
        counts = use * what.points * what.grip.max(axis=1, initial=0.0)
        shape = MinimaxShape(self._forces(self.reach.rank), self.measure, what.groups)
        return self._settled(MODEL, shape, {**values, "s_mu_N": use * what.grip, "s_mu_n": counts}, check=False)

    def _reserve_without(self) -> Solution | None:
        """The reserve with the measured tangential forces exactly zero, None where the balance needs them."""
        alone = np.zeros((2 * len(self.what.scaled), self.data.wrench_map.shape[1]))
        alone[np.arange(len(alone)), np.sort(np.concatenate([2 * self.what.scaled, 2 * self.what.scaled + 1]))] = 1.0
        rows = np.vstack([self.data.wrench_map, self.what.rows, alone])
        load = np.concatenate([self.data.load, np.zeros(len(rows) - 6)])
        reach = wrench_range(rows)
        if reach.outside(load) > NOTHING:
            return None
        values = {**self.values, "G": reach.basis.T @ rows, "load": reach.basis.T @ load, "cap": 1.0}
        return self._settled(EQUILIBRIUM, self._forces(reach.rank), values, check=False)

    def least_friction_use(self) -> ForceAnswer:
        """Bisection on the share of the friction cones that is used."""
        best, lowest = self._reserve(1.0), self._reserve_without()
        if best.status != SOLVED or best.objective < FEASIBLE:
            return infeasible(self.equilibrium)
        if lowest is not None and lowest.status == SOLVED and lowest.objective >= FEASIBLE:
            return self._answer(lowest, "solved", 0.0)
        lo, hi = 0.0, 1.0
        # Where friction is large a small share of it is much: what matters is the slope.
        steepest = max(1.0, float(self.data.friction.max(initial=0.0)))
        while hi - lo > BISECTION / steepest:
            middle = 0.5 * (lo + hi)
            found = self._reserve(middle)
            if found.status == SOLVED and found.objective >= FEASIBLE:
                hi, best = middle, found
            else:
                lo, lowest = middle, found
        jumps = lowest is None or lowest.status != SOLVED or lowest.objective < JUMP
        return self._answer(best, "unbounded" if jumps else "solved", lo if jumps else hi)
