"""The two forms of a polyhedral cone of wrenches: what bounds it, and what spans it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.exceptions import InputError
from socp_statics.spatial import Array


@dataclass(frozen=True, eq=False)
class FaceForm:
    """``{F : U F <= 0, E F = 0}``: inequalities and equalities kept apart.

    Attributes:
        faces: U, outward normals, shape (k, d).
        equalities: E, shape (e, d).
        length: Length that moments are divided by where wrenches are measured [m].
    """

    faces: Array
    equalities: Array
    length: float = 1.0

    def excess(self, F: ArrayLike) -> Array:
        """Largest violation of a face or an equality, negative inside; with rows of unit length a lower bound of the distance.

        Args:
            F: Vectors, shape (d,) or (n, d).

        Returns:
            Shape () or (n,) [N]; -inf where nothing bounds the cone.

        Raises:
            InputError: Wrong shape (field ``wrench``).
        """
        rows = vectors(F, self.faces.shape[1])
        violated = np.concatenate([rows @ self.faces.T, np.abs(rows @ self.equalities.T)], axis=-1)
        return np.asarray(violated.max(axis=-1, initial=-np.inf))


@dataclass(frozen=True, eq=False)
class SpanForm:
    """``{V' a + N' b : a >= 0}``: rays, and lines that are open to both sides.

    Attributes:
        rays: V, shape (r, d).
        lines: N, shape (l, d).
        length: Length that moments are divided by where wrenches are measured [m].
    """

    rays: Array
    lines: Array
    length: float = 1.0


def units(dimension: int, length: float) -> Array:
    """What one unit of each component is: moments, the last three of six, count in units of the length; else 1.

    Args:
        dimension: Number of components.
        length: Length [m].
    """
    return np.repeat([1.0, length], 3) if dimension == 6 else np.ones(dimension)


def vectors(values: ArrayLike, dimension: int, field: str = "wrench") -> Array:
    """Finite vectors of one dimension that were checked.

    Args:
        values: Shape (d,) or (n, d).
        dimension: d.
        field: What to call them.

    Raises:
        InputError: Wrong shape, or a number that is not finite.
    """
    try:
        rows = np.array(values, dtype=float)
    except (TypeError, ValueError) as error:
        raise InputError(f"{field} must be real numbers", field=field) from error
    if rows.ndim not in (1, 2) or rows.shape[-1] != dimension:
        raise InputError(f"{field} must have the shape ({dimension},) or (n, {dimension}), got {rows.shape}", field=field)
    if not np.isfinite(rows).all():
        raise InputError(f"{field} must be finite", field=field)
    return rows


def checked_length(length: object) -> float:
    """A characteristic length that was checked.

    Raises:
        InputError: Not a finite number > 0 (field ``length``).
    """
    number = float(length) if isinstance(length, int | float | np.floating) and not isinstance(length, bool) else np.nan
    if not (np.isfinite(number) and number > 0.0):
        raise InputError(f"length must be a finite number > 0 [m], got {length!r}", field="length")
    return number
