"""Joint torques of postures: against Pinocchio, the two forms (3.74) and (3.75), the composite body (3.55)-(3.60), external wrenches."""

import math

import numpy as np
import pinocchio as pin
import pytest
from scipy.linalg import null_space
from torque_oracles import (
    FOUR,
    LOADS,
    acting,
    balancing,
    full_jacobian,
    generalised_gravity,
    generate,
    random_load,
    random_posture,
    solution,
    world_wrenches,
)

import socp_statics as ss
from socp_statics.contacts.joint import constraint_basis
from socp_statics.postures import GENERATORS
from socp_statics.robots import load_robot
from socp_statics.statics import point_forces
from socp_statics.statics.contact_maps import (
    body_wrench,
    contact_jacobian,
    contact_map,
    gravity_wrench,
    lumped_torque,
    mixed_jacobian,
    net_wrench,
    summed_wrench,
)
from socp_statics.statics.joint_torques import gravity_torque, passive_torque, static_torque, torques_by_name

GRAVITY = np.array([0, 0, -9.81])
STEP = 1e-6


@pytest.fixture(scope="module")
def hoap2():
    return load_robot("hoap2")


class TestAgainstPinocchio:
    """Generalised gravity less J^T F over all 6 + n rows: the base is in balance, the joints have our torques."""

    def test_random_postures_wrenches_and_loads(self, hoap2):
        rng = np.random.default_rng(10)
        model = hoap2.pin_model
        for trial in range(120):
            support = FOUR if trial % 3 else tuple(rng.permutation(FOUR)[: rng.integers(3, 5)])
            posture = random_posture(hoap2, rng, support)
            loads = [random_load(posture, rng) for _ in range(trial % 3)]
            data, x = balancing(posture.stance(external_wrenches=loads), rng)
            torques = torques_by_name(data.torques, data.units, x)
            mine = np.array([torques[joint] for joint in hoap2.joints])

            tau = generalised_gravity(posture)
            pushes = [pin.Force.Zero() for _ in range(model.njoints)]
            placed = model.createData()
            pin.framesForwardKinematics(model, placed, posture.q)
            for link, point, force, moment in acting(posture, point_forces(data, x), loads):
                tau = tau - full_jacobian(posture, link, point).T @ np.concatenate([force, moment])
                joint = model.frames[model.getFrameId(link, pin.FrameType.BODY)].parentJoint
                at_world = pin.Force(force, np.cross(point, force) + moment)
                pushes[joint] = pushes[joint] + placed.oMi[joint].actInv(at_world)
            assert np.abs(tau[:6]).max() < 1e-9
            assert mine == pytest.approx(tau[6:], abs=1e-9)

            still = np.zeros(model.nv)
            inverse = pin.rnea(model, model.createData(), posture.q, still, still, pushes)
            assert np.abs(inverse[:6]).max() < 1e-9
            assert mine == pytest.approx(inverse[6:], abs=1e-9)

    def test_other_gravity(self, hoap2):
        rng = np.random.default_rng(11)
        posture = random_posture(hoap2, rng)
        gravity = np.array([1.0, -2.0, -3.0])
        model = hoap2.pin_model.copy()
        model.gravity.linear = gravity
        tau = pin.computeGeneralizedGravity(model, model.createData(), posture.q)
        assert gravity_torque(posture.com_jacobian, posture.mass, gravity) == pytest.approx(tau[6:], abs=1e-12)
        assert passive_torque(posture.stance(gravity=gravity)) == pytest.approx(tau[6:], abs=1e-12)

    @pytest.mark.parametrize("name", [name for name in GENERATORS.names() if name not in ("quadruped_stance", "keyframes")])
    def test_torques_of_the_answers(self, hoap2, name):
        posture = generate(name, hoap2)
        loads = [ss.ExternalWrench((1.0, 0.5, -2.0), (0, 0, 0), posture.com_W, link="HEAD_LINK2")]
        stance = posture.stance(external_wrenches=loads)
        answers = [ss.check_equilibrium(stance), ss.optimise_contact_forces(stance), ss.minimise_largest_wrench(stance)]
        answers.append(ss.minimise_torque_use(stance, torque_limits={"default": 9.0}))
        for answer in answers:
            tau = generalised_gravity(posture)
            for link, point, force, moment in acting(posture, answer.forces, stance.external_wrenches):
                tau = tau - full_jacobian(posture, link, point).T @ np.concatenate([force, moment])
            assert np.abs(tau[:6]).max() < 1e-6
            assert [answer.torques[joint] for joint in hoap2.joints] == pytest.approx(list(tau[6:]), abs=1e-6)


