"""Virtual linkage: ranks and sizes for two to six contacts, inverses where they exist, internal forces of given solutions (D15 to D21)."""

import numpy as np
import pytest

from socp_statics.distribution.general_solution import general_solution
from socp_statics.distribution.generalized_inverses import pseudoinverse
from socp_statics.distribution.grasp_description import (
    contact_wrenches_of,
    grasp_description,
    internal_wrench,
    inverse_in_blocks,
    net_internal_wrench,
)
from socp_statics.distribution.virtual_linkage import (
    force_map,
    internal_contact_forces,
    internal_moments,
    linkage_matrix,
    member_forces,
    members,
    moment_map,
    point_contact_forces,
)
from socp_statics.exceptions import InputError

RNG = np.random.default_rng(7)
GENERAL = {p: RNG.normal(size=(p, 3)) for p in range(2, 7)}
RANKS = {2: 1, 3: 3, 4: 6, 5: 9, 6: 12}
POINT = np.array([0.1, -0.2, 0.3])


@pytest.mark.parametrize("p", GENERAL)
def test_table_of_d18_ranks_and_sizes(p):
    r = GENERAL[p]
    V, T_f, G = linkage_matrix(r), force_map(r, POINT), grasp_description(r, POINT)
    pairs = p * (p - 1) // 2
    assert V.shape == (3 * p, pairs) and np.linalg.matrix_rank(V, tol=1e-9) == RANKS[p]
    assert 3 * p - np.linalg.matrix_rank(T_f, tol=1e-9) == RANKS[p]
    assert G.shape == (6 + pairs + 3 * p, 6 * p), "the rows of the zero wrench count"
    whole = np.hstack([T_f, moment_map(p)])
    assert 6 * p - np.linalg.matrix_rank(whole, tol=1e-9) == 6 * p - 6


def test_degenerate_places_lose_rank():
    coplanar = np.array([[0.3, 0.2, 0], [0.3, -0.2, 0], [-0.3, 0.2, 0], [-0.3, -0.25, 0]])
    collinear = np.array([[0.0, 0, 0], [0.1, 0, 0], [0.4, 0, 0]])
    assert np.linalg.matrix_rank(linkage_matrix(coplanar), tol=1e-9) == 5
    assert np.linalg.matrix_rank(linkage_matrix(collinear), tol=1e-9) == 2


@pytest.mark.parametrize("p", GENERAL)
def test_3_43_and_3_44_member_forces_are_internal_and_ordered(p):
    r = GENERAL[p]
    V = linkage_matrix(r)
    assert np.abs(force_map(r, POINT) @ V).max() < 1e-14
    for column, (i, j) in enumerate(members(p)):
        f = internal_contact_forces(V, np.eye(V.shape[1])[column]).reshape(p, 3)
        assert f[i] @ (r[j] - r[i]) > 0 and f[j] @ (r[i] - r[j]) > 0, "a positive member pulls its contacts together"
        assert not np.delete(f, [i, j], axis=0).any() and np.isclose(np.linalg.norm(f[i]), 1.0)


def test_3_43_the_order_of_four_contacts():
    assert [(i + 1, j + 1) for i, j in members(4)] == [(1, 2), (1, 3), (1, 4), (2, 3), (2, 4), (3, 4)]


@pytest.mark.parametrize("p", [3, 4, 5, 6])
def test_3_42_point_forces_balance_and_their_members_see_the_internal_part_only(p):
    r, wrench, f_a = GENERAL[p], RNG.normal(size=6), RNG.normal(size=3 * p)
    f = point_contact_forces(r, POINT, wrench, f_a)
    assert np.allclose(force_map(r, POINT) @ f, wrench, atol=1e-12)
    least = point_contact_forces(r, POINT, wrench)
    assert np.abs(member_forces(r, least)).max() < 1e-12, "the least forces carry the load without internal force"
    assert np.allclose(linkage_matrix(r) @ member_forces(r, f), f - least, atol=1e-11)


