"""Inverse kinematics: contacts exactly where they are asked to be, joint limits kept, nearest to the reference, clear refusals."""

import importlib.util

import numpy as np
import pinocchio as pin
import pytest
from benchmarks.inverse_kinematics import survey
from scipy.spatial.transform import Rotation

import socp_statics as ss
from socp_statics.exceptions import InputError
from socp_statics.postures import inverse_kinematics, soft_tasks
from socp_statics.postures.placements import read_base, read_com, read_placements
from socp_statics.postures.reaching import Reaching, targets_of
from socp_statics.postures.starting_posture import laid_over

FEET = {"left_foot": (0.0, 0.05, 0.0), "right_foot": (0.0, -0.05, 0.0)}
WALL = (-1.0, 0.0, 0.0)


@pytest.fixture(scope="module")
def hoap2():
    return ss.load_robot("hoap2")


def frame_placement(robot, q, name):
    """Placement of a contact frame by Pinocchio alone."""
    data = robot.pin_model.createData()
    pin.framesForwardKinematics(robot.pin_model, data, q)
    frame = robot.frames[name]
    link = data.oMf[robot.pin_model.getFrameId(frame.frame, pin.FrameType.BODY)]
    return link * pin.SE3(np.array(frame.rotation), np.array(frame.position))


def turned(roll, pitch, yaw=0.0):
    return Rotation.from_euler("ZYX", [yaw, pitch, roll]).as_matrix()


def random_placements(robot, rng):
    """Places of feet and a hand that some posture within the joint limits reaches."""
    angles = robot.reference + 0.35 * (rng.uniform(robot.lower, robot.upper) - robot.reference)
    q = robot.configuration(angles, rng.uniform(-1, 1, 3), turned(*(0.3 * rng.standard_normal(3))))
    places = {name: frame_placement(robot, q, name) for name in ("left_foot", "right_foot", "right_hand")}
    return {name: (M.translation, M.rotation) for name, M in places.items()}


class TestExact:
    def test_contacts_are_where_they_are_asked_to_be(self, hoap2):
        rng = np.random.default_rng(1)
        for _ in range(15):
            places = random_placements(hoap2, rng)
            posture = ss.reach(hoap2, places, friction=0.6)
            assert posture.support == tuple(places)
            for name, (position, rotation) in places.items():
                placed = frame_placement(hoap2, posture.q, name)
                assert np.abs(placed.translation - position).max() <= 1e-9
                if name != "right_hand":
                    assert np.linalg.norm(pin.log3(placed.rotation.T @ rotation)) <= 1e-9
                assert posture.contacts[name].position == pytest.approx(position, abs=1e-9)
                assert posture.contacts[name].rotation == pytest.approx(rotation, abs=1e-9)
                assert posture.contacts[name].friction == 0.6
            assert (posture.angles >= hoap2.lower).all() and (posture.angles <= hoap2.upper).all()
            again = ss.posture_at(hoap2, posture.q, list(FEET))
            assert again.com_W == pytest.approx(posture.com_W, abs=1e-14)
            assert again.jacobian["left_foot"] == pytest.approx(posture.jacobian["left_foot"], abs=1e-14)

    @pytest.mark.parametrize("com", [(0.02, 0.01), (0.01, 0.0, 0.25)])
    def test_centre_of_mass(self, hoap2, com):
        posture = ss.reach(hoap2, FEET, com=com)
        assert posture.com_W[: len(com)] == pytest.approx(com, abs=1e-9)
        assert ss.check_equilibrium(posture).stable

    def test_base(self, hoap2):
        R = turned(0.05, 0.1)
        posture = ss.reach(hoap2, FEET, base=((0.01, 0.0, 0.21), R))
        assert posture.p_WB == pytest.approx([0.01, 0.0, 0.21], abs=1e-9) and posture.R_WB == pytest.approx(R, abs=1e-9)
        assert ss.reach(hoap2, FEET, base=(0.01, 0.0, 0.21)).p_WB == pytest.approx([0.01, 0.0, 0.21], abs=1e-9)

    def test_a_wall_decides_the_normal_of_a_hand_and_leaves_the_link_free(self, hoap2):
        place = ((0.2, 0.08, 0.36), WALL)
        free = ss.reach(hoap2, {**FEET, "left_hand": place})
        along = ss.reach(hoap2, {**FEET, "left_hand": place}, aligned=["left_hand"])
        own = ss.reach(hoap2, {**FEET, "left_hand": place[0]})
        for posture in (free, along):
            assert posture.contacts["left_hand"].normal_W == pytest.approx(WALL, abs=1e-12)
        assert frame_placement(hoap2, along.q, "left_hand").rotation[:, 2] == pytest.approx(WALL, abs=1e-9)
        by_link = frame_placement(hoap2, own.q, "left_hand").rotation
        assert own.contacts["left_hand"].rotation == pytest.approx(by_link, abs=1e-12)
        assert np.abs(frame_placement(hoap2, free.q, "left_hand").rotation[:, 2] - WALL).max() > 0.01

    def test_the_contacts_of_a_posture_ask_for_the_posture_itself(self, hoap2):
        first = ss.reach(hoap2, {**FEET, "left_hand": ((0.2, 0.08, 0.36), WALL)})
        again = ss.reach(hoap2, {c.name: (c.position, c.rotation) for c in first.contacts}, reference=first)
        assert again.q == pytest.approx(first.q, abs=1e-12)
        moved = ss.reach(hoap2, {c.name: (c.position, c.rotation) for c in first.contacts}, reference=first, com=first.com_W + 1e-3)
        assert np.abs(moved.q - first.q).max() < 0.1


