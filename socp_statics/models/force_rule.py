"""Forces that react to a disturbance by an affine rule: the largest ball of disturbances that one rule holds.

    maximise    t
    subject to  x(u) = x_0 + X u
                G x_0 + L = 0,  G X + t B = 0        balance for the disturbance z = t u, whatever u
                x(u) in every cone, bound and limit for all |u| <= 1
                0 <= t <= cap

"For all |u| <= 1" is exact, by convex constraints on x_0 and X:

- linear rows a(u) >= 0: ``a_0 >= |a|``, a second-order cone;
- round cones: with p_j(w) = w'[[mu n_j + x_j, y_j], [y_j, mu n_j - x_j]]w for the parts j = 0..k of normal force n and tangential
  forces x and y, the cone holds exactly where ``p_0(w) >= |(p_1, ..., p_k)(w)|`` for all w in the plane: an arrow matrix of univariate
  quadratics that is positive semidefinite everywhere, hence a sum of squares: ``[[arrow(a), arrow(b) + S], [arrow(b) - S, arrow(c)]] >= 0``
  for some skew S, a = mu n + x, b = y, c = mu n - x;
- elliptic soft fingers: ``|f_t(u), (mu/gamma) m_n(u)| <= mu (n_0 - |n|)``, which suffices, as a linear matrix inequality (S-lemma).

So the radius is the largest of any affine rule where no soft finger is elliptic, and a lower bound of the largest ball of any reaction.
"""

from __future__ import annotations

from typing import NamedTuple

import cvxpy as cp
import numpy as np
import scipy.sparse as sp

from socp_statics.models.contact_forces_set import ForceShape
from socp_statics.models.program import ConicModel, Program
from socp_statics.spatial import Array


class RuleShape(NamedTuple):
    """Structure of the program: forces, with torque limits as plain rows, and coordinates of the disturbance."""

    forces: ForceShape
    coordinates: int


class _Parts(NamedTuple):
    """Components of ``[x_0, X]`` by kind, one row each, shape (n, 1 + k)."""

    f_t: cp.Expression
    f_n: cp.Expression
    m_n: cp.Expression


def declare(shape: RuleShape) -> Program:
    """The force rule program."""
    s, k = shape.forces, shape.coordinates
    Y = cp.Variable((s.columns, 1 + k), name="Y")
    t = cp.Variable(name="t")
    ends = np.cumsum([0, 2 * s.slipping, s.points, s.box + s.elliptic])
    parts = _Parts(*(Y[a:b] if b > a else cp.Constant(np.zeros((0, 1 + k))) for a, b in zip(ends[:-1], ends[1:], strict=True)))
    load, B = cp.Parameter(s.rows, name="load"), cp.Parameter((s.rows, k), name="B")
    G = cp.Parameter((s.rows, s.columns), name="G")
    variables = {"Y": Y, "t": t}
    constraints: dict[str, cp.Constraint] = {
        "balance": G @ Y[:, 0] == -load,
        "reaction": G @ Y[:, 1:] + t * B == 0,
        "radius": t >= 0,
        "cap": t <= cp.Parameter(name="cap"),
    }
    constraints |= _friction(s, k, parts, variables)
    constraints |= _bounds(s, parts)
    if s.limits:
        rows = cp.Parameter((s.limits, s.columns), name="H") @ Y
        moved = t * cp.Parameter((s.limits, k), name="R")
        constraints["limits"] = _everywhere(cp.Parameter(s.limits, name="limit") - rows[:, 0], moved - rows[:, 1:])
    return Program(cp.Problem(cp.Maximize(t), list(constraints.values())), variables, constraints)


def _everywhere(first: cp.Expression, others: cp.Expression) -> cp.Constraint:
    """``first_i + others_i . u >= 0`` for all |u| <= 1, row by row."""
    return cp.SOC(first, others, axis=1)


def _scaled(factors: cp.Expression, rows: cp.Expression) -> cp.Expression:
    """Rows times their factors."""
    return cp.multiply(cp.reshape(factors, (factors.size, 1), order="F"), rows)


def _friction(s: ForceShape, k: int, parts: _Parts, variables: dict[str, cp.Variable]) -> dict[str, cp.Constraint]:
    out: dict[str, cp.Constraint] = {}
    if s.frictionless:
        smooth = parts.f_n[s.slipping :]
        out["unilateral"] = _everywhere(smooth[:, 0], smooth[:, 1:])
    if not s.slipping:
        return out
    mu = cp.Parameter(s.slipping, name="mu", nonneg=True)
    slope = _scaled(mu, parts.f_n[: s.slipping])
    x, y = parts.f_t[0 : 2 * s.slipping : 2], parts.f_t[1 : 2 * s.slipping : 2]
    if s.sides:
        face = cp.Parameter((s.sides, 2), name="face")
        rows = [slope[: s.circular] - face[j, 0] * x[: s.circular] - face[j, 1] * y[: s.circular] for j in range(s.sides)]
        if s.circular:
            stacked = cp.vstack(rows)
            out["friction"] = _everywhere(stacked[:, 0], stacked[:, 1:])
    elif s.circular:
        out |= _round(s.circular, k, slope, x, y, variables)
    if s.box:
        grip = _scaled(cp.Parameter(s.box + s.elliptic, name="gamma", nonneg=True)[: s.box], parts.f_n[s.circular - s.box : s.circular])
        stacked = cp.vstack([grip + parts.m_n[: s.box], grip - parts.m_n[: s.box]])
        out["torsion"] = _everywhere(stacked[:, 0], stacked[:, 1:])
    if s.elliptic:
        ratio = cp.Parameter(s.box + s.elliptic, name="mu_over_gamma", nonneg=True)
        spin = _scaled(ratio[s.box :], parts.m_n[s.box :])
        mine = slice(s.circular, s.slipping)
        if s.sides:
            stacked = cp.vstack([slope[mine] - face[j, 0] * x[mine] - face[j, 1] * y[mine] + sign * spin
                                 for j in range(s.sides) for sign in (1.0, -1.0)])  # fmt: skip
            out["soft_finger"] = _everywhere(stacked[:, 0], stacked[:, 1:])
        else:
            out |= _elliptic(s, k, slope[mine], [x[mine], y[mine], spin], variables)
    return out


