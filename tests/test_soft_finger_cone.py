"""Soft-finger cones in R^4: projection, distance, duality, the linearised forms of the contract, and what they reduce to."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import nnls

from socp_statics.cones import ConeChoice, EllipticCone, FrictionCone, FrictionPyramid, SoftFingerCone
from socp_statics.exceptions import InputError

KINDS = ("inscribed", "circumscribed")
SHAPES = ("elliptic", "box")
CHOICES = [ConeChoice(), *(ConeChoice(kind, sides, 0.3) for kind in KINDS for sides in (3, 4, 7))]
FORMS = [(shape, choice) for shape in SHAPES for choice in CHOICES]

# Squares of smaller components underflow in the checks themselves.
component = st.floats(-1e3, 1e3).map(lambda x: x if abs(x) > 1e-60 else 0.0)
wrench = st.tuples(component, component, component, component)
coefficient = st.floats(0.01, 3.0)
choices = st.one_of(st.just(ConeChoice()), st.builds(ConeChoice, st.sampled_from(KINDS), st.integers(3, 7), st.floats(-7.0, 7.0)))
any_cone = st.builds(SoftFingerCone, coefficient, coefficient, st.sampled_from(SHAPES), choices)


def wrenches_everywhere(cone: SoftFingerCone, count: int = 40) -> np.ndarray:
    """Wrenches in all directions, among them some next to the boundary, on edges and symmetry planes, in the polar cone, and the apex."""
    rng = np.random.default_rng(0)
    rays = cone.generators(6)
    around = rng.normal(size=(count, 4))
    mixed = rng.exponential(size=(count, len(rays))) * (rng.random((count, len(rays))) < 0.2) @ rays
    polar = -cone.dual().project(rng.normal(size=(count, 4)))
    planes = np.vstack([around * mask for mask in ([1, 1, 1, 0], [0, 0, 1, 1], [0, 0, 1, 0], [1, 1, 0, 1], [1, 1, 0, 0], [0, 0, 0, 1])])
    return np.vstack([around, mixed, mixed + 1e-7 * around, polar, polar + 1e-7 * around, planes, rays, -rays, np.zeros((1, 4))])


def assert_moreau(cone: SoftFingerCone, f: np.ndarray) -> None:
    """x = P_K(x) + P_K°(x) with orthogonal parts, each in its own cone."""
    size = np.maximum(np.linalg.norm(f, axis=1), 1e-300)
    projected, rest = cone.project(f), -cone.dual().project(-f)
    assert np.all(np.linalg.norm(f - projected - rest, axis=1) <= 1e-12 * size)
    assert np.all(np.abs(np.sum(projected * rest, axis=1)) <= 1e-12 * size**2)
    assert np.all(cone.distance(projected) <= 1e-12 * size)
    assert np.all(cone.dual().distance(-rest) <= 1e-12 * size)
    outside = cone.distance(f) > 0.0
    assert np.all(np.abs(cone.distance(f) - np.linalg.norm(rest, axis=1))[outside] <= 1e-12 * size[outside])


def defining_excess(cone: SoftFingerCone, f: np.ndarray) -> np.ndarray:
    """The largest violated inequality, straight from (3.11) and the contract."""
    f_t, f_n, m_z = np.hypot(f[:, 0], f[:, 1]), f[:, 2], np.abs(f[:, 3])
    if cone.choice.is_exact and cone.shape == "box":
        return np.max([f_t - cone.mu * f_n, -f_n, m_z - cone.gamma * f_n], axis=0)
    if cone.choice.is_exact:
        return np.sqrt(f_t**2 + (cone.mu / cone.gamma * m_z) ** 2) - cone.mu * f_n
    angles = cone.choice.heading + 2.0 * math.pi * np.arange(cone.choice.sides) / cone.choice.sides
    pushed = (np.outer(f[:, 0], np.cos(angles)) + np.outer(f[:, 1], np.sin(angles))).max(axis=1)
    inscribed = cone.mu * math.cos(math.pi / cone.choice.sides)
    if cone.choice.kind == "inscribed" and cone.shape == "elliptic":
        return pushed / inscribed + m_z / cone.gamma - f_n
    return np.maximum(pushed - (inscribed if cone.choice.kind == "inscribed" else cone.mu) * f_n, m_z - cone.gamma * f_n)


@settings(max_examples=50, deadline=None)
@given(any_cone, st.lists(wrench, min_size=1, max_size=4))
def test_a_vector_is_the_sum_of_its_projections_on_the_cone_and_on_its_polar(cone, wrenches):
    assert_moreau(cone, np.array(wrenches))


@pytest.mark.parametrize(("shape", "choice"), FORMS)
@pytest.mark.parametrize(("mu", "gamma"), [(0.5, 0.02), (1.2, 1.2), (0.05, 2.0), (0.0, 0.1)])
def test_projection_is_optimal_at_edges_faces_apex_and_polar_cone(mu, gamma, shape, choice):
    cone = SoftFingerCone(mu, gamma, shape, choice)
    assert_moreau(cone, wrenches_everywhere(cone))


@pytest.mark.parametrize(("mu", "gamma"), [(1e-5, 0.3), (0.3, 1e-5), (300.0, 0.01), (1e-3, 1e3), (1e-70, 1e70)])
def test_the_elliptic_projection_stays_optimal_for_extreme_coefficients(mu, gamma):
    cone = SoftFingerCone(mu, gamma)
    assert_moreau(cone, wrenches_everywhere(cone))


@pytest.mark.parametrize(("shape", "choice"), FORMS)
def test_contains_says_what_the_contract_says(shape, choice):
    cone = SoftFingerCone(0.6, 0.4, shape, choice)
    f = np.random.default_rng(0).normal(size=(3000, 4)) * [0.4, 0.4, 1.0, 0.3]
    inside = defining_excess(cone, f) <= 0.0
    assert 50 < inside.sum() < 2900
    assert np.array_equal(cone.contains(f), inside)


@pytest.mark.parametrize(("shape", "choice"), [form for form in FORMS if not form[1].is_exact])
def test_distance_outside_a_linearised_cone_is_that_of_non_negative_least_squares_on_its_rays(shape, choice):
    cone = SoftFingerCone(0.6, 0.2, shape, choice)
    f = np.random.default_rng(1).normal(size=(25, 4))
    f = f[cone.distance(f) > 0.0]
    assert len(f) > 15
    assert cone.distance(f) == pytest.approx([nnls(cone.generators().T, row)[1] for row in f], abs=1e-12)


@pytest.mark.parametrize("shape", SHAPES)
def test_distance_outside_an_exact_cone_is_bracketed_by_least_squares_on_a_dense_inner_and_an_outer_cone(shape):
    cone = SoftFingerCone(0.6, 0.2, shape)
    f = np.random.default_rng(2).normal(size=(12, 4))
    f = f[cone.distance(f) > 0.0]
    rays = cone.generators(48)
    # Rays on the sphere around the cross-section, pushed out until their hull holds all of it (half steps of pi / 48 at most).
    outer = rays * [1.01, 1.01, 1.0, 1.01]
    for row, distance in zip(f, cone.distance(f), strict=True):
        assert nnls(outer.T, row)[1] - 1e-12 <= distance <= nnls(rays.T, row)[1] + 1e-12


@settings(max_examples=40, deadline=None)
@given(coefficient, coefficient, st.floats(0.0, 1.0), st.one_of(st.just(0.0), st.just(math.pi / 2), st.floats(0.0, math.pi / 2)))
def test_depth_inside_the_elliptic_cone_is_the_least_over_its_supporting_planes(mu, gamma, fill, latitude):
    tangential, torsion = fill * math.cos(latitude), fill * math.sin(latitude)
    depth = -SoftFingerCone(mu, gamma).distance([0.6 * mu * tangential, 0.8 * mu * tangential, 1.0, gamma * torsion])

    def to_plane(angle: np.ndarray) -> np.ndarray:
        slope = np.sqrt(1.0 + (np.cos(angle) / mu) ** 2 + (np.sin(angle) / gamma) ** 2)
        return (1.0 - tangential * np.cos(angle) - torsion * np.sin(angle)) / slope

    angles = np.linspace(-0.1, math.pi / 2 + 0.1, 1001)
    for _ in range(3):
        best, step = angles[np.argmin(to_plane(angles))], angles[1] - angles[0]
        angles = np.linspace(best - 2.0 * step, best + 2.0 * step, 1001)
    assert depth == pytest.approx(to_plane(angles).min(), abs=1e-12)


def test_depth_on_the_axis_is_that_of_the_narrower_direction():
    for mu, gamma in np.random.default_rng(8).uniform(0.01, 2.0, size=(100, 2)):
        narrow = min(mu, gamma)
        assert SoftFingerCone(mu, gamma).distance([0.0, 0.0, 1.0, 0.0]) == pytest.approx(-narrow / math.hypot(1.0, narrow), abs=1e-14)


@pytest.mark.parametrize(("shape", "choice"), FORMS)
def test_a_ball_of_the_inner_distance_fits_in_the_cone_and_touches_it(shape, choice):
    rng = np.random.default_rng(3)
    cone = SoftFingerCone(0.6, 0.3, shape, choice)
    rays = cone.generators(6)
    directions = rng.normal(size=(4000, 4))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    for centre in rng.random((6, 6)) @ rays[rng.integers(0, len(rays), 6)] + [0.0, 0.0, 1.0, 0.0]:
        depth = -cone.distance(centre)
        assert depth > 0.0
        assert np.all(defining_excess(cone, centre + (1.0 - 1e-9) * depth * directions) <= 0.0)
        assert np.any(defining_excess(cone, centre + 1.1 * depth * directions) > 0.0)


@settings(max_examples=40, deadline=None)
@given(any_cone, wrench, wrench)
def test_a_cone_and_its_dual_never_meet_at_an_obtuse_angle_and_the_dual_separates(cone, a, b):
    size = 1.0 + np.linalg.norm(a) * np.linalg.norm(b)
    assert cone.project(a) @ cone.dual().project(b) >= -1e-11 * size
    if cone.distance(a) > 1e-9 * (1.0 + np.linalg.norm(a)):
        separator = cone.project(a) - a
        assert cone.dual().contains(separator, 1e-11 * np.linalg.norm(a)) and separator @ np.array(a) < 0.0


def test_the_dual_cones_have_their_closed_forms():
    v = np.random.default_rng(4).normal(size=(500, 4))
    v_t, v_n, w = np.hypot(v[:, 0], v[:, 1]), v[:, 2], np.abs(v[:, 3])
    assert np.array_equal(SoftFingerCone(0.5, 0.2, "box").dual().contains(v), v_n >= 0.5 * v_t + 0.2 * w)
    assert np.array_equal(SoftFingerCone(0.5, 0.2).dual().contains(v), v_n >= np.hypot(0.5 * v_t, 0.2 * w))
    assert SoftFingerCone(0.5, 0.25).dual() == EllipticCone(2.0, 4.0)


@pytest.mark.parametrize(("shape", "choice"), FORMS)
def test_without_torsional_moment_the_cone_is_that_of_a_point_contact(shape, choice):
    f = np.random.default_rng(5).normal(size=(300, 3))
    point = FrictionCone(0.7) if choice.is_exact else FrictionPyramid(0.7, choice)
    assert np.array_equal(SoftFingerCone(0.7, 0.1, shape, choice).contains(np.column_stack([f, np.zeros(300)])), point.contains(f))


@pytest.mark.parametrize(("shape", "choice"), FORMS)
def test_without_tangential_force_the_moment_is_at_most_gamma_times_the_normal_force(shape, choice):
    m_z = np.random.default_rng(6).uniform(-0.3, 0.3, size=300)
    wrenches = np.column_stack([np.zeros((300, 2)), np.ones(300), m_z])
    assert np.array_equal(SoftFingerCone(0.7, 0.1, shape, choice).contains(wrenches), np.abs(m_z) <= 0.1)
    assert np.array_equal(SoftFingerCone(0.7, 0.1, shape, choice).contains(-wrenches), np.zeros(300, dtype=bool))


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("sides", [3, 4, 5, 8, 33])
def test_inscribed_lies_in_exact_lies_in_circumscribed(shape, sides):
    f = np.random.default_rng(sides).normal(size=(400, 4)) * [0.5, 0.5, 1.0, 0.2] + [0.0, 0.0, 1.0, 0.0]
    exact = SoftFingerCone(0.6, 0.2, shape)
    inner, outer = (SoftFingerCone(0.6, 0.2, shape, ConeChoice(kind, sides, 1.0)) for kind in KINDS)
    assert np.all(inner.distance(f) >= exact.distance(f) - 1e-13)
    assert np.all(exact.distance(f) >= outer.distance(f) - 1e-13)
    assert np.abs(exact.distance(inner.generators())).max() < 1e-14


def test_the_elliptic_cone_lies_in_the_box_and_touches_it_where_one_part_vanishes():
    f = np.random.default_rng(7).normal(size=(500, 4))
    elliptic, box = SoftFingerCone(0.6, 0.2), SoftFingerCone(0.6, 0.2, "box")
    assert np.all(box.distance(f) <= elliptic.distance(f) + 1e-14)
    assert box.contains([0.6, 0.0, 1.0, 0.2]) and not elliptic.contains([0.6, 0.0, 1.0, 0.2])
    assert [cone.contains(row) for cone in (elliptic, box) for row in ([0.6, 0, 1, 0], [0, 0, 1, 0.2])] == [True] * 4


@pytest.mark.parametrize(("shape", "choice"), [form for form in FORMS if not form[1].is_exact])
def test_rays_lie_on_at_least_three_independent_faces_and_inside_the_others(shape, choice):
    cone = SoftFingerCone(0.6, 0.2, shape, choice)
    use = cone.generators() @ cone.faces().T
    assert use.max() <= 1e-14
    for row in np.abs(use) < 1e-14:
        assert np.linalg.matrix_rank(cone.faces()[row]) == 3
    for column in (np.abs(use) < 1e-14).T:
        assert np.linalg.matrix_rank(cone.generators()[column]) == 3
    assert np.array_equal(cone.generators()[:, 2], np.ones(len(use)))


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("sides", [3, 4, 9])
def test_generators_of_an_exact_cone_lie_on_its_boundary_and_hold_the_inscribed_form(shape, sides):
    cone = SoftFingerCone(0.6, 0.2, shape)
    rays = cone.generators(sides, 0.3)
    assert np.abs(cone.distance(rays)).max() < 1e-14
    assert np.array_equal(rays[:, 2], np.ones(len(rays)))
    for ray in SoftFingerCone(0.6, 0.2, shape, ConeChoice("inscribed", sides, 0.3)).generators():
        assert np.linalg.norm(rays - ray, axis=1).min() < 1e-15


@pytest.mark.parametrize(("shape", "choice"), FORMS)
def test_without_friction_only_the_normal_force_is_left(shape, choice):
    cone = SoftFingerCone(0.0, 0.1, shape, choice)
    f = np.array([[0, 0, 2, 0], [0, 0, -2, 0], [0, 0, 1, 0.1], [3, 4, 1, 0], [0, 0, 0, 0]], dtype=float)
    assert cone.distance(f) == pytest.approx([0.0, 2.0, 0.1, 5.0, 0.0], abs=1e-15)
    assert cone.dual().distance(f) == pytest.approx([-2.0, 2.0, -1.0, -1.0, 0.0], abs=1e-15)
    assert np.array_equal(cone.generators(), [[0.0, 0.0, 1.0, 0.0]])


def test_the_exact_cones_have_no_faces():
    for mu in (0.0, 0.5):
        with pytest.raises(InputError) as caught:
            SoftFingerCone(mu, 0.1).faces()
        assert caught.value.field == "cone"


@pytest.mark.parametrize(("shape", "choice"), FORMS)
def test_a_component_that_is_not_finite_is_never_inside(shape, choice):
    cone = SoftFingerCone(0.5, 0.1, shape, choice)
    for at, wrong in product(range(4), (math.nan, math.inf, -math.inf)):
        f = np.array([0.0, 0.0, 1.0, 0.0])
        f[at] = wrong
        assert cone.contains(f, tolerance=1e9) is False
        assert math.isnan(cone.distance(f)) and np.all(np.isnan(cone.project(f)))


@pytest.mark.parametrize("wrong", [[0.0, 0.0, 1.0], np.zeros((4, 3)), np.zeros((1, 1, 4)), 0.0, "abcd"])
def test_a_wrench_of_the_wrong_size_is_refused_by_name(wrong):
    for cone in (SoftFingerCone(0.5, 0.1), SoftFingerCone(0.5, 0.1, "box"), SoftFingerCone(0.5, 0.1, "box", ConeChoice("inscribed"))):
        for question in (cone.contains, cone.distance, cone.project):
            with pytest.raises(InputError, match="force") as caught:
                question(wrong)
            assert caught.value.field == "force"


@pytest.mark.parametrize(
    ("stated", "field"),
    [({"mu": value}, "friction") for value in (-0.1, math.nan)]
    + [({"gamma": value}, "torsional_friction") for value in (0.0, -1.0, math.inf)]
    + [({"shape": "round"}, "shape"), ({"shape": None}, "shape"), ({"choice": "exact"}, "cone")],
)
def test_a_wrong_statement_is_refused_by_name(stated, field):
    with pytest.raises(InputError, match=field) as caught:
        SoftFingerCone(**{"mu": 0.5, "gamma": 0.1, **stated})
    assert caught.value.field == field