class Maps:
    """C_cB, C_cC, J_cB, J_cM and gravity of a posture."""

    def __init__(self, posture):
        contacts, jacobian = posture.contacts, list(posture.jacobian.values())
        self.C_cB, self.C_cC = contact_map(contacts, posture.p_WB), contact_map(contacts, posture.com_W)
        self.J_cB = contact_jacobian(contacts, jacobian)
        self.J_cM = mixed_jacobian(self.J_cB, self.C_cC, posture.com_jacobian)
        self.G_B = gravity_wrench(posture.mass, GRAVITY, posture.p_WB, posture.com_W)
        self.g = gravity_torque(posture.com_jacobian, posture.mass, GRAVITY)


class TestTwoForms:
    def test_equal_where_the_forces_balance(self, hoap2):
        rng = np.random.default_rng(12)
        for _ in range(100):
            m = Maps(random_posture(hoap2, rng))
            F = solution(m.C_cB, m.G_B, rng)
            assert static_torque(m.g, m.J_cB, F) == pytest.approx(lumped_torque(m.J_cM, F), abs=1e-9)

    def test_the_force_part_is_enough(self, hoap2):
        rng = np.random.default_rng(13)
        m = Maps(random_posture(hoap2, rng))
        F = solution(m.C_cB[:3], m.G_B[:3], rng)
        assert np.abs(m.C_cB[3:] @ F - m.G_B[3:]).max() > 0.1
        assert static_torque(m.g, m.J_cB, F) == pytest.approx(lumped_torque(m.J_cM, F), abs=1e-9)

    def test_their_difference_is_what_the_forces_lack(self, hoap2):
        rng = np.random.default_rng(14)
        for _ in range(20):
            posture = random_posture(hoap2, rng)
            m = Maps(posture)
            F = rng.normal(0, 20, m.C_cB.shape[1])
            lacking = m.G_B[:3] - m.C_cB[:3] @ F
            difference = static_torque(m.g, m.J_cB, F) - lumped_torque(m.J_cM, F)
            assert np.abs(difference).max() > 1e-2
            assert difference == pytest.approx(posture.com_jacobian.T @ lacking, abs=1e-9)

    def test_both_are_the_torques_of_the_answer(self, hoap2):
        posture = generate("squat", hoap2)
        m = Maps(posture)
        answer = ss.optimise_contact_forces(posture)
        F = []
        for contact, wrench in zip(posture.contacts, answer.forces.wrenches(), strict=True):
            local = np.concatenate([contact.rotation.T @ wrench["force"], contact.rotation.T @ wrench["moment"]])
            F.append(constraint_basis(contact).T @ local)
        F = np.concatenate(F)
        tau = [answer.torques[joint] for joint in hoap2.joints]
        assert static_torque(m.g, m.J_cB, F) == pytest.approx(tau, abs=1e-6)
        assert lumped_torque(m.J_cM, F) == pytest.approx(tau, abs=1e-6)


def test_contact_velocity_of_mixed_coordinates(hoap2):
    rng = np.random.default_rng(15)
    model = hoap2.pin_model
    for _ in range(100):
        posture = random_posture(hoap2, rng)
        m = Maps(posture)
        v = rng.normal(0, 1, model.nv)
        data = model.createData()
        pin.centerOfMass(model, data, posture.q, v)
        expected = []
        for contact in posture.contacts:
            V = full_jacobian(posture, hoap2.frames[contact.name].frame, contact.position) @ v
            V_C = np.concatenate([contact.rotation.T @ V[:3], contact.rotation.T @ V[3:]])
            expected.append(constraint_basis(contact).T @ V_C)
        com_and_base = np.concatenate([data.vcom[0], posture.R_WB @ v[3:6]])
        assert m.C_cC.T @ com_and_base + m.J_cM @ v[6:] == pytest.approx(np.concatenate(expected), abs=1e-10)
        base = np.concatenate([posture.R_WB @ v[:3], posture.R_WB @ v[3:6]])
        assert m.C_cB.T @ base + m.J_cB @ v[6:] == pytest.approx(np.concatenate(expected), abs=1e-10)


