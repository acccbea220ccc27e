"""Derivatives of statics and margin with respect to the posture: against finite differences of everything built anew."""

import numpy as np
import pinocchio as pin
import pytest
from torque_oracles import FOUR, braced, legs, moved_posture, random_load, random_posture

import socp_statics as ss
from socp_statics.exceptions import InputError
from socp_statics.postures import GENERATORS
from socp_statics.postures.moved import posture_on
from socp_statics.robots import load_robot
from socp_statics.statics.joint_torques import passive_torque
from socp_statics.statics.static_derivatives import StaticDerivatives

STEP = 1e-6
LINK = "<link name='{}'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>"
LIMIT = "<axis xyz='1 0 0'/><limit lower='-1' upper='1' effort='1' velocity='1'/>"
LEADER = f"<joint name='lead' type='revolute'><parent link='base'/><child link='a'/>{LIMIT}</joint>"
FOLLOWER = f"<joint name='follow' type='revolute'><parent link='a'/><child link='b'/>{LIMIT}<mimic joint='lead'/></joint>"


@pytest.fixture(scope="module")
def hoap2():
    return load_robot("hoap2")


def statics(posture, gravity, loads, forces_C):
    """Reaction the base would need, in base axes, and joint torques; contact wrenches given in contact frames."""
    stance = posture.stance(gravity=gravity, external_wrenches=loads)
    tau = passive_torque(stance).copy()
    weight = posture.mass * np.asarray(gravity)
    acting = [np.concatenate([weight, np.cross(posture.com_W - posture.p_WB, weight)])]
    acting += [np.concatenate([w.force, w.moment_about(posture.p_WB)]) for w in loads]
    for contact, F in zip(posture.contacts, forces_C, strict=True):
        f, m = contact.rotation @ F[:3], contact.rotation @ F[3:]
        tau -= posture.jacobian[contact.name].T @ np.concatenate([f, m])
        acting.append(np.concatenate([f, m + np.cross(contact.position - posture.p_WB, f)]))
    net = np.sum(acting, axis=0)
    return np.concatenate([-posture.R_WB.T @ net[:3], -posture.R_WB.T @ net[3:], tau])


def along_tangent(function, posture, held=None):
    """Central differences along every coordinate of the tangent; ``held`` contacts keep their frame's rotation."""

    def at(v):
        moved = moved_posture(posture, v)
        if held is None:
            return function(moved)
        placed = {c.name: c.placed(np.array(moved.contacts[c.name].position), c.rotation.copy(), c.friction) for c in held}
        return function(posture_on(posture, moved.q, placed))

    columns = [(at(STEP * e) - at(-STEP * e)) / (2 * STEP) for e in np.eye(posture.robot.pin_model.nv)]
    return np.array(columns).T


class TestStaticDerivatives:
    @pytest.mark.parametrize("gravity", [(0, 0, -9.81), (1.0, 2.0, -7.0)])
    @pytest.mark.parametrize("rides", [True, False])
    def test_against_finite_differences(self, hoap2, gravity, rides):
        rng = np.random.default_rng(3)
        for trial in range(6):
            posture = random_posture(hoap2, rng, FOUR[: 2 + trial % 3])
            loads = [random_load(posture, rng) for _ in range(trial % 3)]
            forces = rng.normal(0, 10, (len(posture.contacts), 6))
            world = np.array([np.kron(np.eye(2), c.rotation) @ F for c, F in zip(posture.contacts, forces, strict=True)])
            turning = None if rides else {name: np.zeros((3, 3)) for name in posture.support}
            ours = StaticDerivatives(posture.stance(gravity=gravity, external_wrenches=loads), turning).of(world)
            held = None if rides else posture.contacts
            numbers = along_tangent(lambda p, g=gravity, w=loads, f=forces: statics(p, g, w, f), posture, held)
            assert np.abs(ours - numbers).max() < 1e-6 * max(1.0, np.abs(ours).max())

    def test_the_shares_of_the_contacts_add_up(self, hoap2):
        posture = random_posture(hoap2, np.random.default_rng(4), FOUR)
        derivatives = StaticDerivatives(posture.stance())
        F = np.random.default_rng(5).normal(0, 10, (4, 6))
        assert np.allclose(derivatives.of(F), derivatives.load + derivatives.produced(F), atol=1e-12)
        assert np.allclose(derivatives.produced(2 * F), 2 * derivatives.produced(F), atol=1e-10)
        assert np.allclose(derivatives.produced(0 * F), 0.0, atol=1e-12)

    def test_a_robot_with_a_mimic_joint_is_refused(self, tmp_path):
        path = tmp_path / "mimic.urdf"
        path.write_text(f"<robot name='mimic'>{LINK.format('base')}{LINK.format('a')}{LINK.format('b')}{LEADER}{FOLLOWER}</robot>")
        robot = load_robot(path, frames={"tip": {"frame": "b", "type": "point"}})
        with pytest.raises(InputError, match="'follow' mimics another"):
            ss.margin_gradient(ss.pose(robot, {}, ["tip"]))


