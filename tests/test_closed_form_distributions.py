"""The distributions in closed form: lever rule, barycentric rule, friction weights, what the pseudoinverse does, batches (D22 to D25)."""

import numpy as np
import pytest
from random_postures import POSTURES, random_posture
from scipy.optimize import linprog

import socp_statics as ss
from socp_statics.contacts import ContactSet, FrictionlessSurfaceContact, Handle, PointContact, Stance, SurfaceContact
from socp_statics.distribution import CLOSED_FORMS, distribute_many
from socp_statics.distribution.barycentric_rule import _best_support, barycentric_shares
from socp_statics.distribution.distributions import load_reaction
from socp_statics.distribution.friction_weights import friction_weighted, friction_weights
from socp_statics.distribution.lever_rule import lever_shares
from socp_statics.distribution.load_line import LoadLine, load_line
from socp_statics.exceptions import InputError
from socp_statics.statics import contact_map

UP, SOLE = (0, 0, 1), [[-0.04, -0.0315], [0.058, -0.0315], [0.058, 0.0315], [-0.04, 0.0315]]
WEIGHT = 6.2431648 * 9.81


def hoap2_feet(roll=0.0, friction=0.5):
    return ContactSet(
        [SurfaceContact(name, (0, side * 0.039, 0), rpy=(side * roll, 0, 0), friction=friction, vertices=SOLE)
         for name, side in (("right_foot", -1), ("left_foot", 1))]
    )  # fmt: skip


def at(y, x=0.0):
    return distribute_many(hoap2_feet(), [[x, y, 0.24]], 6.2431648)


def test_lever_rule_numbers_of_the_notes():
    for method in ("statics_consistent", "barycentric"):
        right, left = at(0.02).wrenches(method)[0]
        assert right[2] == pytest.approx(14.92, abs=5e-3) and left[2] == pytest.approx(46.33, abs=5e-3)
        assert np.abs([right[3:], left[3:]]).max() < 1e-12
        assert left[2] / right[2] == pytest.approx((0.02 + 0.039) / (0.039 - 0.02), abs=1e-12)


def test_a_perpendicular_offset_becomes_equal_centres_of_pressure():
    right, left = at(0.02, x=0.015).wrenches("statics_consistent")[0]
    assert -right[4] / right[2] == pytest.approx(0.015, abs=1e-12) and -left[4] / left[2] == pytest.approx(0.015, abs=1e-12)


@pytest.mark.parametrize("y", [0.039, 0.05, -0.039, -0.2])
def test_limits_of_the_lever_are_safe(y):
    right, left = at(y).wrenches("statics_consistent")[0]
    loaded, idle = (left, right) if y > 0 else (right, left)
    assert loaded[2] == pytest.approx(WEIGHT) and np.abs(idle).max() < 1e-12
    assert loaded[3] == pytest.approx(WEIGHT * (y - np.sign(y) * 0.039), abs=1e-12)


def test_the_printed_weights_are_wrong_outside_the_segment():
    C, load = contact_map(hoap2_feet(), (0, 0, 0)), np.array([0, 0, WEIGHT, 0.05 * WEIGHT, 0, 0])
    w = np.abs(np.array([-0.039, 0.039]) - 0.05) * 0.078
    F = ss.distribution.weighted_inverse(C, np.repeat(w, 6)) @ load
    assert F[2] == pytest.approx(6.7, abs=0.1) and F[8] == pytest.approx(54.5, abs=0.1) and F[9] == pytest.approx(1.07, abs=0.01)


def test_the_pseudoinverse_shares_almost_evenly_and_leaves_the_soles_at_half_their_width():
    right, left = at(0.02).wrenches("pseudoinverse")[0]
    assert right[2] == pytest.approx(30.6, abs=0.05) and left[2] == pytest.approx(30.6, abs=0.05)
    assert right[3] / right[2] == pytest.approx(0.02, abs=2e-4)
    inside, outside = (
        ss.distribute(Stance(hoap2_feet(), (0.009, y, 0.24), 6.24), "pseudoinverse", engine="clarabel") for y in (0.0314, 0.0317)
    )
    assert inside.holds and not outside.holds


