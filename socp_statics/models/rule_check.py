"""Does a given affine force rule keep its forces in their cones for every disturbance of the unit ball? The S-lemma, exactly.

    maximise    s
    subject to  Q_i - q_i diag(1, -1, ..., -1) - s 1 >= 0,   q_i >= 0        every cone i

With ``c(u) = c_0 + c . u`` the grip and ``a(u) = a_0 + A u`` what it has to hold, Q_i is the matrix of ``c(u)^2 - |a(u)|^2`` in (1, u).
It is nonnegative for all |u| <= 1 exactly where s >= 0 (S-lemma), and ``|a| <= c`` then holds where also ``c_0 >= |c|``.
"""

from __future__ import annotations

from typing import NamedTuple

import cvxpy as cp
import numpy as np

from socp_statics.models.program import ConicModel, Program


class RuleCheckShape(NamedTuple):
    """Structure of the check: number of cones and coordinates of the disturbance."""

    cones: int
    coordinates: int


def declare(shape: RuleCheckShape) -> Program:
    """The check of all cones."""
    n, k = shape
    s, q = cp.Variable(name="s"), cp.Variable(n, name="q")
    ball, eye = np.diag([1.0] + k * [-1.0]), np.eye(1 + k)
    Q = cp.Parameter((n * (1 + k), 1 + k), name="Q")
    constraints: dict[str, cp.Constraint] = {
        f"cone[{i}]": Q[i * (1 + k) : (i + 1) * (1 + k)] - q[i] * ball - s * eye >> 0 for i in range(n)
    }
    constraints["multipliers"] = q >= 0
    return Program(cp.Problem(cp.Maximize(s), list(constraints.values())), {"s": s, "q": q}, constraints)


MODEL = ConicModel("rule_check", declare, semidefinite=True)
