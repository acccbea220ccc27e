"""A run: from selectors to a folder of records."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from socp_statics.cases.solve import first_engine, versions
from socp_statics.exceptions import InputError
from socp_statics.runner.dispatch import Chunks, Known, dispatch
from socp_statics.runner.folder import Kept, ResultsFolder, opened
from socp_statics.runner.plan import Question, case_order, check_count, questions
from socp_statics.runner.pool import ClusterPool, LocalPool, checked_workers
from socp_statics.runner.progress import Progress
from socp_statics.runner.selection import select
from socp_statics.runner.shards import UNMET
from socp_statics.runner.work import Done, Part

MOST_CASES = 100_000
TRY_AGAIN = "input"


class Summary(NamedTuple):
    """What a run did.

    Attributes:
        cases: Number of cases asked for.
        kept: Of them, records that were there already; stale ones hold again where their question is asked again.
        computed: Of them, computed now.
        stale: Of the records that held before, those that no longer do: other questions were asked, or the same ones computed anew.
        failed: Of all, those whose record says "failed".
        unmet: Of all, those that do not hold what their file expects.
        seconds: Time on the clock, from the first chunk to the last record [s].
        processor: Processor time of the processes, all together, without their start [s].
        notes: One sentence for each thing in the folder that was put right.
        first_failure: The first failed case, else the first that does not hold what its file expects, or "".
    """

    cases: int
    kept: int
    computed: int
    stale: int
    failed: int
    unmet: int
    seconds: float
    processor: float
    notes: tuple[str, ...]
    first_failure: str


def run(
    selectors: str | Path | Iterable[str | Path] = (),
    out: str | Path = "runs",
    *,
    values: Mapping[str, Any] | None = None,
    engine: str = "auto",
    workers: Any = None,
    scheduler: str | None = None,
    rerun: bool = False,
    yes: bool = False,
    quiet: bool = True,
) -> Summary:
    """Answer many problems and keep the records in a folder; what is there already is not computed again.

    A program that calls this is imported by every process: what it does itself belongs under ``if __name__ == "__main__":``.

    Args:
        selectors: Names, globs of names, families, folders, paths that end in .toml, one or several; none: all named problems.
        out: The folder.
        values: Dotted key -> value, set in every problem.
        engine: "auto" or a registered engine.
        workers: Number of processes, one a processor by default.
        scheduler: Address of a Dask scheduler whose workers are used instead.
        rerun: Compute everything anew.
        yes: Whether more than 100000 cases are meant.
        quiet: Whether to say nothing on standard error.

    Returns:
        What was done.

    Raises:
        InputError: A selector, problem, folder or number is wrong; nothing was computed.
        StaticsError: The folder could not be written; what was finished is kept.
        KeyboardInterrupt: It was interrupted; what was finished is kept.
    """
    if not isinstance(out, str | Path):
        raise InputError(f"out: the path of a folder is expected, got {out!r}", name=str(out), field="out")
    first = _checked_engine(engine)
    count = checked_workers(workers)
    if scheduler is not None and workers is not None:
        raise InputError("--workers cannot be chosen with --scheduler, the cluster has its own", name=str(workers), field="--workers")
    asked = questions(select(selectors), values or {}, first)
    total = check_count(asked, MOST_CASES, yes)
    cluster = None if scheduler is None else ClusterPool(scheduler)
    try:
        return _run(asked, Path(out), total, engine, first, cluster, count, rerun, quiet)
    finally:
        if cluster is not None:
            cluster.close()


def _run(
    asked: list[Question], out: Path, total: int, engine: str, first: str, cluster: ClusterPool | None, workers: int, rerun: bool,
    quiet: bool,
) -> Summary:  # fmt: skip
    with opened(out) as folder:
        current, earlier = folder.current(), folder.earlier()
        held = {(name, number, kept.file) for name, there in current.items() for number, kept in there.items()}
        plan = _plan(asked, folder, current, earlier, rerun)
        missing = sum(work for _, work, _ in plan)
        about = {"engine": engine, "versions": versions(robot=True)}
        for question in asked:
            gone = [number for number in current.get(question.name, {}) if number >= question.cases]
            for number in gone:
                folder.manifest.stale.setdefault(current[question.name].pop(number).file, set()).add(number)
        # A digest stands for records that were all compared with it; until then those of a changed problem are looked at again.
        changed = {q.name for q in asked if not _same(q, folder) and any(k.failure != TRY_AGAIN for k in current.get(q.name, {}).values())}
        folder.manifest.plan({q.name: {"cases": q.cases, "digest": None if q.name in changed else q.digest} for q in asked}, about)
        folder.manifest.write()
        state = _State(folder, current, earlier, missing, quiet)
        if not quiet:
            for note in folder.notes:
                print(note, file=sys.stderr, flush=True)
        if missing:
            _compute(plan, missing, engine, first, cluster, workers, state)
        folder.manifest.plan({q.name: {"cases": q.cases, "digest": q.digest} for q in asked}, about)
        folder.manifest.write()
        holding = folder.current()
        bad = [(q, n, k.failure) for q in asked for n, k in sorted(holding.get(q.name, {}).items()) if k.failure]
        failures = [entry for entry in bad if entry[2] != UNMET]
        first_bad = next((f"{q.label} case {n}" if q.sweep else q.label for q, n, _ in failures or bad), "")
        stale = held - {(name, number, kept.file) for name, there in holding.items() for number, kept in there.items()}
        return Summary(
            total, total - state.computed, state.computed, len(stale), len(failures), len(bad) - len(failures),
            state.progress.elapsed if missing else 0.0, state.processor, tuple(folder.notes), first_bad,
        )  # fmt: skip


def _checked_engine(engine: str) -> str:
    try:
        return first_engine(engine)
    except InputError as error:
        raise InputError(f"--engine: {error}", name=engine, field="--engine") from error


Work = tuple[Question, int, Known]
Current = Mapping[str, Mapping[int, Kept]]
Earlier = Mapping[str, Mapping[int, Mapping[str, Kept]]]


def _same(question: Question, folder: ResultsFolder) -> bool:
    """Whether all records of a problem that hold are known to answer this question."""
    return bool(folder.manifest.plans.get(question.name, {}).get("digest") == question.digest)


def _plan(asked: Sequence[Question], folder: ResultsFolder, current: Current, earlier: Earlier, rerun: bool) -> list[Work]:
    """Of each problem how many of its cases have to be looked at, and the stamps of records that may hold, still or again.

    A problem whose digest is the one its records were made with has only its missing cases looked at. Records that failed because of their
    input are tried again: an extra may have been installed since.
    """
    plan: list[Work] = []
    for question in asked:
        inside = {number: kept for number, kept in current.get(question.name, {}).items() if number < question.cases}
        if rerun:
            plan.append((question, question.cases, {}))
            continue
        settled = {n for n, kept in inside.items() if kept.failure != TRY_AGAIN} if _same(question, folder) else set()
        known: Known = {number: (kept.stamp,) for number, kept in inside.items() if number not in settled}
        for number, stamps in earlier.get(question.name, {}).items():
            good = [stamp for stamp, kept in stamps.items() if kept.failure in ("", UNMET)]
            if good and number < question.cases and number not in settled:
                known[number] = (*known.get(number, ()), *good)
        plan.append((question, question.cases - len(settled), known))
    return plan


def _missing(plan: Sequence[Work], current: Current) -> Iterator[tuple[Question, Iterator[int], Known]]:
    for question, left, known in plan:
        there = current.get(question.name, {})
        every = left == question.cases
        yield question, (n for n in case_order(question.sweep) if every or n not in there or n in known), known


class _State:
    """What is counted while chunks come in."""

    def __init__(self, folder: ResultsFolder, current: dict[str, dict[int, Kept]], earlier: Earlier, total: int, quiet: bool):
        self.folder, self.current, self.earlier = folder, current, earlier
        self.progress = Progress(total, quiet)
        self.computed, self.processor = 0, 0.0

    def finished(self, parts: Sequence[Part], done: Done) -> None:
        """Write what a chunk brought."""
        self.processor += done.processor
        for part, lines in zip(parts, done.lines, strict=True):
            new, there = [line for line in lines if line.text], self.current.get(part.name, {})
            if new:
                self.folder.write(part.name, new, there)
            others = [line for line in lines if not line.text and (line.number not in there or there[line.number].stamp != line.stamp)]
            if others:
                self.folder.hold_again({line.number: self.earlier[part.name][line.number][line.stamp] for line in others}, there)
            self.computed += len(new)
            self.progress.advance(len(lines), sum(line.status == "failed" for line in new))


def _compute(
    plan: Sequence[Work], missing: int, engine: str, first: str, cluster: ClusterPool | None, workers: int, state: _State
) -> None:
    if cluster is None and first == "kernel":
        _compile(state.progress.quiet)
    pool: LocalPool | ClusterPool = cluster or LocalPool(min(workers, missing))
    chunks = Chunks(_missing(plan, {name: dict(there) for name, there in state.current.items()}), missing, pool.workers)

    def waiting() -> None:
        chunks.elapsed = state.progress.elapsed
        state.progress.tick()

    try:
        with state.progress:
            dispatch(chunks, pool, engine, state.finished, waiting)
    finally:
        if pool is not cluster:
            pool.close()


def _compile(quiet: bool) -> None:
    """Compile the kernel, so that no process answers with another engine, or compiles, because it is not on disk yet."""
    from socp_statics.engines.kernel.compilation import PACKAGE, compile_all, entries_of

    if not all(one.kept() for one in entries_of(PACKAGE)):
        if not quiet and not sys.stderr.isatty():
            print("compiling the kernel for this machine, once; this takes about half a minute", file=sys.stderr, flush=True)
        compile_all()
