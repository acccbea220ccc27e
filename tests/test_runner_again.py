"""A run in a folder that has records already: what is kept, what becomes stale, what holds again, whatever interrupts it."""

import pytest
from slope_problem import write

import socp_statics as ss
from socp_statics.cli import main
from socp_statics.runner import run, running
from socp_statics.runner.manifest import Manifest


def test_only_what_is_missing_or_changed_is_computed(tmp_path):
    path, out = write(tmp_path / "slopes.toml", [0.3, 0.5]), tmp_path / "out"
    assert run([str(path)], out, workers=1).computed == 4
    assert run([str(path)], out, workers=1).computed == 0
    # a longer sweep: cases keep their numbers, but the first key changes slowest, so the old ones are the same questions
    write(path, [0.3, 0.5, 0.7])
    assert run([str(path)], out, workers=1).computed == 2
    # a changed value: its cases are computed, the old records marked
    write(path, [0.3, 0.6, 0.7])
    summary = run([str(path)], out, workers=1)
    assert (summary.computed, summary.kept) == (2, 4)
    results = ss.load_results(out)
    assert len(results) == 6 and results.stale_count == 2 and len(ss.load_results(out, stale=True)) == 8
    assert [r["case"]["posture"]["contacts"][0]["friction"] for r in results] == [0.3, 0.3, 0.6, 0.6, 0.7, 0.7]
    # only what is expected has changed, which records repeat
    write(path, [0.3, 0.6, 0.7], rest='[expect]\n"case.generated.mass" = { value = 11.0 }')
    summary = run([str(path)], out, workers=1)
    assert (summary.computed, summary.unmet) == (6, 6)
    # fewer, as they were at first: the records are still there
    write(path, [0.3])
    assert run([str(path)], out, workers=1).computed == 0 and len(ss.load_results(out)) == 2
    before = [record.line() for record in ss.load_results(out)]
    assert run([str(path)], out, workers=1, rerun=True).computed == 2
    assert [record.line() for record in ss.load_results(out)] == before
    # another engine is another question
    assert run([str(path)], out, workers=1, engine="clarabel").computed == 2
    assert {record["engine"] for record in ss.load_results(out)} == {"clarabel"}


def test_another_question_in_the_same_folder_throws_nothing_away(tmp_path, capsys):
    path, out = write(tmp_path / "slopes.toml"), tmp_path / "out"
    arguments = ["run", str(path), "--out", str(out), "--workers", "1"]
    key = "posture.contacts.sole.friction"
    assert main(arguments) == 0
    said = capsys.readouterr().out
    assert said.startswith("8 cases: 8 computed") and "stale" not in said
    before = [record.line() for record in ss.load_results(out)]
    # one question in place of eight, and it is said what became of the eight
    assert main([*arguments, "--rerun", "--set", f"{key}=0.4", "--set", "parameters.cone=exact"]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[0].startswith("1 case: 1 computed") and said[1].startswith("8 earlier records became stale;")
    assert len(ss.load_results(out)) == 1 and ss.load_results(out).stale_count == 8
    # the eight again: none is computed, none is there twice, and the one is stale in its turn
    assert main(arguments) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[0].startswith("8 cases: 0 computed, 8 were there") and said[1].startswith("1 earlier record became stale; it holds")
    assert [record.line() for record in ss.load_results(out)] == before and len(ss.load_results(out, stale=True)) == 9
    assert main(arguments) == 0
    assert capsys.readouterr().out == f"8 cases: 0 computed, 8 were there; records in {out}\n"
    # --rerun computes what is there
    assert run([str(path)], out, workers=1, rerun=True).stale == 8
    assert [record.line() for record in ss.load_results(out)] == before


def test_records_that_hold_again_survive_a_crash_at_any_line(tmp_path, monkeypatch):
    path, out = write(tmp_path / "slopes.toml"), tmp_path / "out"
    other = {"posture.contacts.sole.friction": 0.4, "parameters.cone": "exact"}
    run([str(path)], out, workers=1)
    before = [record.line() for record in ss.load_results(out)]
    run([str(path)], out, values=other, workers=1)
    written: list[bytes] = []

    def kept(self, entry):
        real(self, entry)
        written.append(self.path.read_bytes())

    real = Manifest._append
    with monkeypatch.context() as patch:
        patch.setattr(Manifest, "_append", kept)
        assert run([str(path)], out, workers=1).computed == 0
    assert written and b'"holds"' in written[-1]
    for manifest in written:
        (out / "manifest.jsonl").write_bytes(manifest)
        numbers = [record["sweep"]["case"] for record in ss.load_results(out) if "sweep" in record]
        assert len(numbers) == len(set(numbers))
        assert run([str(path)], out, workers=1).computed == 0
        assert [record.line() for record in ss.load_results(out)] == before
    # without its manifest the folder forgets which of them held, and finds out
    (out / "manifest.jsonl").write_bytes(b"{nonsense\n")
    assert run([str(path)], out, workers=1).computed == 0
    assert [record.line() for record in ss.load_results(out)] == before


def test_a_crash_between_a_shard_and_what_it_replaces_leaves_nothing_twice(tmp_path, monkeypatch):
    path, out = write(tmp_path / "slopes.toml"), tmp_path / "out"
    run([str(path)], out, workers=1)
    before = [record.line() for record in ss.load_results(out)]

    def die(self, file, numbers):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch, pytest.raises(KeyboardInterrupt):
        patch.setattr(Manifest, "mark_stale", die)
        run([str(path)], out, workers=1, rerun=True)
    assert len(ss.load_results(out)) > 8
    run([str(path)], out, workers=1)
    assert [record.line() for record in ss.load_results(out)] == before


@pytest.mark.parametrize("rerun", [False, True])
def test_an_interrupted_change_is_not_taken_for_done(tmp_path, monkeypatch, rerun):
    path, out = write(tmp_path / "slopes.toml", [0.3, 0.5]), tmp_path / "out"
    run([str(path)], out, workers=1)
    write(path, [0.4, 0.6])

    def stop(*arguments):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch, pytest.raises(KeyboardInterrupt):
        patch.setattr(running, "dispatch", stop)
        run([str(path)], out, workers=1, rerun=rerun)
    assert run([str(path)], out, workers=1).computed == 4
    assert [r["case"]["posture"]["contacts"][0]["friction"] for r in ss.load_results(out)] == [0.4, 0.4, 0.6, 0.6]
