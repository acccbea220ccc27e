"""The body wrench cone: a sum and not an intersection, consistency against the conic programs, gravito-inertial slices."""

from __future__ import annotations

import numpy as np
import pytest
from oracles import points_of
from random_stances import random_stance

import socp_statics as ss
from socp_statics.exceptions import InputError
from socp_statics.wrench_cones import acceleration_slice, body_wrench_cone, com_slice, contact_wrench_cone

UP, DOWN = (0, 0, 1), (0, 0, -1)
FEET = [ss.SurfaceContact(f"foot{k}", (0, y, 0), normal=UP, friction=0.5, size=(0.2, 0.1)) for k, y in enumerate((0.15, -0.15))]
TILTED = ss.ContactSet(
    [
        ss.SurfaceContact("left", (0.0, 0.15, 0.0), rpy=(0.35, 0.0, 0.2), friction=0.5, size=(0.2, 0.1)),
        ss.SurfaceContact("right", (0.1, -0.15, 0.1), rpy=(-0.35, 0.1, 0.0), friction=0.5, size=(0.2, 0.1)),
    ]
)
FAMILIES = ("flat", "sloped", "feet_and_hands", "ladder", "points", "loads", "tilted_gravity", "far", "tiny")


def needed(stance, point):
    """The reaction that balances the load of a stance about a point, written out."""
    weight = stance.mass * np.asarray(stance.gravity)
    load = np.concatenate([weight, np.cross(stance.com - point, weight)])
    for w in stance.external_wrenches:
        arm = np.zeros(3) if w.point is None else w.point - point
        load += np.concatenate([w.force, np.cross(arm, w.force) + w.moment])
    return -load


def test_the_weight_is_in_the_sum_of_the_cones_and_not_in_their_intersection():
    wrench = np.array([0, 0, 500.0, 0, 0, 0])
    assert body_wrench_cone(FEET, (0, 0, 0)).contains(wrench)
    for foot in FEET:
        assert not body_wrench_cone([foot], (0, 0, 0)).contains(wrench)


def test_the_body_cone_is_spanned_by_the_transported_rays_of_the_contact_cones():
    pytest.importorskip("cdd")
    cone = body_wrench_cone(TILTED, (0.3, 0.2, 0.9), cone="inscribed", sides=5)
    rays = []
    for contact in TILTED:
        R, arm = np.asarray(contact.rotation), contact.position - np.array([0.3, 0.2, 0.9])
        for ray in contact_wrench_cone(contact, cone="inscribed", sides=5).spans().rays:
            f, m = R @ ray[:3], R @ ray[3:]
            rays.append(np.concatenate([f, m + np.cross(arm, f)]))
    form = cone.faces()
    assert form.excess(np.array(rays)).max() < 1e-9
    for ray in cone.spans().rays:
        along = np.array(rays) @ ray / np.linalg.norm(rays, axis=1) / np.linalg.norm(ray)
        assert along.max() > 1 - 1e-9


def test_a_stance_and_a_posture_bring_their_contacts():
    stance = random_stance(0, "sloped")
    wrench = needed(stance, stance.contacts.centre)
    assert body_wrench_cone(stance).distance(wrench) == body_wrench_cone(stance.contacts).distance(wrench)
    posture = ss.pose(ss.load_robot("hoap2"), {}, support=["left_foot", "right_foot"], friction=0.5)
    assert body_wrench_cone(posture, posture.com_W).contains([0, 0, posture.mass * 9.81, 0, 0, 0])


def test_corner_points_are_turned_with_the_sole():
    """A library moved the corners without turning them: wrong as soon as a sole is yawed or tilted."""
    contact = ss.SurfaceContact("foot", (0.3, -0.2, 0.1), rpy=(0.5, -0.4, 1.2), friction=0.6, size=(0.3, 0.05))
    cone = body_wrench_cone([contact], (0, 0, 0))
    for corner in points_of(contact):
        force = np.asarray(contact.rotation)[:, 2]
        assert cone.contains(np.concatenate([force, np.cross(corner, force)]))
        beyond = corner + 1e-3 * (corner - contact.position)
        assert not cone.contains(np.concatenate([force, np.cross(beyond, force)]))


def test_a_ceiling_pushes_down():
    """A library turned the cone of a ceiling into that of a floor."""
    for contact in (
        ss.PointContact("hand", (0, 0, 2), normal=DOWN, friction=0.5),
        ss.SurfaceContact("hands", (0, 0, 2), normal=DOWN, friction=0.5, size=(0.1, 0.2)),
    ):
        cone = body_wrench_cone([contact], (0, 0, 2))
        assert np.linalg.det(contact.rotation) == pytest.approx(1.0)
        assert cone.contains([0.3, 0.3, -1, 0, 0, 0]) and not cone.contains([0.3, 0.3, 1, 0, 0, 0])
        assert not cone.contains([0.4, 0.4, -1, 0, 0, 0])
        assert body_wrench_cone([contact], (0, 0, 2), cone="circumscribed").contains([0.4, 0.4, -1, 0, 0, 0])


