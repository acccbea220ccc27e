"""Problems with a robot: URDFs of one's own, generators of plugins, records, and the areas of torque-limited regions."""

import json
import math
import subprocess
import sys
import tomllib

import pytest

from socp_statics.cases.problem import load_problem, problem_from_tables
from socp_statics.cases.solve import solve
from socp_statics.cases.summary import summarise
from socp_statics.cases.toml_text import problem_toml
from socp_statics.cli import main
from socp_statics.exceptions import InputError
from socp_statics.postures import GENERATORS, pose
from socp_statics.registry import Entry

LIMITS = "default = inf"
GOOD = f"""\
model = "equilibrium"

[posture]
generator = "squat"
robot = "hoap2"

[posture.torque_limits]
{LIMITS}

[parameters]
torque_limits = true
"""

# a link with one driven joint above its sole; the motor is real
LEG = """\
<robot name="stick">
  <link name="trunk"><inertial><mass value="2.0"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="shank"><inertial><mass value="0.5"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="knee" type="revolute"><parent link="trunk"/><child link="shank"/><origin xyz="0.05 0 -0.3"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="7" velocity="1"/></joint>
</robot>
"""
STICK = """\
model = "equilibrium"

[posture]
generator = "joint_angles"
robot = "stick.urdf"
support = ["sole"]

[posture.frames.sole]
frame = "shank"
type = "surface"
size = [0.3, 0.1]
position = [0, 0, -0.3]

[parameters]
torque_limits = true
"""


def problem(text=GOOD):
    return problem_from_tables(tomllib.loads(text), "robot")


# a robot of one's own


@pytest.fixture
def stick(tmp_path):
    (tmp_path / "stick.urdf").write_text(LEG)
    (tmp_path / "stick.toml").write_text(STICK)
    return tmp_path


def test_a_path_starts_at_the_folder_of_the_file(stick):
    record = solve(load_problem(stick / "stick.toml"))
    assert record["verdict"] == "stable"
    assert record["torque_limits"] == {"knee": [-7.0, 7.0]}
    assert record["torques"]["knee"] == pytest.approx(-2.0 * 9.81 * 0.05)


def test_a_stronger_motor_or_a_heavier_trunk_is_another_question(stick):
    first = solve(load_problem(stick / "stick.toml"))
    assert solve(load_problem(stick / "stick.toml")).to_json() == first.to_json()
    for old, new in (('effort="7"', 'effort="8"'), ('mass value="2.0"', 'mass value="2.1"')):
        (stick / "stick.urdf").write_text(LEG.replace(old, new))
        assert solve(load_problem(stick / "stick.toml"))["hash"] != first["hash"]


def test_a_frame_changes_the_hash_and_survives_toml(stick):
    loaded = load_problem(stick / "stick.toml")
    assert "[posture.frames.sole]" in problem_toml(loaded)
    (stick / "again.toml").write_text(problem_toml(loaded))
    again = load_problem(stick / "again.toml")
    assert again.stated() == loaded.stated()
    assert solve(again)["hash"] == solve(loaded)["hash"]
    assert solve(loaded.with_values({"posture.frames.sole.size": [0.3, 0.2]}))["hash"] != solve(loaded)["hash"]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("</robot>", "", ["stick.urdf", "not a URDF"]),
        ('mass value="2.0"', 'mass value="-2.0"', ["stick.urdf", "link 'trunk'", "negative mass"]),
        ('child link="shank"', 'child link="shnk"', ["stick.urdf", "joint 'knee'", "shnk"]),
        ('effort="7"', 'effort="0"', ["posture.torque_limits", "knee", "placeholders"]),
        ('effort="7"', 'effort="9999"', ["posture.torque_limits", "knee", "placeholders"]),
    ],
)
def test_a_broken_urdf_is_named_by_file_and_element(stick, old, new, words):
    (stick / "stick.urdf").write_text(LEG.replace(old, new))
    with pytest.raises(InputError) as caught:
        load_problem(stick / "stick.toml")
    assert not [word for word in words if word not in str(caught.value)], caught.value


def test_a_missing_urdf_is_named(stick):
    (stick / "stick.urdf").rename(stick / "stork.urdf")
    with pytest.raises(InputError, match="posture.robot: .*stick.urdf.* does not exist"):
        load_problem(stick / "stick.toml")


def test_a_robot_without_the_contact_asked_for_is_refused(stick):
    with pytest.raises(InputError, match="posture.support.0.*'heel'"):
        load_problem(stick / "stick.toml").with_values({"posture.support": ["heel"]})


# generators of others


def crouch(robot, *, depth: float, support: list[str] = ("left_foot",), friction: float = 0.5):
    """Bend one knee.

    Args:
        depth: Knee angle [rad].
    """
    return pose(robot, {"LLEG_JOINT3": -depth / 2, "LLEG_JOINT4": depth, "LLEG_JOINT5": -depth / 2}, support, friction)


def test_a_generator_of_a_plugin_brings_its_own_numbers(monkeypatch):
    monkeypatch.setitem(GENERATORS._own, "crouch", Entry("crouch", "one deep knee", f"{__name__}:crouch"))
    text = 'model = "equilibrium"\n[posture]\ngenerator = "crouch"\nrobot = "hoap2"\ndepth = 1'
    assert problem(text).posture["support"] == ["left_foot"]
    assert problem(text).robot_posture.angles[problem(text).robot_posture.robot.joint_index("LLEG_JOINT4")] == 1.0
    with pytest.raises(InputError, match="posture.depth is missing: it must be a finite number .rad."):
        problem(text.replace("depth = 1", ""))
    with pytest.raises(InputError, match="posture.at is not a known key"):
        problem(text.replace("depth = 1", "depth = 1\nat = [0, 0, 0]"))


