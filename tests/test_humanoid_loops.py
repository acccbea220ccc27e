"""Interdependent and independent loops, and the torques of the whole robot: (3.61) to (3.75) with D12 and D26 to D33."""

import numpy as np
import pytest
from random_postures import POSTURES, random_posture, robot

import socp_statics as ss
from socp_statics.contacts import ContactSet, FrictionlessSurfaceContact, PointContact, SurfaceContact
from socp_statics.contacts.joint import constraint_basis, mobility_basis
from socp_statics.distribution.dual_null_space import dual_projector, null_projector
from socp_statics.distribution.generalized_inverses import pseudoinverse, weighted_inverse
from socp_statics.distribution.independent_loops import base_wrench, independent_loops, object_wrench
from socp_statics.distribution.interdependent_loops import (
    internal_components,
    load_components,
    partition,
    reference_components,
    stacked_components,
    with_references,
)
from socp_statics.exceptions import InputError
from socp_statics.spatial import wrench_translation
from socp_statics.statics import contact_map, summed_wrench
from socp_statics.statics.torque_components import contact_torques, limb_joints, stacked_torque, torque_components

RNG = np.random.default_rng(21)
UP, GRAVITY = (0, 0, 1), np.array([0, 0, -9.81])
HANDS = ("left_hand", "right_hand")


def feet(kind=SurfaceContact, **more):
    return [kind(name, (0, y, 0), normal=UP, size=(0.2, 0.1), **more) for name, y in (("left_foot", 0.1), ("right_foot", -0.1))]


def hands(kind=PointContact):
    return [kind(f"{side}_hand", (0.4, y, 1.0), normal=(-1, 0, 0.2), friction=0.5) for side, y in (("left", 0.2), ("right", -0.2))]


def standing(**more):
    return ContactSet([*feet(**more), *hands()])


def gravity_at_base(posture):
    return ss.gravity_wrench(posture.mass, GRAVITY, posture.p_WB, posture.com_W)


@pytest.mark.parametrize("name", POSTURES)
@pytest.mark.parametrize("weighted", [False, True])
def test_3_61_to_3_66_hand_references_are_met_and_the_feet_balance(name, weighted):
    posture = random_posture(name, 6)
    contacts, G_B = posture.contacts, gravity_at_base(posture)
    C = contact_map(contacts, posture.p_WB)
    sharp = weighted_inverse(C, RNG.uniform(0.2, 2.0, C.shape[1])) if weighted else pseudoinverse(C)
    references = {hand: RNG.normal(size=3) for hand in HANDS}
    found = with_references(contacts, C, G_B, references, sharp)
    assert found.rank == found.wanted == 6 and found.met and not found.words
    assert np.abs(C @ found.components - G_B).max() < 1e-11 * posture.mass * 9.81
    feet_rows, hand_rows = partition(contacts, HANDS, found.components)
    assert np.allclose(hand_rows, np.concatenate([references[h] for h in HANDS]), atol=1e-11)
    again = load_components(sharp, G_B) + internal_components(C, found.parameter, sharp)
    assert np.allclose(again, found.components, atol=1e-10)
    N_F, N_H = partition(contacts, HANDS, null_projector(C, sharp))
    C_F, C_H = partition(contacts, HANDS, sharp)
    written = C_F @ G_B + N_F @ pseudoinverse(N_H) @ (hand_rows - C_H @ G_B)
    assert np.allclose(written, feet_rows, atol=1e-9)


def test_d29_frictionless_feet_lack_the_rank_and_say_what_is_missed():
    contacts = ContactSet([*feet(FrictionlessSurfaceContact), *hands()])
    C, load = contact_map(contacts, (0, 0, 0.5)), np.array([0, 0, 588.6, 0, 0, 0])
    found = with_references(contacts, C, load, {"left_hand": [1.0, 2.0, 3.0], "right_hand": [0.0, 1.0, 2.0]})
    assert found.rank == 3 and found.wanted == 6 and not found.met and "of left_hand" in found.words
    assert np.allclose(C @ found.components, load, atol=1e-11), "it balances all the same"
    nothing = with_references(contacts, C, load, {"left_hand": np.zeros(3), "right_hand": np.zeros(3)})
    assert nothing.met and nothing.rank == 3, "references that the feet happen to be able to balance are met"


