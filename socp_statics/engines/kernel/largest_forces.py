"""The least possible largest force of points with friction in compiled code: many loads on a contact set, many contact sets."""

from __future__ import annotations

import math

import numpy as np

from socp_statics.engines.kernel.arrow_lanes import FORCE, NORMAL, TANGENTIAL, WRENCH, WRENCHES, buffer_size, place
from socp_statics.engines.kernel.ceiling import ACCEPTED, gram, solve
from socp_statics.engines.kernel.compilation import entry, inner
from socp_statics.engines.kernel.friction_points import centre_and_size, full_rank, unit_wrench, wrench_at_com
from socp_statics.engines.kernel.lanes import S2, S, U

# Larger forces than this many W belong to loads that are next to impossible, where accuracy is a matter of luck.
FAR = 1e3


@inner
def _prepare(X, points, centre, size, normal, tangential):
    """Wrenches and measures of the points."""
    for k in range(points.shape[0]):
        a = place(k)
        for c in range(3):
            f0, f1, f2, m0, m1, m2 = unit_wrench(points, k, c, centre, size)
            at = a + WRENCH + U(c) * WRENCHES
            X[at], X[at + S], X[at + S2] = f0, f1, f2
            at += U(3) * S
            X[at], X[at + S], X[at + S2] = m0, m1, m2
        X[a + NORMAL], X[a + TANGENTIAL] = normal, tangential * points[k, 12]


@inner
def _read(X, forces):
    """Forces, written, shape (n, 3); returns the largest measure, the sum of the components, and the largest violation of a cone."""
    square, total, outside = 0.0, 0.0, 0.0
    for k in range(forces.shape[0]):
        a = place(k)
        z0, z1, z2 = X[a + FORCE], X[a + FORCE + S], X[a + FORCE + S2]
        forces[k, 0], forces[k, 1], forces[k, 2] = z0, z1, z2
        n, m, slide = X[a + NORMAL] * z0, X[a + TANGENTIAL], math.sqrt(z1 * z1 + z2 * z2)
        square = max(square, n * n + m * m * slide * slide)
        outside = max(outside, slide - z0)
        total += z0 + slide
    return math.sqrt(square), total, outside


@entry("Tuple((boolean[::1], float64[::1], float64[::1], float64[:,::1], float64[:,::1]))(float64[:,::1], int64[::1], int64[::1], "
       "float64[:,::1], float64, float64)")  # fmt: skip
def largest_forces(points, starts, items, loads, normal, tangential):
    """Forces whose largest measure is least, for loads on sets of points with friction.

    Args:
        points: Rows of all sets, shape (n, 14), see `friction_points`.
        starts: Where each set starts, and the end, shape (s + 1,).
        items: Where the loads of each set start, and the end, shape (s + 1,).
        loads: As `reserves.reserves` reads them, shape (b, 13).
        normal: What the normal force counts in the measure, 0 or 1.
        tangential: What friction counts.

    Returns:
        Of each load: whether it is settled, shape (b,); the least largest measure in units of W, shape (b,); its relative gap,
        shape (b,); the multipliers of the balance, shape (b, 6); and, all loads one after the other, the components of each
        point's force in units of W, shape (rows, 3).
    """
    sets, batch = starts.shape[0] - 1, loads.shape[0]
    widest, rows = 0, 0
    for s in range(sets):
        n = starts[s + 1] - starts[s]
        widest = max(widest, n)
        rows += n * (items[s + 1] - items[s])
    X = np.empty(buffer_size(widest))
    settled, measures, gaps = np.empty(batch, np.bool_), np.empty(batch), np.empty(batch)
    multipliers, forces = np.empty((batch, 6)), np.empty((rows, 3))
    centre, load, missing, r = np.empty(3), np.empty(6), np.empty(6), np.empty(7)
    scratch, grams, A = np.empty((6, 6)), np.empty((7, 7)), np.empty((7, 7))
    at = 0
    for s in range(sets):
        mine = points[starts[s] : starts[s + 1]]
        n = mine.shape[0]
        size = centre_and_size(mine, centre)
        known = full_rank(mine, centre, size, scratch)
        if known:
            _prepare(X, mine, centre, size, normal, tangential)
            gram(X, n, grams)
        for b in range(items[s], items[s + 1]):
            measures[b], gaps[b], settled[b], total, outside = 0.0, 0.0, known, 0.0, 0.0
            for i in range(6):
                multipliers[b, i] = 0.0
            if known:
                wrench_at_com(loads[b], centre, size, load)
                settled[b], gaps[b], _ = solve(X, n, load, grams, A, multipliers[b], r, missing)
                measures[b], total, outside = _read(X, forces[at : at + n])
            else:
                forces[at : at + n] = 0.0
            # No comparison holds where a number is NaN, and a sum is one where any of its terms is.
            settled[b] = settled[b] and total < 2.0 * FAR * n and outside <= ACCEPTED * max(1.0, measures[b])
            at += n
    return settled, measures, gaps, multipliers, forces
