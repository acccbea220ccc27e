"""Largest payloads and pushes: closed forms, brackets by linear programs, the stance at its limit, prices, words, bad input."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from changed_stances import changed, changed_posture, step
from oracles import HIGHS, linear_stance
from programs import CONES, KINDS, stance_of_kind
from random_stances import random_stance
from scipy.optimize import linprog
from torque_oracles import Linear, braced, full_jacobian, generate, random_limits

import socp_statics as ss
from socp_statics.cases.problem import load_problem
from socp_statics.exceptions import InputError
from socp_statics.robots import load_robot
from socp_statics.statics import assemble

ENGINE = ("clarabel", "cvxpy")
WEIGHT, HALF = 98.1, 0.15


@pytest.fixture(scope="module")
def hoap2():
    return load_robot("hoap2")


def block(mu=0.5, **more):
    foot = ss.SurfaceContact("sole", (0, 0, 0), normal=(0, 0, 1), friction=mu, size=(2 * HALF, 0.2), **more)
    return ss.Stance(ss.ContactSet([foot]), (0, 0, 0.2), WEIGHT / 9.81)


# closed forms


@pytest.mark.parametrize("engine", ["kernel", "clarabel", "cvxpy"])
@pytest.mark.parametrize("height", [0.05, 0.2, 0.29, 0.31, 0.5, 2.0])
@pytest.mark.parametrize("mu", [0.2, 0.5, 0.9])
def test_a_block_slides_or_tips(mu, height, engine):
    answer = ss.largest_push(block(mu), (3.0, 0, 0), (0, 0, height), engine=engine)
    slides, tips = mu * WEIGHT, WEIGHT * HALF / height
    assert answer.status == "solved"
    assert answer.objective == pytest.approx(min(slides, tips), rel=1e-7)
    if slides < 0.99 * tips:
        assert answer.beyond.reading == "slides along +x at sole"
        assert answer.prices.of("friction", "sole").value == pytest.approx(WEIGHT, rel=1e-5)
    if tips < 0.99 * slides:
        assert answer.beyond.reading == "tips about the front edge of sole"
        # F h = W a: a block further along the push by d tips later by W d / h.
        assert answer.prices.of("displacement", "sole", "x").value == pytest.approx(WEIGHT / height, rel=1e-5)


@pytest.mark.parametrize("reach", [0.151, 0.2, 1.0, 20.0])
def test_the_lever_rule(reach):
    answer = ss.largest_payload(block(), (reach, 0, 0.7), engine=ENGINE)
    assert answer.objective == pytest.approx(10.0 * HALF / (reach - HALF), rel=1e-6)
    assert answer.forces.force_W.sum(axis=0) == pytest.approx([0, 0, WEIGHT + 9.81 * answer.objective], rel=1e-6, abs=1e-6)


def test_an_upward_push_lifts_the_block():
    assert ss.largest_push(block(), (0, 0, 1), (0, 0, 0.3), engine=ENGINE).objective == pytest.approx(WEIGHT, rel=1e-7)


def test_a_bound_of_the_normal_force_is_what_is_left_of_it():
    answer = ss.largest_payload(block(normal_force=(0.0, 150.0)), (0.05, 0, 0.3), engine=ENGINE)
    assert answer.objective == pytest.approx((150.0 - WEIGHT) / 9.81, rel=1e-7)
    assert answer.prices.of("normal_force", "sole", "upper").value == pytest.approx(1.0 / 9.81, rel=1e-6)
    assert answer.prices.stopping[0].words == "sole upper normal-force bound"


def test_a_payload_hangs_along_gravity():
    tilted = replace(block(), gravity=(1.0, 0.0, -9.0))
    answer = ss.largest_payload(tilted, (0.2, 0, 0.0), engine=ENGINE)
    assert answer.load.direction == pytest.approx(np.array([1.0, 0, -9.0]) / math.sqrt(82.0))
    # moments about (0.15, 0, 0): 10 (9 x 0.15 - 1 x 0.2) = m (9 x 0.05)
    assert answer.objective == pytest.approx(10.0 * (9 * 0.15 - 0.2) / (9 * 0.05), rel=1e-6)


def test_a_push_in_a_direction_that_contacts_cannot_reach():
    """Two smooth points on a line: whatever turns about it cannot be held, whatever does not can."""
    points = [ss.FrictionlessPointContact(name, (x, 0, 0), normal=(0, 0, 1)) for name, x in (("a", -1.0), ("b", 1.0))]
    stance = ss.Stance(ss.ContactSet(points), (0, 0, 0), 10.0)
    assert ss.largest_push(stance, (0, 1, 0), (0, 0, 0), engine=ENGINE).objective == pytest.approx(0.0, abs=1e-6)
    assert ss.largest_push(stance, (0, 0, -1), (0.5, 0, 0), engine=ENGINE).status == "unbounded"


# independent programs


def bracket(stance, load, kind: str, sides: int) -> float:
    """Largest load [N] by a linear program over pyramids that shares nothing with the package; inf where it has no end."""
    m = linear_stance(stance, kind, sides)
    arm = (load.point - m.centre) / m.size
    P = np.concatenate([load.direction, np.cross(arm, load.direction)])
    rows = np.vstack([m.inside, m.outside]) if len(m.outside) else m.inside
    fixed = m.lo == m.hi
    A_eq = [np.column_stack([rows @ m.A, rows @ P]), np.column_stack([m.sums[fixed], np.zeros(fixed.sum())])]
    b_eq = [-rows @ m.load, m.lo[fixed]]
    A_ub = np.vstack([-m.sums, m.sums])[np.r_[~fixed, ~fixed & np.isfinite(m.hi)]]
    b_ub = np.r_[-m.lo, m.hi][np.r_[~fixed, ~fixed & np.isfinite(m.hi)]]
    n = m.A.shape[1]
    found = linprog(
        np.r_[np.zeros(n), -1.0], np.column_stack([A_ub, np.zeros(len(A_ub))]), b_ub, np.vstack(A_eq), np.concatenate(b_eq),
        [*m.box, (0.0, None)], options=HIGHS,
    )  # fmt: skip
    assert found.status in (0, 2, 3, 4), found.message
    return -found.fun * m.weight if found.status == 0 else math.nan if found.status == 2 else math.inf


@pytest.mark.parametrize("kind", [k for k in KINDS if k != "outside"])
def test_linear_programs_over_pyramids_bracket_it(kind):
    stance = stance_of_kind(kind)
    rng = np.random.default_rng(1)
    for _ in range(3):
        direction, point = rng.normal(size=3), rng.uniform(-0.3, 0.3, 3) + [0, 0, 0.5]
        answer = ss.largest_push(stance, direction, point, engine=ENGINE)
        if answer.status == "infeasible":
            assert answer.equilibrium.verdict == "unstable"
            continue
        inner, outer = (bracket(stance, answer.load, side, 64) for side in ("inscribed", "circumscribed"))
        assert math.isnan(inner) or inner * (1 - 1e-6) - 1e-5 <= answer.objective
        assert answer.objective <= outer * (1 + 1e-6) + 1e-5
        if math.isfinite(outer) and inner == inner:
            assert outer - inner <= 0.05 * max(outer, 1.0) + 1.0


@pytest.mark.parametrize("cone", ["inscribed", "circumscribed"])
def test_pyramids_equal_their_linear_program(cone):
    for seed in range(4):
        stance = random_stance(seed, "feet_and_hands")
        answer = ss.largest_push(stance, (1.0, 0.3, 0.2), (0.1, 0, 0.6), cone=cone, sides=5, engine=ENGINE)
        if answer.status != "solved":
            continue
        assert answer.objective == pytest.approx(bracket(stance, answer.load, cone, 5), rel=1e-6, abs=1e-4)


def test_robots_are_bracketed_too(hoap2):
    """Linear programs over all 6 + n rows of the robot with Pinocchio's own Jacobians, torque limits included."""
    rng = np.random.default_rng(11)
    statuses = set()
    for _ in range(14):
        posture, limits = braced(hoap2, rng), random_limits(hoap2, rng, 9.0)
        link, direction = str(rng.choice(["LARM_LINK4", "BODY_LINK1", "RLEG_LINK4"])), rng.normal(size=3)
        direction /= np.linalg.norm(direction)
        point = posture.link_placement(link)[1] + rng.uniform(-0.05, 0.05, 3)
        answer = ss.largest_push(posture, direction, point, link=link, torque_limits=limits, engine=ENGINE)
        statuses.add(answer.status)
        j = full_jacobian(posture, link, point)[:3].T @ direction
        found = []
        for kind in ("inscribed", "circumscribed"):
            program = Linear(posture, kind, 32, limits)
            A, end, offset = program.torque_rows()
            lower, upper = program.limits.T
            # Along the push the robot's rows read g + J' F w = T z + tau.
            moved = np.r_[j[6:][np.isfinite(upper)], -j[6:][np.isfinite(lower)]]
            cost = np.r_[np.zeros(program.T.shape[1]), -1.0]
            value = program._solve(cost, np.column_stack([A, -moved]), end - offset, j[:6])
            found.append(None if value is None else -value)
        inner, outer = found
        if answer.status == "infeasible":
            assert inner is None
            continue
        assert answer.status == "solved"
        assert (inner if inner is not None else 0.0) - 1e-5 <= answer.objective <= outer * (1 + 1e-6) + 1e-5
    assert "solved" in statuses