def test_the_pseudoinverse_depends_on_the_unit_of_length():
    F = at(0.02)
    assert not np.allclose(F.components["pseudoinverse"], F.components["scaled_pseudoinverse"], atol=0.1)


def test_d22_friction_weights_the_right_way_round():
    feet = hoap2_feet(np.deg2rad(15), 0.2)
    C, load = contact_map(feet, (0, 0, 0)), np.array([0, 0, WEIGHT, 0, 0, 0])

    def use(weights):
        F = friction_weighted(C, load, weights)
        return np.hypot(F[0], F[1]) / F[2]

    assert use(np.ones(12)) == pytest.approx(np.tan(np.deg2rad(15)), abs=1e-6)
    assert use(1.0 / friction_weights(feet, 1.0)) == pytest.approx(1.34, abs=5e-3)
    assert use(friction_weights(feet, 1.0)) == pytest.approx(0.054, abs=5e-4)
    assert use(friction_weights(feet)) == pytest.approx(0.011, abs=5e-4)


def test_d22_friction_weights_are_ordered_contact_by_contact():
    contacts = ContactSet([
        PointContact("a", (0, 0, 0), normal=UP, friction=0.5),
        SurfaceContact("b", (1, 0, 0), normal=UP, friction=0.25, size=(0.2, 0.1)),
        FrictionlessSurfaceContact("c", (2, 0, 0), normal=UP, size=(0.1, 0.1)),
        Handle("d", (0, 1, 1), rpy=(0, 0, 0), transmits=["fx", "fz"]),
    ])  # fmt: skip
    assert friction_weights(contacts, 1.0).tolist() == [2, 2, 1, 4, 4, 1, 1, 1, 4, 1, 1, 1, 1, 1]
    with pytest.raises(InputError, match="friction_exponent must be"):
        friction_weights(contacts, 0.0)


def test_d23_no_weight_keeps_the_forces_inside_their_cones():
    stance = Stance(hoap2_feet(np.deg2rad(15), 0.05), (0.009, 0.0, 0.24), 6.24)
    found = ss.distribute(stance, "friction_weighted", engine="clarabel")
    assert (
        found.measures.friction_use["left_foot"] < 1
        and not ss.distribute(
            Stance(hoap2_feet(np.deg2rad(15), 0.2), (0.009, 0.035, 0.24), 6.24), "friction_weighted", engine="clarabel"
        ).holds
    )


def test_a_load_aslant_has_its_lever_across_itself():
    feet = hoap2_feet()
    tilted = distribute_many(feet, [[0, 0.0, 0.24]], 6.0, gravity=(0, 1.0, -9.81))
    p = 0.24 * 1.0 / 9.81
    right, left = tilted.wrenches("statics_consistent")[0]
    share = (0.039 + p) / 0.078
    assert left[2] / (left[2] + right[2]) == pytest.approx(share, abs=1e-12)


@pytest.mark.parametrize("k", [3, 4, 5, 6])
def test_barycentric_shares_are_the_least_squares_among_all(k):
    rng = np.random.default_rng(k)
    r = rng.normal(size=(200, k, 2))
    weights = rng.dirichlet(0.6 * np.ones(k), 200)
    p = (weights[:, None, :] @ r)[:, 0]
    alpha = barycentric_shares(LoadLine(p, r))
    assert (alpha >= 0).all() and np.allclose(alpha.sum(axis=1), 1, atol=1e-9)
    assert np.abs((alpha[:, None, :] @ r)[:, 0] - p).max() < 1e-8
    assert ((alpha**2).sum(axis=1) <= (weights**2).sum(axis=1) + 1e-9).all()
    for i in range(0, 200, 25):
        A = np.vstack([np.ones(k), r[i].T])
        kkt = linprog(alpha[i], A_eq=A, b_eq=np.r_[1, p[i]], bounds=(0, None))
        assert kkt.fun >= alpha[i] @ alpha[i] - 1e-7, "no other share has a lower product with the gradient"
        assert np.allclose(_best_support(A, np.r_[1, p[i]]), alpha[i], atol=1e-6)


