"""Processes that are killed: nothing that was finished is lost, nothing is there twice, and only who kills is blamed."""

import os
import signal
import time
from collections import Counter

import pytest
from deadly_package import finish, install, start, told, write_problem

from socp_statics import load_results


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    place = tmp_path_factory.mktemp("deadly")
    install(place)
    return place


def numbers(folder):
    """The case of every record on disk, stale or not."""
    return sorted(record["sweep"]["case"] for record in load_results(folder, stale=True))


def wait_for(condition, seconds=60.0):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.02)


def alive(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    with open(f"/proc/{pid}/stat") as state:
        return state.read().rpartition(")")[2].split()[0] != "Z"


def test_a_case_that_kills_its_process_is_alone_in_failing(place):
    problem, out = write_problem(place / "killer.toml", last=40, kills=[17], breaks=[23]), place / "killer_runs"
    status, said, complaints = finish(start(place, problem, "--out", out, "--workers", "2"))
    assert status == 1 and complaints[-1].startswith(f"{problem} case 17: failed, and 1 more; socp-statics report")
    assert "41 computed" in said and numbers(out) == list(range(41))
    failed = {record["sweep"]["case"]: record for record in load_results(out) if record["status"] == "failed"}
    assert set(failed) == {17, 23}
    assert failed[17]["failure_kind"] == "process" and "died, twice with this case alone" in failed[17]["failure"]
    dead, broken = (failed[number]["case"]["generated"] for number in (17, 23))
    assert dead == {"contacts": [], "com": [], "mass": 0.0}, "its posture may be what kills"
    assert set(broken) >= set(dead)
    assert failed[23]["failure"] == "unexpected ZeroDivisionError: broken on purpose"
    assert failed[17]["verdict"] == failed[23]["verdict"] == "undecided"
    # what failed is there: it is neither computed again nor lost
    before = len(told(problem))
    status, said, _ = finish(start(place, problem, "--out", out, "--quiet"))
    assert status == 1 and said == "" and len(told(problem)) == before


def test_a_process_that_somebody_kills_costs_no_record(place):
    problem, out = write_problem(place / "victim.toml", last=60, seconds=0.05), place / "victim_runs"
    run = start(place, problem, "--out", out, "--workers", "2")
    wait_for(lambda: len(told(problem)) > 8)
    os.kill(told(problem)[-1][1], signal.SIGKILL)
    status, said, _ = finish(run)
    assert status == 0
    assert "61 computed" in said and numbers(out) == list(range(61))
    assert all(record["status"] == "solved" for record in load_results(out))


def test_a_run_that_somebody_kills_goes_on_where_it_was(place):
    problem, out = write_problem(place / "orphans.toml", last=60, seconds=0.05), place / "orphans_runs"
    shards = out / "shards"
    run = start(place, problem, "--out", out, "--workers", "2", "--quiet")
    wait_for(lambda: len(told(problem)) > 20 and len(list(shards.glob("*.jsonl"))) > 2)
    os.kill(run.pid, signal.SIGKILL)
    run.wait()
    # its processes end with it
    wait_for(lambda: not any(alive(pid) for pid in {pid for _, pid in told(problem)}), 10.0)
    kept = len(numbers(out))
    assert len(set(numbers(out))) == kept
    assert 0 < kept < 61
    status, said, _ = finish(start(place, problem, "--out", out, "--workers", "2"))
    assert status == 0 and f"{kept} were there" in said and numbers(out) == list(range(61))
    begun = Counter(number for number, _ in told(problem))
    assert sum(begun.values()) < 61 + 3 * 30  # only what was not finished was begun again


def test_an_interrupt_keeps_what_is_finished(place):
    problem, out = write_problem(place / "stopped.toml", last=60, seconds=0.15), place / "stopped_runs"
    run = start(place, problem, "--out", out, "--workers", "2")
    wait_for(lambda: len(told(problem)) > 20)
    run.send_signal(signal.SIGINT)
    status, _, complaints = finish(run)
    assert status == 1 and complaints[-1] == f"interrupted: what was finished is kept in {out}, the same command goes on"
    wait_for(lambda: not any(alive(pid) for pid in {pid for _, pid in told(problem)}), 10.0)
    found = numbers(out)
    assert 0 < len(found) < 61
    status, said, _ = finish(start(place, problem, "--out", out))
    assert status == 0 and f"{len(found)} were there" in said and numbers(out) == list(range(61))
