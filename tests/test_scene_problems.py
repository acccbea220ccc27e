"""Problems with generators that state places: what the file says, what is refused, and the answer along keyframes."""

import tomllib

import numpy as np
import pytest

from socp_statics.cases.named_problems import problem_names
from socp_statics.cases.problem import load_problem, problem_from_tables
from socp_statics.cases.solve import shown_stance, solve
from socp_statics.cases.summary import summarise
from socp_statics.cli import main
from socp_statics.exceptions import InputError

FAMILIES = ("talos", "g1", "quadrupeds", "torque", "keyframes", "push")
WALL = """\
model = "equilibrium"

[posture]
generator = "wall_brace"
robot = "hoap2"
hands = ["left_hand"]
distance = 0.19
height = 0.33
"""
HELD = WALL[: WALL.index("hands")].replace("wall_brace", "hold_object")
KEYFRAMES = """\
model = "keyframes"

[posture]
generator = "keyframes"
robot = "hoap2"

[[posture.states]]
name = "both"
support = ["left_foot", "right_foot"]

[[posture.states]]
name = "left"
support = ["left_foot"]
com = [0.0, 0.035]

[parameters]
steps = 4
"""


def problem(text):
    return problem_from_tables(tomllib.loads(text), "scene")


def refusal(text):
    with pytest.raises(InputError) as caught:
        solve(problem(text))
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_there_are_forty_and_each_family_has_some():
    count = {family: sum(name.startswith(f"{family}/") for name in problem_names()) for family in FAMILIES}
    assert sum(count.values()) >= 40 and min(count.values()) >= 6


EDITS = {
    "a misspelt key": ("height = 0.33", "hight = 0.33", ["posture.hight is not a known key", "height"]),
    "a word for a length": ("height = 0.33", 'height = "chest"', ["posture.height", "finite number [m]", "'chest'"]),
    "a length that is nan": ("height = 0.33", "height = nan", ["posture.height", "nan"]),
    "a hand that is no hand": ('["left_hand"]', '["left_foot"]', ["posture.hands", "'left_foot' is not a hand", "right_hand"]),
    "hands that are no list": ('["left_hand"]', "3", ["posture.hands", "got 3"]),
    "no hands": ('["left_hand"]', "[]", ["posture.hands", "at least one"]),
    "a wall out of reach": ("distance = 0.19", "distance = 0.9", ["posture: robot 'hoap2': cannot reach: contact 'left_hand'"]),
    "friction of a contact that does not touch": ("hands", "friction = { left_fot = 1 }\nhands", ["friction names 'left_fot'"]),
    "a model that needs keyframes": ('"equilibrium"', '"keyframes"', ["posture.generator", "the generator keyframes", "'wall_brace'"]),
}  # fmt: skip


@pytest.mark.parametrize("edit", EDITS.values(), ids=EDITS)
def test_a_wrong_scene_is_refused(edit):
    old, new, words = edit
    assert old in WALL
    sentence = refusal(WALL.replace(old, new, 1))
    assert not [word for word in words if word not in sentence], sentence


STATES = {
    "no states": (KEYFRAMES[KEYFRAMES.index("[[") :], "", ["posture.states", "at least one contact state"]),
    "a state that is no table": ("[[posture.states]]", "[[posture.state]]", ["posture.state is not a known key", "states"]),
    "an unknown contact": ('"right_foot"', '"right_fot"', ["posture.states", "did you mean 'right_foot'"]),
    "nothing shared": ('support = ["left_foot"]', 'support = ["left_hand"]', ["posture.states", "'both' and 'left' share no contact"]),
    "no steps": ("steps = 4", "steps = 0", ["parameters.steps", "whole number >= 1"]),
    "a state out of reach": ("[0.0, 0.035]", "[0.0, 0.9]", ["posture.states", "'left'", "cannot reach"]),
}


@pytest.mark.parametrize("edit", STATES.values(), ids=STATES)
def test_wrong_keyframes_are_refused(edit):
    old, new, words = edit
    assert old in KEYFRAMES
    sentence = refusal(KEYFRAMES.replace(old, new, 1))
    assert not [word for word in words if word not in sentence], sentence