def test_outside_the_contacts_the_nearest_edge_carries():
    r = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])
    alpha = barycentric_shares(LoadLine(np.array([0.25, -3.0]), r))
    assert np.allclose(alpha, [0.75, 0.25, 0, 0])
    assert np.allclose(barycentric_shares(LoadLine(np.array([9.0, 9.0]), r)), [0, 0, 1, 0])
    assert np.allclose(barycentric_shares(LoadLine(np.array([0.5, 0.5]), r)), 0.25)
    assert np.allclose(barycentric_shares(LoadLine(np.zeros(2), r[:1])), [1.0])


def test_three_contacts_nest_the_lever_rule():
    rng = np.random.default_rng(2)
    for _ in range(50):
        r, weights = rng.normal(size=(3, 2)), rng.dirichlet(np.ones(3))
        p = weights @ r
        alpha = lever_shares(LoadLine(p, r))
        d, e = p - r[2], r[1] - r[0]
        s, t = np.linalg.solve(np.column_stack([d, -e]), r[0] - r[2])
        r_12 = r[2] + s * d
        w_1, w_2 = np.linalg.norm(r_12 - r[0]), np.linalg.norm(r_12 - r[1])
        w_3, w_12 = abs(d @ (p - r[2])), abs(d @ (p - r_12))
        W = np.array([(w_1 + w_2) / w_2 * w_12, (w_1 + w_2) / w_1 * w_12, w_3])
        assert np.allclose((1 / W) / (1 / W).sum(), alpha, atol=1e-9) and np.allclose(alpha, weights, atol=1e-9)
    flat = lever_shares(LoadLine(np.array([0.25, 0.0]), np.array([[0.0, 0], [1, 0], [2, 0]])))
    assert np.allclose(flat @ np.array([0.0, 1, 2]), 0.25)


def test_feet_at_one_place_share_evenly():
    assert np.allclose(lever_shares(LoadLine(np.ones(2), np.zeros((2, 2)))), 0.5)


def test_the_line_of_a_load_passes_through_the_centre_of_mass():
    com, f = np.array([0.3, -0.2, 0.9]), np.array([1.0, 2.0, 9.0])
    line = load_line(np.concatenate([f, np.cross(com, f)]), com[None] + np.array([[0.0, 0, 0], [1, 2, 9]]))
    assert np.allclose(line.contacts, line.point, atol=1e-12)
    with pytest.raises(InputError, match="no force"):
        load_line(np.array([0, 0, 0, 1.0, 0, 0]), np.zeros((2, 3)))


@pytest.mark.parametrize("name", POSTURES)
@pytest.mark.parametrize("support", [("left_foot", "right_foot"), ("left_foot", "right_foot", "left_hand"),
                                     ("left_foot", "right_foot", "left_hand", "right_hand")], ids=["2", "3", "4"])  # fmt: skip
def test_random_postures_balance_to_rounding_one_by_one_and_in_a_batch(name, support):
    stances = [random_posture(name, seed, support).stance() for seed in range(8)]
    batch = distribute_many(stances)
    expected = set(CLOSED_FORMS) - (set() if len(support) == 2 else {"statics_consistent"})
    assert set(batch.components) == expected
    for method in batch.components:
        assert batch.balance[method].max() < 1e-12
        wrenches = batch.wrenches(method)
        for i, stance in enumerate(stances):
            left = contact_map(stance.contacts, stance.com) @ batch.components[method][i] - load_reaction(stance, stance.com)
            assert np.abs(left).max() < 1e-12 * stance.weight * max(1.0, stance.contacts.size)
            assert np.allclose(wrenches[i, :, :3].sum(axis=0), [0, 0, stance.weight], atol=1e-10)
            alone = distribute_many([stance], methods=[method])
            assert np.allclose(alone.components[method][0], batch.components[method][i], atol=1e-9 * stance.weight)


