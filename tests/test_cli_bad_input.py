"""Wrong input: exit status 2, one plain sentence that names the culprit last on standard error, and no file written."""

import json
import subprocess
import sys

import pytest

from socp_statics.cli import main

GOOD = """\
description = "Two feet on the floor"
model = "support_region"

[posture]
generator = "contacts"
mass = 60.0
com = [0.05, 0.0, 0.80]
gravity = [0, 0, -9.81]

[[posture.contacts]]
name = "left_foot"
type = "surface"
position = [0, 0.1, 0]
rotation = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
friction = 0.6
size = [0.22, 0.13]

[[posture.contacts]]
name = "right_hand"
type = "point"
position = [0.4, -0.3, 1.0]
normal = [-1, 0, 0.2]
friction = 0.5

[parameters]
cone = "inscribed"
sides = 4
tolerance = 1e-2
"""

SURFACE = "size = [0.22, 0.13]"
ROTATION = "rotation = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]"
GRAVITY = "gravity = [0, 0, -9.81]"
EXPECT = '\n[expect]\n"region.inner_area" = { value = 1.0, tolerance = 1.0, source = "none" }\n'

# what is replaced, by what, and words of the sentence
EDITS = {
    "nan mass": ("mass = 60.0", "mass = nan", ["posture.mass", "finite number > 0", "nan"]),
    "infinite mass": ("mass = 60.0", "mass = inf", ["posture.mass", "finite"]),
    "nan in the CoM": ("com = [0.05", "com = [nan", ["posture.com", "finite numbers", "nan at [0]"]),
    "infinite position": ("position = [0, 0.1, 0]", "position = [0, inf, 0]", ["contacts[0].position", "left_foot", "inf at [1]"]),
    "nan friction": ("friction = 0.5", "friction = nan", ["contacts[1].friction", "right_hand", "finite"]),
    "nan gravity": (GRAVITY, "gravity = [0, nan, 0]", ["posture.gravity", "finite"]),
    "zero normal": ("normal = [-1, 0, 0.2]", "normal = [0, 0, 0]", ["contacts[1].normal", "right_hand", "zero"]),
    "nan normal": ("normal = [-1, 0, 0.2]", "normal = [nan, 0, 1]", ["contacts[1].normal", "right_hand", "finite"]),
    "left-handed rotation": (ROTATION, "rotation = [[1, 0, 0], [0, -1, 0], [0, 0, 1]]", ["contacts[0].rotation", "right-handed"]),
    "stretched rotation": (ROTATION, "rotation = [[2, 0, 0], [0, 1, 0], [0, 0, 1]]", ["contacts[0].rotation", "left_foot", "orthonormal"]),
    "rotation of wrong size": (ROTATION, "rotation = [[1, 0], [0, 1]]", ["contacts[0].rotation", "3 x 3"]),
    "two orientations": (ROTATION, ROTATION + "\nnormal = [0, 0, 1]", ["contacts[0]", "left_foot", "rotation and normal"]),
    "three orientations": (ROTATION, ROTATION + "\nnormal = [0, 0, 1]\nrpy = [0, 0, 0]", ["left_foot", "rotation and normal and rpy"]),
    "no orientation": (ROTATION, "", ["contacts[0]", "left_foot", "exactly one of rotation, normal and rpy"]),
    "negative friction": ("friction = 0.6", "friction = -0.4", ["contacts[0].friction", "left_foot", ">= 0", "-0.4"]),
    "missing friction": ("friction = 0.6\n", "", ["contacts[0].friction", "left_foot", "missing"]),
    "friction in words": ("friction = 0.6", 'friction = "high"', ["contacts[0].friction", "'high'"]),
    "negative mass": ("mass = 60.0", "mass = -60", ["posture.mass", "> 0", "-60"]),
    "zero mass": ("mass = 60.0", "mass = 0", ["posture.mass", "> 0"]),
    "missing mass": ("mass = 60.0\n", "", ["posture.mass", "missing"]),
    "boolean mass": ("mass = 60.0", "mass = true", ["posture.mass", "True"]),
    "zero tolerance": ("tolerance = 1e-2", "tolerance = 0", ["parameters.tolerance", "> 0"]),
    "negative tolerance": ("tolerance = 1e-2", "tolerance = -1e-3", ["parameters.tolerance", "> 0"]),
    "crossing vertices": (SURFACE, "vertices = [[0, 0], [1, 1], [1, 0], [0, 1]]", ["contacts[0].vertices", "left_foot"]),
    "reflex vertices": (SURFACE, "vertices = [[0, 0], [2, 0], [0.2, 0.2], [0, 2]]", ["contacts[0].vertices", "left_foot", "convex"]),
    "vertices on a line": (SURFACE, "vertices = [[0, 0], [1, 1], [2, 2]]", ["contacts[0].vertices", "left_foot"]),
    "two vertices": (SURFACE, "vertices = [[0, 0], [1, 1]]", ["contacts[0].vertices", "left_foot"]),
    "nan vertex": (SURFACE, "vertices = [[0, 0], [1, nan], [0, 1]]", ["contacts[0].vertices", "left_foot", "finite"]),
    "size and vertices": (SURFACE, SURFACE + "\nvertices = [[0, 0], [1, 0], [0, 1]]", ["contacts[0].size", "size and vertices"]),
    "neither size nor vertices": (SURFACE, "", ["contacts[0].size", "left_foot", "size and vertices"]),
    "zero size": (SURFACE, "size = [0.22, 0]", ["contacts[0].size", "left_foot", "> 0"]),
    "duplicate names": ('"right_hand"', '"left_foot"', ["contacts[1].name", "left_foot", "twice"]),
    "empty name": ('"right_hand"', '""', ["contacts[1].name"]),
    "unknown contact type": ('type = "point"', 'type = "pont"', ["contacts[1].type", "right_hand", "frictionless_point", "'pont'"]),
    "key of another type": ('type = "point"', 'type = "point"\nsize = [1, 2]', ["contacts[1].size", "right_hand", "point"]),
    "bounds in the wrong order": ("friction = 0.5", "friction = 0.5\nnormal_force = [10, 5]", ["contacts[1].normal_force", "lo <= hi"]),
    "unknown model": ('"support_region"', '"support_regoin"', ["model 'support_regoin'", "did you mean 'support_region'"]),
    "missing model": ('model = "support_region"', "", ["model", "missing"]),
    "unknown generator": ('"contacts"', '"contact"', ["posture.generator", "'contact'", "mean 'contacts'"]),
    "missing generator": ('generator = "contacts"\n', "", ["posture.generator", "missing"]),
    "unknown key at the top": ("description", "descripton", ["descripton", "did you mean 'description'"]),
    "unknown key of the posture": ("mass = 60.0", "mass = 60.0\nmas = 3", ["posture.mas ", "did you mean 'mass'"]),
    "unknown key of a contact": ("friction = 0.5", "friction = 0.5\nfrction = 0.5", ["contacts[1].frction", "right_hand", "friction"]),
    "unknown parameter": ("tolerance = 1e-2", "tolerence = 1e-2", ["parameters.tolerence", "did you mean 'tolerance'"]),
    "unknown cone": ('"inscribed"', '"inner"', ["parameters.cone", "'exact', 'inscribed' or 'circumscribed'", "'inner'"]),
    "two sides": ("sides = 4", "sides = 2", ["parameters.sides", ">= 3", "2"]),
    "sides not whole": ("sides = 4", "sides = 4.5", ["parameters.sides", "whole number", "4.5"]),
    "infinite heading": ("sides = 4", "sides = 4\nheading = inf", ["parameters.heading", "finite"]),
    "unknown form": ("sides = 4", 'form = "lp"', ["parameters.form", "'socp' or 'sdp'"]),
    "torque limits without a robot": ("sides = 4", "torque_limits = true", ["parameters.torque_limits", "robot"]),
    "negative safety": ("sides = 4", "safety = -0.1", ["parameters.safety", ">= 0"]),
    "a contact that is a number": ("mass = 60.0", "mass = 60.0\nexternal_wrenches = [3]", ["posture.external_wrenches", "3"]),
    "a force without a point": (
        "mass = 60.0", "mass = 60.0\nexternal_wrenches = [{ force = [1, 0, 0] }]", ["posture.external_wrenches[0].point", "missing"],
    ),
    "inertia not symmetric": ("mass = 60.0", "mass = 60.0\ninertia = [[1, 1, 0], [0, 1, 0], [0, 0, 1]]", ["posture.inertia", "symmetric"]),
    "zero gravity": (GRAVITY, "gravity = [0, 0, 0]", ["gravity"]),
    "horizontal gravity": (GRAVITY, "gravity = [9.81, 0, 0]", ["gravity"]),
    "unclosed list": ("com = [0.05, 0.0, 0.80]", "com = [0.05, 0.0", ["malformed TOML", "line 8, column 1"]),
    "unclosed at the end": ("tolerance = 1e-2", "tolerance = [1", ["malformed TOML", "line", "column"]),
    "no value": ("mass = 60.0", "mass = ", ["malformed TOML", "line 6, column 8"]),
    "a key twice": ("mass = 60.0", "mass = 60.0\nmass = 61.0", ["malformed TOML", "line 7"]),
    "nested too deeply": ("mass = 60.0", "mass = " + "[" * 5000, ["nested too deeply"]),
    "an endless number": ("mass = 60.0", "mass = " + "1" * 5000, ["malformed TOML"]),
    "a huge number": ("mass = 60.0", "mass = 1" + "0" * 400, ["posture.mass", "finite"]),
    "a huge hexadecimal number": ("mass = 60.0", "mass = 0x" + "f" * 9000, ["posture.mass", "too large"]),
}  # fmt: skip

