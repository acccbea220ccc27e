"""Verdicts and margins against linear programs over pyramids, forces and motions against checks from scratch."""

from functools import cache

import numpy as np
import pytest
from oracles import largest_loads, linear_stance, margin, scales
from random_stances import FAMILIES, SCALED, random_stance
from rechecks import force_violations, motion_power

from socp_statics.cones.choice import ConeChoice
from socp_statics.contacts import (
    ExternalWrench,
    FrictionlessPointContact,
    Handle,
    PointContact,
    SoftFingerContact,
    Stance,
    SurfaceContact,
)
from socp_statics.stability import check_equilibrium

SEEDS = range(14)
EXACT = ConeChoice()
SIDES = 32
UP = [0, 0, 1]


@cache
def stance_of_seed(family, seed):
    return random_stance(seed, family)


@cache
def exact_answer(family, seed):
    return check_equilibrium(stance_of_seed(family, seed))


def bracket(stance):
    return tuple(margin(linear_stance(stance, kind, SIDES)) for kind in ("inscribed", "circumscribed"))


def assert_bracketed(stance, answer):
    """The margin lies between those of pyramids inside and outside the cones; returns these."""
    W, _, _ = scales(stance)
    low, high = bracket(stance)
    slack = 1e-6 * max(W, abs(answer.margin) if np.isfinite(answer.margin) else 0.0)
    assert low - slack <= answer.margin <= high + slack
    return low, high


def assert_proven(stance, answer, choice):
    """The certificate holds when everything is recomputed from positions and rotations."""
    W, _, _ = scales(stance)
    if answer.verdict == "stable":
        balance, cone = force_violations(stance, answer.forces, choice)
        assert balance <= 1e-8
        assert cone <= 1e-8
    if answer.verdict == "unstable":
        power, violation = motion_power(stance, answer.certificate, choice)
        assert violation <= 1e-7
        assert power > 0
        assert power == pytest.approx(answer.certificate.power, rel=1e-6, abs=1e-10 * W)
        assert set(answer.certificate.contacts) == {c.name for c in stance.contacts}
        assert answer.forces is None


@pytest.mark.parametrize("family", [*FAMILIES, *SCALED])
def test_no_verdict_contradicts_the_linear_bracket(family):
    for seed in SEEDS:
        stance, answer = stance_of_seed(family, seed), exact_answer(family, seed)
        W, _, _ = scales(stance)
        low, high = assert_bracketed(stance, answer)
        assert answer.verdict in ("stable", "unstable"), (family, seed)
        if low > 1e-7 * W:
            assert answer.verdict == "stable", (family, seed)
        if high < -1e-7 * W:
            assert answer.verdict == "unstable", (family, seed)
        assert answer.handovers == 0, (family, seed)
        assert_proven(stance, answer, EXACT)


def test_the_random_stances_are_stable_and_unstable_alike():
    verdicts = [exact_answer(family, seed).verdict for family in (*FAMILIES, *SCALED) for seed in SEEDS]
    assert len(verdicts) >= 200
    assert verdicts.count("stable") >= 0.3 * len(verdicts)
    assert verdicts.count("unstable") >= 0.3 * len(verdicts)
    margins = [exact_answer(family, seed).margin for family in (*FAMILIES, *SCALED) for seed in SEEDS]
    assert np.isposinf(margins).sum() >= 5


PYRAMIDS = (
    ConeChoice("inscribed", 4, 0.0),
    ConeChoice("circumscribed", 4, 0.3),
    ConeChoice("inscribed", 3, 0.7),
    ConeChoice("circumscribed", 5, 0.1),
)


@pytest.mark.parametrize("family", [*FAMILIES, "tiny", "far"])
def test_pyramids_have_the_margin_of_the_same_linear_program(family):
    for seed in SEEDS[:8]:
        stance, choice = stance_of_seed(family, seed), PYRAMIDS[seed % 4]
        W, _, _ = scales(stance)
        answer = check_equilibrium(stance, cone=choice)
        expected = margin(linear_stance(stance, choice.kind, choice.sides, choice.heading, stated=True))
        if np.isfinite(expected):
            assert answer.margin == pytest.approx(expected, abs=1e-6 * max(W, abs(expected))), (family, seed)
        else:
            assert answer.margin == expected, (family, seed)
        assert answer.verdict == ("stable" if expected > 0 else "unstable")
        assert_proven(stance, answer, choice)


