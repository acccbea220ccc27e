"""The grasp description matrix: contact wrenches of the null space to internal forces and moments, and back (3.5.2).

``G`` has ``6 + p(p-1)/2 + 3p`` rows, the six of the zero wrench among them, and 6p columns: square, and regular, only for three contacts
that are not on a line and four that are not in a plane. Everywhere else, double stance among it, its pseudoinverse is meant, and says how
well it does: what of the wanted internal forces and moments it cannot give.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.distribution.generalized_inverses import pseudoinverse
from socp_statics.distribution.virtual_linkage import force_map, linkage_matrix, moment_map
from socp_statics.exceptions import InputError
from socp_statics.spatial import Array


class InternalWrench(NamedTuple):
    """Internal forces and moments: members (p(p-1)/2,) [N], moments (3p,) [N m]."""

    forces: Array
    moments: Array


class Recovered(NamedTuple):
    """Contact wrenches of the null space, and what they could not give.

    Attributes:
        forces: f^n, shape (3p,) [N].
        moments: m^n, shape (3p,) [N m].
        exact: Whether they have exactly the internal forces and moments that were wanted, and no net wrench.
        missed: What is missing from ``G [f^n; m^n]``, shape (6 + p(p-1)/2 + 3p,).
    """

    forces: Array
    moments: Array
    exact: bool
    missed: Array


def net_internal_wrench(positions_W: ArrayLike, point_W: ArrayLike, f_n: ArrayLike, m_n: ArrayLike) -> Array:
    """``T_f^T f^n + T_m^T m^n``, zero for what is internal.

    Implements (3.46).

    Args:
        positions_W: Of the contacts, shape (p, 3) [m].
        point_W: What the wrench is about, shape (3,) [m].
        f_n: Contact forces, shape (3p,) [N].
        m_n: Contact moments, shape (3p,) [N m].

    Returns:
        Shape (6,).
    """
    T_f = force_map(positions_W, point_W)
    return T_f @ np.asarray(f_n, dtype=float) + moment_map(T_f.shape[1] // 3) @ np.asarray(m_n, dtype=float)


def grasp_description(positions_W: ArrayLike, point_W: ArrayLike) -> Array:
    """``G = [[T_f^T, T_m^T], [V_L^+, 0], [0, E]]``.

    Implements (3.47), corrected: T_m^T has identity blocks, and the rows number 6 + p(p-1)/2 + 3p, those of the zero wrench included.

    Args:
        positions_W: Of the contacts, shape (p, 3) [m].
        point_W: What wrenches are about, shape (3,) [m].

    Returns:
        Shape (6 + p(p-1)/2 + 3p, 6p).
    """
    T_f, V = force_map(positions_W, point_W), linkage_matrix(positions_W)
    n, k = V.shape
    return np.block([[T_f, moment_map(n // 3)], [pseudoinverse(V), np.zeros((k, n))], [np.zeros((n, n)), np.eye(n)]])


def internal_wrench(G: ArrayLike, f_n: ArrayLike, m_n: ArrayLike) -> tuple[Array, InternalWrench]:
    """``F_int = G F^n``: internal forces and moments of null-space contact wrenches.

    Implements (3.48).

    Args:
        G: Of `grasp_description`.
        f_n: Contact forces, shape (3p,) [N].
        m_n: Contact moments, shape (3p,) [N m].

    Returns:
        The net wrench, shape (6,), zero where the wrenches are internal; and the internal forces and moments.
    """
    G = np.asarray(G, dtype=float)
    n = G.shape[1] // 2
    out = G @ np.concatenate([np.asarray(f_n, dtype=float), np.asarray(m_n, dtype=float)])
    return out[:6], InternalWrench(out[6 : len(out) - n], out[len(out) - n :])


def contact_wrenches_of(G: ArrayLike, f_int: ArrayLike, m_int: ArrayLike) -> Recovered:
    """``F^n = G^-1 F_int`` where G is square and regular, else ``G^+ F_int``.

    Implements (3.49), corrected: G^-1 exists only for three contacts not on a line and four not in a plane.

    Args:
        G: Of `grasp_description`.
        f_int: Member forces, shape (p(p-1)/2,) [N].
        m_int: Internal moments, shape (3p,) [N m].

    Returns:
        The contact wrenches, and whether they give exactly what was wanted.

    Raises:
        InputError: The wrong number of internal forces or moments.
    """
    G = np.asarray(G, dtype=float)
    n = G.shape[1] // 2
    f, m = np.asarray(f_int, dtype=float), np.asarray(m_int, dtype=float)
    for word, given, size in (("f_int", f, len(G) - 6 - n), ("m_int", m, n)):
        if given.shape != (size,):
            raise InputError(f"{word}: {size} numbers are expected, got shape {given.shape}", name=word, field=word)
    wanted = np.concatenate([np.zeros(6), f, m])
    x = pseudoinverse(G) @ wanted
    missed = wanted - G @ x
    exact = bool(np.abs(missed).max() <= 1e-9 * max(float(np.abs(wanted).max()), 1e-300))
    return Recovered(x[:n], x[n:], exact, missed)


def inverse_in_blocks(positions_W: ArrayLike, point_W: ArrayLike) -> Array:
    """``G^-1 = [[(T_f^T)^+, V_L, -(T_f^T)^+ T_m^T], [0, 0, E]]``, an inverse for three and four contacts in general position.

    Implements (3.50), corrected: the lower left block is zero; with the printed (T_m^T)^+ the matrix is no inverse of G.

    Args:
        positions_W: Of the contacts, shape (p, 3) [m].
        point_W: What wrenches are about, shape (3,) [m].

    Returns:
        Shape (6p, 6 + p(p-1)/2 + 3p).
    """
    T_f, V = force_map(positions_W, point_W), linkage_matrix(positions_W)
    n, k = V.shape
    sharp = pseudoinverse(T_f)
    return np.block([[sharp, V, -sharp @ moment_map(n // 3)], [np.zeros((n, 6)), np.zeros((n, k)), np.eye(n)]])
