"""What pyramids cost one stance: closed forms, the side of every error, forces beyond the cone, and the command's files."""

import csv
import json
import math

import numpy as np
import pytest

import socp_statics as ss
from socp_statics.cases.named_problems import problem_names
from socp_statics.cli import main
from socp_statics.comparison import compare, compare_regions, quantities, stance
from socp_statics.comparison.linear_programs import by_linear_programs
from socp_statics.comparison.pyramids import pyramids
from socp_statics.comparison.sentences import stance_sentence, time_sentence
from socp_statics.comparison.times import Timed, times
from socp_statics.comparison.violations import violation
from socp_statics.cones.choice import ConeChoice
from socp_statics.contacts import ExternalWrench, PointContact, SoftFingerContact, Stance, SurfaceContact
from socp_statics.engines import linear
from socp_statics.exceptions import EngineError, InputError
from socp_statics.stability import check_equilibrium

WEIGHT, FRICTION = 98.1, 0.5
SIDES = (3, 4, 8)
HAND = "contacts/foot_and_wall_hand"


def pushed_block(share, angle):
    """A block pushed at the height of the floor by a share of its weight: it slides and does not tip."""
    force = share * WEIGHT * np.array([np.cos(angle), np.sin(angle), 0.0])
    sole = SurfaceContact("sole", [0, 0, 0], normal=(0, 0, 1), friction=FRICTION, size=(0.4, 0.4))
    return Stance([sole], [0, 0, 0.1], 10.0, external_wrenches=(ExternalWrench(force=force, point=(0, 0, 0)),))


def braced_between_floor_and_ceiling(height=2.0, squeeze=30.0):
    """A rod between a floor point and a ceiling point above it, squeezed: the region is a disc of radius h mu N / W."""
    floor = PointContact("floor", [0, 0, 0], normal=(0, 0, 1), friction=2.0)
    ceiling = PointContact("ceiling", [0, 0, height], normal=(0, 0, -1), friction=FRICTION, normal_force=[squeeze, squeeze])
    return Stance([floor, ceiling], [0, 0, 1.0], 10.0), height * FRICTION * squeeze / WEIGHT


def rows_of(found, quantity, kind, sides):
    return [r for r in found["pyramids"] if (r["quantity"], r["kind"], r["sides"]) == (quantity, kind, sides)]


@pytest.fixture(scope="module")
def with_a_hand():
    return compare(ss.load_problem(HAND), (4, 8), 2, with_times=False)


@pytest.mark.parametrize("share", [0.3, 0.6])
def test_margins_of_a_pushed_block_are_those_of_coulomb(share):
    found = stance.compared_stance(pushed_block(share, 0.3), {}, SIDES, 3)
    assert found["exact"]["margin"]["value"] == pytest.approx((WEIGHT - share * WEIGHT / FRICTION) / 4, abs=1e-6)
    for row in found["pyramids"]:
        if row["quantity"] == "margin":
            faces = row["heading"] + 2 * np.pi * np.arange(row["sides"]) / row["sides"]
            slope = FRICTION * (np.cos(np.pi / row["sides"]) if row["kind"] == "inscribed" else 1.0)
            worst = -share * WEIGHT * np.cos(faces - 0.3).min()  # the reaction is against the push
            assert row["value"] == pytest.approx((WEIGHT - worst / slope) / 4, abs=1e-6)


def test_areas_are_those_of_polygons_in_and_about_a_disc():
    braced, radius = braced_between_floor_and_ceiling()
    found = stance.compared_stance(braced, {}, SIDES, 3)
    disc = math.pi * radius**2
    assert found["exact"]["region"]["value"] == pytest.approx(disc, rel=2e-4)
    for sides in SIDES:
        inner = sides / (2 * math.pi) * math.sin(2 * math.pi / sides)
        outer = sides / math.pi * math.tan(math.pi / sides)
        for kind, factor in (("inscribed", inner), ("circumscribed", outer)):
            assert [r["value"] for r in rows_of(found, "region", kind, sides)] == pytest.approx([factor * disc] * 3, rel=2e-4)
            (spread,) = [r for r in found["spread"] if (r["quantity"], r["kind"], r["sides"]) == ("region", kind, sides)]
            assert spread["least"] == pytest.approx(spread["most"], abs=1e-3)
            assert spread["most"] == pytest.approx(factor - 1, abs=1e-3)
    assert found["sides_for_one_percent"]["region"] == {"inscribed": None, "circumscribed": None}


