"""A problem: what a TOML file asks, validated, with defaults filled in."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from socp_statics.cases.dotted import parse_key, resolve, with_value
from socp_statics.cases.named_problems import problem_path
from socp_statics.cases.problem_text import read_toml
from socp_statics.cases.robot_posture import robot_stance
from socp_statics.cases.robotless import robotless_stance
from socp_statics.cases.schema import read_problem, swept_tables
from socp_statics.cases.sweep import Values, case_count, case_values, flatten_keys, is_range
from socp_statics.cones.choice import ConeChoice
from socp_statics.contacts import Stance
from socp_statics.exceptions import InputError
from socp_statics.postures import Posture


@dataclass(frozen=True, eq=False)
class Problem:
    """One question, or with a ``[sweep]`` the product of many; immutable.

    Attributes:
        name: Name under ``problems/``, or the file's name without ``.toml``.
        label: The file as the user wrote it, for sentences.
        description: One sentence.
        model: Which answer is asked for.
        reference: Paper, figure or equation.
        posture: ``[posture]`` with defaults filled in; of the first case when there is a sweep.
        parameters: ``[parameters]`` with defaults filled in; of the first case when there is a sweep.
        sweep: Dotted key -> values; empty for a single problem.
        expect: Dotted key of the record -> value, tolerance, source.
        path: The file, None when the problem was not read from one.
        robot_posture: The posture of the robot, None where there is no robot; of the first case when there is a sweep.
        raw: The tables as they were written.
        number: Which case of a sweep this is, None where it is none.
        swept: Dotted key -> value of that case.
    """

    name: str
    label: str
    description: str
    model: str
    reference: str
    posture: dict[str, Any]
    parameters: dict[str, Any]
    sweep: dict[str, Values]
    expect: dict[str, dict[str, Any]]
    path: Path | None
    robot_posture: Posture | None
    raw: Mapping[str, Any] = field(repr=False)
    number: int | None = None
    swept: Mapping[str, Any] = field(default_factory=dict, repr=False)

    def stance(self) -> Stance:
        """Contacts, centre of mass, mass and loads; with a robot also its posture and, if they are in force, its torque limits.

        Raises:
            InputError: The problem is a sweep, which has as many stances as cases.
        """
        self.require_single()
        if self.robot_posture is not None:
            return robot_stance(self.robot_posture, self.posture, self.parameters["torque_limits"])
        return robotless_stance(self.posture)

    @property
    def cone(self) -> ConeChoice:
        """Exact cones or the pyramid asked for."""
        return ConeChoice(self.parameters["cone"], self.parameters.get("sides"), self.parameters.get("heading"))

    def stated(self) -> dict[str, Any]:
        """The problem as tables with defaults filled in, without its sweep: the ``case`` of a record."""
        texts = {"description": self.description, "model": self.model, "reference": self.reference}
        return texts | {"posture": self.posture, "parameters": self.parameters, "expect": self.expect}

    @property
    def case_count(self) -> int:
        """Number of cases, 1 without a sweep."""
        return case_count(self.sweep)

    def case(self, number: int) -> Problem:
        """One case of the sweep, counted from 0, the last key changing fastest.

        Args:
            number: 0 is also the number of a problem without a sweep.

        Raises:
            InputError: There is no such case, or its values are wrong.
        """
        try:
            values = case_values(self.sweep, number)
        except InputError as error:
            raise InputError(f"{self.label}: {error}", name=self.label, field="--case") from error
        if not values:
            return self
        label = f"{self.label} case {number}"
        read = problem_from_tables(swept_tables(self.raw, self.sweep, number), self.name, label=label, path=self.path)
        return replace(read, number=number, swept=values)

    def cases(self) -> Iterator[Problem]:
        """All cases of the sweep in order; the problem itself without one."""
        return (self.case(number) for number in range(self.case_count))

    def with_values(self, values: Mapping[str, Any], origin: str = "--set") -> Problem:
        """The problem with some of its keys set; a key set here is no longer swept.

        Args:
            values: Dotted key -> value, as ``{"posture.contacts.left_foot.friction": 0.4}``.
            origin: Who set them, for the error sentence.

        Raises:
            InputError: A key is not known or its value is wrong.
        """
        try:
            raw = self._raw_with(values, origin)
        except InputError as error:
            raise InputError(f"{self.label}: {error}", name=self.label, field=error.field) from error
        label = f"{self.label} with {origin} {', '.join(values)}" if values else self.label
        return problem_from_tables(raw, self.name, label=label, path=self.path)

    def _raw_with(self, values: Mapping[str, Any], origin: str) -> dict[str, Any]:
        raw, set_here = dict(self.raw), set()
        for key, value in values.items():
            parts = parse_key(key, origin)
            raw = with_value(raw, parts, value, origin)
            set_here.add(resolve(raw, parts, origin))
        if isinstance(raw.get("sweep"), Mapping):
            stated = flatten_keys(raw.pop("sweep"), is_range)
            swept = {key: value for key, value in stated.items() if resolve(raw, parse_key(key, "sweep"), "sweep") not in set_here}
            raw |= {"sweep": swept} if swept else {}
        return raw

    def require_single(self) -> None:
        """Refuse a problem that is still a sweep.

        Raises:
            InputError: Naming ``--case`` and the number of cases.
        """
        if self.sweep:
            last = self.case_count - 1
            message = (
                f"{self.label}: [sweep] makes {last + 1} cases, choose one with --case 0 to {last} (in Python problem.case(0) to "
                f"problem.case({last}); the last key changes fastest), or run them all with socp-statics run (socp_statics.run)"
            )
            raise InputError(message, name=self.label, field="--case")


def problem_from_tables(tables: Mapping[str, Any], name: str, *, label: str | None = None, path: Path | None = None) -> Problem:
    """A problem from nested tables.

    Args:
        tables: What a TOML file holds.
        name: What to call it in records.
        label: What to call it in sentences, the name by default.
        path: The file it came from.

    Raises:
        InputError: One sentence that names every fault by its key path.
    """
    label = label or name
    read = read_problem(tables, label, None if path is None else path.parent)
    return Problem(
        name=name,
        label=label,
        description=read.top.description,
        model=read.top.model,
        reference=read.top.reference,
        posture=read.posture,
        parameters=read.parameters,
        sweep=read.sweep,
        expect=read.expect,
        path=path,
        robot_posture=read.robot_posture,
        raw=tables,
    )


def require_problem(problem: Any, argument: str = "problem") -> None:
    """Refuse what is no problem, and say how one is made.

    Args:
        problem: What was given.
        argument: What it was given for.

    Raises:
        InputError: It is not a `Problem`.
    """
    if not isinstance(problem, Problem):
        text = isinstance(problem, str | Path)
        made = f"load_problem({str(problem)!r}) makes one" if text else f"load_problem makes one, got {type(problem).__name__}"
        raise InputError(f"{argument}: a Problem is expected, {made}", name=str(problem), field=argument)


def load_problem(name_or_path: str | Path) -> Problem:
    """Read and validate a problem.

    Args:
        name_or_path: A name under ``problems/`` such as ``"contacts/flat_double_stance"``, or a path that ends in ``.toml``.

    Raises:
        InputError: There is no such problem, or the file is wrong; the sentence names the file and every key.
    """
    if not isinstance(name_or_path, str | Path):
        message = f"name_or_path: the name of a problem or a path that ends in .toml is expected, got {name_or_path!r}"
        raise InputError(message, name=str(name_or_path), field="name_or_path")
    text = str(name_or_path)
    if isinstance(name_or_path, Path) or text.endswith(".toml"):
        path, name = Path(name_or_path), Path(name_or_path).stem
    else:
        path, name = problem_path(text), text
    return problem_from_tables(read_toml(path, text), name, label=text, path=path)
