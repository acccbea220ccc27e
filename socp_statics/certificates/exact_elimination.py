"""Linear systems in rational arithmetic, with the pivots chosen where floats say the system is well conditioned."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import numpy as np
from scipy.linalg import qr

from socp_statics.spatial import Array

Rationals = Sequence[Fraction]


def independent_columns(matrix: Array, rank_tolerance: float) -> list[int]:
    """Indices of columns that span the range of a matrix, the best conditioned first.

    Args:
        matrix: Shape (m, n).
        rank_tolerance: Pivots below this count as zero.
    """
    if not matrix.size:
        return []
    _, R, order = qr(matrix, mode="economic", pivoting=True)
    rank = int((np.abs(np.diag(R)) > rank_tolerance).sum())
    return [int(k) for k in order[:rank]]


def eliminate(columns: Sequence[Rationals], right: Rationals, doubtful: int | None = None, least: float = 0.0) -> list[Fraction] | None:
    """Solve ``sum_j x_j column_j = right`` exactly, columns in order of preference.

    A column that is zero on the rows that are left gets 0.

    Args:
        columns: Of the system, each of length m.
        right: Right-hand side, length m.
        doubtful: From this column on, entries no larger than ``least`` are taken for rounding and not used as pivots.
        least: See there.

    Returns:
        The solution, one number a column; None where a row is left over that the columns do not meet exactly.
    """
    rows = [[*entries, value] for *entries, value in zip(*columns, right, strict=True)]
    n = len(columns)
    pivots: list[int] = []
    done = 0
    for j in range(n):
        if done == len(rows):
            break
        best = max(range(done, len(rows)), key=lambda i: abs(rows[i][j]))
        if abs(rows[best][j]) <= (least if doubtful is not None and j >= doubtful else 0):
            continue
        rows[done], rows[best] = rows[best], rows[done]
        head = rows[done]
        for i in range(done + 1, len(rows)):
            if rows[i][j]:
                factor = rows[i][j] / head[j]
                rows[i] = [a - factor * b if b else a for a, b in zip(rows[i], head, strict=True)]
        pivots.append(j)
        done += 1
    if any(row[n] for row in rows[done:]):
        return None
    x = [Fraction(0)] * n
    for i in range(done - 1, -1, -1):
        j, row = pivots[i], rows[i]
        x[j] = (row[n] - sum((row[k] * x[k] for k in pivots[i + 1 :] if x[k]), Fraction(0))) / row[j]
    return x
