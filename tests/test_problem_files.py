"""Problem files: dotted keys, sweeps, parameters, TOML text and names."""

import json
import tomllib

import numpy as np
import pytest

from socp_statics.cases import named_problems
from socp_statics.cases.dotted import key_text, parse_assignment, parse_key, toml_value, with_value
from socp_statics.cases.hashing import case_hash, plain
from socp_statics.cases.problem import load_problem, problem_from_tables
from socp_statics.cases.sweep import case_count, case_values, sweep_values
from socp_statics.cases.toml_text import problem_toml, toml_value_text
from socp_statics.cli import main
from socp_statics.exceptions import InputError


def feet(**changes):
    """Tables of a problem with two contacts, as TOML reads them."""
    return {
        "description": "Two contacts",
        "model": "equilibrium",
        "posture": {
            "generator": "contacts",
            "mass": 60,
            "com": [0, 0, 0.8],
            "contacts": [
                {"name": "left", "type": "surface", "position": [0, 0.1, 0], "normal": [0, 0, 1], "friction": 0.6, "size": [0.2, 0.1]},
                {"name": "right foot", "type": "point", "position": [0, -0.1, 0], "rpy": [0, 0, 0], "friction": 0.5},
            ],
        },
        **changes,
    }


def problem(**changes):
    return problem_from_tables(feet(**changes), "feet")


def digest(loaded):
    return case_hash(loaded.stated(), "clarabel")


# dotted keys


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("posture.mass", ("posture", "mass")),
        ('posture."odd name".x', ("posture", "odd name", "x")),
        ("posture.'a.b'.x", ("posture", "a.b", "x")),
        ('"with \\" quote"', ('with " quote',)),
        ("wrenches.left.force[2]", ("wrenches", "left", "force", 2)),
        ("contacts.1.friction", ("contacts", "1", "friction")),
        (" a . b ", ("a", "b")),
        ("region.inner[0][1]", ("region", "inner", 0, 1)),
    ],
)
def test_keys_are_written_as_toml_writes_them(text, parts):
    assert parse_key(text) == parts
    assert parse_key(key_text(parts)) == parts


@pytest.mark.parametrize("text", ["", ".", "a.", ".a", "a..b", "a b", "[1]", 'a."b', "?LEG*", "a[-1]", "a[1", 'a."\\q"'])
def test_what_is_no_key_is_refused(text):
    with pytest.raises(InputError):
        parse_key(text)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("0.4", 0.4),
        ("3", 3),
        ("true", True),
        ("[1, 2.5]", [1, 2.5]),
        ('"word"', "word"),
        ("word", "word"),
        ("two words", "two words"),
        ("{ a = 1 }", {"a": 1}),
        ("inf", float("inf")),
        ("", ""),
        ("[1, 2", "[1, 2"),
        ("1\nother = 2", "1\nother = 2"),
        ("a=b", "a=b"),
    ],
)
def test_values_are_toml_and_else_strings(text, value):
    assert toml_value(text) == value
    assert parse_assignment(f"a.b={text}") == (("a", "b"), value)


def test_an_equals_sign_in_a_quoted_key_does_not_end_it():
    assert parse_assignment('posture."a=b"=3') == (("posture", "a=b"), 3)


@pytest.mark.parametrize("key", ["posture.contacts.left.friction", "posture.contacts[0].friction", "posture.contacts.0.friction"])
def test_list_entries_are_chosen_by_name_or_index(key):
    assert problem().with_values({key: 0.25}).posture["contacts"][0]["friction"] == 0.25


def test_a_quoted_contact_name_is_a_key():
    changed = problem().with_values({'posture.contacts."right foot".friction': 0.25})
    assert changed.posture["contacts"][1]["friction"] == 0.25


def test_setting_a_key_leaves_the_original_alone():
    tables = feet()
    changed = with_value(tables, parse_key("posture.contacts.left.position[2]"), 5.0)
    assert changed["posture"]["contacts"][0]["position"] == [0, 0.1, 5.0]
    assert tables == feet()


def test_a_key_that_was_not_stated_can_be_set():
    assert problem().with_values({"parameters.cone": "inscribed", "parameters.sides": 8}).cone.sides == 8
    pushed = problem().with_values({"posture.external_wrenches": [{"force": [1, 0, 0], "point": [0, 0, 1]}]})
    assert pushed.stance().external_wrenches[0].force.tolist() == [1, 0, 0]


def test_an_entry_of_a_list_that_does_not_exist_cannot_be_set():
    with pytest.raises(InputError, match="is not a list, it has no entry"):
        problem().with_values({"posture.external_wrenches[0].force": [1, 0, 0]})