class TestCompositeBody:
    """Mistakes of the printed formulas fail, their corrections hold."""

    def test_gravity_torque_with_the_printed_sign_fails(self, hoap2):
        rng = np.random.default_rng(16)
        for _ in range(20):
            posture = random_posture(hoap2, rng)
            expected = generalised_gravity(posture)[6:]
            printed = posture.mass * posture.com_jacobian.T @ GRAVITY
            assert gravity_torque(posture.com_jacobian, posture.mass, GRAVITY) == pytest.approx(expected, abs=1e-12)
            assert printed == pytest.approx(-expected, abs=1e-12) and np.abs(printed - expected).max() > 0.1

    def test_gravity_wrench_is_the_sum_over_the_links(self, hoap2):
        rng = np.random.default_rng(17)
        model = hoap2.pin_model
        for _ in range(20):
            posture = random_posture(hoap2, rng)
            data = model.createData()
            pin.forwardKinematics(model, data, posture.q)
            total = np.zeros(6)
            for placement, inertia in zip(data.oMi, model.inertias, strict=True):
                up = -inertia.mass * GRAVITY
                total += np.concatenate([up, np.cross(placement.act(inertia.lever) - posture.p_WB, up)])
            G_B = gravity_wrench(posture.mass, GRAVITY, posture.p_WB, posture.com_W)
            assert G_B == pytest.approx(total, abs=1e-12)
            at_base = generalised_gravity(posture)[:6]
            assert np.concatenate([posture.R_WB.T @ G_B[:3], posture.R_WB.T @ G_B[3:]]) == pytest.approx(at_base, abs=1e-12)

    def test_body_wrench_three_ways(self, hoap2):
        rng = np.random.default_rng(18)
        for _ in range(20):
            posture = random_posture(hoap2, rng)
            m = Maps(posture)
            F = rng.normal(0, 20, m.C_cB.shape[1])
            at_base, at_com = body_wrench(m.C_cB, F), body_wrench(m.C_cC, F)
            forces, moments = world_wrenches(posture, F)
            positions = np.array([c.position for c in posture.contacts])
            assert summed_wrench(posture.p_WB, positions, forces, moments) == pytest.approx(at_base, abs=1e-10)
            assert summed_wrench(posture.com_W, positions, forces, moments) == pytest.approx(at_com, abs=1e-10)
            arm = posture.com_W - posture.p_WB
            assert at_base[3:] == pytest.approx(at_com[3:] + np.cross(arm, at_com[:3]), abs=1e-10)

            net = np.concatenate([forces.sum(axis=0), moments.sum(axis=0)])
            assert net_wrench(at_base, posture.p_WB, positions, forces) == pytest.approx(net, abs=1e-10)
            assert net_wrench(at_com, posture.com_W, positions, forces) == pytest.approx(net, abs=1e-10)
            levers = np.cross(posture.p_WB - positions, forces).sum(axis=0)
            printed = at_base - np.concatenate([np.zeros(3), levers])
            assert np.abs(printed - net).max() > 0.1

    @pytest.mark.parametrize("side", ["left", "right"])
    def test_torque_sign_with_asymmetric_limits(self, hoap2, side):
        posture = generate("single_stance", hoap2, support=[f"{side}_foot"], knee=1.0)
        knee = f"{side[0].upper()}LEG_JOINT4"
        J = full_jacobian(posture, f"{side[0].upper()}LEG_LINK6", posture.com_W)
        # One foot carries the weight through the centre of mass: the torque is determinate.
        tau = generalised_gravity(posture) - J[:3].T @ (-posture.mass * GRAVITY)
        needed = dict(zip(hoap2.joints, tau[6:], strict=True))[knee]
        assert abs(needed) > 1.0
        for limits, stable in (((needed * 1.01, 0.0), True), ((needed * 0.99, 0.0), False), ((-needed * 1.01, 0.0), False)):
            answer = ss.check_equilibrium(posture, torque_limits={"default": math.inf, knee: sorted(limits)})
            assert answer.stable == stable
            assert answer.reason == (None if stable else "torque")
            if stable:
                assert answer.torques[knee] == pytest.approx(needed, abs=1e-5)


