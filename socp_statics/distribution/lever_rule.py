"""The generalized inverse that is consistent with statics (5.10.4): the lever rule for two and, nested, for three contacts.

``F = C^-W F_C`` with ``W = blockdiag(w_k E)``. For two contacts ``w_k = |D . (p - r_k)|`` with D from one to the other: the load is
shared as on a lever. Here the rule is stated by its shares ``alpha_k`` (the inverse weights, which sum to 1), so that it stays well
defined where p meets a contact, and p is first moved to the nearest point between the contacts: outside, the absolute value would lose
its sign. It is meant for contacts that carry a whole wrench.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from socp_statics.distribution.load_line import LoadLine
from socp_statics.exceptions import InputError
from socp_statics.spatial import Array

SAME_PLACE = 1e-9


def lever_shares(line: LoadLine) -> Array:
    """Shares of the load by the lever rule.

    Args:
        line: p and two or three contacts, of `load_line`.

    Returns:
        alpha, shape (..., k), each >= 0, sum 1.

    Raises:
        InputError: Not two or three contacts.
    """
    k = line.contacts.shape[-2]
    if k == 2:
        return between_two(line.point, line.contacts[..., 0, :], line.contacts[..., 1, :])[0]
    if k == 3:
        return among_three(line.point, line.contacts)
    message = f"the lever rule is for two or three contacts, here are {k}: the method 'barycentric' takes any number"
    raise InputError(message, name="contacts", field="contacts")


def between_two(p: Array, a: Array, b: Array) -> tuple[Array, Array]:
    """Lever rule on the segment from a to b.

    Args:
        p: Shape (..., 2) [m].
        a: Shape (..., 2) [m].
        b: Shape (..., 2) [m].

    Returns:
        Shares of a and b, shape (..., 2), halves where the two coincide; and the distance of p from the segment, shape (...,) [m].
    """
    D = b - a
    squared = (D * D).sum(axis=-1)
    apart = squared > SAME_PLACE**2
    s = np.clip(np.where(apart, ((p - a) * D).sum(axis=-1) / np.where(apart, squared, 1.0), 0.5), 0.0, 1.0)
    away = p - a - s[..., None] * D
    return np.stack([1.0 - s, s], axis=-1), np.sqrt((away * away).sum(axis=-1))


def among_three(p: Array, r: Array) -> Array:
    """Nested lever rule: contacts 1 and 2 share what their common point leaves to contact 3; on the nearest edge where p is outside.

    With r_12 where the line from 3 through p meets the line of 1 and 2, ``alpha_3 = |p - r_12| / |r_3 - r_12|`` and the rest goes to 1
    and 2 by the lever rule at r_12. These are ratios of areas, which stay defined where p meets contact 3.

    Args:
        p: Shape (..., 2) [m].
        r: Shape (..., 3, 2) [m].

    Returns:
        Shape (..., 3).
    """
    alpha, inside = in_triangle(p, r[..., 0, :], r[..., 1, :], r[..., 2, :])
    return np.where(inside[..., None], alpha, on_nearest_segment(p, r)) if not inside.all() else alpha


def in_triangle(p: Array, a: Array, b: Array, c: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Barycentric coordinates of p in a triangle, shape (..., 3), and whether it is inside a triangle that is not flat, shape (...,)."""
    whole = _twice_area(a, b, c)
    longest = np.maximum(np.maximum(_squared(b - a), _squared(c - b)), _squared(a - c))
    proper = np.abs(whole) > SAME_PLACE * longest
    size = np.where(proper, whole, 1.0)
    alpha = np.stack([_twice_area(p, b, c), _twice_area(a, p, c), _twice_area(a, b, p)], axis=-1) / size[..., None]
    return alpha, proper & (alpha >= 0.0).all(axis=-1)


def on_nearest_segment(p: Array, r: Array) -> Array:
    """Lever rule on the nearest of all segments between contacts, shape (..., k)."""
    k = r.shape[-2]
    best = np.full(p.shape[:-1], np.inf)
    alpha = np.zeros((*p.shape[:-1], k))
    for i in range(k):
        for j in range(i + 1, k):
            shares, distance = between_two(p, r[..., i, :], r[..., j, :])
            nearer = distance < best
            best = np.where(nearer, distance, best)
            candidate = np.zeros_like(alpha)
            candidate[..., i], candidate[..., j] = shares[..., 0], shares[..., 1]
            alpha = np.where(nearer[..., None], candidate, alpha)
    return alpha


def _twice_area(a: Array, b: Array, c: Array) -> Array:
    return (b[..., 0] - a[..., 0]) * (c[..., 1] - a[..., 1]) - (b[..., 1] - a[..., 1]) * (c[..., 0] - a[..., 0])


def _squared(d: Array) -> Array:
    return (d * d).sum(axis=-1)
