"""Support regions against support functions by linear programs, closed forms, and numbers of the literature."""

from functools import cache

import numpy as np
import pytest
from oracles import grows_along, linear_stance, scales, support
from plain_stances import UP, directions, feet, hoap2_soles, pinch, three_points_tilted, wall
from random_stances import FAMILIES, random_stance

from socp_statics.cones.choice import ConeChoice
from socp_statics.contacts import Handle, PointContact, Stance, SurfaceContact
from socp_statics.regions import base_of_support, trace_support_region
from socp_statics.stability import check_equilibrium

SEEDS = range(100, 105)


@cache
def seeded(family, seed, tolerance=1e-3):
    stance = random_stance(seed, family)
    return stance, trace_support_region(stance, tolerance)


# --- against linear programs


@pytest.mark.parametrize("family", [*FAMILIES, "tiny", "huge", "far", "heavy"])
def test_regions_lie_between_the_support_functions_of_pyramids(family):
    for seed in SEEDS:
        stance, region = seeded(family, seed)
        _, size, _ = scales(stance)
        low, high = (linear_stance(stance, kind, 32) for kind in ("inscribed", "circumscribed"))
        for d in directions(3, seed):
            (inside, h_low), (outside, h_high) = support(low, d), support(high, d)
            if region.kind == "empty":
                assert inside == "empty"
                continue
            assert outside != "empty"
            if region.kind == "unbounded":
                continue
            assert inside != "unbounded"
            if inside == "solved":
                assert h_low <= (region.outer @ d).max() + 1e-7 * size
            if outside == "solved":
                assert (region.inner @ d).max() <= h_high + 1e-7 * size


@pytest.mark.parametrize("family", ["sloped", "feet_and_hands", "points", "mix", "tilted_gravity"])
def test_regions_of_pyramids_have_the_support_function_of_the_same_pyramids(family):
    for seed in SEEDS[:3]:
        stance = random_stance(seed, family)
        _, size, _ = scales(stance)
        choice = (ConeChoice("inscribed", 4, 0.3), ConeChoice("circumscribed", 6), ConeChoice("inscribed", 5, 0.2))[seed % 3]
        region = trace_support_region(stance, 1e-4, cone=choice)
        model = linear_stance(stance, choice.kind, choice.sides, choice.heading, stated=True)
        for d in directions(3, seed):
            status, h = support(model, d)
            if region.kind == "polygon":
                assert status == "solved"
                assert (region.inner @ d).max() - 1e-7 * size <= h <= (region.outer @ d).max() + 1e-7 * size
            else:
                assert (status == "empty") == (region.kind == "empty")
                if region.kind == "point":
                    assert h == pytest.approx(region.inner[0] @ d, abs=1e-7 * size)


@pytest.mark.parametrize("family", ["points", "sloped"])
def test_empty_regions_are_infeasible_even_for_circumscribed_cones(family):
    found = 0
    for seed in range(60):
        stance = random_stance(seed, family)
        steep = [
            PointContact(c.name, c.position, normal=[*(4 * c.normal_W[:2] + 0.8), c.normal_W[2]], friction=0.3) for c in stance.contacts
        ]
        region = trace_support_region(Stance(steep, stance.com, 60.0))
        if region.kind == "empty":
            low, high = (linear_stance(Stance(steep, stance.com, 60.0), kind, 64) for kind in ("inscribed", "circumscribed"))
            assert support(low, [1.0, 0.0])[0] == "empty"
            found += support(high, [1.0, 0.0])[0] == "empty"
            assert check_equilibrium(Stance(steep, stance.com, 60.0)).verdict == "unstable"
        if found >= 5:
            return
    pytest.fail("too few empty regions among the stances")