# added to the end of the file, and words of the sentence
APPENDED = {
    "expected key misspelt": (EXPECT.replace("inner_area", "inner_aera"), ['expect."region.inner_aera"', "'inner_area'"]),
    "expected contact unknown": (EXPECT.replace("region.inner_area", "wrenches.left_fot.force[2]"), ["left_fot", "'left_foot'"]),
    "expected entry not an index": (EXPECT.replace("region.inner_area", "idle.first"), ["idle", "index"]),
    "expected key is no path": (EXPECT.replace("region.inner_area", "region..area"), ["expect", "dotted TOML key"]),
    "expected value is a table": (EXPECT.replace("value = 1.0", "value = {}"), ["expect", "value", "number"]),
    "expected value is nan": (EXPECT.replace("value = 1.0", "value = nan"), ["expect", "value", "number"]),
    "negative expected tolerance": (EXPECT.replace("tolerance = 1.0", "tolerance = -1.0"), ["expect", "tolerance", ">= 0"]),
    "an expectation that is no table": ('\n[expect]\nverdict = "stable"\n', ["expect.verdict", "table", "value, tolerance, source"]),
    "sweep over an unknown key": ('\n[sweep]\n"posture.contacts.left_foot.frction" = [1, 2]\n', ["contacts[0].frction", "not a known key"]),
    "sweep over an unknown contact": ('\n[sweep]\n"posture.contacts.left_fot.friction" = [1, 2]\n', ["sweep", "left_fot", "'left_foot'"]),
    "sweep over an unknown table": ('\n[sweep]\n"postur.mass" = [1, 2]\n', ["postur", "did you mean 'posture'"]),
    "sweep over nothing": ('\n[sweep]\n"posture.mass" = []\n', ["sweep", "posture.mass", "list of values"]),
    "sweep over one number": ('\n[sweep]\n"posture.mass" = 3\n', ["sweep", "posture.mass", "list of values"]),
    "sweep with a range backwards": ('\n[sweep]\n"posture.mass" = { from = 3, to = 1 }\n', ["sweep", "posture.mass", "a <= b"]),
    "sweep over the expectations": ('\n[sweep]\n"expect.margin.value" = [1, 2]\n', ["sweep", "cannot be swept"]),
    "a sweep without --case": ('\n[sweep]\n"posture.mass" = [1, 2, 3]\n', ["--case", "3 cases", "0 to 2"]),
}  # fmt: skip