def test_the_model_can_be_set_and_brings_its_own_parameters():
    assert problem().with_values({"model": "support_region"}).parameters["tolerance"] == 1e-3


# sweeps


def test_the_last_key_of_a_sweep_is_fastest():
    sweep = {"a": [1, 2], "b": ["x", "y", "z"]}
    assert case_count(sweep) == 6
    pairs = [tuple(case_values(sweep, number).values()) for number in range(6)]
    assert pairs == [(1, "x"), (1, "y"), (1, "z"), (2, "x"), (2, "y"), (2, "z")]
    assert list(case_values(sweep, 4)) == ["a", "b"]


def test_a_range_has_both_its_ends_and_is_not_written_out():
    values = sweep_values("seed", {"from": 0, "to": 4999})
    assert (len(values), values[0], values[-1]) == (5000, 0, 4999)
    assert isinstance(values, range)


@pytest.mark.parametrize("stated", [[], 3, {"from": 0}, {"from": 2, "to": 1}, {"from": 0, "to": 1.5}, {"from": 0, "to": 1, "by": 1}, "abc"])
def test_what_is_no_range_is_refused(stated):
    with pytest.raises(InputError, match="list of values"):
        sweep_values("seed", stated)


def test_the_cases_of_a_sweep():
    swept = problem(sweep={"posture.mass": {"from": 1, "to": 2}, "posture.contacts.left.friction": [0.1, 0.2]})
    cases = list(swept.cases())
    assert [(case.posture["mass"], case.posture["contacts"][0]["friction"]) for case in cases] == [(1, 0.1), (1, 0.2), (2, 0.1), (2, 0.2)]
    assert not any(case.sweep for case in cases)
    assert len({case_hash(case.stated(), "clarabel") for case in cases}) == 4
    with pytest.raises(InputError, match="--case.*0 to 3"):
        swept.case(4)
    with pytest.raises(InputError, match="4 cases.*--case"):
        swept.stance()


def test_swept_keys_may_be_written_without_quotes():
    tables = feet() | tomllib.loads('[sweep]\nposture.contacts."right foot".friction = [0.1, 0.2]\nposture.mass = { from = 1, to = 3 }')
    swept = problem_from_tables(tables, "feet")
    assert swept.case_count == 6
    assert swept.case(3).posture["contacts"][1]["friction"] == 0.2


def test_a_swept_key_need_not_be_stated_beside_the_sweep():
    tables = feet(sweep={"posture.mass": [1, 2]})
    del tables["posture"]["mass"]
    assert problem_from_tables(tables, "feet").case(1).posture["mass"] == 2


def test_a_key_set_by_hand_is_no_longer_swept():
    swept = problem(sweep={"posture.mass": [1, 2], "posture.contacts.left.friction": [0.1, 0.2]})
    half = swept.with_values({"posture.contacts[0].friction": 0.9})
    assert half.case_count == 2
    assert half.case(1).posture["contacts"][0]["friction"] == 0.9
    assert not half.with_values({"posture.mass": 5}).sweep


def test_a_wrong_value_of_a_later_case_is_found_when_it_is_chosen():
    swept = problem(sweep={"posture.mass": [1, -1]})
    with pytest.raises(InputError, match="feet case 1: posture.mass"):
        swept.case(1)


# parameters


def test_pyramids_get_their_defaults_and_exact_cones_do_not():
    assert problem(parameters={"cone": "inscribed"}).parameters == {
        "cone": "inscribed", "form": "socp", "torque_limits": False, "sides": 4, "heading": 0.0,
    }  # fmt: skip
    assert "sides" not in problem().parameters


@pytest.mark.parametrize(
    ("parameters", "words"),
    [
        ({"objective": "reference"}, "parameters.reference_forces.*missing"),
        ({"reference_forces": {"left": [1, 0, 0]}}, "goes with objective 'reference'"),
        ({"objective": "reference", "reference_forces": {"lft": [1, 0, 0]}}, "'lft'.*did you mean 'left'"),
        ({"objective": "reference", "reference_forces": {"left": [1, 0]}}, "parameters.reference_forces must be"),
        ({"objective": "orin"}, "parameters.objective must be"),
    ],
)
def test_parameters_of_a_force_optimisation_are_checked(parameters, words):
    with pytest.raises(InputError, match=words):
        problem(model="contact_forces", parameters=parameters)


@pytest.mark.parametrize(("key", "value"), [("measure", "torque"), ("level", "foot"), ("length", 0), ("objective", "least_squares")])
def test_parameters_of_a_minimax_are_checked(key, value):
    with pytest.raises(InputError, match=f"parameters.{key}"):
        problem(model="minimax_wrench", parameters={key: value})


# TOML text


