"""Postures: where the kinematics put the contacts, their Jacobians, the generators and what they refuse."""

import math

import numpy as np
import pinocchio as pin
import pytest

import socp_statics as ss
from socp_statics.exceptions import InputError
from socp_statics.postures import GENERATORS, pose
from socp_statics.robots import Robot, load_robot

FOUR = ("left_foot", "right_foot", "left_hand", "right_hand")
# generators that state the angles of the joints; test_scenes.py has those that state places
BY_ANGLES = ("joint_angles", "standing", "squat", "single_stance", "rolled_feet")
ARMS_DOWN = {"RARM_JOINT1": math.pi / 2, "LARM_JOINT1": math.pi / 2}
STEP = 1e-6

# generator, its numbers, centre of mass from the middle of the hips [m], height of the soles from there [m]
PUBLISHED = {
    "arms forward": ("standing", {"arms": "forward"}, (0.00450, -0.0000065, 0.03410), -0.237),
    "arms down": ("standing", {}, (-0.01158, -0.0000065, 0.02347), -0.237),
    "half squat": ("squat", {}, (-0.00449, -0.0000065, 0.02872), -0.21252),
    "deep squat": ("squat", {"knee": 2.0}, (0.00033, -0.0000065, 0.04319), -0.14506),
}


@pytest.fixture(scope="module")
def hoap2():
    return load_robot("hoap2")


def generate(name, robot, **numbers):
    return GENERATORS.load(name)(robot, **numbers)


def random_posture(robot, rng, support=FOUR):
    return pose(robot, rng.uniform(robot.lower, robot.upper), support, at=rng.uniform(-1, 1, 3))


def frames_at(robot, q):
    """Data of the model with every frame placed."""
    data = robot.pin_model.createData()
    pin.framesForwardKinematics(robot.pin_model, data, q)
    pin.centerOfMass(robot.pin_model, data, q)
    return data


def touching(robot, data, name):
    """Placement of a contact frame by Pinocchio, without the package's own lookup."""
    frame = robot.frames[name]
    link = data.oMf[robot.pin_model.getFrameId(frame.frame, pin.FrameType.BODY)]
    return link * pin.SE3(np.array(frame.rotation), np.array(frame.position))


def differences(posture, of):
    """Central differences of a function of the placed model along each joint, the base fixed; shape (m, n)."""
    robot, columns = posture.robot, []
    for k in range(len(robot.joints)):
        ends = []
        for sign in (1.0, -1.0):
            q = posture.q.copy()
            q[7 + k] += sign * STEP
            ends.append(frames_at(robot, q))
        columns.append(of(*ends))
    return np.array(columns).T


def placement_rate(after, before):
    """Linear and angular velocity in world axes between two placements 2 STEP apart."""
    linear = (after.translation - before.translation) / (2 * STEP)
    return np.concatenate([linear, pin.log3(after.rotation @ before.rotation.T) / (2 * STEP)])