@pytest.mark.parametrize("family", FAMILIES)
def test_consistency_agrees_with_the_verdict_of_the_conic_programs(family):
    pytest.importorskip("cdd")
    by = set()
    for seed in range(6):
        stance = random_stance(seed, family)
        for kind in ("exact", "inscribed", "circumscribed"):
            cone = body_wrench_cone(stance.contacts, stance.com, cone=kind)
            wrench = needed(stance, stance.com)
            answer = cone.consistency(wrench)
            by.add(answer.by)
            verdict = ss.check_equilibrium(stance, cone=kind, engine="clarabel").verdict
            assert verdict == ("stable" if answer.consistent else "unstable") or verdict == "undecided"
            assert cone.contains(wrench) == answer.consistent
            if not answer.consistent:
                assert answer.distance > 0.0 and answer.separating @ wrench > 0.0
                assert cone.support(answer.separating) <= 1e-9
            assert (answer.by == "support") == (answer.why is not None)
    assert by == {"faces", "support"}


def test_random_wrenches_agree_with_the_conic_programs():
    rng = np.random.default_rng(3)
    contacts = ss.ContactSet(
        [
            *TILTED,
            ss.PointContact("hand", (0.5, 0.2, 1.0), normal=(-1, 0, 0.1), friction=0.4),
            ss.SoftFingerContact("finger", (0.4, -0.4, 0.9), normal=(-1, 0.3, 0), friction=0.6, torsional_friction=0.03),
            ss.LineContact("edge", (-0.3, 0, 0.2), normal=(0.3, 0, 1), friction=0.5, size=0.2),
        ]
    )
    cone = body_wrench_cone(contacts)
    inside = 0
    for _ in range(60):
        wrench = rng.normal(size=6) * [0.6, 0.6, 0.6, 0.25, 0.25, 0.1] + [0, 0, 1.5, 0, 0, 0]
        asked = ss.check_equilibrium(
            contacts, (0, 0, 0), 1.0, gravity=(0, 0, 0), engine="clarabel",
            external_wrenches=[{"force": -wrench[:3], "moment": -wrench[3:], "point": contacts.centre}],
        )  # fmt: skip
        assert cone.contains(wrench) == (asked.verdict == "stable") or asked.verdict == "undecided"
        inside += asked.stable
    assert 10 < inside < 50


def test_a_handle_takes_what_it_transmits_to_both_sides():
    pytest.importorskip("cdd")
    bar = ss.Handle("bar", (0, 0, 1.0), normal=UP, transmits=["fx", "mx"])
    arm = bar.position - FEET[0].position
    for kind in ("exact", "inscribed"):
        cone = body_wrench_cone([FEET[0], bar], FEET[0].position, cone=kind)
        for pull in (-500.0, 500.0):
            force = np.array([pull, 0, 0])
            held = np.concatenate([force, np.cross(arm, force)]) + [0, 0, 100.0, -3 * pull, 0, 0]
            assert (
                cone.contains(held)
                and not cone.contains(held + [0, 60.0, 0, 0, 0, 0])
                and not cone.contains(held + [0, 0, -101.0, 0, 0, 0])
            )
        assert cone.support([1.0, 0, 0, 0, 0, 0]) == np.inf
    form, span = cone.faces(), cone.spans()
    assert np.allclose(form.faces @ span.lines.T, 0.0, atol=1e-12) and len(span.lines) == 2


def test_opposite_fingers_hold_every_wrench():
    pytest.importorskip("cdd")
    fingers = [
        ss.SoftFingerContact(f"finger{s}", (0, 0.05 * s, 0), normal=(0, -s, 0), friction=0.8, torsional_friction=0.02) for s in (1, -1)
    ]
    cone = body_wrench_cone(fingers, cone="inscribed")
    assert cone.faces().faces.shape == (0, 6) and cone.faces().equalities.shape == (0, 6)
    for wrench in np.random.default_rng(0).normal(size=(20, 6)):
        assert cone.consistency(wrench).consistent and body_wrench_cone(fingers).contains(wrench)


def test_many_rays_fall_back_to_a_supporting_plane():
    cone = body_wrench_cone([*FEET, *TILTED], cone="inscribed", sides=16)
    inside, outside = cone.consistency([0, 0, 500, 0, 0, 0]), cone.consistency([900, 0, 500, 0, 0, 0])
    assert inside.consistent and not outside.consistent and inside.by == outside.by == "support"
    assert "wrong tool for 256 rays" in inside.why
    assert outside.separating @ [900, 0, 500, 0, 0, 0] == pytest.approx(outside.distance)


# slices


