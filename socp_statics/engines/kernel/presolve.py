"""Before a program is solved: scaling, unknowns that neither cones nor objective tell apart, and equality rows that repeat others."""

from __future__ import annotations

from math import sqrt

import numpy as np

from socp_statics.engines.kernel.compilation import inner
from socp_statics.engines.kernel.layout import FOUR, ONE, THREE, TWO
from socp_statics.engines.kernel.skyline import backward, factor, factor_dense, forward_columns

EQUILIBRATIONS = 3
# A pivot this small beside its diagonal is looked at; what others then reproduce to DEPENDENT depends on them.
SUSPECT = 1e-9
DEPENDENT = 1e-11
# Pivots of the matrices that are searched for dependence are not smaller than this share of their diagonal.
FLOOR = 1e-14


@inner(forceinline=True)
def _by_root(size):
    return 1.0 / sqrt(size) if size > 0.0 else 1.0


@inner
def equilibrate(P, A, start, column, value, orthant, soc, E, R, C):
    """Ruiz scaling in place, uniform on every cone.

    Args:
        P: Diagonal, shape (n,); becomes ``E P E``.
        A: Equality rows, shape (p, n); become ``R A E``.
        start: Where each row of G begins, shape (m + 1,).
        column: Columns of its entries.
        value: Its entries; become those of ``C G E``.
        orthant: Number of rows of the orthant.
        soc: Dimensions of the second-order cones.
        E: Written, shape (n,).
        R: Written, shape (p,).
        C: Written, shape (m,).
    """
    n, p = len(P), len(A)
    largest = np.empty(n)
    E[:] = 1.0
    R[:] = 1.0
    C[:] = 1.0
    for _ in range(EQUILIBRATIONS):
        for j in range(n):
            largest[j] = P[j]
        for i in range(p):
            most = 0.0
            for j in range(n):
                size = abs(A[i, j])
                most = max(most, size)
                largest[j] = max(largest[j], size)
            by = _by_root(most)
            R[i] *= by
            for j in range(n):
                A[i, j] *= by
        a = 0
        for k in range(orthant + len(soc)):
            stop = a + (1 if k < orthant else soc[k - orthant])
            most = 0.0
            for t in range(start[a], start[stop]):
                size = abs(value[t])
                most = max(most, size)
                largest[column[t]] = max(largest[column[t]], size)
            by = _by_root(most)
            for i in range(a, stop):
                C[i] *= by
            for t in range(start[a], start[stop]):
                value[t] *= by
            a = stop
        for j in range(n):
            largest[j] = _by_root(largest[j])
            E[j] *= largest[j]
            P[j] *= largest[j] * largest[j]
        for i in range(p):
            for j in range(n):
                A[i, j] *= largest[j]
        for t in range(len(value)):
            value[t] *= largest[column[t]]


@inner
def without_column(start, column, value, j):
    """Rows of a sparse matrix without one of its columns; the first three arguments as `blocks.sparse_rows` returns them."""
    fewer = np.zeros_like(start)
    e = 0
    for i in range(len(start) - 1):
        for t in range(start[i], start[i + 1]):
            if column[t] != j:
                column[e] = column[t]
                value[e] = value[t]
                e += 1
        fewer[i + 1] = e
    return fewer, column[:e], value[:e]


@inner
def dependent_column(W, cones, column, first, start, pair, k, F, H, by_pivot, diagonal, share, seen_by_P):
    """Factor ``G' G + E``, E where P is positive, and find the first unknown whose column others reproduce.

    Args:
        W: Structure: the cones' table at 0, and what the next arguments say.
        cones: Number of cones.
        column: Columns cone by cone, as positions in the order.
        first: Envelope.
        start: The same.
        pair: Where the products of a cone's columns are stored.
        k: Number of unknowns.
        F: Numbers: values of the blocks at 0.
        H: Written: the factor.
        by_pivot: Written: its reciprocal pivots.
        diagonal: Workspace, k numbers.
        share: Written: the combination of other columns, k numbers.
        seen_by_P: Whether P is positive, by position.

    Returns:
        Its position, or k.
    """
    for t in range(W[start + k]):
        F[H + t] = 0.0
    t = pair
    for c in range(cones):
        v, width = W[THREE * c + TWO], W[THREE * c + FOUR] - W[THREE * c + ONE]
        for a in range(width):
            for b in range(a + ONE):
                total = 0.0
                for i in range(W[THREE * c + THREE] - W[THREE * c]):
                    total += F[v + i * width + a] * F[v + i * width + b]
                F[H + W[t]] += total
                t += ONE
    for i in range(k):
        end = H + W[start + i + ONE] - ONE
        F[end] += seen_by_P[i]
        F[diagonal + i] = F[end]
    factor(W, first, start, k, F, H, by_pivot, FLOOR)
    for i in range(k):
        if seen_by_P[i] > 0.0 or F[by_pivot + i] * F[diagonal + i] * SUSPECT <= 1.0:
            continue
        row = H + W[start + i + ONE] - ONE - i
        for j in range(k):
            F[share + j] = F[row + j] if W[first + i] <= j and j < i else 0.0
        backward(W, first, start, i, F, H, share)
        most, off = 1.0, 0.0
        for j in range(i):
            most = max(most, abs(F[share + j]))
            off = max(off, seen_by_P[j] * abs(F[share + j]))
        F[share + i] = -1.0
        for c in range(cones):
            begin, end, v = W[THREE * c + ONE], W[THREE * c + FOUR], W[THREE * c + TWO]
            for _ in range(W[THREE * c + THREE] - W[THREE * c]):
                total = 0.0
                for j in range(begin, end):
                    total += F[v] * F[share + W[column + j]]
                    v += ONE
                off = max(off, abs(total))
        F[share + i] = 0.0
        if off <= DEPENDENT * most:
            return i
    return k


