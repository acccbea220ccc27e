"""The four fundamental subspaces of a matrix, by its singular values."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from socp_statics.spatial import Array
from socp_statics.statics.wrench_range import SINGULAR


class Subspaces(NamedTuple):
    """Orthonormal bases as columns.

    Attributes:
        matrix: The matrix, shape (m, n).
        singular_values: Descending, shape (min(m, n),).
        range: R(A), shape (m, r).
        left_null: N(A'), shape (m, m - r).
        row_space: R(A'), shape (n, r).
        null: N(A), shape (n, n - r).
    """

    matrix: Array
    singular_values: Array
    range: Array
    left_null: Array
    row_space: Array
    null: Array

    @property
    def rank(self) -> int:
        """Number of singular values that are not zero."""
        return self.range.shape[1]


def subspaces(A: Array) -> Subspaces:
    """The subspaces of a matrix in scaled units; singular values below 1e-9 count as zero.

    Args:
        A: Shape (m, n), either may be 0.
    """
    U, sigma, Vt = np.linalg.svd(A, full_matrices=True)
    r = int((sigma > SINGULAR).sum())
    return Subspaces(A, sigma, U[:, :r], U[:, r:], Vt[:r].T, Vt[r:].T)


def common(A: Array, B: Array) -> Array:
    """Intersection of two subspaces.

    Args:
        A: Orthonormal columns, shape (n, a).
        B: Orthonormal columns, shape (n, b).

    Returns:
        Orthonormal columns.
    """
    outside = A - B @ (B.T @ A)
    return A @ subspaces(outside).null
