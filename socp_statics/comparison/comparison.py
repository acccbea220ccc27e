"""A problem with the exact cone beside pyramids: one stance by four quantities, a sweep by rates of false verdicts."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from socp_statics.cases.problem import Problem, require_problem
from socp_statics.cases.record import Record
from socp_statics.cases.solve import versions
from socp_statics.cases.writing import finished_or_absent
from socp_statics.comparison.population import Population, judge_problem, judge_records
from socp_statics.comparison.pyramids import HEADINGS, SIDES, checked_headings, checked_sides
from socp_statics.comparison.rates import population_tables
from socp_statics.comparison.sentences import population_sentence, stance_sentence
from socp_statics.comparison.stance import compared_stance
from socp_statics.comparison.tables import csv_table, markdown_table
from socp_statics.comparison.times import Timed, times
from socp_statics.exceptions import InputError

SCHEMA = 1
MODELS = ("equilibrium", "contact_forces", "minimax_wrench", "support_region")
TABLES = {".csv": csv_table, ".md": markdown_table}


class Comparison(Record):
    """What pyramids cost: a mapping of plain JSON values laid out as a record is, the same bytes for the same input.

    ``comparison`` says which of two kinds it is. "stance": ``exact``, ``pyramids``, ``spread``, ``sides_for_one_percent``,
    ``regions``, ``left_out`` (see `stance.compared_stance`). "population": ``stances``, ``verdicts``, ``rates``, ``areas``,
    ``sides_for_one_percent`` (see `rates.population_tables`). Both: ``problem``, ``model``, ``case``, ``sides``, ``answer`` (one
    sentence), ``versions``. Times are no part of it.

    Args:
        entries: The keys.
        times: Times of every way to an answer.
    """

    def __init__(self, entries: Mapping[str, Any], times: Iterable[Timed] = ()):
        super().__init__(entries)
        self.times = tuple(times)

    def __repr__(self) -> str:
        return f"Comparison({self.get('problem')!r}, {self.get('comparison')!r})"

    def write_table(self, path: str | Path) -> None:
        """Write values, errors and times as a table; the file is complete or not there.

        Args:
            path: A name that ends in .csv or .md.

        Raises:
            InputError: It ends otherwise.
        """
        ending = Path(path).suffix.lower()
        if ending not in TABLES:
            raise InputError(f"table {path}: a file that ends in {' or '.join(TABLES)} is expected", name=str(path), field="path")
        with finished_or_absent(Path(path)) as draft:
            draft.write_text(TABLES[ending](self, self.times), encoding="utf-8")


def compare(
    problem: Problem, sides: Sequence[int] = SIDES, headings: int = HEADINGS, *, threads: int = 1, with_times: bool = True
) -> Comparison:
    """A problem with the exact cone and with inscribed and circumscribed pyramids.

    Args:
        problem: Of model equilibrium, contact_forces, minimax_wrench or support_region; a ``[sweep]`` is compared as a population.
        sides: Numbers of sides, each at least 3 and given once.
        headings: Of a single stance: how many headings of each pyramid. In a population pyramids have the problem's heading.
        threads: Of a population: how many threads work at the same time; the answers do not depend on it.
        with_times: Of a single stance: whether to measure how long each way to an answer takes.

    Returns:
        The comparison.

    Raises:
        InputError: It is no problem, the model cannot be compared, sides or headings are wrong, or a case is.
        EngineError: No engine settled an answer, or a pyramid came out on the wrong side of the cone.
    """
    require_problem(problem)
    if problem.model not in MODELS:
        message = f"{problem.label}: model {problem.model!r} cannot be compared with pyramids, one of {', '.join(MODELS)} is expected"
        raise InputError(message, name=problem.label, field="model")
    sides, headings = checked_sides(sides), checked_headings(headings)
    try:
        if problem.sweep:
            return _of_population(judge_problem(problem, sides, threads=threads), problem)
        return _of_stance(problem, sides, headings, with_times)
    except InputError as error:
        if str(error).startswith(problem.label):
            raise
        raise InputError(f"{problem.label}: {error}", name=problem.label, field=error.field) from error


def compare_records(records: Iterable[Mapping[str, Any]], by: Sequence[str] = ("family", "friction", "slope")) -> Comparison:
    """The rates and areas of a population from records with different cones, for example of `run` and `load_results`.

    Args:
        records: An iterable of records; of each only verdict and area are kept.
        by: Keys of ``[posture]`` to compare by, dotted.

    Raises:
        InputError: No record has the exact cone, or none a pyramid.
        EngineError: A pyramid came out on the wrong side of the cone.
    """
    return _of_population(judge_records(records, by), None)


def _of_stance(problem: Problem, sides: Sequence[int], headings: int, with_times: bool) -> Comparison:
    stance, parameters = problem.stance(), problem.parameters
    keys = compared_stance(stance, parameters, sides, headings)
    timed = times(stance, parameters, list(keys["exact"]), sides, parameters.get("heading", 0.0)) if with_times else []
    generated = {"contacts": [contact.statement() for contact in stance.contacts], "com": stance.com, "mass": stance.mass}
    head = _head("stance", problem, problem.stated() | {"generated": generated}) | {"sides": sides, "headings": headings}
    return Comparison(head | {"answer": stance_sentence(keys, sides)} | keys | {"versions": versions(stance.posture is not None)}, timed)


def _of_population(population: Population, problem: Problem | None) -> Comparison:
    tables = population_tables(population)
    sides = sorted({sides for _, sides in population.pyramids})
    stated = None if problem is None else problem.stated() | {"sweep": {key: _swept(values) for key, values in problem.sweep.items()}}
    robot = problem is not None and problem.robot_posture is not None
    head = _head("population", problem, stated) | {"sides": sides, "by": list(population.circumstances)}
    return Comparison(head | {"answer": population_sentence(tables, sides)} | tables | {"versions": versions(robot)})


def _head(kind: str, problem: Problem | None, case: Mapping[str, Any] | None) -> dict[str, Any]:
    name, model = (None, None) if problem is None else (problem.name, problem.model)
    return {"schema": SCHEMA, "comparison": kind, "problem": name, "model": model, "case": case}


def _swept(values: Sequence[Any]) -> Any:
    return {"from": values[0], "to": values[-1]} if isinstance(values, range) else list(values)
