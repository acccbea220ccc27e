"""Runs: what is computed, kept, computed again; the folder they leave; what they refuse."""

import errno
import json
import os
import tracemalloc
from collections import Counter
from concurrent.futures import Future
from importlib import metadata
from pathlib import Path

import pytest
from slope_problem import write

import socp_statics as ss
from socp_statics.cli import main
from socp_statics.runner import dispatch, run, running, shards, stale_problems
from socp_statics.runner.folder import opened
from socp_statics.runner.manifest import HEADER
from socp_statics.runner.plan import case_order
from socp_statics.runner.progress import Progress
from socp_statics.runner.work import Done, Line, Part


def on_disk(folder):
    return {(r["problem"], r.get("sweep", {}).get("case", 0)): r for r in ss.load_results(folder)}


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    """A finished run of two problems, for tests that only look at it."""
    place = tmp_path_factory.mktemp("done")
    write(place / "slopes.toml")
    summary = run([str(place / "slopes.toml"), "contacts/flat_double_stance"], place / "out", workers=2)
    return place, summary


def test_a_run_leaves_the_records_that_solve_gives(done):
    place, summary = done
    assert (summary.cases, summary.computed, summary.kept, summary.failed, summary.unmet) == (9, 9, 0, 0, 0)
    problem = ss.load_problem(place / "slopes.toml")
    records = on_disk(place / "out")
    assert set(records) == {("slopes", k) for k in range(8)} | {("contacts/flat_double_stance", 0)}
    for number in range(8):
        expected = ss.solve(problem.case(number))
        assert records["slopes", number].line() == expected.line()
        assert expected["sweep"] == {"case": number, "values": dict(zip(problem.sweep, expected["sweep"]["values"].values(), strict=True))}
    assert records["contacts/flat_double_stance", 0].line() == ss.solve(ss.load_problem("contacts/flat_double_stance")).line()
    # times are beside the records, in no record
    lines = [line for file in (place / "out/shards").glob("slopes.*.times.jsonl") for line in file.read_text().splitlines()]
    assert sorted(json.loads(line)["case"] for line in lines) == list(range(8))
    assert b"seconds" not in records["slopes", 0].line()


def test_the_manifest_says_what_is_there(done):
    place, _ = done
    lines = [json.loads(line) for line in (place / "out/manifest.jsonl").read_text().splitlines()]
    assert lines[0] == HEADER
    (plan,) = [line for line in lines if "plan" in line]
    assert plan["plan"]["slopes"]["cases"] == 8 and plan["engine"] == "auto" and plan["versions"]["socp_statics"] == ss.__version__
    hashes = {(line["problem"], number): hash_ for line in lines if "shard" in line for number, hash_, *_ in line["cases"]}
    assert hashes == {key: record["hash"] for key, record in on_disk(place / "out").items()}


def test_results_are_a_sequence_and_a_table(done, tmp_path):
    from pyarrow import parquet

    place, _ = done
    results = ss.load_results(place / "out")
    assert len(results) == 9 and results[-1]["problem"] == "slopes" and results[:1][0]["problem"] == "contacts/flat_double_stance"
    assert [record.line() for record in results] == [results[k].line() for k in range(9)]
    assert [record.line() for record in results.of("slopes")] == [record.line() for record in results if record["problem"] == "slopes"]
    table = results.table()
    assert set(table) >= {"verdict", "margin", "seconds", "posture.contacts.sole.friction"}
    assert {len(column) for column in table.values()} == {9}
    mine = [k for k, name in enumerate(table["problem"]) if name == "slopes"]
    assert [table["case"][k] for k in mine] == list(range(8))
    assert all((table["verdict"][k] == "stable") == (table["margin"][k] > 0) and table["seconds"][k] > 0 for k in mine)
    results.write_parquet(tmp_path / "table.parquet")
    read = parquet.read_table(tmp_path / "table.parquet").to_pydict()
    assert read["verdict"] == list(table["verdict"]) and read["mass"] == list(table["mass"])
    with pytest.raises(ss.InputError, match="a file that can be written is expected"):
        results.write_parquet(tmp_path / "nowhere" / "table.parquet")


def test_the_report_has_counts_pictures_and_versions(done, capsys):
    place, _ = done
    assert main(["report", str(place / "out")]) == 0
    assert "9 records of 2 problems" in capsys.readouterr().out
    page, summary = (place / "out/report.html").read_text(), (place / "out/summary.md").read_text()
    assert "http" not in page.replace("http://www.w3.org", "") and page.count("<svg") >= 2
    counts = Counter(record["verdict"] for record in ss.load_results(place / "out"))
    for verdict, count in counts.items():
        assert f"| {verdict} | {count} |" in summary and f"<td>{verdict}</td><td>{count}</td>" in page
    assert "| contacts/flat_double_stance | 1 |" in summary and "## Slowest" in summary
    assert f"| numba | {metadata.version('numba')} |" in summary
    before = page, summary
    assert main(["report", str(place / "out")]) == 0
    assert before == ((place / "out/report.html").read_text(), (place / "out/summary.md").read_text())