def closing_walls(mu, beyond, up):
    """Two pairs of points facing each other, their normals turned up (or down) to where the cones cease to see each other."""
    tilt = np.arctan(mu) + beyond
    return [
        PointContact(f"{name}{k}", [x, y, 0], normal=[0, -np.sign(y) * np.cos(tilt), up * np.sin(tilt)], friction=mu)
        for name, y in (("left", 0.4), ("right", -0.4))
        for k, x in enumerate((-0.1, 0.1))
    ]


@pytest.mark.parametrize("mu", [0.01, 0.5, 2.0])
@pytest.mark.parametrize("beyond", [1e-2, 1e-4, 1e-6, -1e-6, -1e-4, -1e-2])
@pytest.mark.parametrize("up", [1, -1])
def test_the_margin_is_infinite_exactly_where_walls_close_the_force(mu, beyond, up):
    stance = Stance(closing_walls(mu, beyond, up), [0, 0, 0.2], 60.0)
    answer = check_equilibrium(stance)
    assert answer.margin == np.inf if beyond < 0 else np.isfinite(answer.margin)
    assert_bracketed(stance, answer)
    assert answer.verdict == ("stable" if beyond < 0 or up > 0 else "unstable")
    assert_proven(stance, answer, EXACT)


@pytest.mark.parametrize("eps", [1e-3, 1e-5, 2e-6, 1e-6, 5e-7, 1e-7])
@pytest.mark.parametrize("sign", [1, -1])
def test_frictionless_walls_nearly_opposite_are_settled(eps, sign):
    floor = SurfaceContact("floor", [0, 0, 0], normal=UP, friction=0.01, size=[0.2, 0.1])
    left = FrictionlessPointContact("left", [0, 0.4, 0.5], normal=[0, -1, sign * eps])
    right = FrictionlessPointContact("right", [0, -0.4, 0.5], normal=[0, 1, 0])
    stance = Stance([floor, left, right], [0.05, 0, 0.5], 60.0)
    answer = check_equilibrium(stance)
    assert_bracketed(stance, answer)
    assert_proven(stance, answer, EXACT)


@pytest.mark.parametrize("exponent", [-3, -5, -7, -8])
@pytest.mark.parametrize("mu", [0.01, 2.0])
def test_points_nearly_on_a_line_are_judged_right(exponent, mu):
    off = 10.0**exponent
    contacts = [
        PointContact(f"p{k}", p, normal=[0.02 * k, 0, 1], friction=mu) for k, p in enumerate(([-0.3, 0, 0], [0.3, 0, 0.01], [0.05, off, 0]))
    ]
    for shift, inside in ((0.3, True), (0.9, True), (-0.4, False), (1.4, False)):
        if mu < 0.1 and inside:
            continue
        stance = Stance(contacts, [0.05, shift * off, 0.5], 60.0)
        answer = check_equilibrium(stance)
        _, high = assert_bracketed(stance, answer)
        assert answer.verdict == ("stable" if high > 0 else "unstable")
        assert_proven(stance, answer, EXACT)


@pytest.mark.parametrize("family", ["flat", "sloped", "feet_and_hands", "points"])
def test_verdicts_next_to_the_boundary_are_right(family):
    checked = 0
    for seed in range(6):
        stance = stance_of_seed(family, seed)
        W, size, centre = scales(stance)

        def share(u, stance=stance, W=W, size=size, centre=centre):
            at = Stance(stance.contacts, [*(centre[:2] + [u * size, 0.0]), stance.com[2]], stance.mass)
            return check_equilibrium(at).margin / W, at

        if not 0 < share(0.0)[0] < np.inf or share(2.0)[0] > 0:
            continue
        inside, outside = 0.0, 2.0
        while outside - inside > 1e-5:
            middle = 0.5 * (inside + outside)
            inside, outside = (middle, outside) if share(middle)[0] > 0 else (inside, middle)
        a, b = share(inside)[0], share(outside)[0]
        for target in (1e-6, -1e-6, 3e-7, -3e-7):
            found, at = share(inside + (a - target) / (a - b) * (outside - inside))
            if abs(found - target) > 1e-7:
                continue
            answer = check_equilibrium(at)
            assert answer.verdict == ("stable" if target > 0 else "unstable")
            assert_proven(at, answer, EXACT)
            checked += 1
    assert checked >= 6


