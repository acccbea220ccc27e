"""Robustness as users ask for it: lines, records, problem files, and wrong input in files and arguments."""

from __future__ import annotations

import json

import numpy as np
import pytest

import socp_statics as ss
from socp_statics.cases.problem import load_problem
from socp_statics.cases.robustness_words import MEANINGS
from socp_statics.cases.solve import solve
from socp_statics.cli import main
from socp_statics.exceptions import InputError
from socp_statics.figures import save_figure
from socp_statics.stability.robustness import MEASURES

ENGINE = ("clarabel", "cvxpy")
INTERVALS = 'measures = ["friction_interval"]\nfriction_intervals = '
BLOCK = """\
model = "robustness"
[posture]
generator = "contacts"
mass = 10.0
com = [0, 0, 0.5]
[[posture.contacts]]
name = "sole"
type = "surface"
position = [0, 0, 0]
normal = [0, 0, 1]
friction = 0.5
size = [0.3, 0.2]
[[posture.contacts]]
name = "smooth"
type = "frictionless_point"
position = [0.3, 0, 0]
normal = [0, 0, 1]
[parameters]
"""


def block(tmp_path, parameters=""):
    path = tmp_path / "block.toml"
    path.write_text(BLOCK + parameters)
    return str(path)


def test_every_measure_has_words():
    assert set(MEANINGS) == set(MEASURES)


def test_lines_and_record(tmp_path, capsys):
    target = tmp_path / "a.json"
    assert main(["solve", "robustness/block_tips", "--json", str(target)]) == 0
    said = capsys.readouterr().out
    assert "robustness  pushed in any horizontal direction at [0, 0, 0.5] m: 19.62 N; beyond it tips about the" in said
    assert "robustness  CoM displaced in any direction: 100 mm" in said
    assert "robustness  gravity tilted in any direction: 11.31 deg" in said
    assert "robustness  friction needed, as a multiple of what there is: 0; it holds without friction" in said
    record = json.loads(target.read_text())
    push = record["robustness"]["push"]
    assert (push["kind"], push["unit"], push["point"], push["link"]) == ("exact", "N", [0.0, 0.0, 0.5], None)
    assert push["bracket"][0] == push["value"] <= push["bracket"][1]
    assert push["beyond"]["kind"] == "motion"
    assert record["status"] == "solved" and record["verdict"] == "stable" and record["forces"]


def test_bounds_say_on_which_side_they_are(tmp_path, capsys):
    assert main(["solve", "robustness/force_rule"]) == 0
    said = capsys.readouterr().out
    assert "forces by an affine rule: 13.873 N, a lower bound; the truth is between 13.873 and 19.62; by one affine rule" in said
    assert main(["solve", "robustness/slope_too_steep"]) == 0
    said = capsys.readouterr().out
    assert "any force at the CoM: unstable: no reserve" in said
    assert "as a multiple of what there is: 1.5; beyond it slides" in said
    assert main(["solve", "robustness/between_walls"]) == 0
    assert "any wrench about the CoM, moments over 1 m: inf N; contact forces grow with it without end" in capsys.readouterr().out


def test_an_equilibrium_shows_robustness_where_it_is_asked_for(capsys):
    assert main(["solve", "push/hoap2_b_holds", "--set", "parameters.robustness=true"]) == 0
    said = capsys.readouterr().out
    assert said.count("\nrobustness  ") == 6
    assert main(["solve", "push/hoap2_b_holds"]) == 0
    assert "robustness  " not in capsys.readouterr().out


def test_a_safety_zone_beside_the_measures(tmp_path, capsys):
    assert main(["solve", block(tmp_path, 'safety = 0.05\nmeasures = ["com"]\n')]) == 0
    assert "safety      the CoM is inside the region" in capsys.readouterr().out


def test_the_program_is_shown(capsys):
    assert main(["show", "robustness/block_tips"]) == 0
    said = capsys.readouterr().out
    assert "d' z" in said and "G x + L + B z = 0" in said


def test_a_file_and_arguments_say_the_same(tmp_path):
    problem = load_problem(block(tmp_path, 'measures = ["push", "wrench", "mass_and_com"]\nlength = 0.2\npoint = [0, 0, 0.4]\n'))
    record = solve(problem, ENGINE)
    names = ("push", "wrench", "mass_and_com")
    found = ss.measure_robustness(problem.stance(), measures=names, length=0.2, point=(0, 0, 0.4), engine=ENGINE)
    for name, measure in found.measures.items():
        assert record["robustness"][name]["value"] == measure.value
    assert record["robustness"]["wrench"]["length"] == 0.2
    assert np.shape(record["robustness"]["mass_and_com"]["shape"]) == (4, 4)


def test_a_figure_is_drawn_of_a_robustness_record(tmp_path):
    save_figure(solve(load_problem("robustness/block_tips"), ENGINE), tmp_path / "a.svg")
    assert (tmp_path / "a.svg").stat().st_size > 3_000


