"""What is done once for all right-hand sides: scaling, elimination of free unknowns and repeated rows, order, structure and workspace.

Unknowns that cones or P tell apart are kept; the others ("free") are expressed by equality rows. The scaled program is
``P <- E P E``, ``A <- R A E``, ``G <- C G E``.
"""

from __future__ import annotations

import numpy as np

from socp_statics.engines.kernel import layout as at
from socp_statics.engines.kernel.blocks import blocks_of
from socp_statics.engines.kernel.compilation import inner
from socp_statics.engines.kernel.layout import COUNT_E, COUNT_K, COUNT_M, COUNT_N, COUNT_P, COUNT_SCALARS, HEADER, ONE, TWO
from socp_statics.engines.kernel.presolve import dependent_column, eliminate, equilibrate, repeated_row, without_column
from socp_statics.engines.kernel.skyline import envelope, narrow_order


@inner
def _coupling(n, cone, column):
    """Which unknowns share a cone, shape (n, n)."""
    coupled = np.zeros((n, n), np.uint8)
    for k in range(len(cone) // 3 - 1):
        for a in range(cone[3 * k + 1], cone[3 * k + 4]):
            for b in range(cone[3 * k + 1], cone[3 * k + 4]):
                coupled[column[a], column[b]] = 1
    return coupled


@inner
def _pairs(cone, column, rows, k):
    """Where each product of two columns of a cone is stored; columns are positions, rows are from `skyline.envelope`."""
    total = 0
    for c in range(len(cone) // 3 - 1):
        width = cone[3 * c + 4] - cone[3 * c + 1]
        total += width * (width + 1) // 2
    pair = np.empty(total, np.int64)
    t = 0
    for c in range(len(cone) // 3 - 1):
        for a in range(cone[3 * c + 1], cone[3 * c + 4]):
            for b in range(cone[3 * c + 1], a + 1):
                i, j = max(column[a], column[b]), min(column[a], column[b])
                pair[t] = rows[k + i] + j - rows[i]
                t += 1
    return pair


@inner
def _runs(cone, orthant, soc):
    """Runs of cones of equal dimension and equal number of columns: number, dimension and number of columns of each."""
    runs, count = np.empty(3 * len(soc), np.int64), 0
    for i in range(len(soc)):
        width = cone[3 * (orthant + i) + 4] - cone[3 * (orthant + i) + 1]
        if count > 0 and runs[3 * count - 2] == soc[i] and runs[3 * count - 1] == width:
            runs[3 * count - 3] += 1
        else:
            runs[3 * count] = 1
            runs[3 * count + 1] = soc[i]
            runs[3 * count + 2] = width
            count += 1
    return runs[: 3 * count]


@inner
def _fill(target, begin, source):
    """Write a matrix row by row."""
    for i in range(source.shape[0]):
        for j in range(source.shape[1]):
            target[begin] = source[i, j]
            begin += 1


@inner
def plan_rows(P, A, row_start, row_column, row_value, orthant, soc):
    """Prepare a program: everything that does not depend on q, b and h.

    Args:
        P: Diagonal of the quadratic cost, shape (n,), not negative.
        A: Equality rows, shape (p, n).
        row_start: Where each row of G begins, shape (m + 1,), int64; `blocks.sparse_rows` makes this and the next two of a dense G.
        row_column: Columns of G's entries, int64.
        row_value: Values of G's entries.
        orthant: Number of rows of the orthant, which come first.
        soc: Dimensions of the second-order cones, in order, shape (c,), int64.

    Returns:
        The two arrays of a `layout.Plan`. They include the workspace: one thread at a time may solve the plan.
    """
    n, p, m = len(P), len(A), len(row_start) - 1
    P, A, row_value, row_column = P.copy(), A.copy(), row_value[: row_start[m]].copy(), row_column[: row_start[m]].copy()
    E, R, C = np.empty(n), np.empty(p), np.empty(m)
    equilibrate(P, A, row_start, row_column, row_value, orthant, soc, E, R, C)

    active, place, share = np.ones(n, np.uint8), np.zeros(n, np.int64), np.zeros((0, n))
    free, lost = np.empty(n, np.int64), 0
    while True:
        cone, column, value = blocks_of(n, row_start, row_column, row_value, orthant, soc)
        coupled = _coupling(n, cone, column)
        if len(share) == 0:
            for j in range(n):
                if not coupled[j, j] and P[j] == 0.0:
                    active[j] = 0
                    free[lost] = j
                    lost += 1
        order = narrow_order(coupled, active)
        k = len(order)
        rows = envelope(coupled, order)
        seen_by_P = np.zeros(k)
        for i in range(k):
            place[order[i]] = i
            seen_by_P[i] = P[order[i]] > 0.0
        for t in range(len(column)):
            column[t] = place[column[t]]
        pair = _pairs(cone, column, rows, k)
        structure = np.concatenate((cone, column, rows, pair)).astype(np.uint64)
        columns_at, first = np.uint64(len(cone)), np.uint64(len(cone) + len(column))
        kept, cones, H = np.uint64(k), np.uint64(len(cone) // 3 - 1), np.uint64(len(value))
        by_pivot = H + np.uint64(rows[2 * k])
        base = by_pivot + kept
        scratch = np.empty(len(value) + rows[2 * k] + 3 * k + 2 * k * p + p * p + 2 * p)
        for t in range(len(value)):
            scratch[t] = value[t]
        found = dependent_column(
            structure, cones, columns_at, first, first + kept, first + TWO * kept + ONE, kept,
            scratch, H, by_pivot, base, base + kept, seen_by_P,
        )  # fmt: skip
        i = int(found)
        if i == k:
            break
        j = order[i]
        combination = np.zeros((1, n))
        for a in range(k):
            weight = scratch[int(base) + k + a]
            combination[0, order[a]] = weight
            for b in range(p):
                A[b, j] -= weight * A[b, order[a]]
        share = np.concatenate((share, combination))
        active[j] = 0
        free[lost] = j
        lost += 1
        row_start, row_column, row_value = without_column(row_start, row_column, row_value, j)

    mix, row, pivot = np.eye(p), np.arange(p), np.empty(p, np.int64)
    rank = eliminate(A, free[:lost], mix, row, pivot)
    e = p - rank
    while True:
        begin, rows_left = int(base), np.uint64(e)
        for i in range(k):
            for a in range(e):
                scratch[begin + i * e + a] = A[row[rank + a], order[i]]
        Y = base + kept * rows_left
        S = Y + kept * rows_left
        by_row = S + rows_left * rows_left
        weights = by_row + rows_left
        a = int(repeated_row(structure, first, first + kept, kept, scratch, H, by_pivot, base, Y, S, by_row, weights, rows_left))
        if a == e:
            break
        begin = int(weights)
        same = row[rank + a]
        for b in range(a):
            for i in range(p):
                mix[same, i] -= scratch[begin + b] * mix[row[rank + b], i]
        e -= 1
        for b in range(rank + a, rank + e):
            row[b] = row[b + 1]
        row[rank + e] = same

    runs = _runs(cone, orthant, soc)
    sizes = (n, p, m, orthant, k, e, rank, lost, len(share), len(cone) // 3 - 1, len(runs) // 3)
    wholes = (len(cone), len(column), len(runs), k, k + 1, len(pair), k, lost, rank, p)
    reals = (
        len(share) * n, p * p, rank * lost, rank * k, k * e, k, n, p, m, len(value),
        rows[2 * k], len(value), 3 * k * e, e * e, COUNT_K * k, COUNT_E * e, COUNT_M * m, len(soc), COUNT_N * n, COUNT_P * p, COUNT_SCALARS,
    )  # fmt: skip
    head = np.empty(HEADER, np.int64)
    t = 0
    for size in sizes:
        head[t] = size
        t += 1
    end = HEADER
    for size in wholes:
        head[t] = end
        end += size
        t += 1
    end = 0
    for size in reals:
        head[t] = end
        end += size
        t += 1
    W = np.concatenate((head, cone, column, runs, rows, pair, order, free[:lost], pivot[:rank], row)).astype(np.uint64)
    F = np.zeros(end)
    _fill(F, head[at.SHARE], share)
    _fill(F, head[at.MIX], mix)
    for r in range(rank):
        for f in range(lost):
            F[head[at.U_AT] + r * lost + f] = A[row[r], free[f]]
        for i in range(k):
            F[head[at.B_AT] + r * k + i] = A[row[r], order[i]]
    for i in range(k):
        F[head[at.DIAGONAL] + i] = P[order[i]]
        for a in range(e):
            F[head[at.A_AT] + a * k + i] = A[row[rank + a], order[i]]
    for j in range(n):
        F[head[at.BY_COLUMN] + j] = E[j]
    for i in range(p):
        F[head[at.BY_ROW] + i] = R[i]
    for i in range(m):
        F[head[at.BY_CONE] + i] = C[i]
    for i in range(len(value)):
        F[head[at.VALUE] + i] = value[i]
    return W, F
