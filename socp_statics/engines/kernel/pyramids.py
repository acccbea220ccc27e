"""Pyramids as rows of the compiled programs, and the forces behind their multipliers."""

from __future__ import annotations

import numpy as np

from socp_statics.cones.choice import ConeChoice
from socp_statics.spatial import Array


def _edges(points: Array, cone: ConeChoice) -> Array:
    """Tangential components of the pyramids' edges, each with a normal force of one, shape (n with friction, sides, 2)."""
    assert cone.sides is not None
    mu = points[points[:, 12] > 0.0, 12]
    radius = mu * cone.slope_factor() / np.cos(np.pi / cone.sides)
    return radius[:, None, None] * cone.edge_directions()[None]


def cone_rows(points: Array, cone: ConeChoice) -> Array:
    """The rows that the compiled programs work on: the points themselves, or the edges of their pyramids.

    Args:
        points: Contact points, those with friction first, shape (n, 14).
        cone: Exact cones or pyramids.

    Returns:
        Shape (n, 14); with pyramids ``sides`` rows for each point with friction: their "normal" is the force of the edge, their
        share of the reserve 1 / sides, because the edges of a pyramid add up to its normal.
    """
    if cone.is_exact:
        return points
    edges = _edges(points, cone)
    slipping, sides = edges.shape[:2]
    rows = np.repeat(points[:slipping], sides, axis=0)
    flat = edges.reshape(-1, 2)
    rows[:, 9:12] += flat[:, :1] * rows[:, 3:6] + flat[:, 1:] * rows[:, 6:9]
    rows[:, 12], rows[:, 13] = 0.0, 1.0 / sides
    return np.vstack([rows, points[slipping:]])


def unknowns(points: Array, cone: ConeChoice, multipliers: Array) -> Array:
    """The unknown x of `statics.StaticsData` from the multipliers of the rows.

    Args:
        points: Contact points, shape (n, 14).
        cone: Exact cones or pyramids.
        multipliers: Three a row, shape (k, 3 * rows).

    Returns:
        Tangential forces point by point, then normal forces, scaled, shape (k, nx).
    """
    each = multipliers.reshape(len(multipliers), -1, 3)
    slipping = int((points[:, 12] > 0.0).sum())
    if cone.is_exact:
        tangential = points[:slipping, 12, None] * each[:, :slipping, 1:]
        return np.hstack([tangential.reshape(len(each), -1), each[:, :, 0]])
    edges = _edges(points, cone)
    sides = edges.shape[1]
    shares = each[:, : slipping * sides, 0].reshape(len(each), slipping, sides)
    tangential = np.einsum("kns,nsi->kni", shares, edges)
    normal = np.hstack([shares.sum(axis=2), each[:, slipping * sides :, 0]])
    return np.hstack([tangential.reshape(len(each), -1), normal])