class TestPose:
    @pytest.mark.parametrize("first", FOUR)
    def test_the_first_contact_is_placed_level_and_the_others_by_the_kinematics(self, hoap2, first):
        rng = np.random.default_rng(1)
        for _ in range(5):
            at = rng.uniform(-1, 1, 3)
            support = (first, *(name for name in FOUR if name != first))
            posture = pose(hoap2, rng.uniform(hoap2.lower, hoap2.upper), support, at=at)
            assert posture.support == posture.contacts.names == support
            assert posture.contacts[0].position == pytest.approx(at, abs=1e-12)
            assert posture.contacts[0].rotation == pytest.approx(np.eye(3), abs=1e-12)
            data = frames_at(hoap2, posture.q)
            for contact in posture.contacts:
                placed = touching(hoap2, data, contact.name)
                assert contact.position == pytest.approx(placed.translation, abs=1e-12)
                assert contact.rotation == pytest.approx(placed.rotation, abs=1e-12)
            assert posture.com_W == pytest.approx(data.com[0], abs=1e-12)
            assert posture.p_WB == pytest.approx(data.oMi[1].translation, abs=1e-12)
            assert posture.R_WB == pytest.approx(data.oMi[1].rotation, abs=1e-12)

    def test_which_contact_comes_first_moves_the_robot_as_a_whole(self, hoap2):
        angles = np.random.default_rng(2).uniform(hoap2.lower, hoap2.upper)
        one, two = (pose(hoap2, angles, support) for support in (FOUR, FOUR[::-1]))
        for a in FOUR:
            for b in FOUR:
                gaps = [np.linalg.norm(p.contacts[a].position - p.contacts[b].position) for p in (one, two)]
                assert gaps[0] == pytest.approx(gaps[1], abs=1e-12)
            distances = [np.linalg.norm(p.contacts[a].position - p.com_W) for p in (one, two)]
            assert distances[0] == pytest.approx(distances[1], abs=1e-12)

    def test_angles_by_name_or_in_order(self, hoap2):
        named = pose(hoap2, ARMS_DOWN)
        listed = pose(hoap2, [ARMS_DOWN.get(joint, 0.0) for joint in hoap2.joints])
        assert named.q == pytest.approx(listed.q, abs=0)
        assert dict(zip(hoap2.joints, named.angles, strict=True)) == dict.fromkeys(hoap2.joints, 0.0) | ARMS_DOWN
        assert named.support == ("left_foot", "right_foot")

    def test_contact_types_and_friction(self, hoap2):
        posture = pose(hoap2, {}, FOUR, friction={"left_foot": 0.3, "right_foot": 0.4, "left_hand": 0.5, "right_hand": 0.0})
        assert [c.friction for c in posture.contacts] == [0.3, 0.4, 0.5, 0.0]
        assert [len(c.points_W) for c in posture.contacts] == [4, 4, 1, 1]

    def test_one_support_may_be_a_word(self, hoap2):
        assert pose(hoap2, {}, "right_foot").support == ("right_foot",)

    def test_arrays_are_read_only(self, hoap2):
        posture = pose(hoap2, {})
        arrays = [posture.q, posture.angles, posture.com_W, posture.p_WB, posture.R_WB, posture.com_jacobian, *posture.jacobian.values()]
        assert not any(array.flags.writeable for array in arrays)

    def test_link_placement(self, hoap2):
        posture = random_posture(hoap2, np.random.default_rng(3))
        data = frames_at(hoap2, posture.q)
        for link in ("PELVIS", "RLEG_LINK4", "LARM_LINK4"):
            R, p = posture.link_placement(link)
            M = data.oMf[hoap2.pin_model.getFrameId(link, pin.FrameType.BODY)]
            assert R == pytest.approx(M.rotation, abs=1e-12) and p == pytest.approx(M.translation, abs=1e-12)

    def test_the_stance_brings_everything(self, hoap2):
        posture = pose(hoap2, ARMS_DOWN)
        stance = posture.stance(gravity=(0, 0, -1.62))
        assert stance.contacts is posture.contacts and stance.posture is posture and stance.torque_limits is None
        assert stance.mass == pytest.approx(6.2431648, abs=1e-9) and stance.com == pytest.approx(posture.com_W)
        assert stance.gravity == pytest.approx([0, 0, -1.62])

    def test_public_names(self):
        assert ss.pose is pose and ss.load_robot is load_robot


