"""Affine force rules and ellipsoids of pushes: semidefinite programs against sampled truth and closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from plain_stances import feet, wall
from programs import stance_of_kind
from scipy.spatial import ConvexHull

import socp_statics as ss
from socp_statics.cones.choice import ConeChoice
from socp_statics.engines import engines_for
from socp_statics.exceptions import InputError
from socp_statics.models.inscribed_ellipsoid import padded
from socp_statics.stability.robustness import measure_robustness
from socp_statics.stability.robustness.disturbances import HORIZONTAL, pushes
from socp_statics.stability.robustness.ellipsoid import largest_ellipsoid
from socp_statics.stability.robustness.rule import ForceRule, check_rule, design_rule
from socp_statics.statics import assemble

ENGINE = ("clarabel", "cvxpy")
CLARABEL = engines_for("clarabel", "sdp")[0]
HAND = ss.PointContact("hand", (0.5, 0.1, 1.0), normal=(-1, 0, 0.1), friction=0.4)
CIRCLE = np.column_stack([f(np.linspace(0.0, 2.0 * np.pi, 361)) for f in (np.cos, np.sin)])


def designed(stance, cone="exact", axes=HORIZONTAL):
    choice = ConeChoice(cone)
    data = assemble(stance)
    return design_rule(data, pushes(stance, data, np.array(stance.com), None, axes).seen(), choice, "socp", CLARABEL)


def worst_sample(rule, directions=CIRCLE):
    return max(rule.residual(u) for u in directions)


# Kinds of stances that hold, with contacts of every type, bounds and limits.
STANCES = ("feet", "points", "wall hand", "box and line", "frictionless", "bounds", "upper bound", "handle", "all types")


@pytest.mark.parametrize("cone", ["exact", "inscribed", "circumscribed"])
@pytest.mark.parametrize("kind", STANCES)
def test_a_designed_rule_holds_every_push_of_its_disc(kind, cone):
    stance = stance_of_kind(kind)
    rule = designed(stance, cone)
    if rule.radius <= 1e-9:
        assert check_rule(rule, CLARABEL).holds
        return
    check = check_rule(rule, CLARABEL)
    assert check.holds, check
    assert worst_sample(rule) <= 1e-6
    wider = ForceRule(rule.data, rule.cone, rule.disturbance, 1.02 * rule.radius, rule.nominal, 1.02 * rule.reaction)
    again = check_rule(wider, CLARABEL)
    # the design is the largest for its own reaction, but where the radius is at its cap or a finger's bound is not tight
    if rule.radius < 29.0 and not rule.data.elliptic:
        assert not again.holds
        assert wider.residual(again.worst) > 1e-7


def test_the_check_tells_what_samples_tell():
    rng = np.random.default_rng(3)
    seen = set()
    rule = designed(stance_of_kind("wall hand"))
    for _ in range(30):
        shaken = rule.reaction * rng.uniform(0.2, 1.3)
        free = np.linalg.svd(rule.data.wrench_map)[2][6:].T
        nominal = rule.nominal + free @ rng.normal(0, 0.01, free.shape[1])
        given = ForceRule(rule.data, rule.cone, rule.disturbance, rule.radius * np.linalg.norm(shaken) / np.linalg.norm(rule.reaction),
                          nominal, shaken)  # fmt: skip
        check, sampled = check_rule(given, CLARABEL), worst_sample(given)
        seen.add(check.holds)
        if check.holds:
            assert sampled <= 1e-6
        else:
            assert given.residual(check.worst) > 5e-8
            assert sampled > 1e-8
    assert seen == {True, False}


def test_rules_reach_every_push_where_three_points_leave_no_choice():
    points = [ss.PointContact(f"p{k}", (np.cos(a), np.sin(a), 0), normal=(0, 0, 1), friction=5.0) for k, a in enumerate((0.0, 2.1, 4.2))]
    found = measure_robustness(points, (0, 0, 0.5), 10.0, measures=("push", "push_rule"), engine=ENGINE)
    assert found["push_rule"].value == pytest.approx(found["push"].value, rel=1e-3)
    assert found["push_rule"].kind == "exact"


def test_a_square_block_that_tips_needs_more_than_one_rule():
    # N_i = W/4 (1 + a (+-u_x +-u_y)): at the corners of the disc one rule gives up by 1/sqrt(2), while the best force does not
    sole = ss.SurfaceContact("sole", (0, 0, 0), normal=(0, 0, 1), friction=5.0, size=(0.2, 0.2))
    found = measure_robustness([sole], (0, 0, 0.5), 10.0, measures=("push_rule", "push"), engine=ENGINE)
    assert found["push"].value == pytest.approx(98.1 * 0.1 / 0.5, rel=1e-4)
    assert found["push_rule"].value == pytest.approx(98.1 * 0.1 / 0.5 / np.sqrt(2.0), rel=1e-4)
    assert found["push_rule"].kind == "lower bound"


def test_rules_of_more_coordinates():
    rule = designed(stance_of_kind("wall hand"), axes=np.eye(3))
    rng = np.random.default_rng(0)
    u = rng.normal(size=(300, 3))
    assert check_rule(rule, CLARABEL).holds
    assert worst_sample(rule, u / np.linalg.norm(u, axis=1)[:, None]) <= 1e-6


def test_a_rule_of_the_record_can_be_checked_as_a_given_one():
    contacts = ss.ContactSet([*feet(0.6), HAND])
    com, mass = (0.1, 0.0, 0.8), 60.0
    found = measure_robustness(contacts, com, mass, measures=("push_rule",), engine=ENGINE)["push_rule"]
    entries = found.details["rule"]
    np.testing.assert_allclose([e["point"] for e in entries], contacts.points_W, atol=1e-12)
    forces, gains = np.array([e["force"] for e in entries]), np.array([e["force_gain"] for e in entries])[:, :, :2]
    assert ss.check_push_rule(contacts, forces, gains, found.value, com, mass, engine=ENGINE).holds
    check = ss.check_push_rule(contacts, forces, gains, 1.05 * found.value, com, mass, engine=ENGINE)
    assert not check.holds
    f = forces + gains @ (1.05 * found.value * check.worst)
    local = np.array([c.rotation.T @ one for c, one in zip([c for c in contacts for _ in c.points_C], f, strict=True)])
    mu = np.array([c.friction for c in contacts for _ in c.points_C])
    assert (np.hypot(local[:, 0], local[:, 1]) - mu * local[:, 2]).max() > 1e-3
    unbalanced = ss.check_push_rule(contacts, 1.01 * forces, gains, found.value, com, mass, engine=ENGINE)
    assert not unbalanced.holds and unbalanced.balance > 1e-3 and unbalanced.worst is None


def test_given_rules_that_make_no_sense_are_refused():
    sole = ss.SurfaceContact("sole", (0, 0, 0), normal=(0, 0, 1), friction=0.5, size=(0.2, 0.2))
    good = np.full((4, 3), [0.0, 0.0, 24.525]), np.zeros((4, 3, 2))
    for forces, gains, radius, word in (
        (good[0][:3], good[1], 1.0, "forces must be 4x3 numbers"),
        (good[0], good[1][:, :, :1], 1.0, "gains must be 4x3x2 numbers"),
        (good[0], good[1], -1.0, "radius must be a finite number > 0"),
        (good[0] * np.nan, good[1], 1.0, "forces must be finite"),
    ):
        with pytest.raises(InputError, match=word):
            ss.check_push_rule([sole], forces, gains, radius, (0, 0, 0.5), 10.0, engine=ENGINE)
    grip = ss.Handle("rail", (0, 0, 1), normal=(0, 0, 1), transmits=["fx", "fz"])
    with pytest.raises(InputError, match="'rail': a force rule is for points, lines and surfaces"):
        ss.check_push_rule([sole, grip], *good, 1.0, (0, 0, 0.5), 10.0, engine=ENGINE)
    smooth = ss.FrictionlessPointContact("ball", (0, 0, 0), normal=(0, 0, 1))
    with pytest.raises(InputError, match="'ball': forces and gains must be along the normal"):
        ss.check_push_rule([smooth], np.array([[1.0, 0, 98.1]]), np.zeros((1, 3, 2)), 1.0, (0, 0, 0.5), 10.0, engine=ENGINE)
    with pytest.raises(InputError, match="does not take programs in form 'sdp'"):
        measure_robustness([sole], (0, 0, 0.5), 10.0, measures=("push_rule",), engine="kernel")


# Ellipsoids.


@pytest.mark.parametrize("k", [2, 3])
def test_the_largest_ellipsoid_of_a_box_and_of_a_simplex(k):
    half = np.array([1.0, 0.5, 0.2])[:k]
    box = largest_ellipsoid(np.vstack([np.eye(k), -np.eye(k)]), np.concatenate([half + 0.3, half - 0.1]), CLARABEL)
    np.testing.assert_allclose(box.centre, 0.2, atol=1e-6)
    np.testing.assert_allclose(box.shape, np.diag(half + 0.1), atol=1e-6)
    assert box.mean == pytest.approx(np.prod(half + 0.1) ** (1 / k), rel=1e-7)
    # John: the largest ellipsoid of a simplex is its image of the insphere; volume ratio of the regular one
    corners = np.vstack([np.zeros(k), np.diag([2.0, 1.0, 0.7][:k])])
    hull = ConvexHull(corners)
    found = largest_ellipsoid(hull.equations[:, :-1], -hull.equations[:, -1], CLARABEL)
    unit_ball = {2: np.pi, 3: 4.0 / 3.0 * np.pi}[k]
    share = {2: np.pi / np.sqrt(27.0), 3: np.pi * np.sqrt(3.0) / 18.0}[k]
    assert unit_ball * found.mean**k == pytest.approx(share * hull.volume, rel=1e-6)
    np.testing.assert_allclose(found.centre, corners.mean(axis=0), atol=1e-6)


def test_half_spaces_are_padded_without_changing_the_answer():
    a = np.array([[1.0, 0], [-1, 0], [0, 1], [0, -1], [0.6, 0.8]])
    padded_a, padded_b = padded(a, np.ones(5))
    assert len(padded_a) == len(padded_b) == 8
    assert {tuple(row) for row in padded_a} == {tuple(row) for row in a}


def test_the_ellipsoid_of_pushes_of_a_block_is_that_of_its_tipping_rectangle():
    sole = ss.SurfaceContact("sole", (0.02, 0, 0), normal=(0, 0, 1), friction=5.0, size=(0.3, 0.2))
    found = measure_robustness([sole], (0, 0, 0.5), 10.0, measures=("push_ellipsoid",), engine=ENGINE)["push_ellipsoid"]
    one = 98.1 / 0.5
    assert found.value == pytest.approx(one * np.sqrt(0.15 * 0.1), rel=1e-3)
    np.testing.assert_allclose(found.details["centre"], [0.02 * one, 0.0, 0.0], atol=1e-3 * one)
    lengths = np.linalg.norm(found.details["semi_axes"], axis=1)
    np.testing.assert_allclose(lengths, [0.15 * one, 0.1 * one], rtol=2e-3)


def test_every_push_of_the_ellipsoid_is_held():
    contacts, com, mass = ss.ContactSet(feet(0.35)), (0.02, 0.0, 0.3), 60.0
    found = measure_robustness(contacts, com, mass, measures=("push_ellipsoid",), engine=ENGINE)["push_ellipsoid"]
    lower, upper = found.bracket
    assert 0.999 * upper <= lower <= upper
    centre, axes = np.array(found.details["centre"]), np.array(found.details["semi_axes"])
    for u in CIRCLE[::30]:
        push = centre + (1.0 - 1e-6) * u @ axes
        wrench = {"force": push, "point": com}
        assert ss.check_equilibrium(contacts, com, mass, external_wrenches=[wrench], engine=ENGINE).verdict == "stable"


def test_pushes_without_area_or_end():
    line = [ss.PointContact(f"p{x}", (x, 0, 0), normal=(0, 0, 1), friction=0.5) for x in (-0.3, 0.3)]
    found = measure_robustness(line, (0, 0, 0.5), 10.0, measures=("push_ellipsoid", "push_rule"), engine=ENGINE)
    assert [found[name].value for name in ("push_ellipsoid", "push_rule")] == [0.0, 0.0]
    walls = [wall("left", 0.4), wall("right", -0.4)]
    found = measure_robustness(walls, (0, 0, 0.1), 10.0, measures=("push_ellipsoid", "push_rule"), engine=ENGINE)
    assert found["push_ellipsoid"].value == np.inf and found["push_ellipsoid"].kind == "exact"
    assert found["push_rule"].kind == "lower bound" and found["push_rule"].bracket[1] == np.inf
