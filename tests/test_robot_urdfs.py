"""Robots from URDFs: what is read, what is refused and how, where their contacts are."""

import math

import numpy as np
import pinocchio as pin
import pytest

from socp_statics.exceptions import InputError
from socp_statics.robots import ContactFrame, load_robot


def kinematics(robot, angles):
    """Configuration and data of the model after forward kinematics, the base at the origin."""
    data = robot.pin_model.createData()
    q = robot.configuration(robot.angles(angles))
    pin.framesForwardKinematics(robot.pin_model, data, q)
    pin.centerOfMass(robot.pin_model, data, q)
    return q, data


def link(name, mass=1.0, rest=""):
    inertia = '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
    return f'<link name="{name}"><inertial><origin xyz="0.1 0 0.2"/><mass value="{mass}"/>{inertia}</inertial>{rest}</link>'


LIMIT = '<limit lower="-1" upper="1" effort="5" velocity="1"/>'


def joint(name, parent, child, kind="revolute", rest=LIMIT, axis="0 1 0"):
    ends = f'<parent link="{parent}"/><child link="{child}"/><origin xyz="0 0 0.3"/>'
    return f'<joint name="{name}" type="{kind}">{ends}<axis xyz="{axis}"/>{rest}</joint>'


def urdf(*parts):
    return f'<?xml version="1.0"?><robot name="small">{"".join(parts)}</robot>'


GOOD = (link("base"), link("arm"), joint("elbow", "base", "arm"))
BOX = '<visual><origin xyz="1 2 3" rpy="0 0 1"/><geometry><box size="0.1 0.2 {}"/></geometry></visual>'


@pytest.fixture
def write(tmp_path):
    def write(text):
        path = tmp_path / "my.urdf"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    return write


BROKEN = {
    "empty": ("", "my.urdf' is empty"),
    "binary": (bytes(range(256)), "as XML it is broken"),
    "malformed": ("<robot name='a'><link name='b'></robot>", "as XML it is broken .mismatched tag: line 1"),
    "unknown encoding": ('<?xml version="1.0" encoding="foo"?><robot/>', "as XML it is broken .unknown encoding: foo"),
    "not a robot": ("<sdf version='1.6'/>", "outermost element must be <robot>, got <sdf>"),
    "xacro": ("<robot xmlns:xacro='http://www.ros.org/wiki/xacro'><xacro:arg name='a'/></robot>", "xacro:arg> must be expanded"),
    "no link": (urdf(), "<robot> has no link"),
    "link without a name": (urdf(*GOOD, "<link/>"), "link number 3 has no name"),
    "link twice": (urdf(*GOOD, link("arm")), "link 'arm' is defined twice"),
    "joint without a name": (urdf(*GOOD[:2], joint("", "base", "arm")), "joint number 1 has no name"),
    "joint twice": (urdf(*GOOD, link("c"), joint("elbow", "arm", "c")), "joint 'elbow' is defined twice"),
    "unknown parent": (urdf(*GOOD[:2], joint("elbow", "bose", "arm")), "joint 'elbow' has the parent link 'bose'.*did you mean 'base'"),
    "unknown child": (urdf(*GOOD[:2], joint("elbow", "base", "arn")), "joint 'elbow' has the child link 'arn'.*did you mean 'arm'"),
    "no parent": (urdf(*GOOD[:2], '<joint name="elbow" type="fixed"><child link="arm"/></joint>'), "joint 'elbow' has no parent link"),
    "two roots": (urdf(*GOOD, link("moon")), "link 'moon' has no joint to a parent.*'base', 'moon'"),
    "two parents": (urdf(*GOOD, joint("other", "base", "arm")), "link 'arm' is the child of two joints, 'elbow' and 'other'"),
    "loop": (urdf(*GOOD, joint("back", "arm", "base")), "joint '(elbow|back)' closes a loop of links"),
    "loop beside the tree": (
        urdf(*GOOD, link("c"), link("d"), joint("cd", "c", "d"), joint("dc", "d", "c")),
        "joint '(cd|dc)' closes a loop of links .(c -> d -> c|d -> c -> d)",
    ),
    "joint to itself": (urdf(*GOOD[:1], joint("elbow", "base", "base")), "joint 'elbow' closes a loop of links .base -> base"),
    "negative mass": (urdf(link("base"), link("arm", -2), GOOD[2]), "link 'arm' has a negative mass.*got -2 kg"),
    "mass nan": (urdf(link("base", "nan")), "link 'base' has a <mass> whose value must be a finite number, got 'nan'"),
    "mass in words": (urdf(link("base", "heavy")), "link 'base' has a <mass> whose value must be a finite number, got 'heavy'"),
    "no mass": (urdf('<link name="base"><inertial/></link>'), "link 'base' has an <inertial> without <mass>"),
    "half an inertia": (urdf(link("base").replace('iyz="0"', "")), "link 'base' has a <inertia> without iyz"),
    "weightless": (urdf('<link name="base"/>'), "<robot> has no link with a mass > 0"),
    "no limit": (urdf(*GOOD[:2], joint("elbow", "base", "arm", rest="")), "joint 'elbow' has no <limit>"),
    "no effort": (urdf(*GOOD).replace('effort="5"', ""), "joint 'elbow' has a <limit> without effort"),
    "negative effort": (urdf(*GOOD).replace('effort="5"', 'effort="-5"'), "joint 'elbow' has a negative effort limit"),
    "limits crossed": (urdf(*GOOD).replace('lower="-1"', 'lower="2"'), "joint 'elbow' has a lower limit 2 above its upper limit 1"),
    "unknown type": (urdf(*GOOD[:2], joint("elbow", "base", "arm", "hinge")), "joint 'elbow' must be of type .*got 'hinge'"),
    "floating": (urdf(*GOOD[:2], joint("elbow", "base", "arm", "floating")), "got 'floating', the free-flying base is added"),
    "no type": (urdf(*GOOD).replace('type="revolute"', ""), "joint 'elbow' must be of type .*got no type"),
    "two-number origin": (urdf(*GOOD).replace("0 0 0.3", "0 0.3"), "joint 'elbow' has a <origin> whose xyz must be 3 finite numbers"),
    "zero axis": (urdf(*GOOD[:2], joint("elbow", "base", "arm", axis="0 0 0")), "joint 'elbow' has an <axis> of length zero"),
    "mimics nobody": (urdf(*GOOD[:2], joint("elbow", "base", "arm", rest=LIMIT + '<mimic joint="knee"/>')), "must mimic another joint"),
    "flat box": (urdf(link("base", rest=BOX.format(0))), "link 'base' visual box must have sizes > 0"),
    "box in words": (urdf(link("base", rest=BOX.format("x"))), "link 'base' has a <box> whose size must be 3 finite numbers"),
}