# records


def test_restating_what_was_generated_gives_the_same_margin():
    for name in ("hoap2/double_stance", "hoap2/contact_forces", "hoap2/single_stance_tips"):
        first = json.loads(solve(load_problem(name)).to_json())
        generated = first["case"]["generated"]
        posture = {"generator": "contacts", **{key: generated[key] for key in ("contacts", "com", "mass")}}
        again = solve(problem_from_tables({"model": first["model"], "posture": posture}, "again"))
        assert again["margin"] == pytest.approx(first["margin"], rel=1e-9)
        assert "torques" in first and "torques" not in again


def test_the_record_names_every_joint_and_only_the_limits_in_force():
    record = solve(problem())
    robot = problem().robot_posture.robot
    assert list(record["torques"]) == list(record["torque_limits"]) == list(record["case"]["generated"]["angles"]) == list(robot.joints)
    assert record["case"]["generated"]["angles"]["LLEG_JOINT4"] == 1.0
    assert record["case"]["posture"]["arms"] == "down"
    assert record["torque_limits"]["LLEG_JOINT4"] == ["-inf", "inf"]
    assert "pin" in record["versions"]
    free = solve(problem().with_values({"parameters.torque_limits": False}))
    assert free["torque_limits"] == {}
    assert list(free["torques"]) == list(robot.joints)
    assert free["hash"] != record["hash"]


def test_a_knee_that_gives_way_is_in_the_certificate():
    record = solve(load_problem("hoap2/weak_knees"))
    assert (record["verdict"], record["reason"], record["torques"]) == ("unstable", "torque", {})
    assert record["certificate"]["joints"]["LLEG_JOINT4"] > 0
    said = summarise(record)
    assert "only because of the torque limits" in said and "LEG_JOINT4" in said


def test_the_answer_for_a_person_names_the_joints_that_work_hardest():
    said = summarise(solve(load_problem("hoap2/half_squat")))
    assert "frozen posture" in said
    assert "LEG_JOINT4 -1.445 N m, 36.1 % of its limit" in said
    assert sum(line.startswith("torque") for line in said.splitlines()) == 3
    assert "120" in summarise(solve(load_problem("hoap2/torque_infeasible")))


def test_limits_that_are_not_in_force_need_not_cover_placeholders():
    text = GOOD.replace(LIMITS, '"?LEG*" = 4')
    assert solve(problem(text.replace("torque_limits = true", "torque_limits = false")))["verdict"] == "stable"
    with pytest.raises(InputError, match="LLEG_JOINT4.*two patterns"):
        problem(text.replace('"?LEG*" = 4', '"?LEG*" = 4\n"*JOINT4" = 3').replace("torque_limits = true", "torque_limits = false"))


def test_orin_and_oh_without_a_robot_count_the_largest_force():
    points = [{"name": n, "type": "point", "position": [x, 0, 0], "normal": [0, 0, 1], "friction": 0.5} for n, x in (("a", -1), ("b", 3))]
    posture = {"generator": "contacts", "mass": 4, "com": [0, 0, 1], "gravity": [0, 0, -10], "contacts": points}
    record = solve(
        problem_from_tables({"model": "contact_forces", "posture": posture, "parameters": {"objective": "orin_oh", "b": 2.0}}, "bar")
    )
    assert record["objective"] == pytest.approx(60.0, rel=1e-6)


# areas


@pytest.mark.parametrize(
    ("knee", "limit", "area"),
    [
        (1.0, 9.0, 138.2), (1.0, 5.0, 138.1), (1.0, 4.0, 135.6), (1.0, 3.0, 128.8), (1.0, 2.5, 121.3), (1.0, 2.0, 99.4), (1.0, 1.5, 64.2),
        (2.0, 9.0, 138.2), (2.0, 5.0, 131.1), (2.0, 4.0, 123.5), (2.0, 3.0, 101.5), (2.0, 2.5, 80.0), (2.0, 2.0, 55.5), (2.0, 1.5, 22.4),
    ],
)  # fmt: skip
def test_the_torque_limited_region_has_the_area_of_the_tables(knee, limit, area):
    base = load_problem("hoap2/half_squat")
    record = solve(base.with_values({"posture.knee": knee, 'posture.torque_limits."?LEG_JOINT*"': limit}))
    assert record["region"]["posture"] == "frozen"
    assert 1e4 * record["region"]["inner_area"] == pytest.approx(area, abs=0.2)
    assert math.isclose(record["region"]["outer_area"], record["region"]["inner_area"], rel_tol=2e-3)


def test_a_sweep_of_limits_has_the_records_of_the_single_problems():
    case = next(case for case in load_problem("hoap2/half_squat_sweep").cases() if case.posture["torque_limits"]["?LEG_JOINT*"] == 3.0)
    single, swept = solve(load_problem("hoap2/half_squat_3")), solve(case)
    assert swept["hash"] == single["hash"]
    assert swept["region"] == single["region"]


# lists


def test_robots_and_postures_are_listed(capsys):
    assert main(["list", "robots", "--json"]) == 0
    assert "placeholders" in json.loads(capsys.readouterr().out)["hoap2"]
    assert main(["list", "postures", "--json"]) == 0
    assert list(json.loads(capsys.readouterr().out))[:4] == ["contacts", "random_contacts", "joint_angles", "standing"]


@pytest.mark.parametrize("arguments", ["--help", "list", "list robots"])
def test_listing_starts_neither_kinematics_nor_solvers(arguments):
    code = f"import sys; from socp_statics.cli import main; main({arguments.split()!r}); print(*sys.modules, file=sys.stderr)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not {"pinocchio", "cvxpy", "clarabel", "matplotlib"} & set(done.stderr.split())
