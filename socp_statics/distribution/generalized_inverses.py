"""Generalised inverses of a map with more unknowns than rows: the pseudoinverse, and those that weigh the unknowns.

All of them give, for ``A x = b``, the solution that is least in some norm; where no solution exists, among those of least residual.
None of them knows an inequality: whether the contact components they return lie in their cones has to be asked afterwards.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.exceptions import InputError
from socp_statics.spatial import Array

# Singular values below this share of the largest count as zero.
RELATIVE_RANK = 1e-12


def pseudoinverse(A: ArrayLike) -> Array:
    """The Moore-Penrose inverse ``A^+``: ``x = A^+ b`` minimises ``|x|``.

    The norm adds newtons to newton metres, so that the answer depends on the unit of length; `weighted_inverse` does not have to.

    Args:
        A: Shape (..., m, n).

    Returns:
        Shape (..., n, m).

    Raises:
        InputError: Not a matrix of finite numbers (field ``A``).
    """
    inverse: Array = np.asarray(np.linalg.pinv(_matrix(A), rcond=RELATIVE_RANK), dtype=float)
    return inverse


def weighted_inverse(A: ArrayLike, weights: ArrayLike) -> Array:
    """The weighted inverse ``A^-W = W^-1 A^T (A W^-1 A^T)^-1``: ``x = A^-W b`` minimises ``x^T W x``.

    A large weight makes a component dear. A rank-deficient A is allowed, the inner inverse is then a pseudoinverse.

    Args:
        A: Shape (m, n), or (..., m, n) for a batch.
        weights: W, symmetric and positive definite, shape (n, n), or its diagonal, shape (n,); of a batch its diagonals, shape (..., n).

    Returns:
        Shape (n, m), or (..., n, m).

    Raises:
        InputError: Not a matrix of finite numbers, or weights that are not positive definite (fields ``A``, ``weights``).
    """
    A = _matrix(A)
    diagonal = _diagonal(A, weights, "weights")
    if diagonal is not None:
        if not (diagonal > 0.0).all():
            raise InputError("weights must be positive definite: every component needs a weight > 0", field="weights")
        return _of_roots(A, 1.0 / np.sqrt(diagonal))
    W = _symmetric(weights, A.shape[1], "weights")
    values, axes = np.linalg.eigh(W)
    if not values[0] > 0.0:
        raise InputError("weights must be positive definite: every component needs a weight > 0", field="weights")
    root: Array = axes / np.sqrt(values)
    return root @ pseudoinverse(A @ root)


def inverse_of_shares(A: ArrayLike, shares: ArrayLike) -> Array:
    """The weighted inverse of ``W = S^-1``, given S: ``S A^T (A S A^T)^+``, where a share of zero uses nothing of a component.

    Args:
        A: Shape (m, n), or (..., m, n) for a batch.
        shares: S, symmetric and positive semidefinite, shape (n, n), or its diagonal, shape (n,); of a batch its diagonals, shape (..., n).

    Returns:
        Shape (n, m), or (..., n, m).

    Raises:
        InputError: Not a matrix of finite numbers, or shares that are not positive semidefinite (fields ``A``, ``shares``).
    """
    A = _matrix(A)
    diagonal = _diagonal(A, shares, "shares")
    if diagonal is not None:
        if not (diagonal >= 0.0).all():
            raise InputError("shares must be positive semidefinite: no component has a share < 0", field="shares")
        return _of_roots(A, np.sqrt(diagonal))
    values, axes = np.linalg.eigh(_symmetric(shares, A.shape[1], "shares"))
    largest = float(np.abs(values).max(initial=0.0))
    if values.size and values[0] < -RELATIVE_RANK * largest:
        raise InputError("shares must be positive semidefinite: no component has a share < 0", field="shares")
    root: Array = axes * np.sqrt(np.where(values > RELATIVE_RANK * largest, values, 0.0))
    return root @ pseudoinverse(A @ root)


def _of_roots(A: Array, root: Array) -> Array:
    """``R (A R)^+`` of a diagonal R, for one map or a batch."""
    return root[..., :, None] * pseudoinverse(A * root[..., None, :])


def _diagonal(A: Array, values: ArrayLike, field: str) -> Array | None:
    """The values where they are diagonals; None where they are to be read as a whole matrix."""
    array, size = _numbers(values, field), A.shape[-1]
    if A.ndim == 2 and array.shape != (size,):
        return None
    if array.ndim == 0 or array.shape[-1] != size:
        raise InputError(f"{field} must be {size} numbers for each map, got shape {array.shape}", field=field)
    return array


def _matrix(A: ArrayLike) -> Array:
    matrix = _numbers(A, "A")
    if matrix.ndim < 2:
        raise InputError(f"A must be a matrix, got shape {matrix.shape}", field="A")
    return matrix


def _symmetric(values: ArrayLike, size: int, field: str) -> Array:
    """A matrix of weights, symmetric."""
    array = _numbers(values, field)
    if array.shape != (size, size) or not np.allclose(array, array.T, rtol=1e-9, atol=0.0):
        raise InputError(f"{field} must be {size} numbers or a symmetric {size}x{size} matrix, got shape {array.shape}", field=field)
    return 0.5 * (array + array.T)


def _numbers(values: ArrayLike, field: str) -> Array:
    try:
        array = np.asarray(values, dtype=float)
    except (TypeError, ValueError) as error:
        raise InputError(f"{field} must be real numbers", field=field) from error
    if not np.isfinite(array).all():
        raise InputError(f"{field} must be finite", field=field)
    return array