def margin_of(limits, loads=()):
    # not the engine of the gradients, and far more exact than a difference over 1e-6 needs
    return lambda posture: ss.check_equilibrium(posture, torque_limits=limits, external_wrenches=loads, engine="kernel").margin


class TestMarginGradient:
    """Envelope theorem: the derivative of the margin is that of the Lagrangian where forces and multipliers are unique."""

    def test_against_finite_differences_at_seeded_postures(self, hoap2):
        rng = np.random.default_rng(20)
        asked = skipped = infinite = 0
        for trial in range(24):
            posture = braced(hoap2, rng) if trial % 2 else ss.pose(
                hoap2, np.clip(rng.normal(0, 0.25, 25), hoap2.lower, hoap2.upper), FOUR[: 2 + trial % 3], friction=0.6
            )  # fmt: skip
            limits = legs(4.0) if trial % 4 > 1 else False
            loads = [random_load(posture, rng)] if trial % 3 == 0 else []
            found = ss.margin_gradient(posture, torque_limits=limits, external_wrenches=loads, engine="clarabel")
            if not np.isfinite(found.margin):
                infinite += 1
                assert np.isnan(found.tangent).all() and not any(found.unique.values())
                continue
            asked += 1
            assert found.margin == pytest.approx(margin_of(limits, loads)(posture), abs=1e-6)
            if not found.unique["tangent"]:
                skipped += 1
                continue
            numbers = along_tangent(margin_of(limits, loads), posture)
            assert np.abs(found.tangent - numbers).max() < 1e-5 * max(1.0, np.abs(numbers).max()), f"trial {trial}"
        print(f"{asked} finite margins, {skipped} skipped without a unique multiplier, {infinite} infinite")
        assert asked >= 15 and skipped <= 0.2 * asked

    def test_parts_against_finite_differences(self):
        """Contacts alone: the centre of mass, a contact's position, a rotation of its frame."""
        rng = np.random.default_rng(21)
        foot = ss.SurfaceContact("foot", (0, 0.1, 0), rpy=(0.1, 0.2, 0.3), friction=0.5, size=(0.2, 0.1))
        hand = ss.PointContact("hand", (0.5, 0.2, 1.0), normal=(-1, 0.1, 0.2), friction=0.4)
        peg = ss.PointContact("peg", (-0.1, -0.3, 0.1), normal=(0.1, 0.3, 1), friction=0.6)
        com = np.array([0.05, 0.0, 0.7])

        def margin(contacts, at=com):
            return ss.check_equilibrium(contacts, at, 60.0, engine="clarabel").margin

        contacts = [foot, hand, peg]
        found = ss.margin_gradient(contacts, com, 60.0, engine="clarabel")
        assert found.unique == {"com": True, "positions": True, "rotations": True} and found.tangent is None
        for _ in range(4):
            d = rng.normal(size=3)
            slope = (margin(contacts, com + STEP * d) - margin(contacts, com - STEP * d)) / (2 * STEP)
            assert found.com @ d == pytest.approx(slope, rel=1e-5, abs=1e-4)
            for k, contact in enumerate(contacts):

                def shifted(v, k=k, contact=contact):
                    there = contact.placed(contact.position + v, contact.rotation.copy(), contact.friction)
                    return [*contacts[:k], there, *contacts[k + 1 :]]

                def turned(v, k=k, contact=contact):
                    return [*contacts[:k], contact.placed(contact.position.copy(), pin.exp3(v) @ contact.rotation, contact.friction),
                            *contacts[k + 1 :]]  # fmt: skip

                for part, change in ((found.positions, shifted), (found.rotations, turned)):
                    slope = (margin(change(STEP * d)) - margin(change(-STEP * d))) / (2 * STEP)
                    assert part[contact.name] @ d == pytest.approx(slope, rel=1e-5, abs=1e-4)

    def test_the_engines_agree(self, hoap2):
        posture = braced(hoap2, np.random.default_rng(22))
        found = [ss.margin_gradient(posture, torque_limits=legs(4.0), engine=engine) for engine in ("clarabel", "kernel", "cvxpy")]
        for other in found[1:]:
            assert np.allclose(found[0].tangent, other.tangent, atol=1e-4 * np.abs(found[0].tangent).max())

    def test_pyramids_and_soft_fingers(self):
        finger = ss.SoftFingerContact("finger", (0.3, 0, 0.1), normal=(-0.3, 0, 1), friction=0.5, torsional_friction=0.03)
        foot = ss.SurfaceContact("foot", (-0.1, 0.02, 0), rpy=(0.05, 0.1, 0), friction=0.5, size=(0.2, 0.1), normal_force=(0.0, 400.0))
        for cone in ("exact", "inscribed", "circumscribed"):
            settings = {"mass": 60.0, "cone": cone, "engine": "clarabel"}
            found = ss.margin_gradient([finger, foot], (0.1, 0.01, 0.5), **settings)
            ends = [ss.check_equilibrium([finger, foot], (0.1 + s, 0.01, 0.5), **settings).margin for s in (STEP, -STEP)]
            assert found.unique["com"] and found.com[0] == pytest.approx((ends[0] - ends[1]) / (2 * STEP), rel=1e-4)

    def test_a_symmetric_optimum_is_a_kink(self):
        """The centre of mass midway between two feet: whichever way it goes, other corners run out; one-sided slopes differ."""
        feet = [ss.SurfaceContact(n, (0, y, 0), normal=(0, 0, 1), friction=0.6, size=(0.2, 0.1)) for n, y in (("l", 0.1), ("r", -0.1))]
        found = ss.margin_gradient(feet, (0, 0, 0.8), 60.0)
        assert not found.unique["com"]
        aside = ss.margin_gradient(feet, (0.02, 0.0, 0.8), 60.0)
        assert aside.com[0] == pytest.approx(-60 * 9.81 / 0.8, rel=1e-6), "each toe corner loses W d / (8 x half length)"

    def test_infinite_margins_have_no_gradient(self, hoap2):
        grip = ss.Handle("bar", (0, 0, 2), rpy=(0, 0, 0), transmits=["fx", "fy", "fz", "mx", "my", "mz"])
        found = ss.margin_gradient([grip], (0.1, 0, 1), 60.0)
        assert found.margin == np.inf and np.isnan(found.com).all() and not any(found.unique.values())
        weak = ss.margin_gradient(ss.pose(hoap2, {"LLEG_JOINT4": 1.0, "RLEG_JOINT4": 1.0}, ["left_hand"]), torque_limits={"default": 0.01})
        assert weak.margin == -np.inf and np.isnan(weak.tangent).all()


