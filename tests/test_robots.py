"""Robots: HOAP-2 against its published numbers, their catalogue, angles, models from Pinocchio."""

import math
import pickle
import subprocess
import sys

import numpy as np
import pinocchio as pin
import pytest

from socp_statics.exceptions import InputError
from socp_statics.robots import ROBOTS, ContactFrame, Robot, load_robot

ARMS_DOWN = {"RARM_JOINT1": math.pi / 2, "LARM_JOINT1": math.pi / 2}
WEIGHT = 61.245
SINGLE_STANCE_JOINTS = ("RLEG_JOINT4", "RLEG_JOINT2", "RLEG_JOINT6")


def squat(knee):
    return {f"{side}LEG_JOINT{k}": angle for side in "RL" for k, angle in ((3, -knee / 2), (4, knee), (5, -knee / 2))}


# name: (angles, centre of mass from the middle of the hips [m], height of the soles [m],
#        single-stance knee, hip-roll and ankle-roll torque [N m], waist torque [N m])
POSTURES = {
    "arms forward": ({}, (0.00450, -0.0000065, 0.03410), -0.237, (0.23, 2.40, 2.39), 1.02),
    "arms down": (ARMS_DOWN, (-0.01158, -0.0000065, 0.02347), -0.237, (0.755, 2.40, 2.39), 2.007),
    "half squat": (ARMS_DOWN | squat(1.0), (-0.00449, -0.0000065, 0.02872), -0.21252, (3.05, 2.40, 2.39), 2.007),
    "deep squat": (ARMS_DOWN | squat(2.0), (0.00033, -0.0000065, 0.04319), -0.14506, (4.81, 2.40, 2.39), 2.007),
}


@pytest.fixture(scope="module")
def hoap2():
    return load_robot("hoap2")


def kinematics(robot, angles):
    """Data of the model after forward kinematics, the base at the origin."""
    data = robot.pin_model.createData()
    q = robot.configuration(robot.angles(angles))
    pin.framesForwardKinematics(robot.pin_model, data, q)
    pin.computeJointJacobians(robot.pin_model, data, q)
    pin.centerOfMass(robot.pin_model, data, q)
    return q, data


def placed(robot, data, contact):
    frame = robot.frames[contact]
    M = data.oMf[robot.frame_id(frame.frame)]
    return frame.contact(M.rotation, M.translation, friction=0.5)


def single_stance_torques(robot, angles, foot):
    """Joint torques where one foot carries the weight: its wrench is determinate."""
    q, data = kinematics(robot, angles)
    index = robot.frame_id(robot.frames[foot].frame)
    J = pin.getFrameJacobian(robot.pin_model, data, index, pin.LOCAL_WORLD_ALIGNED)
    force = np.array([0, 0, 9.81 * robot.mass])
    moment = np.cross(data.com[0] - data.oMf[index].translation, force)
    tau = pin.computeGeneralizedGravity(robot.pin_model, data, q) - J.T @ np.r_[force, moment]
    assert np.abs(tau[:6]).max() < 1e-12
    return dict(zip(robot.joints, tau[6:], strict=True))


