"""Newton's method on smoothed optimality conditions: what an interior-point method leaves behind is solved to rounding.

    P x + q + A' z = 0,   A x + s = b,   s = phi_mu(v),   z = phi_mu(v) - v,    v = s - z

``phi_mu`` is the projection on the cones with its kinks smoothed, ``(l + sqrt(l^2 + 4 mu)) / 2`` of every eigenvalue l of v (Fukushima,
Luo and Tseng 2002): slack and multiplier lie in their cones and have the product mu whatever v is, so that only linear equations are left
to miss. mu goes to zero as fast as Newton's method follows. The linear systems are solved as they stand, by orthogonal factors, of least
norm where forces or multipliers are not unique: an interior-point method squares their condition, and stops where sets have hardly any
interior, forces are a million weights or an optimum degenerates.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from scipy.linalg import lstsq

from socp_statics.engines.conic_form import Cones, ConicData
from socp_statics.spatial import Array

# Dense matrices larger than this take longer than a second.
LARGEST = 600
MOST_STEPS = 120
# What a failed method leaves behind can be of any size.
FARTHEST = 1e15
# Products of slack and multiplier to begin with, between these; the least one is where rounding begins.
NEAR, FAR, LEAST = 1e-12, 1e-4, 1e-25
LARGEST_PRODUCT = 1e4
ROUNDING, RANK = 1e-14, 1e-15
# Newton's method is taken to follow while its residual falls like this, and to have followed where it is as small beside sqrt(mu).
DECREASE, SHORTEST, STEPS, FOLLOWED = 0.1, 0.01, 8, 0.3
# By what the product shrinks: at first, at most, and when it is hardly worth going on.
SHRINK, FASTEST, SLOWEST = 0.1, 1e-3, 0.9
# What a step away from where it starts costs over its square, in units of cost and unknowns, one step after the other.
PROXIMAL = (1e-3, 1e-5, 1e-7, 1e-9)


class _Rows:
    """Which rows of the slack are zero, which are not negative, and which form cones of one dimension, shape (k, d) for each."""

    def __init__(self, cones: Cones):
        self.zero, self.first = cones.zero, cones.zero + cones.nonneg
        starts = self.first + np.cumsum([0, *cones.soc[:-1]]) if cones.soc else np.zeros(0, dtype=int)
        sizes = np.array(cones.soc, dtype=int)
        self.round = [starts[sizes == d, None].astype(int) + np.arange(d) for d in sorted(set(cones.soc))]
        self.degree = max(cones.nonneg + 2 * len(cones.soc), 1)


def _positive_part(value: Array, product: float) -> tuple[Array, Array]:
    """``phi`` of eigenvalues and its slope."""
    root = np.sqrt(value * value + 4.0 * product)
    # Without cancellation on either side.
    part = np.where(value > 0.0, 0.5 * (value + root), 2.0 * product / np.maximum(root - value, 1e-300))
    return part, part / root


def _slack(v: Array, product: float, rows: _Rows) -> tuple[Array, Array]:
    """``phi(v)``, shape (m,), and its derivative, shape (m, m)."""
    s, D = np.zeros(len(v)), np.zeros((len(v), len(v)))
    flat = np.arange(rows.zero, rows.first)
    s[flat], D[flat, flat] = _positive_part(v[flat], product)
    for index in rows.round:
        head, tail = v[index[:, 0]], v[index[:, 1:]]
        length = np.sqrt((tail * tail).sum(axis=1))
        way = tail / np.maximum(length, 1e-300)[:, None]
        (low, high), (slope, steep) = _positive_part(np.array([head - length, head + length]), product)
        s[index[:, 0]], s[index[:, 1:]] = 0.5 * (low + high), 0.5 * (high - low)[:, None] * way
        middle, half = 0.5 * (steep + slope), 0.5 * (steep - slope)
        apart = length > 1e-14 * np.maximum(np.abs(head), 1e-300)
        across = np.where(apart, (high - low) / np.where(apart, 2.0 * length, 1.0), middle)
        J = np.empty((*index.shape, index.shape[1]))
        J[:, 0, 0] = middle
        J[:, 0, 1:] = J[:, 1:, 0] = half[:, None] * way
        J[:, 1:, 1:] = across[:, None, None] * np.eye(index.shape[1] - 1)
        J[:, 1:, 1:] += (middle - across)[:, None, None] * way[:, :, None] * way[:, None]
        D[index[:, :, None], index[:, None, :]] = J
    return s, D


def unit_of(x: Array, y: Array) -> float:
    """The unit that makes unknowns and multipliers of one size: the difference v of slack and multiplier then keeps the digits of both."""
    return max(1.0, float(np.abs(x).max(initial=0.0))) / max(1.0, float(np.abs(y).max(initial=0.0)))


def finished(data: ConicData, cones: Cones, x: Array, y: Array, unit: float) -> tuple[Array, Array] | None:
    """Solve a program to rounding from an approximate solution.

    Args:
        data: The program, without semidefinite cones.
        cones: Its cones.
        x: Unknowns.
        y: Conic multipliers.
        unit: Of unknowns and slacks, see `unit_of`.

    Returns:
        Unknowns and multipliers, these inside their cones, slacks inside theirs to rounding; None where the method does not get to the
        end, the program is too large, or what it starts from is no solution of anything: not finite, or beyond all scales.
    """
    m, n = data.A.shape
    if cones.psd or m + n > LARGEST or not (np.abs(x).max(initial=0.0) <= FARTHEST and np.abs(y).max(initial=0.0) <= FARTHEST):
        return None
    A, b, x, rows, identity = data.A.toarray(), data.b / unit, x / unit, _Rows(cones), np.eye(m)
    upper = data.P.toarray() * unit
    P = upper + np.triu(upper, 1).T
    M = np.zeros((n + m, n + m))
    M[:n, :n], M[n:, :n] = P, A
    s = b - A @ x
    v = s - y
    v[: cones.zero] = -y[: cones.zero]
    product = float(np.clip(abs(s[cones.zero :] @ y[cones.zero :]) / rows.degree, NEAR, FAR))

    def missed(x: Array, v: Array) -> tuple[Array, Array, Array]:
        slack, D = _slack(v, product, rows)
        return np.concatenate([P @ x + data.q + A.T @ (slack - v), A @ x + slack - b]), slack - v, D

    reached: tuple[Array, Array, float] | None = None
    shrink, steps = SHRINK, 0
    off, z, D = missed(x, v)
    last = float(np.linalg.norm(off))
    for _ in range(MOST_STEPS):
        M[:n, n:], M[n:, n:] = A.T @ (D - identity), D
        step = lstsq(M, -off, cond=RANK, lapack_driver="gelsy", check_finite=False)[0]
        steps, share = steps + 1, 1.0
        while True:
            there = x + share * step[:n], v + share * step[n:]
            off, z, D = missed(*there)
            size = float(np.linalg.norm(off))
            follows = size <= (1.0 - DECREASE * share) * last
            if follows or share < SHORTEST:
                break
            share *= 0.5
        scale = max(1.0, float(np.abs(there[0]).max()), float(np.abs(z).max(initial=0.0)))
        exact = size <= 10.0 * ROUNDING * scale
        if exact or (follows and size <= FOLLOWED * np.sqrt(product) * min(1.0, 1e3 * np.sqrt(product))):
            x, v = there
            if product * rows.degree <= ROUNDING and (size <= ROUNDING * scale or product <= LEAST):
                return unit * x, z
            reached = x, v, product
            shrink = max(shrink**1.5, FASTEST) if steps <= 2 else min(np.sqrt(shrink), 0.5) if steps > 4 else shrink
            product *= shrink
        elif follows and steps <= STEPS:
            x, v, last = *there, size
            continue
        elif reached is None:
            product *= 100.0
            if product > LARGEST_PRODUCT:
                return None
        else:
            x, v, product = reached
            shrink = np.sqrt(shrink)
            if shrink > SLOWEST:
                return None
            product *= shrink
        steps = 0
        off, z, D = missed(x, v)
        last = float(np.linalg.norm(off))
    return None


def approached(data: ConicData, cones: Cones, x: Array, y: Array, unit: float) -> tuple[Array, Array] | None:
    """Solve a program whose optimum lies far along a valley that hardly falls, as far as the valley can be followed.

    Proximal point steps (Rockafellar 1976): the square of the way from the last iterate joins the cost, ever less of it. Each of these
    programs has one solution, which meets the constraints to rounding; only the multipliers' equation misses what the way costs.

    Args:
        data: The program, without semidefinite cones.
        cones: Its cones.
        x: Unknowns.
        y: Conic multipliers.
        unit: Of unknowns and slacks, see `unit_of`.

    Returns:
        Unknowns and multipliers as `finished` has them, of the last step that was solved; None where none was.
    """
    largest = float(np.abs(x).max(initial=0.0))
    if not largest <= FARTHEST:
        return None
    scale = (float(np.abs(data.q).max(initial=0.0)) or 1.0) / max(1.0, largest)
    found: tuple[Array, Array] | None = None
    for share in PROXIMAL:
        cost = scale * share
        near = data._replace(P=sp.csc_array(data.P + cost * sp.eye_array(len(x))), q=data.q - cost * x)
        step = finished(near, cones, x, y, unit)
        if step is None:
            break
        found = x, y = step
    return found