def test_d30_the_feet_share_changes_with_the_references():
    contacts = standing(friction=0.6)
    C, load = contact_map(contacts, (0, 0, 0.5)), np.array([0, 0, 588.6, 0, 0, 0])
    still, pushing = (with_references(contacts, C, load, {h: [0, 0, push] for h in HANDS}).components for push in (0.0, 40.0))
    assert np.abs(still[:12] - pushing[:12]).max() > 10.0
    stance = ss.Stance(contacts, (0.0, 0, 0.5), 60.0)
    gentle, hard = (
        ss.distribute(stance, "pseudoinverse", references={h: push * contacts[h].normal_W for h in HANDS}, engine="clarabel")
        for push in (5.0, 400.0)
    )
    assert gentle.holds and not hard.holds, "the feet are checked against their cones again"


def test_hands_first_leave_the_feet_to_the_lever_rule():
    stance = ss.Stance(standing(friction=0.6), (0.0, 0.02, 0.8), 60.0)
    push = {h: 20.0 * stance.contacts[h].normal_W for h in HANDS}
    for method in ("statics_consistent", "barycentric"):
        found = ss.distribute(stance, method, references=push, engine="clarabel")
        assert found.balance < 1e-13
        for k, name in enumerate(found.contacts):
            if name in push:
                assert np.allclose(found.wrenches_W[k, :3], push[name], atol=1e-12) and np.allclose(found.wrenches_W[k, 3:], 0)
    with pytest.raises(InputError, match="two or three contacts, here are 4"):
        ss.distribute(stance, "statics_consistent", engine="clarabel")
    too_many = push | {"left_foot": [0, 0, 100.0]}
    with pytest.raises(InputError, match="two or three contacts, here are 1"):
        ss.distribute(stance, "statics_consistent", references=too_many, engine="clarabel")
    assert ss.compare_distributions(stance, references=too_many, engine="clarabel")["statics_consistent"].status == "unsuitable"


@pytest.mark.parametrize(
    ("references", "words"),
    [
        ({"left_elbow": [0, 0, 1]}, "contact 'left_elbow' is not there"),
        ({"left_hand": "gently"}, "finite numbers, got 'gently'"),
        ({"left_hand": [0, 0, np.nan]}, "finite numbers"),
        ({"left_hand": [0, 1]}, "'left_hand' needs a force of 3 or a wrench of 6"),
        ({"left_hand": [0, 0, 0, 1, 0, 0]}, "does not transmit m[xyz]"),
        ({name: [0, 0, 1] for name in ("left_foot", "right_foot", *HANDS)}, "at least one has to be free"),
    ],
)
def test_wrong_references_are_named(references, words):
    stance = ss.Stance(standing(friction=0.6), (0.0, 0.0, 0.8), 60.0)
    with pytest.raises(InputError, match=words):
        ss.distribute(stance, "pseudoinverse", references=references)


def test_wrong_components_are_named():
    contacts = standing(friction=0.6)
    C = contact_map(contacts, (0, 0, 0))
    with pytest.raises(InputError, match="at least one contact's wrench"):
        with_references(contacts, C, np.zeros(6), {})
    with pytest.raises(InputError, match="must be 3 numbers"):
        with_references(contacts, C, np.zeros(6), {"left_hand": np.zeros(6)})
    with pytest.raises(InputError, match="'right_hand': its components are missing"):
        stacked_components(contacts, {"left_foot": np.zeros(6), "right_foot": np.zeros(6), "left_hand": np.zeros(3)})
    with pytest.raises(InputError, match="is not there"):
        partition(contacts, ["tail"], np.zeros(18))