# arguments after the name of the good file, and words of the sentence
ARGUMENTS = {
    "unknown key": (["--set", "posture.contacts.left_foot.frction=0.4"], ["--set", "contacts[0].frction", "friction"]),
    "unknown contact": (["--set", "posture.contacts.left_fot.friction=0.4"], ["--set", "left_fot", "did you mean 'left_foot'"]),
    "index beyond the list": (["--set", "posture.contacts[2].friction=0.4"], ["--set", "posture.contacts", "2 entries"]),
    "negative value": (["--set", "posture.contacts.left_foot.friction=-0.4"], ["--set", "contacts[0].friction", "-0.4"]),
    "word for a number": (["--set", "posture.mass=heavy"], ["--set", "posture.mass", "'heavy'"]),
    "no value": (["--set", "posture.mass"], ["--set", "KEY=VALUE"]),
    "no key": (["--set", "=3"], ["--set", "dotted TOML key"]),
    "beyond a number": (["--set", "posture.mass.x=3"], ["--set", "posture.mass", "'x'"]),
    "unknown model": (["--set", "model=equilibrum"], ["--set", "model", "did you mean 'equilibrium'"]),
    "unknown engine": (["--engine", "clarabell"], ["--engine", "'clarabell'", "did you mean 'clarabel'"]),
    "case of no sweep": (["--case", "1"], ["--case", "got 1"]),
    "negative case": (["--case", "-1"], ["--case", "-1"]),
    "case that is a word": (["--case", "first"], ["problem.toml: --case must be a whole number from 0 to 0, got 'first'"]),
    "case that is no whole number": (["--case", "1.5"], ["problem.toml: --case must be a whole number", "got '1.5'"]),
    "case with too many digits": (["--case", "9" * 5000], ["--case must be a whole number"]),
    "unknown option": (["--sides", "3"], ["--sides"]),
    "option without a value": (["--set"], ["--set"]),
    "a second problem": (["other.toml"], ["other.toml"]),
    "figure of an unknown kind": (["--figure", "out.xyz"], ["--figure", "out.xyz", ".pdf"]),
    "unwritable record": (["--json", "no/such/folder/out.json"], ["--json", "no/such/folder/out.json", "No such file or directory"]),
    "unwritable figure": (["--figure", "no/such/folder/out.pdf"], ["--figure", "no/such/folder/out.pdf"]),
    "record into a folder": (["--json", "."], ["--json", "folder"]),
    "record over the problem": (["--json", "problem.toml"], ["--json", "problem.toml", "problem file itself"]),
    "record below a file": (["--json", "problem.toml/out.json"], ["--json", "problem.toml/out.json"]),
    "record and figure in one file": (["--json", "out.pdf", "--figure", "out.pdf"], ["--figure", "same file"]),
}


