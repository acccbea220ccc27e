"""Convex polygons of the plane: area, width, distance, membership."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.spatial import Array

# Share of the size below which a region or base has no width.
NARROW = 1e-9


def area(polygon: Array) -> float:
    """Signed area of a polygon, positive when counter-clockwise, shape (k, 2) -> m^2."""
    if len(polygon) < 3:
        return 0.0
    P = polygon - polygon.mean(axis=0)
    Q = np.roll(P, -1, axis=0)
    return 0.5 * float((P[:, 0] * Q[:, 1] - P[:, 1] * Q[:, 0]).sum())


def corners(points: Array, tolerance: float) -> list[int]:
    """Indices of the corners of points given counter-clockwise round a convex polygon.

    Points nearer than the tolerance to the chord of their neighbours are dropped, one at a time.

    Args:
        points: Shape (n, 2).
        tolerance: Distance [unit of the points].

    Returns:
        Indices in order; at least one.
    """
    keep = list(range(len(points)))
    changed = True
    while changed and len(keep) > 1:
        changed = False
        i = 0
        while i < len(keep) and len(keep) > 1:
            a, b, c = (points[keep[(i + k) % len(keep)]] for k in (-1, 0, 1))
            chord = c - a
            length = float(np.hypot(*chord))
            if length <= tolerance:
                redundant = float(np.hypot(*(b - a))) <= tolerance
            else:
                along = float((b - a) @ chord) / length
                off = (chord[0] * (b - a)[1] - chord[1] * (b - a)[0]) / length
                redundant = off >= -tolerance and -tolerance <= along <= length + tolerance
            if redundant:
                del keep[i]
                changed = True
            else:
                i += 1
    return keep


def width(polygon: Array) -> float:
    """Least distance between two parallel lines that hold a convex polygon, 0 for fewer than three corners."""
    if len(polygon) < 3:
        return 0.0
    edges = np.roll(polygon, -1, axis=0) - polygon
    length = np.linalg.norm(edges, axis=1)
    edges = edges[length > 0] / length[length > 0, None]
    if not len(edges):
        return 0.0
    heights = np.column_stack([edges[:, 1], -edges[:, 0]]) @ polygon.T
    return float(np.ptp(heights, axis=1).min())


def halfplanes(polygon: Array) -> tuple[Array, Array]:
    """Half-planes of a counter-clockwise polygon: ``A x <= b`` with unit rows, shapes (k, 2) and (k,)."""
    edges = np.roll(polygon, -1, axis=0) - polygon
    length = np.linalg.norm(edges, axis=1)
    edges, start = edges[length > 0] / length[length > 0, None], polygon[length > 0]
    A = np.column_stack([edges[:, 1], -edges[:, 0]])
    return A, (A * start).sum(axis=1)


def distance(vertices: Array, xy: ArrayLike) -> Array:
    """Signed distance to a convex polygon, segment or point: positive inside, minus the distance outside.

    Args:
        vertices: Counter-clockwise corners, shape (k, 2), k >= 1 [m].
        xy: Points, shape (..., 2) [m].

    Returns:
        Shape (...) [m]; 0 on a segment or point that holds the point.
    """
    points = np.asarray(xy, dtype=float)
    a = vertices
    e = np.roll(a, -1, axis=0) - a
    r = points[..., None, :] - a
    along = np.clip((r * e).sum(-1) / np.maximum((e * e).sum(-1), 1e-300), 0.0, 1.0)
    away = np.linalg.norm(r - along[..., None] * e, axis=-1).min(axis=-1)
    length = np.linalg.norm(e, axis=1)
    # Edges between repeated points have directions made of rounding.
    real = length > 1e-9 * length.max(initial=0.0)
    if real.sum() < 3:
        return -away
    inside = ((e[:, 0] * r[..., 1] - e[:, 1] * r[..., 0])[..., real] >= 0.0).all(axis=-1)
    return np.where(inside, away, -away)