@pytest.mark.parametrize("kind", ["inscribed", "circumscribed"])
@pytest.mark.parametrize("acceleration", [(0, 0, 0), (1.0, 0.5, 0.3)])
def test_a_slice_of_positions_is_the_support_region_of_the_gravity_that_is_felt(kind, acceleration):
    cone = body_wrench_cone(TILTED, (0.2, 0.1, 0.3), cone=kind)
    felt = np.array([0, 0, -9.81]) - acceleration
    region = ss.trace_support_region(TILTED, height=0.8, gravity=felt, cone=kind, tolerance=1e-9, engine="clarabel")
    cut = com_slice(cone, (0.2, 0.1, 0.3), 0.8, 60.0, acceleration=acceleration)
    assert cut.bounded and region.inner_area - 1e-7 <= cut.area <= region.outer_area + 1e-7
    assert (region.margin(cut.vertices) > -1e-6).all()
    x = np.random.default_rng(1).uniform(-0.3, 0.3, (20, 2))
    assert (cut.contains(x) == region.contains(x)).all()


def test_faces_and_rays_give_the_same_slice():
    pytest.importorskip("cdd")
    cone = body_wrench_cone(TILTED, (0, 0, 0), cone="inscribed")
    by_faces = com_slice(cone, (0, 0, 0), 0.8, 60.0, external_wrenches=[{"force": (30, 0, 0), "point": (0, 0, 1.2)}])
    by_rays = com_slice(cone, (0, 0, 0), 0.8, 60.0, external_wrenches=[{"force": (30, 0, 0), "point": (0, 0, 1.2)}])
    by_rays.__dict__["_faces"] = None
    assert (by_faces.by, by_rays.by) == ("faces", "support")
    assert by_faces.area == pytest.approx(by_rays.area, rel=1e-7) and by_faces.area > 0.01
    felt = ss.trace_support_region(
        TILTED, height=0.8, mass=60.0, cone="inscribed", tolerance=1e-9, engine="clarabel",
        external_wrenches=[{"force": (30, 0, 0), "point": (0, 0, 1.2)}],
    )  # fmt: skip
    assert by_faces.area == pytest.approx(felt.inner_area, rel=1e-6)


def test_a_slice_of_accelerations_agrees_with_verdicts():
    com = np.array([0.05, 0.0, 0.8])
    cone = body_wrench_cone(TILTED, com, cone="circumscribed")
    cut = acceleration_slice(cone, com, com, 60.0, vertical=1.0)
    assert cut.bounded and cut.unit == "m/s^2"
    for x in np.random.default_rng(2).uniform(-3, 3, (12, 2)):
        felt = np.array([0, 0, -9.81]) - [x[0], x[1], 1.0]
        assert (
            bool(cut.contains(x)) == ss.check_equilibrium(TILTED, com, 60.0, gravity=felt, cone="circumscribed", engine="clarabel").stable
        )


def test_slices_that_are_a_segment_a_point_empty_or_without_end():
    o = (0, 0, 0)
    line = body_wrench_cone([ss.LineContact("edge", o, normal=UP, friction=0.5, size=0.4)], o, cone="inscribed")
    cut = com_slice(line, o, 0.5, 10.0)
    assert np.allclose(sorted(cut.vertices.tolist()), [[-0.2, 0], [0.2, 0]], atol=1e-9) and cut.area == 0.0
    point = body_wrench_cone([ss.PointContact("toe", (0.1, 0.2, 0), normal=UP, friction=0.5)], o, cone="inscribed")
    assert np.allclose(com_slice(point, o, 0.5, 10.0).vertices, [[0.1, 0.2]], atol=1e-9)
    ceiling = body_wrench_cone([ss.PointContact("hand", (0, 0, 2), normal=DOWN, friction=0.5)], o, cone="inscribed")
    assert com_slice(ceiling, o, 0.5, 10.0).vertices.shape == (0, 2)
    bar = ss.Handle("bar", o, normal=UP, transmits=["fz", "mx", "my"])
    held = com_slice(body_wrench_cone([bar], o, cone="inscribed"), o, 0.5, 10.0)
    assert not held.bounded and held.area == pytest.approx(400.0)


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: body_wrench_cone([]), "at least one contact is expected"),
        (lambda: body_wrench_cone(FEET, (0, 0)), "stance|wrench|point must be 3 numbers"),
        (lambda: body_wrench_cone(FEET, length=np.nan), "length must be a finite number > 0"),
        (lambda: body_wrench_cone(FEET).consistency(np.zeros((2, 6))), r"wrench must have the shape \(6,\)"),
        (lambda: com_slice(body_wrench_cone(FEET), (0, 0, 0), 0.8, 60.0), "ask trace_support_region"),
        (lambda: acceleration_slice(body_wrench_cone(FEET), (0, 0, 0), (0, 0, 0.8), 60.0), "ask check_equilibrium"),
        (lambda: com_slice(body_wrench_cone(FEET, cone="inscribed"), (0, 0, 0), 0.8, 0.0), "mass must be a finite number > 0"),
        (lambda: com_slice(body_wrench_cone(FEET, cone="inscribed"), (0, 0, 0), 0.8, 1.0).support([1.0]), "direction must have the shape"),
    ],
)
def test_wrong_input_is_one_sentence(call, sentence):
    with pytest.raises(InputError, match=sentence):
        call()