@pytest.fixture(autouse=True)
def empty_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def refused(capsys, arguments, words, folder):
    """Run, and check status, sentence and that nothing was written."""
    before = sorted(path.name for path in folder.iterdir())
    status = main(arguments)
    said = capsys.readouterr()
    sentence = said.err.rstrip("\n").rpartition("\n")[2]
    assert status == 2, said
    assert not [word for word in words if word not in sentence], sentence
    assert "Traceback" not in said.err
    assert said.out == ""
    assert sorted(path.name for path in folder.iterdir()) == before
    return sentence


@pytest.mark.parametrize("edit", EDITS.values(), ids=EDITS)
def test_a_wrong_file_is_refused(edit, capsys, tmp_path):
    old, new, words = edit
    assert old in GOOD
    (tmp_path / "problem.toml").write_text(GOOD.replace(old, new, 1))
    refused(capsys, ["solve", "problem.toml", "--json", "out.json", "--figure", "out.pdf"], ["problem.toml", *words], tmp_path)


@pytest.mark.parametrize("appended", APPENDED.values(), ids=APPENDED)
def test_a_wrong_sweep_or_expectation_is_refused(appended, capsys, tmp_path):
    text, words = appended
    (tmp_path / "problem.toml").write_text(GOOD + text)
    refused(capsys, ["solve", "problem.toml", "--json", "out.json"], ["problem.toml", *words], tmp_path)


@pytest.mark.parametrize("argument", ARGUMENTS.values(), ids=ARGUMENTS)
def test_a_wrong_argument_is_refused(argument, capsys, tmp_path):
    arguments, words = argument
    (tmp_path / "problem.toml").write_text(GOOD)
    refused(capsys, ["solve", "problem.toml", *arguments], words, tmp_path)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", ["empty"]),
        (b" \n\n", ["empty"]),
        (b"\x89PNG\r\n\x1a\n\xff\xfe", ["not a text file"]),
        (b"\0\0", ["binary"]),
        (b"# nothing\n", ["model", "posture"]),
    ],
    ids=["empty", "blank", "binary", "zeros", "comment"],
)
def test_a_file_without_a_problem_is_refused(content, words, capsys, tmp_path):
    (tmp_path / "problem.toml").write_bytes(content)
    refused(capsys, ["solve", "problem.toml"], ["problem.toml", *words], tmp_path)
    refused(capsys, ["show", "problem.toml"], ["problem.toml", *words], tmp_path)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("absent.toml", ["absent.toml", "no such file"]),
        ("folder.toml", ["folder.toml", "folder"]),
        (".", ["'.'", "folder"]),
        ("no_such_family/no_such_name", ["no_such_family/no_such_name", "named problem"]),
        ("bad\0name.toml", ["cannot be read"]),
        ("", ["named problem"]),
    ],
    ids=["missing", "folder.toml", "folder", "name", "zero byte", "empty"],
)
def test_what_is_no_problem_is_refused(name, words, capsys, tmp_path):
    (tmp_path / "folder.toml").mkdir()
    refused(capsys, ["solve", name], words, tmp_path)


