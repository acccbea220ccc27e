"""Which other optima a program has: the directions along which its variables, or its multipliers, stay optimal."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from socp_statics.engines.conic_form import ConicData, ConicForm
from socp_statics.exceptions import EngineError
from socp_statics.spatial import Array

# Slacks and multipliers below this, in units of the program, count as zero.
SMALL = 1e-6


class OptimalFace(NamedTuple):
    """The linear spans of the optimal sets at a strictly complementary optimum.

    Attributes:
        variables: Directions in z, orthonormal, shape (columns, a).
        multipliers: Directions in the conic multipliers, orthonormal, shape (rows, b).
        strict: Whether every slack is clearly positive or has a clearly positive multiplier; where not, the spans may be too large.
    """

    variables: Array
    multipliers: Array
    strict: bool


def optimal_face(form: ConicForm, data: ConicData, z: Array, y: Array) -> OptimalFace:
    """The optimal face of a program with a linear cost.

    Args:
        form: Canonical form of the program.
        data: The instance.
        z: Optimal variables, in the middle of their face as an interior-point method leaves them.
        y: Optimal conic multipliers.

    Returns:
        The spans.

    Raises:
        EngineError: The program has semidefinite cones.
    """
    if form.cones.psd:
        raise EngineError("optimal faces of programs with semidefinite cones are not known; ask in form 'socp'")
    A = data.A.toarray()
    s = data.b - A @ z
    fixed: list[Array] = [A[: form.cones.zero]]
    free: list[Array] = [np.eye(form.rows)[: form.cones.zero]]
    strict = True
    start = form.cones.zero
    for size in (*(1,) * form.cones.nonneg, *form.cones.soc):
        at = slice(start, start + size)
        inside, tight, clear = _held(s[at], y[at])
        fixed.append(inside @ A[at])
        embedded = np.zeros((len(tight), form.rows))
        embedded[:, at] = tight
        free.append(embedded)
        strict, start = strict and clear, start + size
    basis = np.vstack(free)
    return OptimalFace(_null(np.vstack(fixed)), basis.T @ _null((basis @ A).T), strict)


def _held(s: Array, y: Array) -> tuple[Array, Array, bool]:
    """Rows that a slack's change has to annul, directions that a multiplier may take, and whether the two are strictly complementary."""
    n = len(s)
    lengths = float(np.linalg.norm(s[1:])), float(np.linalg.norm(y[1:]))
    (s_low, s_high), (y_low, y_high) = ((v[0] - r, v[0] + r) for v, r in zip((s, y), lengths, strict=True))
    if s_low > SMALL:
        return np.zeros((0, n)), np.zeros((0, n)), y_high < SMALL
    if s_high < SMALL:
        return np.eye(n), np.eye(n), y_low > SMALL
    ray, against = (np.concatenate([[1.0], v[1:] / r]) / np.sqrt(2.0) if r else np.eye(n)[0] for v, r in zip((s, y), lengths, strict=True))
    return np.eye(n) - np.outer(ray, ray), against[None], y_high > SMALL and y_low < SMALL


def _null(rows: Array) -> Array:
    """Orthonormal basis of the null space."""
    if not rows.size:
        return np.eye(rows.shape[1])
    _, sigma, Vt = np.linalg.svd(rows)
    return Vt[int((sigma > SMALL).sum()) :].T