# at the limit


def loaded(stance, answer, share):
    """The stance with a share of the largest load on it."""
    return replace(stance, external_wrenches=(*stance.external_wrenches, answer.load.wrench(share * answer.objective)))


@pytest.mark.parametrize("family", ["feet_and_hands", "sloped", "mix", "loads", "tilted_gravity", "tiny", "far", "heavy"])
def test_the_stance_stands_just_below_the_limit_and_falls_just_above(family):
    seen = 0
    for seed in range(16):
        stance = random_stance(seed, family)
        P = stance.contacts.points_W
        answer = ss.largest_payload(stance, P.mean(axis=0) + (P[0] - P.mean(axis=0)) * [3, 3, 1], engine=ENGINE)
        if answer.status != "solved" or answer.objective < 1e-3 * stance.mass:
            continue
        below, above = (ss.check_equilibrium(loaded(stance, answer, 1.0 + s * 1e-6), engine=ENGINE).margin for s in (-1.0, 1.0))
        assert above < below and below > -1e-9 * stance.weight and above < 1e-9 * stance.weight
        assert ss.check_equilibrium(loaded(stance, answer, 0.999), engine=ENGINE).margin > below
        assert ss.check_equilibrium(loaded(stance, answer, 1.001), engine=ENGINE).verdict == "unstable"
        seen += 1
    assert seen >= 1