def many_sided():
    tables = feet(model="contact_forces", parameters={"objective": "reference", "reference_forces": {"right foot": [1, 0, 0]}})
    tables["reference"] = 'quotes " and \\ and \x7f and \u00e4'
    tables["posture"]["contacts"] += [
        {"name": "bar", "type": "handle", "position": [0, 0, 1], "rpy": [0.1, 0, 0], "transmits": ["fx", "mz"],
         "limits": {"fx": [-1, float("inf")]}},
        {"name": "finger", "type": "soft_finger", "position": [1, 0, 1], "normal": [0, 1, 1], "friction": 0.5, "torsional_friction": 1e-3,
         "normal_force": [0, float("inf")]},
    ]  # fmt: skip
    tables["posture"]["external_wrenches"] = [{"force": [1, 0, 0], "point": [0, 0, 1]}, {"moment": [0, 0, 1e-9]}]
    tables["expect"] = {"wrenches.left.force[2]": {"value": 7, "tolerance": 1e9, "source": "none"}, "margin": {"value": "inf"}}
    return problem_from_tables(tables, "many")


def test_the_text_of_a_problem_reads_back_to_the_same_problem():
    loaded = many_sided()
    again = problem_from_tables(tomllib.loads(problem_toml(loaded)), "again")
    assert again.stated() == loaded.stated()
    assert digest(again) == digest(loaded)


def test_the_text_of_a_sweep_reads_back_to_the_same_cases():
    swept = problem(sweep={"posture.mass": {"from": 1, "to": 3}, "posture.contacts.left.friction": [0.1, 0.2]})
    again = problem_from_tables(tomllib.loads(problem_toml(swept)), "again")
    assert [digest(case) for case in again.cases()] == [digest(case) for case in swept.cases()]


@pytest.mark.parametrize(
    "value", [1e-300, 1e22, 0.1, -0.0, float("inf"), -float("inf"), 7, True, 'a\n"b\\', [[1, 2], []], {"a b": {"c": [1.5]}}, {}]
)
def test_values_survive_toml(value):
    assert tomllib.loads(f"x = {toml_value_text(value)}") == {"x": value}


def test_show_toml_prints_a_file_that_solves_the_same_question(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.toml").write_text(problem_toml(many_sided()))
    assert main(["show", "a.toml", "--toml"]) == 0
    (tmp_path / "b.toml").write_text(capsys.readouterr().out)
    assert digest(load_problem("b.toml")) == digest(load_problem(tmp_path / "a.toml"))


def test_a_byte_order_mark_and_windows_line_ends_are_read(tmp_path):
    path = tmp_path / "a.toml"
    path.write_bytes(b"\xef\xbb\xbf" + problem_toml(problem()).replace("\n", "\r\n").encode())
    assert load_problem(path).name == "a"


# generated contacts


def test_the_generated_contacts_can_be_stated_again():
    loaded = many_sided()
    generated = plain([contact.statement() for contact in loaded.stance().contacts])
    again = problem_from_tables(loaded.stated() | {"posture": loaded.posture | {"contacts": json.loads(json.dumps(generated))}}, "again")
    for one, other in zip(loaded.stance().contacts, again.stance().contacts, strict=True):
        assert one.name == other.name
        np.testing.assert_allclose(one.points_W, other.points_W, atol=1e-15)
        np.testing.assert_allclose(one.rotation, other.rotation, atol=1e-15)


# named problems


@pytest.fixture
def shelf(tmp_path, monkeypatch):
    for name in ("contacts/feet", "contacts/hand", "degenerate/one_point"):
        path = tmp_path / "shelf" / f"{name}.toml"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(problem_toml(problem(description=f"about {name}")))
    monkeypatch.setattr(named_problems, "problems_folder", lambda: tmp_path / "shelf")
    monkeypatch.chdir(tmp_path)


def test_named_problems_are_found_from_any_folder(shelf):
    assert named_problems.problem_names() == ["contacts/feet", "contacts/hand", "degenerate/one_point"]
    assert load_problem("contacts/feet").name == "contacts/feet"


def test_named_problems_are_listed_with_a_line_each(shelf, capsys):
    assert main(["list", "problems", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["contacts/hand"] == "about contacts/hand"
    assert main(["list"]) == 0
    listing = capsys.readouterr().out
    assert all(
        word in listing for word in ("problems:", "degenerate/one_point", "models:", "support_region", "postures:", "contacts", "robots:")
    )


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("contacts/fet", "did you mean 'contacts/feet'"),
        ("feet", "did you mean 'contacts/feet'"),
        ("contacts", "contacts/feet, contacts/hand"),
    ],
)
def test_a_misspelt_name_is_helped(shelf, name, words):
    with pytest.raises(InputError, match=words):
        load_problem(name)
