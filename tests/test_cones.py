"""Friction cones and pyramids in R^3: projection, distance, duality and the pyramids' side of the exact cone."""

from __future__ import annotations

import math
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog, minimize_scalar, nnls

from socp_statics.cones import ConeChoice, ConvexCone, FrictionCone, FrictionPyramid, PolyhedralCone
from socp_statics.exceptions import InputError

KINDS = ("inscribed", "circumscribed")
SIDES = (3, 4, 5, 6, 7, 8, 16, 33)

# Squares of smaller components underflow in the checks themselves.
component = st.floats(-1e3, 1e3).map(lambda x: x if abs(x) > 1e-60 else 0.0)
force = st.tuples(component, component, component)
friction = st.one_of(st.just(0.0), st.floats(1e-3, 10.0))
pyramid_choice = st.builds(ConeChoice, st.sampled_from(KINDS), st.integers(3, 12), st.floats(-7.0, 7.0))
any_cone = st.one_of(st.builds(FrictionCone, friction), st.builds(FrictionPyramid, friction, pyramid_choice))


def forces_everywhere(cone: ConvexCone, seed: int = 0, count: int = 40) -> np.ndarray:
    """Forces in all directions, among them some next to the boundary, on edges, in the polar cone, and the apex."""
    rng = np.random.default_rng(seed)
    rays = cone.generators()
    mixed = rng.exponential(size=(count, len(rays))) * (rng.random((count, len(rays))) < 0.3) @ rays
    around = rng.normal(size=(count, cone.dimension))
    polar = -cone.dual().project(rng.normal(size=(count, cone.dimension)))
    return np.vstack([around, mixed, mixed + 1e-7 * around, polar, polar + 1e-7 * around, rays, -rays, np.zeros((1, cone.dimension))])


def assert_moreau(cone: ConvexCone, f: np.ndarray) -> None:
    """x = P_K(x) + P_K°(x) with orthogonal parts, each in its own cone."""
    size = np.maximum(np.linalg.norm(f, axis=1), 1e-300)
    projected, rest = cone.project(f), -cone.dual().project(-f)
    assert np.all(np.linalg.norm(f - projected - rest, axis=1) <= 1e-12 * size)
    assert np.all(np.abs(np.sum(projected * rest, axis=1)) <= 1e-12 * size**2)
    assert np.all(cone.distance(projected) <= 1e-12 * size)
    assert np.all(cone.dual().distance(-rest) <= 1e-12 * size)
    outside = cone.distance(f) > 0.0
    assert np.allclose(cone.distance(f)[outside], np.linalg.norm(rest, axis=1)[outside], rtol=0.0, atol=1e-12 * size.max())


@settings(max_examples=80, deadline=None)
@given(any_cone, st.lists(force, min_size=1, max_size=4))
def test_a_vector_is_the_sum_of_its_projections_on_the_cone_and_on_its_polar(cone, forces):
    assert_moreau(cone, np.array(forces))


@pytest.mark.parametrize("mu", [0.0, 1e-8, 0.01, 0.4, 1.0, 30.0])
@pytest.mark.parametrize("sides", [None, 3, 4, 7, 33])
def test_projection_is_optimal_at_edges_faces_apex_and_polar_cone(mu, sides):
    cone = FrictionCone(mu) if sides is None else FrictionPyramid(mu, ConeChoice("inscribed", sides, 0.2))
    assert_moreau(cone, forces_everywhere(cone))


@pytest.mark.parametrize("sides", SIDES)
@pytest.mark.parametrize("kind", KINDS)
def test_distance_outside_a_pyramid_is_that_of_non_negative_least_squares_on_its_edges(kind, sides):
    cone = FrictionPyramid(0.45, ConeChoice(kind, sides, 0.1))
    f = np.random.default_rng(sides).normal(size=(40, 3))
    f = f[cone.distance(f) > 0.0]
    assert len(f) > 10
    expected = [nnls(cone.generators().T, row)[1] for row in f]
    assert cone.distance(f) == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("mu", [0.1, 0.5, 2.0])