class TestHoap2:
    def test_mass_and_weight(self, hoap2):
        assert hoap2.mass == pytest.approx(6.2431648, abs=1e-9)
        assert 9.81 * hoap2.mass == pytest.approx(WEIGHT, abs=5e-4)

    def test_joints_are_the_25_of_fujitsu(self, hoap2):
        legs = [f"{side}LEG_JOINT{k}" for side in "RL" for k in range(1, 7)]
        arms = [f"{side}ARM_JOINT{k}" for side in "RL" for k in range(1, 6)]
        assert sorted(hoap2.joints) == sorted([*legs, *arms, "BODY_JOINT1", "HEAD_JOINT1", "HEAD_JOINT2"])
        assert hoap2.pin_model.nv == 6 + 25
        assert [hoap2.pin_model.names[k + 2] for k in range(25)] == list(hoap2.joints)

    @pytest.mark.parametrize("name", POSTURES)
    def test_centre_of_mass_and_sole_height(self, hoap2, name):
        angles, com, sole, _, _ = POSTURES[name]
        _, data = kinematics(hoap2, angles)
        assert data.com[0] == pytest.approx(com, abs=6e-6)
        for side, y in (("left", 0.039), ("right", -0.039)):
            foot = placed(hoap2, data, f"{side}_foot")
            assert foot.position == pytest.approx([0, y, sole], abs=6e-6)
            assert foot.normal_W == pytest.approx([0, 0, 1], abs=1e-12)

    @pytest.mark.parametrize("name", POSTURES)
    def test_static_torques_that_need_no_optimisation(self, hoap2, name):
        angles, _, _, leg_torques, waist = POSTURES[name]
        torques = single_stance_torques(hoap2, angles, "right_foot")
        assert [abs(torques[joint]) for joint in SINGLE_STANCE_JOINTS] == pytest.approx(leg_torques, abs=0.005)
        assert abs(torques["BODY_JOINT1"]) == pytest.approx(waist, abs=0.005)

    def test_link_frames_are_parallel_to_the_base_in_the_zero_pose(self, hoap2):
        _, data = kinematics(hoap2, {})
        for frame in data.oMf:
            assert frame.rotation == pytest.approx(np.eye(3), abs=1e-15)

    def test_positions_along_the_chains_in_the_zero_pose(self, hoap2):
        _, data = kinematics(hoap2, {})

        def at(link):
            return data.oMf[hoap2.frame_id(link)].translation

        assert at("RLEG_LINK3") == pytest.approx([0, -0.039, 0])
        assert at("RLEG_LINK6") == pytest.approx([0, -0.039, -0.2])
        assert at("LARM_LINK1") == pytest.approx([0, 0.0995, 0.145])
        assert at("LARM_LINK4") == pytest.approx([0.101, 0.0995, 0.145])
        assert at("HEAD_LINK2") == pytest.approx([0.008, 0, 0.226])

    def test_contacts(self, hoap2):
        _, data = kinematics(hoap2, {})
        assert list(hoap2.frames) == ["left_foot", "right_foot", "left_hand", "right_hand"]
        foot = placed(hoap2, data, "right_foot")
        corners = foot.points_W - foot.position
        assert sorted(map(tuple, corners.round(12))) == [(x, y, 0.0) for x in (-0.04, 0.058) for y in (-0.0315, 0.0315)]
        hand = placed(hoap2, data, "left_hand")
        assert hand.type == "point" and hand.position == pytest.approx([0.101 + 0.146, 0.0995, 0.145])
        assert hand.normal_W == pytest.approx([-1, 0, 0])
        assert np.linalg.det(hand.rotation) == pytest.approx(1.0)

    def test_inertias_are_those_of_rigid_bodies(self, hoap2):
        massive = [body for body in hoap2.pin_model.inertias if body.mass > 0]
        assert len(massive) == 24
        for body in massive:
            principal = np.linalg.eigvalsh(body.inertia)
            assert principal[0] > 0 and principal[2] < principal[0] + principal[1]

    def test_left_and_right_are_mirrored(self, hoap2):
        mirror = np.diag([1.0, -1.0, 1.0])
        rng = np.random.default_rng(3)
        drawn = zip(hoap2.joints, rng.uniform(hoap2.lower, hoap2.upper), strict=True)
        right = {joint: angle for joint, angle in drawn if joint.startswith("R")}
        sign = {joint: 1.0 if self.axis(hoap2, joint)[1] else -1.0 for joint in right}
        left = {"L" + joint[1:]: sign[joint] * angle for joint, angle in right.items()}
        _, one = kinematics(hoap2, right)
        _, other = kinematics(hoap2, left)
        for frame in [f.name for f in hoap2.pin_model.frames if f.name.startswith("R")]:
            M, N = one.oMf[hoap2.frame_id(frame)], other.oMf[hoap2.frame_id("L" + frame[1:])]
            assert mirror @ M.translation == pytest.approx(N.translation, abs=1e-14)
            assert mirror @ M.rotation @ mirror == pytest.approx(N.rotation, abs=1e-14)

    @staticmethod
    def axis(robot, joint):
        J = pin.computeJointJacobians(robot.pin_model, robot.pin_model.createData(), robot.configuration(robot.neutral))
        return np.abs(J[3:, 6 + robot.joint_index(joint)]).round(12)

    def test_limits_are_mirrored(self, hoap2):
        for joint in [joint for joint in hoap2.joints if joint.startswith("R")]:
            k, m = hoap2.joint_index(joint), hoap2.joint_index("L" + joint[1:])
            expected = (hoap2.lower[k], hoap2.upper[k]) if self.axis(hoap2, joint)[1] else (-hoap2.upper[k], -hoap2.lower[k])
            assert (hoap2.lower[m], hoap2.upper[m]) == expected

    def test_limits_of_the_knee(self, hoap2):
        k = hoap2.joint_index("LLEG_JOINT4")
        assert (hoap2.lower[k], hoap2.upper[k]) == (-0.017453, 2.26893)

    def test_torque_limits_are_placeholders(self, hoap2):
        assert not hoap2.torque_limits_real and hoap2.placeholder_joints == hoap2.joints
        assert (hoap2.torque_limits == [-9.0, 9.0]).all()
        assert "not a datasheet value" in hoap2.torque_limits_note

    def test_shapes_show_the_true_soles(self, hoap2):
        shapes = {link: [shape for shape in hoap2.shapes if shape.link == link] for link in {shape.link for shape in hoap2.shapes}}
        assert len(shapes) == 26
        assert {shape.kind for shape in hoap2.shapes} == {"box", "cylinder", "sphere"}
        for link in ("LLEG_LINK6", "RLEG_LINK6"):
            sole = min(shapes[link], key=lambda shape: shape.position[2])
            low, high = sole.position - np.array(sole.size) / 2, sole.position + np.array(sole.size) / 2
            assert (low[0], high[0], low[1], high[1], low[2]) == pytest.approx((-0.040, 0.058, -0.0315, 0.0315, -0.037))

    def test_it_says_where_it_comes_from(self, hoap2):
        assert "hinataros/V6" in hoap2.source and hoap2.licence == "BSD-2-Clause"

    def test_an_unknown_contact_offers_near_names(self, hoap2):
        with pytest.raises(InputError, match="'left_food' is not one of its contacts .did you mean 'left_foot'"):
            hoap2.contact_frame("left_food")
        assert hoap2.contact_frame("left_hand").frame == "LARM_LINK4"