@inner
def eliminate(A, free, mix, row, pivot):
    """Gaussian elimination of the free unknowns from the equality rows by complete pivoting, in place.

    Args:
        A: Equality rows, shape (p, n).
        free: The free unknowns, shape (f,).
        mix: The same operations are done on it, shape (p, p).
        row: Order of the rows; pivot rows come first on return, shape (p,).
        pivot: Index in `free` of what each pivot row expresses, written, shape (min(p, f),).

    Returns:
        Number of pivot rows.
    """
    p, f = len(A), len(free)
    used = np.zeros(f, np.int64)
    for r in range(min(p, f)):
        most, best, which = DEPENDENT, -1, -1
        for i in range(r, p):
            for j in range(f):
                if not used[j] and abs(A[row[i], free[j]]) > most:
                    most, best, which = abs(A[row[i], free[j]]), i, j
        if best < 0:
            return r
        row[r], row[best] = row[best], row[r]
        pivot[r] = which
        used[which] = 1
        a, c = row[r], free[which]
        for i in range(r + 1, p):
            b = row[i]
            share = A[b, c] / A[a, c]
            if share != 0.0:
                for j in range(A.shape[1]):
                    A[b, j] -= share * A[a, j]
                A[b, c] = 0.0
                for j in range(p):
                    mix[b, j] -= share * mix[a, j]
    return min(p, f)


@inner
def repeated_row(W, first, start, k, F, H, by_pivot, A, Y, S, by_row_pivot, share, e):
    """The first of some equality rows that those before it reproduce.

    Args:
        W: Structure.
        first: Envelope of the factor that `dependent_column` made.
        start: The same.
        k: Number of unknowns.
        F: Numbers.
        H: The factor.
        by_pivot: Its reciprocal pivots.
        A: The rows, transposed, shape (k, e).
        Y: Workspace of the same size.
        S: Workspace, e e numbers.
        by_row_pivot: Workspace, e numbers.
        share: Written: the combination of other rows, e numbers.
        e: Number of rows.

    Returns:
        Its position, or e.
    """
    for t in range(k * e):
        F[Y + t] = F[A + t]
    forward_columns(W, first, start, k, F, H, Y, e)
    for a in range(e):
        for b in range(a + ONE):
            total = 0.0
            for i in range(k):
                total += F[Y + i * e + a] * F[Y + i * e + b] * F[by_pivot + i]
            F[S + a * e + b] = total
        F[share + a] = F[S + a * e + a]
    factor_dense(e, F, S, by_row_pivot, FLOOR)
    for a in range(e):
        F[by_row_pivot + a] *= F[share + a]
    for a in range(e):
        most = 0.0
        for i in range(k):
            most = max(most, abs(F[A + i * e + a]))
        empty = most <= DEPENDENT
        if not empty and F[by_row_pivot + a] * SUSPECT <= 1.0:
            continue
        for b in range(e):
            F[share + b] = F[S + a * e + b] if b < a and not empty else 0.0
        largest, off = 1.0, 0.0
        for turn in range(a):
            b = a - ONE - turn
            for c in range(b):
                F[share + c] -= F[S + b * e + c] * F[share + b]
            largest = max(largest, abs(F[share + b]))
        for i in range(k):
            rest = F[A + i * e + a]
            for b in range(a):
                rest -= F[share + b] * F[A + i * e + b]
            off = max(off, abs(rest))
        if off <= DEPENDENT * largest:
            return a
    return e