@pytest.mark.parametrize(
    ("parameters", "words"),
    [
        ('measures = ["puhs"]', "parameters.measures: measure 'puhs' is not known"),
        ("measures = []", "parameters.measures must be a list of push, force"),
        ("length = 0", "parameters.length must be a finite length > 0 [m]: a moment"),
        ("length = -0.1", "parameters.length must be a finite length > 0 [m]"),
        ("length = nan", "parameters.length must be a finite length > 0 [m]"),
        ("point = [0, 0]", "parameters.point must be three finite numbers [m]"),
        ("point = [0, 0, nan]", "parameters.point must be three finite numbers [m]"),
        ('link = "LARM_LINK4"', "parameters.link: a link needs a robot"),
        ("tolerance = 0", "parameters.tolerance must be a number > 0 and < 1"),
        ("tolerance = 1.0", "parameters.tolerance must be a number > 0 and < 1"),
        ("ellipsoid = [1, 1, 1]", "parameters.ellipsoid must be four semi-axes"),
        ("ellipsoid = [1, nan, 1, 1]", "parameters.ellipsoid must be four semi-axes"),
        ("ellipsoid = [1.0, -0.1, 0.1, 0.1]", "parameters.ellipsoid: question 'robustness': ellipsoid must be symmetric"),
        ("ellipsoid = [0.0, 0.0, 0.0, 0.0]", "ellipsoid must be symmetric, positive semidefinite and not zero"),
        ("ellipsoid = [[1,0,0,0],[0.5,1,0,0],[0,0,1,0],[0,0,0,1]]", "ellipsoid must be symmetric, positive semidefinite"),
        ("safety = -0.1", "parameters.safety must be a finite length >= 0 [m]"),
        ('measures = ["friction_interval"]', "friction_intervals are missing, the measure 'friction_interval' needs [lo, hi]"),
        ("friction_intervals = { foot = [0.1, 0.2] }", "parameters.friction_intervals: contact 'foot' is not known"),
        ("friction_intervals = { sole = [0.1] }", "parameters.friction_intervals.sole must be a pair [lo, hi]"),
        (INTERVALS + "{ sole = [0.5, 0.1] }", "'sole': friction_intervals must be [lo, hi] with 0 <= lo <= hi"),
        (INTERVALS + "{ sole = [-0.5, 0.1] }", "'sole': friction_intervals must be [lo, hi] with 0 <= lo"),
        (INTERVALS + "{ sole = [0.5, inf] }", "'sole': friction_intervals must be [lo, hi] with finite ends"),
        (INTERVALS + "{ smooth = [0.1, 0.2] }", "contact 'smooth' has no friction here, known: default, sole"),
        ("torque_limits = true", "parameters.torque_limits: torque limits need a robot"),
        ("robustness = true", "parameters.robustness is not a known key"),
    ],
)  # fmt: skip
def test_wrong_parameters_are_named(tmp_path, capsys, parameters, words):
    target = tmp_path / "a.json"
    assert main(["solve", block(tmp_path, parameters + "\n"), "--json", str(target)]) == 2
    last = capsys.readouterr().err.strip().splitlines()[-1]
    assert words in last, last
    assert not target.exists()


def test_robustness_of_an_equilibrium_is_true_or_false(capsys):
    assert main(["solve", "contacts/push_holds", "--set", "parameters.robustness=1"]) == 2
    assert "parameters.robustness must be true or false" in capsys.readouterr().err
    assert main(["solve", "contacts/flat_double_stance", "--set", "parameters.robustness=true"]) == 2
    assert "parameters.robustness is not a known key" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"measures": ("push", "pull")}, "measure 'pull' is not known"),
        ({"measures": ()}, "at least one of push, force"),
        ({"length": -1.0}, "length must be a finite number > 0"),
        ({"length": np.nan}, "length must be a finite number > 0"),
        ({"point": (0, 0)}, "point must be 3 numbers"),
        ({"point": (0, 0, np.inf)}, "point must be finite"),
        ({"link": "hand"}, "link 'hand' of the push needs a robot"),
        ({"tolerance": 0.0}, "tolerance must be a finite number > 0"),
        ({"tolerance": 2.0}, "tolerance must be < 1"),
        ({"ellipsoid": np.eye(3)}, "ellipsoid must be 4x4 numbers"),
        ({"ellipsoid": (1.0, 1.0)}, "ellipsoid must be 4 numbers"),
        ({"ellipsoid": np.full((4, 4), np.nan)}, "ellipsoid must be finite"),
        ({"torque_limits": True}, "torque_limits need a robot"),
        ({"cone": "pyramid"}, "cone must be one of"),
        ({"engine": "mosek"}, "engine 'mosek' is not known"),
    ],
)
def test_wrong_arguments_are_named(arguments, words):
    sole = ss.SurfaceContact("sole", (0, 0, 0), normal=(0, 0, 1), friction=0.5, size=(0.3, 0.2))
    with pytest.raises(InputError, match=words):
        ss.measure_robustness([sole], (0, 0, 0.5), 10.0, **arguments)


def test_a_link_that_the_robot_does_not_have_is_named(capsys):
    assert main(["solve", "robustness/hoap2_standing", "--set", "parameters.link=tail"]) == 2
    assert "tail" in capsys.readouterr().err.strip().splitlines()[-1]