def test_a_robot_stands_just_below_the_limit_and_falls_just_above(hoap2):
    squat = generate("squat", hoap2)
    limits = {"default": 9.0, "?LEG_JOINT*": 2.0}
    for ask in (
        lambda: ss.largest_payload(squat, link="LARM_LINK4", torque_limits=limits, engine=ENGINE),
        lambda: ss.largest_push(squat, (-1, 0, 0), link="BODY_LINK1", torque_limits=limits, engine=ENGINE),
        lambda: ss.largest_push(squat, (0, 1, 0), link="BODY_LINK1", engine=ENGINE),
    ):
        answer = ask()
        within = limits if answer.torque_limits else False
        for share, verdict in ((1.0 - 1e-6, True), (1.0 + 1e-6, False)):
            stance = squat.stance(external_wrenches=[answer.load.wrench(share * answer.objective)], torque_limits=within)
            found = ss.check_equilibrium(stance, engine=ENGINE)
            assert (found.margin > -1e-9) is verdict, (share, found.margin)


def test_forces_at_the_limit_balance_it_within_cones_and_torque_limits(hoap2):
    squat = generate("squat", hoap2)
    answer = ss.largest_payload(squat, link="LARM_LINK4", torque_limits={"default": 9.0, "?LEG_JOINT*": 2.0}, engine=ENGINE)
    stance = squat.stance(external_wrenches=[answer.load.wrench(answer.objective)])
    f, p = answer.forces.force_W, answer.forces.point_W
    load = answer.load.wrench(answer.objective).force
    weight = stance.mass * stance.gravity
    assert f.sum(axis=0) + load + weight == pytest.approx(np.zeros(3), abs=1e-7)
    moments = np.cross(p, f).sum(axis=0) + np.cross(answer.load.point, load) + np.cross(stance.com, weight)
    assert moments == pytest.approx(np.zeros(3), abs=1e-7)
    assert (np.linalg.norm(f[:, :2], axis=1) <= 0.5 * f[:, 2] + 1e-7).all()
    for joint, (lower, upper) in answer.torque_limits.items():
        assert lower - 1e-7 <= answer.torques[joint] <= upper + 1e-7
    # The torques are those of a posture that carries the payload as an external wrench.
    again = ss.optimise_contact_forces(stance, "reference", reference_forces={
        w["contact"]: w["force"] for w in answer.forces.wrenches()}, engine=ENGINE)  # fmt: skip
    assert again.objective == pytest.approx(0.0, abs=1e-8)