class TestCatalogue:
    def test_listing_robots_does_not_import_pinocchio(self):
        code = "from socp_statics.robots import ROBOTS; ROBOTS.describe(); import sys; sys.exit('pinocchio' in sys.modules)"
        assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0

    def test_a_line_says_what_matters(self):
        line = ROBOTS.describe()["hoap2"]
        robot = load_robot("hoap2")
        for word in (f"{len(robot.joints)} joints", f"{robot.mass:.3f} kg", *robot.frames, "placeholders", robot.licence, "V6"):
            assert word in line

    @pytest.mark.parametrize("name", ROBOTS.names())
    def test_every_robot_can_be_loaded_and_posed(self, name):
        robot = load_robot(name)
        assert robot.name == name and robot.frames and robot.source and robot.licence
        _, data = kinematics(robot, {})
        for contact in robot.frames:
            assert np.isfinite(placed(robot, data, contact).points_W).all()

    def test_an_unknown_robot_offers_near_names(self):
        with pytest.raises(InputError, match="robot 'hoap3' is not known .did you mean 'hoap2'.*must end in .urdf") as caught:
            load_robot("hoap3")
        assert (caught.value.name, caught.value.field) == ("hoap3", "robot")

    def test_frames_join_those_of_a_catalogue_robot(self, hoap2):
        more = load_robot("hoap2", {"knee": {"frame": "LLEG_LINK4", "type": "point"}})
        assert [*hoap2.frames, "knee"] == list(more.frames)
        assert "knee" not in load_robot("hoap2").frames
        assert more.digest != hoap2.digest

    def test_a_robot_goes_to_another_process(self, hoap2):
        again = pickle.loads(pickle.dumps(hoap2))
        assert again.digest == hoap2.digest and again.pin_model == hoap2.pin_model


class TestAngles:
    def test_a_mapping_leaves_the_others_neutral(self, hoap2):
        angles = hoap2.angles({"LLEG_JOINT4": 1.0})
        assert angles[hoap2.joint_index("LLEG_JOINT4")] == 1.0
        assert np.count_nonzero(angles) == 1

    def test_an_array_is_in_the_order_of_joints(self, hoap2):
        middle = (hoap2.lower + hoap2.upper) / 2
        assert (hoap2.angles(middle) == middle).all()
        assert (hoap2.angles(hoap2.upper + 0.9e-9) > hoap2.upper).all()

    @pytest.mark.parametrize(
        ("angles", "name", "sentence"),
        [
            ({"LLEG_JOINT9": 0.0}, "LLEG_JOINT9", "'LLEG_JOINT9' is not one of its joints .did you mean 'LLEG_JOINT"),
            ({"LLEG_JOINT4": 2.3}, "LLEG_JOINT4", "'LLEG_JOINT4' must have a finite angle between -0.017453 and 2.26893 rad, got 2.3"),
            ({"LLEG_JOINT4": -0.02}, "LLEG_JOINT4", "between -0.017453 and 2.26893 rad, got -0.02"),
            ({"LLEG_JOINT4": math.nan}, "LLEG_JOINT4", "angle must be a finite number, got nan"),
            ({"LLEG_JOINT4": "bent"}, "LLEG_JOINT4", "angle must be a finite number, got 'bent'"),
            ([0.0] * 24, "hoap2", "angles must be 25 numbers, one a joint, got shape .24,."),
            ([[0.0], [0.0, 1.0]], "hoap2", "angles must be numbers"),
            ([math.nan] + [0.0] * 24, "BODY_JOINT1", "finite angle"),
        ],
    )
    def test_wrong_angles_are_refused_by_name(self, hoap2, angles, name, sentence):
        with pytest.raises(InputError, match=sentence) as caught:
            hoap2.angles(angles)
        assert caught.value.name == name

    def test_the_configuration_puts_the_base_where_it_is_told(self, hoap2):
        R_WB = pin.rpy.rpyToMatrix(0.3, -0.2, 1.1)
        q = hoap2.configuration(hoap2.neutral, np.array([1.0, 2.0, 3.0]), R_WB)
        data = hoap2.pin_model.createData()
        pin.framesForwardKinematics(hoap2.pin_model, data, q)
        base = data.oMf[hoap2.frame_id(hoap2.base)]
        assert hoap2.base == "PELVIS"
        assert base.translation == pytest.approx([1, 2, 3]) and base.rotation == pytest.approx(R_WB)


