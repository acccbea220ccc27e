"""The verb ``compare``: linearised against exact cones."""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from socp_statics.cli.app import CaseOption, ProblemArgument, SetOption, app
from socp_statics.cli.arguments import case_or_sweep, check_outputs
from socp_statics.exceptions import EngineError, InputError, StaticsError

if TYPE_CHECKING:
    from socp_statics.comparison import Comparison

FIGURE_ENDINGS = (".pdf", ".png", ".svg")
TABLE_ENDINGS = (".csv", ".md")
SidesOption = Annotated[str, typer.Option("--sides", metavar="LIST", help="Numbers of sides, with commas between them.")]
HeadingsOption = Annotated[str, typer.Option("--headings", metavar="N", help="Headings of each pyramid; a sweep has the problem's alone.")]


@app.command()
def compare(
    problem: ProblemArgument,
    sides: SidesOption = "3,4,6,8,16,32",
    headings: HeadingsOption = "8",
    values: SetOption = None,
    case: CaseOption = None,
    json_file: Annotated[str | None, typer.Option("--json", metavar="FILE", help="Write the comparison; - prints only it.")] = None,
    table_file: Annotated[str | None, typer.Option("--table", metavar="FILE", help="Write the table with times (.csv or .md).")] = None,
    figure_file: Annotated[str | None, typer.Option("--figure", metavar="FILE", help="Draw it (.pdf, .png or .svg).")] = None,
) -> None:
    """Linearised against exact cones.

    One stance is compared by its values, a sweep by its rates of false verdicts.
    """
    from socp_statics.cases.problem import load_problem
    from socp_statics.comparison import compare as compare_problem
    from socp_statics.comparison.pyramids import checked_headings, checked_sides

    loaded = case_or_sweep(load_problem(problem), values or [], case)
    try:
        asked, turns = checked_sides(_numbers(sides), "--sides"), checked_headings(_whole(headings), "--headings")
    except InputError as error:
        raise InputError(f"{loaded.label}: {error}", name=error.name, field=error.field) from error
    files = {"--json": None if json_file == "-" else json_file, "--table": table_file, "--figure": figure_file}
    check_outputs(loaded, files)
    _check_endings(files)
    try:
        found = compare_problem(loaded, asked, turns, threads=os.cpu_count() or 1)
    except EngineError as error:
        raise EngineError(f"{loaded.label}: {error}", name=loaded.label) from error
    if json_file == "-":
        typer.echo(found.to_json(), nl=False)
    else:
        _say(found)
    _write(found, files)


def _numbers(sides: str) -> list[int]:
    parts = [part.strip() for part in sides.split(",")]
    for part in parts:
        if not re.fullmatch(r"\d{1,9}", part):
            message = f"--sides: whole numbers from 3 on with commas between them are expected, as 3,4,8, got {part or sides!r}"
            raise InputError(message, name=sides, field="--sides")
    return [int(part) for part in parts]


def _whole(headings: str) -> int | str:
    """A number where it is one; what is none is refused by who knows which are expected."""
    return int(headings) if re.fullmatch(r"-?\d{1,9}", headings, re.ASCII) else headings


def _check_endings(files: Mapping[str, str | None]) -> None:
    """Refuse endings that say nothing, and one file for two outputs."""
    for option, endings in (("--table", TABLE_ENDINGS), ("--figure", FIGURE_ENDINGS)):
        file = files[option]
        if file is not None and Path(file).suffix.lower() not in endings:
            raise InputError(f"{option} {file}: a file that ends in {', '.join(endings)} is expected", name=file, field=option)
    seen: dict[str, str] = {}
    for option, file in files.items():
        if file is not None and seen.setdefault(os.path.realpath(file), option) != option:
            message = f"{option} {file}: {seen[os.path.realpath(file)]} names the same file, two files are expected"
            raise InputError(message, name=file, field=option)


def _say(found: Comparison) -> None:
    from socp_statics.comparison.sentences import time_sentence
    from socp_statics.comparison.tables import printed_tables

    typer.echo(f"{found['problem']}, {found['model']}: the exact cone beside pyramids\n")
    for title, head, rows in printed_tables(found, found.times):
        typer.echo(title)
        widths = [max(len(row[k]) for row in (head, *rows)) for k in range(len(head))]
        for row in (head, *rows):
            typer.echo("  " + "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip())
        typer.echo()
    for name, reason in found.get("left_out", {}).items():
        typer.echo(f"{name} is left out: {reason}\n")
    typer.echo(found["answer"])
    if found.times:
        typer.echo(time_sentence(found.times, found["sides"]))


def _write(found: Comparison, files: Mapping[str, str | None]) -> None:
    from socp_statics.figures import save_comparison

    writers = {"--json": found.write, "--table": found.write_table, "--figure": lambda path: save_comparison(found, path, found.times)}
    for option, file in files.items():
        if file is None:
            continue
        try:
            writers[option](file)
        except OSError as error:
            message = f"{option} {file}: the comparison could not be written ({error.strerror})"
            raise StaticsError(message, name=file, field=option) from error
