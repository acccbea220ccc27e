"""What lies on the floor: the support region, the base of support, and the projection of the centre of mass."""

from __future__ import annotations

import numpy as np

from socp_statics.colours import BLACK, GREY, REGION_COLOURS
from socp_statics.contacts import ContactSet
from socp_statics.regions import SupportRegion, base_of_support
from socp_statics.regions.polygon import halfplanes
from socp_statics.spatial import Array
from socp_statics.viewer.marks import Lines, Mark, Solid, closed, dashed
from socp_statics.viewer.solids import ball, fan, placed

LIFT, DASH, DOT_SHARE, CROSS_SHARE = 0.002, 0.02, 0.012, 0.02
REGION_OPACITY = 0.35
REACH = 1.5


def floor_height(contacts: ContactSet) -> float:
    """Height of the lowest contact point, where the floor is drawn [m]."""
    return float(contacts.points_W[:, 2].min())


def region_marks(region: SupportRegion | None, contacts: ContactSet, extent: float) -> list[Mark]:
    """The support region on the floor: the inner polygon filled, the edge of the outer one as a line.

    Args:
        region: The region; None where there is none to draw, as without vertical gravity.
        contacts: The contacts.
        extent: How large the scene is [m]; a region without an end is shown as far as 1.5 times that from the contacts.
    """
    if region is None or not len(region.inner):
        return []
    height, colour = floor_height(contacts) + 2.0 * LIFT * extent, REGION_COLOURS[region.cone.kind]
    if region.kind == "point":
        return [Solid("region/point", *placed(ball(DOT_SHARE * extent), np.eye(3), np.array([*region.inner[0], height])), colour)]
    if region.kind == "segment":
        return [Lines("region/segment", _at(np.array([region.inner[0], region.inner[-1]]), height)[None], colour, pixels=4.0)]
    inner, outer = (
        _within(corners, contacts.centre[:2], REACH * extent) if region.kind == "unbounded" else corners
        for corners in (region.inner, region.outer)
    )
    return [
        Solid("region/inner", *fan(_at(inner, height)), colour, opacity=REGION_OPACITY),
        Lines("region/outer", closed(_at(outer, height)), colour, pixels=3.0),
    ]


def base_marks(contacts: ContactSet, extent: float) -> list[Mark]:
    """The base of support as a dashed line on the floor.

    Args:
        contacts: The contacts.
        extent: How large the scene is [m].
    """
    base = base_of_support(contacts)
    if base.kind == "point":
        return []
    corners = _at(base.vertices, floor_height(contacts) + LIFT * extent)
    pieces = closed(corners) if base.kind == "polygon" else corners[None]
    return [Lines("base/outline", dashed(pieces, DASH * extent), GREY, pixels=2.5)]


def com_marks(com: Array, contacts: ContactSet, extent: float) -> list[Lines]:
    """The plumb line of the centre of mass, and a cross where it meets the floor.

    Args:
        com: Centre of mass, shape (3,) [m].
        contacts: The contacts.
        extent: How large the scene is [m].
    """
    foot = np.array([com[0], com[1], floor_height(contacts) + 3.0 * LIFT * extent])
    arm = CROSS_SHARE * extent
    cross = np.array([[foot - arm * way, foot + arm * way] for way in np.eye(3)[:2]])
    return [
        Lines("com/plumb", dashed(np.array([[com, foot]]), DASH * extent), BLACK, pixels=1.5),
        Lines("com/projection", cross, BLACK, pixels=3.0),
    ]


def _at(corners: Array, height: float) -> Array:
    return np.column_stack([corners, np.full(len(corners), height)])


def _within(corners: Array, centre: Array, half: float) -> Array:
    """The part of a convex polygon inside a square, counter-clockwise, shape (k, 2)."""
    from scipy.spatial import ConvexHull, HalfspaceIntersection

    A, b = halfplanes(corners)
    sides = np.vstack([np.eye(2), -np.eye(2)])
    rows = np.column_stack([np.vstack([A, sides]), -np.concatenate([b, sides @ centre + half])])
    inner = _deepest(rows)
    if inner is None:
        return np.zeros((0, 2))
    points = HalfspaceIntersection(rows, inner).intersections
    return points[ConvexHull(points).vertices]


def _deepest(rows: Array) -> Array | None:
    """The centre of the largest circle inside half-planes ``A x + c <= 0``, None where there is no room for one, shape (2,)."""
    from scipy.optimize import linprog

    A = np.column_stack([rows[:, :2], np.linalg.norm(rows[:, :2], axis=1)])
    found = linprog([0.0, 0.0, -1.0], A_ub=A, b_ub=-rows[:, 2], bounds=[(None, None), (None, None), (0.0, None)])
    return found.x[:2] if found.success and found.x[2] > 0.0 else None
