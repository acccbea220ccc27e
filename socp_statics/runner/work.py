"""What a worker process does: a chunk of cases in, their records as lines out."""

from __future__ import annotations

import gc
import threading
import time
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from socp_statics.cases.batch import Answered, problem_stamp, refused_record, solve_many, stamp_of
from socp_statics.cases.problem import Problem
from socp_statics.cases.sweep import Values
from socp_statics.cases.sweep_cases import Cases
from socp_statics.exceptions import InputError
from socp_statics.runner.shards import Line, failure_of

# Cases solved by one call: enough to share its cost, few enough that their records do not pile up.
TOGETHER = 64
# A worker of a cluster may run several tasks in threads; the libraries behind an answer expect to be alone.
_ALONE = threading.Lock()


class Part(NamedTuple):
    """Some cases of one problem.

    Attributes:
        name: What records call the problem.
        label: What sentences call it.
        path: Its file.
        tables: What is in it.
        sweep: Dotted key -> values.
        numbers: Of the cases.
        known: Number -> stamps of records that are there and may hold, now or again.
    """

    name: str
    label: str
    path: Path
    tables: Mapping[str, Any]
    sweep: Mapping[str, Values]
    numbers: Sequence[int]
    known: Mapping[int, Sequence[str]]


class Done(NamedTuple):
    """What came of a chunk.

    Attributes:
        lines: Of each part, its finished cases in order.
        seconds: Time on the clock for all of it [s].
        processor: Processor time of it [s].
    """

    lines: list[list[Line]]
    seconds: float
    processor: float


def answer_chunk(parts: Sequence[Part], engine: str) -> Done:
    """Answer the cases of a chunk.

    Args:
        parts: The cases.
        engine: As for `socp_statics.solve`.
    """
    with _ALONE:
        began, spent = time.perf_counter(), time.process_time()
        # Records are trees that die when they are written; looking through thousands of them for circles is a fifth of the time.
        collecting = gc.isenabled()
        gc.disable()
        try:
            lines = [_answer_part(part, engine) for part in parts]
        finally:
            if collecting:
                gc.enable()
        return Done(lines, time.perf_counter() - began, time.process_time() - spent)


def _answer_part(part: Part, engine: str) -> list[Line]:
    cases = Cases(part.tables, part.sweep, part.name, part.label, part.path)
    done: dict[int, Line] = {}
    for start in range(0, len(part.numbers), TOGETHER):
        ready: dict[int, Problem] = {}
        for number in part.numbers[start : start + TOGETHER]:
            try:
                problem = cases.case(number)
            except InputError as error:
                done[number] = _refused(part, cases, number, engine, str(error))
                continue
            if number in part.known and (stamp := problem_stamp(problem, engine)) in part.known[number]:
                done[number] = Line(number, "", stamp, "", "", 0.0, b"")
            else:
                ready[number] = problem
        for number, answered in zip(ready, solve_many(list(ready.values()), engine), strict=True):
            done[number] = _line(number, answered)
    return [done[number] for number in part.numbers]


def _refused(part: Part, cases: Cases, number: int, engine: str, reason: str) -> Line:
    """A case whose input is wrong."""
    tables, values = cases.tables(number)
    record = refused_record(part.name, tables, engine, reason, number if part.sweep else None, values)
    line = _line(number, Answered(record, 0.0))
    return line._replace(text=b"") if line.stamp in part.known.get(number, ()) else line


def dead_line(part: Part, engine: str) -> Line:
    """The record of a case that kills the process that answers it; its posture is not made here, which may be what kills.

    Args:
        part: The case alone.
        engine: As for `socp_statics.solve`.
    """
    (number,) = part.numbers
    tables, values = Cases(part.tables, part.sweep, part.name, part.label, part.path).tables(number)
    reason = f"{part.label} case {number}: " if part.sweep else f"{part.label}: "
    reason += "the process that computed it died, twice with this case alone"
    record = refused_record(part.name, tables, engine, reason, number if part.sweep else None, values, "process")
    return _line(number, Answered(record, 0.0))


def _line(number: int, answered: Answered) -> Line:
    record = answered.record
    stamp = stamp_of(record["hash"], record["case"])
    return Line(number, record["hash"], stamp, record["status"], failure_of(record), answered.seconds, record.line())
