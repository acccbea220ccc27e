"""The support programs of an internal-force window.

    maximise    d' s
    subject to  F(x) = F_0 + sum_i s_i D_i      contact by contact            others "fixed"
                G x + L = 0,  s_i = D_i+ (F(x) - F_0)                         others "free"
                f_i in K_i,  bounds,  hard rows

It is the program of a support region (`socp_statics.models.support_region`) with s in place of the centre of mass.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from socp_statics.cones.choice import ConeChoice
from socp_statics.contacts import ContactSet, Stance
from socp_statics.engines import engine_names, engines_for
from socp_statics.engines.solution import INFEASIBLE, SOLVED, UNBOUNDED, Solution
from socp_statics.exceptions import EngineError
from socp_statics.models.contact_forces_set import force_shape, force_values
from socp_statics.models.support_region import MODEL, RegionShape
from socp_statics.optimization.window_set import WindowSet, flat_set, traced_set
from socp_statics.optimization.wrench_measures import torques_of
from socp_statics.optimization.wrench_reserve import contact_wrench_rows, wrench_reserve
from socp_statics.spatial import Array
from socp_statics.statics import StaticsData, assemble, wrench_range

# Where there is no end, the set is drawn to this many W of internal force.
CLIP = 10.0
AT_THE_END = 1e-6
# How far beyond its end an internal force is tried, in W.
STEP = 1e-4


@dataclass(frozen=True, eq=False)
class WindowEnd:
    """One end of an interval of internal force.

    Attributes:
        value: Internal force there, per unit of the direction [N]; inf or -inf where there is no end.
        wrenches_W: Contact wrenches there, world axes, shape (k, 6); None without an end.
        stopped_by: Contacts that would leave their cones beyond it (all loaded ones at the edge, where the others are free), and joints at
            their limits; empty without an end.
    """

    value: float
    wrenches_W: Array | None
    stopped_by: tuple[str, ...]


class WindowQuestion:
    """The support programs of a window, scaled: s in units of W."""

    def __init__(
        self, stance: Stance, directions: Array, particular: Array, others: str, cone: ConeChoice, form: str,
        engine: str | Sequence[str],
    ):  # fmt: skip
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
            found.append(WindowEnd(value, world, self._stopped_by(sign, local, world)))
        return found[0], found[1]

    def _stopped_by(self, sign: float, local: Array, world: Array) -> tuple[str, ...]:
        """Loaded contacts that are at the edge of their cones and, where the others are fixed, would leave it; joints at a limit."""
        W = self.data.units.force
        step = sign * STEP * (self.D[:, 0].reshape(-1, 6) * self.data.units.wrench)
        names = []
        for k, contact in enumerate(self.stance.contacts):
            if not contact.unilateral or self._reserve_of(k, local[k]) >= AT_THE_END * W:
                continue
            leaving = self._reserve_of(k, local[k] + step[k]) < -AT_THE_END * W
            if leaving if self.others == "fixed" else np.abs(local[k] / self.data.units.wrench).max() > AT_THE_END:
                names.append(contact.name)
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
