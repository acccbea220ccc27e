"""Which loads the contacts can reach at all, whatever their cones: the range of the wrench map."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from socp_statics.spatial import Array

SINGULAR = 1e-9
INSIDE = 1e-12
OUTSIDE = 1e-7
# Below this singular value a direction is weak: what a solver leaves of its balance takes forces many times as large to make good.
WEAK = 1e-4
# No row is enlarged more than this value asks for, else the rounding of the load would be enlarged beyond what a solver leaves.
WEAKEST = 1e-7


class WrenchRange(NamedTuple):
    """Bases of what a map reaches and of what it never reaches, shapes (m, r) and (m, m - r), m = 6 for wrenches.

    The second is orthonormal. The rows of a balance are those of the map times the first one, ``basis' (G x + L) = 0``, and its
    multipliers y the twist ``basis y``.
    """

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
        The range; its basis is the identity where the rank is full and no direction is weak, so that rows keep their meaning, and
        orthonormal where the rank is less. Where a direction is weak, as about a line that all points hardly leave, the
        basis has columns as long as 1 / singular value, so that all rows of a balance count alike.
    """
    U, s, _ = np.linalg.svd(wrench_map, full_matrices=True)
    rank = int((s > SINGULAR).sum())
    rows = len(wrench_map)
    if rank and s[rank - 1] < WEAK:
        return WrenchRange(U[:, :rank] / np.maximum(s[:rank], WEAKEST), U[:, rank:])
    if rank == rows:
        return WrenchRange(np.eye(rows), np.zeros((rows, 0)))
    return WrenchRange(U[:, :rank], U[:, rank:])
