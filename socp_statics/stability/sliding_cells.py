"""How points in one plane can slide together: cones of planar motions, and the friction that each of them allows at each point.

The tangential acceleration of points in one plane depends on three numbers only, the acceleration along the plane and the turning about
its normal, however the body tilts. The space of these numbers (two for a single point) is divided into simplicial cones, the cells.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations, product

import numpy as np

from socp_statics.spatial import Array
from socp_statics.stability.one_body import OneBody

SAME_PLANE = 1e-9
PIVOT = 1e-9


@dataclass(frozen=True, eq=False)
class SlidingGroup:
    """Points with friction in one plane.

    Attributes:
        points: Their indices.
        rows: Motion coordinates due to an acceleration of the body, shape (k, 6), k = 3, or 2 for a single point.
        maps: Tangential acceleration of each point along its own t1, t2 due to the coordinates, shape (points, 2, k).
    """

    points: list[int]
    rows: Array
    maps: Array


def sliding_groups(body: OneBody) -> list[SlidingGroup]:
    """The points with friction of a body, by plane."""
    data = body.data
    R = data.rotation[data.contact_of_point]
    planes: list[list[int]] = []
    for i in range(data.slipping):
        for plane in planes:
            n = R[plane[0], :, 2]
            if np.abs(R[i, :, 2] - n).max() < SAME_PLANE and abs(float(n @ (data.point[i] - data.point[plane[0]]))) < SAME_PLANE:
                plane.append(i)
                break
        else:
            planes.append([i])
    return [_group(body, plane, R) for plane in planes]


def _group(body: OneBody, points: list[int], R: Array) -> SlidingGroup:
    axes, where = R[points[0]], body.data.point[points]
    centre = where.mean(axis=0)
    reach = float(np.linalg.norm(where - centre, axis=1).max())
    along = body.point_rows[points[0], :2]
    if reach == 0.0:
        maps = np.array([R[i, :, :2].T @ axes[:, :2] for i in points])
        return SlidingGroup(points, along, maps)
    turning = np.concatenate([np.zeros(3), reach * axes[:, 2]])
    arm = (centre - where[0]) @ axes[:, :2]
    shifted = along + np.outer(np.array([-arm[1], arm[0]]) / reach, turning)
    arms = (where - centre) @ axes[:, :2] / reach
    planar = np.array([[[1.0, 0.0, -y], [0.0, 1.0, x]] for x, y in arms])
    turned = np.array([R[i, :, :2].T @ axes[:, :2] for i in points])
    return SlidingGroup(points, np.vstack([shifted, turning]), turned @ planar)


def first_cells(group: SlidingGroup) -> list[Array]:
    """The orthants, each as its rays, shape (k, k)."""
    k = len(group.rows)
    return [np.diag(signs).astype(float) for signs in product((1.0, -1.0), repeat=k)]


def divided_cell(cell: Array) -> list[Array]:
    """The two halves of a cell, its widest edge cut in the middle."""
    i, j = max(combinations(range(len(cell)), 2), key=lambda pair: -float(cell[pair[0]] @ cell[pair[1]]))
    middle = cell[i] + cell[j]
    halves = []
    for k in (i, j):
        half = cell.copy()
        half[k] = middle / np.linalg.norm(middle)
        halves.append(half)
    return halves


def friction_rays(mu: float, images: Array, disc: Array) -> Array:
    """Unit-normal forces that contain all friction against sliding in the cone of some directions.

    Args:
        mu: Coulomb coefficient.
        images: Accelerations that span the cone, shape (k, 2).
        disc: Tips of a polygon round the unit disc, shape (s, 2), for cones that allow any direction.

    Returns:
        Rays, shape (r, 3): the ends of the arc and what the tangents there cut off; all of the disc where the point may be at rest.
    """
    length = np.linalg.norm(images, axis=1)
    turn = np.arctan2(images[:, 1], images[:, 0])
    order = np.sort(turn)
    gaps = np.diff(np.append(order, order[0] + 2 * np.pi))
    widest = int(np.argmax(gaps))
    width = 2 * np.pi - float(gaps[widest])
    if length.min() < PIVOT or width > np.pi - 1e-6:
        return np.column_stack([mu * disc, np.ones(len(disc))])
    start = float(order[(widest + 1) % len(order)])
    parts = max(int(np.ceil(width / (np.pi / 4))), 1)
    ends = np.array([start, start + width])
    middles = start + (np.arange(parts) + 0.5) * width / parts
    away = np.concatenate([np.exp(1j * ends), np.exp(1j * middles) / np.cos(width / parts / 2)])
    return np.column_stack([-mu * away.real, -mu * away.imag, np.ones(len(away))])


def polygon_tips(touching: Array) -> Array:
    """Tips of the polygon round the unit disc that touches it in some directions, shape (s, 2)."""
    turn = np.sort(touching % (2 * np.pi))
    half = np.diff(np.append(turn, turn[0] + 2 * np.pi)) / 2
    return np.column_stack([np.cos(turn + half), np.sin(turn + half)]) / np.cos(half)[:, None]
