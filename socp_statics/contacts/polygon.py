"""Contact polygons: convex, counter-clockwise, without idle vertices."""

from __future__ import annotations

from typing import Any

import numpy as np

from socp_statics.exceptions import InputError
from socp_statics.spatial import Array

COLLINEAR = 1e-12


def _cross(a: Array, b: Array) -> Array:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def rectangle(length: float, width: float) -> Array:
    """Corners of a rectangle centred on the contact frame, counter-clockwise, shape (4, 2) [m]."""
    x, y = length / 2, width / 2
    return np.array([[x, y], [-x, y], [-x, -y], [x, -y]])


def convex_polygon(name: str, vertices: Any) -> Array:
    """Vertices of a convex polygon given in order round it, in either sense.

    Repeated vertices and vertices on an edge are dropped.

    Args:
        name: Contact name, for the error sentence.
        vertices: Points in the contact plane, shape (k, 2) [m].

    Returns:
        Counter-clockwise corners, shape (m, 2), 3 <= m <= k [m].

    Raises:
        InputError: Fewer than three corners, a crossing or reflex outline, zero area, or a number that is not finite.
    """

    def wrong(sentence: str) -> InputError:
        return InputError(f"contact '{name}': vertices {sentence}", name=name, field="vertices")

    try:
        P = np.array(vertices, dtype=float)
    except (TypeError, ValueError) as error:
        raise wrong(f"must be pairs of numbers, got {vertices!r}") from error
    if P.ndim != 2 or P.shape[1] != 2 or len(P) < 3:
        raise wrong(f"must be at least 3 points [x, y], got an array of shape {P.shape}")
    if not np.isfinite(P).all():
        raise wrong("must be finite")
    extent = float(np.ptp(P, axis=0).max())
    P = P[np.linalg.norm(P - np.roll(P, 1, axis=0), axis=1) > COLLINEAR * extent]
    while len(P) >= 3:
        into, out = P - np.roll(P, 1, axis=0), np.roll(P, -1, axis=0) - P
        turn = _cross(into, out) / (np.linalg.norm(into, axis=1) * np.linalg.norm(out, axis=1))
        straight = np.abs(turn) <= COLLINEAR
        if (straight & ((into * out).sum(axis=1) < 0)).any():
            raise wrong("must not run back over an edge")
        if not straight.any():
            break
        P = np.delete(P, int(np.flatnonzero(straight)[0]), axis=0)
    if len(P) < 3:
        raise wrong("must enclose an area, they lie on a line")
    into, out = P - np.roll(P, 1, axis=0), np.roll(P, -1, axis=0) - P
    angles = np.arctan2(_cross(into, out), (into * out).sum(axis=1))
    if not ((angles > 0).all() or (angles < 0).all()):
        raise wrong("must be convex and in order round the polygon, one corner is reflex")
    if abs(abs(angles.sum()) - 2 * np.pi) > 1e-6:
        raise wrong("must be in order round the polygon, the outline crosses itself")
    corners = P if angles[0] > 0 else P[::-1].copy()
    corners.setflags(write=False)
    return corners
