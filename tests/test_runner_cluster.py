"""A Dask cluster in place of the pool: real worker processes, one of them killed; what the extra is needed for."""

import os
import signal
import socket
import sys
import time

import pytest
from deadly_package import ROOT, finish, install, start, told, write_problem

from socp_statics import load_results
from socp_statics.cli import main
from socp_statics.runner.pool import ClusterPool


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    place = tmp_path_factory.mktemp("cluster")
    install(place)
    return place


@pytest.fixture(scope="module")
def cluster(place):
    distributed = pytest.importorskip("distributed")
    patch = pytest.MonkeyPatch()
    # Dask starts its workers with the path of this process.
    for folder in (str(ROOT), str(place)):
        patch.syspath_prepend(folder)
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=":0") as cluster:
        yield cluster
    patch.undo()


def test_a_cluster_survives_the_death_of_a_worker(place, cluster):
    problem, out = write_problem(place / "clustered.toml", last=40, seconds=0.05, breaks=[7]), place / "runs"
    run = start(place, problem, "--out", out, "--scheduler", cluster.scheduler_address)
    end = time.monotonic() + 60
    while len(told(problem)) < 6:
        assert time.monotonic() < end
        time.sleep(0.02)
    os.kill(told(problem)[-1][1], signal.SIGKILL)
    status, said, complaints = finish(run)
    assert status == 1 and "case 7: failed" in complaints[-1]
    assert "41 computed" in said
    records = list(load_results(out, stale=True))
    assert [record["sweep"]["case"] for record in records] == list(range(41))
    assert [record["status"] for record in records].count("failed") == 1
    assert os.getpid() not in {pid for _, pid in told(problem)}


def test_a_case_that_kills_its_worker_is_recorded(cluster):
    """The pool says of Dask's own error that a worker died, and of no other."""
    from distributed.scheduler import KilledWorker

    pool = ClusterPool(cluster.scheduler_address)
    try:
        assert pool.workers == 2
        assert pool.died(KilledWorker("task", None, 3)) and not pool.died(ValueError("x"))
    finally:
        pool.close()


@pytest.mark.parametrize("answers", ["nobody", "somebody who says nothing"])
def test_no_scheduler_at_an_address_is_said_in_one_sentence(answers, monkeypatch, capfd, tmp_path):
    pytest.importorskip("distributed")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("socp_statics.runner.pool.ANSWERS_WITHIN", 0.5)
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        if answers != "nobody":
            other.listen()
        address = f"tcp://127.0.0.1:{other.getsockname()[1]}"
        assert main(["run", "contacts/ladder", "--scheduler", address]) == 2
    (said,) = capfd.readouterr().err.strip().splitlines()
    assert said.startswith(f"--scheduler {address}: a running Dask scheduler is expected at an address of the form tcp://host:port")
    assert not (tmp_path / "runs").exists()


def test_a_cluster_needs_its_extra(monkeypatch, capsys, tmp_path):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setitem(sys.modules, "distributed", None)
    assert main(["run", "contacts/ladder", "--scheduler", "tcp://127.0.0.1:8786"]) == 2
    assert capsys.readouterr().err.strip().endswith("--scheduler needs the extra batch: pip install 'socp-statics[batch]'")
    assert not (tmp_path / "runs").exists()
