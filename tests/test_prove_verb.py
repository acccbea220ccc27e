"""The verb prove as a user types it: problems, records, proof files, and what is no record."""

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

from socp_statics.certificates import verify_proof
from socp_statics.cli import main

README = (Path(__file__).parents[1] / "README.md").read_text()
NAME = "contacts/foot_and_wall_hand"


def refused(capsys, arguments, status, *words):
    assert main(arguments) == status
    said = capsys.readouterr()
    *_, last = said.err.splitlines()
    assert all(word in last for word in words), last
    assert not said.out


@pytest.fixture(scope="module")
def record(tmp_path_factory):
    file = tmp_path_factory.mktemp("records") / "record.json"
    assert main(["solve", NAME, "--json", str(file)]) == 0
    return file


def test_what_the_readme_says_is_what_is_said(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    shown = re.search(r"```\n(\$ socp-statics solve .*?)```", README, re.S).group(1)
    commands = [block.partition("\n") for block in re.split(r"^\$ ", shown, flags=re.M) if block]
    assert [command.split()[0] for command, _, _ in commands] == ["socp-statics", "socp-statics", "python", "sed", "socp-statics"]
    for command, _, said in commands:
        words = command.split()
        capsys.readouterr()
        if words[0] == "socp-statics":
            status = main(words[1:])
            out = capsys.readouterr()
            if said:
                assert (out.out + out.err).splitlines() == said.splitlines()
            assert status == (1 if "not proved" in said else 0)
        elif words[0] == "python":
            done = subprocess.run([sys.executable, verify_proof.__file__, *words[2:]], capture_output=True, text=True)
            assert (done.returncode, done.stdout) == (0, said)
        else:
            assert subprocess.run(command, shell=True, check=False).returncode == 0


def test_a_problem_is_solved_and_proved(tmp_path, capsys):
    file = tmp_path / "proof.json"
    assert main(["prove", NAME, "--set", "posture.mass=50", "--json", str(file)]) == 0
    assert "proved stable" in capsys.readouterr().out
    assert verify_proof.main([str(file)]) == 0
    assert "proved stable" in capsys.readouterr().out
    assert json.loads(file.read_text())["statement"]["mass"] == "50"


def test_a_record_is_proved_and_only_the_proof_is_printed(record, capsys):
    assert main(["prove", str(record), "--json", "-"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert verify_proof.verify(document).startswith("proved stable")
    assert document["claim"] == "stable"


def test_undecided_is_an_answer(tmp_path, capsys):
    file = tmp_path / "proof.json"
    assert main(["prove", "degenerate/slope_at_friction_angle", "--json", str(file)]) == 0
    assert "undecided (boundary" in capsys.readouterr().out
    assert verify_proof.main([str(file)]) == 1
    assert "nothing is claimed" in capsys.readouterr().err


def test_a_case_of_a_sweep_is_chosen(capsys):
    assert main(["prove", "contacts/slope_block_sweep", "--case", "0"]) == 0
    assert "proved" in capsys.readouterr().out
    refused(capsys, ["prove", "contacts/slope_block_sweep"], 2, "--case", "6 cases")


def test_an_edited_record_fails(record, tmp_path, capsys):
    edited = json.loads(record.read_text())
    edited["forces"][0]["force"][2] += 1.0
    file, proof = tmp_path / "edited.json", tmp_path / "proof.json"
    file.write_text(json.dumps(edited))
    refused(capsys, ["prove", str(file), "--json", str(proof)], 1, "edited.json", "not proved", "forces", "balance")
    assert not proof.exists()


WRONG = {
    "cut.json": (lambda text: text[:500], ["record (JSON) is expected"]),
    "empty.json": (lambda _: "", ["record (JSON) is expected"]),
    "list.json": (lambda _: "[1, 2]", ["schema 1"]),
    "other_schema.json": (lambda text: text.replace('"schema": 1', '"schema": 99', 1), ["schema 1"]),
    "another.json": (lambda _: '{"schema": 1, "name": "not a record"}', ["a record is expected", "'problem' is missing"]),
    "words.json": (lambda text: text.replace('"force": [', '"force": ["many", ', 1), ["a record is expected"]),
    "verdict.json": (lambda text: text.replace('"verdict": "stable"', '"verdict": "maybe"', 1), ["a record is expected", "verdict"]),
    "case.json": (lambda text: text.replace('"friction": 0.', '"friction": -0.', 1), ["case", "friction"]),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_is_no_record_is_refused(name, record, tmp_path, capsys):
    change, words = WRONG[name]
    file = tmp_path / name
    file.write_text(change(record.read_text()))
    assert file.read_text() != record.read_text()
    refused(capsys, ["prove", str(file)], 2, name, *words)


def test_files_that_are_not_there_and_options_that_make_no_sense(record, tmp_path, capsys):
    (tmp_path / "folder.json").mkdir()
    refused(capsys, ["prove", str(tmp_path / "none.json")], 2, "none.json", "record")
    refused(capsys, ["prove", str(tmp_path / "folder.json")], 2, "folder.json", "record")
    refused(capsys, ["prove", "no/such"], 2, "no/such")
    refused(capsys, ["prove", str(record), "--set", "posture.mass=3"], 2, "--set", "record")
    refused(capsys, ["prove", str(record), "--case", "1"], 2, "--case", "record")
    refused(capsys, ["prove", str(record), "--json", str(record)], 2, "--json", "the record itself")
    refused(capsys, ["prove", str(record), "--json", str(tmp_path / "folder.json")], 2, "--json", "folder")
    refused(capsys, ["prove", NAME, "--json", str(tmp_path / "nowhere" / "p.json")], 2, "--json")
    refused(capsys, ["prove", NAME, "--engine", "kernal"], 2, "--engine", "kernal")
    refused(capsys, ["prove", str(record), "--engine", "kernal"], 2, "kernal")


NO_PROOF = {
    "cut": lambda text: text[:900],
    "empty": lambda _: "",
    "record": lambda _: '{"schema": 1, "verdict": "stable"}',
    "schema": lambda text: text.replace('"schema": 1', '"schema": 99', 1),
    "list": lambda _: "[]",
    "float": lambda text: text.replace('"mass": "', '"mass": "0.', 1),
    "zero": lambda text: re.sub(r'"mass": "\d+', '"mass": "1/0', text, count=1),
    "kind": lambda text: text.replace('"type": "surface"', '"type": "glue"', 1),
    "claim": lambda text: text.replace('"claim": "stable"', '"claim": "surely"', 1),
    "point": lambda text: text.replace('"forces": {', '"forces": {}, "more": {', 1),
}


@pytest.fixture(scope="module")
def proof(record):
    file = record.parent / "proof.json"
    assert main(["prove", str(record), "--json", str(file)]) == 0
    return file


@pytest.mark.parametrize("name", NO_PROOF)
def test_what_is_no_proof_is_unreadable(name, proof, tmp_path, capsys):
    file = tmp_path / "broken.json"
    file.write_text(NO_PROOF[name](proof.read_text()))
    assert file.read_text() != proof.read_text()
    assert verify_proof.main([str(file)]) == 2
    said = capsys.readouterr()
    assert not said.out and said.err.startswith(f"{file}: ") and len(said.err.splitlines()) == 1


def test_a_folder_and_a_missing_file_are_no_proof(tmp_path, capsys):
    for path in (tmp_path, tmp_path / "none.json"):
        assert verify_proof.main([str(path)]) == 2
        assert str(path) in capsys.readouterr().err
    assert verify_proof.main([]) == 2
    assert "usage" in capsys.readouterr().err
