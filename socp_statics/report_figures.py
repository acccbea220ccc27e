"""The report figures: each is a script in ``paper_figures/`` that draws records of named problems and words its caption from them."""

from __future__ import annotations

import importlib.util
import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

from socp_statics.cases.named_problems import problems_folder
from socp_statics.cases.problem import Problem, load_problem, problem_from_tables
from socp_statics.cases.record import Record
from socp_statics.cases.solve import solve
from socp_statics.cases.writing import finished_or_absent
from socp_statics.contacts import Stance
from socp_statics.engines import SINGLE
from socp_statics.exceptions import InputError, StaticsError
from socp_statics.figures.figure_file import write_figure
from socp_statics.figures.style import house_style
from socp_statics.registry import nearest
from socp_statics.runner import load_results, stale_problems

ENDINGS = (".pdf", ".png")


class Need(NamedTuple):
    """A problem whose records a figure draws.

    Attributes:
        problem: Its name; a sweep gives one record for each case.
        values: Dotted key -> value, as ``--set`` takes them.
    """

    problem: str
    values: Mapping[str, Any] = {}

    def stated(self) -> Problem:
        """The problem with these values."""
        problem = load_problem(self.problem)
        return problem.with_values(self.values, "a report figure's") if self.values else problem


class Kept(NamedTuple):
    """A file of ``results/`` that takes too long to make for one figure.

    Attributes:
        file: Its name there.
        command: What makes it.
    """

    file: str
    command: str

    @property
    def path(self) -> Path:
        """Where the file is."""
        return problems_folder().parent / "results" / self.file

    def read(self) -> Any:
        """What the file holds.

        Raises:
            InputError: It is not there, or is no JSON.
        """
        try:
            return json.loads(self.path.read_text(encoding="utf-8"))
        except (OSError, ValueError) as error:
            message = f"figures: results/{self.file} is expected, made by: {self.command}"
            raise InputError(message, name=self.file, field="figures") from error


def scripts_folder() -> Path:
    """Where the scripts are.

    Raises:
        InputError: This is no checkout; an installed package has no report figures.
    """
    folder = problems_folder().parent / "paper_figures"
    if not folder.is_dir():
        raise InputError("figures: the report figures are made in a checkout, there is no folder paper_figures here", name="figures")
    return folder


def figure_names() -> list[str]:
    """Names of the report figures, sorted."""
    return sorted(path.stem for path in scripts_folder().glob("*.py"))


def figure_script(name: str) -> ModuleType:
    """The script of a figure: ``NEEDS`` (key -> `Need` or `Kept`), ``draw(records)`` and ``caption(records)``.

    Args:
        name: Of the figure.

    Raises:
        InputError: There is no such figure.
    """
    names = figure_names()
    if name not in names:
        message = f"figures: there is no report figure {name!r}{nearest(name, names) or f', one of {chr(44).join(names)} is expected'}"
        raise InputError(message, name=name, field="figures")
    spec = importlib.util.spec_from_file_location(f"paper_figures.{name}", scripts_folder() / f"{name}.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def figure_records(script: ModuleType) -> dict[str, Any]:
    """The records a figure draws: those of ``results/`` where they are current, else the problems are solved.

    Args:
        script: Of `figure_script`.

    Returns:
        The keys of its ``NEEDS`` with a record for each case, or with what the file kept in ``results/`` holds.

    Raises:
        InputError: A file that is kept in ``results/`` is not there.
        EngineError: A problem could not be solved.
    """
    return {key: need.read() if isinstance(need, Kept) else _kept(need) or _solved(need) for key, need in script.NEEDS.items()}


def _kept(need: Need) -> list[Record]:
    """The records of a named problem in ``results/``, none if they are not there or no longer those of the problem."""
    folder = problems_folder().parent / "results"
    if need.values or not (folder / "manifest.jsonl").exists() or stale_problems(folder, [need.problem]):
        return []
    return load_results(folder).of(need.problem)


def _solved(need: Need) -> list[Record]:
    return [solve(case, SINGLE) for case in need.stated().cases()]


def stance_of(record: Mapping[str, Any]) -> Stance:
    """The stance that a record states, with its robot if it has one."""
    stated = {key: value for key, value in record["case"].items() if key != "generated"}
    return problem_from_tables(stated, str(record["problem"])).stance()


def make_figures(names: Iterable[str] = (), out: Path | None = None) -> list[Path]:
    """Draw report figures into PDF and PNG files with a caption beside each; the same records give the same bytes.

    Args:
        names: Of the figures; all of them by default.
        out: The folder to write to, made if it does not exist; ``paper_figures/made`` of the checkout by default.

    Returns:
        The files written.

    Raises:
        InputError: There is no such figure, or the folder is a file.
        StaticsError: A file could not be written.
    """
    chosen = list(names) or figure_names()
    scripts = {name: figure_script(name) for name in chosen}
    folder = scripts_folder() / "made" if out is None else out
    written: list[Path] = []
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        message = f"--out {folder}: a folder that can be written is expected ({error.strerror})"
        raise InputError(message, name=str(folder), field="--out") from error
    try:
        for name, script in scripts.items():
            written += _make(name, script, folder)
    except OSError as error:
        raise StaticsError(f"figures: {folder}: a file could not be written ({error.strerror})", name=str(folder)) from error
    return written


def _make(name: str, script: ModuleType, folder: Path) -> list[Path]:
    records = figure_records(script)
    paths = [folder / f"{name}{ending}" for ending in ENDINGS]
    with house_style():
        figure = script.draw(records)
    for path in paths:
        write_figure(figure, path, name)
    caption = folder / f"{name}.txt"
    with finished_or_absent(caption) as draft:
        draft.write_text(" ".join(script.caption(records).split()) + "\n", encoding="utf-8")
    return [*paths, caption]
