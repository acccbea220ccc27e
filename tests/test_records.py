"""Records: expectations, hashes, exact text and complete files."""

import json
import tomllib

import numpy as np
import pytest

from socp_statics.cases.expect import check_expected_key, evaluate, look_up
from socp_statics.cases.hashing import canonical_json, case_hash
from socp_statics.cases.problem import problem_from_tables
from socp_statics.cases.record import Record, read_record
from socp_statics.cases.solve import solve
from socp_statics.cases.toml_text import problem_toml
from socp_statics.cases.writing import check_writable, finished_or_absent
from socp_statics.cli import main
from socp_statics.exceptions import EngineError, InputError


def foot(**changes):
    """Tables of a problem with one contact, as TOML reads them."""
    contact = {"name": "left", "type": "surface", "position": [0, 0.1, 0], "normal": [0, 0, 1], "friction": 0.6, "size": [0.2, 0.1]}
    posture = {"generator": "contacts", "mass": 60, "com": [0, 0, 0.8], "contacts": [contact]}
    return {"description": "One foot", "model": "equilibrium", "posture": posture, **changes}


def problem(**changes):
    return problem_from_tables(foot(**changes), "foot")


# expectations


RECORD = {"margin": 5.0, "verdict": "stable", "idle": ["a"], "reason": None, "wrenches": [{"contact": "left", "force": [0.0, 0.0, 7.0]}]}


@pytest.mark.parametrize(
    ("key", "value", "tolerance", "ok"),
    [
        ("margin", 5.1, 0.2, True),
        ("margin", 5.1, 0.05, False),
        ("margin", "5.0", 1.0, False),
        ("margin", True, 9.0, False),
        ("verdict", "stable", 0.0, True),
        ("verdict", "unstable", 0.0, False),
        ("idle", ["a"], 0.0, True),
        ("idle", [], 0.0, False),
        ("reason", "rank", 0.0, False),
        ("reason", 0.0, 1.0, False),
        ("wrenches.left.force[2]", 7, 0.0, True),
        ("wrenches[0].force", [0, 0, 7.05], 0.1, True),
        ("wrenches.right.force[2]", 7, 0.0, False),
        ("wrenches[3].force[2]", 7, 0.0, False),
    ],
)
def test_expectations_are_compared(key, value, tolerance, ok):
    entries = evaluate({key: {"value": value, "tolerance": tolerance, "source": "here"}}, RECORD)
    assert entries == [{"key": key, "value": look_up(RECORD, key), "expected": value, "tolerance": tolerance, "source": "here", "ok": ok}]


def test_infinite_margins_can_be_expected():
    for stated in ("inf", float("inf")):
        assert evaluate({"margin": {"value": stated, "tolerance": 0.0, "source": ""}}, {"margin": "inf"})[0]["ok"]


def test_keys_of_a_record_are_known_before_it_exists():
    keys = {"margin": None, "wrenches": [{"force": [None]}], "idle": [None], "certificate": {"contacts": {"*": None}}}
    for key in ("margin", "wrenches.left.force[2]", "wrenches[0].force", "wrenches.0", "idle[0]", "certificate.contacts.left"):
        check_expected_key(key, keys, "m", ("left",))
    for key in ("margins", "margin.x", "wrenches.right", "wrenches.left.forces", "idle.left", "certificate.contacts.right"):
        with pytest.raises(InputError):
            check_expected_key(key, keys, "m", ("left",))


def test_expected_keys_may_be_written_without_quotes():
    tables = foot() | tomllib.loads('[expect]\nresiduals.balance = { value = 0, tolerance = 1e-6 }\nverdict = { value = "stable" }')
    assert list(problem_from_tables(tables, "foot").expect) == ["residuals.balance", "verdict"]


def test_a_region_cannot_be_expected_of_an_equilibrium():
    with pytest.raises(InputError, match="region.inner_area.*equilibrium"):
        problem(expect={"region.inner_area": {"value": 1}})


# hashes


def digest(loaded):
    return case_hash(loaded.stated(), "clarabel")


def test_words_about_a_problem_do_not_change_its_hash():
    changed = problem(description="other", reference="a paper", expect={"verdict": {"value": "stable"}})
    assert digest(changed) == digest(problem())


def test_the_order_of_keys_and_defaults_do_not_change_the_hash():
    def backwards(value):
        if isinstance(value, dict):
            return {key: backwards(value[key]) for key in reversed(value)}
        return [backwards(entry) for entry in value] if isinstance(value, list) else value

    stated = problem(parameters={"cone": "exact", "form": "socp"}).with_values({"posture.gravity": [0, 0, -9.81], "posture.mass": 60.0})
    assert digest(problem_from_tables(backwards(foot()), "other name")) == digest(problem()) == digest(stated)


@pytest.mark.parametrize(
    "change", [{"posture.mass": 61}, {"model": "support_region"}, {"parameters.cone": "inscribed"}, {"posture.contacts[0].name": "x"}]
)
def test_every_number_and_word_of_the_question_changes_the_hash(change):
    assert digest(problem().with_values(change)) != digest(problem())


def test_the_engine_changes_the_hash():
    assert case_hash(problem().stated(), "cvxpy") != digest(problem())


