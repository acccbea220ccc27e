"""The rows of G cone by cone, with only the columns that a cone touches, and products with them."""

from __future__ import annotations

import numpy as np

from socp_statics.engines.kernel import layout as at
from socp_statics.engines.kernel.compilation import inner
from socp_statics.engines.kernel.layout import FOUR, ONE, THREE, TWO
from socp_statics.engines.kernel.second_order import unscale


@inner
def sparse_rows(G):
    """The entries of a dense matrix that are not zero, row by row.

    Args:
        G: Shape (m, n).

    Returns:
        Where each row begins, shape (m + 1,), columns, and values.
    """
    m, n = G.shape
    start = np.zeros(m + 1, np.int64)
    column, value = np.empty(m * n, np.int64), np.empty(m * n)
    t = 0
    for i in range(m):
        for j in range(n):
            if G[i, j] != 0.0:
                column[t] = j
                value[t] = G[i, j]
                t += 1
        start[i + 1] = t
    return start, column, value


@inner
def blocks_of(n, start, column, value, orthant, soc):
    """Dense blocks of a sparse matrix, one a cone; every row of the orthant is a cone of dimension 1.

    Args:
        n: Number of columns.
        start: Where each row begins, shape (m + 1,).
        column: Columns of the entries.
        value: Values of the entries.
        orthant: Number of rows of the orthant.
        soc: Dimensions of the second-order cones, which follow in this order.

    Returns:
        Of each cone its first row, where its columns and where its values begin, shape (3 (cones + 1),); columns; values, row by row
        within a cone.
    """
    cones = orthant + len(soc)
    cone = np.zeros(3 * (cones + 1), np.int64)
    columns, place = np.empty(start[-1], np.int64), np.full(n, -1)
    a, e, v = 0, 0, 0
    for k in range(cones):
        d = 1 if k < orthant else soc[k - orthant]
        b = e
        for t in range(start[a], start[a + d]):
            j = column[t]
            if place[j] < b:
                place[j] = e
                columns[e] = j
                e += 1
        a += d
        v += d * (e - b)
        cone[3 * k + 3] = a
        cone[3 * k + 4] = e
        cone[3 * k + 5] = v
    values = np.zeros(v)
    for k in range(cones):
        a, b, v = cone[3 * k], cone[3 * k + 1], cone[3 * k + 2]
        c = cone[3 * k + 4] - b
        for i in range(c):
            place[columns[b + i]] = i
        for i in range(cone[3 * k + 3] - a):
            for t in range(start[a + i], start[a + i + 1]):
                values[v + i * c + place[column[t]]] += value[t]
    return cone, columns[:e], values


@inner(forceinline=True)
def _times(d, c, W, column, F, value, x, out):
    for i in range(d):
        total = 0.0
        for j in range(c):
            total += F[value + i * c + j] * F[x + W[column + j]]
        F[out + i] = total


@inner(forceinline=True)
def _add_transposed(d, c, W, column, F, value, z, out):
    for j in range(c):
        total = F[out + W[column + j]]
        for i in range(d):
            total += F[value + i * c + j] * F[z + i]
        F[out + W[column + j]] = total


@inner
def times(W, F, value, x, out):
    """``out = G x``.

    Args:
        W: Integers of the plan.
        F: Reals of the plan; the other arguments say where in it.
        value: Values of the blocks of G, or of the scaled blocks.
        x: Unknowns.
        out: Cone rows, written.
    """
    cone, column, orthant = W[at.CONE], W[at.COLUMN], W[at.L]
    for k in range(orthant):
        b = W[cone + THREE * k + ONE]
        _times(ONE, W[cone + THREE * k + FOUR] - b, W, column + b, F, value + W[cone + THREE * k + TWO], x, out + k)
    a, b, v = out + orthant, column + W[cone + THREE * orthant + ONE], value + W[cone + THREE * orthant + TWO]
    for r in range(W[at.RUNS]):
        run = W[at.RUN] + r * THREE
        d, c = W[run + ONE], W[run + TWO]
        for _ in range(W[run]):
            if d == THREE and c == THREE:
                _times(THREE, THREE, W, b, F, v, x, a)
            elif d == THREE and c == FOUR:
                _times(THREE, FOUR, W, b, F, v, x, a)
            elif d == FOUR and c == FOUR:
                _times(FOUR, FOUR, W, b, F, v, x, a)
            else:
                _times(d, c, W, b, F, v, x, a)
            a += d
            b += c
            v += d * c


