"""A program in units of its own: rows and columns scaled to entries of about one, every cone as a whole (Ruiz 2001).

Friction of 1e8 or of 1e-9 puts entries of that size beside those of a balance. What rounding then leaves of an optimum is large beside
the smaller ones, and the larger ones hide it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.sparse as sp

from socp_statics.engines.conic_form import Cones, ConicData
from socp_statics.spatial import Array

ROUNDS = 20


class Equilibrated(NamedTuple):
    """A scaled program ``(E P E, E q, C A E, C b)`` and its units.

    Attributes:
        data: The scaled program; its cones are the same.
        columns: E, powers of two, shape (n,).
        rows: C, powers of two, one a cone, shape (m,).
    """

    data: ConicData
    columns: Array
    rows: Array

    def enter(self, x: Array, y: Array) -> tuple[Array, Array]:
        """Unknowns and multipliers in the units of the scaled program."""
        return x / self.columns, y / self.rows

    def leave(self, x: Array, y: Array) -> tuple[Array, Array]:
        """Unknowns and multipliers of the scaled program in the units of the original one."""
        return x * self.columns, y * self.rows


def equilibrated(data: ConicData, cones: Cones) -> Equilibrated:
    """Scale a program.

    Args:
        data: The program, without semidefinite cones.
        cones: Its cones.

    Returns:
        The scaled program; no digit of the original one is lost.
    """
    flat = cones.zero + cones.nonneg
    cone = np.concatenate([np.arange(flat), flat + np.repeat(np.arange(len(cones.soc)), cones.soc)]).astype(int)
    A, upper = np.abs(data.A.toarray()), np.abs(data.P.toarray())
    P = np.maximum(upper, upper.T)
    E, C = np.ones(A.shape[1]), np.ones(A.shape[0])
    for _ in range(ROUNDS):
        scaled = C[:, None] * A * E
        row = np.zeros(flat + len(cones.soc))
        np.maximum.at(row, cone, scaled.max(axis=1, initial=0.0))
        column = np.maximum(scaled.max(axis=0, initial=0.0), (E[:, None] * P * E).max(axis=0, initial=0.0))
        C /= np.sqrt(np.where(row > 0.0, row, 1.0))[cone]
        E /= np.sqrt(np.where(column > 0.0, column, 1.0))
    E, C = np.exp2(np.round(np.log2(E))), np.exp2(np.round(np.log2(C)))
    by_column, by_row = sp.diags_array(E), sp.diags_array(C)
    A_scaled, P_scaled = sp.csc_array(by_row @ data.A @ by_column), sp.csc_array(by_column @ data.P @ by_column)
    return Equilibrated(ConicData(P_scaled, E * data.q, A_scaled, C * data.b), E, C)