PLANTED = {
    "on an edge": ([SurfaceContact("foot", [0, 0, 0], normal=UP, friction=0.6, size=[0.2, 0.1])], [0.1, 0.0, 0.5]),
    "on a corner": ([SurfaceContact("foot", [0, 0, 0], normal=UP, friction=0.6, size=[0.2, 0.1])], [0.1, 0.05, 0.5]),
    "just outside an edge, slippery": (
        [SurfaceContact("foot", [0, 0, 0], normal=UP, friction=2.0, size=[0.2, 0.1])],
        [0.1 + 3e-8, 0.0, 0.5],
    ),
    "just inside an edge": ([SurfaceContact("foot", [0, 0, 0], normal=UP, friction=2.0, size=[0.2, 0.1])], [0.1 - 3e-8, 0.0, 0.5]),
    "over one of two points": (
        [PointContact("a", [0, 0.1, 0], normal=UP, friction=0.5), PointContact("b", [0, -0.1, 0], normal=UP, friction=0.5)],
        [0.0, 0.1, 0.5],
    ),
    "on a slope of the angle of friction": ([PointContact("a", [0, 0, 0], normal=[0.5, 0, 1], friction=0.5)], [0.0, 0.0, 0.5]),
}


@pytest.mark.parametrize("case", PLANTED)
def test_planted_boundaries_are_undecided(case):
    contacts, com = PLANTED[case]
    answer = check_equilibrium(contacts, com, 60.0)
    assert (answer.verdict, answer.reason) == ("undecided", "boundary")
    assert abs(answer.margin) < 1e-7 * 60 * 9.81
    assert answer.certificate is None
    assert_bracketed(Stance(contacts, com, 60.0), answer)


def test_a_load_barely_out_of_reach_is_undecided_by_rank():
    points = [PointContact("a", [0, 0.1, 0], normal=UP, friction=0.5), PointContact("b", [0, -0.1, 0], normal=UP, friction=0.5)]
    answer = check_equilibrium(points, [1e-9, 0.0, 0.5], 60.0)
    assert (answer.verdict, answer.reason) == ("undecided", "rank")
    assert np.isnan(margin(linear_stance(Stance(points, [1e-9, 0.0, 0.5], 60.0), "inscribed", 8)))


def test_idle_contacts_decide_as_the_contract_says():
    floor = SurfaceContact("floor", [0, 0, 0], normal=UP, friction=0.0, size=[0.2, 0.1])
    wall = FrictionlessPointContact("wall", [0.1, 0, 0.5], normal=[-1, 0, 0])
    inside = check_equilibrium([floor, wall], [0, 0, 0.5], 60.0)
    alone = check_equilibrium([floor], [0, 0, 0.5], 60.0)
    assert (inside.verdict, inside.idle) == ("stable", ("wall",))
    assert inside.idle_margin == pytest.approx(alone.margin, abs=1e-5)
    assert abs(inside.margin) < 1e-7 * 60 * 9.81
    assert_proven(Stance([floor, wall], [0, 0, 0.5], 60.0), inside, EXACT)
    loads = largest_loads(linear_stance(Stance([floor, wall], [0, 0, 0.5], 60.0), "circumscribed", 8))
    assert loads["wall"] == pytest.approx(0.0, abs=1e-9)
    assert loads["floor"] == pytest.approx(1.0, abs=1e-9)
    outside = check_equilibrium([floor, wall], [0.2, 0, 0.5], 60.0)
    assert outside.verdict == "unstable"
    assert_proven(Stance([floor, wall], [0.2, 0, 0.5], 60.0), outside, EXACT)


