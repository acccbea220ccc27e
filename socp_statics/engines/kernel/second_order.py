"""Nesterov-Todd algebra of second-order cones; all vectors lie in one array F, and arguments say where they begin.

A cone is ``K = {(s0, s1): |s1| <= s0}``. With the scaling point w of s and z, of determinant 1, and v its square root,
``W = eta (2 v v' - J)`` and ``W z = W^-1 s = lambda``. Everything else is written in the scaled space, where s and z are both
lambda. (Nesterov and Todd 1997; formulas as in Vandenberghe, The CVXOPT linear and quadratic cone program solvers, 2010.)

Functions of one cone take its dimension first; given as a constant, it lets the compiler unroll them.
"""

from __future__ import annotations

from math import sqrt

from socp_statics.engines.kernel.compilation import inner
from socp_statics.engines.kernel.layout import FOUR, ONE, THREE

# A determinant below this share of the square of its first entry is rounding.
FLAT = 1e-30


@inner(forceinline=True)
def determinant(d, F, v):
    """``v0^2 - |v1|^2`` without cancellation, never below rounding.

    Args:
        d: Dimension of the cone.
        F: All vectors.
        v: Where the point begins.

    Returns:
        A positive number for a point inside the cone.
    """
    square = 0.0
    for i in range(ONE, d):
        square += F[v + i] * F[v + i]
    norm = sqrt(square)
    return max((F[v] - norm) * (F[v] + norm), FLAT * F[v] * F[v])


@inner(forceinline=True)
def scale_cone(d, F, s, z, w, lam):
    """Scaling point of one cone.

    Args:
        d: Dimension of the cone.
        F: All vectors.
        s: Slack, inside the cone.
        z: Multiplier, inside the cone.
        w: Scaling point, written.
        lam: The common image lambda of s and z, written.

    Returns:
        eta, the size of the scaling.
    """
    root_s, root_z = sqrt(determinant(d, F, s)), sqrt(determinant(d, F, z))
    by_s, by_z = 1.0 / root_s, 1.0 / root_z
    dot = 0.0
    for i in range(d):
        dot += F[s + i] * F[z + i]
    gamma = sqrt(max(0.5 + 0.5 * dot * by_s * by_z, 1.0))
    size = sqrt(root_s * root_z)
    s0, z0 = F[s] * by_s, F[z] * by_z
    part, half = size / (s0 + z0 + 2.0 * gamma), 0.5 / gamma
    F[lam] = size * gamma
    square = 0.0
    for i in range(ONE, d):
        si, zi = F[s + i] * by_s, F[z + i] * by_z
        wi = (si - zi) * half
        square += wi * wi
        F[w + i] = wi
        F[lam + i] = part * ((gamma + z0) * si + (gamma + s0) * zi)
    F[w] = sqrt(1.0 + square)
    return sqrt(root_s * by_z)


@inner(forceinline=True)
def unscale(d, F, w, by_eta, v, out, step):
    """``W^-1 v`` of one cone.

    Args:
        d: Dimension of the cone.
        F: All vectors.
        w: Scaling point.
        by_eta: 1 / eta.
        v: The vector.
        out: The result, written; v itself is allowed.
        step: Distance of the entries of v and of out.
    """
    dot = 0.0
    for i in range(ONE, d):
        dot += F[w + i] * F[v + i * step]
    first = F[v]
    share = dot / (1.0 + F[w]) - first
    F[out] = (F[w] * first - dot) * by_eta
    for i in range(ONE, d):
        F[out + i * step] = (F[v + i * step] + share * F[w + i]) * by_eta


