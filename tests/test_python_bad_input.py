"""Wrong arguments of the Python entry points that take problems, selectors and folders: one sentence, an InputError."""

from pathlib import Path

import pytest

import socp_statics as ss

PROBLEM = ss.load_problem("contacts/ladder")
CALLS = {
    "solve a name": (lambda: ss.solve("contacts/chimney"), ["problem: a Problem is expected, load_problem('contacts/chimney') makes one"]),
    "solve a path": (lambda: ss.solve(Path("a/b.toml")), ["problem: a Problem is expected, load_problem('a/b.toml') makes one"]),
    "solve nothing": (lambda: ss.solve(None), ["problem: a Problem is expected, load_problem makes one, got NoneType"]),
    "solve tables": (lambda: ss.solve({"model": "equilibrium"}), ["problem: a Problem is expected, load_problem makes one, got dict"]),
    "compare a name": (lambda: ss.compare("contacts/chimney"), ["problem: a Problem is expected, load_problem('contacts/chimney') makes"]),
    "compare nothing": (lambda: ss.compare(None), ["problem: a Problem is expected", "got NoneType"]),
    "load nothing": (lambda: ss.load_problem(None), ["name_or_path: the name of a problem or a path that ends in .toml", "None"]),
    "load a number": (lambda: ss.load_problem(3), ["name_or_path: the name of a problem or a path that ends in .toml", "got 3"]),
    "results of nothing": (lambda: ss.load_results(None), ["folder: the path of a folder that socp-statics run has written", "got None"]),
    "results of a number": (lambda: ss.load_results(3), ["folder: the path of a folder that socp-statics run has written", "got 3"]),
    "run nothing": (lambda: ss.run(None), ["selectors: a name, glob, family, folder or path", "got None"]),
    "run a number": (lambda: ss.run(["contacts/ladder", 3]), ["selectors: a name, glob, family, folder or path", "got 3"]),
    "run a mistyped name": (lambda: ss.run("contacts/chimny"), ["'contacts/chimny' is no named problem", "'contacts/chimney'"]),
    "run into a number": (lambda: ss.run("contacts/ladder", 3), ["out: the path of a folder is expected, got 3"]),
}


@pytest.mark.parametrize(("call", "words"), CALLS.values(), ids=CALLS)
def test_a_wrong_argument_is_an_input_error(call, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ss.InputError) as caught:
        call()
    for word in words:
        assert word in str(caught.value)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("kind", [str, Path])
def test_one_selector_needs_no_list(kind, tmp_path):
    path = tmp_path / "sway.toml"
    path.write_text(Path(str(PROBLEM.path)).read_text())
    assert ss.run(kind(path), tmp_path / "out", workers=1).cases == 1
    assert [record["problem"] for record in ss.load_results(tmp_path / "out")] == ["sway"]


def test_a_sweep_says_how_a_case_is_chosen_from_either_side():
    problem = ss.load_problem("contacts/slope_block_sweep")
    with pytest.raises(ss.InputError) as caught:
        ss.solve(problem)
    said = str(caught.value)
    assert said.count("contacts/slope_block_sweep") == 1
    for word in ("makes 6 cases", "--case 0 to 5", "problem.case(0) to problem.case(5)", "socp-statics run", "socp_statics.run"):
        assert word in said
    assert ss.solve(problem.case(5))["sweep"]["case"] == 5
