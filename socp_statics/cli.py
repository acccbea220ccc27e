"""The command line: each verb calls one public function.

Only typer is imported here; what a verb needs is imported by the verb, so that ``--help`` answers at once.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from socp_statics.exceptions import InputError, StaticsError

if TYPE_CHECKING:
    from socp_statics.cases.problem import Problem
    from socp_statics.cases.record import Record

FIGURE_ENDINGS = (".pdf", ".png", ".svg")
KINDS = ("problems", "models", "postures", "robots")

app = typer.Typer(
    name="socp-statics",
    help="Statics of a robot in contact, with exact friction cones.",
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    add_completion=False,
)
ProblemArgument = Annotated[str, typer.Argument(metavar="PROBLEM", help="A named problem, or a path that ends in .toml.")]
SetOption = Annotated[list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Set a key of the problem; repeatable.")]
CaseOption = Annotated[int | None, typer.Option("--case", metavar="N", help="Which case of a [sweep], from 0.")]
EngineOption = Annotated[str, typer.Option("--engine", metavar="NAME", help="auto (Clarabel first), kernel, clarabel or cvxpy.")]


@app.callback(invoke_without_command=True)
def _start(
    context: typer.Context, version: Annotated[bool, typer.Option("--version", help="Print the version and exit.", is_eager=True)] = False
) -> None:
    if version:
        import socp_statics

        typer.echo(f"socp-statics {socp_statics.__version__}")
        raise typer.Exit
    if context.invoked_subcommand is None:
        typer.echo(context.get_help())


@app.command("list")
def list_names(
    kind: Annotated[str, typer.Argument(metavar="[problems|models|postures|robots]", help="What to list; all of them by default.")] = "",
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON: kind, then name and line.")] = False,
) -> None:
    """Names with one line each."""
    if kind and kind not in KINDS:
        from socp_statics.registry import nearest

        raise InputError(
            f"list: {kind!r} cannot be listed, one of {', '.join(KINDS)} is expected{nearest(kind, KINDS)}", name=kind, field="list"
        )
    tables = {word: _described(word) for word in ([kind] if kind else KINDS)}
    if as_json:
        typer.echo(json.dumps(tables[kind] if kind else tables, indent=1))
        return
    for word, table in tables.items():
        if not kind:
            typer.echo(f"{word}:")
        width = max(map(len, table), default=0)
        for name, line in table.items():
            typer.echo(f"{'' if kind else '  '}{name:<{width}}  {line}")


def _described(kind: str) -> dict[str, str]:
    if kind == "problems":
        from socp_statics.cases.named_problems import describe_problems

        return describe_problems()
    if kind == "models":
        from socp_statics.cases.answers import ANSWERS

        return ANSWERS.describe()
    if kind == "postures":
        from socp_statics.cases.generators import describe_generators

        return describe_generators()
    from socp_statics.robots import ROBOTS

    return ROBOTS.describe()


@app.command()
def show(
    problem: ProblemArgument,
    toml: Annotated[bool, typer.Option("--toml", help="Print a problem file to copy and edit.")] = False,
) -> None:
    """The expanded problem and the mathematical program that will be solved."""
    from socp_statics.cases.problem import load_problem
    from socp_statics.cases.toml_text import problem_toml

    loaded = load_problem(problem)
    typer.echo(problem_toml(loaded), nl=False)
    if toml:
        return
    from socp_statics.models.display import describe

    first = loaded.case(0)
    if loaded.sweep:
        typer.echo(f"\n[sweep] makes {loaded.case_count} cases; this is the program of case 0:")
    typer.echo(f"\n{describe(first.model, first.stance(), first.parameters)}")
    if first.robot_posture is not None:
        from socp_statics.statics.posture_types import posture_types

        typer.echo(f"\nposture types (Table 3.1)\n{posture_types(first.robot_posture).describe()}")


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

    loaded = _chosen_case(load_problem(problem), values or [], case)
    _check_engine(loaded, engine)
    _check_outputs(loaded, {"--json": None if record_file == "-" else record_file, "--figure": figure_file})
    _check_figure(record_file, figure_file)
    asked = _engines(engine)
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
    _check_expectations(loaded, record)


@app.command()
def view(
    problem: ProblemArgument,
    values: SetOption = None,
    case: CaseOption = None,
    engine: EngineOption = "auto",
    html_file: Annotated[str | None, typer.Option("--html", metavar="FILE", help="Write the view as one HTML file and exit.")] = None,
) -> None:
    """3-D view in the browser; drag the centre of mass and the answer follows."""
    from socp_statics.cases.problem import load_problem
    from socp_statics.cases.solve import solve as answer
    from socp_statics.exceptions import EngineError
    from socp_statics.viewer import LiveView, ask, require_viewer, save_page

    loaded = _chosen_case(load_problem(problem), values or [], case)
    _check_engine(loaded, engine)
    _check_outputs(loaded, {"--html": html_file})
    require_viewer()
    asked = _engines(engine)
    try:
        record = answer(loaded, asked)
        question = ask(loaded, record, asked)
    except EngineError as error:
        raise EngineError(f"{loaded.label}: {error}", name=loaded.label) from error
    if html_file is None:
        live = LiveView(question)
        typer.echo(f"{loaded.label} at {live.url}, until interrupted (Ctrl-C)")
        sys.stdout.flush()
        live.run()
        return
    try:
        save_page(question, html_file)
    except OSError as error:
        message = f"--html {html_file}: the view could not be written ({error.strerror})"
        raise StaticsError(message, name=html_file, field="--html") from error
    typer.echo(f"{loaded.label}, {record['verdict']}: written to {html_file}")
    _check_expectations(loaded, record)


def _check_expectations(problem: Problem, record: Record) -> None:
    from socp_statics.cases.solve import unmet

    failed = unmet(record)
    if failed:
        raise StaticsError(f"{problem.label}: {'; '.join(failed)}", name=problem.label, field="expect")


def _chosen_case(problem: Problem, assignments: Iterable[str], case: int | None) -> Problem:
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
    if case is not None:
        return problem.case(case)
    problem.require_single()
    return problem


def _check_engine(problem: Problem, engine: str) -> None:
    from socp_statics.cases.solve import first_engine

    try:
        first_engine(engine)
    except InputError as error:
        raise InputError(f"{problem.label}: --engine: {error}", name=engine, field="--engine") from error


def _engines(engine: str) -> str | Sequence[str]:
    from socp_statics.engines import SINGLE

    return SINGLE if engine == "auto" else engine


def _check_outputs(problem: Problem, files: Mapping[str, str | None]) -> None:
    from socp_statics.cases.writing import check_writable

    for option, file in files.items():
        if file is None:
            continue
        check_writable(Path(file), option)
        if problem.path is not None and Path(file).exists() and Path(file).samefile(problem.path):
            raise InputError(f"{option} {file}: this is the problem file itself, another file is expected", name=file, field=option)


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


def main(arguments: list[str] | None = None) -> int:
    """Run the command line.

    Args:
        arguments: Without the program's name; those of the process by default.

    Returns:
        0: the question was answered. 1: the computation or an expectation failed. 2: the input is wrong. On 1 and 2 the last line
        of standard error is one plain sentence.
    """
    try:
        status = app(args=arguments, standalone_mode=False, prog_name="socp-statics")
        sys.stdout.flush()
        return status if isinstance(status, int) else 0
    except InputError as error:
        return _say(error, 2)
    except StaticsError as error:
        return _say(error, 1)
    except typer.TyperException as error:
        return _say(f"{error.format_message().rstrip('.')}; socp-statics --help says what is expected", 2)
    except typer.Abort:
        return _say("interrupted", 1)
    except BrokenPipeError:
        # whoever read our output has enough; Python would complain again when it flushes at exit
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0


def _say(message: object, status: int) -> int:
    print(" ".join(str(message).split()), file=sys.stderr)
    return status


def entry_point() -> None:
    """The console script ``socp-statics``."""
    sys.exit(main())
