"""What every cone answers: membership, signed distance, projection and the dual cone."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from numbers import Real

import numpy as np
from numpy.typing import ArrayLike, NDArray

from socp_statics.exceptions import InputError

Array = NDArray[np.float64]
BoolArray = NDArray[np.bool_]

# Beyond these limits a cone cannot be told from a ray or a half-space in double precision, and squares would overflow.
NARROWEST, WIDEST = 1e-60, 1e60


class ConvexCone(ABC):
    """A closed convex cone with its apex at zero, in the components of a contact frame.

    Lengths are Euclidean in those components [N] (a torsional moment counts 1 N m as 1 N). A vector with a component that is not
    finite is never inside: its distance and its projection are NaN.
    """

    @property
    @abstractmethod
    def dimension(self) -> int:
        """Number of components of a vector of this cone."""

    @abstractmethod
    def dual(self) -> ConvexCone:
        """The dual cone: all v with ``f . v >= 0`` for every f of this cone."""

    @abstractmethod
    def _signed_distance(self, rows: Array) -> Array:
        """Signed distance of finite rows of magnitude about one, shape (n, d) -> (n,)."""

    @abstractmethod
    def _nearest(self, rows: Array) -> Array:
        """Projection of finite rows of magnitude about one, shape (n, d) -> (n, d)."""

    def contains(self, f: ArrayLike, tolerance: float = 0.0) -> bool | BoolArray:
        """Whether vectors lie in the (closed) cone.

        Args:
            f: Vectors in the contact frame, shape (n, d) or (d,) [N].
            tolerance: Distance outside the cone that is still accepted [N]; a negative one asks for that depth inside.

        Returns:
            Shape (n,), or one bool for one vector; False where a component is not finite.

        Raises:
            InputError: Wrong shape (field ``force``) or a tolerance that is not a finite number.
        """
        if not isinstance(tolerance, Real) or not math.isfinite(tolerance):
            raise InputError(f"tolerance must be a finite number, got {tolerance!r}", field="tolerance")
        inside: BoolArray = np.less_equal(np.asarray(self.distance(f)), tolerance, dtype=np.bool_)
        return bool(inside) if np.ndim(inside) == 0 else inside

    def distance(self, f: ArrayLike) -> float | Array:
        """Signed Euclidean distance: positive outside, minus the distance to the boundary inside.

        Args:
            f: Vectors in the contact frame, shape (n, d) or (d,) [N].

        Returns:
            Shape (n,), or one float for one vector [N].

        Raises:
            InputError: Wrong shape (field ``force``).
        """
        distance = _scaled(self._signed_distance, f, self.dimension)
        return float(distance) if distance.ndim == 0 else distance

    def project(self, f: ArrayLike) -> Array:
        """The nearest point of the cone.

        Args:
            f: Vectors in the contact frame, shape (n, d) or (d,) [N].

        Returns:
            Same shape as ``f`` [N].

        Raises:
            InputError: Wrong shape (field ``force``).
        """
        return _scaled(self._nearest, f, self.dimension)


def finite_coefficient(value: object, field: str, *, positive: bool = False) -> float:
    """A friction coefficient that was checked.

    Args:
        value: What the user gave.
        field: Its key, for the message.
        positive: Whether zero is refused.

    Raises:
        InputError: Not a finite number, negative, or zero where that is refused.
    """
    number = float(value) if isinstance(value, Real) and not isinstance(value, bool) else math.nan
    if not math.isfinite(number) or number < 0.0 or (positive and number == 0.0):
        raise InputError(f"{field} must be a finite number {'> 0' if positive else '>= 0'}, got {value!r}", field=field)
    return number


def resolvable(coefficient: float) -> float:
    """The coefficient that geometry computes with: 0 when too small to be told from it, and never so large that squares overflow."""
    return 0.0 if coefficient < NARROWEST else min(coefficient, WIDEST)


def _scaled(function: Callable[[Array], Array], f: ArrayLike, dimension: int) -> Array:
    """Evaluate a function that is positively homogeneous of degree one on vectors of any magnitude."""
    vectors = _vectors(f, dimension)
    rows = np.atleast_2d(vectors)
    finite: BoolArray = np.asarray(np.isfinite(rows).all(axis=1))
    rows = np.where(finite[:, None], rows, 0.0)
    # A power of two as the unit rounds nothing, so vectors exactly on a face stay exactly on it.
    _, exponent = np.frexp(np.abs(rows).max(axis=1, initial=0.0))
    values = function(np.ldexp(rows, -exponent[:, None]))
    values = np.ldexp(values, exponent if values.ndim == 1 else exponent[:, None])
    values[~finite] = np.nan
    return values if vectors.ndim == 2 else np.asarray(values[0])


def _vectors(f: ArrayLike, dimension: int) -> Array:
    try:
        array = np.asarray(f)
        vectors = array.astype(float) if array.dtype.kind in "iuf" or array.size == 0 else None
    except ValueError:
        vectors = None
    if vectors is None:
        raise InputError("force must be an array of real numbers", field="force")
    if vectors.ndim not in (1, 2) or vectors.shape[-1] != dimension:
        raise InputError(f"force must have the shape ({dimension},) or (n, {dimension}), got {vectors.shape}", field="force")
    return vectors