class TestUrdf:
    @pytest.mark.parametrize("case", BROKEN)
    def test_a_broken_urdf_is_named_by_file_and_element(self, case, write, capfd):
        text, sentence = BROKEN[case]
        with pytest.raises(InputError, match=sentence) as caught:
            load_robot(write(text))
        assert "\n" not in str(caught.value)
        assert "my.urdf" in str(caught.value) and caught.value.name.endswith("my.urdf")
        assert capfd.readouterr() == ("", "")

    def test_a_missing_file_offers_near_ones(self, write):
        path = write(urdf(*GOOD))
        with pytest.raises(InputError, match="mi.urdf' does not exist .did you mean 'my.urdf'"):
            load_robot(path.with_name("mi.urdf"))
        with pytest.raises(InputError, match="does not exist, the path of a URDF is expected"):
            load_robot("nowhere/at_all.urdf")

    def test_a_folder_is_not_a_robot(self, tmp_path):
        with pytest.raises(InputError, match="is a folder, a URDF file is expected"):
            load_robot(tmp_path)

    def test_relative_paths_start_at_the_folder(self, write):
        path = write(urdf(*GOOD))
        assert load_robot("my.urdf", folder=path.parent).name == "small"

    def test_meshes_and_foreign_elements_are_not_looked_at(self, write, capfd):
        mesh = '<visual><geometry><mesh filename="package://gone/base.dae"/></geometry><material name="undefined"/></visual>'
        text = urdf(link("base", rest=mesh), *GOOD[1:], '<transmission name="t"><joint name="elbow"/></transmission><gazebo/>')
        robot = load_robot(write(text.replace("<robot ", '<robot xmlns="http://drake.mit.edu" ')))
        assert robot.joints == ("elbow",) and robot.shapes == ()
        assert capfd.readouterr() == ("", "")

    def test_shapes_are_read_with_their_placement(self, write):
        (shape,) = load_robot(write(urdf(link("base", rest=BOX.format(0.3))))).shapes
        assert (shape.link, shape.kind, shape.size) == ("base", "box", (0.1, 0.2, 0.3))
        assert shape.position == pytest.approx([1, 2, 3])
        assert shape.rotation == pytest.approx(pin.rpy.rpyToMatrix(0.0, 0.0, 1.0))

    def test_fixed_joints_alone_make_a_rigid_body(self, write):
        robot = load_robot(write(urdf(*GOOD[:2], joint("weld", "base", "arm", "fixed"))), {"tip": {"frame": "arm", "type": "point"}})
        assert robot.joints == () and robot.mass == 2.0 and robot.angles({}).shape == (0,)
        assert robot.torque_limits.shape == (0, 2) and robot.torque_limits_real
        assert robot.configuration(robot.angles([])) == pytest.approx([0, 0, 0, 0, 0, 0, 1])

    def test_a_continuous_joint_turns_without_limits(self, write):
        parts = (link("base"), link("wheel"), link("arm"), joint("axle", "base", "wheel", "continuous", rest=""))
        robot = load_robot(write(urdf(*parts, joint("elbow", "wheel", "arm"))))
        assert (robot.pin_model.nq, robot.pin_model.nv, robot.joints) == (10, 8, ("axle", "elbow"))
        assert robot.lower.tolist() == [-math.inf, -1.0] and robot.upper.tolist() == [math.inf, 1.0]
        _, data = kinematics(robot, {"axle": 7.5, "elbow": 0.25})
        assert data.oMf[robot.frame_id("arm")].rotation == pytest.approx(pin.rpy.rpyToMatrix(0.0, 7.75, 0.0))
        assert robot.placeholder_joints == ("axle",)

    def test_a_prismatic_joint_has_a_length(self, write):
        robot = load_robot(write(urdf(*GOOD[:2], joint("lift", "base", "arm", "prismatic"))))
        _, data = kinematics(robot, {"lift": 0.5})
        assert data.oMf[robot.frame_id("arm")].translation == pytest.approx([0, 0.5, 0.3])
        with pytest.raises(InputError, match="between -1 and 1 m, got 3"):
            robot.angles({"lift": 3})

    @pytest.mark.parametrize("leader", ["a", "z"])
    def test_a_mimic_joint_follows_its_leader(self, write, leader):
        follower = {"a": "z", "z": "a"}[leader]
        mimic = LIMIT + f'<mimic joint="{leader}" multiplier="-2" offset="0.1"/>'
        parts = (link("base"), link("one"), link("two"), joint(leader, "base", "one"), joint(follower, "base", "two", rest=mimic))
        robot = load_robot(write(urdf(*parts)))
        assert robot.joints == (leader,) and robot.pin_model.nv == 7
        q, data = kinematics(robot, {leader: 0.3})
        assert data.oMf[robot.frame_id("two")].rotation == pytest.approx(pin.rpy.rpyToMatrix(0.0, -0.5, 0.0))
        assert data.oMf[robot.frame_id(follower)].rotation == pytest.approx(pin.rpy.rpyToMatrix(0.0, -0.5, 0.0))
        tau = pin.computeGeneralizedGravity(robot.pin_model, data, q)[6]
        ahead = [kinematics(robot, {leader: 0.3 + step})[1].com[0][2] for step in (-1e-6, 1e-6)]
        assert tau == pytest.approx(9.81 * robot.mass * (ahead[1] - ahead[0]) / 2e-6, rel=1e-6)

    def test_a_leader_inside_the_branch_that_follows_it_is_refused(self, write, capfd):
        mimic = LIMIT + '<mimic joint="wrist"/>'
        parts = (link("base"), link("one"), link("two"), joint("elbow", "base", "one", rest=mimic), joint("wrist", "one", "two"))
        with pytest.raises(InputError, match="my.urdf': <robot> is refused by Pinocchio .*mimic"):
            load_robot(write(urdf(*parts)))

    def test_neutral_lies_inside_the_limits(self, write):
        robot = load_robot(write(urdf(*GOOD).replace('lower="-1"', 'lower="0.5"')))
        assert robot.angles({}).tolist() == [0.5]

    def test_the_digest_is_stable_and_sensitive(self, write):
        text, frames = urdf(*GOOD), {"tip": {"frame": "arm", "type": "point"}}
        digest = load_robot(write(text), frames).digest
        assert len(digest) == 64
        assert load_robot(write(text), {"tip": ContactFrame("tip", "arm", "point")}).digest == digest
        assert (
            load_robot(write(text.replace("><", ">\r\n<")), frames).digest == load_robot(write(text.replace("><", ">\n<")), frames).digest
        )
        others = [
            load_robot(write(text.replace('effort="5"', 'effort="6"')), frames),
            load_robot(write(text), {"tip": frames["tip"] | {"position": [0, 0, 1e-9]}}),
            load_robot(write(text), {"top": frames["tip"]}),
            load_robot(write(text)),
        ]
        assert digest not in {robot.digest for robot in others}

    @pytest.mark.parametrize(
        ("effort", "placeholders"),
        [((5, 0), ("b",)), ((100, 100), ("a", "b")), ((100, 99), ()), ((999, 1000), ("b",)), ((5, 5), ())],
    )
    def test_placeholder_efforts_are_known(self, write, effort, placeholders):
        limits = [LIMIT.replace('"5"', f'"{value}"') for value in effort]
        parts = (
            link("base"),
            link("one"),
            link("two"),
            joint("a", "base", "one", rest=limits[0]),
            joint("b", "one", "two", rest=limits[1]),
        )
        robot = load_robot(write(urdf(*parts)))
        assert robot.placeholder_joints == placeholders
        assert robot.torque_limits_real == (not placeholders)
        assert robot.torque_limits.tolist() == [[-value, value] for value in effort]


