"""General solution, dual null spaces, priorities and loop torques: the corrected identities of (3.35) to (3.41), (3.51), (3.52), (3.54)."""

import numpy as np
import pytest
from random_postures import POSTURES, random_posture

import socp_statics as ss
from socp_statics.contacts import ContactSet, FrictionlessSurfaceContact, PointContact, SurfaceContact
from socp_statics.distribution.dual_null_space import dual_null_basis, dual_projector, null_basis, null_projector, projector_from_dual
from socp_statics.distribution.general_solution import general_solution, internal_component, loop_wrench, null_component
from socp_statics.distribution.generalized_inverses import pseudoinverse, weighted_inverse
from socp_statics.distribution.limb_torques import limb_jacobians
from socp_statics.distribution.loop_torques import component_slices, contact_components, limb_loop_torque
from socp_statics.distribution.priorities import LEVELS, prioritised_torque, restricted_mobility, stacked_by_priority
from socp_statics.exceptions import InputError
from socp_statics.statics import contact_map

RNG = np.random.default_rng(11)
UP = (0, 0, 1)
FEET = ContactSet(
    [SurfaceContact(name, (0.0, y, 0.0), normal=UP, friction=0.6, size=(0.2, 0.1)) for name, y in (("left", 0.1), ("right", -0.1))]
)
POINTS = ContactSet([PointContact(name, (0.0, y, 0.0), normal=UP, friction=0.6) for name, y in (("left", 0.1), ("right", -0.1))])
ICE = ContactSet(
    [FrictionlessSurfaceContact(name, (0.0, y, 0.0), normal=UP, size=(0.2, 0.1)) for name, y in (("left", 0.1), ("right", -0.1))]
)
LOAD = np.array([0.0, 0.0, 588.6, 10.0, -20.0, 0.0])


@pytest.mark.parametrize(("contacts", "c", "rank"), [(FEET, 12, 6), (POINTS, 6, 5), (ICE, 6, 3)], ids=["feet", "points", "ice"])
def test_3_39_to_3_41_every_member_balances_and_the_null_space_has_c_less_rank_dimensions(contacts, c, rank):
    C = contact_map(contacts, (0, 0, 0.8))
    wrench = C @ RNG.normal(size=c)
    solution = general_solution(C, wrench)
    assert solution.rank == rank and solution.internal == c - rank
    F_a, F_int = RNG.normal(size=c), RNG.normal(size=c - rank)
    for F in (solution.particular, solution.with_arbitrary(F_a), solution.with_internal(F_int)):
        assert np.allclose(loop_wrench(C, F), wrench, atol=1e-12)
    assert np.allclose(null_component(solution.projector, F_a), solution.basis @ (solution.basis.T @ F_a), atol=1e-12)
    assert np.linalg.matrix_rank(solution.projector, tol=1e-9) == c - rank
    assert np.allclose(solution.basis.T @ internal_component(solution.basis, F_int), F_int)


def test_3_39_the_weighted_particular_solution_differs_by_a_null_component_only():
    C = contact_map(FEET, (0, 0, 0.8))
    sharp = weighted_inverse(C, RNG.uniform(0.1, 2.0, 12))
    difference = general_solution(C, LOAD, sharp).particular - general_solution(C, LOAD).particular
    assert np.abs(C @ difference).max() < 1e-10 and np.abs(difference).max() > 1e-3
    oblique = null_projector(C, sharp)
    assert np.allclose(oblique @ oblique, oblique) and np.allclose(C @ oblique, 0.0, atol=1e-12)


def test_d31_the_planar_example_has_one_internal_force_and_moments_that_need_a_vertical_couple():
    """Two planar feet with (moment, horizontal, vertical) each, at y = -b and b on one level; balance of (horizontal, vertical, moment)."""
    b, z = 0.056, -0.236
    foot = [np.array([[0, 1, 0], [0, 0, 1], [1, -z, y]]) for y in (-b, b)]
    C = np.hstack(foot)
    solution = general_solution(C, np.array([0.0, 61.2, 0.0]))
    V_L = np.array([0.0, 1, 0, 0, -1, 0])
    assert solution.rank == 3 and solution.internal == 3 and not (C @ V_L).any()
    assert np.allclose(solution.particular[[2, 5]], 30.6), "the pseudoinverse shares a symmetric load equally"
    moment, couple = np.array([1.0, 0, 0, 0, 0, 0]), np.array([0, 0, 0.5 / b, 0, 0, -0.5 / b])
    assert np.abs(C @ moment).max() > 0.5 and np.allclose(C @ (moment + couple), 0.0, atol=1e-12)