@inner
def add_transposed(W, F, value, z, out):
    """``out += G' z``; arguments as in `times`, z are cone rows and out unknowns."""
    cone, column, orthant = W[at.CONE], W[at.COLUMN], W[at.L]
    for k in range(orthant):
        b = W[cone + THREE * k + ONE]
        _add_transposed(ONE, W[cone + THREE * k + FOUR] - b, W, column + b, F, value + W[cone + THREE * k + TWO], z + k, out)
    a, b, v = z + orthant, column + W[cone + THREE * orthant + ONE], value + W[cone + THREE * orthant + TWO]
    for r in range(W[at.RUNS]):
        run = W[at.RUN] + r * THREE
        d, c = W[run + ONE], W[run + TWO]
        for _ in range(W[run]):
            if d == THREE and c == THREE:
                _add_transposed(THREE, THREE, W, b, F, v, a, out)
            elif d == THREE and c == FOUR:
                _add_transposed(THREE, FOUR, W, b, F, v, a, out)
            elif d == FOUR and c == FOUR:
                _add_transposed(FOUR, FOUR, W, b, F, v, a, out)
            else:
                _add_transposed(d, c, W, b, F, v, a, out)
            a += d
            b += c
            v += d * c


@inner(forceinline=True)
def _add_square(d, c, F, w, by_eta, value, out, W, pair, H):
    for j in range(c):
        unscale(d, F, w, by_eta, value + j, out + j, c)
    t = pair
    for j in range(c):
        for i in range(j + ONE):
            total = F[H + W[t]]
            for r in range(d):
                total += F[out + r * c + i] * F[out + r * c + j]
            F[H + W[t]] = total
            t += ONE


@inner
def add_square(W, F, w):
    """``W^-1 G`` into the scaled blocks and ``H += (W^-1 G)' (W^-1 G)``.

    Args:
        W: Integers of the plan.
        F: Reals of the plan.
        w: Scaling points.
    """
    cone, orthant, value, out, t, H = W[at.CONE], W[at.L], W[at.VALUE], W[at.SCALED], W[at.PAIR], W[at.H_AT]
    for k in range(orthant):
        v, c, by_w = W[cone + THREE * k + TWO], W[cone + THREE * k + FOUR] - W[cone + THREE * k + ONE], 1.0 / F[w + k]
        for j in range(c):
            entry = F[value + v + j] * by_w
            F[out + v + j] = entry
            for i in range(j + ONE):
                F[H + W[t]] += F[out + v + i] * entry
                t += ONE
    a, eta, v = w + orthant, W[at.ETA], W[cone + THREE * orthant + TWO]
    for r in range(W[at.RUNS]):
        run = W[at.RUN] + r * THREE
        d, c = W[run + ONE], W[run + TWO]
        for _ in range(W[run]):
            if d == THREE and c == THREE:
                _add_square(THREE, THREE, F, a, 1.0 / F[eta], value + v, out + v, W, t, H)
            elif d == THREE and c == FOUR:
                _add_square(THREE, FOUR, F, a, 1.0 / F[eta], value + v, out + v, W, t, H)
            elif d == FOUR and c == FOUR:
                _add_square(FOUR, FOUR, F, a, 1.0 / F[eta], value + v, out + v, W, t, H)
            else:
                _add_square(d, c, F, a, 1.0 / F[eta], value + v, out + v, W, t, H)
            a += d
            v += d * c
            eta += ONE
            t += c * (c + ONE) // TWO