class TestContactFrames:
    FOOT = {"frame": "arm", "type": "surface", "size": [0.2, 0.1]}

    def test_a_contact_is_where_the_kinematics_put_it(self, write):
        to_the_right = [[1, 0, 0], [0, 0, -1], [0, 1, 0]]
        robot = load_robot(write(urdf(*GOOD)), {"foot": self.FOOT | {"position": [0.5, 0, 0], "rotation": to_the_right}})
        _, data = kinematics(robot, {"elbow": -1.0})
        arm = data.oMf[robot.frame_id("arm")]
        foot = robot.contact_frame("foot").contact(arm.rotation, arm.translation, friction=0.5)
        assert foot.position == pytest.approx([0.5 * math.cos(1), 0, 0.3 + 0.5 * math.sin(1)])
        assert foot.normal_W == pytest.approx([0, -1, 0])
        assert foot.rotation[:, 0] == pytest.approx([math.cos(1), 0, math.sin(1)])
        assert (foot.name, foot.friction, foot.points_C.shape) == ("foot", 0.5, (4, 2))
        assert not foot.position.flags.writeable

    def test_a_frame_can_be_stated_again(self):
        frame = ContactFrame("grip", "arm", "handle", position=(1, 2, 3), extra={"transmits": ["fx", "mz"], "limits": {"fx": (-1, 2)}})
        again = ContactFrame.from_statement("grip", frame.statement())
        assert again.statement() == frame.statement()
        assert again.contact(np.eye(3), np.zeros(3), friction=0.5).friction == 0.0

    @pytest.mark.parametrize(
        ("keys", "field", "sentence"),
        [
            ({"frame": "ram"}, "frame", "'ram' is not a link or frame of the robot 'small' .did you mean 'arm'"),
            ({"frame": ""}, "frame", "frame must be the name of a link"),
            ({"type": "sole"}, "type", "type must be one of point, surface"),
            ({"size": None}, "size", "exactly one of size and vertices"),
            ({"size": [0.2, -0.1]}, "size", "size must be two lengths > 0"),
            ({"vertices": [[0, 0], [1, 0], [0, 1]]}, "size", "exactly one of size and vertices is expected, got both"),
            ({"shape": "box"}, "shape", "shape is not a key of a surface contact"),
            ({"sise": [1, 1]}, "sise", "sise is not a key of a contact frame .did you mean 'size'"),
            ({"position": [0, 0]}, "position", "position must be 3 numbers"),
            ({"rotation": [[1, 0, 0], [0, 1, 0], [0, 0, -1]]}, "rotation", "right-handed"),
        ],
    )
    def test_wrong_keys_are_named(self, write, keys, field, sentence):
        with pytest.raises(InputError, match=sentence) as caught:
            load_robot(write(urdf(*GOOD)), {"left_foot": self.FOOT | keys})
        assert (caught.value.name, caught.value.field) == ("left_foot", field)

    @pytest.mark.parametrize("key", ["frame", "type"])
    def test_frame_and_type_are_needed(self, key):
        with pytest.raises(InputError, match=f"contact 'foot': {key} is missing"):
            ContactFrame.from_statement("foot", {k: v for k, v in self.FOOT.items() if k != key})

    def test_friction_is_checked_where_it_is_given(self):
        frame = ContactFrame.from_statement("foot", self.FOOT)
        for friction in (None, -0.1, math.nan):
            with pytest.raises(InputError, match="contact 'foot': friction must be a finite number >= 0"):
                frame.contact(np.eye(3), np.zeros(3), friction)
