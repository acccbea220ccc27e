"""Every named problem, by being listed: it loads, solves, meets its expectations and says where they come from."""

import json
import math

import pytest

from socp_statics.cases.answers import ANSWERS
from socp_statics.cases.named_problems import problem_names
from socp_statics.cases.problem import load_problem
from socp_statics.cases.solve import solve
from socp_statics.cli import main

NAMES = problem_names()
FAMILIES = {name.split("/")[0] for name in NAMES}


def cases(problem):
    """All cases of a small sweep, the first and last of a large one, or the problem itself."""
    if not problem.sweep:
        return [problem]
    chosen = range(problem.case_count) if problem.case_count <= 8 else (0, problem.case_count - 1)
    return [problem.case(i) for i in chosen]


@pytest.mark.parametrize("name", NAMES)
def test_problem_is_solved_as_expected(name):
    problem = load_problem(name)
    assert problem.description and len(problem.description) <= 160
    assert problem.model in ANSWERS.names()
    assert problem.reference or problem.expect
    for case in cases(problem):
        record = solve(case)
        assert record["status"] != "failed"
        assert [entry for entry in record["expect"] if not entry["ok"]] == []
        assert all(entry["source"] for entry in record["expect"])
        assert json.loads(record.to_json()) == json.loads(solve(case).to_json())
        margin = record["margin"]
        assert margin is None or isinstance(margin, str) or math.isfinite(margin)


def test_there_are_enough_and_most_have_expectations():
    assert len(NAMES) >= 20
    assert {"contacts", "degenerate"} <= FAMILIES
    assert sum(bool(load_problem(name).expect) for name in NAMES) > 0.7 * len(NAMES)
    assert {"contacts/hoap2_double_stance", "contacts/flat_double_stance"} <= set(NAMES)


def test_every_model_of_the_command_line_has_a_named_problem(capsys):
    main(["list", "models", "--json"])
    models = set(json.loads(capsys.readouterr().out))
    assert {load_problem(name).model for name in NAMES} == models


@pytest.mark.parametrize("name", NAMES)
def test_the_shown_file_is_the_same_problem(name, capsys, tmp_path):
    assert main(["show", name, "--toml"]) == 0
    path = tmp_path / "shown.toml"
    path.write_text(capsys.readouterr().out)
    problem, again = load_problem(name), load_problem(str(path))
    assert again.stated() == problem.stated()
    assert main(["show", name]) == 0
    shown = capsys.readouterr().out
    assert "subject to" in shown and ("maximise" in shown or "minimise" in shown)
