"""The correctness sweep: thousands of seeded stances, every verdict, margin, region and certificate checked without the toolkit.

    python tests/sweeps/verdicts.py [--stances 20000] [--seed 0] [--engine auto] [--workers 2] [--json FILE]
    python tests/sweeps/verdicts.py --only FAMILY:SEED [--engine auto]

Exit status 1 where anything does not hold; each violation names a stance that `--only` checks alone.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path

# Before numpy is imported: the stances are spread over processes, one thread each.
for library in ("OMP", "OPENBLAS", "MKL", "NUMBA"):
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")
sys.path.insert(0, str(Path(__file__).parents[1]))

from sweeps.checks import check_case, unchecked  # noqa: E402
from sweeps.outcome import Outcome  # noqa: E402
from sweeps.population import Case, population  # noqa: E402
from sweeps.summary import Summary  # noqa: E402

CHUNK = 20


def _checked(cases: list[Case], engine: str, sides: int, regions: int, batches: int) -> list[Outcome]:
    """Some stances in one process; regions and batch calls of one in so many."""
    return [
        check_case(case, engine, sides, regions=case.seed % regions == 0, batches=bool(batches) and case.seed % batches == 0)
        for case in cases
    ]


def outcomes(cases: list[Case], workers: int, *asked) -> Iterator[Outcome]:
    """Every stance of a sweep, checked; in order, whatever the number of processes.

    Compiled code can take its process with it, which is a violation: of the stance that does so again in a process of its own, else
    of the first of those that were lost. Memory that was overwritten shows later and not always: `NUMBA_BOUNDSCHECK=1` finds where.
    """
    chunks = [cases[k : k + CHUNK] for k in range(0, len(cases), CHUNK)]
    done = 0
    while done < len(chunks):
        with _pool(workers) as pool:
            coming = [pool.submit(_checked, chunk, *asked) for chunk in chunks[done:]]
            try:
                for found in coming:
                    yield from found.result()
                    done += 1
            except BrokenProcessPool:
                pool.shutdown(cancel_futures=True)
        if done < len(chunks):
            again = [_alone(case, *asked) for case in chunks[done]]
            if not any(check == "process" for out in again for check, _ in out.violations):
                lost = f"{chunks[done][0]} to {chunks[done][-1]}" + (" or soon after" if workers > 1 else "")
                again[0].require(False, "process", f"a process ended in {lost}, and none of these stances does it alone")
            yield from again
            done += 1


def _pool(workers: int) -> ProcessPoolExecutor:
    return ProcessPoolExecutor(workers, mp_context=multiprocessing.get_context("spawn"))


def _alone(case: Case, *asked) -> Outcome:
    """A stance checked in a process of its own."""
    with _pool(1) as pool:
        try:
            return pool.submit(_checked, [case], *asked).result()[0]
        except BrokenProcessPool:
            out = unchecked(case)
            out.require(False, "process", "the process ended while this stance was checked")
            return out


def main(arguments: list[str] | None = None) -> int:
    """Run the sweep and print what it found."""
    parser = argparse.ArgumentParser(description="Check verdicts, margins, regions and certificates of seeded random stances.")
    parser.add_argument("--stances", type=int, default=20000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--engine", default="auto")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--sides", type=int, default=256, help="of the pyramids of the linear programs")
    parser.add_argument("--regions", type=int, default=1, help="trace the region of one stance in so many")
    parser.add_argument("--batches", type=int, default=4, help="put one contact set in so many to the batch call; 0: none")
    parser.add_argument("--json", type=Path, help="where to write counts, violations and handovers")
    parser.add_argument("--only", action="append", help="check one stance alone, FAMILY:SEED")
    given = parser.parse_args(arguments)
    cases = population(given.stances, given.seed)
    if given.only:
        pairs = [name.rsplit(":", 1) for name in given.only]
        cases = [Case(family, int(seed)) for family, seed in pairs]
    start = time.perf_counter()
    summary = Summary(f"{len(cases)} stances, seed {given.seed}, engine {given.engine}, {given.workers} processes", given.sides)
    asked = (1, given.engine, given.sides, 1, 1) if given.only else (
        given.workers, given.engine, given.sides, given.regions, given.batches
    )  # fmt: skip
    for k, out in enumerate(outcomes(cases, *asked), start=1):
        summary.add(out)
        if given.only:
            print(*out.lines(), sep="\n")
        elif sys.stderr.isatty():
            found = len(summary.violations)
            print(f"\r{k}/{len(cases)}  {found} violations  {time.perf_counter() - start:.0f} s", end="", file=sys.stderr, flush=True)
    summary.wall = time.perf_counter() - start
    if not given.only:
        print(*summary.lines(), sep="\n")
    if given.json:
        given.json.write_text(json.dumps(summary.record(), indent=1) + "\n")
    return 1 if summary.violations or (summary.lopsided and not given.only) else 0


if __name__ == "__main__":
    sys.exit(main())