def pendulum(*efforts):
    """A free flyer that carries one revolute joint for each pair of effort limits."""
    model = pin.Model()
    model.name = "pendulum"
    parent = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "root_joint")
    model.appendBodyToJoint(parent, pin.Inertia.FromSphere(2.0, 0.1), pin.SE3.Identity())
    model.addBodyFrame("trunk", parent, pin.SE3.Identity(), 0)
    one = np.ones(1)
    for k, (least, most) in enumerate(efforts):
        parent = model.addJoint(parent, pin.JointModelRX(), pin.SE3(np.eye(3), np.array([0, 0, 0.5])), f"joint{k}", least * one, most * one,
                                -one, one, -one, one, 0 * one, 0 * one, 0 * one)  # fmt: skip
        model.appendBodyToJoint(parent, pin.Inertia.FromSphere(1.0, 0.1), pin.SE3.Identity())
        model.addBodyFrame(f"link{k}", parent, pin.SE3.Identity(), 0)
    return model


class TestFromPinocchio:
    def test_a_model_with_a_free_flyer_is_a_robot(self):
        robot = Robot.from_pinocchio(pendulum((-3, 4)), {"tip": {"frame": "link0", "type": "point", "position": [0, 0, 0.1]}})
        assert (robot.name, robot.base, robot.mass, robot.joints) == ("pendulum", "trunk", 3.0, ("joint0",))
        assert robot.torque_limits.tolist() == [[-3.0, 4.0]] and robot.torque_limits_real
        _, data = kinematics(robot, [0.5])
        assert placed(robot, data, "tip").position == pytest.approx([0, -0.1 * math.sin(0.5), 0.5 + 0.1 * math.cos(0.5)])

    def test_the_model_is_copied(self):
        model = pendulum((-3, 4))
        robot = Robot.from_pinocchio(model)
        model.inertias[1].mass = 100.0
        assert pin.computeTotalMass(robot.pin_model) == 3.0

    def test_its_limits_can_be_declared_placeholders(self):
        robot = Robot.from_pinocchio(pendulum((-3, 4), (-5, 5)), torque_limits_real=False)
        assert robot.placeholder_joints == ("joint0", "joint1")

    def test_an_interval_without_zero_is_a_placeholder(self):
        assert Robot.from_pinocchio(pendulum((3, 4), (-5, 5))).placeholder_joints == ("joint0",)

    def test_the_digest_tells_models_apart(self):
        digests = [Robot.from_pinocchio(pendulum(*efforts)).digest for efforts in (((-3, 4),), ((-3, 4),), ((-3, 5),))]
        assert digests[0] == digests[1] != digests[2]

    def test_a_model_without_a_free_flyer_is_refused(self):
        for model in (pin.Model(), pin.buildSampleModelManipulator()):
            with pytest.raises(InputError, match="the first joint of the model must be a free flyer"):
                Robot.from_pinocchio(model)

    def test_a_ball_joint_is_refused_by_name(self):
        model = pendulum((-3, 4))
        model.addJoint(2, pin.JointModelSpherical(), pin.SE3.Identity(), "ball")
        with pytest.raises(InputError, match="joint 'ball' must have one degree of freedom, got 3") as caught:
            Robot.from_pinocchio(model)
        assert caught.value.name == "ball"

    def test_a_second_tree_is_refused(self):
        model = pendulum((-3, 4))
        model.addJoint(0, pin.JointModelRX(), pin.SE3.Identity(), "crane")
        with pytest.raises(InputError, match="joint 'crane' is fixed to the world"):
            Robot.from_pinocchio(model)

    def test_an_unknown_frame_offers_near_names(self):
        with pytest.raises(InputError, match="frame 'link1' is not a link or frame of the robot 'pendulum' .did you mean 'link0'"):
            Robot.from_pinocchio(pendulum((-3, 4)), {"tip": {"frame": "link1", "type": "point"}})

    def test_a_frame_under_another_name_is_refused(self):
        with pytest.raises(InputError, match="contact 'tip': its frame is named 'top'"):
            Robot.from_pinocchio(pendulum((-3, 4)), {"tip": ContactFrame("top", "link0", "point")})
