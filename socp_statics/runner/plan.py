"""What a run will compute: the cases of each problem, in an order in which neighbours share a compiled program."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import socp_statics
from socp_statics.cases.dotted import parse_key
from socp_statics.cases.hashing import SCHEMA, canonical_json
from socp_statics.cases.problem import Problem
from socp_statics.cases.schema import read_sweep
from socp_statics.cases.sweep import Values, case_count
from socp_statics.exceptions import InputError
from socp_statics.runner.selection import Source

# Keys of a sweep that change which program is compiled; those that only change its numbers come last.
STRUCTURAL = (("model",), ("parameters",), ("posture", "generator"), ("posture", "robot"), ("posture", "support"))
STRUCTURAL_ENDS = ("type", "size", "vertices", "transmits", "shape")


class Question(NamedTuple):
    """One problem of a run.

    Attributes:
        name: What records call it.
        label: What sentences call it.
        path: Its file.
        tables: What is in it, with what ``--set`` says.
        sweep: Dotted key -> values.
        cases: Number of cases.
        digest: Of everything that decides the records of all its cases.
        group: Problems of one group share compiled programs.
    """

    name: str
    label: str
    path: Path
    tables: Mapping[str, Any]
    sweep: Mapping[str, Values]
    cases: int
    digest: str
    group: str


def questions(sources: Sequence[Source], values: Mapping[str, Any], engine: str) -> list[Question]:
    """The problems of a run, neighbours in the order share compiled programs.

    Args:
        sources: The files.
        values: Dotted key -> value, set in every one of them.
        engine: The engine that is asked first.

    Raises:
        InputError: A problem that was named, or that ``--set`` changes, is wrong; or the sweep of any is.
    """
    from socp_statics.cases.problem import problem_from_tables

    found = []
    for source in sources:
        tables: Mapping[str, Any] = source.tables
        if source.chosen or values:
            problem = problem_from_tables(tables, source.name, label=source.label, path=source.path)
            tables = _with_values(problem, values)
        sweep = read_sweep(tables, source.label)
        digest = _digest(tables, sweep, source.path.parent, engine)
        label = f"{source.label} with --set {', '.join(values)}" if values else source.label
        found.append(Question(source.name, label, source.path, tables, sweep, case_count(sweep), digest, _group(tables)))
    first = {question.group: i for i, question in reversed(list(enumerate(found)))}
    return sorted(found, key=lambda question: first[question.group])


def _with_values(problem: Problem, values: Mapping[str, Any]) -> Mapping[str, Any]:
    return problem.with_values(values).raw if values else problem.raw


def _group(tables: Mapping[str, Any]) -> str:
    """What decides which programs are compiled, as far as the text of a problem says it."""
    posture = tables.get("posture")
    posture = posture if isinstance(posture, Mapping) else {}
    contacts = posture.get("contacts")
    kinds = [entry.get("type") for entry in contacts if isinstance(entry, Mapping)] if isinstance(contacts, list) else []
    return repr([tables.get("model"), posture.get("robot"), posture.get("support"), kinds, tables.get("parameters")])


def _digest(tables: Mapping[str, Any], sweep: Mapping[str, Values], folder: Path, engine: str) -> str:
    """SHA-256 of a problem with its sweep, the engine, the toolkit, and the text of the robots that are files."""
    posture = tables.get("posture")
    stated = posture.get("robot") if isinstance(posture, Mapping) else None
    robots = [stated, *next((values for key, values in sweep.items() if parse_key(key) == ("posture", "robot")), ())]
    files = {}
    for robot in robots:
        path = folder / robot if isinstance(robot, str) and robot.endswith((".urdf", ".xml")) else None
        if path is not None and path.is_file():
            files[str(robot)] = hashlib.sha256(path.read_bytes()).hexdigest()
    kept = {key: value for key, value in tables.items() if key != "sweep"}
    swept = {key: [values.start, values.stop] if isinstance(values, range) else values for key, values in sweep.items()}
    whole = {"schema": SCHEMA, "toolkit": socp_statics.__version__, "engine": engine, "robots": files, "sweep": swept, "problem": kept}
    return hashlib.sha256(canonical_json(_dated(whole)).encode("ascii")).hexdigest()


def _dated(value: Any) -> Any:
    """The tables with TOML's dates and times as text: they are wrong in every problem, and each case will say so."""
    if isinstance(value, Mapping):
        return {key: _dated(entry) for key, entry in value.items()}
    if isinstance(value, list):
        return [_dated(entry) for entry in value]
    return value.isoformat() if hasattr(value, "isoformat") else value


def case_order(sweep: Mapping[str, Values]) -> Iterator[int]:
    """The numbers of all cases; what changes the compiled program changes slowest.

    Args:
        sweep: Dotted key -> values; the number of a case counts its last key fastest.
    """
    keys = list(sweep)
    strides, stride = {}, 1
    for key in reversed(keys):
        strides[key] = stride
        stride *= len(sweep[key])
    order = sorted(keys, key=lambda key: not _structural(key))

    def numbers(at: int, base: int) -> Iterator[int]:
        if at == len(order):
            yield base
            return
        for k in range(len(sweep[order[at]])):
            yield from numbers(at + 1, base + k * strides[order[at]])

    return numbers(0, 0)


def _structural(key: str) -> bool:
    parts = parse_key(key, "sweep")
    return any(parts[: len(start)] == start for start in STRUCTURAL) or parts[-1] in STRUCTURAL_ENDS


def check_count(asked: Sequence[Question], most: int, agreed: bool) -> int:
    """The number of cases of a run.

    Args:
        asked: The problems.
        most: More than this need to be agreed to.
        agreed: Whether they are.

    Raises:
        InputError: They are too many and not agreed to.
    """
    total = sum(question.cases for question in asked)
    if total > most and not agreed:
        largest = max(asked, key=lambda question: question.cases)
        makes = f"{largest.cases} of {total} cases" if largest.cases < total else f"{total} cases"
        message = f"{largest.label}: its sweep alone makes {makes}, more than {most}; --yes is expected where that is meant"
        raise InputError(message, name=largest.label, field="--yes")
    return total
