"""Where chunks are computed: processes of this machine, or a Dask cluster; both are executors of `concurrent.futures`."""

from __future__ import annotations

import asyncio
import logging
import multiprocessing
import os
import re
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import BrokenExecutor, Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import contextmanager
from multiprocessing.connection import Connection
from typing import Any

from socp_statics.exceptions import InputError, StaticsError
from socp_statics.runner.work import Done, Part, answer_chunk

ONE_THREAD = {f"{library}_NUM_THREADS": "1" for library in ("OMP", "OPENBLAS", "MKL", "NUMEXPR", "VECLIB_MAXIMUM")}
WORK = "socp_statics.runner.work"
ANSWERS_WITHIN = 10
# Host and port, a name or number of either version of the internet protocol; how it is spoken to may be left out.
ADDRESS = re.compile(r"(?:[a-z]+://)?(?:\[[0-9A-Fa-f:.]+(?:%\w+)?\]|[^\s:/\[\]]+):(\d{1,5})/?|inproc://\S+")


class LocalPool:
    """Processes of this machine, forked from a server that has imported what they need.

    Args:
        workers: How many.
        work: What they do; answers chunks by default.
    """

    shared = False

    def __init__(self, workers: int, work: Callable[..., Done] = answer_chunk):
        self.workers, self._work = workers, work
        self._start()

    def _start(self) -> None:
        context = multiprocessing.get_context("forkserver")
        context.set_forkserver_preload([WORK])
        # The processes watch the other end: when it closes, because the run is over or this process has died, they end at once.
        self._watched, self._lifeline = context.Pipe(duplex=False)
        self._executor: Executor = ProcessPoolExecutor(
            self.workers, mp_context=context, initializer=_prepare, initargs=(self._watched,)
        )
        # One that cannot even start is no fault of a case.
        with _environment():
            started = self._executor.submit(os.getpid)
        try:
            started.result()
        except BrokenExecutor as error:
            raise StaticsError("the processes of the pool die when they start; socp-statics solve may say why", name="--workers") from error

    def submit(self, parts: Sequence[Part], engine: str) -> Future[Done]:
        """Have a chunk answered."""
        try:
            with _environment():
                return self._executor.submit(self._work, parts, engine)
        except BrokenExecutor as error:
            failed: Future[Done] = Future()
            failed.set_exception(error)
            return failed

    def died(self, error: BaseException) -> bool:
        """Whether a chunk failed because a process did."""
        return isinstance(error, BrokenExecutor)

    def restart(self) -> None:
        """New processes in place of a broken pool's."""
        self.close()
        self._start()

    def close(self) -> None:
        """End the processes, whatever they are at."""
        self._lifeline.close()
        self._executor.shutdown(wait=True, cancel_futures=True)
        self._watched.close()


@contextmanager
def _environment() -> Iterator[None]:
    """What the server that processes are forked from is started with: one thread for linear algebra, and the path of this process."""
    wanted = ONE_THREAD | {"PYTHONPATH": os.pathsep.join(os.path.abspath(place) for place in sys.path if place)}
    before = {name: os.environ.get(name) for name in wanted}
    os.environ.update(wanted)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


def _prepare(watched: Connection) -> None:
    """First thing in a process of the pool: one thread for linear algebra, interrupts are the parent's, no life without it."""
    os.environ.update(ONE_THREAD)
    signal.signal(signal.SIGINT, signal.SIG_IGN)

    def watch() -> None:
        try:
            watched.recv()
        except (EOFError, OSError):
            os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


class ClusterPool:
    """A Dask cluster that is there already.

    Args:
        address: Of its scheduler.

    Raises:
        InputError: The extra is not installed, the address is none, nobody answers, or no worker is there.
    """

    # A cluster starts a new worker where one died; only the chunk that was on it is lost.
    shared = True

    def __init__(self, address: str):
        form = ADDRESS.fullmatch(str(address))
        if form is None or not 0 < int(form[1] or 1) < 65536:
            raise _no_scheduler(address, "this is no tcp://host:port")
        try:
            from distributed import Client, Security, rpc
        except ImportError as error:
            message = "--scheduler needs the extra batch: pip install 'socp-statics[batch]'"
            raise InputError(message, name=address, field="--scheduler") from error

        async def who() -> None:
            async with rpc(address, connection_args=Security().get_connection_args("scheduler")) as other:
                await other.identity()

        try:
            with _silenced():
                # A client waits for ever for one that lets it connect and says nothing; a notebook has a loop of its own in this thread.
                with ThreadPoolExecutor(1) as aside:
                    aside.submit(lambda: asyncio.run(asyncio.wait_for(who(), ANSWERS_WITHIN))).result()
                self._client: Any = Client(address, timeout=ANSWERS_WITHIN, set_as_default=False)
        except TimeoutError as error:
            raise _no_scheduler(address, f"no scheduler answered within {ANSWERS_WITHIN} s") from error
        except (OSError, ValueError, TypeError, RuntimeError) as error:
            raise _no_scheduler(address, str(error).split("\n")[0].strip().rstrip(".") or type(error).__name__) from error
        self.workers = sum(self._client.nthreads().values())
        if not self.workers:
            self.close()
            raise InputError(f"--scheduler {address}: it has no workers, at least one is expected", name=address, field="--scheduler")
        self._executor = self._client.get_executor(pure=False)

    def submit(self, parts: Sequence[Part], engine: str) -> Future[Done]:
        """Have a chunk answered."""
        return self._executor.submit(answer_chunk, parts, engine)

    def died(self, error: BaseException) -> bool:
        """Whether a chunk failed because its workers did, time after time."""
        from distributed.scheduler import KilledWorker

        if type(error).__module__.startswith(("distributed", "dask", "concurrent.futures")) and not isinstance(error, KilledWorker):
            raise StaticsError(f"--scheduler: the cluster gave up on a chunk ({error})", name="--scheduler") from error
        return isinstance(error, KilledWorker)

    def restart(self) -> None:
        """The cluster restarts its workers itself."""

    def close(self) -> None:
        """Leave the cluster as it was."""
        self._client.close()


def _no_scheduler(address: str, reason: str) -> InputError:
    message = f"--scheduler {address}: a running Dask scheduler is expected at an address of the form tcp://host:port ({reason})"
    return InputError(message, name=str(address), field="--scheduler")


@contextmanager
def _silenced() -> Iterator[None]:
    """Dask logs the traceback of an attempt to connect that failed; the error says it once more, in a sentence."""
    log = logging.getLogger("distributed")
    before, log.disabled = log.disabled, True
    try:
        yield
    finally:
        log.disabled = before


def checked_workers(workers: Any) -> int:
    """The number of processes.

    Args:
        workers: A whole number, also as text; None for one each processor that this process may use.

    Raises:
        InputError: It is not a whole number >= 1.
    """
    if workers is None:
        return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    text = str(workers).strip()
    if isinstance(workers, bool | float) or not text.isdecimal() or not 1 <= int(text) <= 4096:
        message = f"--workers must be a whole number from 1 to 4096, got {workers!r}"
        raise InputError(message, name=str(workers), field="--workers")
    return int(text)
