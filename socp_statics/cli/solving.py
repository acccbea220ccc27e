"""The verb ``solve``: one answer, its record and its figure."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from socp_statics.cli.app import CaseOption, EngineOption, ProblemArgument, SetOption, app
from socp_statics.cli.arguments import check_engine, check_expectations, check_outputs, chosen_case, engines_of
from socp_statics.exceptions import InputError, StaticsError

if TYPE_CHECKING:
    from socp_statics.cases.problem import Problem
    from socp_statics.cases.record import Record

FIGURE_ENDINGS = (".pdf", ".png", ".svg")


@app.command()
def solve(
    problem: ProblemArgument,
    values: SetOption = None,
    case: CaseOption = None,
    engine: EngineOption = "auto",
    record_file: Annotated[str | None, typer.Option("--json", metavar="FILE", help="Write the record; - prints only the record.")] = None,
    figure_file: Annotated[str | None, typer.Option("--figure", metavar="FILE", help="Draw the answer (.pdf, .png or .svg).")] = None,
) -> None:
    """One answer, short and human."""
    from socp_statics.cases import solve as solving
    from socp_statics.cases.problem import load_problem
    from socp_statics.cases.summary import summarise
    from socp_statics.exceptions import EngineError

    loaded = chosen_case(load_problem(problem), values or [], case)
    check_engine(loaded, engine)
    check_outputs(loaded, {"--json": None if record_file == "-" else record_file, "--figure": figure_file})
    _check_figure(record_file, figure_file)
    asked = engines_of(engine)
    try:
        record = solving.solve(loaded, asked)
    except EngineError as error:
        _write_record(solving.failed_record(loaded, asked, str(error)), record_file)
        raise EngineError(f"{loaded.label}: {error}", name=loaded.label) from error
    _write_record(record, record_file)
    if figure_file is not None:
        _draw(loaded, record, Path(figure_file), asked)
    if record_file != "-":
        typer.echo(summarise(record))
    check_expectations(loaded, record)


def _check_figure(record_file: str | None, figure_file: str | None) -> None:
    if figure_file is not None and Path(figure_file).suffix.lower() not in FIGURE_ENDINGS:
        message = f"--figure {figure_file}: a file that ends in {', '.join(FIGURE_ENDINGS)} is expected"
        raise InputError(message, name=figure_file, field="--figure")
    if figure_file is not None and record_file not in (None, "-") and os.path.realpath(record_file) == os.path.realpath(figure_file):
        raise InputError(f"--figure {figure_file}: --json names the same file, two files are expected", name=figure_file, field="--figure")


def _write_record(record: Record, file: str | None) -> None:
    if file == "-":
        typer.echo(record.to_json(), nl=False)
    elif file is not None:
        try:
            record.write(file)
        except OSError as error:
            raise StaticsError(f"--json {file}: the record could not be written ({error.strerror})", name=file, field="--json") from error


def _draw(problem: Problem, record: Record, path: Path, engine: str | Sequence[str]) -> None:
    from socp_statics.cases.solve import shown_stance
    from socp_statics.cases.writing import finished_or_absent
    from socp_statics.comparison import compare_regions
    from socp_statics.figures import save_figure

    regions: Mapping[str, object] | None
    stance = shown_stance(problem, record)
    try:
        regions = compare_regions(stance, problem.parameters.get("tolerance", 1e-3), engine=engine)
    except InputError:
        # without gravity along z there is no region to draw beside the contacts
        regions = None
    try:
        with finished_or_absent(path) as draft:
            save_figure(record, draft, regions=regions, posture=stance.posture)
    except OSError as error:
        raise StaticsError(
            f"--figure {path}: the figure could not be written ({error.strerror})", name=str(path), field="--figure"
        ) from error
