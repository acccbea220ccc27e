"""The same set of forces several times over, as one set: for questions that ask for several choices of forces at once."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from socp_statics.models.contact_forces_set import ForceShape
from socp_statics.spatial import Array

BY_SLIPPING, BY_SOFT, TILED = ("mu",), ("gamma", "mu_over_gamma"), ("lo", "hi", "equal", "load", "limit")


class RepeatedForces(NamedTuple):
    """A set that holds copies of another.

    Attributes:
        shape: Its structure.
        values: Its numbers by parameter name.
        columns: Where the unknowns of each copy are, shape (copies, nx).
    """

    shape: ForceShape
    values: dict[str, Any]
    columns: NDArray[np.int_]


def repeated_forces(shape: ForceShape, values: Mapping[str, Any], copies: int) -> RepeatedForces:
    """Copies of a set of forces, independent of each other.

    Args:
        shape: Structure of the set, without torque variables.
        values: Its numbers, of `force_values`.
        copies: How many, at least 1.

    Returns:
        The set of all copies.
    """
    s = shape
    more = {name: copies * getattr(s, name) for name in ("circular", "box", "elliptic", "frictionless", "handle", "rows", "lower", "upper",
                                                         "equal", "limits")}  # fmt: skip
    whole = s._replace(**more)
    point = _spread((s.circular - s.box, s.box, s.elliptic, s.frictionless), copies)
    soft = _spread((s.box, s.elliptic), copies)
    handle = _spread((s.handle,), copies)
    slipping = point[:, : s.slipping]
    f_t = (2 * slipping[:, :, None] + np.arange(2)).reshape(copies, -1)
    start = 2 * whole.slipping
    columns = np.hstack([f_t, start + point, start + whole.points + soft, start + whole.points + whole.box + whole.elliptic + handle])
    out: dict[str, Any] = dict(values)
    for name, index in ((n, slipping) for n in BY_SLIPPING):
        out[name] = _scattered(values[name], index)
    for name in BY_SOFT:
        out[name] = _scattered(values[name], soft)
    for name in TILED:
        out[name] = np.tile(values[name], copies)
    for name in ("S_lower", "S_upper", "S_equal"):
        out[name] = block_rows(values[name], point, whole.points)
    for name in ("G", "H"):
        out[name] = block_rows(values[name], columns, whole.columns)
    return RepeatedForces(whole, out, columns)


def block_rows(rows: Array, columns: NDArray[np.int_], width: int) -> Array:
    """Rows over the unknowns of one copy, repeated for every copy.

    Args:
        rows: Shape (k, n).
        columns: Where each copy's entries are, shape (copies, n).
        width: Number of entries of all copies.

    Returns:
        Shape (copies k, width).
    """
    out = np.zeros((len(columns), len(rows), width))
    for block, index in zip(out, columns, strict=True):
        block[:, index] = rows
    return out.reshape(len(columns) * len(rows), width)


def _spread(sizes: tuple[int, ...], copies: int) -> NDArray[np.int_]:
    """Places of the entries of each copy where groups stay together: first all copies of the first group."""
    starts = np.cumsum([0, *(copies * n for n in sizes)])
    return np.hstack([start + np.arange(copies * n).reshape(copies, n) for start, n in zip(starts, sizes, strict=False)]).astype(int)


def _scattered(values: Array, index: NDArray[np.int_]) -> Array:
    out = np.zeros(index.size)
    out[index] = values
    return out