def test_how_many_sides_buy_one_per_cent_of_a_disc():
    braced, _ = braced_between_floor_and_ceiling()
    few = stance.compared_stance(braced, {}, (16, 20, 24, 28), 1)["sides_for_one_percent"]["region"]
    # 2 pi^2 / (3 n^2) of the area is missing, pi^2 / (3 n^2) is too much
    assert few == {"inscribed": 28, "circumscribed": 20}


def test_every_pyramid_is_on_its_side(with_a_hand):
    weight = 40.0 * 9.81
    for name, exact in with_a_hand["exact"].items():
        grows = name in ("margin", "region")
        for row in (r for r in with_a_hand["pyramids"] if r["quantity"] == name):
            wider = row["kind"] == "circumscribed"
            assert row["error"] * (1 if wider == grows else -1) >= -1e-6 * max(weight, abs(exact["value"]))
            assert row["side"] in ({"unsafe", "none"} if wider else {"safe", "none"})
            assert row["engine"] == exact["engine"] == "kernel"
    assert {r["side"] for r in with_a_hand["pyramids"]} == {"safe", "unsafe", "none"}


def test_a_margin_is_sandwiched_at_both_signs():
    for share, sign in ((0.45, 1.0), (0.55, -1.0)):
        found = stance.compared_stance(pushed_block(share, 0.9), {}, (5,), 5)
        exact = found["exact"]["margin"]["value"]
        assert exact * sign > 0
        assert all(row["value"] <= exact + 1e-9 for row in rows_of(found, "margin", "inscribed", 5))
        assert all(row["value"] >= exact - 1e-9 for row in rows_of(found, "margin", "circumscribed", 5))


def test_a_pyramid_on_the_wrong_side_is_no_answer():
    margin, region, forces, _ = quantities.QUANTITIES
    one, two = (quantities.Finding(value, value, "solved", tuple, "kernel") for value in (1.0, 2.0))
    for quantity, inner, outer in ((margin, one, two), (region, one, two), (forces, two, one)):
        quantities.require_order(quantity, "inscribed", outer, inner, 1.0)
        quantities.require_order(quantity, "circumscribed", inner, outer, 1.0)
        for kind, true, found in (("inscribed", inner, outer), ("circumscribed", outer, inner)):
            with pytest.raises(EngineError, match=f"{kind} pyramid is on the wrong side"):
                quantities.require_order(quantity, kind, true, found, 1.0)


@pytest.mark.parametrize("sides", [3, 4, 5])
def test_a_pyramid_turned_by_one_face_is_the_same_and_the_exact_cone_has_no_heading(sides):
    block = pushed_block(0.45, 0.4)
    headings = [c.heading for c in pyramids(sides, 4, 0.1)][:4]
    assert np.diff(headings) == pytest.approx([2 * np.pi / (4 * sides)] * 3)
    for kind in ("inscribed", "circumscribed"):
        a, b = (check_equilibrium(block, cone=ConeChoice(kind, sides, h)).margin for h in (0.2, 0.2 + 2 * np.pi / sides))
        assert a == pytest.approx(b, abs=1e-9)
    turned = check_equilibrium(block, cone="exact", heading=0.7)
    assert turned.margin == check_equilibrium(block).margin


def test_forces_beyond_the_cone_are_measured():
    block = pushed_block(0.6, np.pi / 4)
    answer = ss.optimise_contact_forces(block, cone="circumscribed", sides=4)
    found = violation(block.contacts, [answer.forces])
    assert found.share == pytest.approx(0.2, abs=1e-6)
    assert found.force == pytest.approx(0.1 * WEIGHT / 4, abs=1e-5)
    assert found.points == 4
    held = pushed_block(0.45, np.pi / 4)
    assert violation(held.contacts, [ss.optimise_contact_forces(held).forces]) == (0.0, 0.0, 0)