def test_infinite_margins_are_counted_by_their_sign(tmp_path, capsys):
    """A grip on both sides braces itself at will; without friction no force holds the weight."""
    contact = '[[posture.contacts]]\nname = "{}"\ntype = "point"\nposition = [{}, 0, 0]\nnormal = [{}, 0, 0]\nfriction = {}\n'
    head = 'model = "equilibrium"\n[posture]\ngenerator = "contacts"\nmass = 1.0\ncom = [0, 0, 0]\n'
    for name, friction in (("grip", 0.5), ("slippery", 0.0)):
        contacts = [contact.format(side, x, -x, friction) for side, x in (("left", 1), ("right", -1))]
        (tmp_path / f"{name}.toml").write_text("".join([head, *contacts]))
    (tmp_path / "block.toml").write_text((head + contact.format("foot", 0, 0, 0.5)).replace("normal = [0, 0, 0]", "normal = [0, 0, 1]"))
    out = tmp_path / "out"
    run([tmp_path / f"{name}.toml" for name in ("grip", "slippery", "block")], out, workers=1)
    assert {r["problem"]: r["margin"] for r in ss.load_results(out) if r["problem"] != "block"} == {"grip": "inf", "slippery": "-inf"}
    assert main(["report", str(out)]) == 0
    said = capsys.readouterr().out
    assert "1 margin of inf (braced at will) and 1 margin of -inf (no balance) left out of medians and percentiles" in said
    assert "| margin over the weight | 1 |" in (out / "summary.md").read_text()


