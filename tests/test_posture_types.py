"""Posture types of Table 3.1: every label against velocities by finite differences, virtual work, and SciPy's null spaces."""

import numpy as np
import pytest
from scipy.linalg import null_space, orth
from torque_oracles import FOUR, generate, moved_posture, random_posture

import socp_statics as ss
from socp_statics.cli import main
from socp_statics.contacts.joint import constraint_basis, mobility_basis
from socp_statics.exceptions import InputError
from socp_statics.robots import load_robot
from socp_statics.statics.contact_maps import contact_jacobian, contact_map
from socp_statics.statics.posture_types import posture_types
from socp_statics.statics.subspaces import common, subspaces

STEP = 1e-6
ROWS = ("regular", "singular", "structural force", "internal wrench", "internal joint torque", "fully constrained", "overconstrained",
        "underconstrained", "stationary base", "stationary base and end links", "stationary end links")  # fmt: skip


@pytest.fixture(scope="module")
def hoap2():
    return load_robot("hoap2")


def maps(posture):
    """J_cB, J_mB, J_B, C_cB, C_mB in SI."""
    contacts = posture.contacts
    J = [posture.jacobian[c.name] for c in contacts]
    free = [mobility_basis(c) for c in contacts]
    everything = [np.eye(6) for _ in contacts]
    base = posture.p_WB
    return (contact_jacobian(contacts, J), contact_jacobian(contacts, J, free), contact_jacobian(contacts, J, everything),
            contact_map(contacts, base), contact_map(contacts, base, free))  # fmt: skip


def postures(hoap2):
    rng = np.random.default_rng(40)
    yield from (random_posture(hoap2, rng, FOUR[: 1 + trial % 4]) for trial in range(8))
    yield from (generate(name, hoap2) for name in ("squat", "standing", "single_stance", "rolled_feet"))


class TestTransforms:
    def test_any_two_jacobians_give_the_third(self, hoap2):
        """J_B = B_c J_cB + B_m J_mB contact by contact, so two of them fix the third."""
        for posture in postures(hoap2):
            J_c, J_m, J, _, _ = maps(posture)
            held, free = [constraint_basis(c) for c in posture.contacts], [mobility_basis(c) for c in posture.contacts]
            c = m = 0
            for k, (B_c, B_m) in enumerate(zip(held, free, strict=True)):
                own, ours, theirs = J[6 * k : 6 * k + 6], J_c[c : c + B_c.shape[1]], J_m[m : m + B_m.shape[1]]
                assert np.allclose(own, B_c @ ours + B_m @ theirs, atol=1e-14)
                assert np.allclose(ours, B_c.T @ own, atol=1e-14) and np.allclose(theirs, B_m.T @ own, atol=1e-14)
                c, m = c + B_c.shape[1], m + B_m.shape[1]

    def test_contact_maps_are_complementary(self, hoap2):
        """The base: each contact's C_c and C_m together are invertible. The joints: what one leaves out, the other holds."""
        for posture in postures(hoap2):
            _, _, _, C_c, C_m = maps(posture)
            c = m = 0
            for contact in posture.contacts:
                n_c, n_m = constraint_basis(contact).shape[1], mobility_basis(contact).shape[1]
                assert n_c + n_m == 6
                assert np.linalg.matrix_rank(np.hstack([C_c[:, c : c + n_c], C_m[:, m : m + n_m]])) == 6
                c, m = c + n_c, m + n_m

    def test_contact_velocities_by_finite_differences(self, hoap2):
        """C_cB' V_B + J_cB theta_dot is the velocity of the contacts along what they hold."""
        rng = np.random.default_rng(41)
        for posture in postures(hoap2):
            v = rng.normal(size=31)
            ends = [moved_posture(posture, s * STEP * v) for s in (1, -1)]
            J_c, _, _, C_c, _ = maps(posture)
            twist = np.concatenate([posture.R_WB @ v[:3], posture.R_WB @ v[3:6]])
            predicted, start = C_c.T @ twist + J_c @ v[6:], 0
            for contact in posture.contacts:
                a, b = (end.contacts[contact.name] for end in ends)
                spin = (a.rotation - b.rotation) @ contact.rotation.T / (2 * STEP)
                omega = np.array([spin[2, 1], spin[0, 2], spin[1, 0]])
                velocity = np.concatenate([contact.rotation.T @ (a.position - b.position) / (2 * STEP), contact.rotation.T @ omega])
                B = constraint_basis(contact)
                assert np.allclose(B.T @ velocity, predicted[start : start + B.shape[1]], atol=1e-7)
                start += B.shape[1]


