"""Which loads the contacts can reach at all, whatever their cones: the range of the wrench map."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from socp_statics.spatial import Array

SINGULAR = 1e-9
INSIDE = 1e-12
OUTSIDE = 1e-7


class WrenchRange(NamedTuple):
    """Orthonormal bases of what a map reaches and of what it never reaches, shapes (m, r) and (m, m - r), m = 6 for wrenches."""

    basis: Array
    null: Array

    @property
    def rank(self) -> int:
        """Dimension of the range."""
        return self.basis.shape[1]

    def outside(self, load: Array) -> float:
        """Largest share of a scaled load that is out of reach."""
        return float(np.linalg.norm(self.null.T @ load)) if self.null.shape[1] else 0.0


def wrench_range(wrench_map: Array) -> WrenchRange:
    """Range of a scaled wrench map; singular values below 1e-9 count as zero.

    Args:
        wrench_map: Columns are wrenches in scaled units, shape (6, n); further rows may be stacked below.

    Returns:
        The range; the identity where the rank is full, so that rows keep their meaning.
    """
    U, s, _ = np.linalg.svd(wrench_map, full_matrices=True)
    rank = int((s > SINGULAR).sum())
    rows = len(wrench_map)
    if rank == rows:
        return WrenchRange(np.eye(rows), np.zeros((rows, 0)))
    return WrenchRange(U[:, :rank], U[:, rank:])
