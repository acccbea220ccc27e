"""Handing out chunks: as long as measured times say, to as many processes as there are, and away from a case that kills them."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from itertools import chain
from typing import Protocol

from socp_statics.runner.plan import Question
from socp_statics.runner.work import Done, Part, dead_line

# Seconds a chunk should take: at first, at most, and which share of the run so far.
LEAST, MOST, SHARE = 1.0, 10.0, 1 / 30
FIRST_CASES, GROWTH, MOST_CASES = 4, 8, 2000
# How often a case that is computed alone may take its process with it before the case is blamed.
PATIENCE = 2
LOOK = 0.2
Known = dict[int, tuple[str, ...]]
Finished = Callable[[Sequence[Part], Done], None]


class Pool(Protocol):
    """What chunks are submitted to."""

    workers: int
    shared: bool

    def submit(self, parts: Sequence[Part], engine: str) -> Future[Done]:
        """Have a chunk answered."""
        ...

    def died(self, error: BaseException) -> bool:
        """Whether a chunk failed because a process did."""
        ...

    def restart(self) -> None:
        """Make the pool work again."""
        ...


class Chunks:
    """Cuts the cases of a run into chunks; chunks of one group of problems follow each other.

    Args:
        wanted: Problems, each with the numbers of its cases in the order in which they are computed, and the stamps of records that may
            hold.
        total: Number of cases altogether.
        workers: Number of processes.
    """

    def __init__(self, wanted: Iterable[tuple[Question, Iterator[int], Known]], total: int, workers: int):
        self._cases = chain.from_iterable(((q, number, known) for number in numbers) for q, numbers, known in wanted)
        self._next = next(self._cases, None)
        self._left, self._workers = total, workers
        self._pace: dict[str, float] = {}
        self._last: dict[str, int] = {}
        self.elapsed = 0.0

    def measured(self, group: str, cases: int, seconds: float) -> None:
        """Learn from a finished chunk."""
        if cases:
            new = seconds / cases
            old = self._pace.get(group, new)
            self._pace[group] = 0.5 * (old + new)

    def _size(self, group: str) -> int:
        pace, before = self._pace.get(group), self._last.get(group)
        if pace is None or before is None:
            size = FIRST_CASES if before is None else before
        else:
            target = min(MOST, max(LEAST, SHARE * self.elapsed))
            size = min(int(target / max(pace, 1e-6)), GROWTH * before, MOST_CASES)
        size = max(1, min(size, -(-self._left // (2 * self._workers))))
        self._last[group] = max(size, 1)
        return size

    def take(self) -> tuple[str, list[Part]] | None:
        """The next chunk with its group, None when there is none."""
        if self._next is None:
            return None
        group = self._next[0].group
        size = self._size(group)
        cases: list[tuple[Question, int, Known]] = []
        while self._next is not None and len(cases) < size and self._next[0].group == group:
            cases.append(self._next)
            self._next = next(self._cases, None)
        self._left -= len(cases)
        by_problem: dict[str, tuple[Question, list[int], Known]] = {}
        for question, number, known in cases:
            by_problem.setdefault(question.name, (question, [], known))[1].append(number)
        return group, [_part(*entry) for entry in by_problem.values()]


def _part(question: Question, numbers: list[int], known: Known) -> Part:
    mine = {number: known[number] for number in numbers if number in known}
    return Part(question.name, question.label, question.path, question.tables, question.sweep, numbers, mine)


def dispatch(chunks: Chunks, pool: Pool, engine: str, finished: Finished, waiting: Callable[[], None]) -> None:
    """Have all chunks answered.

    Args:
        chunks: The chunks.
        pool: Where.
        engine: As for `socp_statics.solve`.
        finished: Called with every chunk that is done, in this thread.
        waiting: Called now and then.
    """
    running: dict[Future[Done], tuple[str, list[Part]]] = {}
    while True:
        while len(running) < pool.workers + 1 and (chunk := chunks.take()) is not None:
            running[pool.submit(chunk[1], engine)] = chunk
        if not running:
            return
        waiting()
        done, _ = wait(running, timeout=LOOK, return_when=FIRST_COMPLETED)
        lost: list[tuple[str, list[Part]]] = []
        for future in done:
            group, parts = running.pop(future)
            error = future.exception()
            if error is None:
                _note(chunks, group, parts, future.result(), finished)
            elif pool.died(error):
                lost.append((group, parts))
            else:
                raise error
        if lost:
            if not pool.shared:
                # One process took the others with it: whoever was at work is suspected, those that had finished are not.
                for future, (group, parts) in running.items():
                    wait([future])
                    if future.exception() is None:
                        _note(chunks, group, parts, future.result(), finished)
                    else:
                        lost.append((group, parts))
                running.clear()
            _isolate(lost, chunks, pool, engine, finished, waiting)


def _note(chunks: Chunks, group: str, parts: list[Part], done: Done, finished: Finished) -> None:
    chunks.measured(group, sum(len(mine) for mine in done.lines), done.seconds)
    finished(parts, done)


def _isolate(
    lost: list[tuple[str, list[Part]]], chunks: Chunks, pool: Pool, engine: str, finished: Finished, waiting: Callable[[], None]
) -> None:
    """Compute suspects one after the other, halving a chunk that kills its process again until the case that does it is alone."""
    suspects = deque((group, parts, 0) for group, parts in lost)
    pool.restart()
    while suspects:
        group, parts, deaths = suspects.popleft()
        future = pool.submit(parts, engine)
        while not wait([future], timeout=LOOK).done:
            waiting()
        error = future.exception()
        if error is None:
            _note(chunks, group, parts, future.result(), finished)
            continue
        if not pool.died(error):
            raise error
        pool.restart()
        if sum(len(part.numbers) for part in parts) > 1:
            suspects.extendleft((group, half, 0) for half in reversed(_halves(parts)))
        elif deaths + 1 < PATIENCE:
            suspects.appendleft((group, parts, deaths + 1))
        else:
            finished(parts, Done([[dead_line(parts[0], engine)]], 0.0, 0.0))


def _halves(parts: list[Part]) -> tuple[list[Part], list[Part]]:
    """A chunk in two halves, by the number of cases."""
    single = [part._replace(numbers=[number]) for part in parts for number in part.numbers]
    middle = len(single) // 2
    return single[:middle], single[middle:]