class TestLabels:
    def test_dimensions_by_null_spaces_in_si(self, hoap2):
        for posture in postures(hoap2):
            J_c, J_m, J, C, C_m = maps(posture)
            types = posture_types(posture)
            n, c = J_c.shape[1], C.shape[1]
            rank = np.linalg.matrix_rank
            assert tuple(row.name for row in types.rows) == ROWS
            assert types.constraints == c and types.ranks == {"J_cB": rank(J_c, 1e-9), "J_B": rank(J, 1e-9), "C_cB": rank(C, 1e-9)}
            assert types["regular"].holds == (rank(np.hstack([J_c, C.T]), 1e-9) == rank(J_c, 1e-9)) != types["singular"].holds
            assert types["internal wrench"].dimension == c - rank(C, 1e-9)
            assert types["stationary base"].dimension == n - rank(J_c, 1e-9)
            assert types["stationary base and end links"].dimension == n - rank(J, 1e-9)
            assert types["underconstrained"].dimension == 6 - rank(C, 1e-9)
            if types["overconstrained"].holds:
                assert types["overconstrained"].dimension == n - rank(null_space(C, 1e-9).T @ J_c, 1e-9)
            meet = null_space(np.hstack([null_space(J_m, 1e-9) if len(J_m) else np.eye(n), -orth(J_c.T, 1e-9)]), 1e-9).shape[1]
            assert types["stationary end links"].dimension == meet

    def test_bases_do_what_the_labels_say(self, hoap2):
        for posture in postures(hoap2):
            J_c, J_m, J, C, _ = maps(posture)
            types = posture_types(posture)
            for twist in types["regular"].basis.T:
                assert np.linalg.norm(J_c @ np.linalg.lstsq(J_c, -C.T @ twist, rcond=1e-9)[0] + C.T @ twist) < 1e-7
            for wrench in types["structural force"].basis.T:
                F = null_space(J_c.T, 1e-9)
                used = np.linalg.lstsq(C @ F, wrench, rcond=1e-9)[0]
                assert np.allclose(C @ F @ used, wrench, atol=1e-8), "contact forces that load no motor give this base wrench"
                for twist in types["regular"].basis.T:
                    assert abs(wrench @ twist) < 1e-7 * np.linalg.norm(wrench), "and do no work on the motions that are possible"
            for F in types["internal wrench"].basis.T:
                assert np.linalg.norm(C @ F) < 1e-8 * max(1.0, np.linalg.norm(F))
            for tau in types["internal joint torque"].basis.T:
                N = J_c.T @ null_space(C, 1e-9)
                assert np.allclose(N @ np.linalg.lstsq(N, tau, rcond=1e-9)[0], tau, atol=1e-7)
            for twist in types["underconstrained"].basis.T:
                assert np.linalg.norm(C.T @ twist) < 1e-9
            for name, matrix in (("stationary base", J_c), ("stationary base and end links", J), ("stationary end links", J_m)):
                for rates in types[name].basis.T:
                    assert np.linalg.norm(matrix @ rates) < 1e-8

    def test_a_squat_is_regular_and_straight_knees_are_singular(self, hoap2):
        squat, standing = posture_types(generate("squat", hoap2)), posture_types(generate("standing", hoap2))
        assert squat["regular"].holds and not squat["singular"].holds and squat["structural force"].dimension == 0
        assert standing["singular"].holds and not standing["regular"].holds
        vertical = np.array([0, 0, 1.0, 0, 0, 0])
        twists, wrenches = standing["singular"].basis, standing["structural force"].basis
        assert twists.shape[1] == wrenches.shape[1] == 2, "up and down, and rolling on straight legs side by side"
        assert np.linalg.norm(vertical - orth(wrenches) @ (orth(wrenches).T @ vertical)) < 1e-9
        assert "structural force" in standing.names and "up to" in standing["structural force"].sentence

    def test_constraints_by_rank(self, hoap2):
        single, double = posture_types(generate("single_stance", hoap2)), posture_types(generate("squat", hoap2))
        assert single["fully constrained"].holds and single.constraints == 6 and single["fully constrained"].dimension == 25
        assert not single["overconstrained"].holds and not single["internal wrench"].holds
        assert double["overconstrained"].holds and not double["fully constrained"].holds and double.constraints == 12
        hand = posture_types(ss.pose(hoap2, {}, ["left_hand"]))
        assert hand["underconstrained"].dimension == 3 and not hand["fully constrained"].holds
        hands = posture_types(ss.pose(hoap2, {}, ["left_hand", "right_hand"]))
        assert hands.constraints == 6 and hands.ranks["C_cB"] == 5, "c = 6 alone does not make it fully constrained"
        assert hands["underconstrained"].dimension == 1 and hands["overconstrained"].holds and not hands["fully constrained"].holds

    def test_the_printed_condition_of_stationary_end_links_is_always_empty(self, hoap2):
        for posture in postures(hoap2):
            J_c, _, J, _, _ = maps(posture)
            assert common(subspaces(J).null, subspaces(J_c).row_space).shape[1] == 0

    def test_static_torques_of_self_motion_are_zero(self, hoap2):
        """tau^n of (3.78) has no part in statics: joint torques of any forces vanish on N(J_B) but for gravity's own."""
        posture = generate("squat", hoap2)
        J_c, _, J, _, _ = maps(posture)
        F = np.random.default_rng(42).normal(size=len(J_c))
        assert np.allclose(null_space(J, 1e-9).T @ (J_c.T @ F), 0.0, atol=1e-12)


class TestAsAUser:
    def test_show_prints_them(self, capsys):
        assert main(["show", "hoap2/half_squat"]) == 0
        text = capsys.readouterr().out
        assert "posture types (Table 3.1)" in text and "yes regular" in text and "no  singular" in text
        assert "e-1" not in text.split("moments about")[1].splitlines()[0], "rounding errors are no coordinates"
        assert main(["show", "hoap2/double_stance"]) == 0
        assert "moments about [0.009, -0.039, 0] m" in capsys.readouterr().out
        assert main(["show", "contacts/flat_double_stance"]) == 0
        assert "posture types" not in capsys.readouterr().out

    def test_public_function(self, hoap2):
        types = ss.posture_types(generate("squat", hoap2))
        assert "regular" in types.names and types["regular"].sentence
        with pytest.raises(KeyError):
            types["flying"]
        with pytest.raises(InputError, match="a Posture is expected, got Stance"):
            ss.posture_types(generate("squat", hoap2).stance())
