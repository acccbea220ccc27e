"""Rates of false verdicts over populations: closed forms, confidence, the same from records, tables and figures."""

import csv
import json
import math

import numpy as np
import pytest

import socp_statics as ss
from socp_statics.cases.problem import problem_from_tables
from socp_statics.cli import main
from socp_statics.comparison import compare, compare_records, judge_stances, population_tables
from socp_statics.comparison.population import Judged, Population
from socp_statics.comparison.sentences import population_sentence
from socp_statics.contacts import ExternalWrench, Stance, SurfaceContact
from socp_statics.exceptions import EngineError, InputError

WEIGHT, FRICTION = 98.1, 0.5
SWEEP = {
    "posture.family": ["sloped_feet", "feet_and_hands"],
    "posture.slope": [0.1, 0.4],
    "posture.seed": {"from": 0, "to": 7},
}


def small(model="equilibrium", **more):
    posture = {"generator": "random_contacts", "family": "flat", "seed": 0, "friction": 0.5}
    return problem_from_tables({"model": model, "description": "", "posture": posture, "sweep": SWEEP} | more, "small")


def pushed(share, angle):
    force = share * WEIGHT * np.array([np.cos(angle), np.sin(angle), 0.0])
    sole = SurfaceContact("sole", [0, 0, 0], normal=(0, 0, 1), friction=FRICTION, size=(0.4, 0.4))
    return Stance([sole], [0, 0, 0.1], 10.0, external_wrenches=(ExternalWrench(force=force, point=(0, 0, 0)),))


def wilson(false, of, z=1.959963984540054):
    """The interval as Wilson (1927) states it."""
    p, n = false / of, of
    middle, half = p + z * z / (2 * n), z * math.sqrt(p * (1 - p) / n + z * z / (4 * n * n))
    return (middle - half) / (1 + z * z / n), (middle + half) / (1 + z * z / n)


def row(tables, name, kind, sides, **where):
    (found,) = [r for r in tables[name] if (r["kind"], r["sides"], r["where"]) == (kind, sides, where)]
    return found


@pytest.fixture(scope="module")
def judged():
    """Blocks pushed in all directions by less and by more than friction holds."""
    angles = np.linspace(0, 2 * np.pi, 40, endpoint=False) + 0.01
    shares = np.repeat([0.4, 0.51, 0.65], 40)
    stances = [pushed(share, angle) for share, angle in zip(shares, np.tile(angles, 3), strict=True)]
    return shares, np.tile(angles, 3), judge_stances(stances, {"share": shares}, (4, 8), threads=2)


def test_verdicts_and_rates_of_pushed_blocks_are_those_of_coulomb(judged):
    shares, angles, population = judged
    tables = population_tables(population)
    assert tables["verdicts"] == {"stable": 40, "unstable": 80, "undecided": 0}
    for sides in (4, 8):
        faces = 2 * np.pi * np.arange(sides) / sides
        reach = -np.cos(faces[None] - angles[:, None]).min(axis=1) * shares
        for kind, slope in (("inscribed", FRICTION * np.cos(np.pi / sides)), ("circumscribed", FRICTION)):
            assert (population.pyramids[kind, sides].verdict == np.where(reach <= slope, "stable", "unstable")).all()
        wrong = int(((reach <= FRICTION) & (shares > FRICTION)).sum())
        found = row(tables, "rates", "circumscribed", sides)
        assert (found["of"], found["false"], found["error"]) == (80, wrong, "falsely stable")
        assert (found["low"], found["high"]) == pytest.approx(wilson(wrong, 80), abs=1e-12)
        wrong = int(((reach > FRICTION * np.cos(np.pi / sides)) & (shares < FRICTION)).sum())
        assert row(tables, "rates", "inscribed", sides)["false"] == wrong
    assert row(tables, "rates", "circumscribed", 4)["false"] > row(tables, "rates", "circumscribed", 8)["false"] > 0


def test_rates_under_a_circumstance_add_up(judged):
    tables = population_tables(judged[2])
    each = [row(tables, "rates", "circumscribed", 4, share=share) for share in (0.4, 0.51, 0.65)]
    assert sum(r["of"] for r in each) == 80 and each[0] == each[0] | {"of": 0, "rate": None, "low": None, "high": None}
    assert sum(r["false"] for r in each) == row(tables, "rates", "circumscribed", 4)["false"]


def hand_made(verdict, area):
    exact = Judged(np.array(["stable", "unstable", "stable"]), np.array([1.0, 0.0, 2.0]))
    return Population({}, exact, {("inscribed", 4): Judged(np.array(verdict), np.array(area))}, {})


def test_areas_are_counted():
    tables = population_tables(hand_made(["stable", "unstable", "unstable"], [0.9, 0.0, 0.0]))
    found = row(tables, "areas", "inscribed", 4)
    assert (found["regions"], found["lost"], found["endless"], found["within"]) == (2, 1, 0, 0.0)
    assert found["worst"] == -1.0
    assert row(tables, "rates", "inscribed", 4)["rate"] == 0.5


@pytest.mark.parametrize(
    ("verdict", "area", "words"),
    [(["stable", "stable", "stable"], [0.9, 0.0, 2.0], "stance 1"), (["stable", "unstable", "stable"], [0.9, 0.0, 2.1], "stance 2")],
)
def test_a_pyramid_on_the_wrong_side_is_no_answer(verdict, area, words):
    with pytest.raises(EngineError, match=words):
        population_tables(hand_made(verdict, area))