def test_torsion_counts_where_a_soft_finger_bears_it():
    def finger(shape):
        return SoftFingerContact("finger", [0, 0, 0], normal=(0, 0, 1), friction=0.5, torsional_friction=0.1, shape=shape)

    moment = ExternalWrench(moment=(0.0, 0.0, 3.0))
    push = ExternalWrench(force=(40.0, 0.0, 0.0), point=(0, 0, 0))
    loaded = {shape: Stance([finger(shape)], [0, 0, 0.0], 10.0, external_wrenches=(moment, push)) for shape in ("box", "elliptic")}
    wide = check_equilibrium(loaded["elliptic"], cone="circumscribed")
    assert violation(loaded["box"].contacts, [wide.forces]).points == 0
    beyond = violation(loaded["elliptic"].contacts, [wide.forces])
    assert beyond.share == pytest.approx(np.hypot(40.0, 5 * 3.0) / (0.5 * WEIGHT) - 1, abs=1e-6) if beyond.points else beyond.share == 0.0


def test_what_cannot_be_asked_is_left_out_with_its_reason():
    sideways = ss.load_problem(HAND).with_values({"posture.gravity": [9.81, 0.0, 0.0]})
    found = compare(sideways, (4,), 1, with_times=False)
    assert "horizontal" in found["left_out"]["region"]
    assert set(found["exact"]) == {"margin", "contact_forces", "minimax_wrench"}


def test_objective_and_measure_are_those_of_the_problem():
    names = {"contact_forces": "contacts/valley_normal_force", "minimax_wrench": "contacts/valley_minimax_force"}
    assert set(names.values()) <= set(problem_names())
    for quantity, name in names.items():
        problem = ss.load_problem(name)
        found = compare(problem, (4,), 1, with_times=False)
        assert found["exact"][quantity]["value"] == pytest.approx(ss.solve(problem, "kernel")["objective"], rel=1e-6)
    assert compare(ss.load_problem(names["contact_forces"]), (4,), 1, with_times=False)["exact"]["contact_forces"]["unit"] == "N"


class TestLinearPrograms:
    """HiGHS solves the same programs."""

    @pytest.mark.parametrize("by", ["HiGHS", "HiGHS (SciPy)"])
    def test_values_are_those_of_the_kernel(self, by, monkeypatch, capfd):
        if by == "HiGHS":
            pytest.importorskip("highspy")
        monkeypatch.setattr(linear, "interface", lambda: by)
        problem = ss.load_problem(HAND)
        asked, cone = problem.stance(), ConeChoice("inscribed", 4)
        parameters = {"objective": "normal_force", "measure": "normal"}
        for quantity in quantities.QUANTITIES:
            found = by_linear_programs(quantity.name, asked, parameters, cone, 1e-4)
            assert found.value == pytest.approx(quantity.ask(asked, parameters, cone, "kernel").value, rel=1e-5)
            assert 0.0 <= found.inside < 10.0
        if by == "HiGHS":
            quadratic = by_linear_programs("contact_forces", asked, {}, cone, 1e-4)
            assert quadratic.value == pytest.approx(ss.optimise_contact_forces(asked, cone=cone).objective, rel=1e-6)
        else:
            with pytest.raises(EngineError, match="quadratic"):
                by_linear_programs("contact_forces", asked, {}, cone, 1e-4)
        assert capfd.readouterr() == ("", "")

    def test_what_is_not_linear_is_refused(self):
        asked = ss.load_problem(HAND).stance()
        with pytest.raises(EngineError, match="not linear"):
            by_linear_programs("margin", asked, {}, ConeChoice(), 1e-4)
        with pytest.raises(EngineError, match="not linear"):
            by_linear_programs("minimax_wrench", asked, {"measure": "force"}, ConeChoice("inscribed", 4), 1e-4)

    def test_multipliers_certify_the_value(self):
        asked = pushed_block(0.45, 0.2)
        engine = linear.LinearEngine()
        from socp_statics.models.contact_forces_set import force_shape, force_values
        from socp_statics.models.equilibrium import MODEL
        from socp_statics.statics import assemble, wrench_range

        cone, data = ConeChoice("inscribed", 4), assemble(asked)
        reach = wrench_range(data.wrench_map)
        values = {**force_values(data, cone, reach.basis), "cap": np.array(1.0)}
        solution = engine.compile(MODEL, force_shape(data, cone, "socp", reach.rank)).solve(values)
        assert max(solution.residuals) < 1e-8

    def test_each_way_is_timed_with_its_engine_named(self):
        problem = ss.load_problem(HAND)
        rows = times(problem.stance(), problem.parameters, ["margin", "region"], (4,))
        seen = {(t.quantity, t.cone, t.engine) for t in rows}
        for quantity in ("margin", "region"):
            assert {(quantity, cone, engine) for cone in ("exact", "inscribed") for engine in ("kernel", "clarabel")} <= seen
            assert (quantity, "inscribed", linear.interface()) in seen
        assert all(t.seconds > 0 and (t.inside is None) == (t.engine in ("kernel", "clarabel")) for t in rows)


