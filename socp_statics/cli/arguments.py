"""What the arguments of several verbs mean: the case of a problem, its engines, files that can be written, expectations that hold."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from socp_statics.exceptions import InputError, StaticsError

if TYPE_CHECKING:
    from socp_statics.cases.problem import Problem
    from socp_statics.cases.record import Record


def check_expectations(problem: Problem, record: Record) -> None:
    """Raise :class:`StaticsError` (exit status 1) where the record does not hold what the file expects."""
    from socp_statics.cases.solve import unmet

    failed = unmet(record)
    if failed:
        raise StaticsError(f"{problem.label}: {'; '.join(failed)}", name=problem.label, field="expect")


def chosen_case(problem: Problem, assignments: Iterable[str], case: str | None) -> Problem:
    """The one case that ``--set`` and ``--case`` leave of a problem; :class:`InputError` if there are several."""
    problem = case_or_sweep(problem, assignments, case)
    problem.require_single()
    return problem


def case_or_sweep(problem: Problem, assignments: Iterable[str], case: str | None) -> Problem:
    """What ``--set`` and ``--case`` leave of a problem, one case or a sweep."""
    from socp_statics.cases.dotted import key_text, parse_assignment

    values = {}
    for text in assignments:
        try:
            parts, value = parse_assignment(text)
        except InputError as error:
            raise InputError(f"{problem.label}: {error}", name=problem.label, field="--set") from error
        values[key_text(parts)] = value
    if values:
        problem = problem.with_values(values)
    if case is None:
        return problem
    if not re.fullmatch(r"\s*[+-]?\d{1,18}\s*", case, re.ASCII):
        message = f"{problem.label}: --case must be a whole number from 0 to {problem.case_count - 1}, got {case!r}"
        raise InputError(message, name=case, field="--case")
    return problem.case(int(case))


def check_engine(problem: Problem, engine: str) -> None:
    """Refuse an ``--engine`` that is not one, in the problem's name."""
    from socp_statics.cases.solve import first_engine

    try:
        first_engine(engine)
    except InputError as error:
        raise InputError(f"{problem.label}: --engine: {error}", name=engine, field="--engine") from error


def engines_of(engine: str) -> str | Sequence[str]:
    """The engines to ask in turn: a single answer never waits for a compiler unless the kernel is named."""
    from socp_statics.engines import SINGLE

    return SINGLE if engine == "auto" else engine


def check_outputs(problem: Problem, files: Mapping[str, str | None]) -> None:
    """Refuse output files, by option, that cannot be written or are the problem itself."""
    from socp_statics.cases.writing import check_writable

    for option, file in files.items():
        if file is None:
            continue
        check_writable(Path(file), option)
        if problem.path is not None and Path(file).exists() and Path(file).samefile(problem.path):
            raise InputError(f"{option} {file}: this is the problem file itself, another file is expected", name=file, field=option)
