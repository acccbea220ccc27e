"""Null spaces in the motion and in the force domain, and how they belong together."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.distribution.generalized_inverses import RELATIVE_RANK, pseudoinverse
from socp_statics.spatial import Array


def null_projector(A: ArrayLike, inverse: ArrayLike | None = None) -> Array:
    """``N(A) = E - A^# A``: projects onto the null space of A, along directions that the generalized inverse chooses.

    Args:
        A: Shape (..., m, n).
        inverse: A^#, shape (..., n, m), the pseudoinverse by default.

    Returns:
        Shape (..., n, n).
    """
    A = np.asarray(A, dtype=float)
    return np.eye(A.shape[-1]) - (pseudoinverse(A) if inverse is None else np.asarray(inverse, dtype=float)) @ A


def null_basis(A: ArrayLike) -> Array:
    """V(A): an orthonormal basis of the null space of A as columns, shape (n, n - rank)."""
    A = np.asarray(A, dtype=float)
    _, s, Vt = np.linalg.svd(A, full_matrices=True)
    rank = int((s > RELATIVE_RANK * s.max(initial=0.0)).sum())
    return Vt[rank:].T


def dual_null_basis(A: ArrayLike, inverse: ArrayLike | None = None) -> Array:
    """N*(A), the dual null space: ``N*(A) = N(A^#T)``, the forces of the joint space that A^# maps to no contact force.

    Implements (3.35).

    Args:
        A: A Jacobian, shape (m, n).
        inverse: A^#, shape (n, m), the pseudoinverse by default.

    Returns:
        An orthonormal basis as columns, shape (n, n - rank).
    """
    return null_basis((pseudoinverse(A) if inverse is None else np.asarray(inverse, dtype=float)).T)


def dual_projector(A: ArrayLike, inverse: ArrayLike | None = None) -> Array:
    """``N*(A) = E - A^T A^#T``: projects onto the dual null space, shape (..., n, n)."""
    A = np.asarray(A, dtype=float)
    sharp = pseudoinverse(A) if inverse is None else np.asarray(inverse, dtype=float)
    return np.eye(A.shape[-1]) - A.swapaxes(-1, -2) @ sharp.swapaxes(-1, -2)


def projector_from_dual(dual: ArrayLike, weights: ArrayLike) -> Array:
    """The projector of the motion domain from that of the force domain: ``W^-1 (E - A^T A^-WT) W = E - A^-W A``.

    Implements (3.36).

    Args:
        dual: ``E - A^T A^-WT``, shape (n, n).
        weights: W, symmetric and positive definite, shape (n, n).

    Returns:
        ``E - A^-W A``, shape (n, n).
    """
    W = np.asarray(weights, dtype=float)
    return np.linalg.solve(W, np.asarray(dual, dtype=float) @ W)
