"""Meshes of robots in the 3-D view: which are found, where they are drawn, what takes their place where there are none."""

import numpy as np
import pytest
import trimesh

from socp_statics.postures import pose
from socp_statics.robots import load_robot
from socp_statics.robots.meshes import mesh_visuals
from socp_statics.robots.urdf_text import read_urdf
from socp_statics.viewer.body import body_marks
from socp_statics.viewer.marks import Frame, Solid, path
from socp_statics.viewer.meshes import robot_meshes

SIZE = np.array([0.1, 0.2, 0.3])
URDF = """\
<robot name="stick">
  <link name="trunk">
    <inertial><mass value="2.0"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><origin xyz="0.01 0 0" rpy="0 0 1.5707963267948966"/><geometry><mesh filename="{trunk}"{scale}/></geometry></visual>
  </link>
  <link name="shank">
    <inertial><mass value="0.5"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><mesh filename="meshes/nowhere.stl"/></geometry></visual>
  </link>
  <joint name="knee" type="revolute"><parent link="trunk"/><child link="shank"/><origin xyz="0.05 0 -0.3"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="7" velocity="1"/></joint>
</robot>
"""
SOLE = {"sole": {"frame": "shank", "type": "surface", "size": [0.3, 0.1], "position": [0, 0, -0.3]}}
# one triangle with corners at 0, x and y; which axis is up is filled in
COLLADA = """\
<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><up_axis>{up}</up_axis></asset>
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="a" count="9">0 0 0 1 0 0 0 1 0</float_array><technique_common>
<accessor source="#a" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
</accessor></technique_common></source><vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles count="1">
<input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles></mesh></geometry></library_geometries><library_visual_scenes>
<visual_scene id="s"><node><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes><scene>
<instance_visual_scene url="#s"/></scene></COLLADA>
"""


def stick(folder, trunk, scale=""):
    """A robot whose URDF lies in ``folder/my_robot/urdf`` and names a mesh."""
    (folder / "my_robot" / "urdf").mkdir(parents=True, exist_ok=True)
    (folder / "my_robot" / "meshes").mkdir(exist_ok=True)
    file = folder / "my_robot" / "urdf" / "stick.urdf"
    file.write_text(URDF.format(trunk=trunk, scale=scale))
    trimesh.creation.box(extents=SIZE).export(folder / "my_robot" / "meshes" / "box.stl")
    return load_robot(str(file)).with_frames(SOLE)


@pytest.mark.parametrize("name", ["package://my_robot/meshes/box.stl", "../meshes/box.stl", "file://../meshes/box.stl"])
def test_meshes_are_found_and_drawn_in_the_axes_of_their_link(name, tmp_path):
    robot = stick(tmp_path, name, ' scale="1 1 2"')
    ((link, (vertices, faces)),) = robot_meshes(robot)
    assert link == "trunk" and faces.shape == (12, 3)
    assert np.allclose(np.ptp(vertices, axis=0), [0.2, 0.1, 0.6], atol=1e-6)  # turned by a quarter about z, and stretched
    assert np.allclose(0.5 * (vertices.min(axis=0) + vertices.max(axis=0)), [0.01, 0, 0], atol=1e-6)
    volume = np.einsum("ij,ij->", vertices[faces[:, 0]], np.cross(vertices[faces[:, 1]], vertices[faces[:, 2]])) / 6.0
    assert volume == pytest.approx(2.0 * np.prod(SIZE), rel=1e-5)
    posture = pose(robot, {"knee": 0.3}, support=["sole"])
    marks = {mark.name: mark for mark in body_marks(posture.stance(), 1.0)}
    solid, frame = marks[path("body", "root_joint", "trunk_mesh_0")], marks["body/root_joint"]
    R_WF, p_WF = posture.link_placement("trunk")
    assert np.allclose(solid.vertices @ frame.rotation.T + frame.position, vertices @ R_WF.T + p_WF)
    assert isinstance(frame, Frame) and isinstance(solid, Solid)


def test_a_mirrored_mesh_keeps_its_faces_outside(tmp_path):
    ((_, (vertices, faces)),) = robot_meshes(stick(tmp_path, "../meshes/box.stl", ' scale="1 -1 1"'))
    assert np.einsum("ij,ij->", vertices[faces[:, 0]], np.cross(vertices[faces[:, 1]], vertices[faces[:, 2]])) > 0


@pytest.mark.parametrize(("up", "corner"), [("Z_UP", [0, 1, 0]), ("Y_UP", [0, 0, 1])])
def test_a_collada_file_says_which_axis_is_up(up, corner, tmp_path):
    robot = stick(tmp_path, "../meshes/triangle.dae")
    (tmp_path / "my_robot" / "meshes" / "triangle.dae").write_text(COLLADA.format(up=up))
    ((_, (vertices, _)),) = robot_meshes(robot)
    turned = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1.0]])
    assert np.abs(vertices - (turned @ corner + [0.01, 0, 0])).sum(axis=1).min() < 1e-6


def test_where_meshes_are_broken_or_gone_the_robot_is_a_skeleton(tmp_path):
    robot = stick(tmp_path, "../meshes/broken.stl")
    (tmp_path / "my_robot" / "meshes" / "broken.stl").write_text("solid nothing")
    assert len(mesh_visuals(read_urdf(robot.urdf_file))) == 1 and robot_meshes(robot) == []
    names = [mark.name for mark in body_marks(pose(robot, {}, support=["sole"]).stance(), 1.0)]
    assert "body/root_joint/bone_knee" in names and "body/knee/bone_to_sole" in names
    robot.urdf_file.write_text("no robot any more")
    assert robot_meshes(robot) == []
    robot.urdf_file.unlink()
    assert robot_meshes(robot) == []


def test_names_with_slashes_do_not_break_a_path():
    assert path("body", "a/b", "c") == "body/a|b/c"