class TestKeyframes:
    def test_every_state_and_both_ends_of_every_way_are_looked_at(self):
        record = solve(problem(KEYFRAMES))
        entries = record["keyframes"]
        assert [entry["where"] for entry in entries] == ["both", *["both -> left"] * 5, "left"]
        assert [entry["progress"] for entry in entries] == [0.0, 0.0, 0.25, 0.5, 0.75, 1.0, 1.0]
        assert [len(entry["support"]) for entry in entries] == [2, 1, 1, 1, 1, 1, 1]
        assert [entry["verdict"] for entry in entries] == ["stable", *["unstable"] * 1, *["stable"] * 5]

    def test_the_first_failure_is_named_and_the_record_is_its(self):
        record = solve(problem(KEYFRAMES))
        failure = record["first_failure"]
        assert failure == record["keyframes"][1] and failure["support"] == ["left_foot"]
        assert "tips about" in failure["reading"] and failure["reading"] == record["certificate"]["reading"]
        assert record["verdict"] == "unstable" and record["margin"] == failure["margin"]
        assert [contact["name"] for contact in record["case"]["generated"]["contacts"]] == ["left_foot"]
        assert "both -> left, at 0 of the way, is the first of 7 that fails, on left_foot" in summarise(record)

    def test_without_a_failure_the_record_is_that_of_the_least_margin(self):
        record = solve(load_problem("keyframes/hoap2_shifts_and_lifts"))
        margins = [entry["margin"] for entry in record["keyframes"]]
        assert record["first_failure"] is None and record["margin"] == min(margins)
        weight = sum(np.array(wrench["force"]) for wrench in record["wrenches"])
        assert weight == pytest.approx([0, 0, 6.2431648 * 9.81], abs=1e-6)
        assert f"all {len(margins)} postures hold" in summarise(record)

    def test_the_figure_shows_what_fails(self):
        asked = problem(KEYFRAMES)
        record = solve(asked)
        stance = shown_stance(asked, record)
        assert stance.contacts.names == ("left_foot",)
        assert stance.com == pytest.approx(record["case"]["generated"]["com"], abs=1e-12)
        plain = problem(WALL)
        assert shown_stance(plain, solve(plain)).posture is plain.robot_posture

    def test_torque_limits_count_along_the_way(self):
        weak = '\n[posture.torque_limits]\ndefault = inf\n"?LEG_JOINT6" = 0.3\n[parameters]\ntorque_limits = true'
        record = solve(problem(KEYFRAMES.replace("[parameters]", weak.strip())))
        assert {entry["reason"] for entry in record["keyframes"]} >= {"torque"}

    def test_the_generator_alone_gives_any_posture_of_the_way(self):
        text = KEYFRAMES.replace('"keyframes"', '"equilibrium"', 1).replace("steps = 4", "")
        text = text.replace("[[posture.states]]", "progress = 0.5\n\n[[posture.states]]", 1)
        record = solve(problem(text))
        assert record["verdict"] == "stable" and len(record["wrenches"]) == 1
        assert record["case"]["generated"]["com"][1] == pytest.approx(0.0175, abs=1e-9)


class TestHeldObject:
    def test_the_squeeze_is_in_the_record(self):
        made = solve(problem(HELD + "mass = 1.0\nsqueeze = 15.0\n"))["case"]["generated"]
        assert made["mass"] == pytest.approx(7.2431648, abs=1e-9)
        assert [load["link"] for load in made["external_wrenches"]] == ["LARM_LINK4", "RARM_LINK4"]
        assert np.sum([load["force"] for load in made["external_wrenches"]], axis=0) == pytest.approx([0, 0, 0], abs=1e-12)
        assert [contact["name"] for contact in made["contacts"]] == ["left_foot", "right_foot"]

    def test_held_by_nothing(self):
        assert "posture.hands: hold_object: the object is held by nothing" in refusal(HELD + "hands = []\n")


def test_the_users_way(capsys, tmp_path, monkeypatch):
    """TALOS with one hand on a wall, by name, with torque limits; and a wall nobody reaches."""
    monkeypatch.chdir(tmp_path)
    assert main(["solve", "talos/hand_on_the_wall", "--json", "answer.json", "--figure", "answer.png"]) == 0
    said = capsys.readouterr().out
    assert "stable" in said and "contact     left_hand: force" in said and "torque      " in said
    assert (tmp_path / "answer.json").stat().st_size > 1000 and (tmp_path / "answer.png").stat().st_size > 10_000
    assert main(["solve", "talos/hand_on_the_wall", "--set", "posture.distance=3.0", "--json", "none.json"]) == 2
    said = capsys.readouterr()
    assert "talos/hand_on_the_wall" in said.err and "cannot reach: contact 'left_hand'" in said.err
    assert not (tmp_path / "none.json").exists()
    assert main(["list", "postures"]) == 0
    listed = capsys.readouterr().out
    assert all(word in listed for word in ("wall_brace", "hold_object", "keyframes", "quadruped_stance"))