def test_3_61_components_in_the_order_of_the_contacts():
    contacts = standing(friction=0.6)
    given = {name: RNG.normal(size=6 if "foot" in name else 3) for name in reversed(contacts.names)}
    assert np.array_equal(stacked_components(contacts, given), np.concatenate([given[name] for name in contacts.names]))
    world = RNG.normal(size=3)
    assert np.allclose(contacts["left_hand"].rotation @ reference_components(contacts["left_hand"], world), world)


# Two feet on the floor, two hands with friction on a box of 1 kg.
BASE, OBJECT = np.array([0.02, 0.0, 0.6]), np.array([0.35, 0.0, 0.9])
GRIP = [
    SurfaceContact(f"{side}_hand", OBJECT + [0, 0.1 * s, 0.01 * s], normal=(0, s, 0), friction=0.5, size=(0.04, 0.04))
    for side, s in (("left", 1), ("right", -1))
]
G_B = ss.gravity_wrench(6.0, GRAVITY, BASE, np.array([0.01, 0.005, 0.55]))
G_O = np.array([0, 0, 9.81, 0, 0, 0])


def test_3_67_to_3_70_both_readings_agree_and_the_feet_carry_robot_and_object():
    internal = {"foot_internal": RNG.normal(size=6), "hand_internal": RNG.normal(size=6)}
    system, alone = (
        independent_loops(feet(friction=0.6), GRIP, BASE, G_B, OBJECT, G_O, reading=reading, **internal) for reading in ("system", "robot")
    )
    assert np.allclose(system.feet, alone.feet, atol=1e-11) and np.allclose(system.hands_on_object, alone.hands_on_object)
    assert system.feet_internal == system.hands_internal == 6
    C_F, C_H = contact_map(ContactSet(feet(friction=0.6)), BASE), contact_map(ContactSet(GRIP), BASE)
    assert (C_F @ system.feet)[2] == pytest.approx(7 * 9.81), "68.7 N, not the 58.9 N of the printed mixture"
    assert np.allclose(object_wrench(contact_map(ContactSet(GRIP), OBJECT), system.hands_on_object), G_O, atol=1e-12)
    assert np.allclose(base_wrench(C_F, system.feet, C_H, system.hands_on_robot), G_B, atol=1e-11)
    assert np.allclose(system.base, G_B + wrench_translation(BASE - OBJECT) @ G_O) and np.allclose(alone.base, G_B)


def test_d27_the_printed_mixture_makes_the_feet_carry_the_robot_alone():
    found = independent_loops(feet(friction=0.6), GRIP, BASE, G_B, OBJECT, G_O)
    C_F, C_H = contact_map(ContactSet(feet(friction=0.6)), BASE), contact_map(ContactSet(GRIP), BASE)
    F_B = G_B + wrench_translation(BASE - OBJECT) @ G_O
    printed = pseudoinverse(C_F) @ (F_B - C_H @ found.hands_on_object)
    assert (C_F @ printed)[2] == pytest.approx(6 * 9.81)


def test_an_object_needs_hands_that_can_hold_it():
    on_ice = [FrictionlessSurfaceContact("left_hand", OBJECT + [0, 0.1, 0], normal=(0, 1, 0), size=(0.04, 0.04))]
    with pytest.raises(InputError, match="held by nothing"):
        independent_loops(feet(friction=0.6), [], BASE, G_B, OBJECT, G_O)
    with pytest.raises(InputError, match="the object cannot be balanced.*no force along x; force along z"):
        independent_loops(feet(friction=0.6), on_ice, BASE, G_B, OBJECT, G_O)
    with pytest.raises(InputError, match="reading must be one of"):
        independent_loops(feet(friction=0.6), GRIP, BASE, G_B, OBJECT, G_O, reading="both")
    with pytest.raises(InputError, match="hand_internal: 6 internal components"):
        independent_loops(feet(friction=0.6), GRIP, BASE, G_B, OBJECT, G_O, hand_internal=np.zeros(7))


