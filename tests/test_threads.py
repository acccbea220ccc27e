"""Batches in threads: pieces in order, whoever fails first, helpers after a fork, work arrays of each thread."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import socp_statics as ss
from socp_statics.engines.threads import in_chunks
from socp_statics.engines.work_memory import LARGEST, kept

ROOT = Path(__file__).parents[1]


@pytest.mark.parametrize("threads", [1, 2, 3, 64])
@pytest.mark.parametrize("items", [0, 1, 6, 7, 100])
def test_pieces_come_back_in_order(items, threads):
    assert in_chunks(lambda part: [2 * i for i in part], list(range(items)), 7, threads) == [2 * i for i in range(items)]


@pytest.mark.parametrize("threads", [2, 5])
def test_pieces_are_short_where_a_thread_would_wait_for_a_long_one(threads):
    lengths = []
    in_chunks(lambda part: [lengths.append(len(part))] * len(part), list(range(400)), 16, threads)
    assert sum(lengths) == 400 and max(lengths) == 16
    assert lengths[0] == 1 and max(lengths[-threads:]) <= 2


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_the_first_piece_that_fails_is_the_one_that_is_heard_of(threads):
    asked, failing = [], threading.Event()

    def work(part):
        asked.append(part[0])
        if 200 in part:
            failing.set()
            raise ss.EngineError("item 200")
        if part[0] > 200:
            failing.wait(10.0)
            time.sleep(0.02)
            raise ss.EngineError("a later item")
        return part

    with pytest.raises(ss.EngineError, match="item 200"):
        in_chunks(work, list(range(1000)), 10, threads)
    # Whoever works on other pieces at that moment finishes them, and takes no more.
    assert len(asked) < 60


def test_threads_keep_work_arrays_of_their_own():
    def make(width, length):
        return (np.empty((length, width)),)

    mine = kept(make, 5, 10)
    assert mine[0].shape[0] == 10 and mine[0].shape[1] >= 5
    assert kept(make, 3, 10) is mine and kept(make, 3, 11) is not mine
    mine, others = kept(make, 5, 10), []
    thread = threading.Thread(target=lambda: others.append(kept(make, 5, 10)))
    thread.start()
    thread.join()
    assert others[0] is not mine and kept(make, 5, 10) is mine


def test_large_work_arrays_are_given_back():
    def make(width, length):
        return (np.empty(length),)

    small = kept(make, 1, 8)
    assert kept(make, 1, LARGEST // 8 + 1) is not kept(make, 1, LARGEST // 8 + 1)
    assert kept(make, 1, 8) is small


def test_the_caller_works_too():
    asked, together = set(), threading.Barrier(2, timeout=10.0)

    def work(part):
        asked.add(threading.current_thread())
        if part[0] < 2:
            together.wait()
        return part

    in_chunks(work, list(range(40)), 1, 2)
    assert len(asked) == 2 and threading.current_thread() in asked


FORKED = """
import os, sys
from socp_statics.engines.threads import in_chunks
work = lambda part: [2 * i for i in part]
assert in_chunks(work, list(range(20)), 3, 3) == list(range(0, 40, 2))
child = os.fork()
if child == 0:
    os._exit(0 if in_chunks(work, list(range(20)), 3, 3) == list(range(0, 40, 2)) else 1)
sys.exit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes do not fork here")
def test_a_forked_process_has_helpers_of_its_own():
    assert subprocess.run([sys.executable, "-W", "ignore", "-c", FORKED], cwd=ROOT, timeout=60).returncode == 0