@pytest.mark.parametrize("p", [2, 3, 4])
def test_internal_force_of_a_given_solution_is_found_again(p):
    r = GENERAL[p]
    f_int = RNG.normal(size=p * (p - 1) // 2)
    wrench = force_map(r, POINT) @ RNG.normal(size=3 * p)
    f = point_contact_forces(r, POINT, wrench) + internal_contact_forces(linkage_matrix(r), f_int)
    assert np.allclose(member_forces(r, f.reshape(p, 3)), f_int, atol=1e-11)


def test_3_45_moments_are_their_own_internal_moments():
    m = RNG.normal(size=9)
    m_int, m_e = internal_moments(m)
    assert np.array_equal(m_int, m) and np.allclose(m_e, m[:3] + m[3:6] + m[6:])
    assert np.allclose((moment_map(3) @ m)[3:], m_e) and not (moment_map(3) @ m)[:3].any()


@pytest.mark.parametrize("p", GENERAL)
def test_3_46_to_3_48_null_space_wrenches_to_internal_ones(p):
    r = GENERAL[p]
    whole = np.hstack([force_map(r, POINT), moment_map(p)])
    x = general_solution(whole, np.zeros(6)).basis @ RNG.normal(size=6 * p - 6)
    f_n, m_n = x[: 3 * p], x[3 * p :]
    assert np.abs(net_internal_wrench(r, POINT, f_n, m_n)).max() < 1e-13
    net, inside = internal_wrench(grasp_description(r, POINT), f_n, m_n)
    assert np.abs(net).max() < 1e-13 and np.array_equal(inside.moments, m_n)
    assert np.allclose(inside.forces, pseudoinverse(linkage_matrix(r)) @ f_n, atol=1e-13)


@pytest.mark.parametrize("p", [3, 4])
def test_3_49_and_3_50_the_corrected_blocks_are_the_inverse(p):
    r = GENERAL[p]
    G, blocks = grasp_description(r, POINT), inverse_in_blocks(r, POINT)
    assert G.shape[0] == G.shape[1]
    assert np.allclose(G @ blocks, np.eye(6 * p), atol=1e-10) and np.allclose(blocks @ G, np.eye(6 * p), atol=1e-10)
    printed = blocks.copy()
    printed[3 * p :, :6] = pseudoinverse(moment_map(p))
    assert not np.allclose(G @ printed, np.eye(6 * p), atol=1e-3)
    f_int, m_int = RNG.normal(size=p * (p - 1) // 2), RNG.normal(size=3 * p)
    found = contact_wrenches_of(G, f_int, m_int)
    assert found.exact and np.allclose(np.concatenate([found.forces, found.moments]), blocks @ np.r_[np.zeros(6), f_int, m_int], atol=1e-9)


@pytest.mark.parametrize("p", [2, 5, 6])
def test_3_49_elsewhere_the_pseudoinverse_says_what_it_misses(p):
    r = GENERAL[p]
    G = grasp_description(r, POINT)
    found = contact_wrenches_of(G, RNG.normal(size=p * (p - 1) // 2), RNG.normal(size=3 * p))
    assert not found.exact and np.abs(found.missed).max() > 1e-3
    attainable = internal_wrench(
        G, *np.split(general_solution(np.hstack([force_map(r, POINT), moment_map(p)]), np.zeros(6)).basis[:, 0], 2)
    )
    again = contact_wrenches_of(G, attainable[1].forces, attainable[1].moments)
    assert again.exact and np.abs(net_internal_wrench(r, POINT, again.forces, again.moments)).max() < 1e-10


def test_two_feet_have_seven_rows_for_six_internal_components():
    r = np.array([[0, 0.1, 0], [0, -0.1, 0.0]])
    G = grasp_description(r, (0, 0, 0))
    assert G.shape == (13, 12) and G[6:].shape[0] == 7
    assert 12 - np.linalg.matrix_rank(np.hstack([force_map(r, (0, 0, 0)), moment_map(2)])) == 6


def test_wrong_sizes_and_places_are_named():
    with pytest.raises(InputError, match="at the same place"):
        linkage_matrix(np.zeros((2, 3)))
    with pytest.raises(InputError, match="at least two contacts"):
        linkage_matrix(np.zeros((1, 3)))
    with pytest.raises(InputError, match="shape \\(p, 3\\)"):
        force_map(np.zeros(3), POINT)
    with pytest.raises(InputError, match="6 member forces"):
        internal_contact_forces(linkage_matrix(GENERAL[4]), np.zeros(5))
    with pytest.raises(InputError, match="m_int: 9 numbers"):
        contact_wrenches_of(grasp_description(GENERAL[3], POINT), np.zeros(3), np.zeros(8))
