"""The verb ``run``: many answers, kept in a folder."""

from __future__ import annotations

from typing import Annotated

import typer

from socp_statics.cli.app import SetOption, app
from socp_statics.exceptions import StaticsError


@app.command()
def run(
    selectors: Annotated[
        list[str] | None,
        typer.Argument(metavar="SELECTOR", help="Names, globs, families, folders, paths that end in .toml; all by default."),
    ] = None,
    values: SetOption = None,
    engine: Annotated[str, typer.Option("--engine", metavar="NAME", help="auto (the kernel first), kernel, clarabel or cvxpy.")] = "auto",
    workers: Annotated[str | None, typer.Option("--workers", metavar="N", help="Processes, one a processor by default.")] = None,
    scheduler: Annotated[str | None, typer.Option("--scheduler", metavar="ADDRESS", help="Use the workers of a Dask cluster.")] = None,
    out: Annotated[str, typer.Option("--out", metavar="DIR", help="Folder of the records.")] = "runs",
    quiet: Annotated[bool, typer.Option("--quiet", help="Say nothing unless something is wrong.")] = False,
    rerun: Annotated[bool, typer.Option("--rerun", help="Compute again what is there.")] = False,
    yes: Annotated[bool, typer.Option("--yes", help="More than 100000 cases are meant.")] = False,
) -> None:
    """Many answers, kept in a folder.

    Sweeps are expanded; a later run goes on where one stopped.
    """
    from socp_statics.cases.dotted import key_text, parse_assignment
    from socp_statics.runner import run as run_problems

    assigned = {key_text(parts): value for parts, value in (parse_assignment(text) for text in values or [])}
    try:
        done = run_problems(
            selectors or [], out, values=assigned, engine=engine, workers=workers, scheduler=scheduler, rerun=rerun, yes=yes, quiet=quiet
        )
    except KeyboardInterrupt:
        message = f"interrupted: what was finished is kept in {out}, the same command goes on"
        raise StaticsError(message, name=out, field="--out") from None
    if not quiet:
        rate = f" in {done.seconds:.1f} s, {done.computed / done.seconds:.3g} a second" if done.computed and done.seconds else ""
        failed = f", {done.failed} failed" if done.failed else ""
        cases = f"{done.cases} case{'s' if done.cases != 1 else ''}"
        typer.echo(f"{cases}: {done.computed} computed{rate}, {done.kept} were there{failed}; records in {out}")
        if done.stale:
            plural, they = ("s", "they hold") if done.stale != 1 else ("", "it holds")
            typer.echo(f"{done.stale} earlier record{plural} became stale; {they} again where the same is asked again")
    if done.failed:
        message = f"{done.first_failure}: failed{f', and {done.failed - 1} more' if done.failed > 1 else ''}"
        raise StaticsError(f"{message}; socp-statics report {out} says why", name=done.first_failure)
    if done.unmet:
        message = f"{done.first_failure}: [expect] does not hold{f', nor that of {done.unmet - 1} more' if done.unmet > 1 else ''}"
        raise StaticsError(f"{message}; socp-statics report {out} says which", name=done.first_failure, field="expect")
