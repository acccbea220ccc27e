"""The catalogue: what the list says is what is loaded, and the contacts are where the models' own geometry has them."""

import sys

import numpy as np
import pinocchio as pin
import pytest
from scipy.spatial import ConvexHull

import socp_statics as ss
from socp_statics.cases import robot_posture
from socp_statics.cli import main
from socp_statics.exceptions import InputError
from socp_statics.postures import GENERATORS, posture_at
from socp_statics.postures.joint_roles import ROLES
from socp_statics.robots import ROBOTS
from socp_statics.robots.humanoids import talos
from socp_statics.robots.robot_data import urdf_path

NAMES = ROBOTS.names()
HUMANOIDS = tuple(ROLES)
QUADRUPEDS = ("anymal_c", "solo12", "hyq", "centauro")
FILES = {
    "talos": "talos_data/robots/talos_reduced.urdf",
    "g1": "g1_description/urdf/g1_29dof_rev_1_0.urdf",
    "icub": "icub_description/robots/icub.urdf",
    "romeo": "romeo_description/urdf/romeo.urdf",
    "anymal_c": "anymal_c_simple_description/urdf/anymal.urdf",
    "solo12": "solo_description/robots/solo12.urdf",
    "hyq": "hyq_description/robots/hyq_no_sensors.urdf",
    "centauro": "centauro_description/urdf/centauro.urdf",
}
NEAR_THE_GROUND = 2e-3


