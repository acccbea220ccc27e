"""Measures of robustness: closed forms, an independent conic program as the truth, invariances, and postures without reserve."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from plain_stances import feet, hoap2_soles, pinch, wall
from random_stances import FAMILIES, moved, random_stance
from robustness_oracle import LENGTH, PLAIN, disturbed, slack

import socp_statics as ss
from socp_statics.cases.answers import robustness_keys
from socp_statics.contacts import ContactSet, ExternalWrench, Stance
from socp_statics.contacts.stance import stance_of
from socp_statics.optimization import minimise_largest_wrench
from socp_statics.stability.robustness import DEFAULT_MEASURES, MEASURES, measure_robustness
from socp_statics.stability.robustness.assess import UNITS

ENGINE = ("clarabel", "cvxpy")
G = 9.81
BALLS = ("push", "force", "wrench", "com", "mass_and_com")


def block(mu=0.5, size=(0.3, 0.2), normal=(0, 0, 1)):
    return ss.SurfaceContact("sole", (0, 0, 0), normal=normal, friction=mu, size=size)


def measured(contacts, com=None, mass=None, *names, **more):
    return measure_robustness(contacts, com, mass, measures=names or DEFAULT_MEASURES, engine=more.pop("engine", ENGINE), **more)


def random_balls(k, count, rng):
    u = rng.normal(size=(count, k))
    return u / np.linalg.norm(u, axis=1)[:, None]


# Closed forms.


@pytest.mark.parametrize("height", [0.2, 0.6])
@pytest.mark.parametrize("mu", [0.1, 0.3, 1.0])
def test_a_block_slides_or_tips(mu, height):
    found = measured([block(mu)], (0, 0, height), 10.0, *DEFAULT_MEASURES)
    slope = min(mu, 0.1 / height)
    assert found["push"].value == pytest.approx(10.0 * G * slope, rel=2e-3)
    assert found["force"].value == pytest.approx(10.0 * G * slope / np.hypot(1.0, slope), rel=2e-3)
    assert found["tilt"].value == pytest.approx(np.degrees(np.arctan(slope)), rel=2e-3)
    assert found["com"].value == pytest.approx(0.1, rel=1e-6)
    assert found["friction"].value == 0.0
    assert all(found[name].kind == "exact" for name in ("push", "force", "tilt", "com", "friction"))
    word = "slides" if mu < 0.1 / height else "tips"
    assert word in found["push"].beyond.reading


def test_a_push_above_the_centre_of_mass_tips_sooner():
    found = measured([block(2.0)], (0, 0, 0.2), 10.0, "push", point=(0.0, 0.0, 0.5))
    assert found["push"].value == pytest.approx(10.0 * G * 0.1 / 0.5, rel=1e-6)
    np.testing.assert_allclose(np.abs(found["push"].direction), [0.0, 1.0, 0.0], atol=1e-6)


@pytest.mark.parametrize("angle", [0.1, 0.3])
def test_critical_friction_is_the_tangent_of_the_slope(angle):
    sole = block(0.5, normal=(np.sin(angle), 0, np.cos(angle)))
    found = measured([sole], (0, 0, 0.02), 10.0, "friction", "tilt")
    assert found["friction"].value == pytest.approx(np.tan(angle) / 0.5, rel=1e-5)
    lower, upper = found["friction"].bracket
    assert lower < np.tan(angle) / 0.5 <= upper
    assert "slides" in found["friction"].beyond.reading
    assert found["tilt"].value == pytest.approx(np.degrees(np.arctan(0.5) - angle), rel=2e-3)


def test_an_unstable_slope_says_how_much_more_friction_it_takes():
    found = measured([block(0.2, normal=(0.3, 0, 1))], (0, 0, 0.02), 10.0)
    assert found["friction"].value == pytest.approx(1.5, rel=1e-5)
    for name in ("push", "force", "com", "tilt", "placement"):
        assert found[name].value is None
        assert found[name].note == "unstable: no reserve"


def test_no_friction_holds_what_tips():
    found = measured([block(0.5)], (0, 0.2, 0.5), 10.0, "friction")["friction"]
    assert (found.value, found.kind, found.note) == (np.inf, "exact", "no friction can hold it")


def test_any_friction_braces_between_walls():
    found = measured([wall("left", 0.4), wall("right", -0.4)], (0, 0, 0.1), 60.0, "friction", "push", "com", "tilt", "wrench")
    assert found["friction"].value <= 1e-6
    assert found["friction"].note == "any friction will do"
    assert all(found[name].value == np.inf and found[name].kind == "exact" for name in ("push", "com", "wrench"))
    assert found["tilt"].value == 180.0


def test_the_ellipsoid_of_mass_and_first_moment_of_a_block():
    # d(mc) - c dm tips it: with semi-axes (a, b) about c = 0 the limit is s b = 0.1 (m - s' a) along the worst mix of the two
    a, b, m = 1.0, 0.1, 10.0
    found = measured([block()], (0, 0, 0.5), m, "mass_and_com", ellipsoid=(a, b, b, b))["mass_and_com"]
    assert found.value == pytest.approx(0.1 * m / np.hypot(b, 0.1 * a), rel=1e-6)
    assert found.as_record()["kind"] == "exact"


def test_the_wrench_ball_of_a_point_on_the_floor_is_nothing():
    found = measured([ss.PointContact("p", (0, 0, 0), normal=(0, 0, 1), friction=0.5)], (0, 0, 0.5), 10.0, "wrench", "push", "com")
    assert [found[name].value for name in ("wrench", "push", "com")] == [0.0, 0.0, 0.0]
    assert "which cannot resist it" in found["com"].beyond.reading


def test_friction_intervals_are_decided_at_their_lower_ends():
    sole = block(0.5, normal=(0.3, 0, 1))
    ends = {0.31: ("stable", "stable"), 0.2: ("unstable", "stable")}
    for lo, words in ends.items():
        found = measured([sole], (0, 0, 0.02), 10.0, "friction_interval", friction_intervals={"default": [lo, 0.9]})["friction_interval"]
        assert tuple(found.details["verdicts"].values()) == words
        direct = ss.check_equilibrium([block(lo, normal=(0.3, 0, 1))], (0, 0, 0.02), 10.0, engine=ENGINE)
        assert found.value == pytest.approx(direct.margin, abs=1e-9)
        assert found.kind == "exact"
    named = measured([sole], (0, 0, 0.02), 10.0, "friction_interval", friction_intervals={"sole": [0.1, 0.2]})["friction_interval"]
    assert named.note == "holds for none of them"


def test_soft_fingers_and_bounds_have_robustness_too():
    fingers = [ss.SoftFingerContact(f"f{x}", (x, 0, 0), normal=(0.1 * x, 0, 1), friction=0.6, torsional_friction=0.02) for x in (-1.0, 1.0)]
    alone = measured(fingers, (0, 0, -0.3), 10.0, "push")["push"]
    assert 0.0 < alone.value < 1.0  # only their torsion, about normals that lean, resists turning about the line of the fingers
    wide = [*fingers, ss.PointContact("p", (0, 0.5, 0), normal=(0, 0, 1), friction=0.5, normal_force=(1.0, 40.0))]
    found = measured(wide, (0, 0.1, -0.3), 10.0, *MEASURES, friction_intervals={"p": [0.2, 0.6]})
    assert 0.0 < found["wrench"].value < found["force"].value <= found["push"].value
    assert found["friction"].kind == found["friction_interval"].kind == "exact"
    assert 0.0 < found["push_rule"].value <= found["push"].value * (1 + 1e-6)


# Truth by an independent program.


@pytest.mark.parametrize("family", PLAIN)
def test_samples_never_refute_a_radius_and_reach_beyond_it_fails(family):
    rng = np.random.default_rng(0)
    stances = (random_stance(seed, family) for seed in range(20))
    for stance in [s for s in stances if ss.check_equilibrium(s, engine=ENGINE).margin > 1e-3][:1]:
        found = measured(stance, None, None, *BALLS, "tilt", length=LENGTH)
        sizes = {"push": 2, "force": 3, "wrench": 6, "com": 3, "mass_and_com": 4}
        for name, k in sizes.items():
            m = found[name]
            if not np.isfinite(m.value):
                continue
            for u in random_balls(k, 3, rng):
                assert disturbed(stance, name, np.append(u, 0.0) if name == "push" else u, (1.0 - 1e-6) * m.value) > -1e-6, (name, u)
            assert disturbed(stance, name, np.asarray(m.direction), 1.002 * m.bracket[1] + 1e-6 * k) < 1e-7, name
        if found["tilt"].value < 180.0:
            for way in random_balls(3, 3, rng):
                assert disturbed(stance, "tilt", way, (1.0 - 1e-6) * found["tilt"].value) > -1e-6
            assert disturbed(stance, "tilt", np.asarray(found["tilt"].direction), 1.003 * found["tilt"].bracket[1] + 1e-4) < 1e-6


HAND = ss.PointContact("hand", (0.5, 0.1, 1.0), normal=(-1, 0, 0.1), friction=0.4)


@pytest.mark.parametrize("contacts", [feet(0.4), hoap2_soles(), [block(0.6), HAND]], ids=["feet", "soles", "hand"])
def test_contacts_may_be_misplaced_by_the_lower_bound(contacts):
    stance = stance_of(contacts, (0.01, 0.0, 0.5), 20.0)
    found = measured(stance, None, None, "placement", "com")
    lower, upper = found["placement"].bracket
    assert 0.0 < lower <= upper <= found["com"].bracket[1] * (1 + 1e-9)
    rng = np.random.default_rng(1)
    for _ in range(12):
        by = random_balls(3, len(contacts), rng)
        displaced = [c.placed(c.position + lower * d, c.rotation.copy(), c.friction) for c, d in zip(contacts, by, strict=True)]
        assert slack(replace(stance, contacts=ContactSet(displaced))) > -1e-7
    alike = np.asarray(found["com"].direction) * upper * 1.002
    displaced = [c.placed(c.position - alike, c.rotation.copy(), c.friction) for c in contacts]
    assert slack(replace(stance, contacts=ContactSet(displaced))) < 1e-7


def test_critical_friction_is_the_friction_use():
    for seed in range(12):
        stance = random_stance(seed, "sloped")
        answer = ss.check_equilibrium(stance, engine=ENGINE)
        if not answer.stable or answer.margin < 1e-3:
            continue
        use = minimise_largest_wrench(stance, "friction_use", engine=ENGINE)
        found = measured(stance, None, None, "friction")["friction"]
        assert found.value == pytest.approx(use.objective, abs=2e-5)


def test_the_region_and_the_error_of_the_centre_of_mass_agree():
    for seed in range(6):
        stance = random_stance(seed, "feet_and_hands")
        if not ss.check_equilibrium(stance, engine=ENGINE).stable:
            continue
        region = ss.trace_support_region(stance, 1e-4, engine=ENGINE)
        assert measured(stance, None, None, "com")["com"].value == pytest.approx(region.com_margin, rel=3e-3, abs=1e-6)


# Symmetry, scaling, order.


@pytest.mark.parametrize("family", ["feet_and_hands", "points"])
def test_scaling_turning_and_weighing(family):
    names = ("push", "force", "com", "tilt", "friction")
    stance = next(s for s in (random_stance(k, family) for k in range(20)) if ss.check_equilibrium(s, engine=ENGINE).margin > 1.0)
    a = measured(stance, None, None, *names)
    turn = np.array([[np.cos(0.7), -np.sin(0.7), 0], [np.sin(0.7), np.cos(0.7), 0], [0, 0, 1]])
    b = measured(moved(stance, scale=3.0, shift=(5.0, -2.0, 1.0), turn=turn, mass=2.0 * stance.mass), None, None, *names)
    for name, factor in (("push", 2.0), ("force", 2.0), ("com", 3.0), ("tilt", 1.0), ("friction", 1.0)):
        assert b[name].value == pytest.approx(factor * a[name].value, rel=2e-3, abs=1e-6), name


def test_more_friction_or_better_cones_never_hurt():
    values = []
    for mu, cone in ((0.2, "inscribed"), (0.2, "exact"), (0.2, "circumscribed"), (0.4, "circumscribed"), (0.8, "circumscribed")):
        found = measured([block(mu), HAND], (0.05, 0.01, 0.6), 20.0, "push", "com", "tilt", "wrench", cone=cone)
        values.append([found[name].value for name in ("push", "com", "tilt", "wrench")])
    assert (np.diff(values, axis=0) >= -2e-3 * np.array(values)[1:]).all()


def test_engines_agree():
    stance = stance_of(feet(0.9), (0.02, 0.01, 0.7), 40.0)
    names = ("push", "com", "tilt", "friction", "mass_and_com")
    answers = [measured(stance, None, None, *names, engine=engine) for engine in ("clarabel", "cvxpy", "kernel")]
    for name in names:
        first, *others = (a[name].value for a in answers)
        assert others == pytest.approx([first, first], rel=2e-3)


def test_external_wrenches_are_part_of_the_load():
    pushed = Stance(ContactSet([block(0.5)]), (0, 0, 0.2), 10.0, external_wrenches=(ExternalWrench((20.0, 0, 0), point=(0, 0, 0.2)),))
    found = measured(pushed, None, None, "push", "tilt")
    assert found["push"].value == pytest.approx(10.0 * G * 0.5 - 20.0, rel=2e-3)
    # the push does not tilt with gravity: it slides where 20 + W sin a = mu W cos a
    a = np.radians(found["tilt"].value)
    assert 20.0 + 98.1 * np.sin(a) == pytest.approx(0.5 * 98.1 * np.cos(a), rel=2e-3)


def test_gravity_free_postures_have_nothing_to_tilt():
    found = measured(Stance(ContactSet(pinch()), (0, 0, 0), 1.0, gravity=(0, 0, 0)), None, None, "tilt", "com")
    assert found["tilt"].note in ("there is no gravity to tilt", "undecided: no reserve")
    assert found["com"].value in (None, np.inf)


# Robots.


@pytest.fixture(scope="module")
def squat():
    robot = ss.load_robot("hoap2")
    angles = {f"{side}LEG_JOINT{k}": angle for side in "LR" for k, angle in ((3, -0.5), (4, 1.0), (5, -0.5))}
    return ss.pose(robot, angles, support=["left_foot", "right_foot"], friction=0.5)


def test_torque_limits_count(squat):
    limits = {"default": float("inf"), "?LEG_JOINT4": 1.6}
    names = ("push", "force", "com", "tilt", "wrench", "placement")
    free, weak = (measured(squat, None, None, *names, torque_limits=t) for t in (False, limits))
    assert free["placement"].value > 0.0
    assert weak["placement"].value is None
    assert "torque limits" in weak["placement"].note
    for name in names[:-1]:
        assert weak[name].value <= free[name].value * 1.002
    assert weak["com"].value < 0.9 * free["com"].value
    assert "give way at the torque limit" in weak["com"].beyond.reading


def test_pushes_at_a_link_load_its_joints(squat):
    limits = {"default": float("inf"), "LARM_JOINT?": 0.5}
    at_base = measured(squat, None, None, "push", torque_limits=limits, point=squat.link_placement("LARM_LINK4")[1])["push"]
    at_hand = measured(squat, None, None, "push", torque_limits=limits, link="LARM_LINK4")["push"]
    assert at_hand.value < 0.8 * at_base.value
    direction = np.asarray(at_hand.direction)
    most = ss.largest_push(squat, direction, link="LARM_LINK4", torque_limits=limits, engine=ENGINE).objective
    assert at_hand.bracket[0] * (1 - 1e-6) <= most <= at_hand.bracket[1] * (1 + 1e-6)


def test_a_tilt_with_torque_limits_turns_the_weight_of_the_limbs_too(squat):
    limits = {"default": float("inf"), "?LEG_JOINT4": 1.6}
    found = measured(squat, None, None, "tilt", torque_limits=limits)["tilt"]
    gravity = G * np.asarray(found.direction)
    down = np.array([0.0, 0.0, -G])
    for share, verdict in ((0.99, "stable"), (1.01, "unstable")):
        turned = down + share * (gravity - down)
        turned *= G / np.linalg.norm(turned)
        assert ss.check_equilibrium(squat, gravity=turned, torque_limits=limits, engine=ENGINE).verdict == verdict


def test_measures_have_names_units_and_lines():
    assert tuple(UNITS) == MEASURES == robustness_keys.MEASURES
    assert DEFAULT_MEASURES == robustness_keys.DEFAULT_MEASURES
    assert set(PLAIN) <= set(FAMILIES)


@pytest.mark.parametrize("family", ["flat", "sloped", "feet_and_hands", "points"])
def test_balls_over_pyramids_are_distances_to_the_faces_of_the_body_wrench_cone(family):
    pytest.importorskip("cdd")
    stances = (random_stance(seed, family) for seed in range(20))
    stance = next(s for s in stances if ss.check_equilibrium(s, cone="inscribed", engine=ENGINE).margin > 1.0 and len(s.contacts) < 4)
    faces = ss.body_wrench_cone(stance, stance.com, cone="inscribed").faces()
    reaction = np.concatenate([-stance.mass * np.asarray(stance.gravity), np.zeros(3)])
    assert not len(faces.equalities) and not stance.external_wrenches
    room = -faces.faces @ reaction
    found = measured(stance, None, None, "push", "force", "wrench", cone="inscribed", length=LENGTH)
    for name, axes in (("push", np.eye(6)[:, :2]), ("force", np.eye(6)[:, :3]), ("wrench", np.diag([1.0] * 3 + [LENGTH] * 3))):
        reach = np.linalg.norm(faces.faces @ axes, axis=1)
        exact = float((room[reach > 1e-9] / reach[reach > 1e-9]).min())
        lower, upper = found[name].bracket
        assert lower * (1 - 1e-6) <= exact <= upper * (1 + 1e-6), name
        assert lower >= 0.97 * exact