@inner(forceinline=True)
def advance(d, F, w, share, dz, z):
    """One cone's part of ``z += step W^-1 dz``.

    Args:
        d: Dimension of the cone.
        F: All vectors.
        w: Scaling point.
        share: Step length over eta.
        dz: Direction of the multiplier, scaled.
        z: Multiplier, updated.
    """
    dot = 0.0
    for i in range(ONE, d):
        dot += F[w + i] * F[dz + i]
    along = dot / (1.0 + F[w]) - F[dz]
    F[z] += share * (F[w] * F[dz] - dot)
    for i in range(ONE, d):
        F[z + i] += share * (F[dz + i] + along * F[w + i])


@inner(forceinline=True)
def correct(d, F, lam, ds, dz, centre, out):
    """One cone's part of the solution u of ``lambda o u = lambda o lambda - centre e + ds o dz``, the target of the corrected direction.

    Args:
        d: Dimension of the cone.
        F: All vectors.
        lam: Scaled point.
        ds: Predictor of the slack, scaled.
        dz: Predictor of the multiplier, scaled.
        centre: sigma mu.
        out: The target, written; ds itself is allowed.
    """
    s0, z0, dot = F[ds], F[dz], 0.0
    first = s0 * z0 - centre
    for i in range(ONE, d):
        first += F[ds + i] * F[dz + i]
        dot += F[lam + i] * (s0 * F[dz + i] + z0 * F[ds + i])
    head = (F[lam] * first - dot) / determinant(d, F, lam)
    by_first = 1.0 / F[lam]
    F[out] = F[lam] + head
    for i in range(ONE, d):
        F[out + i] = F[lam + i] + (s0 * F[dz + i] + z0 * F[ds + i] - head * F[lam + i]) * by_first


@inner(forceinline=True)
def blocked(d, F, lam, ds, dz):
    """How soon one cone stops a step: lambda + t ds and lambda + t dz stay inside for ``t <= 1 / result``.

    Args:
        d: Dimension of the cone.
        F: All vectors.
        lam: Scaled point.
        ds: Direction of the slack, scaled.
        dz: Direction of the multiplier, scaled.

    Returns:
        The larger of the two rates; zero or negative where nothing stops them.
    """
    by_root = 1.0 / sqrt(determinant(d, F, lam))
    l0 = F[lam] * by_root
    first_s, first_z = l0 * F[ds], l0 * F[dz]
    for i in range(ONE, d):
        li = F[lam + i] * by_root
        first_s -= li * F[ds + i]
        first_z -= li * F[dz + i]
    part = 1.0 / (1.0 + l0)
    share_s, share_z = (first_s + F[ds]) * part, (first_z + F[dz]) * part
    square_s, square_z = 0.0, 0.0
    for i in range(ONE, d):
        li = F[lam + i] * by_root
        rest_s, rest_z = F[ds + i] - share_s * li, F[dz + i] - share_z * li
        square_s += rest_s * rest_s
        square_z += rest_z * rest_z
    return max(sqrt(square_s) - first_s, sqrt(square_z) - first_z) * by_root


@inner
def scale_cones(W, runs, count, orthant, F, s, z, w, lam, eta):
    """Scaling of all cones; the orthant's is ``w = sqrt(s / z)``.

    Args:
        W: Structure.
        runs: Where the runs of cones of equal dimension begin in W: number of cones, dimension, number of columns of each.
        count: Number of runs.
        orthant: Number of rows of the orthant.
        F: All vectors.
        s: Slacks.
        z: Multipliers.
        w: Scaling points, written.
        lam: Scaled point, written.
        eta: Sizes of the scalings, written, one a second-order cone.
    """
    for i in range(orthant):
        F[w + i] = sqrt(F[s + i] / F[z + i])
        F[lam + i] = sqrt(F[s + i] * F[z + i])
    a = orthant
    for r in range(count):
        at = runs + r * THREE
        cones, d = W[at], W[at + ONE]
        if d == THREE:
            for k in range(cones):
                F[eta + k] = scale_cone(THREE, F, s + a, z + a, w + a, lam + a)
                a += THREE
        elif d == FOUR:
            for k in range(cones):
                F[eta + k] = scale_cone(FOUR, F, s + a, z + a, w + a, lam + a)
                a += FOUR
        else:
            for k in range(cones):
                F[eta + k] = scale_cone(d, F, s + a, z + a, w + a, lam + a)
                a += d
        eta += cones