def test_a_batch_of_placements_is_the_batch_of_stances():
    rng = np.random.default_rng(4)
    feet = hoap2_feet()
    positions = np.array([c.position for c in feet]) + 0.01 * rng.normal(size=(20, 2, 3))
    coms = rng.uniform(-0.03, 0.03, (20, 3)) + [0, 0, 0.24]
    found = distribute_many(feet, coms, 6.24, positions=positions)
    placed = [
        Stance(ContactSet([c.placed(p, c.rotation, c.friction) for c, p in zip(feet, r, strict=True)]), com, 6.24)
        for r, com in zip(positions, coms, strict=True)
    ]
    again = distribute_many(placed)
    for method in found.components:
        assert np.allclose(found.components[method], again.components[method], atol=1e-10)


def test_external_wrenches_are_balanced_too():
    wrench = ss.ExternalWrench(force=(5.0, 0, -3.0), moment=(0.1, 0.2, 0.3), point=(0.1, 0.0, 0.3))
    stance = Stance(hoap2_feet(), (0.0, 0.01, 0.24), 6.24, external_wrenches=(wrench,))
    found = distribute_many([stance])
    assert max(b.max() for b in found.balance.values()) < 1e-13
    total = found.wrenches("barycentric")[0][:, :3].sum(axis=0)
    assert np.allclose(total, [-5.0, 0, 6.24 * 9.81 + 3.0])


TWO_POINTS = [PointContact(name, (0, y, 0), normal=UP, friction=1.0) for name, y in (("a", 0), ("b", 1))]
ONE_FOOT = ContactSet(list(hoap2_feet())[:1])


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: distribute_many([]), "at least one is expected"),
        (lambda: distribute_many([Stance(hoap2_feet(), (0, 0, 1), 1.0), Stance(ONE_FOOT, (0, 0, 1), 1.0)]), "must have the contacts"),
        (lambda: distribute_many(hoap2_feet(), [0, 0, 1]), "coms: shape"),
        (lambda: distribute_many(hoap2_feet(), [[0, 0, 1]], positions=np.zeros((1, 3, 3))), "positions: shape"),
        (lambda: distribute_many(hoap2_feet(), [[0, 0, 1]], methods=["pseudo_inverse"]), "did you mean 'pseudoinverse'"),
        (lambda: distribute_many(ONE_FOOT, [[0, 0, 1]], methods=["statics_consistent"]), "two or three contacts, here are 1"),
        (lambda: distribute_many(TWO_POINTS, [[0.1, 0.5, 1]]), "rank 5 of 6.* give no moment about y"),
        (lambda: distribute_many(TWO_POINTS, [[0.0, 0.5, 1]], methods=["statics_consistent"]), "'a' has 3 of 6 components"),
    ],
)  # fmt: skip
def test_wrong_input_is_named(call, words):
    with pytest.raises(InputError, match=words):
        call()


def test_a_yaw_moment_does_not_move_the_centre_of_pressure():
    push = ss.ExternalWrench(force=(50.0, 0, 0), moment=(0, 0, 7.0), point=(0.0, 0.0, 0.0))
    stance = Stance(hoap2_feet(), (0.0, 0.01, 0.24), 20.0, external_wrenches=(push,))
    right, left = distribute_many([stance]).wrenches("barycentric")[0]
    assert np.abs([right[3], left[3]]).max() < 1e-10, "both feet press at the middle of their width"
    assert left[2] / (left[2] + right[2]) == pytest.approx(0.049 / 0.078, abs=1e-12)


def test_a_load_without_gravity_or_across_it_has_its_own_line():
    f = np.array([0.0, 3.0, 0.0])
    wrench = np.concatenate([f, np.cross([0.2, 0, 0.1], f)])
    for up in (np.zeros(3), np.array([0, 0, 9.81]), None):
        line = load_line(wrench, np.array([[0.2, -5.0, 0.1]]), up)
        assert np.allclose(line.point, line.contacts[0], atol=1e-12)
