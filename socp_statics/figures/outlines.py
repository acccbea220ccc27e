"""Outlines of boxes, cylinders and spheres, seen along a world axis, and which of them hides which."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.spatial import ConvexHull, QhullError

from socp_statics.robots import Shape
from socp_statics.spatial import Array

ROUND = 72
GRID = 240
FLAT = 1e-9


class View(NamedTuple):
    """A direction to look in, along a world axis.

    Attributes:
        axes: The world axes of the drawing plane, to the right and up.
        toward: Unit vector to the reader, world axes.
        words: Where the reader stands.
    """

    axes: tuple[int, int]
    toward: tuple[float, float, float]
    words: str


VIEWS = {
    "side": View((0, 2), (0.0, -1.0, 0.0), "from its right"),
    "front": View((1, 2), (1.0, 0.0, 0.0), "from the front"),
}


class Body(NamedTuple):
    """A shape where the posture puts it.

    Attributes:
        shape: The shape.
        R_WS: Its axes in world axes, shape (3, 3).
        p_WS: Its centre, world axes, shape (3,) [m].
    """

    shape: Shape
    R_WS: Array
    p_WS: Array


def outline(body: Body, view: View) -> Array:
    """The outline of a body on the drawing plane.

    Args:
        body: The body.
        view: The view.

    Returns:
        Counter-clockwise corners of the hull of its projection, shape (k, 2) [m]; round parts have 72 corners on the true curve, the
        points where straight edges touch it among them.
    """
    size = body.shape.size
    if body.shape.kind == "box":
        corners = 0.5 * np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * size
        return hull((body.p_WS + corners @ body.R_WS.T)[:, view.axes])
    if body.shape.kind == "cylinder":
        radius, length = size
        axis = body.R_WS[:, 2]
        return hull(np.vstack([disc(body.p_WS + 0.5 * s * length * axis, axis, radius, view) for s in (-1.0, 1.0)]))
    return hull(disc(body.p_WS, np.array(view.toward), size[0], view))


def disc(centre: Array, normal: Array, radius: float, view: View) -> Array:
    """Points round a disc on the drawing plane.

    Args:
        centre: World axes, shape (3,) [m].
        normal: Unit vector, shape (3,).
        radius: Of the disc [m].
        view: The view.

    Returns:
        Shape (72, 2) [m]; the two ends of its longest chord, where a cylinder's straight edges begin, are among them.
    """
    first = np.cross(normal, view.toward)
    if np.linalg.norm(first) < FLAT:
        first = np.eye(3)[view.axes[0]]
    first = first / np.linalg.norm(first)
    angle = 2.0 * np.pi * np.arange(ROUND) / ROUND
    ring: Array = centre + radius * (np.cos(angle)[:, None] * first + np.sin(angle)[:, None] * np.cross(normal, first))
    return ring[:, view.axes]


def hull(points: Array) -> Array:
    """Counter-clockwise corners of the convex hull, shape (n, 2) -> (k, 2); the two ends where all lie on a line."""
    try:
        return points[ConvexHull(points).vertices]
    except QhullError:
        along = points @ np.linalg.svd(points - points.mean(axis=0))[2][0]
        return points[[int(np.argmin(along)), int(np.argmax(along))]]


def nearest_depth(body: Body, xy: Array, view: View) -> Array:
    """How near to the reader the surface of a body is, above points of the drawing plane.

    Args:
        body: The body.
        xy: Points, shape (n, 2) [m].
        view: The view.

    Returns:
        Shape (n,) [m], larger is nearer; -inf beside the outline.
    """
    start_W = np.zeros((len(xy), 3))
    start_W[:, view.axes] = xy
    start = (start_W - body.p_WS) @ body.R_WS
    way = np.array(view.toward) @ body.R_WS
    size = body.shape.size
    if body.shape.kind == "box":
        spans = [_span(start[:, [k]], way[[k]], 0.5 * size[k]) for k in range(3)]
    elif body.shape.kind == "cylinder":
        spans = [_span(start[:, :2], way[:2], size[0]), _span(start[:, 2:], way[2:], 0.5 * size[1])]
    else:
        spans = [_span(start, way, size[0])]
    first, last = np.max([s[0] for s in spans], axis=0), np.min([s[1] for s in spans], axis=0)
    depth: Array = np.where(first <= last, last, -np.inf)
    return depth


def _span(start: Array, way: Array, radius: float) -> tuple[Array, Array]:
    """Where lines ``start + s way``, shape (n, m) and (m,), are inside the ball ``|x| <= radius``: first and last s, shape (n,)."""
    a, b, c = float(way @ way), start @ way, (start * start).sum(axis=1) - radius**2
    if a < FLAT**2:
        inside = c <= 0.0
        return np.where(inside, -np.inf, np.inf), np.where(inside, np.inf, -np.inf)
    root = np.sqrt(np.maximum(b * b - a * c, 0.0))
    hit = b * b >= a * c
    return np.where(hit, (-b - root) / a, np.inf), np.where(hit, (-b + root) / a, -np.inf)


def back_to_front(bodies: list[Body], outlines: list[Array], view: View) -> list[int]:
    """In which order to paint outlines so that what is nearer covers what is behind it.

    Outlines are painted whole. Where bodies run into each other or cover each other in a ring no order is right; then the one that
    covers the least of the others is painted first.

    Args:
        bodies: The bodies.
        outlines: Their outlines.
        view: The view.

    Returns:
        Indices of the bodies, the farthest first.
    """
    low, high = np.vstack(outlines).min(axis=0), np.vstack(outlines).max(axis=0)
    step = float((high - low).max()) / GRID
    x, y = (np.arange(low[k] + 0.5 * step, high[k], step) for k in (0, 1))
    points = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    depth = np.full((len(bodies), len(points)), -np.inf)
    for mine, body, corners in zip(depth, bodies, outlines, strict=True):
        seen = ((points >= corners.min(axis=0)) & (points <= corners.max(axis=0))).all(axis=1)
        mine[seen] = nearest_depth(body, points[seen], view)
    covers = np.zeros((len(bodies), len(bodies)))
    for i, mine in enumerate(depth):
        seen = np.isfinite(mine)
        # a body beside the outline is infinitely far behind, which hides nothing
        others = depth[:, seen]
        nearer = (mine[seen] > others + 1e-6 * step) & np.isfinite(others)
        covers[i] = nearer.sum(axis=1)
    wrong = np.maximum(covers - covers.T, 0.0)
    centres = [float(body.p_WS @ view.toward) for body in bodies]
    left, order = list(range(len(bodies))), []
    while left:
        best = min(left, key=lambda i: (wrong[i, left].sum(), centres[i], i))
        order.append(best)
        left.remove(best)
    return order
