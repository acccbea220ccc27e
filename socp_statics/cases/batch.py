"""Many problems at once: each gets the record that `solve` gives it, those of one kind by one call of the kernel."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from socp_statics.cases.answers import ANSWERS
from socp_statics.cases.hashing import NOT_HASHED, SCHEMA, canonical_json, case_hash
from socp_statics.cases.problem import Problem
from socp_statics.cases.record import Record
from socp_statics.cases.solve import failed_record, first_engine, no_answer, problem_hash, record_of, solve
from socp_statics.exceptions import InputError, StaticsError


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
        record = refused_record(problem.name, problem.raw, engine, str(error), problem.number, problem.swept)
    except StaticsError as error:
        record = failed_record(problem, engine, str(error))
    except Exception as error:  # a mistake of ours in one of thousands of cases is that case's failure, with its reason
        record = failed_record(problem, engine, f"unexpected {type(error).__name__}: {error}")
    return Answered(record, time.perf_counter() - began)


def refused_record(
    name: str, tables: Mapping[str, Any], engine: str | Sequence[str], reason: str, number: int | None, values: Mapping[str, Any],
    failure: str = "input",
) -> Record:  # fmt: skip
    """The record of a case that has no stance: its input is wrong, or its process died.

    Args:
        name: Of the problem.
        tables: What its file says, the values of the case set.
        engine: As for `solve`.
        reason: Why there is no answer.
        number: Which case of a sweep it is, None where it is none.
        values: Dotted key -> value of that case.
        failure: "input" or "process".
    """
    stated = {key: value for key, value in tables.items() if key != "sweep"}
    first = first_engine(engine)
    return Record(
        {
            "schema": SCHEMA,
            "problem": name,
            "model": str(tables.get("model")),
            "hash": case_hash(stated, first),
            **({} if number is None else {"sweep": {"case": number, "values": values}}),
            "case": {"description": "", "reference": "", "expect": {}} | stated | {"generated": {}},
            **no_answer(first, reason),
            "failure_kind": failure,
        }
    )


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