def test_a_folder_is_named_once(capsys, tmp_path):
    (tmp_path / "folder.toml").mkdir()
    for verb in (["solve"], ["run"]):
        said = refused(capsys, [*verb, "folder.toml"], [], tmp_path)
        assert said == "folder.toml: this is a folder, a problem file (.toml) is expected"


@pytest.mark.parametrize("verb", ["solve", "run"])
def test_a_name_that_is_nearly_one_is_helped(verb, capsys, tmp_path):
    (tmp_path / "base.toml").write_text(GOOD)
    refused(capsys, [verb, "base"], ["did you mean 'base.toml'?"], tmp_path)
    refused(capsys, [verb, "contacts/flat"], ["did you mean 'contacts/flat_double_stance'"], tmp_path)


def test_what_can_be_listed_is_said_once(capsys, tmp_path):
    said = refused(capsys, ["list", "nonsense"], [], tmp_path)
    assert said == "list: 'nonsense' cannot be listed, one of problems, models, postures, robots is expected"
    refused(capsys, ["list", "robot"], ["did you mean 'robots'?"], tmp_path)


def test_help_is_whole(capsys):
    assert main(["--help"]) == 0
    commands = capsys.readouterr().out.partition("Commands:")[2]
    assert commands.count("\n") >= 9 and "..." not in commands
    for verb in ("run", "figures", "report", "list"):
        assert main([verb, "--help"]) == 0
        assert "[[" not in capsys.readouterr().out


@pytest.mark.parametrize("arguments", [["lst"], ["list", "problem"], ["show"], ["solve"], ["--vers"]], ids=" ".join)
def test_a_wrong_command_line_is_refused(arguments, capsys, tmp_path):
    refused(capsys, arguments, [], tmp_path)


def test_contacts_are_needed(capsys, tmp_path):
    head, _, _ = GOOD.partition("[[posture.contacts]]")
    (tmp_path / "problem.toml").write_text(head)
    refused(capsys, ["solve", "problem.toml"], ["posture.contacts", "missing"], tmp_path)
    (tmp_path / "problem.toml").write_text(head + "contacts = []\n")
    refused(capsys, ["solve", "problem.toml"], ["posture.contacts", "at least one"], tmp_path)


def test_all_faults_are_named_at_once(capsys, tmp_path):
    text = (
        GOOD.replace("mass = 60.0", "mass = -1")
        .replace("friction = 0.6", "friction = -1")
        .replace('"point"', '"pont"')
        .replace("sides = 4", "sids = 4")
    )
    (tmp_path / "problem.toml").write_text(text)
    words = ["posture.mass", "contacts[0].friction", "contacts[1].type", "parameters.sids"]
    refused(capsys, ["solve", "problem.toml"], words, tmp_path)


def test_the_process_says_one_sentence_and_exits_with_two(tmp_path):
    (tmp_path / "problem.toml").write_text(GOOD.replace("mass = 60.0", "mass = -1"))
    code = "from socp_statics.cli import entry_point; entry_point()"
    done = subprocess.run([sys.executable, "-c", code, "solve", "problem.toml", "--json", "-"], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "problem.toml: posture.mass must be a finite number > 0 [kg], got -1\n"


def test_an_expectation_that_fails_is_status_one_and_the_record_is_written(capsys, tmp_path):
    (tmp_path / "problem.toml").write_text(GOOD + EXPECT.replace("tolerance = 1.0", "tolerance = 1e-9"))
    assert main(["solve", "problem.toml", "--json", "out.json"]) == 1
    sentence = capsys.readouterr().err.rstrip("\n").rpartition("\n")[2]
    assert "problem.toml" in sentence
    assert "region.inner_area" in sentence
    entry = json.loads((tmp_path / "out.json").read_text())["expect"][0]
    assert (entry["key"], entry["expected"], entry["ok"]) == ("region.inner_area", 1.0, False)