def _round(
    count: int, k: int, slope: cp.Expression, x: cp.Expression, y: cp.Expression, variables: dict[str, cp.Variable]
) -> dict[str, cp.Constraint]:
    """Round cones as sums of squares, one matrix a point."""
    first, second, third, skew = _gram_maps(k)
    S = cp.Variable((count, k * (k + 1) // 2), name="S")
    variables["S"] = S
    n = 2 * (k + 1)
    return {
        f"friction[{i}]": cp.reshape(first @ (slope[i] + x[i]) + second @ y[i] + third @ (slope[i] - x[i]) + skew @ S[i], (n, n), order="F")
        >> 0
        for i in range(count)
    }


def _gram_maps(k: int) -> tuple[sp.csc_array, ...]:
    """Columns are the matrices of unit parts a_j, b_j, c_j, and of unit skew entries, as vectors."""
    m = k + 1
    arrows, skews = [], []
    for j in range(m):
        arrow = np.eye(m) if j == 0 else np.zeros((m, m))
        arrow[0, j] = arrow[j, 0] = 1.0
        arrows.append(arrow)
    for i in range(m):
        for j in range(i):
            skew = np.zeros((m, m))
            skew[i, j], skew[j, i] = 1.0, -1.0
            skews.append(skew)

    def vectors(corner: Array, blocks: list[Array]) -> sp.csc_array:
        return sp.csc_array(np.column_stack([np.kron(corner, block).ravel(order="F") for block in blocks]))

    off = np.array([[0.0, 1.0], [0.0, 0.0]])
    both = np.column_stack([(np.kron(off, a) + np.kron(off.T, a.T)).ravel(order="F") for a in arrows])
    turned = np.column_stack([(np.kron(off, a) + np.kron(off.T, a.T)).ravel(order="F") for a in skews])
    return vectors(np.diag([1.0, 0.0]), arrows), sp.csc_array(both), vectors(np.diag([0.0, 1.0]), arrows), sp.csc_array(turned)


def _elliptic(
    s: ForceShape, k: int, slope: cp.Expression, grip: list[cp.Expression], variables: dict[str, cp.Variable]
) -> dict[str, cp.Constraint]:
    """Elliptic soft fingers: the ball that the rule makes of tangential force and spin, inside the least cone section of any u."""
    r, q = cp.Variable(s.elliptic, name="r"), cp.Variable(s.elliptic, name="q")
    variables |= {"r": r, "q": q}
    out: dict[str, cp.Constraint] = {"least_grip": _everywhere(slope[:, 0] - r, slope[:, 1:])}
    for i in range(s.elliptic):
        A = cp.vstack([row[i] for row in grip])
        first = cp.reshape(A[:, 0], (3, 1), order="F")
        out[f"soft_finger[{i}]"] = cp.bmat([
            [cp.reshape(r[i] - q[i], (1, 1), order="F"), np.zeros((1, k)), first.T],
            [np.zeros((k, 1)), q[i] * np.eye(k), A[:, 1:].T],
            [first, A[:, 1:], r[i] * np.eye(3)],
        ]) >> 0  # fmt: skip
    return out


def _bounds(s: ForceShape, parts: _Parts) -> dict[str, cp.Constraint]:
    out: dict[str, cp.Constraint] = {}
    if s.lower:
        sums = cp.Parameter((s.lower, s.points), name="S_lower") @ parts.f_n
        out["lower_bound"] = _everywhere(sums[:, 0] - cp.Parameter(s.lower, name="lo"), sums[:, 1:])
    if s.upper:
        sums = cp.Parameter((s.upper, s.points), name="S_upper") @ parts.f_n
        out["upper_bound"] = _everywhere(cp.Parameter(s.upper, name="hi") - sums[:, 0], sums[:, 1:])
    if s.equal:
        sums = cp.Parameter((s.equal, s.points), name="S_equal") @ parts.f_n
        out["equal_bound"] = sums[:, 0] == cp.Parameter(s.equal, name="equal")
        out["equal_reaction"] = sums[:, 1:] == 0
    return out


MODEL = ConicModel("force_rule", declare, semidefinite=True)
