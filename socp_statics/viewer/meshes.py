"""The meshes of a robot as vertices and faces."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from socp_statics.exceptions import InputError
from socp_statics.robots import Robot
from socp_statics.robots.meshes import Mesh, mesh_visuals
from socp_statics.robots.urdf_text import read_urdf
from socp_statics.spatial import Array
from socp_statics.viewer.solids import Surface, placed

Y_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])


def robot_meshes(robot: Robot) -> list[tuple[str, Surface]]:
    """The meshes of a robot that are at hand and can be read.

    Args:
        robot: The robot.

    Returns:
        Links, and surfaces in their axes; none for a robot whose URDF has no meshes or is not there any more.
    """
    if robot.urdf_file is None or not robot.urdf_file.is_file():
        return []
    try:
        meshes = mesh_visuals(read_urdf(robot.urdf_file))
    except InputError:
        # the robot was loaded; that its file has changed since is no reason not to show its skeleton
        return []
    read = ((mesh, _read(mesh)) for mesh in meshes)
    return [(mesh.link, placed(surface, mesh.rotation, mesh.position)) for mesh, surface in read if surface is not None]


def _read(mesh: Mesh) -> Surface | None:
    """The surface of a mesh file in metres, None where it is broken or of a kind that is not known."""
    import coal

    try:
        model = coal.MeshLoader().load(str(mesh.file), np.ones(3))
    except (ValueError, RuntimeError):
        return None
    faces = [(face[0], face[1], face[2]) for face in (model.tri_indices(k) for k in range(model.num_tris))]
    if not faces:
        return None
    corners = np.array(faces, dtype=int)
    mirrored = bool(np.prod(mesh.scale) < 0.0)
    return np.array(model.vertices(), dtype=float) @ _upright(mesh.file).T * mesh.scale, corners[:, ::-1] if mirrored else corners


def _upright(file: Path) -> Array:
    """The rotation to axes with z up: a COLLADA file says which of its own is; coal does not read that."""
    return Y_UP if file.suffix.lower() == ".dae" and b"<up_axis>Y_UP" in file.read_bytes() else np.eye(3)