@pytest.mark.parametrize("name", POSTURES)
@pytest.mark.parametrize("seed", range(3))
def test_3_71_to_3_75_torques_by_limbs_by_components_and_by_either_model_of_gravity(name, seed):
    posture = random_posture(name, seed)
    contacts, J = posture.contacts, [posture.jacobian[c.name] for c in posture.contacts]
    C, C_C = contact_map(contacts, posture.p_WB), contact_map(contacts, posture.com_W)
    J_c = ss.contact_jacobian(contacts, J)
    J_m = ss.contact_jacobian(contacts, J, [mobility_basis(c) for c in contacts])
    g_theta, load = ss.gravity_torque(posture.com_jacobian, posture.mass, GRAVITY), pseudoinverse(C) @ gravity_at_base(posture)
    internal = null_projector(C) @ RNG.normal(size=C.shape[1])
    F = load + internal
    tau_c, tau_m = contact_torques(J_c, J_m, F)
    assert not tau_m.any()
    parts = torque_components(g_theta, J_c, load, internal)
    expected = ss.static_torque(g_theta, J_c, F)
    scale = posture.mass * 9.81
    assert np.allclose(parts.total, expected, atol=1e-12 * scale) and np.allclose(g_theta + tau_c, expected, atol=1e-12 * scale)
    lumped = ss.lumped_torque(ss.mixed_jacobian(J_c, C_C, posture.com_jacobian), F)
    assert np.allclose(lumped, expected, atol=1e-10 * scale), "tau_B = tau_M where the forces balance (E2)"
    limbs, start = {}, 0
    for contact in contacts:
        columns, c = limb_joints(posture, contact.name), constraint_basis(contact).shape[1]
        limbs[contact.name] = (columns, -J_c[start : start + c, columns].T @ F[start : start + c])
        others = np.delete(J_c[start : start + c], columns, axis=1)
        assert np.abs(others).max() < 1e-12, "a contact loads the joints of its own limb only"
        start += c
    assert np.allclose(stacked_torque(posture.robot.joints, limbs, g_theta), expected, atol=1e-11 * scale)


def test_d33_the_waist_is_shared_by_both_arms_and_the_neck_belongs_to_no_limb():
    posture = random_posture("hoap2", 0)
    joints = robot("hoap2").joints
    left, right = ({joints[i] for i in limb_joints(posture, hand)} for hand in HANDS)
    assert left & right == {"BODY_JOINT1"} and not any("HEAD" in name for name in left | right)
    assert {joints[i] for i in limb_joints(posture, "left_foot")} == {f"LLEG_JOINT{k}" for k in range(1, 7)}
    with pytest.raises(InputError, match="contact 'tail' is not known"):
        limb_joints(posture, "tail")
    with pytest.raises(InputError, match="limb 'leg': 2 torques"):
        stacked_torque(joints, {"leg": (np.array([0, 1]), [0.0])})
    with pytest.raises(InputError, match="rest: 25 torques"):
        stacked_torque(joints, {}, [0.0])


def test_3_72_the_mobility_torque_does_the_work_of_the_mobility_components():
    J_c, J_m, F_c, F_m = RNG.normal(size=(3, 7)), RNG.normal(size=(3, 7)), RNG.normal(size=3), RNG.normal(size=3)
    tau_c, tau_m = contact_torques(J_c, J_m, F_c, F_m)
    rates = RNG.normal(size=7)
    assert (tau_c + tau_m) @ rates == pytest.approx(-F_c @ (J_c @ rates) - F_m @ (J_m @ rates))


