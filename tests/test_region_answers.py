"""Support regions in themselves: tolerance, polygons, half-planes, margins in metres, rays, thin and unbounded ones."""

from functools import cache

import numpy as np
import pytest
from oracles import linear_stance, margin, scales
from plain_stances import UP, directions, feet, pinch, wall
from random_stances import random_stance

from socp_statics.contacts import ExternalWrench, Handle, PointContact, Stance, SurfaceContact
from socp_statics.regions import base_of_support, trace_support_region
from socp_statics.regions.sandwich import Support, _crossing
from socp_statics.stability import check_equilibrium

SEEDS = range(100, 105)


@cache
def seeded(family, seed, tolerance=1e-3):
    stance = random_stance(seed, family)
    return stance, trace_support_region(stance, tolerance)


def polygon_distance(P, xy):
    """Signed distance by brute force: half-planes of the edges inside, dense points of the outline outside."""
    E = np.roll(P, -1, axis=0) - P
    keep = np.linalg.norm(E, axis=1) > 0
    n = np.column_stack([E[keep, 1], -E[keep, 0]]) / np.linalg.norm(E[keep], axis=1)[:, None]
    reserve = ((P[keep] - xy) * n).sum(axis=1)
    if (reserve >= 0).all():
        return reserve.min()
    s = np.linspace(0, 1, 4001)[:, None]
    outline = np.vstack([p + s * e for p, e in zip(P, E, strict=True)])
    return -np.linalg.norm(outline - xy, axis=1).min()


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4, 1e-5])
def test_the_tolerance_is_respected(tolerance):
    for family in ("sloped", "feet_and_hands", "points"):
        region = trace_support_region(random_stance(101, family), tolerance)
        if region.kind == "polygon":
            assert 0 <= region.relative_gap <= tolerance
            assert region.relative_gap == pytest.approx(1 - region.inner_area / region.outer_area, abs=1e-9)


@pytest.mark.parametrize("family", ["flat", "sloped", "feet_and_hands", "points", "slivers", "mix"])
def test_inner_outer_halfplanes_and_membership_agree(family):
    for seed in SEEDS[:3]:
        stance, region = seeded(family, seed)
        if region.kind != "polygon":
            continue
        _, size, _ = scales(stance)
        A, b = region.halfplanes
        assert (A @ region.inner.T <= b[:, None] + 1e-9 * size).all()
        assert np.allclose(np.linalg.norm(A, axis=1), 1.0)
        rng = np.random.default_rng(seed)
        box = region.outer[:, None].min(axis=0)[0], region.outer.max(axis=0)
        xy = rng.uniform(box[0] - 0.05 * size, box[1] + 0.05 * size, (200, 2))
        distances, contained = region.margin(xy), region.contains(xy)
        assert (contained == (distances >= -1e-12 * size)).all()
        assert (A @ xy[contained].T <= b[:, None] + 1e-9 * size).all()
        assert distances[:20] == pytest.approx([polygon_distance(region.inner, p) for p in xy[:20]], abs=2e-4 * size)


@pytest.mark.parametrize("family", ["flat", "sloped", "feet_and_hands", "points", "loads", "tilted_gravity"])
def test_the_margin_in_metres_agrees_with_verdict_and_region(family):
    for seed in SEEDS[:3]:
        stance, region = seeded(family, seed)
        if region.kind != "polygon":
            continue
        _, size, _ = scales(stance)
        fine = trace_support_region(stance, 1e-6)
        rng = np.random.default_rng(seed)
        A, b = fine.halfplanes
        P, middle = fine.inner, fine.inner.mean(axis=0)
        edge = 0.5 * (P + np.roll(P, -1, axis=0))[rng.integers(len(P), size=3)]
        where = [rng.dirichlet(np.ones(len(P))) @ P, *(middle + (edge - middle) * [[1 - 1e-4], [1 + 1e-4], [1.5]])]
        for xy in where:
            at = Stance(stance.contacts, [*xy, stance.com[2]], stance.mass, stance.gravity, stance.external_wrenches)
            coarse, answer = trace_support_region(at, 1e-2), check_equilibrium(at)
            # Between the inner polygon and the half-planes of the outer one; outside, no half-plane is farther than the region.
            low, high = float(fine.margin(xy)), float((b - A @ xy).min())
            assert low - 2e-3 * abs(low) - 1e-9 * size <= coarse.com_margin <= high + 2e-3 * abs(high) + 1e-9 * size
            assert (answer.verdict, coarse.com_margin < 0) in (("stable", False), ("unstable", True))


def test_the_margin_in_metres_survives_repeated_corners():
    normal = [np.tan(np.arctan(0.5) - 1e-3), 0, 1]
    contacts = [
        PointContact(k, p, normal=normal, friction=0.5) for k, p in (("a", [0, 0, 0]), ("b", [0.3, 0.1, 0]), ("c", [0.2, 0.4, 0.1]))
    ]
    stance = Stance(contacts, [0.1, 0.1, 0.5], 60.0)
    region = trace_support_region(stance)
    assert check_equilibrium(stance).verdict == "stable"
    assert region.com_margin == pytest.approx(float(region.margin([0.1, 0.1])), rel=2e-3)
    assert region.solves < 40