class TestJacobians:
    def test_contacts_against_differences_of_the_kinematics(self, hoap2):
        rng = np.random.default_rng(4)
        for _ in range(4):
            posture = random_posture(hoap2, rng)
            for name in FOUR:
                J = differences(posture, lambda a, b, name=name: placement_rate(touching(hoap2, a, name), touching(hoap2, b, name)))
                assert posture.jacobian[name].shape == (6, 25)
                assert posture.jacobian[name] == pytest.approx(J, abs=1e-8)

    def test_centre_of_mass_against_differences(self, hoap2):
        rng = np.random.default_rng(5)
        for _ in range(4):
            posture = random_posture(hoap2, rng)
            J = differences(posture, lambda a, b: (a.com[0] - b.com[0]) / (2 * STEP))
            assert posture.com_jacobian.shape == (3, 25)
            assert posture.com_jacobian == pytest.approx(J, abs=1e-8)

    @pytest.mark.parametrize("link", ["LARM_LINK4", "RLEG_LINK4", "HEAD_LINK2"])
    def test_points_of_links_against_differences(self, hoap2, link):
        rng = np.random.default_rng(6)
        posture = random_posture(hoap2, rng)
        index = hoap2.pin_model.getFrameId(link, pin.FrameType.BODY)
        M = frames_at(hoap2, posture.q).oMf[index]
        point = M.translation + rng.uniform(-0.3, 0.3, 3)
        offset = pin.SE3(np.eye(3), M.actInv(point))
        J = differences(posture, lambda a, b: placement_rate(a.oMf[index] * offset, b.oMf[index] * offset))
        assert posture.point_jacobian(link, point) == pytest.approx(J, abs=1e-8)

    def test_points_of_the_base_do_not_move_with_the_joints(self, hoap2):
        posture = random_posture(hoap2, np.random.default_rng(7))
        assert not posture.point_jacobian(hoap2.base, (0.3, -0.2, 0.5)).any()