@pytest.mark.parametrize("name", POSTURES)
def test_d36_a_torque_of_the_dual_null_space_moves_the_joints(name):
    import pinocchio

    posture = random_posture(name, 2)
    J = np.vstack([posture.jacobian[c.name] for c in posture.contacts])
    tau_n = dual_projector(J) @ RNG.normal(size=J.shape[1])
    M = pinocchio.crba(posture.robot.pin_model, posture.robot.pin_model.createData(), posture.q)
    M = np.triu(M) + np.triu(M, 1).T
    M[6:, 6:] += 0.02 * np.eye(len(tau_n))  # rotors; HOAP-2's hands have no mass
    contacts = np.vstack([np.hstack([_base_columns(posture, c.position), posture.jacobian[c.name]]) for c in posture.contacts])
    B = np.concatenate([np.zeros(6), tau_n])
    inverse = np.linalg.inv(M)
    F = np.linalg.lstsq(contacts @ inverse @ contacts.T, contacts @ inverse @ B, rcond=None)[0]
    acceleration = inverse @ (B - contacts.T @ F)
    assert np.abs(contacts @ acceleration).max() < 1e-6 and np.abs(acceleration).max() > 1e-3


def _base_columns(posture, point):
    """Velocity of a point due to the base's twist in base axes, as Pinocchio's free flyer has it."""
    arm = point - posture.p_WB
    S = np.array([[0, -arm[2], arm[1]], [arm[2], 0, -arm[0]], [-arm[1], arm[0], 0]])
    R = posture.R_WB
    return np.block([[R, -S @ R], [np.zeros((3, 3)), R]])


def test_d26_d28_the_body_wrench_and_the_net_wrench():
    posture = random_posture("hoap2", 5, ("left_foot", "right_foot"))
    batch = ss.distribute_many([posture], methods=["barycentric"])
    W = batch.wrenches("barycentric")[0]
    r = np.array([c.position for c in posture.contacts])
    F_B = ss.body_wrench(contact_map(posture.contacts, posture.p_WB), batch.components["barycentric"][0])
    assert np.allclose(F_B, gravity_at_base(posture), atol=1e-11), "equilibrium is F_B = G_B, not minus it"
    assert np.allclose(summed_wrench(posture.p_WB, r, W[:, :3], W[:, 3:]), F_B, atol=1e-11)
    assert np.allclose(ss.net_wrench(F_B, posture.p_WB, r, W[:, :3]), W.sum(axis=0), atol=1e-11)


@pytest.mark.parametrize("name", POSTURES)
def test_3_67_to_3_70_on_a_robot_with_an_object_between_its_hands(name):
    """Feet, hands and object of a random posture: both readings agree, and the arms feel the object while the feet feel the sum."""
    posture = random_posture(name, 9)
    standing_on = [posture.contacts[c] for c in ("left_foot", "right_foot")]
    places = [posture.contacts[hand].position for hand in HANDS]
    middle = 0.5 * (places[0] + places[1])
    grip = [PointContact(hand, r, normal=r - middle, friction=0.8) for hand, r in zip(HANDS, places, strict=True)]
    G = np.array([0, 0, 0.1 * posture.mass * 9.81, 0, 0, 0])
    squeeze = RNG.normal(size=1)
    system, alone = (
        independent_loops(standing_on, grip, posture.p_WB, gravity_at_base(posture), middle, G, reading=r, hand_internal=squeeze)
        for r in ("system", "robot")
    )
    assert np.allclose(system.feet, alone.feet, atol=1e-9) and system.hands_internal == 1
    C_F, C_H = contact_map(ContactSet(standing_on), posture.p_WB), contact_map(ContactSet(grip), posture.p_WB)
    assert np.allclose(base_wrench(C_F, system.feet, C_H, system.hands_on_robot), gravity_at_base(posture), atol=1e-9)
    assert (C_F @ system.feet)[2] == pytest.approx(1.1 * posture.mass * 9.81)
    other = independent_loops(standing_on, grip, posture.p_WB, gravity_at_base(posture), middle, G, hand_internal=squeeze + 5.0)
    assert np.allclose(other.feet, system.feet, atol=1e-9), "the loops are independent: squeezing does not reach the feet"
