"""Wrong input about a robot: one sentence that names the key path, the name that is wrong, and near names."""

import tomllib

import pytest

from socp_statics.cases.problem import problem_from_tables
from socp_statics.cases.solve import solve
from socp_statics.cli import main
from socp_statics.exceptions import InputError

FRAME = "\n[posture.frames.heel]\n"
PARAMETERS = "\n[parameters]"
WRENCH = "\n[[posture.external_wrenches]]\nforce = [0, 0, -1]\npoint = [0, 0, 0.3]\n"
LIMITS = "default = inf"
GOOD = f"""\
model = "equilibrium"

[posture]
generator = "squat"
robot = "hoap2"
support = ["left_foot", "right_foot"]
knee = 1.0
friction = 0.5

[posture.torque_limits]
{LIMITS}

[parameters]
torque_limits = true
"""


def refusal(text):
    with pytest.raises(InputError) as caught:
        solve(problem_from_tables(tomllib.loads(text), "robot"))
    return str(caught.value)


EDITS = {
    "unknown robot": ('"hoap2"', '"hoap3"', ["posture.robot", "'hoap3'", "did you mean 'hoap2'"]),
    "robot of another kind": ('"hoap2"', "2", ["posture.robot must be", "got 2"]),
    "no robot": ('robot = "hoap2"\n', "", ["posture.robot", "missing"]),
    "unknown generator": ('"squat"', '"sqat"', ["posture.generator", "'sqat'", "did you mean 'squat'"]),
    "a word for an angle": ("knee = 1.0", 'knee = "deep"', ["posture.knee", "finite number [rad]", "'deep'"]),
    "an angle that is nan": ("knee = 1.0", "knee = nan", ["posture.knee", "nan"]),
    "an angle beyond its joint": ("knee = 1.0", "knee = 2.9", ["LLEG_JOINT3", "-1.43117", "-1.45"]),
    "key of another generator": ("knee = 1.0", "lift = 1.0", ["posture.lift is not a known key"]),
    "unknown arms": ("knee = 1.0", 'arms = "up"', ["posture.arms", "'down'", "'up'"]),
    "inertia of a robot": ("knee = 1.0", "mass = 6.0", ["posture.mass is not a known key"]),
    "unknown contact": ('"right_foot"', '"right_fot"', ["posture.support[1]", "'right_fot'", "did you mean 'right_foot'"]),
    "contact named twice": ('"right_foot"', '"left_foot"', ["posture.support", "'left_foot' twice"]),
    "no contact": ('["left_foot", "right_foot"]', "[]", ["posture.support", "at least one"]),
    "contact off the ground": ('"right_foot"', '"left_hand"', ["posture.support", "left_hand", "level"]),
    "negative friction": ("friction = 0.5", "friction = -0.5", ["posture.friction", ">= 0", "-0.5"]),
    "negative friction of one": ("friction = 0.5", "friction = { left_foot = -1 }", ["posture.friction.left_foot", ">= 0", "-1"]),
    "friction of one missing": ("friction = 0.5", "friction = { left_foot = 0.5 }", ["posture.friction", "right_foot", "missing"]),
    "friction of another": ("friction = 0.5", "friction = { left_fot = 1 }", ["posture.friction", "'left_fot'"]),
    "position of two numbers": ("knee = 1.0", "at = [0, 0]", ["posture.at", "three finite numbers"]),
    "limits of no joint": (LIMITS, f"{LIMITS}\nLLEG_JOINT7 = 3", ["torque_limits.LLEG_JOINT7", "did you mean 'LLEG_JOINT"]),
    "a pattern without a match": (LIMITS, f'{LIMITS}\n"?LEGS*" = 3', ['torque_limits."?LEGS*"', "matches no joint"]),
    "two patterns on one joint": (LIMITS, f'{LIMITS}\n"LLEG*" = 3\n"*JOINT4" = 3', ["LLEG_JOINT4", "two patterns"]),
    "lower above zero": (LIMITS, f"{LIMITS}\nLLEG_JOINT4 = [1, 3]", ["torque_limits.LLEG_JOINT4", "lower <= 0 <= upper"]),
    "upper below zero": (LIMITS, f"{LIMITS}\nLLEG_JOINT4 = [-3, -1]", ["torque_limits.LLEG_JOINT4", "lower <= 0 <= upper"]),
    "limits in the wrong order": (LIMITS, f"{LIMITS}\nLLEG_JOINT4 = [3, -1]", ["torque_limits.LLEG_JOINT4", "3"]),
    "negative limit": (LIMITS, f"{LIMITS}\nLLEG_JOINT4 = -1", ["torque_limits.LLEG_JOINT4", "number >= 0", "-1"]),
    "limit that is nan": (LIMITS, f"{LIMITS}\nLLEG_JOINT4 = nan", ["torque_limits.LLEG_JOINT4", "nan"]),
    "limit in words": (LIMITS, f'{LIMITS}\nLLEG_JOINT4 = "low"', ["torque_limits.LLEG_JOINT4", "'low'"]),
    "placeholders": (LIMITS, '"?LEG*" = 4', ["posture.torque_limits", "BODY_JOINT1", "placeholders"]),
    "unknown link": ("\n[parameters]", f'{WRENCH}link = "BODY_LINK"\n[parameters]', ["external_wrenches[0].link", "BODY_LINK1"]),
    "unknown frame": (
        PARAMETERS, FRAME + 'frame = "LLEG_LINK"\ntype = "point"' + PARAMETERS, ["frames.heel.frame", "LLEG_LINK6"],
    ),
    "frame without a size": (
        PARAMETERS, FRAME + 'frame = "LLEG_LINK6"\ntype = "surface"' + PARAMETERS, ["frames.heel", "size"],
    ),
    "unknown key of a frame": (
        PARAMETERS, FRAME + 'frame = "LLEG_LINK6"\ntype = "point"\nfriction = 1' + PARAMETERS, ["frames.heel.friction"],
    ),
    "expected joint unknown": (PARAMETERS, '\n[expect]\n"torques.LLEG_JOINT" = { value = 1 }' + PARAMETERS, ["mean 'LLEG_JOINT"]),
}  # fmt: skip


