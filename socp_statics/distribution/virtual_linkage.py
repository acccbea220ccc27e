"""The virtual linkage (3.5.2): internal forces as members between the contact points, and internal moments.

A member joins every pair of contacts. A positive member force pulls its two contacts together (tension on the member), a negative one
pushes them apart; the chapter's Fig. 3.5 calls the latter compression. Internal forces alone say nothing about cones: the sum with the
particular solution has to lie in them. Contact forces are reactions in world axes.

Members number p(p-1)/2, but V_L has rank 1, 3, 6, 9, 12 for p = 2 to 6 contacts in general position, 5 for four coplanar ones and 2 for
three on a line: beyond that the member forces behind given contact forces are not unique, and the least ones are meant.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.distribution.dual_null_space import null_projector
from socp_statics.distribution.generalized_inverses import pseudoinverse
from socp_statics.exceptions import InputError
from socp_statics.spatial import Array, skew


def members(contacts: int) -> list[tuple[int, int]]:
    """The pairs of contacts in the order of the member forces: (1,2), (1,3), ..., (2,3), ..., counted from 0."""
    return list(combinations(range(contacts), 2))


def force_map(positions_W: ArrayLike, point_W: ArrayLike) -> Array:
    """T_f^T: contact forces to the wrench about a point, ``[E; S(r_k - r)]`` side by side, shape (6, 3p)."""
    arms = _positions(positions_W) - np.asarray(point_W, dtype=float)
    return np.hstack([np.vstack([np.eye(3), skew(arm)]) for arm in arms])


def moment_map(contacts: int) -> Array:
    """T_m^T: contact moments to the wrench, ``[0; E]`` side by side (not ones), shape (6, 3p)."""
    return np.tile(np.vstack([np.zeros((3, 3)), np.eye(3)]), (1, contacts))


def point_contact_forces(positions_W: ArrayLike, point_W: ArrayLike, wrench: ArrayLike, f_a: ArrayLike | None = None) -> Array:
    """Forces of point contacts that balance a wrench: ``f^c = (T_f^T)^+ F_ef + N(T_f^T) f_a``.

    Implements (3.42).

    Args:
        positions_W: Of the contacts, shape (p, 3) [m].
        point_W: What the wrench is about, shape (3,) [m].
        wrench: F_ef, shape (6,) [N, N m].
        f_a: Any contact forces, whose internal part is added, shape (3p,) [N]; none by default.

    Returns:
        Shape (3p,) [N].
    """
    T = force_map(positions_W, point_W)
    f = pseudoinverse(T) @ np.asarray(wrench, dtype=float)
    return f if f_a is None else f + null_projector(T) @ np.asarray(f_a, dtype=float)


def linkage_matrix(positions_W: ArrayLike) -> Array:
    """V_L: member forces to contact forces; column (i, j) has the unit vector e_ij at i and e_ji at j.

    Implements (3.43), corrected: the member forces are (f12, f13, f14, f23, f24, f34) for four contacts, and so on.

    Args:
        positions_W: Of the contacts, shape (p, 3) [m].

    Returns:
        Shape (3p, p(p-1)/2).

    Raises:
        InputError: Fewer than two contacts, or two at the same place: no member joins them.
    """
    r = _positions(positions_W)
    pairs = members(len(r))
    if not pairs:
        raise InputError("a virtual linkage joins at least two contacts, got one", name="contacts", field="contacts")
    V = np.zeros((3 * len(r), len(pairs)))
    for column, (i, j) in enumerate(pairs):
        d = r[j] - r[i]
        length = float(np.linalg.norm(d))
        if length == 0.0:
            message = f"contacts {i} and {j} are at the same place: no member of the virtual linkage joins them"
            raise InputError(message, name="contacts", field="contacts")
        V[3 * i : 3 * i + 3, column], V[3 * j : 3 * j + 3, column] = d / length, -d / length
    return V


def internal_contact_forces(V_L: ArrayLike, f_int: ArrayLike) -> Array:
    """Contact forces of member forces: ``f^n = V_L f_int``; together they have no wrench, ``T_f^T V_L = 0``.

    Implements (3.44).

    Args:
        V_L: Shape (3p, p(p-1)/2).
        f_int: Shape (p(p-1)/2,) [N].

    Returns:
        Shape (3p,) [N].

    Raises:
        InputError: The wrong number of member forces.
    """
    V, f = np.asarray(V_L, dtype=float), np.asarray(f_int, dtype=float)
    if f.shape != (V.shape[1],):
        raise InputError(f"f_int: {V.shape[1]} member forces are expected, got shape {f.shape}", name="f_int", field="f_int")
    return V @ f


def internal_moments(m_n: ArrayLike) -> tuple[Array, Array]:
    """Internal moments are the null-space contact moments themselves, ``m_int = m^n``, and sum to ``m_e = sum_k m_k``.

    Implements (3.45).

    Args:
        m_n: Shape (3p,) [N m].

    Returns:
        m_int, shape (3p,), and m_e, shape (3,) [N m].
    """
    m = np.asarray(m_n, dtype=float)
    return m, m.reshape(-1, 3).sum(axis=0)


def member_forces(positions_W: ArrayLike, forces_W: ArrayLike) -> Array:
    """The internal forces of a *given* solution: ``V_L^+ f``, which is blind to the least-norm part that carries the load.

    Args:
        positions_W: Of the contacts, shape (p, 3) [m].
        forces_W: Their forces, shape (p, 3) or (3p,) [N].

    Returns:
        Shape (p(p-1)/2,) [N], tension positive; the least ones where V_L has not full column rank.
    """
    f = np.asarray(forces_W, dtype=float).reshape(-1)
    return pseudoinverse(linkage_matrix(positions_W)) @ f


def _positions(positions_W: ArrayLike) -> Array:
    r = np.asarray(positions_W, dtype=float)
    if r.ndim != 2 or r.shape[1] != 3:
        raise InputError(f"positions: shape (p, 3) is expected, got {r.shape}", name="positions", field="positions")
    return r
