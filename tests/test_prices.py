"""Prices against central differences of re-solved margins; units, complementarity, degenerate optima, words and records."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from changed_stances import changed, changed_posture, step
from programs import CONES, KINDS, stance_of_kind
from random_stances import FAMILIES, SCALED, moved, random_stance
from scipy.optimize import minimize_scalar
from torque_oracles import braced, generate, random_limits

import socp_statics as ss
from socp_statics.cases.problem import load_problem
from socp_statics.cases.solve import solve
from socp_statics.cases.summary import summarise
from socp_statics.cli import main
from socp_statics.exceptions import InputError
from socp_statics.robots import load_robot
from socp_statics.statics import assemble

ENGINE = ("clarabel", "cvxpy")
RELATIVE = 1e-4


@pytest.fixture(scope="module")
def hoap2():
    return load_robot("hoap2")


def difference(value, h):
    return (value(h) - value(-h)) / (2.0 * h)


def compare(prices, value, force, length, one, larger=1.0):
    """Compare all unique prices with central differences; returns how many were compared and how many left out.

    Args:
        prices: The prices.
        value: (price, h) -> objective with that number changed by h.
        force: W of the stance.
        length: Its size.
        one: What counts as a price of one in the objective's unit, by all of the number.
        larger: How many times larger steps are than usual, where the objective is known less well.
    """
    compared = left_out = 0
    for price in prices.entries:
        if not price.unique:
            left_out += 1
            continue
        h = larger * step(price, force, length)
        try:
            found = difference(lambda s, price=price: value(price, s), h)
        except InputError:
            assert price.kind == "normal_force"  # a lower bound of zero has no smaller one
            continue
        amount = larger * one * 1e-5 / h
        assert price.value == pytest.approx(found, rel=RELATIVE, abs=RELATIVE * amount), (price, found)
        compared += 1
    return compared, left_out


def margin_of(stance, choice="exact"):
    return ss.check_equilibrium(stance, cone=choice, engine=ENGINE).margin


@pytest.mark.parametrize("cone", CONES)
def test_prices_are_derivatives_for_every_kind_of_contact_and_cone(cone):
    choice, form = CONES[cone]
    total = np.zeros(2, dtype=int)
    for kind in KINDS:
        stance = stance_of_kind(kind)
        answer = ss.check_equilibrium(stance, cone=choice, form=form, engine=ENGINE)
        if answer.prices is None:
            assert not np.isfinite(answer.margin)
            continue
        units = assemble(stance).units
        total += compare(
            answer.prices, lambda p, h, s=stance: margin_of(changed(s, p, h), choice), units.force, units.length, units.force
        )
    compared, left_out = total
    assert compared > 120
    assert left_out <= 0.1 * compared, f"{left_out} of {compared + left_out} prices are not unique"


@pytest.mark.parametrize("engine", ["kernel", "clarabel"])
@pytest.mark.parametrize("family", [*FAMILIES, *SCALED])
def test_prices_are_derivatives_at_random_stances(family, engine):
    compared = left_out = 0
    for seed in range(3):
        stance = random_stance(seed, family)
        prices = ss.check_equilibrium(stance, engine=(engine, "clarabel")).prices
        if prices is None or prices.objective != "margin":
            continue
        units = assemble(stance).units
        a, b = compare(prices, lambda p, h, s=stance: margin_of(changed(s, p, h)), units.force, units.length, units.force)
        compared, left_out = compared + a, left_out + b
    assert left_out <= 0.1 * compared, f"{left_out} of {compared + left_out} prices are not unique"


def test_prices_of_a_robot_are_derivatives(hoap2):
    """Braced postures with random torque limits: some stable, some not, some with limits that cannot be met."""
    rng = np.random.default_rng(5)
    objectives, active, compared, left_out = set(), 0, 0, 0
    for _ in range(12):
        posture, limits = braced(hoap2, rng), random_limits(hoap2, rng, 6.0)
        answer = ss.check_equilibrium(posture, engine=ENGINE, torque_limits=limits)
        prices = answer.prices
        if prices is None:
            continue
        objectives.add(prices.objective)
        active += any(p.kind == "torque_limits" for p in prices.stopping)

        def value(p, h, posture=posture, limits=limits, objective=prices.objective):
            other, ends = changed_posture(posture, limits, p, h)
            found = ss.check_equilibrium(other, engine=ENGINE, torque_limits=ends)
            return found.margin if objective == "margin" else -found.prices.value

        units = assemble(posture.stance()).units
        one = units.force if prices.objective == "margin" else units.force * units.length
        stopping = {p.name for p in prices.stopping} | {p.name for p in prices.entries if p.kind != "torque_limits"}
        asked = type(prices)(prices.objective, prices.unit, prices.value, tuple(p for p in prices.entries if p.name in stopping))
        a, b = compare(asked, value, units.force, units.length, one)
        compared, left_out = compared + a, left_out + b
    assert "margin" in objectives and active >= 3 and compared > 100
    assert left_out <= 0.1 * compared, f"{left_out} of {compared + left_out} prices are not unique"


def test_the_shortfall_of_torque_limits_and_its_prices(hoap2):
    record = solve(load_problem("hoap2/weak_knees"), ENGINE)
    prices = record["prices"]["shortfall"]
    # The knees share 2.9 N m whatever the soles do: each N m of one lets both limits give way by half a N m less.
    assert prices["torque_limits"] == {j: {"lower": pytest.approx(0.5, abs=1e-6)} for j in ("LLEG_JOINT4", "RLEG_JOINT4")}
    assert (prices["unit"], prices["unique"]) == ("N m", True)
    squat = generate("squat", hoap2)
    wide = {"default": np.inf, "?LEG_JOINT4": [-1.0 - 1.001 * prices["value"], 4.0]}
    assert ss.check_equilibrium(squat, torque_limits=wide, engine=ENGINE).stable
    wide["?LEG_JOINT4"] = [-1.0 - 0.999 * prices["value"], 4.0]
    assert not ss.check_equilibrium(squat, torque_limits=wide, engine=ENGINE).stable
    assert "more on each would do" in summarise(record)


def test_a_joint_without_a_motor(hoap2):
    """Limits of zero leave no room: their price is what a little room would gain."""
    rng = np.random.default_rng(2)
    posture = braced(hoap2, rng)
    limits = {"default": np.inf, "LARM_JOINT4": 0.0, "RARM_JOINT1": 0.0}
    answer = ss.check_equilibrium(posture, torque_limits=limits, engine=ENGINE)
    worth = [p for p in answer.prices.entries if p.kind == "torque_limits"]
    assert len(worth) == 4 and all(p.unique for p in worth)
    assert sum(p.value > 0.0 for p in worth) == 2  # each joint would use one of its ends
    for price in worth:
        h = 1e-5
        wider = limits | {price.name: [-h, 0.0] if price.end == "lower" else [0.0, h]}
        gain = (ss.check_equilibrium(posture, torque_limits=wider, engine=ENGINE).margin - answer.margin) / h
        assert price.value == pytest.approx(gain, rel=1e-3, abs=1e-2)


# the distance to the edge of the region


def distance_to_the_edge(stance, near: float, engine=ENGINE, choice="exact") -> float:
    """min over directions near an angle of h(d) - d . c, by searching for it."""

    def height(angle):
        d = np.array([np.cos(angle), np.sin(angle)])
        return float(ss.support_function(stance, d[None], engine=engine, cone=choice).height[0] - d @ stance.com[:2])

    return minimize_scalar(height, bounds=(near - 0.05, near + 0.05), method="bounded", options={"xatol": 1e-9}).fun


def nearest_angle(region, com) -> float:
    A, b = region.halfplanes
    nearest = A[int(np.argmin(b - A @ com[:2]))]
    return float(np.arctan2(nearest[1], nearest[0]))


@pytest.mark.parametrize("family", ["feet_and_hands", "points", "ladder", "mix", "tilted_gravity"])
def test_prices_of_the_com_margin_are_derivatives(family):
    compared = 0
    for seed in range(3):
        stance = random_stance(seed, family)
        region = ss.trace_support_region(stance, engine=ENGINE)
        if region.kind != "polygon":
            continue
        inside = 0.6 * region.inner.mean(axis=0) + 0.4 * region.inner[0]
        stance = replace(stance, com=np.append(inside, stance.com[2]))
        region = ss.trace_support_region(stance, engine=ENGINE)
        prices = ss.com_margin_prices(stance, region, engine=ENGINE)
        units, angle = assemble(stance).units, nearest_angle(region, stance.com)
        assert prices.value == pytest.approx(distance_to_the_edge(stance, angle), abs=1e-7 * units.length)
        a, _ = compare(
            prices, lambda p, h, s=stance, t=angle: distance_to_the_edge(changed(s, p, h), t), units.force, units.length, units.length,
            larger=30.0,
        )  # fmt: skip
        compared += a
    assert compared >= 5


@pytest.mark.parametrize(("family", "seed"), [*((f, s) for f in (*FAMILIES, *SCALED) for s in (0, 1)), ("far", 24)])
def test_prices_are_those_of_the_nearest_edge(family, seed):
    """Also where the polygon is coarse near the centre of mass, as of regions without end."""
    stance = random_stance(seed, family)
    region = ss.trace_support_region(stance, engine=ENGINE)
    prices = ss.com_margin_prices(stance, region, engine=ENGINE)
    if prices is not None:
        assert prices.value == pytest.approx(region.com_margin, rel=2e-3, abs=1e-7 * region.size)
    else:
        assert region.kind not in ("polygon", "unbounded") or region.widened or not np.isfinite(region.com_margin)


def test_prices_of_the_com_margin_outside_are_derivatives():
    problem = load_problem("contacts/leaning_too_far")
    stance = problem.stance()
    region = ss.trace_support_region(stance, engine=ENGINE)
    prices = ss.com_margin_prices(stance, region, engine=ENGINE)
    assert prices.value == pytest.approx(region.com_margin, rel=2e-3) and prices.value < 0.0
    for price in prices.entries:
        h = step(price, 600.0, 1.0)

        def value(s, price=price):
            other = changed(stance, price, s)
            return ss.com_margin_prices(other, ss.trace_support_region(other, engine=ENGINE), engine=ENGINE).value

        assert price.value == pytest.approx(difference(value, h), rel=RELATIVE, abs=RELATIVE)


def test_knees_push_the_edge_of_a_frozen_region(hoap2):
    squat = generate("squat", hoap2)
    limits = {"default": np.inf, "?LEG_JOINT*": 2.0}
    region = ss.trace_support_region(squat, torque_limits=limits, engine=ENGINE)
    prices = ss.com_margin_prices(squat, region, torque_limits=limits, engine=ENGINE)
    assert {p.name for p in prices.stopping} == {"LLEG_JOINT4", "RLEG_JOINT4"}
    # A N m at one knee takes the load 1 / W further from it.
    weight = squat.mass * 9.81
    assert sum(p.value for p in prices.stopping) == pytest.approx(2.0 / weight, rel=1e-4)


def test_regions_without_an_edge_have_no_prices():
    for name in ("contacts/chimney", "degenerate/two_points", "degenerate/one_point", "contacts/push_slides"):
        problem = load_problem(name)
        stance = problem.stance()
        assert ss.com_margin_prices(stance, ss.trace_support_region(stance, engine=ENGINE), engine=ENGINE) is None
    stance = load_problem("contacts/climber").stance()  # a strip has two edges
    assert ss.com_margin_prices(stance, ss.trace_support_region(stance, engine=ENGINE), engine=ENGINE).value == pytest.approx(0.4)


def test_two_edges_equally_near_are_not_unique():
    foot = ss.SurfaceContact("foot", (0, 0, 0), normal=(0, 0, 1), friction=0.5, size=(0.2, 0.2))
    stance = ss.Stance(ss.ContactSet([foot]), (0.0, 0.0, 0.5), 10.0)
    region = ss.trace_support_region(stance, engine=ENGINE)
    assert not ss.com_margin_prices(stance, region, engine=ENGINE).of("displacement", "foot", "x").unique


# closed forms, units, complementarity


def test_a_block_on_a_slope_gains_what_the_closed_form_says():
    record = solve(load_problem("contacts/slope_block_slides"), ENGINE)
    posture = record["case"]["posture"]
    f = record["case"]["generated"]["contacts"][0]
    n = np.array(f["rotation"])[:, 2]
    weight = posture["mass"] * 9.81
    # |W sin| <= mu (W cos - 4 t): t = (W cos - W sin / mu) / 4
    slope = np.hypot(n[0], n[1])
    prices = record["prices"]["margin"]
    assert prices["friction"]["sole"] == pytest.approx(weight * slope / f["friction"] ** 2 / 4.0, rel=1e-6)
    assert prices["stopped_by"][0] == {"what": "sole friction", "price": prices["friction"]["sole"], "per": "1"}


@pytest.mark.parametrize("family", ["feet_and_hands", "mix", "points"])
def test_units_do_not_matter(family):
    rng = np.random.default_rng(3)
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    turn *= np.linalg.det(turn)
    stance = random_stance(1, family)
    if stance.external_wrenches or any(c.normal_force is not None or hasattr(c, "limits") for c in stance.contacts):
        stance = ss.Stance(stance.contacts, stance.com, stance.mass, stance.gravity)
    other = moved(stance, scale=7.0, shift=(100.0, -30.0, 5.0), turn=turn)
    a, b = (ss.check_equilibrium(s, engine=ENGINE).prices for s in (stance, other))
    names = stance.contacts.names
    for p, q in zip(a.entries, b.entries, strict=True):
        assert (p.kind, p.name, p.end, p.unique) == (q.kind, q.name, q.end, q.unique)
        if p.kind == "friction":
            assert q.value == pytest.approx(p.value, rel=1e-6, abs=1e-6 * stance.weight)
    for name in names:
        gain = [np.array([prices.of("displacement", name, axis).value for axis in "xyz"]) for prices in (a, b)]
        assert gain[1] * 7.0 == pytest.approx(turn @ gain[0], abs=2e-6 * stance.weight)


def test_what_is_not_used_up_is_worth_nothing():
    """Complementarity: friction only at points that slip, bounds and limits only where they are reached."""
    seen = 0
    for kind in KINDS:
        stance = stance_of_kind(kind)
        answer = ss.check_equilibrium(stance, engine=ENGINE)
        if answer.prices is None:
            continue
        data, x, t = assemble(stance), answer.optimum.x, answer.optimum.reserve
        f_t, f_n = x[data.tangential].reshape(-1, 2), x[data.normal][: data.slipping]
        slack = data.friction * (f_n - t) - np.linalg.norm(f_t, axis=1)
        for k, name in enumerate(data.names):
            mine = (data.contact_of_point[: data.slipping] == k) & (np.arange(data.slipping) < data.circular)
            if mine.any() and slack[mine].min() > 1e-5:
                assert answer.prices.of("friction", name).value == 0.0
                seen += 1
        for (lo, hi), k in zip(data.bounds, data.bounded, strict=True):
            total = x[data.normal][data.contact_of_point == k].sum()
            if lo < hi and total - t - lo > 1e-5:
                assert answer.prices.of("normal_force", data.names[k], "lower").value == 0.0
            if np.isfinite(hi) and lo < hi and hi - t - total > 1e-5:
                assert answer.prices.of("normal_force", data.names[k], "upper").value == 0.0
        if len(data.limit_values):
            slack_rows = data.limit_values - data.limit_rows @ x
            assert (np.abs(answer.optimum.multipliers.limits[slack_rows > 1e-5]) < 1e-6).all()
    assert seen >= 3


def test_friction_is_never_worth_less_than_nothing():
    for family in FAMILIES:
        prices = ss.check_equilibrium(random_stance(7, family), engine=ENGINE).prices
        for price in prices.entries if prices is not None else ():
            assert price.kind == "displacement" or price.end == "equal" or price.value >= 0.0


# where multipliers or forces are not unique


def test_a_derivative_that_differs_with_the_sign_is_not_called_unique():
    """A block pushed so high that it would tip and slide at once: more friction gains nothing, less costs."""
    weight, a, mu, push = 98.1, 0.15, 0.5, 30.0
    foot = ss.SurfaceContact("sole", (0, 0, 0), normal=(0, 0, 1), friction=mu, size=(2 * a, 0.2))
    load = ss.ExternalWrench(force=(push, 0, 0), point=(0, 0, a / mu))
    stance = ss.Stance(ss.ContactSet([foot]), (0, 0, 0.2), weight / 9.81, external_wrenches=(load,))
    for engine in (ENGINE, "kernel"):
        answer = ss.check_equilibrium(stance, engine=engine)
        price = answer.prices.of("friction", "sole")
        assert not price.unique and not answer.prices.unique
        assert 0.0 <= price.value <= push / (4.0 * mu**2) + 1e-6
    h = 1e-4
    up, down = ((margin_of(changed(stance, price, s * h)) - answer.margin) / (s * h) for s in (1.0, -1.0))
    assert up == pytest.approx(0.0, abs=1e-3)
    assert down == pytest.approx(push / (4.0 * mu**2), rel=1e-3)


def test_two_points_in_one_place():
    """Coincident points below the centre of mass: friction of neither stops it, and a displacement has no derivative."""
    points = [ss.PointContact(name, (0, 0, 0), normal=(0, 0, 1), friction=0.4) for name in ("a", "b")]
    prices = ss.check_equilibrium(ss.Stance(ss.ContactSet(points), (0, 0, 0.3), 10.0), engine=ENGINE).prices
    assert not prices.of("displacement", "a", "x").unique  # any displacement makes the load fall out of reach
    assert prices.of("friction", "a").unique and prices.of("friction", "a").value == 0.0


def test_infinite_margins_have_no_prices():
    for name in ("contacts/chimney", "contacts/hooks_hold", "degenerate/push_on_ice", "degenerate/two_points_a_hair_outside"):
        assert ss.check_equilibrium(load_problem(name).stance(), engine=ENGINE).prices is None


# what users see


def test_lines_and_record_of_a_wall_hand(capsys, tmp_path):
    assert main(["solve", "contacts/foot_and_wall_hand", "--json", str(tmp_path / "a.json")]) == 0
    said = capsys.readouterr().out
    assert "stopped by  foot friction (+16.6 N per 0.1), hand friction (+0.228 N per 0.1)" in said
    assert "moving      foot along" in said
    record = json.loads((tmp_path / "a.json").read_text())
    assert set(record["prices"]) == {"margin"}
    assert record["prices"]["margin"]["friction"]["foot"] == pytest.approx(166.0444, rel=1e-4)
    assert len(record["prices"]["margin"]["displacement"]["hand"]) == 3
    again = solve(load_problem("contacts/foot_and_wall_hand"), ENGINE)
    assert again.to_json() == (tmp_path / "a.json").read_text()


def test_prices_can_be_expected(tmp_path, capsys):
    text = (
        'model = "equilibrium"\n[posture]\ngenerator = "contacts"\nmass = 10.0\ncom = [0, 0, 0.2]\n[[posture.contacts]]\nname = "sole"\n'
        'type = "surface"\nposition = [0, 0, 0]\nnormal = [0.6, 0, 0.8]\nfriction = 0.5\nsize = [0.8, 0.2]\n[expect]\n'
        '"prices.margin.friction.sole" = { value = 58.86, tolerance = 1e-3, source = "W sin / (4 mu^2)" }\n'
    )
    (tmp_path / "slope.toml").write_text(text)
    assert main(["solve", str(tmp_path / "slope.toml")]) == 0
    (tmp_path / "slope.toml").write_text(text.replace("friction.sole", "friction.hand"))
    assert main(["solve", str(tmp_path / "slope.toml")]) == 2
    assert "has no entry 'hand'" in capsys.readouterr().err