class TestTorqueIsUnique:
    """In statics the torque of given forces is unique: what the dual null space adds accelerates the joints."""

    @staticmethod
    def acceleration(posture, tau):
        """Of base and joints, both soles held to the ground (rotors added: the hands have no mass)."""
        model = posture.robot.pin_model
        M = pin.crba(model, model.createData(), posture.q)
        M = np.triu(M) + np.triu(M, 1).T + np.diag([0.0] * 6 + [0.02] * (model.nv - 6))
        J = np.vstack([full_jacobian(posture, posture.robot.frames[c.name].frame, c.position) for c in posture.contacts])
        driving = np.concatenate([np.zeros(6), tau]) - generalised_gravity(posture)
        system = np.block([[M, J.T], [J, np.zeros((len(J), len(J)))]])
        assert np.linalg.matrix_rank(J) == len(J)
        return np.linalg.solve(system, np.concatenate([driving, np.zeros(len(J))]))[: model.nv]

    def test_null_space_torque_accelerates(self, hoap2):
        posture = generate("squat", hoap2)
        m, rng = Maps(posture), np.random.default_rng(19)
        F = solution(m.C_cB, m.G_B, rng)
        tau = static_torque(m.g, m.J_cB, F)
        assert np.abs(self.acceleration(posture, tau)).max() < 1e-8
        internal = null_space(m.C_cB) @ rng.normal(0, 20, 6)
        assert np.abs(self.acceleration(posture, tau - m.J_cM.T @ internal)).max() < 1e-8
        tau_n = null_space(m.J_cM) @ rng.normal(0, 1, 25 - np.linalg.matrix_rank(m.J_cM))
        assert np.abs(self.acceleration(posture, tau + tau_n)).max() > 0.1
        # No contact forces make up for it.
        rows = np.vstack([m.C_cB, m.J_cB.T])
        wanted = np.concatenate([m.G_B, m.g - tau - tau_n])
        left = rows @ np.linalg.lstsq(rows, wanted, rcond=None)[0] - wanted
        assert np.abs(left).max() > 0.1

    def test_posture_and_forces_leave_no_freedom(self, hoap2):
        posture = generate("single_stance", hoap2)
        answers = [ss.check_equilibrium(posture), ss.optimise_contact_forces(posture), ss.minimise_largest_wrench(posture)]
        for answer in answers[1:]:
            assert answer.torques == pytest.approx(answers[0].torques, abs=1e-5)


class TestExternalWrenches:
    @pytest.mark.parametrize("link", LOADS[:-1])
    def test_virtual_work_on_a_link(self, hoap2, link):
        rng = np.random.default_rng(20)
        posture = random_posture(hoap2, rng)
        load = ss.ExternalWrench(rng.normal(0, 10, 3), rng.normal(0, 1, 3), rng.uniform(-1, 1, 3), link=link)
        model = hoap2.pin_model
        index = model.getFrameId(link, pin.FrameType.BODY)

        def placed(q):
            data = model.createData()
            pin.framesForwardKinematics(model, data, q)
            return data.oMf[index]

        held = placed(posture.q).actInv(load.point)
        work = []
        for k in range(25):
            ahead, behind = posture.q.copy(), posture.q.copy()
            ahead[7 + k] += STEP
            behind[7 + k] -= STEP
            a, b = placed(ahead), placed(behind)
            turned = pin.log3(a.rotation @ b.rotation.T)
            work.append((load.force @ (a.act(held) - b.act(held)) + load.moment @ turned) / (2 * STEP))
        extra = passive_torque(posture.stance(external_wrenches=[load])) - passive_torque(posture.stance())
        assert np.abs(extra).max() > 0.1
        assert extra == pytest.approx(-np.array(work), abs=1e-6)

    def test_the_base_needs_no_torque_for_it(self, hoap2):
        posture = random_posture(hoap2, np.random.default_rng(21))
        plain = passive_torque(posture.stance())
        for link in (None, hoap2.base):
            load = {"force": (5, -3, 2), "moment": (1, 2, 3), "point": (0.1, 0.2, 0.3), "link": link}
            assert passive_torque(posture.stance(external_wrenches=[load])) == pytest.approx(plain, abs=0)

    def test_a_moment_needs_no_point(self, hoap2):
        posture = random_posture(hoap2, np.random.default_rng(22))
        tau = [
            passive_torque(posture.stance(external_wrenches=[{"moment": (1, 2, 3), "link": "RARM_LINK4"} | more]))
            for more in ({}, {"point": (4, 5, 6)})
        ]
        assert tau[0] == pytest.approx(tau[1], abs=1e-12)

    def test_the_link_does_not_matter_for_the_balance(self, hoap2):
        posture = generate("squat", hoap2)
        load = {"force": (3.0, 2.0, -5.0), "point": (0.02, 0.0, 0.2)}
        answers = [
            ss.check_equilibrium(posture, external_wrenches=[load | more]) for more in ({}, {"link": "PELVIS"}, {"link": "HEAD_LINK1"})
        ]
        assert [a.margin for a in answers] == pytest.approx([answers[0].margin] * 3, abs=1e-6)
        assert answers[0].torques == pytest.approx(answers[1].torques, abs=1e-9)
        assert abs(answers[2].torques["BODY_JOINT1"] - answers[0].torques["BODY_JOINT1"]) > 0.1