class TestSentence:
    def test_it_says_what_four_sides_cost_and_when_they_are_unsafe(self, with_a_hand):
        said = with_a_hand["answer"]
        assert said.startswith("A four-sided pyramid costs") and said.count(".") - said.count(".0") <= 40
        for words in ("inscribed, which is safe", "circumscribed, which is unsafe", "exceed the true cones by up to 41 %", "heading"):
            assert words in said
        region = [r for r in with_a_hand["spread"] if (r["quantity"], r["sides"]) == ("region", 4)]
        for row in region:
            assert f"{100 * abs(row['least']):.2g} to {100 * abs(row['most']):.2g} % of the region's area" in said

    def test_it_says_when_a_slide_is_missed(self):
        found = stance.compared_stance(pushed_block(0.6, np.pi / 4), {}, (4,), 1)
        assert "calls an unstable stance stable" in stance_sentence(found, (4,))
        assert "forces where none balance" in stance_sentence(found, (4,))

    def test_it_says_when_nothing_is_lost(self):
        flat = compare(ss.load_problem("contacts/flat_double_stance"), (4, 6), 2, with_times=False)
        assert "costs nothing here and is not unsafe" in flat["answer"]
        assert {r["side"] for r in flat["pyramids"]} == {"none"}

    def test_times_are_said_with_their_engines(self):
        rows = [Timed("region", "exact", None, "kernel", 2e-4), Timed("region", "inscribed", 4, "HiGHS", 9e-3, 3e-3)]
        said = time_sentence(rows, (4, 8))
        assert "exact region takes 0.2 ms by kernel" in said and "9 ms by HiGHS (3 ms of it inside)" in said
        assert time_sentence([], (4,)) == ""