@pytest.mark.parametrize("edit", EDITS.values(), ids=EDITS)
def test_a_wrong_robot_problem_is_refused(edit):
    old, new, words = edit
    assert old in GOOD
    text = GOOD.replace(old, new, 1)
    sentence = refusal(text)
    assert sentence.startswith("robot: ")
    assert "\n" not in sentence
    assert not [word for word in words if word not in sentence], sentence


def test_the_good_problem_is_good():
    assert solve(problem_from_tables(tomllib.loads(GOOD), "robot"))["verdict"] == "stable"


def test_all_faults_of_a_robot_problem_are_named_at_once():
    text = GOOD.replace('"right_foot"', '"right_fot"').replace(LIMITS, '"?LEGS*" = 3\nLKNEE = 4\nRLEG_JOINT4 = [1, 2]\nRLEG_JOINT5 = -1')
    text = text.replace("knee = 1.0", 'knee = "deep"').replace("\n[parameters]", f'{WRENCH}link = "chest"\n[parameters]\nsids = 4')
    sentence = refusal(text)
    for path in (
        "support[1]",
        'torque_limits."?LEGS*"',
        "torque_limits.RLEG_JOINT5",
        "posture.knee",
        "wrenches[0].link",
        "parameters.sids",
    ):
        assert path in sentence, path
    sound = refusal(text.replace("RLEG_JOINT5 = -1", ""))
    assert "torque_limits.LKNEE" in sound and "torque_limits.RLEG_JOINT4" in sound


def test_a_contact_whose_frame_is_wrong_is_not_blamed_twice():
    text = GOOD.replace('"right_foot"', '"heel"').replace(PARAMETERS, FRAME + 'frame = "LLEG_LINK"\ntype = "point"' + PARAMETERS)
    sentence = refusal(text)
    assert "posture.frames.heel.frame" in sentence and "posture.support" not in sentence


def test_angles_are_judged_one_by_one():
    joints = GOOD.replace('"squat"', '"joint_angles"').replace("knee = 1.0", "angles = { LKNEE = 1, RLEG_JOINT4 = 3, LLEG_JOINT4 = 'x' }")
    assert "posture.angles.LLEG_JOINT4 must be a finite number [rad]" in refusal(joints)
    sentence = refusal(joints.replace("'x'", "1"))
    assert "posture.angles.LKNEE" in sentence and "posture.angles.RLEG_JOINT4" in sentence and "2.26893" in sentence


@pytest.mark.parametrize(
    ("model", "parameters", "words"),
    [
        ("torque_feasibility", {"torque_limits": False}, "parameters.torque_limits.*true is expected"),
        ("contact_forces", {"rates": {"LLEG_JOINT4": 1.0}}, "parameters.rates.*orin_oh"),
        ("contact_forces", {"b": 1.0}, "parameters.b.*orin_oh"),
        ("contact_forces", {"objective": "orin_oh", "rates": {"LKNEE": 1.0}}, "parameters.rates.LKNEE.*no joint"),
        ("contact_forces", {"objective": "orin_oh", "b": -1.0}, "parameters.b must be"),
        ("contact_forces", {"objective": "orin_oh", "rates": {"LLEG_JOINT4": "fast"}}, "parameters.rates.LLEG_JOINT4 must be"),
    ],
)
def test_parameters_about_joints_are_checked(model, parameters, words):
    with pytest.raises(InputError, match=words):
        problem_from_tables(tomllib.loads(GOOD) | {"model": model, "parameters": parameters}, "robot")


@pytest.mark.parametrize(
    ("model", "parameters"),
    [
        ("torque_feasibility", {}),
        ("equilibrium", {"torque_limits": True}),
        ("contact_forces", {"objective": "orin_oh", "rates": {"a": 1.0}}),
    ],
)
def test_joints_need_a_robot(model, parameters):
    point = {"name": "point", "type": "point", "position": [0, 0, 0], "normal": [0, 0, 1], "friction": 0.5}
    posture = {"generator": "contacts", "mass": 1, "com": [0, 0, 1], "contacts": [point]}
    with pytest.raises(InputError, match="parameters.*robot"):
        problem_from_tables({"model": model, "posture": posture, "parameters": parameters}, "stone")
    loads = [{"force": [0, 0, 1], "point": [0, 0, 0], "link": "base"}]
    with pytest.raises(InputError, match="external_wrenches.0..link is not a known key"):
        problem_from_tables({"model": "equilibrium", "posture": posture | {"external_wrenches": loads}}, "stone")
    with pytest.raises(InputError, match="torques.*robot"):
        problem_from_tables({"model": "equilibrium", "posture": posture, "expect": {"torques.knee": {"value": 1}}}, "stone")


def test_a_wrong_robot_on_the_command_line_is_exit_two(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["solve", "hoap2/half_squat", "--set", 'posture.torque_limits."?LEGS*"=2.0', "--json", "out.json"]) == 2
    said = capsys.readouterr()
    assert said.out == "" and "matches no joint" in said.err.rpartition("\n")[0]
    assert list(tmp_path.iterdir()) == []
