"""Symmetric matrices stored row by row from the first entry of each row: order, envelope, LDL' and triangular solves.

Forces couple within a contact and with one or two unknowns that all cones share. In a good order such a matrix has short rows and a
few long ones, and its factorisation costs as much as its entries. Structure lies in an array W and numbers in an array F; arguments say
where: `first` the first column of each row, `start` where each row begins, its diagonal at the end.
"""

from __future__ import annotations

import numpy as np

from socp_statics.engines.kernel.compilation import inner
from socp_statics.engines.kernel.layout import ONE


@inner
def narrow_order(coupled, active):
    """An order with a narrow front: King's (1970), which keeps unknowns that couple with all others for the end.

    Args:
        coupled: Which unknowns share an entry, symmetric, shape (n, n), uint8.
        active: Which unknowns take part, shape (n,), uint8.

    Returns:
        Indices of the active unknowns in their new order.
    """
    n = len(active)
    order, state, growth = np.empty(n, np.int64), np.zeros(n, np.int64), np.zeros(n, np.int64)
    for i in range(n):
        for j in range(n):
            growth[i] += coupled[i, j] != 0 and j != i
    done = 0
    while True:
        best, least = -1, 4 * n + 4
        for i in range(n):
            cost = 2 * growth[i] + (state[i] == 0)
            if active[i] and state[i] < 2 and cost < least:
                best, least = i, cost
        if best < 0:
            return order[:done]
        order[done] = best
        done += 1
        # What enters the front is no growth for its neighbours any more: the unknown itself, then those it couples with.
        for i in range(n):
            if i == best or coupled[best, i]:
                if state[i] == 0:
                    for j in range(n):
                        growth[j] -= coupled[i, j] != 0 and j != i
                state[i] = max(state[i], 1)
        state[best] = 2


@inner
def envelope(coupled, order):
    """Where the rows begin.

    Args:
        coupled: Which unknowns share an entry, shape (n, n).
        order: Unknowns in the order of elimination, shape (k,).

    Returns:
        First column of each row, shape (k,), then where each row begins in the stored values, shape (k + 1,), in one array.
    """
    k = len(order)
    rows = np.zeros(2 * k + 1, np.int64)
    for i in range(k):
        j = 0
        while j < i and not coupled[order[i], order[j]]:
            j += 1
        rows[i] = j
        rows[k + i + 1] = rows[k + i] + i - j + 1
    return rows


@inner
def factor(W, first, start, k, F, H, by_pivot, floor):
    """LDL' in place; pivots that are lost in rounding are raised to a share of their diagonal.

    Args:
        W: Structure.
        first: First columns.
        start: Beginnings of rows.
        k: Number of rows.
        F: Numbers.
        H: The matrix on entry, L (without its unit diagonal) on return.
        by_pivot: Reciprocals of D, written.
        floor: The share.
    """
    for i in range(k):
        f, end = W[first + i], H + W[start + i + ONE] - ONE
        row = end - i
        for j in range(f, i):
            g = W[first + j]
            other = H + W[start + j] - g
            total = F[row + j]
            for c in range(max(f, g), j):
                total -= F[row + c] * F[other + c]
            F[row + j] = total
        pivot = F[end]
        least = floor * pivot
        for j in range(f, i):
            value = F[row + j]
            scaled = value * F[by_pivot + j]
            pivot -= value * scaled
            F[row + j] = scaled
        F[by_pivot + i] = 1.0 / max(pivot, least)


@inner
def forward(W, first, start, k, F, L, v):
    """``v <- L^-1 v``; arguments as in `factor`."""
    for i in range(k):
        row = L + W[start + i + ONE] - ONE - i
        total = F[v + i]
        for c in range(W[first + i], i):
            total -= F[row + c] * F[v + c]
        F[v + i] = total


@inner
def backward(W, first, start, k, F, L, v):
    """``v <- L'^-1 v``; arguments as in `factor`."""
    for turn in range(k):
        i = k - ONE - turn
        row = L + W[start + i + ONE] - ONE - i
        value = F[v + i]
        for c in range(W[first + i], i):
            F[v + c] -= F[row + c] * value


@inner
def forward_columns(W, first, start, k, F, L, V, columns):
    """``V <- L^-1 V`` for all columns of V, shape (k, columns); arguments as in `factor`."""
    for i in range(k):
        row = L + W[start + i + ONE] - ONE - i
        for c in range(W[first + i], i):
            share = F[row + c]
            for j in range(columns):
                F[V + i * columns + j] -= share * F[V + c * columns + j]


@inner
def factor_dense(p, F, S, by_pivot, floor):
    """LDL' of the lower triangle of a dense matrix of p rows; otherwise as `factor`."""
    for i in range(p):
        row = S + i * p
        for j in range(i):
            total = F[row + j]
            for c in range(j):
                total -= F[row + c] * F[S + j * p + c]
            F[row + j] = total
        pivot = F[row + i]
        least = floor * pivot
        for j in range(i):
            value = F[row + j]
            F[row + j] = value * F[by_pivot + j]
            pivot -= value * F[row + j]
        F[by_pivot + i] = 1.0 / max(pivot, least)


@inner
def solve_dense(p, F, S, by_pivot, v):
    """Solve with the factors of `factor_dense` in place."""
    for i in range(p):
        total = F[v + i]
        for c in range(i):
            total -= F[S + i * p + c] * F[v + c]
        F[v + i] = total
    for turn in range(p):
        i = p - ONE - turn
        total = F[v + i] * F[by_pivot + i]
        for c in range(i + ONE, p):
            total -= F[S + c * p + i] * F[v + c]
        F[v + i] = total