class TestGenerators:
    @pytest.mark.parametrize("name", BY_ANGLES)
    def test_the_default_is_a_stable_posture(self, hoap2, name):
        posture = generate(name, hoap2)
        assert posture.mass == pytest.approx(6.2431648, abs=1e-9)
        assert (posture.angles >= hoap2.lower).all() and (posture.angles <= hoap2.upper).all()
        assert posture.contacts[0].position == pytest.approx([0, 0, 0], abs=1e-12)
        for contact in posture.contacts:
            assert contact.friction == 0.5
            assert contact.normal_W == pytest.approx([0, 0, 1], abs=1e-12) and abs(contact.position[2]) < 1e-12
        answer = ss.check_equilibrium(posture)
        assert answer.stable and answer.margin > 0.1
        assert set(answer.torques) == set(hoap2.joints)

    @pytest.mark.parametrize("name", BY_ANGLES)
    def test_where_and_how_rough(self, hoap2, name):
        posture, moved = generate(name, hoap2), generate(name, hoap2, at=(1.0, -2.0, 0.5), friction=0.7)
        assert moved.com_W - posture.com_W == pytest.approx([1.0, -2.0, 0.5], abs=1e-12)
        assert moved.angles == pytest.approx(posture.angles, abs=0)
        assert all(contact.friction == 0.7 for contact in moved.contacts)

    @pytest.mark.parametrize("first", ["left_foot", "right_foot"])
    @pytest.mark.parametrize("name", PUBLISHED)
    def test_published_centres_of_mass_and_soles(self, hoap2, name, first):
        generator, numbers, com, sole = PUBLISHED[name]
        support = (first, "left_foot" if first == "right_foot" else "right_foot")
        posture = generate(generator, hoap2, support=support, **numbers)
        assert posture.R_WB == pytest.approx(np.eye(3), abs=1e-12)
        assert posture.com_W - posture.p_WB == pytest.approx(com, abs=6e-6)
        for side, y in (("left", 0.039), ("right", -0.039)):
            # The contact frame is at the middle of the rectangle [-0.040, 0.058] x [-0.0315, 0.0315] of the foot.
            hip = posture.contacts[f"{side}_foot"].position - posture.p_WB
            assert hip[1:] == pytest.approx([y, sole], abs=6e-6)
        reach = 1.0 if first == "left_foot" else -1.0
        assert posture.contacts[support[1]].position == pytest.approx([0, -0.078 * reach, 0], abs=1e-12)

    def test_the_soles_of_the_published_postures_are_under_the_hips(self, hoap2):
        corners = generate("standing", hoap2).contacts["left_foot"].points_W
        posture = generate("standing", hoap2)
        x = corners[:, 0] - posture.p_WB[0]
        assert [x.min(), x.max()] == pytest.approx([-0.040, 0.058], abs=1e-12)

    def test_rolled_feet(self, hoap2):
        posture = generate("rolled_feet", hoap2)
        for side, y in (("left", 0.05643), ("right", -0.05643)):
            foot = posture.contacts[f"{side}_foot"].position - posture.p_WB
            assert foot[1:] == pytest.approx([y, -0.23624], abs=6e-6)
        assert generate("rolled_feet", hoap2, angle=0.0).q == pytest.approx(generate("standing", hoap2).q, abs=1e-12)

    def test_squat_of_straight_knees_is_standing(self, hoap2):
        assert generate("squat", hoap2, knee=0.0).q == pytest.approx(generate("standing", hoap2).q, abs=1e-12)

    @pytest.mark.parametrize("knee", [0.0, 0.5, 1.0])
    @pytest.mark.parametrize("side", ["left", "right"])
    def test_single_stance_holds_on_either_side(self, hoap2, side, knee):
        posture = generate("single_stance", hoap2, support=[f"{side}_foot"], knee=knee)
        assert posture.support == (f"{side}_foot",)
        assert ss.check_equilibrium(posture).stable
        # The free foot is off the ground.
        other = "right" if side == "left" else "left"
        free = touching(hoap2, frames_at(hoap2, posture.q), f"{other}_foot")
        assert free.translation[2] > 0.01

    def test_single_stance_is_mirrored(self, hoap2):
        left, right = (generate("single_stance", hoap2, support=side) for side in ("left_foot", "right_foot"))
        assert left.com_W[:2] == pytest.approx(right.com_W[:2] * [1, -1], abs=5e-5)

    @pytest.mark.parametrize("side", ["left", "right"])
    def test_single_stance_tips_without_lean(self, hoap2, side):
        answer = ss.check_equilibrium(generate("single_stance", hoap2, support=[f"{side}_foot"], lean=0.0))
        assert answer.verdict == "unstable" and answer.reason is None
        assert answer.certificate.power > 0 and "tips about" in answer.certificate.reading
        assert not answer.certificate.joints

    def test_joint_angles(self, hoap2):
        posture = generate("joint_angles", hoap2, angles={"LARM_JOINT4": -1.0}, support=["left_hand", "right_foot"])
        assert posture.support == ("left_hand", "right_foot")
        assert posture.angles[hoap2.joints.index("LARM_JOINT4")] == -1.0
        assert generate("joint_angles", hoap2).q == pytest.approx(pose(hoap2, {}).q, abs=0)


def refused(call, name, field, *words):
    with pytest.raises(InputError) as caught:
        call()
    error = caught.value
    assert (error.name, error.field) == (name, field)
    for word in (name, *words):
        assert word in str(error)
    assert "\n" not in str(error)