class TestTheProgram:
    def test_jacobians_against_differences(self, hoap2):
        rng, step = np.random.default_rng(2), 1e-6
        places = read_placements(hoap2, {**FEET, "left_hand": ((0.2, 0.08, 0.36), WALL), "right_hand": (0.2, -0.1, 0.3)}, ["left_hand"])
        for com in ((0.0, 0.0), (0.0, 0.0, 0.2)):
            targets = targets_of(hoap2, places, read_com(com), read_base(((0, 0, 0.2), np.eye(3))))
            reaching = Reaching(hoap2, laid_over(hoap2, hoap2.reference, places), targets)
            for _ in range(3):
                x = 0.3 * rng.standard_normal(31)
                J = reaching.jacobian(x)
                for k in range(31):
                    e = step * np.eye(31)[k]
                    assert J[:, k] == pytest.approx((reaching.residual(x + e) - reaching.residual(x - e)) / (2 * step), abs=1e-8)

    @pytest.mark.parametrize("name", ["icub", "romeo", "centauro"])
    def test_jacobians_of_mirrored_mimicking_and_wheeled_robots(self, name):
        """Along random directions: a base that looks backwards, fingers that follow others, held wheels."""
        robot, rng, step = ss.load_robot(name), np.random.default_rng(7), 1e-6
        q = robot.configuration(robot.reference)
        places = read_placements(robot, {contact: frame_placement(robot, q, contact).translation for contact in robot.frames})
        reaching = Reaching(robot, q, targets_of(robot, places, read_com((0.0, 0.0, 0.5)), None))
        x = 0.2 * rng.standard_normal(len(reaching.lower))
        for _ in range(6):
            e = rng.standard_normal(len(x))
            slope = (reaching.residual(x + step * e) - reaching.residual(x - step * e)) / (2 * step)
            assert reaching.jacobian(x) @ e == pytest.approx(slope, abs=1e-7)

    def test_the_answer_is_a_local_optimum(self, hoap2):
        """At the answer the distance grows along every direction that keeps the contacts and the joint limits."""
        rng = np.random.default_rng(3)
        for _ in range(6):
            placements = random_placements(hoap2, rng)
            places = read_placements(hoap2, placements)
            reaching = Reaching(hoap2, laid_over(hoap2, hoap2.reference, places), targets_of(hoap2, places, None, None))
            posture = ss.reach(hoap2, placements)
            x = pin.difference(hoap2.pin_model, reaching.q0, posture.q)
            J = reaching.jacobian(x)
            low, high = x <= reaching.lower + 1e-9, x >= reaching.upper - 1e-9
            free = ~(low | high)
            multipliers = np.linalg.lstsq(J[:, free].T, x[free], rcond=None)[0]
            gradient = x - J.T @ multipliers
            assert np.abs(gradient[free]).max() < 1e-3
            assert (gradient[low] > -1e-3).all() and (gradient[high] < 1e-3).all()

    def test_deterministic(self, hoap2):
        places = random_placements(hoap2, np.random.default_rng(4))
        assert ss.reach(hoap2, places).q.tobytes() == ss.reach(hoap2, places).q.tobytes()

    def test_soft_tasks_and_random_starts_take_over_in_turn(self, hoap2, monkeypatch):
        if importlib.util.find_spec("pink") is None:
            pytest.fail("the extra ik is part of the test extra")
        used, real = [], inverse_kinematics._nearest

        def failing_before(count):
            def nearest(reaching, start):
                used.append(start)
                return np.zeros_like(start) if len(used) <= count else real(reaching, start)

            return nearest

        places = random_placements(hoap2, np.random.default_rng(5))
        for count in (0, 1, 2):
            used.clear()
            monkeypatch.setattr(inverse_kinematics, "_nearest", failing_before(count))
            posture = ss.reach(hoap2, places)
            assert len(used) == count + 1
            assert posture.contacts["left_foot"].position == pytest.approx(places["left_foot"][0], abs=1e-9)
        monkeypatch.setattr(soft_tasks, "find_spec", lambda name: None)
        used.clear()
        monkeypatch.setattr(inverse_kinematics, "_nearest", failing_before(1))
        assert ss.reach(hoap2, places).support == tuple(places) and len(used) == 2

    def test_soft_tasks_come_near(self, hoap2):
        places = read_placements(hoap2, {**FEET, "left_hand": ((0.2, 0.08, 0.36), WALL)}, ["left_hand"])
        targets = targets_of(hoap2, places, read_com((0.01, 0.0)), read_base((0.0, 0.0, 0.21)))
        reaching = Reaching(hoap2, laid_over(hoap2, hoap2.reference, places), targets)
        x = soft_tasks.soft_start(reaching)
        assert np.abs(reaching.residual(x)).max() < 0.2 * np.abs(reaching.residual(np.zeros(31))).max()
        assert (x >= reaching.lower).all() and (x <= reaching.upper).all()