@pytest.mark.parametrize(
    ("contacts", "com", "expected"),
    [
        ([wall("left", 0.3), wall("right", -0.3)], [0.0, 0, 0], np.inf),
        ([wall("left", 0.3), wall("right", -0.3)], [60.0, 0, 0], np.inf),
        (pinch(), [0, 2.0, 0], 0.0),
        (pinch(), [0, 20.0, 0], 0.0),
        (pinch(), [0.1, 2.0, 0], -0.1),
        ([*feet(), Handle("rail", [0.3, 0, 1], normal=UP, transmits=["my"])], [30.0, 0.1, 0.8], 0.065),
    ],
)
def test_margins_in_regions_without_end(contacts, com, expected):
    stance = Stance(contacts, com, 60.0)
    region = trace_support_region(stance)
    assert region.kind == "unbounded"
    assert region.com_margin == pytest.approx(expected, abs=1e-6)
    assert (check_equilibrium(stance).verdict == "unstable") == (expected < 0)


@pytest.mark.parametrize("engine", ["auto", "clarabel", "cvxpy"])
@pytest.mark.parametrize("least", [1.2, 2.0])
@pytest.mark.parametrize("transmits", [["mx", "my"], ["fx", "fy", "mx", "my"], ["mx", "my", "mz"], ["fx", "mx", "my", "mz"]])
def test_a_rail_that_resists_any_moment_carries_nobody_who_must_press_too_hard(transmits, least, engine):
    foot = SurfaceContact("foot", [0, 0, 0], normal=UP, friction=0.5, size=[0.2, 0.1], normal_force=[least * 60 * 9.81, np.inf])
    rail = Handle("rail", [0.5, 0, 1], normal=UP, transmits=transmits)
    stance = Stance([foot, rail], (0, 0, 1), 60.0)
    region = trace_support_region(stance, engine=engine)
    assert (region.kind, region.com_margin) == ("empty", None)
    assert check_equilibrium(stance, engine=engine).verdict == "unstable"


@pytest.mark.parametrize("bar", [True, False])
def test_a_line_of_positions_is_empty_where_a_foot_must_press_too_hard(bar):
    rod = Handle("rod", [0.5, 0, 1], normal=UP, transmits=["my"] if bar else ["mx"])
    for bounds, kind in (([2 * 60 * 9.81, np.inf], "empty"), (None, "unbounded")):
        foot = PointContact("foot", [0, 0, 0], normal=UP, friction=0.5, normal_force=bounds)
        assert trace_support_region(Stance([foot, rod], (0, 0, 1), 60.0)).kind == kind


def test_unbounded_polygons_are_clipped_to_ten_sizes():
    for contacts in ([wall("left", 0.3), wall("right", -0.3)], pinch()):
        region = trace_support_region(contacts)
        _, size, centre = scales(Stance(contacts, [0, 0, 0], 1.0))
        assert np.abs(region.inner - centre[:2]).max() == pytest.approx(10 * size, rel=1e-8)
    push = (ExternalWrench(moment=[300, 2 * 588.6, 0]),)
    oblique = [
        PointContact("left", [0.2, 0.3, 0], normal=[-2, -3, 0], friction=1.0),
        PointContact("right", [-0.2, -0.3, 0], normal=[2, 3, 0], friction=1.0),
    ]
    region = trace_support_region(Stance(oblique, [-2, 1, 0], 60.0, external_wrenches=push))
    _, size, _ = scales(Stance(oblique, [0, 0, 0], 1.0))
    assert [np.abs(end).max() for end in region.inner] == pytest.approx([10 * size, 10 * size], rel=1e-6)


@pytest.mark.parametrize("exponent", [-2, -3, -4, -5, -6])
@pytest.mark.parametrize("mu", [0.5, 2.0])
def test_thin_regions_keep_their_promises(exponent, mu):
    contacts = [
        PointContact(f"p{k}", p, normal=UP, friction=mu) for k, p in enumerate(([-0.3, 0, 0], [0.3, 0, 0], [0.05, 10.0**exponent, 0]))
    ]
    region = trace_support_region(contacts)
    assert region.kind == "polygon"
    assert region.inner_area == pytest.approx(0.3 * 10.0**exponent, rel=1e-3)
    A, b = region.halfplanes
    assert (A @ region.inner.T <= b[:, None] + 1e-9).all()
    assert 0 <= region.relative_gap <= 1e-3


def test_soles_become_segments_only_below_a_billionth_of_their_size():
    for width, kind in ((1e-7, "polygon"), (1e-8, "polygon"), (1e-11, "segment")):
        region = trace_support_region([SurfaceContact("f", [0, 0, 0], normal=UP, friction=0.5, size=[0.2, width])])
        assert region.kind == kind
        assert region.relative_gap <= 1e-3


