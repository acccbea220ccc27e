"""The conic program of a posture and of a small motion of it, with the numbers it has at a posture."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from socp_statics.cones.choice import ConeChoice
from socp_statics.contacts import Stance
from socp_statics.engines import engines_for
from socp_statics.engines.solution import SOLVED, Solution
from socp_statics.models.contact_forces_set import force_shape, force_values
from socp_statics.models.posture_optimization import MODEL, PostureStepShape
from socp_statics.models.repeated_forces import RepeatedForces, block_rows, repeated_forces
from socp_statics.optimization.com_directions import com_directions
from socp_statics.postures import Posture
from socp_statics.postures.held_contacts import HeldContacts
from socp_statics.spatial import Array, skew
from socp_statics.statics import StaticsData, assemble
from socp_statics.statics.contact_wrenches import contact_wrenches
from socp_statics.statics.static_derivatives import StaticDerivatives

# Keeps motions that gain nothing out of a step; too little to be seen in a gain.
DAMPING = 1e-6
CAP, FARTHEST = 1.0, 100.0


@dataclass(frozen=True, eq=False)
class Question:
    """What is asked of every posture on the way.

    Attributes:
        stance_of: The stance of a posture, with loads and limits.
        held: The contacts that stay.
        objective: "margin", "torque" or "com_margin".
        cone: Exact cones or pyramids.
        engine: Which engines to try.
    """

    stance_of: Callable[[Posture], Stance]
    held: HeldContacts
    objective: str
    cone: ConeChoice
    engine: str | Sequence[str]


class Slopes:
    """How balance and torque rows change along the motions that keep the contacts, at a posture and its optimal forces; scaled.

    Attributes:
        motions: Orthonormal motions, shape (nv, m).
        balance: A, one block for each choice of forces, shape (copies, 6, m).
        torques: Change of the joint torques, shape (copies, n, m).
    """

    def __init__(self, at: AtPosture, forces: Array):
        held, posture, units = at.question.held, at.posture, at.data.units
        self.motions = held.motions(posture)
        derivatives = StaticDerivatives(at.stance, held.turning)
        to_origin = np.kron(np.eye(2), posture.R_WB)
        to_origin[3:, :3] = skew(posture.p_WB - units.origin) @ posture.R_WB
        turning = posture.R_WB @ self.motions[3:6]
        balance, torques = [], []
        for x in forces:
            changed = derivatives.of(contact_wrenches(at.data, x)) @ self.motions
            block = -(to_origin @ changed[:6])
            # the derivatives are in base axes: a moment that a displaced centre of mass has to balance turns with them
            left = at.data.wrench_map @ x + at.data.load
            block[3:] -= skew(left[3:] * units.force * units.length) @ turning
            balance.append(block / units.wrench[:, None])
            torques.append(changed[6:] / (units.force * units.length))
        self.balance, self.torques = np.array(balance), np.array(torques)


class AtPosture:
    """The program at one posture.

    Attributes:
        question: What is asked.
        posture: The posture.
        stance: Its stance.
        data: The stance's arrays.
        directions: Of a CoM margin, unit vectors, shape (k, 2), None for other objectives or where there is no region.
        value: The objective, larger is better: the margin in units of W, minus the worst share, or the CoM margin in units of the size;
            -inf where there is none.
        settled: Whether an engine settled the program.
    """

    def __init__(self, question: Question, posture: Posture):
        self.question, self.posture = question, posture
        self.stance = question.stance_of(posture)
        self.data: StaticsData = assemble(self.stance)
        by_com = question.objective == "com_margin"
        self.directions = com_directions(self.stance, question.cone, question.engine) if by_com else None
        self._copies = 1 if self.directions is None else len(self.directions)
        solution = None if self.without_edge else self._solved(None, np.zeros((posture.robot.pin_model.nv, self.columns)))
        self.settled = solution is not None
        self.value = -np.inf if solution is None else float(solution.variables["t"])
        self._forces = None if solution is None else solution.variables["x"][self._set.columns]

    @cached_property
    def slopes(self) -> Slopes:
        """The slopes at the optimal forces."""
        assert self._forces is not None
        return Slopes(self, self._forces)

    @property
    def unlimited(self) -> bool:
        """Whether nothing limits the margin."""
        return self.value >= CAP * (1.0 - 1e-6) and self.question.objective == "margin"

    @property
    def without_edge(self) -> bool:
        """Whether a CoM margin is asked for where the region has no edges to keep away from."""
        return self.question.objective == "com_margin" and self.directions is None

    @cached_property
    def columns(self) -> int:
        """Number of motions that keep the contacts."""
        return self.question.held.motions(self.posture).shape[1]

    def step(self, trust: float, slopes: Slopes | None = None, damping: float = DAMPING) -> tuple[Array, float] | None:
        """The best motion within a trust radius.

        Args:
            trust: Largest length of the motion: joints [rad], displacement of the base over the contacts' size.
            slopes: Slopes of another posture nearby; this one's by default.
            damping: rho.

        Returns:
            The motion, shape (nv,), and the value it promises; None where no engine settled the program.
        """
        used = slopes or self.slopes
        motions = used.motions
        if slopes is not None:
            # the motions that the other posture's slopes are for, as far as this one's contacts allow them
            scale = self.question.held.scale[:, None]
            allowed = self.question.held.motions(self.posture)
            motions = allowed @ ((allowed / scale).T @ (slopes.motions / scale))
            if len(slopes.balance) != self._copies:
                return None
        solution = self._solved(used, motions, trust, damping)
        return None if solution is None else (motions @ solution.variables["z"], float(solution.variables["t"]))

    def optimality(self) -> float:
        """What the linearised program still promises within a motion of length one: it bounds the residual of the KKT conditions."""
        step = self.step(1.0, damping=0.0)
        return np.inf if step is None else step[1] - self.value

    @cached_property
    def _set(self) -> RepeatedForces:
        """The set without the torque rows, which the step states itself, once for each direction."""
        data, handles, cone = self.data, self.data.handle_limits, self.question.cone
        shape = force_shape(data, cone, "socp", 6)._replace(limits=handles, joints=0)
        values = force_values(data, cone, np.eye(6)) | {"H": data.limit_rows[:handles], "limit": data.limit_values[:handles]}
        return repeated_forces(shape, values, self._copies)

    @cached_property
    def _fixed(self) -> tuple[PostureStepShape, dict[str, Any]]:
        """Structure and numbers of the program but for the motion."""
        data, torques, handles, k = self.data, self.data.torques, self.data.handle_limits, self._copies
        robot, angles, forces = self.posture.robot, self.posture.angles, self._set
        lower, upper = torques.limits[:, 0], torques.limits[:, 1]
        share = np.concatenate([upper[np.isfinite(upper)], -lower[np.isfinite(lower)]])
        room = np.concatenate([(robot.upper - angles)[np.isfinite(robot.upper)], (angles - robot.lower)[np.isfinite(robot.lower)]])
        directions = 0 if self.directions is None else k
        shape = PostureStepShape(forces.shape, self.columns, k * len(share), len(room), self.question.objective, directions)
        values = forces.values | {
            "room": np.maximum(room, 0.0),
            "H_torque": block_rows(data.limit_rows[handles:], forces.columns, forces.shape.columns),
            "d_torque": np.tile(data.limit_values[handles:], k),
            "u_torque": np.tile(share, k),
            "cap": CAP if self.directions is None else FARTHEST,
        }
        if self.directions is not None:
            values |= {"D": np.kron(np.eye(k), data.com_load), "d": self._reach()}
        return shape, values

    def _reach(self) -> Array:
        """Rows ``d_k . s_k``, shape (k, 2 k)."""
        assert self.directions is not None
        rows = np.zeros((self._copies, 2 * self._copies))
        for k, d in enumerate(self.directions):
            rows[k, 2 * k : 2 * k + 2] = d
        return rows

    def _solved(self, slopes: Slopes | None, motions: Array, trust: float = 1.0, damping: float = 0.0) -> Solution | None:
        """The program with slopes along motions; without slopes, with a motion that changes nothing."""
        shape, fixed = self._fixed
        robot, limits = self.posture.robot, self.data.torques.limits
        over, under = np.isfinite(robot.upper), np.isfinite(robot.lower)
        above, below = np.isfinite(limits[:, 1]), np.isfinite(limits[:, 0])
        m, k, n = motions.shape[1], self._copies, len(robot.joints)
        A, B = (np.zeros((k, 6, m)), np.zeros((k, n, m))) if slopes is None else (slopes.balance, slopes.torques)
        values = fixed | {
            "A": A.reshape(6 * k, m),
            "Q": np.vstack([motions[6:][over], -motions[6:][under]]),
            "V": np.vstack([row for block in B for row in (block[above], -block[below])]),
            "trust": trust,
            "rho": damping,
        }
        for one in engines_for(self.question.engine):
            solution = one.compile(MODEL, shape._replace(coordinates=m)).solve(values)
            if solution.status == SOLVED:
                return solution
        return None