def test_rays_are_directions_of_growth_and_nothing_beyond_them_is():
    rail = lambda words, **limits: Handle("rail", [0.3, 0, 1], normal=UP, transmits=words, limits=limits)  # noqa: E731
    cases = [
        [*feet(), rail(["fz"])],
        [*feet(), rail(["fz"], fz=(-np.inf, 0.0))],
        [*feet(), rail(["mx"])],
        [*feet(), rail(["my"], my=(0.0, np.inf))],
        [*feet(), rail(["mx", "my"], my=(0.0, np.inf), mx=(0.0, np.inf))],
        [wall("left", 0.3), wall("right", -0.3)],
        pinch(),
    ]
    for contacts in cases:
        stance = Stance(contacts, [0, 0, 0.5], 60.0)
        region = trace_support_region(stance)
        assert region.kind == "unbounded"
        assert np.allclose(np.linalg.norm(region.rays, axis=1), 1.0)
        low, high = (linear_stance(stance, kind, 32) for kind in ("inscribed", "circumscribed"))
        for d in directions(16):
            weights, *_ = np.linalg.lstsq(region.rays.T, d, rcond=None)
            inside = len(region.rays) == 4 or any(
                np.abs(np.cross(np.append(r, 0), np.append(d, 0))).max() < 1e-9 and r @ d > 0 for r in region.rays
            )
            if len(region.rays) == 2:
                inside = inside or (weights > 1e-3).all() and abs(np.linalg.det(region.rays)) > 1e-6
            if inside:
                assert grows_along(high, d)
            elif not (len(region.rays) == 2 and abs(np.linalg.det(region.rays)) > 1e-6 and (weights > -1e-3).all()):
                assert not grows_along(low, d)
        for r in region.rays:
            assert grows_along(high, r * (1 - 1e-9))


# --- numbers


@pytest.mark.parametrize(("engine", "solves"), [("clarabel", 8), ("kernel", 5)])
def test_flat_double_stance_of_hoap2(engine, solves):
    region = trace_support_region(hoap2_soles(), engine=engine)
    assert region.kind == "polygon"
    assert region.inner_area == pytest.approx(138.18e-4, abs=1e-8)
    assert region.outer_area == pytest.approx(0.098 * 0.141, abs=1e-8)
    assert region.solves == solves
    assert len(region.inner) == len(region.outer) == 4
    assert np.allclose(
        sorted(map(tuple, np.round(region.inner, 9))), sorted([(0.058, 0.0705), (-0.04, 0.0705), (-0.04, -0.0705), (0.058, -0.0705)])
    )
    assert base_of_support(hoap2_soles()).area == pytest.approx(138.18e-4)


@pytest.mark.parametrize("mu", [0.01, 0.5, 2.0])
@pytest.mark.parametrize("kind", ["exact", "inscribed", "circumscribed"])
def test_flat_stances_do_not_depend_on_friction_or_its_cone(mu, kind):
    assert trace_support_region(hoap2_soles(mu=mu), cone=kind).inner_area == pytest.approx(138.18e-4, abs=1e-8)


def test_pyramid_areas_converge_to_the_exact_one_as_their_sides_double():
    stance = three_points_tilted(np.deg2rad(30), 0.3)
    exact = trace_support_region(stance, 1e-4)
    errors = []
    for sides in (4, 8, 16, 32):
        low, high = (trace_support_region(stance, 1e-4, cone=kind, sides=sides) for kind in ("inscribed", "circumscribed"))
        assert low.inner_area <= exact.outer_area
        assert exact.inner_area <= high.outer_area
        errors.append(high.outer_area - low.inner_area)
    assert errors == sorted(errors, reverse=True)
    assert errors[-1] < 0.06 * errors[0]
    assert trace_support_region(stance, 1e-4, cone="circumscribed").inner_area > 1.08 * exact.outer_area


def test_unilateral_contacts_of_stabilipy_are_bracketed():
    where = ([-0.1, 0.4, 0], [0, -0.4, 0.1], [0.5, 0, 0.8])
    normals = ([0, 0.3, 1], [0, -0.3, 1], [1, 0, 1])
    stance = Stance(
        [PointContact(f"c{k}", p, normal=n, friction=0.5) for k, (p, n) in enumerate(zip(where, normals, strict=True))], [0.1, 0, 0.5], 60.0
    )
    region = trace_support_region(stance, 1e-4)
    low, high = (linear_stance(stance, kind, 64) for kind in ("inscribed", "circumscribed"))
    for d in directions(24):
        assert support(low, d)[1] <= (region.outer @ d).max() + 1e-9
        assert (region.inner @ d).max() <= support(high, d)[1] + 1e-9


