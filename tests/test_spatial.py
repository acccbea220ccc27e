"""Wrenches and twists between points and frames: (3.1)-(3.4) as corrected."""

from __future__ import annotations

import numpy as np
import pytest

from socp_statics.spatial import moment_about, skew, twist_to_frame, wrench_to_frame, wrench_translation

RNG = np.random.default_rng(7)


def rotation(rng):
    """A random rotation."""
    Q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return Q * np.linalg.det(Q)


CASES = [(rotation(RNG), RNG.normal(size=3), RNG.normal(size=6), RNG.normal(size=6)) for _ in range(10)]


@pytest.mark.parametrize("shape", [(3,), (5, 3), (2, 4, 3)])
def test_skew_is_the_cross_product(shape):
    r, a = RNG.normal(size=(2, *shape))
    S = skew(r)
    assert S.shape == (*shape, 3)
    np.testing.assert_allclose(np.einsum("...ij,...j->...i", S, a), np.cross(r, a), atol=1e-15)
    np.testing.assert_array_equal(S, -np.swapaxes(S, -1, -2))


def test_moment_of_a_force_about_another_point():
    np.testing.assert_array_equal(moment_about([0, 0, 0], [1, 0, 0], [0, 0, 2]), [0, -2, 0])
    np.testing.assert_array_equal(moment_about([1, 0, 0], [1, 0, 0], [0, 0, 2], [3, 4, 5]), [3, 4, 5])


def test_moments_of_arrays():
    o, p, f, m = RNG.normal(size=(4, 6, 3))
    together = moment_about(o, p, f, m)
    np.testing.assert_allclose(together, [moment_about(*row) for row in zip(o, p, f, m, strict=True)], atol=1e-15)
    np.testing.assert_allclose(moment_about(o[0], p, f), [moment_about(o[0], b, c) for b, c in zip(p, f, strict=True)], atol=1e-15)


@pytest.mark.parametrize(("R", "r", "wrench", "twist"), CASES)
def test_translation_moves_the_moment_point(R, r, wrench, twist):
    # r = r_O - r_P with P at the origin: (3.4) agrees with (3.1), -S(r_OP) f + m_P.
    moved = wrench_translation(r) @ wrench
    np.testing.assert_array_equal(moved[:3], wrench[:3])
    np.testing.assert_allclose(moved[3:], moment_about(r, np.zeros(3), wrench[:3], wrench[3:]), atol=1e-14)
    np.testing.assert_allclose(moved[3:], -skew(r) @ wrench[:3] + wrench[3:], atol=1e-14)


@pytest.mark.parametrize(("R", "r", "wrench", "twist"), CASES)
def test_frame_change_turns_the_translated_wrench(R, r, wrench, twist):
    moved = wrench_translation(r) @ wrench
    np.testing.assert_allclose(wrench_to_frame(R, r) @ wrench, [*(R @ moved[:3]), *(R @ moved[3:])], atol=1e-14)
    # (3.3) written with the arm in B: translation after rotation.
    np.testing.assert_allclose(wrench_to_frame(R, r), wrench_translation(R @ r) @ np.kron(np.eye(2), R), atol=1e-14)


@pytest.mark.parametrize(("R", "r", "wrench", "twist"), CASES)
def test_the_printed_sign_moves_the_moment_the_wrong_way(R, r, wrench, twist):
    # D2: (3.3) prints -S(r_OP)' = +S(r_OP) in the lower left block, against (3.1) and (3.4).
    printed = np.eye(6)
    printed[3:, :3] = -skew(R @ r).T
    printed = printed @ np.kron(np.eye(2), R)
    wanted = R @ moment_about(r, np.zeros(3), wrench[:3], wrench[3:])
    np.testing.assert_allclose((wrench_to_frame(R, r) @ wrench)[3:], wanted, atol=1e-14)
    assert np.abs((printed @ wrench)[3:] - wanted).max() > 1e-3
    assert abs((printed @ wrench) @ (twist_to_frame(R, r) @ twist) - wrench @ twist) > 1e-3


@pytest.mark.parametrize(("R", "r", "wrench", "twist"), CASES)
def test_power_does_not_depend_on_point_or_frame(R, r, wrench, twist):
    # D1: B_F_O = X^-T W_F_P with B_V_O = X W_V_P, the same frames on both sides.
    X = twist_to_frame(R, r)
    assert (X @ twist) @ (wrench_to_frame(R, r) @ wrench) == pytest.approx(twist @ wrench, abs=1e-12)
    np.testing.assert_allclose(wrench_to_frame(R, r), np.linalg.inv(X).T, atol=1e-13)
    # As printed in (3.2), frames mixed: the wrench that belongs to the other frame does not keep the power.
    assert abs((X @ twist) @ (X.T @ wrench) - twist @ wrench) > 1e-3


@pytest.mark.parametrize(("R", "r", "wrench", "twist"), CASES)
def test_twists_are_velocities_of_points_of_a_body(R, r, wrench, twist):
    v, w = twist[:3], twist[3:]
    np.testing.assert_allclose(twist_to_frame(R, r) @ twist, [*(R @ (v + np.cross(w, r))), *(R @ w)], atol=1e-14)


@pytest.mark.parametrize("transform", [wrench_to_frame, twist_to_frame])
def test_frame_changes_form_a_group(transform):
    (R1, r1, *_), (R2, r2, *_) = CASES[:2]
    # From W at P to B at O, then on to A at Q; the second arm is given in the axes it starts from.
    chained = transform(R2, R1 @ r2) @ transform(R1, r1)
    np.testing.assert_allclose(chained, transform(R2 @ R1, r1 + r2), atol=1e-14)
    np.testing.assert_allclose(transform(R1.T, -R1 @ r1) @ transform(R1, r1), np.eye(6), atol=1e-14)
    np.testing.assert_array_equal(transform(np.eye(3), np.zeros(3)), np.eye(6))
    assert np.linalg.det(transform(R1, r1)) == pytest.approx(1.0)


def test_translations_add():
    a, b = RNG.normal(size=(2, 3))
    np.testing.assert_allclose(wrench_translation(a) @ wrench_translation(b), wrench_translation(a + b), atol=1e-15)