def test_canonical_json_has_one_text_for_equal_values():
    assert canonical_json({"b": np.float64(0.5), "a": np.array([1, -0.0])}) == canonical_json({"a": [1.0, 0], "b": 0.5}).replace(
        "[1.0,0]", "[1.0,0.0]"
    )
    assert canonical_json([float("inf"), -float("inf"), float("nan"), True, None]) == '["inf","-inf",null,true,null]'


# records


def test_a_record_is_a_mapping_of_plain_values():
    record = Record({"schema": 1, "margin": float("inf"), "idle_margin": float("nan"), "com": np.array([0.1, 2.0]), "count": np.int64(3)})
    assert dict(record) == {"schema": 1, "margin": "inf", "idle_margin": None, "com": [0.1, 2.0], "count": 3}
    assert "Record(" in repr(record)


def test_the_text_of_a_record_is_exact_and_always_the_same():
    values = [0.1, 1 / 3, 1e-300, 5e-324, 1.7976931348623157e308, -0.0, 123456789.123456789]
    record = Record({"schema": 1, "values": values, "nested": [{"force": [1.0, 2.0]}, {}], "empty": []})
    text = record.to_json()
    assert text == Record(json.loads(text)).to_json()
    assert json.loads(text)["values"] == values
    assert "NaN" not in text
    assert text.count("\n") < 15


def test_a_record_survives_its_file(tmp_path):
    record = Record({"schema": 1, "margin": float("-inf"), "words": ["\u00e4"]})
    record.write(tmp_path / "a.json")
    assert dict(read_record(tmp_path / "a.json")) == dict(record)
    assert [path.name for path in tmp_path.iterdir()] == ["a.json"]


@pytest.mark.parametrize("content", ["", "[1]", "{}", '{"schema": 99}', "{", "\udcff"])
def test_what_is_no_record_is_refused(content, tmp_path):
    (tmp_path / "a.json").write_bytes(content.encode("utf-8", "surrogateescape"))
    with pytest.raises(InputError, match="a.json: a record"):
        read_record(tmp_path / "a.json")


def test_a_file_is_complete_or_absent(tmp_path):
    path = tmp_path / "a.json"

    def interrupted():
        with finished_or_absent(path) as draft:
            draft.write_text("half")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert list(tmp_path.iterdir()) == []


def test_writing_follows_links_and_leaves_devices_alone(tmp_path):
    (tmp_path / "real.json").write_text("old")
    (tmp_path / "link.json").symlink_to("real.json")
    Record({"schema": 1}).write(tmp_path / "link.json")
    assert (tmp_path / "link.json").is_symlink()
    assert read_record(tmp_path / "real.json")["schema"] == 1
    (tmp_path / "null").symlink_to("/dev/null")
    check_writable(tmp_path / "null", "--json")
    Record({"schema": 1}).write(tmp_path / "null")
    assert (tmp_path / "null").is_char_device()


# answers


def write_foot(folder, **changes):
    (folder / "foot.toml").write_text(problem_toml(problem(**changes)))


def test_dash_prints_only_the_record_and_always_the_same(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    write_foot(tmp_path, expect={"verdict": {"value": "unstable"}})
    assert main(["solve", "foot.toml", "--json", "-"]) == 0
    printed = capsys.readouterr().out
    assert main(["solve", "foot.toml", "--json", "out.json"]) == 0
    assert (tmp_path / "out.json").read_text() == printed
    record = read_record("out.json")
    assert (record["schema"], record["problem"], record["status"]) == (1, "foot", "solved")
    assert record["hash"] == digest(problem())
    assert record["expect"][0]["ok"]


def test_the_answer_for_a_person_is_short(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    write_foot(tmp_path)
    assert main(["solve", "foot.toml", "--set", "posture.com=[0, 0.1, 0.8]"]) == 0
    said = capsys.readouterr().out
    assert all(word in said for word in ("stable", "% of the weight", "clarabel", "left: force [0, 0, 588.6] N"))
    assert len(said.splitlines()) < 12


def test_restating_what_was_generated_gives_the_same_margin(tmp_path):
    first = solve(problem().with_values({"posture.com": [0.02, 0.11, 0.8]}))
    first.write(tmp_path / "out.json")
    case = read_record(tmp_path / "out.json")["case"]
    posture = {"generator": "contacts", **{key: case["generated"][key] for key in ("contacts", "com", "mass")}}
    again = solve(problem_from_tables({"model": case["model"], "posture": posture}, "again"))
    assert again["verdict"] == "stable"
    assert again["margin"] == pytest.approx(first["margin"], rel=1e-9)


def test_a_failed_computation_has_a_record_and_status_one(tmp_path, monkeypatch, capsys):
    def breaks_down(*_, **__):
        raise EngineError("no engine settled the program")

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("socp_statics.stability.check_equilibrium", breaks_down)
    write_foot(tmp_path)
    assert main(["solve", "foot.toml", "--json", "out.json"]) == 1
    assert capsys.readouterr().err == "foot.toml: no engine settled the program\n"
    record = read_record(tmp_path / "out.json")
    assert (record["status"], record["verdict"], record["margin"], record["forces"]) == ("failed", "undecided", None, [])


def test_wrong_input_found_while_solving_names_the_file_and_the_key():
    sideways = problem(model="support_region").with_values({"posture.gravity": [9.81, 0, 0]})
    with pytest.raises(InputError, match="foot with --set posture.gravity: posture.gravity"):
        solve(sideways)