# generator, its numbers, joint of the largest leg torque, that torque, waist, single stance: knee, hip roll, ankle roll [N m]
PUBLISHED = {
    "arms forward": ("standing", {"arms": "forward"}, 5, 0.13, 1.02, (0.23, 2.40, 2.39)),
    "arms down": ("standing", {"arms": "down"}, 3, 0.43, 2.01, (0.76, 2.40, 2.39)),
    "half squat": ("squat", {"knee": 1.0}, 4, 1.45, 2.01, (3.05, 2.40, 2.39)),
    "deep squat": ("squat", {"knee": 2.0}, 4, 2.24, 2.01, (4.81, 2.40, 2.39)),
}


class TestPublished:
    @pytest.mark.parametrize("name", PUBLISHED)
    def test_double_stance_without_internal_force(self, hoap2, name):
        generator, numbers, joint, largest, waist, _ = PUBLISHED[name]
        answer = ss.optimise_contact_forces(generate(generator, hoap2, **numbers), "least_squares")
        legs = {name: abs(value) for name, value in answer.torques.items() if "LEG" in name}
        assert max(legs.values()) == pytest.approx(largest, abs=0.01)
        assert max(legs, key=legs.get).endswith(f"LEG_JOINT{joint}")
        assert abs(answer.torques["BODY_JOINT1"]) == pytest.approx(waist, abs=0.01)

    @pytest.mark.parametrize("side", ["L", "R"])
    @pytest.mark.parametrize("name", PUBLISHED)
    def test_single_stance_of_a_full_foot(self, hoap2, name, side):
        _, numbers, _, _, waist, expected = PUBLISHED[name]
        foot = {"L": "left_foot", "R": "right_foot"}[side]
        posture = generate("single_stance", hoap2, support=[foot], lean=0.0, lift=0.0, **{"knee": 0.0} | numbers)
        m = Maps(posture)
        F = np.linalg.solve(m.C_cB, m.G_B)
        for tau in (static_torque(m.g, m.J_cB, F), lumped_torque(m.J_cM, F)):
            torques = dict(zip(hoap2.joints, np.abs(tau), strict=True))
            assert [torques[f"{side}LEG_JOINT{k}"] for k in (4, 2, 6)] == pytest.approx(expected, abs=0.01)
            assert torques["BODY_JOINT1"] == pytest.approx(waist, abs=0.01)

    @pytest.mark.parametrize("push, hip, ankle", [(0.0, 0.403, 0.0), (-5.0, 1.584, 0.185), (5.0, -0.778, -0.185)])
    def test_internal_force_between_rolled_feet(self, hoap2, push, hip, ankle):
        posture = generate("rolled_feet", hoap2)
        m = Maps(posture)
        half = posture.mass * 9.81 / 2
        assert half == pytest.approx(30.62, abs=0.005)
        # The push is positive on the right foot, V_L = (0 1 0 0 -1 0)^T with the right foot first (D31), so here the left one,
        # which comes first, gets minus the push. The pitch moments carry the offset of the weight.
        F = np.array([0, -push, half, 0, 0, 0, 0, push, half, 0, 0, 0])
        F[[4, 10]] += (m.G_B - m.C_cB @ F)[4] / 2
        assert np.abs(m.C_cB @ F - m.G_B).max() < 1e-3
        torques = dict(zip(hoap2.joints, static_torque(m.g, m.J_cB, F), strict=True))
        assert [torques["RLEG_JOINT2"], torques["RLEG_JOINT6"]] == pytest.approx([hip, ankle], abs=0.002)
        assert [torques["LLEG_JOINT2"], torques["LLEG_JOINT6"]] == pytest.approx([-hip, -ankle], abs=0.002)
