"""How far is the centre of mass from the edge of its region, in compiled code: the refinement of `regions.com_margin`."""

from __future__ import annotations

import math

from socp_statics.engines.kernel.compilation import inner
from socp_statics.engines.kernel.supports import BOUND, CX, CY, DX, DY

RELATIVE = 1e-3
NEGLIGIBLE = 1e-10
# Edges shorter than this, scaled, have directions made of rounding.
SHORT = 1e-7
MOST_REFINEMENTS = 60
OUTSIDE = -1


@inner
def nearest_edge(nodes, order, ring, keep, corners, x, y):
    """Where to look next for the distance of a position.

    Args:
        nodes: The supports.
        order: Their ring.
        ring: How many they are.
        keep: Those whose attained points are corners.
        corners: How many they are.
        x: First coordinate of the position, scaled.
        y: Second coordinate.

    Returns:
        Whether the distance is known already; the distance to the attained polygon, negative outside; the support whose edge is
        nearest (OUTSIDE for a position outside); and the direction that would tell more.
    """
    ruled_out = -math.inf
    for a in range(ring):
        i = order[a]
        ruled_out = max(ruled_out, nodes[i, DX] * x + nodes[i, DY] * y - nodes[i, BOUND])
    least, edge, away, near_x, near_y, dx, dy = math.inf, OUTSIDE, math.inf, 0.0, 0.0, 1.0, 0.0
    for a in range(corners):
        i, j = keep[a], keep[(a + 1) % corners]
        ex, ey = nodes[j, CX] - nodes[i, CX], nodes[j, CY] - nodes[i, CY]
        px, py = x - nodes[i, CX], y - nodes[i, CY]
        square = ex * ex + ey * ey
        share = (px * ex + py * ey) / square if square > 0.0 else 0.0
        share = min(max(share, 0.0), 1.0)
        gap = math.hypot(px - share * ex, py - share * ey)
        if gap < away:
            away, near_x, near_y = gap, nodes[i, CX] + share * ex, nodes[i, CY] + share * ey
        length = math.sqrt(square)
        if length > SHORT and corners > 2:
            reserve = (ex * py - ey * px) / length
            if reserve < least:
                least, edge, dx, dy = reserve, i, ey / length, -ex / length
    if edge != OUTSIDE and least > 0.0:
        return False, least, edge, dx, dy
    if away <= NEGLIGIBLE:
        return True, 0.0, OUTSIDE, dx, dy
    return away - ruled_out <= RELATIVE * away, -away, OUTSIDE, (x - near_x) / away, (y - near_y) / away


@inner
def thin_enough(nodes, edge, new, inside):
    """Whether a support found beyond an edge lies so little beyond it that the distance to the edge stands."""
    dx, dy = nodes[new, DX], nodes[new, DY]
    thickness = nodes[new, BOUND] - (dx * nodes[edge, CX] + dy * nodes[edge, CY])
    return thickness <= RELATIVE * inside or thickness <= NEGLIGIBLE