class TestCommand:
    def test_files_and_what_is_printed(self, tmp_path, capsys):
        files = {name: tmp_path / f"out.{name}" for name in ("json", "csv", "md", "pdf")}
        arguments = ["compare", HAND, "--sides", "4, 8", "--headings", "3"]
        assert main([*arguments, "--json", str(files["json"]), "--table", str(files["csv"]), "--figure", str(files["pdf"])]) == 0
        said = capsys.readouterr().out
        assert "A four-sided pyramid costs" in said and "CPU time" in said and "kernel" in said and "clarabel" in said
        found = json.loads(files["json"].read_text())
        assert found["sides"] == [4, 8] and found["headings"] == 3 and found["problem"] == HAND
        assert len(found["pyramids"]) == 4 * 2 * 2 * 3
        assert "seconds" not in files["json"].read_text() and "times" not in found
        assert found["answer"] in said
        rows = list(csv.DictReader(files["csv"].open()))
        assert len(rows) == 4 + len(found["pyramids"])
        timed = [row for row in rows if row["seconds_kernel"]]
        assert {(row["quantity"], row["kind"]) for row in timed} >= {("region", "exact"), ("region", "inscribed"), ("margin", "exact")}
        assert files["pdf"].read_bytes().startswith(b"%PDF")
        assert main([*arguments, "--table", str(files["md"])]) == 0
        assert "| sides | inscribed: error |" in files["md"].read_text() and found["answer"] in files["md"].read_text()

    def test_the_json_has_the_same_bytes_every_time(self, capsys):
        texts = []
        for _ in range(2):
            assert main(["compare", "contacts/valley_minimax_force", "--sides", "4", "--headings", "2", "--json", "-"]) == 0
            texts.append(capsys.readouterr().out)
        assert texts[0] == texts[1]
        assert json.loads(texts[0])["comparison"] == "stance"

    def test_a_case_of_a_sweep_and_a_set_key(self, capsys):
        assert main(["compare", "contacts/slope_block_sweep", "--case", "1", "--sides", "4", "--headings", "1", "--json", "-"]) == 0
        assert json.loads(capsys.readouterr().out)["case"]["posture"]["contacts"][0]["friction"] == 0.33
        assert main(["compare", HAND, "--set", "posture.mass=50", "--sides", "4", "--headings", "1", "--json", "-"]) == 0
        assert json.loads(capsys.readouterr().out)["case"]["posture"]["mass"] == 50

    @pytest.mark.parametrize(
        ("arguments", "words"),
        {
            "two sides": (["--sides", "2"], ["--sides", "from 3 to 512", "got 2"]),
            "no whole number": (["--sides", "4.5"], ["--sides", "whole numbers", "'4.5'"]),
            "words": (["--sides", "four"], ["--sides", "'four'"]),
            "nothing": (["--sides", ""], ["--sides", "''"]),
            "a stray comma": (["--sides", "4,,8"], ["--sides", "commas"]),
            "twice": (["--sides", "4,8,4"], ["--sides", "4 is given twice"]),
            "too many": (["--sides", "1000"], ["--sides", "512", "1000"]),
            "no heading": (["--headings", "0"], ["--headings", "1 to 360"]),
            "half a heading": (["--headings", "1.5"], ["--headings: a whole number from 1 to 360 is expected, got '1.5'"]),
            "a folder as file": (["--json", "FOLDER"], ["--json", "folder"]),
            "a figure that is none": (["--figure", "out.txt"], ["--figure", ".pdf"]),
            "a table that is none": (["--table", "out.xls"], ["--table", ".csv"]),
            "no such folder": (["--table", "nowhere/out.csv"], ["--table", "nowhere"]),
            "one file for two": (["--json", "same.csv", "--table", "same.csv"], ["--table", "--json names the same file"]),
            "an unknown key": (["--set", "posture.mas=3"], ["--set", "mass"]),
            "no sweep": (["--case", "3"], ["--case"]),
        }.values(),
        ids=str,
    )
    def test_wrong_arguments(self, arguments, words, tmp_path, monkeypatch, capsys):
        monkeypatch.chdir(tmp_path)
        arguments = [str(tmp_path) if word == "FOLDER" else word for word in arguments]
        assert main(["compare", HAND, *arguments]) == 2
        last = capsys.readouterr().err.strip().splitlines()[-1]
        assert all(word in last for word in words), last
        assert list(tmp_path.iterdir()) == []

    @pytest.mark.parametrize("name", ["hoap2/following_standing", "contacts/payload_on_hooks"])
    def test_models_that_are_no_question_of_forces_are_refused(self, name, capsys):
        model = ss.load_problem(name).model
        assert main(["compare", name]) == 2
        said = capsys.readouterr().err
        assert f"model '{model}' cannot be compared" in said and "support_region" in said

    def test_the_problem_is_not_overwritten(self, tmp_path, capsys):
        file = tmp_path / "mine.toml"
        main(["show", HAND, "--toml"])
        file.write_text(capsys.readouterr().out)
        assert main(["compare", str(file), "--json", str(file)]) == 2
        assert "the problem file itself" in capsys.readouterr().err
        assert main(["compare", str(tmp_path)]) == 2


def test_wrong_numbers_in_python():
    problem = ss.load_problem(HAND)
    for sides in ((), (4, 4), (2,), (4.0,), (True,), ("4",)):
        with pytest.raises(InputError) as caught:
            compare(problem, sides)
        assert caught.value.field == "sides"
    with pytest.raises(InputError, match="headings"):
        compare(problem, (4,), 2.5)


def test_the_old_way_of_comparing_regions_still_agrees(with_a_hand):
    regions = compare_regions(ss.load_problem(HAND).stance(), 1e-4, sides=4)
    assert regions["exact"].inner_area == pytest.approx(with_a_hand["exact"]["region"]["value"], rel=1e-6)
    (first, *_) = rows_of(with_a_hand, "region", "inscribed", 4)
    assert regions["inscribed"].inner_area == pytest.approx(first["value"], rel=1e-6)