@inner
def unscale_all(W, runs, count, orthant, F, w, eta, v, out):
    """``W^-1 v`` of all cones; arguments as in `scale_cones`."""
    for i in range(orthant):
        F[out + i] = F[v + i] / F[w + i]
    a = orthant
    for r in range(count):
        at = runs + r * THREE
        cones, d = W[at], W[at + ONE]
        if d == THREE:
            for k in range(cones):
                unscale(THREE, F, w + a, 1.0 / F[eta + k], v + a, out + a, ONE)
                a += THREE
        elif d == FOUR:
            for k in range(cones):
                unscale(FOUR, F, w + a, 1.0 / F[eta + k], v + a, out + a, ONE)
                a += FOUR
        else:
            for k in range(cones):
                unscale(d, F, w + a, 1.0 / F[eta + k], v + a, out + a, ONE)
                a += d
        eta += cones


@inner
def advance_all(W, runs, count, orthant, F, w, eta, step, dz, z):
    """``z += step W^-1 dz`` of all cones; arguments as in `scale_cones` and `advance`."""
    for i in range(orthant):
        F[z + i] += step * F[dz + i] / F[w + i]
    a = orthant
    for r in range(count):
        at = runs + r * THREE
        cones, d = W[at], W[at + ONE]
        if d == THREE:
            for k in range(cones):
                advance(THREE, F, w + a, step / F[eta + k], dz + a, z + a)
                a += THREE
        elif d == FOUR:
            for k in range(cones):
                advance(FOUR, F, w + a, step / F[eta + k], dz + a, z + a)
                a += FOUR
        else:
            for k in range(cones):
                advance(d, F, w + a, step / F[eta + k], dz + a, z + a)
                a += d
        eta += cones


@inner
def correct_all(W, runs, count, orthant, F, lam, ds, dz, centre, out):
    """The solution u of ``lambda o u = lambda o lambda - centre e + ds o dz`` of all cones; arguments as in `scale_cones` and `correct`."""
    for i in range(orthant):
        F[out + i] = F[lam + i] + (F[ds + i] * F[dz + i] - centre) / F[lam + i]
    a = orthant
    for r in range(count):
        at = runs + r * THREE
        cones, d = W[at], W[at + ONE]
        if d == THREE:
            for _ in range(cones):
                correct(THREE, F, lam + a, ds + a, dz + a, centre, out + a)
                a += THREE
        elif d == FOUR:
            for _ in range(cones):
                correct(FOUR, F, lam + a, ds + a, dz + a, centre, out + a)
                a += FOUR
        else:
            for _ in range(cones):
                correct(d, F, lam + a, ds + a, dz + a, centre, out + a)
                a += d


@inner
def rate_of_all(W, runs, count, orthant, F, lam, ds, dz):
    """Reciprocal of the longest step that leaves all cones at their boundary at most; arguments as in `scale_cones` and `blocked`.

    Returns:
        The rate, at least 0.
    """
    rate = 0.0
    for i in range(orthant):
        rate = max(rate, -min(F[ds + i], F[dz + i]) / F[lam + i])
    a = orthant
    for r in range(count):
        at = runs + r * THREE
        cones, d = W[at], W[at + ONE]
        if d == THREE:
            for _ in range(cones):
                rate = max(rate, blocked(THREE, F, lam + a, ds + a, dz + a))
                a += THREE
        elif d == FOUR:
            for _ in range(cones):
                rate = max(rate, blocked(FOUR, F, lam + a, ds + a, dz + a))
                a += FOUR
        else:
            for _ in range(cones):
                rate = max(rate, blocked(d, F, lam + a, ds + a, dz + a))
                a += d
    return rate