def test_the_catalogue():
    assert NAMES[:9] == ("hoap2", *FILES) and set(HUMANOIDS) | set(QUADRUPEDS) == set(NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_the_line_says_what_is_loaded(name):
    robot, line = ss.load_robot(name), ROBOTS.describe()[name]
    assert f"{len(robot.joints)} joints" in line and f"{robot.mass:.4g} kg" in line
    assert f"contacts {', '.join(robot.frames)};" in line
    assert robot.licence in line and robot.name == name
    real = "torque limits are those of the model" in line
    assert real or "torque limits are placeholders" in line
    assert real == (len(robot.placeholder_joints) < len(robot.joints))
    assert robot.torque_limits_real == (real and "placeholders" not in line)
    assert ("extra robots" in line) == (name != "hoap2")
    kinds = {frame.type for frame in robot.frames.values()}
    assert ("soles" in line) == ("surface" in kinds) and ("are points" in line) == ("point" in kinds)
    assert (robot.reference >= robot.lower).all() and (robot.reference <= robot.upper).all()


def test_masses_are_those_of_the_urdf():
    """The mass of every link added up, without Pinocchio."""
    from xml.etree import ElementTree

    for name, file in FILES.items():
        masses = [float(tag.get("value")) for tag in ElementTree.parse(urdf_path(name, file)).iter("mass")]
        assert ss.load_robot(name).mass == pytest.approx(sum(masses), abs=1e-9)


def geometry(name, link, frame):
    """Collision shapes of a link in axes of a contact frame: (placement, shape) pairs."""
    robot = ss.load_robot(name)
    path = urdf_path(name, FILES[name])
    folder = next(parent for parent in path.parents if parent.name == "example-robot-data").parent
    model = robot.pin_model
    shapes = pin.buildGeomFromUrdf(model, str(path), pin.GeometryType.COLLISION, package_dirs=[str(folder)])
    contact = robot.frames[frame]
    carrier = model.frames[robot.frame_id(contact.frame)]
    offset = carrier.placement * pin.SE3(np.array(contact.rotation), np.array(contact.position))
    found = [(offset.actInv(g.placement), g.geometry) for g in shapes.geometryObjects if model.frames[g.parentFrame].name == link]
    assert found
    return found


def corners(found):
    """Vertices of meshes in axes of the contact frame, shape (n, 3) [m]."""
    return np.vstack([np.array(shape.vertices()) @ M.rotation.T + M.translation for M, shape in found])


def inside(polygon, points, slack):
    """Whether points lie in a convex polygon or at most ``slack`` outside."""
    faces = ConvexHull(points).equations
    return bool((np.asarray(polygon) @ faces[:, :2].T + faces[:, 2] <= slack).all())


@pytest.mark.parametrize(("name", "link"), [("talos", "leg_left_6_link"), ("romeo", "l_ankle"), ("icub", "l_foot")])
def test_soles_are_what_lies_near_the_ground(name, link):
    points = corners(geometry(name, link, "left_foot"))
    if name == "icub":
        ankle = geometry(name, link, "left_foot")[0][0].translation[:2]
        turned = points[:, :2] - ankle
        points[:, :2] = ankle + np.column_stack([-turned[:, 1], turned[:, 0]])
    lowest = points[:, 2].min()
    assert abs(lowest) < 1e-3
    low = points[points[:, 2] < lowest + NEAR_THE_GROUND][:, :2]
    sole = ss.load_robot(name).frames["left_foot"].vertices
    assert inside(sole, low, 5e-3)
    for end in (np.min, np.max):
        assert end(np.asarray(sole), axis=0) == pytest.approx(end(low, axis=0), abs=6e-3)


@pytest.mark.parametrize("side", ["left", "right"])
def test_the_sole_of_g1_has_the_lowest_points_of_its_balls(side):
    balls = geometry("g1", f"{side}_ankle_roll_link", f"{side}_foot")
    lowest = sorted((*(M.translation[:2].round(9)), round(M.translation[2] - shape.radius, 9)) for M, shape in balls)
    sole = sorted((*corner, 0.0) for corner in ss.load_robot("g1").frames[f"{side}_foot"].vertices)
    assert np.array(lowest) == pytest.approx(np.array(sole), abs=1e-9)


@pytest.mark.parametrize(
    ("name", "link", "height", "radius"),
    [("anymal_c", "LF_FOOT", 0.0225, 0.03), ("hyq", "lf_foot", 0.0, 0.02175), ("solo12", "FL_FOOT", 0.0, 0.016)],
)
def test_point_feet_against_their_balls(name, link, height, radius):
    M, ball = geometry(name, link, "left_front_foot")[-1]
    if name == "solo12":
        points = corners([(M, ball)])
        assert np.abs(points[:, [0, 2]]).max() == pytest.approx(radius, abs=1e-5)
    else:
        assert ball.radius == pytest.approx(radius) and M.translation == pytest.approx([0, 0, height], abs=1e-9)


def test_the_wheels_of_centauro_touch_at_their_lowest_point():
    robot = ss.load_robot("centauro")
    (M, wheel), *_ = geometry("centauro", "wheel_1", "left_front_foot")
    assert wheel.radius == pytest.approx(0.124)
    for leg, number in (("left_front", 1), ("right_front", 2), ("left_hind", 3), ("right_hind", 4)):
        posture = posture_at(robot, robot.configuration(robot.reference), [f"{leg}_foot"])
        hub, contact = posture.link_placement(f"wheel_{number}")[1], posture.contacts[0]
        assert hub - contact.position == pytest.approx(0.124 * contact.normal_W, abs=1e-9)


def test_the_hands_of_talos_touch_with_the_fingertips():
    tips = corners(geometry("talos", "gripper_left_fingertip_1_link", "left_hand"))
    assert tips[:, 2].min() == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize("name", HUMANOIDS)
def test_hands_point_along_the_forearm_towards_the_elbow(name):
    robot = ss.load_robot(name)
    posture = posture_at(robot, robot.configuration(robot.reference), ["left_hand", "right_hand"])
    model = robot.pin_model
    for contact in posture.contacts:
        joint = model.frames[robot.frame_id(robot.frames[contact.name].frame)].parentJoint
        elbow = posture.link_placement(model.names[model.parents[model.parents[joint]]])[1]
        along = elbow - contact.position
        assert contact.normal_W @ along / np.linalg.norm(along) > 0.8


@pytest.mark.parametrize("name", NAMES)
def test_left_and_right_are_mirror_images(name):
    robot = ss.load_robot(name)
    posture = posture_at(robot, robot.configuration(robot.reference), list(robot.frames))
    ahead = posture.R_WB.T @ np.eye(3)
    for left in (contact for contact in posture.contacts if contact.name.startswith("left")):
        right = posture.contacts[left.name.replace("left", "right")]
        across = left.position - right.position
        assert abs(across @ ahead[0]) < 2e-3 and abs(across[2]) < 2e-3 and abs(across[1]) > 0.02
        normal = left.normal_W * np.array([1, -1, 1])
        assert np.abs(right.normal_W - normal).max() < 2e-3


@pytest.mark.parametrize("name", HUMANOIDS)
def test_roles_bend_the_knees_forward_and_keep_the_soles_level(name):
    robot = ss.load_robot(name)
    straight, bent = (GENERATORS.load("squat")(robot, knee=knee) for knee in (0.2, 0.8))
    assert bent.com_W[2] < straight.com_W[2] - 0.02 * straight.com_W[2]
    for side in ("left", "right"):
        joint, _ = ROLES[name].joints[f"{side}_knee_pitch"]
        assert bent.link_placement(joint)[1][0] > straight.link_placement(joint)[1][0] + 0.01
    down, forward = (GENERATORS.load("standing")(robot, arms=arms) for arms in ("down", "forward"))
    hands = [posture_at(robot, p.q, ["left_hand"]).contacts[0].position for p in (down, forward)]
    assert hands[1][0] > hands[0][0] + 0.1 and hands[1][2] > hands[0][2] + 0.1


def test_a_missing_extra_is_one_sentence_with_the_pip_command(monkeypatch, capsys):
    talos.cache_clear()
    robot_posture._loaded.cache_clear()
    monkeypatch.setitem(sys.modules, "example_robot_data", None)
    monkeypatch.setitem(sys.modules, "example_robot_data.robots_loader", None)
    with pytest.raises(InputError, match=r"robot 'talos' needs the extra robots: pip install 'socp-statics\[robots\]'"):
        ss.load_robot("talos")
    assert ss.load_robot("hoap2").name == "hoap2"
    assert main(["solve", "talos/double_stance"]) == 2
    last = capsys.readouterr().err.strip().splitlines()[-1]
    assert "talos/double_stance" in last and "posture.robot" in last and "pip install 'socp-statics[robots]'" in last
    assert main(["list", "robots"]) == 0
    assert "talos" in capsys.readouterr().out