def test_distance_to_the_friction_cone_is_the_least_distance_to_its_boundary_rays(mu):
    cone = FrictionCone(mu)

    def along_ray(angle: float, f: np.ndarray) -> float:
        ray = np.array([mu * math.cos(angle), mu * math.sin(angle), 1.0])
        return float(np.linalg.norm(f - max(f @ ray, 0.0) / (ray @ ray) * ray))

    for f in np.random.default_rng(7).normal(size=(15, 3)):
        middle = math.atan2(f[1], f[0])
        least = minimize_scalar(along_ray, args=(f,), bounds=(middle - 1.0, middle + 1.0), method="bounded", options={"xatol": 1e-9}).fun
        assert abs(cone.distance(f)) == pytest.approx(least, abs=1e-12)
        assert (cone.distance(f) <= 0.0) == (math.hypot(f[0], f[1]) <= mu * f[2])


@pytest.mark.parametrize("cone", [FrictionCone(0.6), *(FrictionPyramid(0.6, ConeChoice(kind, 5)) for kind in KINDS)])
def test_a_ball_of_the_inner_distance_fits_in_the_cone_and_touches_it(cone):
    rng = np.random.default_rng(3)
    f = (rng.random((20, 8)) @ cone.generators()[rng.integers(0, len(cone.generators()), 8)]) + [0.0, 0.0, 1.0]
    depth = -cone.distance(f)
    assert np.all(depth > 0.0)
    directions = rng.normal(size=(500, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    for centre, radius in zip(f, depth, strict=True):
        assert np.all(cone.distance(centre + (1.0 - 1e-12) * radius * directions) <= 0.0)
        assert cone.distance(centre + 1.05 * radius * directions).max() > 0.0


def test_known_distances_of_the_friction_cone():
    cone = FrictionCone(1.0)
    f = [[0, 0, 1], [1, 0, 0], [0, 0, -2], [3, 4, 5], [0, 0, 0], [3, 4, -5], [3, 4, -6]]
    expected = [-1 / math.sqrt(2), 1 / math.sqrt(2), 2.0, 0.0, 0.0, math.sqrt(50), math.sqrt(61)]
    assert cone.distance(f) == pytest.approx(expected, abs=1e-15)
    assert cone.project([1.0, 0.0, 0.0]) == pytest.approx([0.5, 0.0, 0.5])


@settings(max_examples=60, deadline=None)
@given(any_cone, force, force)
def test_a_cone_and_its_dual_never_meet_at_an_obtuse_angle(cone, a, b):
    f, v = cone.project(a), cone.dual().project(b)
    assert f @ v >= -1e-12 * (1.0 + np.linalg.norm(a) * np.linalg.norm(b))


@settings(max_examples=60, deadline=None)
@given(any_cone, force)
def test_a_vector_outside_is_separated_by_a_member_of_the_dual(cone, f):
    f = np.array(f)
    if cone.distance(f) > 1e-9 * (1.0 + np.linalg.norm(f)):
        separator = cone.project(f) - f
        assert cone.dual().contains(separator, 1e-11 * np.linalg.norm(f))
        assert separator @ f < 0.0


def test_the_dual_of_the_friction_cone_is_the_cone_of_the_inverse_coefficient():
    v = np.random.default_rng(0).normal(size=(200, 3))
    dual = FrictionCone(0.25).dual()
    assert dual == FrictionCone(4.0)
    assert np.array_equal(dual.contains(v), v[:, 2] >= 0.25 * np.hypot(v[:, 0], v[:, 1]))
    assert dual.dual() == FrictionCone(0.25)


@pytest.mark.parametrize("cone", [FrictionPyramid(0.7, ConeChoice("inscribed", 5, 1.0)), FrictionPyramid(0.0, ConeChoice("inscribed", 6))])
def test_faces_and_rays_change_places_in_the_dual(cone):
    dual = cone.dual()
    assert np.array_equal(dual.faces(), -cone.generators())
    assert np.array_equal(dual.generators(), -cone.faces())
    f = forces_everywhere(cone)
    assert np.allclose(dual.dual().distance(f), cone.distance(f), rtol=0.0, atol=1e-14)


@pytest.mark.parametrize("cone", [FrictionCone(0.0), *(FrictionPyramid(0.0, ConeChoice(kind, 3)) for kind in KINDS)])
def test_without_friction_the_cone_is_the_ray_of_the_normal_and_its_dual_the_half_space(cone):
    assert np.array_equal(cone.generators(), [[0.0, 0.0, 1.0]])
    f = np.array([[0, 0, 2], [0, 0, -2], [3, 4, 1], [3, 4, -1], [0, 0, 0]], dtype=float)
    assert cone.distance(f) == pytest.approx([0.0, 2.0, 5.0, math.sqrt(26), 0.0], abs=1e-15)
    assert np.array_equal(cone.contains(f), [True, False, False, False, True])
    assert cone.dual().distance(f) == pytest.approx([-2.0, 2.0, -1.0, 1.0, 0.0], abs=1e-15)
    assert cone.dual().project([3.0, 4.0, -1.0]) == pytest.approx([3.0, 4.0, 0.0])
    if isinstance(cone, FrictionPyramid):
        assert np.all(cone.faces() @ [0.0, 0.0, 1.0] <= 0.0)
        assert np.any(cone.faces() @ [0.0, 0.0, -1.0] > 0.0)


@pytest.mark.parametrize("heading", [0.0, 0.3, -math.pi / 2, 5.0])
@pytest.mark.parametrize("sides", SIDES)
def test_inscribed_lies_in_exact_lies_in_circumscribed(sides, heading):
    mu, exact = 0.8, FrictionCone(0.8)
    inner, outer = (FrictionPyramid(mu, ConeChoice(kind, sides, heading)) for kind in KINDS)
    f = np.random.default_rng(sides).normal(size=(2000, 3)) + [0.0, 0.0, 1.0]
    assert np.all(inner.distance(f) >= exact.distance(f) - 1e-13)
    assert np.all(exact.distance(f) >= outer.distance(f) - 1e-13)
    assert exact.distance(inner.generators()) == pytest.approx(np.zeros(sides), abs=1e-14)
    touching = np.column_stack([mu * outer.choice.face_normals(), np.ones(sides)])
    assert exact.distance(touching) == pytest.approx(np.zeros(sides), abs=1e-14)
    assert outer.distance(touching) == pytest.approx(np.zeros(sides), abs=1e-14)


@pytest.mark.parametrize("kind", KINDS)
def test_each_edge_lies_on_two_faces_and_inside_the_others(kind):
    for sides in range(3, 34):
        pyramid = FrictionPyramid(0.37, ConeChoice(kind, sides, 0.77))
        use = pyramid.generators() @ pyramid.faces().T
        assert use.max() <= 1e-14
        on_face = np.abs(use) < 1e-14
        for j in range(sides):
            assert set(np.flatnonzero(on_face[j])) == {j, (j + 1) % sides}
        assert np.array_equal(pyramid.generators()[:, 2], np.ones(sides))


@settings(max_examples=60, deadline=None)
@given(st.floats(1e-2, 5.0), pyramid_choice, force)
def test_faces_say_what_contains_says(mu, choice, f):
    pyramid = FrictionPyramid(mu, choice)
    excess = (pyramid.faces() @ f).max()
    slope = mu * (math.cos(math.pi / choice.sides) if choice.kind == "inscribed" else 1.0)
    angles = choice.heading + 2.0 * math.pi * np.arange(choice.sides) / choice.sides
    assert excess == pytest.approx(max(math.cos(a) * f[0] + math.sin(a) * f[1] - slope * f[2] for a in angles), abs=1e-9)
    if abs(excess) > 1e-9:
        assert pyramid.contains(f) == (excess < 0.0)


@pytest.mark.parametrize("sides", [3, 4, 9])
def test_the_edges_span_what_the_faces_bound(sides):
    pyramid = FrictionPyramid(0.5, ConeChoice("circumscribed", sides, 0.4))
    for direction in np.random.default_rng(1).normal(size=(10, 2)):
        cost, zeros = -np.append(direction, 0.0), np.zeros(sides)
        most = linprog(cost, A_ub=pyramid.faces(), b_ub=zeros, A_eq=[[0, 0, 1]], b_eq=[1], bounds=(None, None))
        assert -most.fun == pytest.approx((pyramid.generators()[:, :2] @ direction).max(), abs=1e-9)


def test_the_circumscribed_square_accepts_sqrt_2_mu_and_the_inscribed_never_more_than_mu():
    mu = 0.5
    outer, inner = FrictionPyramid(mu, ConeChoice("circumscribed")), FrictionPyramid(mu, ConeChoice("inscribed"))
    diagonal = np.array([mu, mu, 1.0])
    assert outer.contains(diagonal) and not FrictionCone(mu).contains(diagonal)
    reach = np.linalg.norm(outer.generators()[:, :2], axis=1)
    assert reach == pytest.approx(np.full(4, mu * math.sqrt(2)))
    assert inner.slope == pytest.approx(mu / math.sqrt(2))
    assert np.linalg.norm(inner.generators()[:, :2], axis=1) == pytest.approx(np.full(4, mu))


def test_a_circumscribed_triangle_reaches_twice_the_friction_circle():
    assert np.linalg.norm(FrictionPyramid(0.5, ConeChoice("circumscribed", 3)).generators()[:, :2], axis=1) == pytest.approx(np.ones(3))


def printed_rows(mu: float, sides: int, sign: float) -> np.ndarray:
    angles = 2.0 * math.pi * np.arange(sides) / sides
    return np.column_stack([-np.sin(angles), -np.cos(angles), np.full(sides, sign * mu)])


@pytest.mark.parametrize("sides", [3, 4, 7, 12])
def test_the_general_printed_rows_are_the_circumscribed_pyramid_at_heading_minus_half_pi(sides):
    ours = FrictionPyramid(0.6, ConeChoice("circumscribed", sides, -math.pi / 2)).faces()
    apart = np.linalg.norm(ours[:, None] - printed_rows(0.6, sides, -1.0)[None], axis=2)
    assert apart.min(axis=1).max() < 1e-14 and apart.min(axis=0).max() < 1e-14


def test_the_sign_printed_in_3_12_excludes_every_compressive_force():
    printed = np.array([[0, -1, 1], [-1, 0, 1], [0, 1, 1], [1, 0, 1]]) * [1.0, 1.0, 0.6]
    f = np.random.default_rng(0).normal(size=(1000, 3))
    f[:, 2] = np.abs(f[:, 2]) + 1e-6
    assert not np.any(np.all(f @ printed.T <= 0.0, axis=1))
    corrected = printed * [1.0, 1.0, -1.0]
    ours = FrictionPyramid(0.6, ConeChoice("circumscribed", 4))
    assert np.array_equal(np.all(f @ corrected.T <= 0.0, axis=1), ours.contains(f))


def test_the_generators_of_the_exact_cone_are_the_edges_of_the_inscribed_pyramid():
    pyramid = FrictionPyramid(0.3, ConeChoice("inscribed", 7, 0.9))
    assert np.allclose(FrictionCone(0.3).generators(7, 0.9), pyramid.generators(), rtol=0.0, atol=1e-16)
    assert FrictionCone(0.3).distance(FrictionCone(0.3).generators(9)) == pytest.approx(np.zeros(9), abs=1e-15)


@settings(max_examples=50, deadline=None)
@given(any_cone, force, st.floats(1e-150, 1e150))
def test_distance_and_projection_scale_with_the_force(cone, f, factor):
    f = np.array(f)
    unit = np.linalg.norm(f)
    assert cone.distance(factor * f) / factor == pytest.approx(cone.distance(f), abs=1e-12 * unit)
    assert cone.project(factor * f) / factor == pytest.approx(cone.project(f), abs=1e-12 * unit)


def test_one_vector_gives_what_an_array_of_it_gives():
    f = np.array([[1.0, 2.0, 3.0], [1.0, -2.0, -3.0]])
    pyramid = FrictionPyramid(0.5, ConeChoice("inscribed", 6))
    for cone in (FrictionCone(0.5), pyramid, pyramid.dual()):
        assert isinstance(cone.distance(f[0]), float) and isinstance(cone.contains(f[0]), bool)
        assert [cone.distance(row) for row in f] == pytest.approx(cone.distance(f))
        assert cone.project(f[1]).shape == (3,) and cone.project(f).shape == (2, 3)
        assert cone.distance(np.zeros((0, 3))).shape == (0,) and cone.project(np.zeros((0, 3))).shape == (0, 3)


def test_tolerance_accepts_a_distance_outside_and_asks_for_a_depth_inside():
    cone = FrictionCone(1.0)
    assert cone.contains([1.0, 0.0, 0.9], tolerance=0.08) and not cone.contains([1.0, 0.0, 0.9], tolerance=0.07)
    assert cone.contains([0.9, 0.0, 1.0], tolerance=-0.07) and not cone.contains([0.9, 0.0, 1.0], tolerance=-0.08)
    assert cone.contains([0.3, 0.4, 0.5]) and FrictionCone(0.5).contains([0.3, 0.4, 1.0])


INSCRIBED = FrictionPyramid(0.5, ConeChoice("inscribed", 3))


@pytest.mark.parametrize("cone", [FrictionCone(0.5), FrictionCone(0.0), FrictionCone(0.0).dual(), INSCRIBED, INSCRIBED.dual()])
def test_a_component_that_is_not_finite_is_never_inside(cone):
    for at, wrong in product(range(3), (math.nan, math.inf, -math.inf)):
        f = np.array([0.0, 0.0, 1.0])
        f[at] = wrong
        assert cone.contains(f, tolerance=1e9) is False
        assert math.isnan(cone.distance(f)) and np.all(np.isnan(cone.project(f)))
        assert np.array_equal(cone.contains([f, [0.0, 0.0, 1.0]]), [False, True])


WRONG_FORCES = ([1.0, 2.0], [[1.0, 2.0, 3.0, 4.0]], np.zeros((2, 2, 3)), 1.0, [], "abc", [1j, 0, 0], [None, 0, 0], [[1, 2, 3], [1, 2]])


@pytest.mark.parametrize("cone", [FrictionCone(0.5), FrictionCone(0.0).dual(), INSCRIBED, INSCRIBED.dual()])
def test_a_force_of_the_wrong_size_or_kind_is_refused_by_name(cone):
    for question, wrong in product((cone.contains, cone.distance, cone.project), WRONG_FORCES):
        with pytest.raises(InputError, match="force") as caught:
            question(wrong)
        assert caught.value.field == "force"


@pytest.mark.parametrize("mu", [-0.1, math.nan, math.inf, "0.5", None, True, 1j])
def test_a_wrong_coefficient_is_refused_by_name(mu):
    for build in (FrictionCone, lambda mu: FrictionPyramid(mu, ConeChoice("inscribed"))):
        with pytest.raises(InputError, match="friction must be") as caught:
            build(mu)
        assert caught.value.field == "friction"


@pytest.mark.parametrize(
    ("stated", "field"),
    [({"kind": "round"}, "cone"), ({"kind": None}, "cone"), ({"sides": 2}, "sides"), ({"sides": 4.5}, "sides"), ({"sides": True}, "sides")]
    + [({"sides": math.nan}, "sides"), ({"sides": "4"}, "sides"), ({"heading": math.inf}, "heading"), ({"heading": "north"}, "heading")],
)
def test_a_wrong_choice_is_refused_by_name(stated, field):
    with pytest.raises(InputError, match=field) as caught:
        ConeChoice(**{"kind": "inscribed", **stated})
    assert caught.value.field == field


def test_a_choice_fills_its_defaults_and_the_exact_one_forgets_sides_and_heading():
    assert ConeChoice().as_record() == {"kind": "exact", "sides": None, "heading": None}
    assert ConeChoice("exact", 7, 1.0) == ConeChoice()
    assert ConeChoice("circumscribed").as_record() == {"kind": "circumscribed", "sides": 4, "heading": 0.0}
    assert isinstance(ConeChoice("inscribed", np.int64(5)).sides, int)
    assert np.array_equal(ConeChoice("inscribed").face_normals(), [[1, 0], [0, 1], [-1, 0], [0, -1]])
    assert (ConeChoice("inscribed", 3).slope_factor(), ConeChoice("circumscribed", 3).slope_factor()) == pytest.approx((0.5, 1.0))


def test_the_exact_choice_has_no_faces():
    exact = ConeChoice()
    for question in (exact.face_normals, exact.edge_directions, exact.slope_factor, lambda: FrictionPyramid(0.5, exact)):
        with pytest.raises(InputError) as caught:
            question()
        assert caught.value.field == "cone"


def test_what_is_handed_out_cannot_change_the_cone():
    pyramid = FrictionPyramid(0.5, ConeChoice("inscribed"))
    pyramid.faces()[:] = 0.0
    pyramid.generators()[:] = 0.0
    assert isinstance(pyramid.dual(), PolyhedralCone) and not pyramid.contains([1.0, 0.0, 1.0])
