"""The largest ellipsoid inside a polytope of loads that can be balanced (John's ellipsoid).

    maximise    t <= (det E)^(1/k)
    subject to  |E a_j| + a_j . c <= b_j            every half-space a_j . z <= b_j
                [[E, Z], [Z', diag(Z)]] >= 0        Z lower triangular: prod Z_ii <= det E
                t^k <= prod Z_ii                    second-order cones, k = 2 or 3

The ellipsoid is ``{c + E u : |u| <= 1}`` with E symmetric positive semidefinite; t is the geometric mean of its semi-axes.
"""

from __future__ import annotations

from typing import NamedTuple

import cvxpy as cp
import numpy as np

from socp_statics.models.program import ConicModel, Program


class EllipsoidShape(NamedTuple):
    """Structure of the program: number of half-spaces, and coordinates (2 or 3)."""

    planes: int
    coordinates: int


def declare(shape: EllipsoidShape) -> Program:
    """The largest ellipsoid."""
    m, k = shape
    E, c, Z, t = cp.Variable((k, k), name="E"), cp.Variable(k, name="c"), cp.Variable((k, k), name="Z"), cp.Variable(name="t")
    a, b = cp.Parameter((m, k), name="a"), cp.Parameter(m, name="b")
    diagonal = cp.diag(cp.diag(Z))
    constraints: dict[str, cp.Constraint] = {
        "inside": cp.SOC(b - a @ c, a @ E, axis=1),
        "symmetric": cp.hstack([E[i, j] - E[j, i] for i in range(k) for j in range(i)]) == 0,
        "triangular": cp.hstack([Z[j, i] for i in range(k) for j in range(i)]) == 0,
        "determinant": cp.bmat([[E, Z], [Z.T, diagonal]]) >> 0,
    }
    variables = {"E": E, "c": c, "Z": Z, "t": t}
    if k == 2:
        constraints["mean"] = _below_mean(t, Z[0, 0], Z[1, 1])
    else:
        half = cp.Variable(2, name="half")
        variables["half"] = half
        # t^4 <= (Z_1 Z_2)(Z_3 t)
        constraints |= {
            "mean": _below_mean(t, half[0], half[1]),
            "first": _below_mean(half[0], Z[0, 0], Z[1, 1]),
            "second": _below_mean(half[1], Z[2, 2], t),
        }
    return Program(cp.Problem(cp.Maximize(t), list(constraints.values())), variables, constraints)


def _below_mean(t: cp.Expression, a: cp.Expression, b: cp.Expression) -> cp.Constraint:
    """``t^2 <= a b`` with a, b >= 0."""
    return cp.SOC(a + b, cp.hstack([2.0 * t, a - b]))


def padded(normals: np.ndarray, offsets: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Half-spaces repeated up to a power of two, so that few shapes are ever compiled.

    Args:
        normals: Shape (m, k).
        offsets: Shape (m,).
    """
    wanted = 1 << (len(offsets) - 1).bit_length()
    index = np.arange(wanted) % len(offsets)
    return normals[index], offsets[index]


MODEL = ConicModel("inscribed_ellipsoid", declare, semidefinite=True)