def test_a_rank_deficient_map_says_which_directions_cannot_be_balanced():
    with pytest.raises(InputError, match="rank 3 of 6.*force along x; force along y; moment about z"):
        general_solution(contact_map(ICE, (0, 0, 0)), LOAD + [1.0, 0, 0, 0, 0, 0])
    with pytest.raises(InputError, match="rank 5 of 6.*give no moment about y"):
        general_solution(contact_map(POINTS, (0, 0, 0)), LOAD)
    with pytest.raises(InputError, match="wrench: 6 numbers are expected"):
        general_solution(contact_map(FEET, (0, 0, 0)), LOAD[:3])
    solution = general_solution(contact_map(FEET, (0, 0, 0)), LOAD)
    with pytest.raises(InputError, match="F_a: 12 numbers"):
        solution.with_arbitrary(np.zeros(6))
    with pytest.raises(InputError, match="F_int: 6 numbers"):
        solution.with_internal(np.zeros(12))


def test_3_35_the_dual_null_space_is_the_null_space_of_the_transposed_inverse():
    J = RNG.normal(size=(6, 9))
    V = dual_null_basis(J)
    assert V.shape == (9, 3) and np.allclose(pseudoinverse(J).T @ V, 0.0, atol=1e-12)
    J_c, J_m = J[:4], J[4:]
    both = np.vstack([pseudoinverse(J_c).T, pseudoinverse(J_m).T])
    assert np.allclose(both @ V, 0.0, atol=1e-12), "N*(J_R) is the intersection of N*(J_cR) and N*(J_mR)"
    assert null_basis(both).shape[1] == 3


def test_3_36_similarity_of_the_projectors_holds_for_symmetric_weights():
    A, root = RNG.normal(size=(6, 9)), RNG.normal(size=(9, 9))
    W = root @ root.T + np.eye(9)
    sharp = weighted_inverse(A, W)
    assert np.allclose(projector_from_dual(dual_projector(A, sharp), W), null_projector(A, sharp), atol=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_3_37_no_lower_priority_changes_the_constraint_force(seed):
    rng = np.random.default_rng(seed)
    J_c, J_m = rng.normal(size=(4, 9)), rng.normal(size=(2, 9))
    F_c, F_m, u = rng.normal(size=4), rng.normal(size=2), rng.normal(size=9)
    torque = prioritised_torque(J_c, J_m, F_c, F_m, u)
    read = pseudoinverse(J_c).T
    assert np.allclose(read @ torque.total, -F_c, atol=1e-12)
    assert np.allclose(read @ torque.mobility, 0.0, atol=1e-12) and np.allclose(read @ torque.null, 0.0, atol=1e-12)
    assert np.allclose(pseudoinverse(J_m).T @ torque.null, 0.0, atol=1e-12)
    assert np.abs(torque.mobility).max() > 1e-3 and np.abs(torque.null).max() > 1e-3
    assert restricted_mobility(J_c, J_m).shape == (2, 9), "printed without the transpose the term has the wrong size"
    in_statics = prioritised_torque(J_c, J_m, F_c)
    assert not in_statics.mobility.any() and not in_statics.null.any() and np.allclose(in_statics.total, -J_c.T @ F_c)


def test_3_54_levels_in_order():
    given = {"n": np.zeros(2), "ext": np.ones(2), "int": 2 * np.ones(2)}
    assert [level for level, _ in stacked_by_priority(given)] == ["ext", "int", "n"] and LEVELS == ("ext", "int", "m", "n")


@pytest.mark.parametrize("name", POSTURES)
def test_3_51_and_3_52_limbs_add_up_to_the_static_torque(name):
    posture = random_posture(name, 3)
    C = contact_map(posture.contacts, posture.p_WB)
    G_B = ss.gravity_wrench(posture.mass, (0, 0, -9.81), posture.p_WB, posture.com_W)
    sharp, F_a = pseudoinverse(C), RNG.normal(size=C.shape[1])
    N = null_projector(C)
    parts = contact_components(posture.contacts, sharp, G_B, N, F_a)
    whole = sharp @ G_B + N @ F_a
    torque = ss.gravity_torque(posture.com_jacobian, posture.mass, np.array([0, 0, -9.81]))
    slices = component_slices(posture.contacts)
    for contact in posture.contacts:
        load, internal = parts[contact.name]
        assert np.allclose(load + internal, whole[slices[contact.name]], atol=1e-12)
        J_c, _ = limb_jacobians(contact, posture.jacobian[contact.name])
        torque = torque + limb_loop_torque(J_c, load, internal).total
    J = ss.contact_jacobian(posture.contacts, [posture.jacobian[c.name] for c in posture.contacts])
    expected = ss.static_torque(ss.gravity_torque(posture.com_jacobian, posture.mass, np.array([0, 0, -9.81])), J, whole)
    assert np.allclose(torque, expected, atol=1e-10)
