"""Surfaces of simple bodies, as vertices and faces."""

from __future__ import annotations

from typing import Any

import numpy as np

from socp_statics.spatial import Array

ROUND = 24
Surface = tuple[Array, Array]


def box(size: Array) -> Surface:
    """A box about its centre, full lengths along its axes, shape (3,) [m]."""
    import trimesh

    return _surface(trimesh.creation.box(extents=size))


def ball(radius: float) -> Surface:
    """A ball about its centre [m]."""
    import trimesh

    return _surface(trimesh.creation.icosphere(subdivisions=2, radius=radius))


def cylinder(radius: float, length: float) -> Surface:
    """A cylinder about its centre, its axis along z [m]."""
    import trimesh

    return _surface(trimesh.creation.cylinder(radius=radius, height=length, sections=ROUND))


def rod(start: Array, end: Array, radius: float) -> Surface:
    """A cylinder between two points that are not the same, shape (3,) each [m]."""
    import trimesh

    return _surface(trimesh.creation.cylinder(radius=radius, segment=[start, end], sections=ROUND))


def fan(corners: Array) -> Surface:
    """A flat convex polygon, corners in order round it, shape (k, 3) [m]."""
    k = np.arange(1, len(corners) - 1)
    return np.asarray(corners, dtype=float), np.column_stack([np.zeros_like(k), k, k + 1])


def cone(apex: Array, rim: Array) -> Surface:
    """An open cone from its apex to the corners of its rim, shapes (3,) and (k, 3) [m]."""
    k = np.arange(len(rim))
    return np.vstack([apex, rim]), np.column_stack([np.zeros_like(k), 1 + np.roll(k, -1), 1 + k])


def placed(surface: Surface, rotation: Array, position: Array) -> Surface:
    """A surface in the axes that its own are turned and moved in."""
    vertices, faces = surface
    return vertices @ rotation.T + position, faces


def _surface(mesh: Any) -> Surface:
    return np.array(mesh.vertices, dtype=float), np.array(mesh.faces, dtype=int)