PYMANOID = {
    "double": ([("left", [0.20, 0.15, 0.10], [0.4, 0, 0]), ("right", [-0.20, -0.195, 0], [-0.4, 0, 0])], [0, 0, 0.9]),
    "triple": (
        [
            ("left", [0.5779, 0.3871, 0.1023], [0.4701, 0, 0]),
            ("right", [0, -0.3187, 0.0576], [-0.7124, 0, 0]),
            ("hand", [0.6544, 0.3917, 1.0263], [1.3382, -0.2331, -0.7726]),
        ],
        [0.3, 0.04, 0.75],
    ),
}


@pytest.mark.parametrize("name", PYMANOID)
def test_stances_of_pymanoid_are_bracketed(name):
    contacts, com = PYMANOID[name]
    stance = Stance([SurfaceContact(n, p, rpy=rpy, friction=0.5, size=[0.24, 0.13]) for n, p, rpy in contacts], com, 62.0)
    region = trace_support_region(stance, 1e-4)
    assert region.kind == "polygon"
    assert region.com_margin > 0
    assert check_equilibrium(stance).verdict == "stable"
    low, high = (linear_stance(stance, kind, 64) for kind in ("inscribed", "circumscribed"))
    for d in directions(12):
        assert support(low, d)[1] <= (region.outer @ d).max() + 1e-8
        assert (region.inner @ d).max() <= support(high, d)[1] + 1e-8


def test_contacts_that_other_tools_refuse():
    point = trace_support_region([PointContact("p", [0.3, 0.2, 0.1], normal=[0.1, 0, 1], friction=0.5)])
    assert (point.kind, point.inner.shape, point.inner_area) == ("point", (1, 2), 0.0)
    assert np.allclose(point.inner[0], [0.3, 0.2])
    two = trace_support_region(
        [PointContact("a", [0, 0.1, 0], normal=UP, friction=0.5), PointContact("b", [0.1, -0.1, 0.2], normal=UP, friction=0.5)]
    )
    assert two.kind == "segment"
    assert np.allclose(sorted(map(tuple, two.inner)), [(0, 0.1), (0.1, -0.1)], atol=1e-9)
    corners = 0.005 * np.array([[0, 0], [1, 0], [0.5, 0.8]])
    small = trace_support_region([PointContact(f"p{k}", [*xy, 0], normal=UP, friction=0.5) for k, xy in enumerate(corners)])
    assert small.kind == "polygon"
    assert len(small.inner) == 3
    assert small.inner_area == pytest.approx(1e-5, rel=1e-8)


def test_a_ceiling_helps_only_where_something_pushes_against_it():
    ceiling = SurfaceContact("ceiling", [0, 0, 1], normal=[0, 0, -1], friction=0.5, size=[0.1, 0.1])
    assert trace_support_region([ceiling]).kind == "empty"
    foot = SurfaceContact("foot", [0, 0, 0], normal=UP, friction=0.5, size=[0.2, 0.1])
    braced = trace_support_region([foot, ceiling])
    assert braced.kind == "unbounded"
    beside = trace_support_region([foot, SurfaceContact("ceiling", [2, 0, 1], normal=[0, 0, -1], friction=0.01, size=[0.1, 0.1])])
    model = linear_stance(
        Stance([foot, SurfaceContact("ceiling", [2, 0, 1], normal=[0, 0, -1], friction=0.01, size=[0.1, 0.1])], [0, 0, 0], 60.0),
        "circumscribed",
        32,
    )
    assert np.isinf(support(model, [-1.0, 0.0])[1]) == (beside.kind == "unbounded")


def test_normals_matter():
    areas = [trace_support_region(three_points_tilted(angle, 0.3)).inner_area for angle in (0.0, 0.2, 0.3, 0.6)]
    assert areas[0] == pytest.approx(0.75 * np.sqrt(3) * 0.2**2, rel=1e-6)
    assert areas[1] == pytest.approx(areas[0], rel=1e-6)
    assert areas[0] > areas[2] > 1.4 * areas[3]
