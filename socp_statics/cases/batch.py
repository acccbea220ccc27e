"""Many problems at once: each gets the record that `solve` gives it, those of one kind by one call of the kernel."""

from __future__ import annotations

import hashlib
import math
import time
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from socp_statics.cases.answers import ANSWERS
from socp_statics.cases.hashing import NOT_HASHED, SCHEMA, canonical_json, case_hash
from socp_statics.cases.problem import Problem
from socp_statics.cases.record import Record
from socp_statics.cases.solve import failed_record, first_engine, no_answer, problem_hash, record_of, solve
from socp_statics.exceptions import InputError, StaticsError

NOTHING: dict[str, Any] = {"contacts": [], "com": [], "mass": 0.0}


class Answered(NamedTuple):
    """The record of one problem and the time it took.

    Attributes:
        record: Of `solve`; one with status "failed" where that broke down.
        seconds: Time on the clock [s]; of a batch the same share for each.
    """

    record: Record
    seconds: float


def solve_many(problems: Sequence[Problem], engine: str | Sequence[str] = "auto") -> list[Answered]:
    """Answer many problems.

    Args:
        problems: Single problems, or cases of sweeps.
        engine: As for `solve`.

    Returns:
        For each problem the record that `solve` gives it, byte for byte, whatever the others are. Where the computation breaks down, or
        the input is wrong, the record says so.
    """
    kinds: dict[Any, list[int]] = {}
    for i, problem in enumerate(problems):
        kinds.setdefault(_kind(problem, engine), []).append(i)
    answered: dict[int, Answered] = {}
    for kind, mine in kinds.items():
        found = [one_answered(problems[i], engine) for i in mine] if kind is None else _together([problems[i] for i in mine], engine)
        answered |= dict(zip(mine, found, strict=True))
    return [answered[i] for i in range(len(problems))]


def _kind(problem: Problem, engine: str | Sequence[str]) -> Any:
    """What problems have in common that one call of the kernel answers; None for one that is answered alone."""
    many = ANSWERS.load(problem.model).many
    return None if many is None or problem.sweep else many.kind(problem, engine)


def _together(problems: list[Problem], engine: str | Sequence[str]) -> list[Answered]:
    """Records of problems of one kind; one by one where the batch breaks down, so that only who is to blame fails."""
    many = ANSWERS.load(problems[0].model).many
    assert many is not None
    began = time.perf_counter()
    try:
        stances = [problem.stance() for problem in problems]
        keys = many.compute(problems, stances, engine)
        records = [record_of(*each, first_engine(engine)) for each in zip(problems, stances, keys, strict=True)]
    except StaticsError:
        return [one_answered(problem, engine) for problem in problems]
    seconds = (time.perf_counter() - began) / len(problems)
    return [Answered(record, seconds) for record in records]


def one_answered(problem: Problem, engine: str | Sequence[str]) -> Answered:
    """The record of one problem; one with status "failed" where it cannot be answered.

    Args:
        problem: A single problem.
        engine: As for `solve`.
    """
    began = time.perf_counter()
    try:
        record = solve(problem, engine)
    except InputError as error:
        record = _without_answer(problem, engine, str(error), "input")
    except StaticsError as error:
        record = _without_answer(problem, engine, str(error), "engine")
    except Exception as error:  # a mistake of ours in one of thousands of cases is that case's failure, with its reason
        record = _without_answer(problem, engine, f"unexpected {type(error).__name__}: {error}", "engine")
    return Answered(record, time.perf_counter() - began)


def _without_answer(problem: Problem, engine: str | Sequence[str], reason: str, failure: str) -> Record:
    """The record of a problem that is not answered, with its stance where it has one."""
    try:
        return failed_record(problem, engine, reason, failure)
    except Exception:  # the stance itself is what failed, for the reason that is there already
        return refused_record(problem.name, problem.raw, engine, reason, problem.number, problem.swept, failure)


def refused_record(
    name: str, tables: Mapping[str, Any], engine: str | Sequence[str], reason: str, number: int | None, values: Mapping[str, Any],
    failure: str = "input",
) -> Record:  # fmt: skip
    """The record of a case that has no stance: its input is wrong, or its process died.

    Its case is what was asked, with nothing generated: no contacts, no coordinates of a centre of mass, no mass. Loads that cannot be read
    are under ``case.asked`` and not where readers of records look for loads.

    Args:
        name: Of the problem.
        tables: What its file says, the values of the case set.
        engine: As for `solve`.
        reason: Why there is no answer.
        number: Which case of a sweep it is, None where it is none.
        values: Dotted key -> value of that case.
        failure: "input", "engine" or "process".
    """
    stated = {key: value for key, value in tables.items() if key != "sweep"}
    first, posture = first_engine(engine), stated.get("posture")
    readable = _readable(posture)
    asked = {} if readable == posture else {"asked": {"posture": posture}}
    case = {"description": "", "reference": "", "expect": {}} | stated | {"posture": readable, **asked, "generated": dict(NOTHING)}
    return Record(
        {
            "schema": SCHEMA,
            "problem": name,
            "model": str(tables.get("model")),
            "hash": case_hash(stated, first),
            **({} if number is None else {"sweep": {"case": number, "values": values}}),
            "case": case,
            **no_answer(first, reason, failure),
        }
    )


def _readable(posture: Any) -> dict[str, Any]:
    """The table of a posture that may be wrong, without loads that are no vectors."""
    if not isinstance(posture, Mapping):
        return {}
    wrong = set() if _is_vector(posture.get("gravity", (0.0, 0.0, 0.0))) else {"gravity"}
    wrenches = posture.get("external_wrenches", [])
    if not isinstance(wrenches, list) or not all(map(_is_wrench, wrenches)):
        wrong.add("external_wrenches")
    return {key: value for key, value in posture.items() if key not in wrong}


def _is_wrench(value: Any) -> bool:
    """Whether a value is a table of vectors."""
    return isinstance(value, Mapping) and all(_is_vector(value[key]) for key in ("force", "moment", "point") if key in value)


def _is_vector(value: Any) -> bool:
    """Whether a value is three finite numbers."""
    numbers = isinstance(value, list | tuple) and len(value) == 3 and all(isinstance(x, int | float) for x in value)
    return bool(numbers and all(math.isfinite(x) for x in value))


def stamp_of(hash_: str, stated: Mapping[str, Any]) -> str:
    """Short digest of a record's question: its hash, and what the hash leaves out but the record repeats.

    Args:
        hash_: Of the case.
        stated: Its ``case``.
    """
    texts, expect = [str(stated.get(key, "")) for key in NOT_HASHED[:2]], stated.get("expect")
    rest = canonical_json(expect) if expect else "{}"
    return hashlib.sha256(repr([hash_, *texts, rest]).encode()).hexdigest()[:16]


def problem_stamp(problem: Problem, engine: str | Sequence[str]) -> str:
    """The stamp that the record of a problem will have.

    Args:
        problem: A single problem.
        engine: As for `solve`.
    """
    return stamp_of(problem_hash(problem, first_engine(engine)), problem.stated())