UNBOUNDED = {
    "a handle alone": ([Handle("bar", [0, 0, 1], normal=UP, transmits=["fx", "fy", "fz", "mx", "my", "mz"])], [0.3, 0, 0], np.inf),
    "a handle too weak": (
        [Handle("bar", [0, 0, 1], normal=UP, transmits=["fx", "fy", "fz", "mx", "my"], limits={"fz": (-100, 100)})],
        [0, 0, 0],
        -np.inf,
    ),
    "one point and a lever": ([PointContact("p", [0, 0, 0], normal=UP, friction=1.0)], [0.1, 0, 1], -np.inf),
    "two points and a lever": (
        [PointContact("a", [0, 0.1, 0], normal=UP, friction=1.0), PointContact("b", [0, -0.1, 0], normal=UP, friction=1.0)],
        [0.1, 0, 1],
        -np.inf,
    ),
    "a foot that must carry nothing": (
        [SurfaceContact("foot", [0, 0, 0], normal=UP, friction=1.0, size=[0.2, 0.1], normal_force=[0, 0])],
        [0, 0, 1],
        -np.inf,
    ),
    "a chimney": (
        [SurfaceContact(n, [0, y, 0], normal=[0, -y, 0], friction=0.4, size=[0.2, 0.1]) for n, y in (("left", 0.3), ("right", -0.3))],
        [0, 0, 0],
        np.inf,
    ),
    "a chimney with a bound": (
        [
            SurfaceContact("left", [0, 0.3, 0], normal=[0, -1, 0], friction=0.4, size=[0.2, 0.1], normal_force=[0, 2000]),
            SurfaceContact("right", [0, -0.3, 0], normal=[0, 1, 0], friction=0.4, size=[0.2, 0.1]),
        ],
        [0, 0, 0],
        None,
    ),
    "a hand on a rail over a foot": (
        [
            SurfaceContact("foot", [0, 0, 0], normal=UP, friction=0.4, size=[0.2, 0.1]),
            Handle("rail", [0.3, 0, 1], normal=UP, transmits=["fx", "fz"]),
        ],
        [0, 0, 1],
        np.inf,
    ),
    "a ceiling": ([PointContact("c", [0, 0, 0], normal=[0, 0, -1], friction=1.0)], [0, 0, -1], None),
    "soft fingers in a pinch": (
        [
            SoftFingerContact(n, [0, y, 0], normal=[0, -y, 0], friction=0.4, torsional_friction=0.02, shape=shape)
            for n, y, shape in (("a", 0.03, "elliptic"), ("b", -0.03, "box"))
        ],
        [0.02, 0, -0.1],
        np.inf,
    ),
}


@pytest.mark.parametrize("case", UNBOUNDED)
def test_margins_without_end_are_recognised(case):
    contacts, com, expected = UNBOUNDED[case]
    stance = Stance(contacts, com, 60.0)
    answer = check_equilibrium(stance)
    low, high = assert_bracketed(stance, answer)
    if expected is None:
        assert np.isfinite(answer.margin)
    else:
        assert answer.margin == low == high == expected
        assert answer.status == ("unbounded" if expected > 0 else "infeasible")
        assert answer.verdict == ("stable" if expected > 0 else "unstable")
    assert_proven(stance, answer, EXACT)


def test_forces_of_an_infinite_margin_balance_as_well_as_any():
    stance = Stance(closing_walls(1.0, -1e-7, -1), [0, 0, 0.2], 60.0)
    answer = check_equilibrium(stance)
    assert answer.verdict == "stable"
    assert_proven(stance, answer, EXACT)


def test_bounds_shift_with_the_reserve():
    foot = SurfaceContact("foot", [0, 0, 0], normal=UP, friction=0.6, size=[0.2, 0.1], normal_force=[500, 650])
    stance = Stance([foot], [0, 0, 0.5], 60.0)
    weight = 60 * 9.81
    assert check_equilibrium(stance).margin == pytest.approx(min(weight / 4, weight - 500, 650 - weight), abs=1e-4)
    push = ExternalWrench(force=[0, 0, 30], point=[0, 0, 0.5])
    pushed = Stance([foot], [0, 0, 0.5], 60.0, external_wrenches=(push,))
    assert check_equilibrium(pushed).margin == pytest.approx(weight - 30 - 500, abs=1e-4)
