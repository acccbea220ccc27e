"""The lever rule for any number of contacts: shares are barycentric coordinates of p among the contacts, none negative.

``F = C^-W F_C`` minimises ``sum_k |F_k|^2 / alpha_k`` with ``sum alpha_k r_k = p``; on level contacts every contact then carries alpha_k
of the weight. Two contacts have one choice of alpha and three in general position one; of more, the one with the least ``sum alpha_k^2``
is taken. Where p is outside the contacts it is first moved to the nearest point between two of them.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np

from socp_statics.distribution.lever_rule import in_triangle, lever_shares, on_nearest_segment
from socp_statics.distribution.load_line import LoadLine
from socp_statics.exceptions import EngineError
from socp_statics.spatial import Array

STEPS = 30
MET = 1e-10
FLAT = 1e-12


def barycentric_shares(line: LoadLine) -> Array:
    """Shares of the load by barycentric coordinates.

    Args:
        line: p and the contacts, of `load_line`, for one stance or a batch.

    Returns:
        alpha, shape (..., k), each >= 0, sum 1.
    """
    p, r = line.point, line.contacts
    k = r.shape[-2]
    if k == 1:
        return np.ones((*p.shape[:-1], 1))
    if k <= 3:
        return lever_shares(line)
    shape = p.shape[:-1]
    points, contacts = p.reshape(-1, 2), r.reshape(-1, k, 2)
    alpha = on_nearest_segment(points, contacts)
    inside = np.zeros(len(points), dtype=bool)
    for corners in combinations(range(k), 3):
        inside |= in_triangle(points, *(contacts[:, i] for i in corners))[1]
    alpha[inside] = least_squares_shares(points[inside], contacts[inside])
    return alpha.reshape(*shape, k)


def least_squares_shares(p: Array, r: Array) -> Array:
    """The shares with the least sum of squares, for points inside the hull of their contacts.

    The optimum has the form ``alpha = max(0, A^T y)`` with ``A = [1; r]``: Newton's method on ``A alpha = [1; p]``, and where it does not
    end, the best of all supports.

    Args:
        p: Shape (n, 2) [m].
        r: Shape (n, k, 2) [m].

    Returns:
        Shape (n, k).
    """
    centre = r.mean(axis=1, keepdims=True)
    size = np.sqrt(((r - centre) ** 2).sum(axis=2).max(axis=1))
    A = np.concatenate([np.ones((*r.shape[:2], 1)), (r - centre) / size[:, None, None]], axis=2).swapaxes(1, 2)
    b = np.concatenate([np.ones((len(p), 1)), (p - centre[:, 0]) / size[:, None]], axis=1)
    alpha, left = np.empty(r.shape[:2]), np.arange(len(p))
    active = np.ones(r.shape[:2], dtype=bool)
    for _ in range(STEPS):
        if not len(left):
            return alpha
        M = A[left] * active[left][:, None, :]
        y = np.linalg.pinv(M @ M.swapaxes(1, 2), rcond=FLAT, hermitian=True) @ b[left][:, :, None]
        raw = (A[left].swapaxes(1, 2) @ y)[:, :, 0]
        kept = np.maximum(raw, 0.0)
        met = np.abs((A[left] @ kept[:, :, None])[:, :, 0] - b[left]).max(axis=1) < MET
        alpha[left[met]] = kept[met]
        active[left] = raw > 0.0
        left = left[~met]
    for i in left:
        alpha[i] = _best_support(A[i], b[i])
    return alpha


def _best_support(A: Array, b: Array) -> Array:
    """The least-squares shares by trying every set of contacts that carry."""
    best: Array | None = None
    for size in range(1, A.shape[1] + 1):
        for support in combinations(range(A.shape[1]), size):
            part = np.zeros(A.shape[1])
            part[list(support)] = np.linalg.pinv(A[:, support]) @ b
            fits = np.abs(A @ part - b).max() < MET and part.min() >= -MET
            if fits and (best is None or part @ part < best @ best):
                best = np.maximum(part, 0.0)
    if best is None:
        raise EngineError("the barycentric shares of the load were not found", name="barycentric")
    return best