@pytest.mark.parametrize("over", [1e-3, 1e-4, 1e-6, -1e-6, -1e-4])
def test_pushes_at_the_limit_of_friction_are_settled(over):
    push = ExternalWrench(force=[0.6 * 588.6 * (1 + over), 0, 0], point=[0, 0, 0])
    stance = Stance(feet(), [0, 0, 0.8], 60.0, external_wrenches=(push,))
    region = trace_support_region(stance)
    assert (region.kind == "empty") == (over > 0)
    assert check_equilibrium(stance).verdict == ("unstable" if over > 0 else "stable")


@pytest.mark.parametrize("over", [1e-8, 5e-8])
def test_a_region_without_interior_says_by_how_much_its_cones_were_widened(over):
    push = ExternalWrench(force=[0.6 * 588.6 * (1 + over), 0, 0], point=[0, 0, 0])
    stance = Stance(feet(), [0, 0, 0.8], 60.0, external_wrenches=(push,))
    region = trace_support_region(stance)
    assert region.kind == "polygon"
    assert 0 < region.widened <= 2.1e-7 * 588.6
    assert region.as_record()["widened"] == region.widened
    plain = trace_support_region(feet())
    assert plain.widened == 0 and "widened" not in plain.as_record()


def test_a_push_at_the_limit_of_friction_needs_hardly_wider_cones():
    """The set of forces has no interior but what rounding leaves: settled as it stands, or with cones 1e-7 W wider and said so."""
    push = ExternalWrench(force=[0.6 * 588.6, 0, 0], point=[0, 0, 0])
    region = trace_support_region(Stance(feet(), [0, 0, 0.8], 60.0, external_wrenches=(push,)))
    assert region.kind == "polygon"
    assert region.widened <= 2.1e-7 * 588.6
    for forces in region.inner_forces:
        slip = np.hypot(*forces.force_W[:, :2].T) - 0.6 * forces.force_W[:, 2]
        assert slip.max() <= 0.6 * region.widened + 1e-8 * 588.6
        assert np.abs(forces.force_W.sum(axis=0) + [0.6 * 588.6, 0.0, -588.6]).max() <= 1e-8 * 588.6


@pytest.mark.parametrize("family", ["sloped", "feet_and_hands", "mix"])
def test_the_same_input_gives_the_same_bytes(family):
    one, two = (trace_support_region(random_stance(103, family), 1e-4) for _ in range(2))
    for key in ("inner", "outer", "rays"):
        assert getattr(one, key).tobytes() == getattr(two, key).tobytes()
    assert (one.relative_gap, one.solves, one.com_margin) == (two.relative_gap, two.solves, two.com_margin)
    a, b = (check_equilibrium(random_stance(103, family)) for _ in range(2))
    assert a.margin == b.margin


def test_the_base_of_support_is_the_hull_of_the_points():
    for family in ("flat", "points", "ladder"):
        contacts = random_stance(7, family).contacts
        base = base_of_support(contacts)
        assert (base.margin(contacts.points_W[:, :2]) >= -1e-9).all()
        for d in directions(8):
            assert (base.vertices @ d).max() == pytest.approx((contacts.points_W[:, :2] @ d).max(), abs=1e-12)


def test_inner_corners_are_in_balance_and_points_beyond_outer_edges_are_not():
    for family in ("sloped", "feet_and_hands", "points"):
        stance, region = seeded(family, 102)
        if region.kind != "polygon":
            continue
        W, size, _ = scales(stance)
        middle = region.inner.mean(axis=0)
        for corner in region.inner[:: max(1, len(region.inner) // 4)]:
            inside = Stance(stance.contacts, [*(corner + 1e-3 * (middle - corner)), stance.com[2]], stance.mass)
            assert margin(linear_stance(inside, "circumscribed", 64)) > 0
        for a, b in zip(region.outer, np.roll(region.outer, -1, axis=0), strict=True):
            if np.linalg.norm(b - a) < 1e-3 * size:
                continue
            n = np.array([b[1] - a[1], a[0] - b[0]]) / np.linalg.norm(b - a)
            outside = Stance(stance.contacts, [*(0.5 * (a + b) + 1e-6 * size * n), stance.com[2]], stance.mass)
            assert margin(linear_stance(outside, "inscribed", 64)) < 1e-9 * W


@pytest.mark.parametrize("apart", [1e-8, 1e-6, 1e-3, 1.0])
def test_lines_that_are_nearly_parallel_cross_on_both(apart):
    rng = np.random.default_rng(3)
    for angle, h, more in rng.uniform(-1.0, 1.0, (50, 3)):
        lines = [Support((np.cos(a), np.sin(a)), (0.0, 0.0), b, None) for a, b in ((angle, h), (angle + apart, h + apart * more))]
        crossing = _crossing(*lines)
        for line in lines:
            assert np.dot(line.d, crossing) == pytest.approx(line.h, abs=2e-15)
