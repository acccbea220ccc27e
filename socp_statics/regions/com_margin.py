"""How far is the centre of mass from the edge of its region? Refined near it to a relative 1e-3."""

from __future__ import annotations

import numpy as np

from socp_statics.regions.polygon import distance
from socp_statics.regions.sandwich import Sandwich
from socp_statics.spatial import Array

RELATIVE = 1e-3
NEGLIGIBLE = 1e-10
MOST_REFINEMENTS = 60
# Of the size: what rounding may put a centre of mass outside by that is on the edge.
ON_EDGE = 1e-9


def on_edge_or(margin: float, size: float) -> float:
    """A CoM margin; zero where it is negative by rounding alone.

    Args:
        margin: Distance to the edge, negative outside.
        size: Largest distance between contact points, in the same unit.
    """
    return 0.0 if -ON_EDGE * size < margin <= 0.0 else margin


def _points(sandwich: Sandwich) -> Array:
    return np.array([s.c for s in sandwich.supports()])


def on_clip(a: Array, b: Array, clip: float | None) -> bool:
    """Whether an edge lies on the clipping square and so is no edge of the region."""
    return clip is not None and any(abs(abs(a[i]) - clip) < 1e-9 * clip and abs(a[i] - b[i]) < 1e-9 * clip for i in (0, 1))


def refined_margin(sandwich: Sandwich, com: Array, clip: float | None) -> float:
    """Distance of a position to the edge of the region, minus the distance outside.

    Args:
        sandwich: The region; it is refined on the way.
        com: Position in the coordinates of the sandwich, shape (2,).
        clip: Half-side of the clipping square, or None.

    Returns:
        Scaled distance; inf where the region has no edge.
    """
    inside = -np.inf
    for _ in range(MOST_REFINEMENTS):
        P = _points(sandwich)
        away = float(distance(P, com))
        # What is known so far, should the refinements run out.
        inside = away
        if away <= 0.0:
            outcome = _step_outside(sandwich, P, com, -away)
            if outcome is not None:
                return outcome
            continue
        Q = np.roll(P, -1, axis=0)
        E = Q - P
        length = np.linalg.norm(E, axis=1)
        real = [k for k in range(len(P)) if length[k] > NEGLIGIBLE and not on_clip(P[k], Q[k], clip)]
        if not real:
            return np.inf
        normals = np.column_stack([E[:, 1], -E[:, 0]])[real] / length[real, None]
        reserve = (normals * (P[real] - com)).sum(axis=1)
        k = int(np.argmin(reserve))
        inside = max(float(reserve[k]), 0.0)
        support = sandwich.query((float(normals[k, 0]), float(normals[k, 1])))
        thickness = support.h - float(normals[k] @ P[real[k]])
        if thickness <= RELATIVE * inside or thickness <= NEGLIGIBLE:
            break
    return inside


def _step_outside(sandwich: Sandwich, P: Array, com: Array, away: float) -> float | None:
    """One refinement towards a position that no attained point holds yet.

    Returns:
        Minus the distance once the best separating line is near the nearest attained point; None to go on.
    """
    if away <= NEGLIGIBLE:
        return 0.0
    best = max(float(np.dot(s.d, com)) - s.h for s in sandwich.supports())
    if away - best <= RELATIVE * away:
        return -away
    E = np.roll(P, -1, axis=0) - P
    along = np.clip(((com - P) * E).sum(axis=1) / np.maximum((E * E).sum(axis=1), 1e-300), 0.0, 1.0)
    nearest = P + along[:, None] * E
    gaps = np.linalg.norm(com - nearest, axis=1)
    u = (com - nearest[int(np.argmin(gaps))]) / gaps.min()
    sandwich.query((float(u[0]), float(u[1])))
    return None