class TestRefusals:
    def test_the_contact_and_the_joint_at_fault_are_named(self, hoap2):
        with pytest.raises(InputError, match=r"contact 'left_hand' stays 0\.\d+ m from its place with .*LARM_JOINT\d") as caught:
            ss.reach(hoap2, {**FEET, "left_hand": (0.6, 0.1, 0.35)}, restarts=1)
        assert caught.value.name == "left_hand" and caught.value.field == "placements"

    def test_the_centre_of_mass_at_fault(self, hoap2):
        with pytest.raises(InputError, match="cannot reach: the centre of mass stays"):
            ss.reach(hoap2, FEET, com=(0.0, 0.0, 0.6), restarts=1)

    @pytest.mark.parametrize(
        ("placements", "keys", "words"),
        [
            ({}, {}, "placements must name at least one contact"),
            ({"left_fot": (0, 0, 0)}, {}, "did you mean 'left_foot'"),
            ({"left_foot": (0, 0)}, {}, "contact 'left_foot': position must be"),
            ({"left_foot": ((0, 0, 0), (0, 0, 0))}, {}, "contact 'left_foot': normal must not be zero"),
            ({"left_foot": ((0, 0, 0), 2 * np.eye(3))}, {}, "contact 'left_foot': rotation must be orthonormal"),
            (FEET, {"aligned": ["left_foot"]}, "contact 'left_foot': aligned"),
            (FEET, {"com": (0, 0, 0, 0)}, "target 'com'.*3 numbers"),
            (FEET, {"base": (0, 0)}, "target 'base'.*3 numbers"),
            (FEET, {"friction": {"left_foot": 0.5}}, "friction of 'right_foot' is missing"),
            (FEET, {"reference": {"LLEG_JOINT4": 9.0}}, "LLEG_JOINT4.*2.26893"),
        ],
    )
    def test_wrong_questions(self, hoap2, placements, keys, words):
        with pytest.raises(InputError, match=words):
            ss.reach(hoap2, placements, **keys)

    def test_a_configuration_needs_a_unit_quaternion(self, hoap2):
        q = hoap2.configuration(hoap2.reference)
        with pytest.raises(InputError, match="unit quaternion"):
            ss.posture_at(hoap2, np.concatenate([q[:3], [0, 0, 0, 2], q[7:]]))
        with pytest.raises(InputError, match="q must be 32 numbers"):
            ss.posture_at(hoap2, q[:-1])


@pytest.mark.parametrize("name", ["talos", "hyq"])
def test_seeded_random_targets_are_reached(name):
    found = survey(name, 8)
    assert len(found.seconds) == 8 and not found.refused and found.worst <= 1e-9
    assert found.line().startswith(name)
