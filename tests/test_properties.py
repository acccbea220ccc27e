"""Symmetries, monotonicity and sandwiches that hold for every stance."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from oracles import scales
from random_stances import FAMILIES, moved, random_stance, restated

from socp_statics.cones.choice import ConeChoice
from socp_statics.contacts import ExternalWrench, PointContact, Stance, SurfaceContact
from socp_statics.regions import trace_support_region
from socp_statics.stability import check_equilibrium

MODEST = settings(derandomize=True, deadline=None, max_examples=25, database=None)
FEW = settings(derandomize=True, deadline=None, max_examples=10, database=None)
families = st.sampled_from(["flat", "sloped", "feet_and_hands", "points", "mix", "loads"])
any_family = st.sampled_from(list(FAMILIES))
seeds = st.integers(1000, 1020)
yaws = st.floats(-3.1, 3.1)


def same(a: float, b: float, unit: float) -> bool:
    """Margins are equal: both the same infinity, or within 1e-7 of W (and of themselves)."""
    if np.isinf(a) or np.isinf(b):
        return a == b
    return abs(a - b) <= 1e-7 * max(unit, abs(a))


def with_contacts(stance, contacts):
    return Stance(contacts, stance.com, stance.mass, stance.gravity, stance.external_wrenches)


def yaw_matrix(angle):
    return np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1.0]])


@MODEST
@given(any_family, seeds, yaws, st.tuples(*[st.floats(-50, 50)] * 3))
def test_moving_and_turning_a_stance_changes_nothing(family, seed, yaw, shift):
    stance = random_stance(seed, family)
    W, _, _ = scales(stance)
    one, two = check_equilibrium(stance), check_equilibrium(moved(stance, turn=yaw_matrix(yaw), shift=shift))
    assert same(one.margin, two.margin, W)
    assert (one.verdict, one.idle) == (two.verdict, two.idle)


@MODEST
@given(families, seeds, st.floats(-3, 6))
def test_margins_grow_with_the_load_and_not_with_the_size(family, seed, exponent):
    stance = random_stance(seed, family)
    W, _, _ = scales(stance)
    factor = 10.0**exponent
    stance = with_contacts(
        stance,
        [
            c if c.type == "handle" or c.normal_force is None else restated(c, normal_force=[0, np.inf])
            for c in stance.contacts
            if c.type != "handle"
        ],
    )
    wrenches = tuple(ExternalWrench(force=factor * w.force, moment=factor * w.moment, point=w.point) for w in stance.external_wrenches)
    base = check_equilibrium(stance)
    heavy = check_equilibrium(Stance(stance.contacts, stance.com, factor * stance.mass, stance.gravity, wrenches))
    assert same(base.margin * factor, heavy.margin, W * factor)
    larger = check_equilibrium(moved(stance, scale=10.0 ** (exponent / 3)))
    if not stance.external_wrenches:
        assert same(base.margin, larger.margin, W)
        assert base.verdict == larger.verdict


@FEW
@given(st.sampled_from(["flat", "sloped", "feet_and_hands", "points"]), seeds, st.floats(-2, 2), yaws)
def test_areas_grow_with_the_square_of_lengths_and_turn_with_the_stance(family, seed, exponent, yaw):
    stance = random_stance(seed, family)
    factor = 10.0**exponent
    base = trace_support_region(stance, 1e-4)
    other = trace_support_region(moved(stance, scale=factor, turn=yaw_matrix(yaw)), 1e-4)
    assert base.kind == other.kind
    if base.kind == "polygon":
        assert other.inner_area == pytest.approx(factor**2 * base.inner_area, rel=2e-4)
        R = yaw_matrix(yaw)[:2, :2]
        _, size, _ = scales(stance)
        assert (other.margin(factor * base.inner @ R.T) >= -1e-2 * factor * size).all()


@MODEST
@given(any_family, seeds, st.randoms(use_true_random=False))
def test_the_order_of_contacts_and_corners_does_not_matter(family, seed, random):
    stance = random_stance(seed, family)
    W, _, _ = scales(stance)
    contacts = list(stance.contacts)
    random.shuffle(contacts)
    turned = []
    for c in contacts:
        if c.type != "surface":
            turned.append(c)
            continue
        corners = np.roll(c.vertices, random.randrange(4), axis=0)[:: random.choice([1, -1])]
        middle = 0.5 * (corners[0] + corners[1])
        turned.append(restated(c, size=None, vertices=np.vstack([corners[:1], [middle], corners[1:]]).tolist()))
    one, two = check_equilibrium(stance), check_equilibrium(with_contacts(stance, turned))
    assert same(one.margin, two.margin, W)
    assert one.verdict == two.verdict
    assert set(one.idle) == set(two.idle)


def mirrored(stance):
    """The stance seen in the mirror y -> -y; contact frames stay right-handed by turning t2."""
    M, flip = np.diag([1.0, -1.0, 1.0]), np.diag([1.0, -1.0, 1.0])
    contacts = []
    for c in stance.contacts:
        changes = {"position": (M @ c.position).tolist(), "rotation": (M @ c.rotation @ flip).tolist()}
        if c.type in ("surface", "frictionless_surface"):
            changes |= {"size": None, "vertices": (c.vertices * [1, -1]).tolist()}
        if c.type == "handle":
            sign = {"fy": -1, "mx": -1, "mz": -1}
            changes["limits"] = {k: (v if sign.get(k, 1) > 0 else (-v[1], -v[0])) for k, v in c.limits.items()}
        contacts.append(restated(c, **changes))
    wrenches = tuple(
        ExternalWrench(force=M @ w.force, moment=-(M @ w.moment), point=None if w.point is None else M @ w.point)
        for w in stance.external_wrenches
    )
    return Stance(contacts, M @ stance.com, stance.mass, M @ stance.gravity, wrenches)


@MODEST
@given(any_family, seeds)
def test_mirrored_stances_have_mirrored_answers(family, seed):
    stance = random_stance(seed, family)
    W, _, _ = scales(stance)
    one, two = check_equilibrium(stance), check_equilibrium(mirrored(stance))
    assert same(one.margin, two.margin, W)
    assert one.verdict == two.verdict


@FEW
@given(st.sampled_from(["sloped", "feet_and_hands", "points"]), seeds)
def test_mirrored_regions_are_mirrored(family, seed):
    stance = random_stance(seed, family)
    one, two = trace_support_region(stance, 1e-4), trace_support_region(mirrored(stance), 1e-4)
    assert one.kind == two.kind
    assert two.inner_area == pytest.approx(one.inner_area, rel=2e-4)
    if one.com_margin is not None and np.isfinite(one.com_margin):
        assert two.com_margin == pytest.approx(one.com_margin, rel=3e-3, abs=1e-6)


@MODEST
@given(any_family, seeds, st.floats(0.0, 1.0))
def test_margins_grow_with_friction(family, seed, more):
    stance = random_stance(seed, family)
    W, _, _ = scales(stance)
    rougher = [restated(c, friction=c.friction + more) if c.friction > 0 else c for c in stance.contacts]
    a, b = check_equilibrium(stance).margin, check_equilibrium(with_contacts(stance, rougher)).margin
    assert b >= a - 1e-7 * max(W, abs(a) if np.isfinite(a) else 0.0)


@MODEST
@given(any_family, seeds, st.integers(3, 12), st.floats(-1, 1))
def test_exact_margins_lie_between_those_of_pyramids_and_more_sides_are_closer(family, seed, sides, heading):
    stance = random_stance(seed, family)
    W, _, _ = scales(stance)
    exact = check_equilibrium(stance).margin
    slack = 1e-7 * max(W, abs(exact) if np.isfinite(exact) else 0.0)

    def with_cone(kind, n, turned=heading):
        return check_equilibrium(stance, cone=ConeChoice(kind, n, turned)).margin

    low, high = with_cone("inscribed", sides), with_cone("circumscribed", sides)
    assert low - slack <= exact <= high + slack
    # Faces j of the pyramid are every second face of one with twice the sides: circumscribed pyramids are nested. Inscribed ones
    # share their edges when the finer one is turned by half a face.
    assert with_cone("circumscribed", 2 * sides) <= high + slack
    if not any(c.type == "soft_finger" for c in stance.contacts):
        assert with_cone("inscribed", 2 * sides, heading + np.pi / (2 * sides)) >= low - slack


@FEW
@given(st.sampled_from(["sloped", "feet_and_hands", "points", "flat"]), seeds, st.booleans())
def test_a_contact_that_need_not_carry_anything_never_shrinks_the_region(family, seed, grip):
    stance = random_stance(seed, family)
    _, size, centre = scales(stance)
    rng = np.random.default_rng(seed)
    extra = PointContact(
        "extra", centre + rng.uniform(-1, 1, 3) * size / 2, normal=[*rng.uniform(-1, 1, 2), 1.0 if grip else -0.2], friction=0.4
    )
    if np.linalg.norm(stance.contacts.points_W - extra.position, axis=1).max() > size:
        extra = PointContact("extra", centre, normal=extra.normal_W, friction=0.4)
    few, many = trace_support_region(stance, 1e-3), trace_support_region(with_contacts(stance, [*stance.contacts, extra]), 1e-3)
    if few.kind == "empty":
        return
    assert many.kind != "empty"
    if few.kind == "polygon" and many.kind == "polygon":
        assert many.outer_area >= few.inner_area * (1 - 1e-9)
        for angle in np.linspace(0, 6, 12):
            d = np.array([np.cos(angle), np.sin(angle)])
            assert (many.outer @ d).max() >= (few.inner @ d).max() - 1e-8 * size


def test_the_margin_itself_may_shrink_when_a_contact_is_added():
    foot = SurfaceContact("foot", [0, 0, 0], normal=[0, 0, 1], friction=0.5, size=[0.2, 0.1])
    other = SurfaceContact("other", [0.5, 0, 0], normal=[0, 0, 1], friction=0.5, size=[0.2, 0.1])
    alone, both = check_equilibrium([foot], [0, 0, 0.5], 60.0), check_equilibrium([foot, other], [0, 0, 0.5], 60.0)
    assert both.margin < alone.margin
    assert trace_support_region([foot, other]).inner_area > trace_support_region([foot]).inner_area


@FEW
@given(st.sampled_from(["sloped", "feet_and_hands", "points", "loads", "tilted_gravity"]), seeds, st.integers(4, 8))
def test_regions_of_pyramids_sandwich_the_exact_one(family, seed, sides):
    stance = random_stance(seed, family)
    _, size, _ = scales(stance)
    low, exact, high = (trace_support_region(stance, 1e-3, cone=kind, sides=sides) for kind in ("inscribed", "exact", "circumscribed"))
    for small, large in ((low, exact), (exact, high)):
        if small.kind == "empty" or large.kind == "unbounded":
            continue
        assert large.kind != "empty"
        assert small.kind != "unbounded"
        for angle in np.linspace(0, 6, 12):
            d = np.array([np.cos(angle), np.sin(angle)])
            assert (small.inner @ d).max() <= (large.outer @ d).max() + 1e-8 * size


@MODEST
@given(st.sampled_from(["flat", "sloped", "feet_and_hands", "points", "ladder", "chimney", "loads", "tilted_gravity", "slivers"]), seeds)
def test_verdict_membership_and_margin_in_metres_agree(family, seed):
    stance = random_stance(seed, family)
    answer, region = check_equilibrium(stance), trace_support_region(stance, 1e-4)
    _, size, _ = scales(stance)
    xy = stance.com[:2]
    if answer.verdict == "stable":
        assert region.kind != "empty"
        assert region.com_margin >= 0
    if answer.verdict == "unstable" and region.kind != "empty":
        assert region.com_margin < 0
    if region.kind == "polygon":
        assert bool(region.contains(xy)) <= (answer.verdict != "unstable")
        A, b = region.halfplanes
        assert (A @ xy <= b + 1e-9 * size).all() >= (answer.verdict == "stable")


@MODEST
@given(any_family, seeds)
def test_answers_do_not_depend_on_names(family, seed):
    stance = random_stance(seed, family)
    renamed = []
    for k, c in enumerate(stance.contacts):
        statement = c.statement() | {"name": f"contact {9 - k}"}
        renamed.append(type(c)(**{key: value for key, value in statement.items() if key != "type"}))
    W, _, _ = scales(stance)
    one, two = check_equilibrium(stance), check_equilibrium(with_contacts(stance, renamed))
    assert same(one.margin, two.margin, W)
    assert one.verdict == two.verdict