def test_forces_without_end_are_a_direction_of_the_cones():
    stance = load_problem("contacts/push_that_jams").stance()
    answer = ss.largest_push(stance, (0.4, 0, -1), (0.05, 0, 0.05), engine=ENGINE)
    assert (answer.status, answer.objective, answer.prices, answer.beyond) == ("unbounded", math.inf, None, None)
    f, p = answer.growth.force_W, answer.growth.point_W
    assert f.sum(axis=0) + answer.load.direction == pytest.approx(np.zeros(3), abs=1e-9)
    assert np.cross(p, f).sum(axis=0) + np.cross(answer.load.point, answer.load.direction) == pytest.approx(np.zeros(3), abs=1e-9)
    assert (np.linalg.norm(f[:, :2], axis=1) <= 0.5 * f[:, 2] + 1e-9).all()
    for k in (1.0, 1e3, 1e6):
        pushed = replace(stance, external_wrenches=(answer.load.wrench(k),))
        assert ss.check_equilibrium(pushed, engine=ENGINE).margin > -1e-7 * k


def test_not_even_zero_load():
    stance = load_problem("contacts/slope_block_slides").stance()
    answer = ss.largest_payload(stance, (0, 0, 1.0), engine=ENGINE)
    assert (answer.status, answer.objective, answer.forces) == ("infeasible", None, None)
    assert answer.equilibrium.certificate.contacts == {"sole": "slides"}


@pytest.mark.parametrize("cone", CONES)
def test_engines_agree(cone):
    choice, form = CONES[cone]
    for kind in ("feet", "wall hand", "bounds", "handle", "all types"):
        stance = stance_of_kind(kind)
        found = []
        for engine in ("clarabel", "cvxpy", *(["kernel"] if form == "socp" else [])):
            found.append(ss.largest_push(stance, (1.0, 0.2, 0.1), (0.1, 0, 0.4), cone=choice, form=form, engine=engine))
        assert len({a.status for a in found}) == 1
        if found[0].status == "solved":
            assert [a.objective for a in found] == pytest.approx([found[0].objective] * len(found), rel=1e-6)


# prices


def test_prices_of_a_push_are_derivatives():
    compared = 0
    for kind in ("feet", "wall hand", "elliptic", "bounds", "handle", "all types"):
        stance = stance_of_kind(kind)

        def ask(s):
            return ss.largest_push(s, (1.0, 0.3, 0.1), (0.05, 0.02, 0.5), engine=ENGINE)

        answer = ask(stance)
        if answer.status != "solved":
            continue
        units = assemble(stance).units
        for price in answer.prices.entries:
            if not price.unique:
                continue
            h = step(price, units.force, units.length)
            try:
                up, down = (ask(changed(stance, price, s * h)).objective for s in (1.0, -1.0))
            except InputError:
                continue  # a lower bound of zero has no smaller one
            amount = 1e-5 * units.force / h
            assert price.value == pytest.approx((up - down) / (2 * h), rel=1e-4, abs=1e-4 * amount), price
            compared += 1
    assert compared > 30


def test_prices_of_a_payload_on_a_robot_are_derivatives(hoap2):
    squat = generate("squat", hoap2)
    limits = dict(zip(hoap2.joints, squat.torque_limits({"default": 9.0, "?LEG_JOINT*": 2.0}).tolist(), strict=True))
    point = squat.link_placement("LARM_LINK4")[1]

    def ask(posture, ends):
        return ss.largest_payload(posture, point, link="LARM_LINK4", torque_limits=ends, engine=ENGINE)

    answer = ask(squat, limits)
    assert {p.kind for p in answer.prices.stopping} == {"torque_limits"}
    names = {p.name for p in answer.prices.stopping} | {"left_foot", "right_foot"}
    for price in answer.prices.entries:
        if price.name in names and price.unique:
            h = step(price, 60.0, 0.2)
            up, down = (ask(*changed_posture(squat, limits, price, s * h)).objective for s in (1.0, -1.0))
            assert price.value == pytest.approx((up - down) / (2 * h), rel=1e-4, abs=1e-3), price