def test_undecided_stances_are_left_out_of_rates():
    exact = Judged(np.array(["stable", "undecided"]), np.array([np.nan, np.nan]))
    pyramid = Judged(np.array(["undecided", "stable"]), np.array([np.nan, np.nan]))
    tables = population_tables(Population({}, exact, {("inscribed", 4): pyramid}, {}))
    assert tables["rates"][0]["of"] == 0 and tables["rates"][0]["rate"] is None
    assert tables["areas"] == [] and tables["verdicts"]["undecided"] == 1


def test_records_say_what_batches_say():
    problem = small("support_region")
    direct = compare(problem, (4,), threads=2)
    cones = [{}, *({"parameters.cone": kind, "parameters.sides": 4} for kind in ("inscribed", "circumscribed"))]
    records = (ss.solve(case, "kernel") for cone in cones for case in problem.with_values(cone).cases())
    read = compare_records(records)
    assert read["sides"] == [4] and read["by"] == ["family", "slope"] == direct["by"]
    assert read["verdicts"] == direct["verdicts"] and read["rates"] == direct["rates"]
    for mine, other in zip(direct["areas"], read["areas"], strict=True):
        assert mine["where"] == other["where"] and mine["median"] == pytest.approx(other["median"], abs=2e-3)
    with pytest.raises(InputError, match="a pyramid beside the exact cone"):
        compare_records([ss.solve(problem.case(0), "kernel")])
    with pytest.raises(InputError, match="the exact cone"):
        compare_records([])


def test_a_level_floor_costs_nothing():
    found = compare(ss.load_problem("comparison/level_floor").with_values({"posture.friction": 0.4}), (3, 4), threads=2)
    assert found["stances"] == 200
    assert {r["false"] for r in found["rates"]} == {0}
    assert all(abs(r["worst"]) < 1e-9 for r in found["areas"])
    assert "changes no area" in found["answer"] and "unsafe" not in found["answer"]


@pytest.mark.parametrize(
    ("median", "most", "said"),
    [
        (4, 8, "; 4 sides bring the median area within 1 %, 8 that of 95 % of the regions."),
        (4, None, "; 4 sides bring the median area within 1 %, but even with 8 more than 5 % of the regions are farther off."),
        (None, None, "; even 8 sides do not bring the median area within 1 %."),
    ],
)
def test_the_sentence_says_how_many_sides_bring_areas_near(median, most, said):
    kinds = ("inscribed", "circumscribed")
    row = {"where": {}, "median": 0.0, "worst": 0.1, "low": 0.0, "high": 0.1}
    areas = [{"kind": kind, "sides": sides} | row for kind in kinds for sides in (4, 8)]
    few = {kind: {"median": median, "most": most} for kind in kinds}
    tables = {"stances": 9, "rates": [], "areas": areas, "sides_for_one_percent": few}
    assert population_sentence(tables, (4, 8)).endswith(said)


class TestCommand:
    @pytest.fixture
    def file(self, tmp_path):
        path = tmp_path / "small.toml"
        text = ["model = 'equilibrium'", "[posture]", "generator = 'random_contacts'", "family = 'flat'", "seed = 0", "friction = 0.5"]
        text += ["[sweep]", "'posture.family' = ['sloped_feet', 'feet_and_hands']", "'posture.slope' = [0.1, 0.4]"]
        path.write_text("\n".join([*text, "'posture.seed' = { from = 0, to = 7 }"]))
        return path

    def test_files_and_the_sentence(self, file, tmp_path, capsys):
        outputs = {name: tmp_path / f"out.{name}" for name in ("json", "csv", "png")}
        arguments = ["compare", str(file), "--sides", "4,8"]
        assert main([*arguments, "--json", str(outputs["json"]), "--table", str(outputs["csv"]), "--figure", str(outputs["png"])]) == 0
        said = capsys.readouterr().out
        found = json.loads(outputs["json"].read_text())
        assert found["comparison"] == "population" and found["stances"] == 32 and found["by"] == ["family", "slope"]
        assert said.rstrip().endswith(found["answer"]) and "Over 32 stances a four-sided pyramid costs this" in said
        assert "falsely stable" in said and "falsely unstable" in said
        rows = list(csv.DictReader(outputs["csv"].open()))
        assert {r["table"] for r in rows} == {"rates", "areas"} and {r["slope"] for r in rows} >= {"", "0.1", "0.4"}
        assert outputs["png"].read_bytes().startswith(b"\x89PNG")
        assert main([*arguments, "--json", "-"]) == 0
        assert capsys.readouterr().out == outputs["json"].read_text()

    def test_a_sweep_that_changes_the_cone_is_refused(self, tmp_path, capsys):
        file = tmp_path / "cones.toml"
        file.write_text(
            "model = 'equilibrium'\n[posture]\ngenerator = 'random_contacts'\nfamily = 'flat'\nseed = 0\n"
            "[sweep]\n'parameters.cone' = ['exact', 'inscribed']\n"
        )
        assert main(["compare", str(file)]) == 2
        assert "parameters.cone changes the cone" in capsys.readouterr().err
