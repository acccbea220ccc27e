"""The compiled tracer: the same regions as Clarabel's, witnesses that check, closed forms, invariances, threads."""

from __future__ import annotations

import numpy as np
import pytest
from random_stances import moved, random_stance
from sweeps.population import Case, stance_of

import socp_statics as ss
from socp_statics.cones.choice import ConeChoice
from socp_statics.regions.polygon import distance
from socp_statics.statics import assemble

FAMILIES = ("flat", "sloped", "feet_and_hands", "points", "near_vertical", "loads", "tilted_gravity", "slivers", "ladder", "chimney")
CONES = [ConeChoice(), ConeChoice("inscribed", 5, 0.3), ConeChoice("circumscribed", 4)]


def sole(name, x, y, roll=0.0, pitch=0.0, z=0.0, mu=0.5):
    return ss.SurfaceContact(name, (x, y, z), rpy=(roll, pitch, 0.0), friction=mu, size=(0.2, 0.1))


def rolled(points=8):
    rolls = np.linspace(-0.35, 0.35, points // 4)
    return ss.ContactSet([sole(f"sole{i}", 0.02 * i, 0.2 * i, r, 0.1 * r, 0.03 * i) for i, r in enumerate(rolls)])


def friction_stances(per_family=4):
    for family in FAMILIES:
        for seed in range(per_family):
            stance = random_stance(seed, family)
            if stance.contacts.friction_points is not None:
                yield pytest.param(stance, id=f"{family}-{seed}")


@pytest.mark.parametrize("stance", list(friction_stances()))
def test_the_kernel_traces_what_clarabel_traces(stance):
    mine, theirs = (ss.trace_support_region(stance, engine=engine) for engine in ("auto", ("clarabel", "cvxpy")))
    assert mine.kind == theirs.kind
    near = 1e-6 * mine.size
    for a, b in ((mine, theirs), (theirs, mine)):
        if a.kind in ("polygon", "unbounded") and len(a.inner):
            assert distance(b.outer, a.inner).min() >= -near
    assert mine.inner_area == pytest.approx(theirs.inner_area, rel=2.5e-3, abs=1e-9 * mine.size**2)
    assert mine.relative_gap <= 1e-3
    if mine.com_margin is None or np.isinf(mine.com_margin):
        assert mine.com_margin == theirs.com_margin
    else:
        assert mine.com_margin == pytest.approx(theirs.com_margin, rel=3e-3, abs=near)


def checked_witnesses(stance, region, cone):
    """Forces of every corner in their cones and in balance; motions of every edge that no contact resists."""
    data = assemble(stance)
    W, size = data.units.force, data.units.length
    assert len(region.inner_forces) == len(region.inner) and len(region.outer_multipliers) == len(region.outer)
    for corner, forces in zip(region.inner, region.inner_forces, strict=True):
        com = np.array([*corner, stance.com[2]])
        weight = stance.mass * stance.gravity
        force = forces.force_W.sum(axis=0) + weight
        moment = np.cross(forces.point_W - data.units.origin, forces.force_W).sum(axis=0) + np.cross(com - data.units.origin, weight)
        for wrench in stance.external_wrenches:
            force = force + wrench.force
            moment = moment + wrench.moment_about(data.units.origin)
        assert np.abs(force).max() <= 1e-8 * W
        assert np.abs(moment).max() <= 1e-8 * W * size
        R = data.rotation[[data.names.index(c) for c in forces.contact]]
        local = np.einsum("nji,nj->ni", R, forces.force_W) / W
        mu = np.array([stance.contacts[c].friction for c in forces.contact])
        if cone.is_exact:
            assert (np.hypot(local[:, 0], local[:, 1]) - mu * local[:, 2]).max() <= 1e-7
        else:
            assert ((local[:, :2] @ cone.face_normals().T) - (cone.slope_factor() * mu * local[:, 2])[:, None]).max() <= 1e-7
    for k, (linear, angular) in enumerate(region.outer_multipliers):
        a, b = region.outer[k], region.outer[(k + 1) % len(region.outer)]
        power = []
        for xy in (a, b, a + (b - a)[[1, 0]] * [1, -1]):
            com = np.array([*xy, stance.com[2]]) - data.units.origin
            load = stance.mass * stance.gravity @ linear + np.cross(com, stance.mass * stance.gravity) @ angular
            load += sum(w.force @ linear + w.moment_about(data.units.origin) @ angular for w in stance.external_wrenches)
            power.append(load / W)
        speed = max(np.linalg.norm(linear), np.linalg.norm(angular) * size)
        assert np.abs(power[:2]).max() <= 1e-6 * speed
        assert power[2] > 0
        velocity = linear + np.cross(angular, data.units.length * data.point)
        u = np.einsum("nji,nj->ni", data.rotation[data.contact_of_point], velocity)
        mu = np.zeros(data.points)
        mu[: data.slipping] = data.friction
        if cone.is_exact:
            assert (mu * np.hypot(u[:, 0], u[:, 1]) - u[:, 2]).max() <= 1e-7 * speed


@pytest.mark.parametrize("cone", CONES, ids=lambda c: c.kind)
@pytest.mark.parametrize("family", ["flat", "sloped", "feet_and_hands", "loads", "tilted_gravity"])
def test_every_corner_and_edge_has_a_witness(family, cone):
    seen = 0
    for seed in range(4):
        stance = random_stance(seed, family)
        if stance.contacts.friction_points is None:
            continue
        region = ss.trace_support_region(stance, cone=cone, engine="kernel")
        if region.kind == "polygon":
            seen += 1
            checked_witnesses(stance, region, cone)
    assert seen


@pytest.mark.parametrize("family, seed", [("soles", 19700), ("pushed", 7735)])
def test_corners_that_nearly_repeat_do_not_turn_a_margin_round(family, seed):
    """Stances of the sweep whose refined regions have two corners within rounding of each other."""
    stance = stance_of(Case(family, seed))
    mine, other = (ss.trace_support_region(stance, engine=e) for e in ("kernel", "clarabel"))
    assert ss.check_equilibrium(stance).stable and mine.engine == "kernel"
    assert mine.com_margin == pytest.approx(other.com_margin, rel=1e-6) and mine.com_margin > 0.0
    assert mine.margin(stance.com[:2]) == pytest.approx(mine.com_margin, rel=2e-3)


def test_flat_feet_are_the_hull_of_their_corners_to_rounding():
    feet = ss.ContactSet([sole("left", 0.0, 0.1), sole("right", 0.05, -0.1)])
    region, base = ss.trace_support_region(feet, engine="kernel"), ss.base_of_support(feet)
    assert region.inner_area == pytest.approx(base.area, rel=1e-12)
    assert region.outer_area == pytest.approx(base.area, rel=1e-11)
    assert region.engine == "kernel" and region.handovers == 0


@pytest.mark.parametrize("points", [8, 16, 32])
def test_a_fine_tolerance_is_reached_by_continuation(points):
    contacts = rolled(points)
    mine, coarse = (ss.trace_support_region(contacts, t, engine="kernel") for t in (1e-6, 1e-3))
    assert mine.relative_gap <= 1e-6
    assert distance(mine.outer, coarse.inner).min() >= -1e-9
    assert distance(coarse.outer, mine.inner).min() >= -1e-9
    stance = ss.Stance(contacts, (0.0, 0.0, 0.0), 1.0)
    checked_witnesses(stance, mine, ConeChoice())


def test_pyramids_approach_the_exact_region_from_both_sides():
    exact = ss.trace_support_region(rolled(), 1e-5, engine="kernel").inner_area
    inner, outer = ([ss.trace_support_region(rolled(), 1e-5, cone=kind, sides=n, engine="kernel").inner_area for n in (4, 8, 32, 128)]
                    for kind in ("inscribed", "circumscribed"))  # fmt: skip
    assert inner == sorted(inner) and outer == sorted(outer, reverse=True)
    assert inner[-1] <= exact * (1 + 1e-5) <= outer[-1] * (1 + 3e-5)
    assert outer[-1] - inner[-1] <= 3e-3 * exact
    for kind in ("inscribed", "circumscribed"):
        a, b = (ss.trace_support_region(rolled(), cone=kind, sides=3, heading=0.4, engine=e) for e in ("kernel", "clarabel"))
        assert a.engine == "kernel"
        assert a.inner_area == pytest.approx(b.inner_area, rel=2e-3)


@pytest.mark.parametrize(
    "change", [{"scale": 0.01}, {"scale": 100.0}, {"shift": (1000.0, -700.0, 300.0)}, {"mass": 1e-3}, {"mass": 1e6}], ids=str
)
def test_the_shape_does_not_depend_on_size_place_and_mass(change):
    stance = ss.Stance(rolled(), (0.0, 0.1, 0.5), 60.0)
    other = moved(stance, **change)
    a, b = (ss.trace_support_region(s, engine="kernel") for s in (stance, other))
    k = change.get("scale", 1.0)
    assert b.inner_area == pytest.approx(k * k * a.inner_area, rel=1e-6)
    assert b.com_margin == pytest.approx(k * a.com_margin, rel=3e-3)
    assert len(a.inner) == len(b.inner)


def test_kinds_that_are_not_polygons_are_recognised():
    up = (0.0, 0.0, 1.0)
    cases = {
        "segment": [ss.PointContact(f"p{i}", (x, 0.0, 0.0), normal=up, friction=0.5) for i, x in enumerate((-0.2, 0.3))],
        "point": [ss.PointContact("p", (0.1, 0.2, 0.0), normal=up, friction=0.5)],
        "empty": [ss.PointContact(f"p{i}", (np.cos(i), np.sin(i), 0.0), normal=(2.0, 0.0, 1.0), friction=0.1) for i in range(4)],
        "unbounded": [sole("floor", 0.0, 0.0), ss.PointContact("ceiling", (0.0, 0.0, 1.0), normal=(0.0, 0.0, -1.0), friction=0.5)],
    }
    for kind, contacts in cases.items():
        for engine in ("kernel", "clarabel"):
            assert ss.trace_support_region(contacts, engine=engine).kind == kind, (kind, engine)


def test_answers_do_not_depend_on_the_number_of_threads():
    sets = [ss.ContactSet([sole("a", 0.0, 0.1, 0.3 + 0.001 * k), sole("b", 0.0, -0.1, -0.3)]) for k in range(70)]
    sets[5] = ss.ContactSet([ss.PointContact("p", (0.1, 0.2, 0.0), normal=(0, 0, 1), friction=0.5)])
    one, two = (ss.trace_support_regions(sets, threads=n) for n in (1, 2))
    alone = [ss.trace_support_region(s) for s in sets]
    assert [r.kind for r in one] == ["polygon"] * 5 + ["point"] + ["polygon"] * 64
    for a, b, c in zip(one, two, alone, strict=True):
        assert a.inner.tobytes() == b.inner.tobytes() == c.inner.tobytes()
        assert a.outer.tobytes() == b.outer.tobytes() == c.outer.tobytes()
        assert (a.solves, a.relative_gap) == (b.solves, b.relative_gap) == (c.solves, c.relative_gap)


def test_what_was_traced_before_does_not_matter():
    few, many = rolled(4), rolled(200)
    first, second = ss.trace_support_region(few, 1e-2), ss.trace_support_region(many, 1e-4)
    for one, tolerance, before in ((few, 1e-2, first), (many, 1e-4, second), (few, 1e-2, first)):
        again = ss.trace_support_region(one, tolerance)
        np.testing.assert_array_equal(again.inner, before.inner)
        np.testing.assert_array_equal(again.outer_multipliers, before.outer_multipliers)
    np.testing.assert_array_equal(first.inner, ss.trace_support_region(few, 1e-2).inner)


@pytest.mark.parametrize("threads", [0, -1, 1.5, True, "two"])
def test_a_wrong_number_of_threads_is_refused(threads):
    with pytest.raises(ss.InputError, match="threads must be a whole number >= 1"):
        ss.trace_support_regions([rolled()], threads=threads)


def test_stances_bring_their_margin_and_contacts_alone_do_not():
    stance = ss.Stance(rolled(), (0.0, 0.1, 0.5), 60.0)
    with_com, without = ss.trace_support_regions([stance, rolled()])
    assert with_com.com_margin == pytest.approx(ss.trace_support_region(stance, engine="clarabel").com_margin, rel=2e-3)
    assert without.com_margin is None