class TestErrors:
    @pytest.mark.parametrize("generator", ["standing", "squat", "rolled_feet"])
    @pytest.mark.parametrize("hand", ["left_hand", "right_hand"])
    def test_contacts_off_the_plane(self, hoap2, generator, hand):
        refused(lambda: generate(generator, hoap2, support=["left_foot", hand]), hand, "support", generator, "ground")

    def test_a_foot_off_the_plane_is_the_one_named(self, hoap2):
        refused(lambda: generate("squat", hoap2, support=["left_hand", "right_foot"]), "right_foot", "support", "squat")

    @pytest.mark.parametrize("support", [[], ["left_foot", "right_foot"], ["left_hand"], "both"])
    def test_single_stance_wants_one_foot(self, hoap2, support):
        refused(lambda: generate("single_stance", hoap2, support=support), "single_stance", "support", "left_foot", "right_foot")

    def test_support_twice(self, hoap2):
        refused(lambda: pose(hoap2, {}, ["left_foot", "right_foot", "left_foot"]), "left_foot", "support", "twice")

    def test_no_support(self, hoap2):
        refused(lambda: pose(hoap2, {}, []), "hoap2", "support", "at least one")

    @pytest.mark.parametrize("wrong, near", [("left_fot", "left_foot"), ("rigth_hand", "right_hand")])
    def test_unknown_contact(self, hoap2, wrong, near):
        refused(lambda: pose(hoap2, {}, ["left_foot", wrong]), wrong, "support", repr(near))

    @pytest.mark.parametrize(
        "friction, name, word",
        [
            ({"left_foot": 0.5}, "right_foot", "missing"),
            ({"left_foot": 0.5, "right_foot": 0.5, "left_hand": 0.5}, "left_hand", "not in support"),
            ({"left_foot": 0.5, "right_foot": -0.5}, "right_foot", "-0.5"),
            ({"left_foot": math.nan, "right_foot": 0.5}, "left_foot", "nan"),
            ({"left_foot": "rough", "right_foot": 0.5}, "left_foot", "rough"),
            (-1.0, "left_foot", "-1"),
            (None, "left_foot", "None"),
        ],
    )
    def test_friction(self, hoap2, friction, name, word):
        refused(lambda: pose(hoap2, {}, friction=friction), name, "friction", word)

    @pytest.mark.parametrize("at", [(0, 0), (0, 0, math.inf), "here"])
    def test_where(self, hoap2, at):
        refused(lambda: pose(hoap2, {}, at=at), "hoap2", "at")

    def test_angles_outside_their_limits(self, hoap2):
        refused(lambda: pose(hoap2, {"RLEG_JOINT4": 2.5}), "RLEG_JOINT4", "angles", "2.26893", "2.5")
        refused(lambda: generate("squat", hoap2, knee=-0.5), "LLEG_JOINT4", "angles", "-0.5")
        refused(lambda: generate("squat", hoap2, knee=2.2), "LLEG_JOINT5", "angles", "-1.1")
        refused(lambda: generate("rolled_feet", hoap2, angle=0.5), "LLEG_JOINT6", "angles")
        refused(lambda: pose(hoap2, {"RLEG_JOINT4": math.nan}), "RLEG_JOINT4", "angle", "nan")

    def test_unknown_joint(self, hoap2):
        refused(lambda: pose(hoap2, {"RLEG_JOINT7": 0.1}), "RLEG_JOINT7", "angles", "RLEG_JOINT")
        refused(lambda: generate("joint_angles", hoap2, angles={"LEG_JOINT4": 0.1}), "LEG_JOINT4", "angles", "LLEG_JOINT4")

    def test_wrong_number_of_angles(self, hoap2):
        refused(lambda: pose(hoap2, np.zeros(24)), "hoap2", "angles", "25")

    @pytest.mark.parametrize("name", BY_ANGLES[1:])
    def test_a_robot_without_known_roles(self, hoap2, name):
        stranger = Robot.from_pinocchio(hoap2.pin_model, hoap2.frames, name="stranger")
        refused(lambda: generate(name, stranger), "stranger", "generator", "joint_angles")
        assert generate("joint_angles", stranger).mass == pytest.approx(hoap2.mass)

    @pytest.mark.parametrize("name", ["standing", "squat", "single_stance", "rolled_feet"])
    def test_arms(self, hoap2, name):
        refused(lambda: generate(name, hoap2, arms="up"), "arms", "arms", "down", "forward")

    def test_unknown_link(self, hoap2):
        posture = pose(hoap2, {})
        for ask in (posture.link_placement, lambda link: posture.point_jacobian(link, (0, 0, 0))):
            refused(lambda ask=ask: ask("LARM_LINK"), "hoap2", "frame", "LARM_LINK")
        loads = [{"moment": [0, 0, 1], "link": "TORSO"}]
        refused(lambda: posture.stance(external_wrenches=loads), "hoap2", "frame", "TORSO")