def test_a_damaged_folder_is_put_right(tmp_path):
    path, out = write(tmp_path / "slopes.toml"), tmp_path / "out"
    run([str(path)], out, workers=1)
    before = [record.line() for record in ss.load_results(out)]
    files = sorted(p for p in (out / "shards").iterdir() if not p.name.endswith(".times.jsonl"))
    content = files[0].read_bytes()
    files[0].write_bytes(content[: len(content) // 2])
    lost = len(content.splitlines())
    with pytest.raises(ss.InputError, match="a shard of records is expected"):
        list(ss.load_results(out))
    summary = run([str(path)], out, workers=1)
    assert summary.computed == lost and len(summary.notes) == 1
    assert f"{files[0]} is not what was written: set aside as {files[0].name}.corrupt" in summary.notes[0]
    assert files[0].with_name(files[0].name + ".corrupt").exists()
    assert [record.line() for record in ss.load_results(out)] == before
    # the process died before it could note its last shard, in the middle of a line, and with a file half written
    draft = files[0].with_name(".123.slopes.9999.times.jsonl")
    draft.write_text("{")
    manifest = out / "manifest.jsonl"
    whole = manifest.read_bytes().splitlines(keepends=True)
    manifest.write_bytes(b"".join(whole[:-1]) + whole[-1][:20])
    assert run([str(path)], out, workers=1).computed == 0
    assert [record.line() for record in ss.load_results(out)] == before and not draft.exists()
    # the manifest itself is damaged: the records are read from the shards; no digest is left, so they are compared one by one
    manifest.write_bytes(b"{nonsense\n")
    with pytest.raises(ss.InputError, match="this manifest is damaged"):
        ss.load_results(out)
    summary = run([str(path)], out, workers=1)
    assert summary.computed == 0 and "is damaged" in summary.notes[0]
    assert [record.line() for record in ss.load_results(out)] == before


def test_a_full_disk_loses_nothing_that_is_finished(tmp_path, monkeypatch, capsys):
    path, out = write(tmp_path / "slopes.toml"), tmp_path / "out"
    real, calls = os.fsync, []

    def full(handle):
        calls.append(handle)
        if len(calls) > 4:
            raise OSError(errno.ENOSPC, "No space left on device")
        real(handle)

    with monkeypatch.context() as patch:
        patch.setattr(shards.os, "fsync", full)
        assert main(["run", str(path), "--out", str(out), "--workers", "1", "--quiet"]) == 1
    said = capsys.readouterr().err.strip().splitlines()[-1]
    assert "could not be written (No space left on device); finished shards are kept, the same command goes on" in said
    assert not [p for p in out.rglob(".*") if p.name != ".lock"]
    kept = len(ss.load_results(out))
    assert 0 < kept < 8
    summary = run([str(path)], out, workers=1)
    assert (summary.kept, summary.computed) == (kept, 8 - kept) and len(ss.load_results(out)) == 8


def test_a_case_whose_input_is_wrong_fails_alone_and_is_tried_again(tmp_path, capsys):
    path, out = write(tmp_path / "slopes.toml", [0.3, -1.0]), tmp_path / "out"
    assert main(["run", str(path), "--out", str(out), "--workers", "1"]) == 1
    told = capsys.readouterr()
    assert told.err.strip().splitlines()[-1] == f"{path} case 2: failed, and 1 more; socp-statics report {out} says why"
    assert "4 cases: 4 computed" in told.out and "2 failed" in told.out
    failed = [record for record in ss.load_results(out) if record["status"] == "failed"]
    assert len(failed) == 2 and all("friction" in r["failure"] and r["verdict"] == "undecided" for r in failed)
    assert run([str(path)], out, workers=1).computed == 0
    assert main(["report", str(out)]) == 0 and "## Failed (2)" in (out / "summary.md").read_text()


BAD = {
    "a pattern that matches nothing": (["hoap2/x*"], ["'hoap2/x*' matches no named problem", "hoap2"]),
    "a name that is mistyped": (["contacts/flat_doubel_stance"], ["is no named problem", "did you mean 'contacts/flat_double_stance' or"]),
    "a name without its family": (["flat_double_stance"], ["did you mean 'contacts/flat_double_stance'?"]),
    "a file that is not there": (["{tmp}/none.toml"], ["there is no such file"]),
    "a pattern of files": (["{tmp}/none*.toml"], ["no file matches"]),
    "an empty folder": (["{tmp}/empty"], ["holds no problem file"]),
    "two files of one name": (["{tmp}/a/same.toml", "{tmp}/b/same.toml"], ["same name"]),
    "a million cases": (["{tmp}/million.toml"], ["its sweep alone makes 1000000 cases, more than 100000", "--yes"]),
    "a million cases and one": (["{tmp}/million.toml", "contacts/ladder"], ["makes 1000000 of 1000001 cases, more than 100000"]),
    "no workers": (["contacts/ladder", "--workers", "0"], ["--workers must be a whole number", "'0'"]),
    "many workers": (["contacts/ladder", "--workers", "many"], ["--workers must be a whole number", "'many'"]),
    "workers of a cluster": (["contacts/ladder", "--workers", "2", "--scheduler", "tcp://127.0.0.1:1"], ["--workers cannot be chosen"]),
    "an address that is none": (["contacts/ladder", "--scheduler", "nonsense:x"], ["--scheduler nonsense:x", "Dask scheduler is expected"]),
    "an address without a port": (["contacts/ladder", "--scheduler", "blah"], ["--scheduler blah", "of the form tcp://host:port"]),
    "an address with no such port": (["contacts/ladder", "--scheduler", "tcp://a:99999"], ["tcp://a:99999", "of the form tcp://host:port"]),
    "the start of names": (["contacts/flat"], ["did you mean 'contacts/flat_double_stance'"]),
    "a file without its ending": (["million"], ["did you mean 'million.toml'?"]),
    "an unknown engine": (["contacts/ladder", "--engine", "kernle"], ["--engine", "did you mean 'kernel'?"]),
    "a key that is not known": (["contacts/ladder", "--set", "posture.mas=3"], ["contacts/ladder", "posture.mas", "did you mean 'mass'?"]),
    "a folder of other things": (["contacts/ladder", "--out", "{tmp}/a"], ["holds other things (same.toml)"]),
    "a file as folder": (["contacts/ladder", "--out", "{tmp}/a/same.toml"], ["this is a file, a folder is expected"]),
    "a wrong sweep": (["{tmp}/sweep.toml"], ["sweep", "list of values"]),
}


@pytest.mark.parametrize("arguments, words", BAD.values(), ids=BAD)
def test_wrong_input_is_refused_before_anything_is_computed(arguments, words, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for folder in ("empty", "a", "b"):
        (tmp_path / folder).mkdir()
    for folder in ("a", "b"):
        write(tmp_path / folder / "same.toml")
    write(tmp_path / "million.toml", rest='"posture.mass" = { from = 1, to = 125000 }')
    (tmp_path / "sweep.toml").write_text((tmp_path / "million.toml").read_text().replace("from = 1", "from = 9999999"))
    assert main(["run", *(a.replace("{tmp}", str(tmp_path)) for a in arguments)]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    for word in words:
        assert word in said.err.strip().splitlines()[-1]
    assert not (tmp_path / "runs").exists()


@pytest.mark.parametrize("what, words", [("none", "there is no such folder"), ("empty", "has no manifest.jsonl")])
def test_reports_and_results_refuse_other_folders(what, words, tmp_path, capsys):
    (tmp_path / "empty").mkdir()
    assert main(["report", str(tmp_path / what)]) == 2
    assert words in capsys.readouterr().err
    with pytest.raises(ss.InputError, match=words):
        ss.load_results(tmp_path / what)


def test_a_second_run_in_the_same_folder_refuses(tmp_path, capsys):
    out = tmp_path / "out"
    with opened(out):
        assert main(["run", "contacts/ladder", "--out", str(out)]) == 2
    assert f"--out {out}: another run is at work in this folder; wait for it" in capsys.readouterr().err
    with opened(out):
        pass  # the first has let go of it


def test_solve_names_run_for_a_sweep(capsys):
    assert main(["solve", "contacts/slope_block_sweep"]) == 2
    said = capsys.readouterr().err
    assert "--case 0 to 5" in said and "6 cases" in said and "socp-statics run" in said


def test_what_changes_the_program_changes_slowest():
    sweep = {"posture.mass": [1, 2, 3], "parameters.cone": ["exact", "inscribed"], "posture.com": [1, 2]}
    order = list(case_order(sweep))
    assert sorted(order) == list(range(12))
    cones = [number // 2 % 2 for number in order]
    assert cones == sorted(cones)


def test_progress_is_plain_lines_away_from_a_terminal(capsys, monkeypatch):
    monkeypatch.setattr("socp_statics.runner.progress.EVERY", 0.0)
    for quiet in (False, True):
        with Progress(10, quiet) as progress:
            progress.advance(4, 1)
        said = capsys.readouterr().err
        assert said == "" if quiet else said.startswith("4 of 10 cases, ") and "1 failed" in said and said.endswith(" left\n")


def test_progress_is_a_bar_on_a_terminal(monkeypatch):
    import io

    class Terminal(io.StringIO):
        def isatty(self):
            return True

    terminal = Terminal()
    monkeypatch.setattr("sys.stderr", terminal)
    monkeypatch.setenv("TERM", "xterm")
    with Progress(10, False) as progress:
        progress.advance(4, 1)
        progress._bar.refresh()
    for word in ("4/10", "a second", "1 failed", "-:--:--"):
        assert word in terminal.getvalue(), word


class Immediate:
    """A pool whose chunks are done at once, and whose cases take as long as it is told."""

    workers, shared = 2, False

    def __init__(self, pace):
        self.pace, self.sizes = pace, []

    def submit(self, parts, engine):
        (part,) = parts
        self.sizes.append(len(part.numbers))
        lines = [Line(number, f"{number:064d}", f"{number:016d}", "solved", "", self.pace, b'{"none":0}') for number in part.numbers]
        future: Future = Future()
        future.set_result(Done([lines], self.pace * len(lines), 0.0))
        return future

    def died(self, error):
        return False

    def restart(self):
        pass


def test_chunks_grow_to_what_measured_times_say_and_memory_does_not(tmp_path):
    path = tmp_path / "large.toml"
    write(path, rest='"posture.mass" = { from = 1, to = 3750 }')
    (question,) = running.questions(running.select([str(path)]), {}, "kernel")
    total = question.cases
    assert total == 30_000
    pool = Immediate(0.004)
    with opened(tmp_path / "out") as folder:
        state = running._State(folder, {}, {}, total, True)
        tracemalloc.start()
        chunks = dispatch.Chunks([(question, case_order(question.sweep), {})], total, pool.workers)
        dispatch.dispatch(chunks, pool, "auto", state.finished, lambda: None)
        _, peak = tracemalloc.get_traced_memory()
        tracemalloc.stop()
    assert state.computed == total == sum(pool.sizes)
    assert pool.sizes[0] == dispatch.FIRST_CASES and max(pool.sizes) == int(dispatch.LEAST / 0.004) and pool.sizes[-1] < 10
    assert peak / total < 2_000  # bytes a case: 100000 cases stay below 200 MB beside the 300 MB of the libraries


def test_named_records_are_stale_when_their_problem_changes(tmp_path):
    path, out = write(tmp_path / "slopes.toml", [0.5]), tmp_path / "out"
    run([str(path)], out, workers=1)
    assert stale_problems(out, [str(path)]) == {}
    write(path, [0.6])
    assert stale_problems(out, [str(path)]) == {"slopes": "the problem has changed since"}
    write(path, [0.5, 0.6])
    assert stale_problems(out, [str(path)]) == {"slopes": "2 of 4 records are missing"}
    assert set(stale_problems(out, ["contacts/ladder"])) == {"contacts/ladder"}


def test_parts_of_a_chunk_are_small_to_send(tmp_path):
    import pickle

    path = write(tmp_path / "slopes.toml")
    (question,) = running.questions(running.select([str(path)]), {}, "kernel")
    part = Part(question.name, question.label, question.path, question.tables, question.sweep, range(1000), {})
    assert len(pickle.dumps(part)) < 4_000 and isinstance(part.path, Path)
