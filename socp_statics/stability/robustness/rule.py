"""Affine force rules: designed for the largest ball of disturbances, and checked exactly."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from socp_statics.certificates import force_residuals
from socp_statics.cones.choice import ConeChoice
from socp_statics.engines.engine import Engine
from socp_statics.engines.solution import SOLVED
from socp_statics.exceptions import EngineError
from socp_statics.models.contact_forces_set import force_shape, force_values
from socp_statics.models.force_rule import MODEL, RuleShape
from socp_statics.models.rule_check import MODEL as CHECK
from socp_statics.models.rule_check import RuleCheckShape
from socp_statics.spatial import Array
from socp_statics.stability.robustness.disturbances import Disturbance
from socp_statics.statics import StaticsData, point_forces, wrench_range
from socp_statics.statics.added_load import with_load

# Largest radius asked for, in units of the load.
CAP = 30.0
# Slack of cones and rows, and rest of the balance, that count as kept, in units of W, or of the forces where they are larger.
KEPT = 1e-7
# Sections of the interval of a multiplier, each by the golden ratio.
REFINED = 70
GOLDEN = 0.6180339887498949


class RuleCheck(NamedTuple):
    """Whether a rule holds for all disturbances of the unit ball.

    Attributes:
        holds: Whether it does, to 1e-7 of W (of the forces where they are larger) in every cone, row and the balance.
        slack: Least slack of cones (the least eigenvalue of the S-lemma, in squares of that) and rows; negative where one breaks.
        balance: Rest of the balance over the unit ball, scaled.
        worst: The disturbance of the unit ball that breaks it most, shape (k,); None where it holds or only the balance is wrong.
    """

    holds: bool
    slack: float
    balance: float
    worst: Array | None


@dataclass(frozen=True, eq=False)
class ForceRule:
    """``x(u) = x_0 + X u`` for the disturbances ``z = radius u``, |u| <= 1, scaled.

    Attributes:
        data: The stance's arrays.
        cone: Exact cones or pyramids.
        disturbance: Of which the radius is.
        radius: Of the ball, scaled.
        nominal: x_0, shape (nx,).
        reaction: X, shape (nx, k).
    """

    data: StaticsData
    cone: ConeChoice
    disturbance: Disturbance
    radius: float
    nominal: Array
    reaction: Array

    def forces(self, u: Array) -> Array:
        """Scaled forces at a disturbance of the unit ball."""
        return self.nominal + self.reaction @ u

    def residual(self, u: Array) -> float:
        """How far the forces at a disturbance are from balance and cones, in units of W."""
        z = self.radius * u
        at = with_load(self.data, self.disturbance.wrench, self.disturbance.relief(self.data), self.disturbance.torque, z)
        return max(force_residuals(at, self.cone, self.forces(u)))

    def entries(self) -> list[dict[str, Any]]:
        """Records of the rule, one a point: its force without disturbance [N], and the change of it per unit of each coordinate.

        The coordinates are those of `Disturbance.axes`; handles and soft fingers also have moments.
        """
        per_unit = self.reaction @ self.disturbance.axes.T / (self.radius * self.disturbance.one) if self.radius else None
        out = point_forces(self.data, self.nominal).entries()
        if per_unit is None:
            return out
        changes = [point_forces(self.data, column).entries() for column in per_unit.T]
        for i, entry in enumerate(out):
            entry["force_gain"] = np.array([change[i]["force"] for change in changes]).T.tolist()
            if "moment" in entry:
                entry["moment_gain"] = np.array([change[i]["moment"] for change in changes]).T.tolist()
        return out


def design_rule(data: StaticsData, seen: Disturbance, cone: ConeChoice, form: str, engine: Engine) -> ForceRule:
    """The affine rule with the largest ball.

    Args:
        data: Arrays of a stance that holds.
        seen: The disturbances, in coordinates that all matter and that contacts can resist.
        cone: Exact cones or pyramids.
        form: "socp" or "sdp".
        engine: One that takes semidefinite cones.

    Raises:
        EngineError: The engine did not settle it.
    """
    reach = wrench_range(data.wrench_map)
    shape = RuleShape(force_shape(data, cone, form, reach.rank)._replace(joints=0), seen.wrench.shape[1])
    values = force_values(data, cone, reach.basis) | {
        "B": reach.basis.T @ seen.wrench,
        "R": seen.relief(data),
        "H": data.limit_rows,
        "cap": np.array(CAP),
    }
    solution = engine.compile(MODEL, shape).solve(values)
    if solution.status != SOLVED:
        raise EngineError(f"engine {engine.name} did not settle a force rule: {solution.detail}", name=engine.name)
    Y = solution.variables["Y"]
    return ForceRule(data, cone, seen, max(float(solution.variables["t"]), 0.0), Y[:, 0].copy(), Y[:, 1:].copy())


def check_rule(rule: ForceRule, engine: Engine) -> RuleCheck:
    """Whether a rule keeps balance, cones, bounds and limits for all disturbances of its ball; exact, by the S-lemma.

    Args:
        rule: Any rule.
        engine: One that takes semidefinite cones.

    Raises:
        EngineError: The engine did not settle it.
    """
    data, k = rule.data, rule.reaction.shape[1]
    Y = np.column_stack([rule.nominal, rule.reaction])
    load = np.column_stack([data.load, rule.radius * rule.disturbance.wrench])
    size = max(1.0, float(np.linalg.norm(Y)))
    left = np.linalg.norm(data.wrench_map @ Y + load, axis=0) / size
    balance = float(left[0] + np.linalg.norm(left[1:]))
    cones, rows = _cones_and_rows(rule, Y)
    cones, rows = [(c / size, A / size) for c, A in cones], rows / size
    slack, kept, breaks = np.inf, True, [(0.0, np.zeros(k))]
    if len(rows):
        room = rows[:, 0] - np.linalg.norm(rows[:, 1:], axis=1)
        i = int(np.argmin(room))
        slack, kept = float(room[i]), bool(room[i] >= -KEPT)
        breaks.append((-slack, _unit(-rows[i, 1:])))
    if cones:
        Q = np.vstack([np.outer(c, c) - A.T @ A for c, A in cones])
        solution = engine.compile(CHECK, RuleCheckShape(len(cones), k)).solve({"Q": Q})
        if solution.status != SOLVED:
            raise EngineError(f"engine {engine.name} did not settle the check of a force rule: {solution.detail}", name=engine.name)
        slack, q = min(slack, float(solution.objective)), solution.variables["q"]
        for i, (c, A) in enumerate(cones):
            if not _kept(c, A, float(q[i])):
                kept = False
                u = _least(np.outer(c, c) - A.T @ A)
                one = np.append(1.0, u)
                breaks.append((float(np.linalg.norm(A @ one) - c @ one), u))
    return RuleCheck(kept and balance <= KEPT, slack, balance, None if kept else max(breaks, key=lambda entry: entry[0])[1])


def _kept(c: Array, A: Array, q: float) -> bool:
    """Whether a cone wider by 1e-7 W is kept: the solver's multiplier, refined until only rounding is left.

    The least eigenvalue is concave in the multiplier, and any multiplier >= 0 with one >= 0 proves it.
    """
    wider = c + KEPT * np.eye(len(c))[0]
    Q, ball = np.outer(wider, wider) - A.T @ A, np.diag([1.0] + (len(c) - 1) * [-1.0])

    def least(multiplier: float) -> float:
        return float(np.linalg.eigvalsh(Q - multiplier * ball)[0])

    low, high = 0.0, 2.0 * max(q, KEPT)
    for _ in range(REFINED):
        a, b = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
        low, high = (low, b) if least(a) >= least(b) else (a, high)
    rounding = 1e-15 * max(1.0, float(np.abs(Q).max()))
    return max(least(low), least(high), least(0.0)) >= -(KEPT**2) - rounding


def _cones_and_rows(rule: ForceRule, Y: Array) -> tuple[list[tuple[Array, Array]], Array]:
    """Second-order cones ``|A (1, u)| <= c . (1, u)`` of a rule, and rows ``a . (1, u) >= 0``, those of the grips among them."""
    data, cone = rule.data, rule.cone
    f_t, f_n, m_n = Y[data.tangential].reshape(data.slipping, 2, -1), Y[data.normal], Y[data.torsional]
    mu = data.friction * (1.0 if cone.is_exact else cone.slope_factor())
    slope = mu[:, None] * f_n[: data.slipping]
    soft = data.circular - data.box
    rows = [*f_n]
    cones: list[tuple[Array, Array]] = []
    for i in range(data.slipping):
        finger = i >= soft
        spin = m_n[i - soft] * (mu[i] / data.torsion[i - soft]) if finger else np.zeros(Y.shape[1])
        elliptic = i >= data.circular
        if finger and (not elliptic or cone.kind == "circumscribed"):
            grip = data.torsion[i - soft] * f_n[i]
            rows += [grip + m_n[i - soft], grip - m_n[i - soft]]
        if cone.is_exact:
            cones.append((slope[i], np.vstack([f_t[i], spin]) if elliptic else f_t[i]))
        elif elliptic and cone.kind == "inscribed":
            rows += [slope[i] - face @ f_t[i] + sign * spin for face in cone.face_normals() for sign in (1.0, -1.0)]
        else:
            rows += [slope[i] - face @ f_t[i] for face in cone.face_normals()]
    for owner, (lo, hi) in zip(data.bounded, data.bounds, strict=True):
        total = f_n[data.contact_of_point == owner].sum(axis=0)
        rows.append(total - lo * np.eye(Y.shape[1])[0])
        if np.isfinite(hi):
            rows.append(hi * np.eye(Y.shape[1])[0] - total)
    if len(data.limit_values):
        ends = np.column_stack([data.limit_values, rule.radius * rule.disturbance.relief(data)])
        rows += [*(ends - data.limit_rows @ Y)]
    return cones, np.array(rows).reshape(-1, Y.shape[1])


def _least(Q: Array) -> Array:
    """Where ``(1, u) Q (1, u)'`` is least over the unit ball, by its secular equation, shape (k,)."""
    w, V = np.linalg.eigh(Q[1:, 1:])
    b = V.T @ Q[1:, 0]
    low, high = max(0.0, -float(w[0])), max(0.0, -float(w[0])) + float(np.linalg.norm(b)) + 1.0

    def at(shift: float) -> Array:
        return -np.divide(b, w + shift, out=np.zeros_like(b), where=np.abs(w + shift) > 0.0)

    if float(np.linalg.norm(at(low))) < 1.0:
        # Inside, or in the hard case, where the least direction itself fills the rest of the ball.
        u = at(low)
        if w[0] < 0.0:
            u[0] += np.sqrt(1.0 - float(u @ u))
        return V @ u
    for _ in range(REFINED):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if float(np.linalg.norm(at(middle))) > 1.0 else (low, middle)
    return _unit(V @ at(high))


def _unit(v: Array) -> Array:
    size = float(np.linalg.norm(v))
    return v / size if size else v