class TestMovedPostures:
    def test_no_motion_gives_the_same_posture(self, hoap2):
        posture = random_posture(hoap2, np.random.default_rng(30), FOUR)
        again = moved_posture(posture, np.zeros(31))
        for name in ("q", "angles", "com_W", "p_WB", "R_WB", "com_jacobian"):
            assert np.allclose(getattr(posture, name), getattr(again, name), atol=1e-14)
        for contact in posture.contacts:
            assert np.allclose(contact.position, again.contacts[contact.name].position, atol=1e-14)
            assert np.allclose(posture.jacobian[contact.name], again.jacobian[contact.name], atol=1e-14)

    def test_what_the_robot_holds_stays_with_it(self, hoap2):
        """The squeeze is felt by the arms after a motion as well, as the derivatives of its statics say."""
        holding, rng = GENERATORS.load("hold_object")(hoap2, mass=1.0), np.random.default_rng(32)
        assert moved_posture(holding, 0.01 * rng.normal(size=31)).loads == holding.loads and len(holding.loads) == 2
        forces = rng.normal(0, 10, (2, 6))
        world = np.array([np.kron(np.eye(2), c.rotation) @ F for c, F in zip(holding.contacts, forces, strict=True)])
        ours = StaticDerivatives(holding.stance()).of(world)
        numbers = along_tangent(lambda p: statics(p, (0, 0, -9.81), [], forces), holding)
        assert np.abs(ours - numbers).max() < 1e-6 * max(1.0, np.abs(ours).max())
