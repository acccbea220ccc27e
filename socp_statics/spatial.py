"""Wrenches and how they move: the conventions of the whole package, stated once.

A wrench is the stacked vector ``[force; moment]`` [N, N m] with the moment taken about a named point; world axes unless a
name says otherwise. ``R_WC`` turns coordinates in frame C into world coordinates; ``p_WC`` is the origin of C in the world.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def skew(r: ArrayLike) -> Array:
    """Matrix of the cross product: ``skew(r) @ a == np.cross(r, a)``.

    Args:
        r: Vectors, shape (..., 3).

    Returns:
        Antisymmetric matrices, shape (..., 3, 3).
    """
    r = np.asarray(r, dtype=float)
    S = np.zeros((*r.shape[:-1], 3, 3))
    S[..., 0, 1], S[..., 0, 2] = -r[..., 2], r[..., 1]
    S[..., 1, 0], S[..., 1, 2] = r[..., 2], -r[..., 0]
    S[..., 2, 0], S[..., 2, 1] = -r[..., 1], r[..., 0]
    return S


def cross(a: Array, b: Array) -> Array:
    """Cross products of vectors in the last axis, without the general machinery of ``numpy.cross``.

    Args:
        a: Shape (..., 3).
        b: Shape (..., 3), broadcastable.

    Returns:
        Shape (..., 3).
    """
    a0, a1, a2 = a[..., 0], a[..., 1], a[..., 2]
    b0, b1, b2 = b[..., 0], b[..., 1], b[..., 2]
    first = a1 * b2 - a2 * b1
    out = np.empty((*first.shape, 3))
    out[..., 0] = first
    out[..., 1] = a2 * b0 - a0 * b2
    out[..., 2] = a0 * b1 - a1 * b0
    return out


def moment_about(o: ArrayLike, p: ArrayLike, force: ArrayLike, moment_p: ArrayLike = (0.0, 0.0, 0.0)) -> Array:
    """Moment about ``o`` of a force and moment given at ``p``, ``m_O = -S(r_O - r_P) f + m_P``.

    Implements (3.1).

    Args:
        o: New moment point, shape (..., 3) [m].
        p: Point the moment was taken about, shape (..., 3) [m].
        force: Force, shape (..., 3) [N].
        moment_p: Moment about ``p``, shape (..., 3) [N m].

    Returns:
        Moment about ``o``, shape (..., 3) [N m].
    """
    arm = np.asarray(p, dtype=float) - np.asarray(o, dtype=float)
    return cross(arm, np.asarray(force, dtype=float)) + np.asarray(moment_p, dtype=float)


def wrench_translation(r_OP: ArrayLike) -> Array:
    """Matrix that moves a wrench from P to O in the same axes: ``F_O = [[E, 0], [-S(r_OP), E]] F_P``.

    Implements (3.4).

    Args:
        r_OP: ``r_O - r_P``, shape (3,) [m].

    Returns:
        The transpose of the twist translation, shape (6, 6).
    """
    T = np.eye(6)
    T[3:, :3] = -skew(r_OP)
    return T


def wrench_to_frame(R_BW: ArrayLike, r_OP_W: ArrayLike) -> Array:
    """Matrix that takes a wrench at P in world axes to O in the axes of B.

    Implements (3.3), corrected: with ``r_OP = r_O - r_P`` the lower left block is ``-S(r_OP)``, without a transpose.

    Args:
        R_BW: Rotation from world to B coordinates, shape (3, 3).
        r_OP_W: ``r_O - r_P`` in world axes, shape (3,) [m].

    Returns:
        Shape (6, 6): ``B_F_O = X @ W_F_P``.
    """
    R = np.asarray(R_BW, dtype=float)
    return np.kron(np.eye(2), R) @ wrench_translation(r_OP_W)


def twist_to_frame(R_BW: ArrayLike, r_OP_W: ArrayLike) -> Array:
    """Matrix that takes a twist ``[v; w]`` at P in world axes to O in the axes of B.

    Implements (3.2), corrected: the wrench transform is this matrix's inverse transpose, ``B_F_O = X^-T W_F_P`` with the same
    frames on both sides, so that the power ``V . F`` does not change.

    Args:
        R_BW: Rotation from world to B coordinates, shape (3, 3).
        r_OP_W: ``r_O - r_P`` in world axes, shape (3,) [m].

    Returns:
        Shape (6, 6).
    """
    R = np.asarray(R_BW, dtype=float)
    T = np.eye(6)
    T[:3, 3:] = -skew(r_OP_W)
    return np.kron(np.eye(2), R) @ T
