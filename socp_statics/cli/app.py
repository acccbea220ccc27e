"""The application every verb joins, and the arguments that several verbs share."""

from __future__ import annotations

from typing import Annotated

import typer

app = typer.Typer(
    name="socp-statics",
    help="Statics of a robot in contact, with exact friction cones.",
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    add_completion=False,
)
ProblemArgument = Annotated[str, typer.Argument(metavar="PROBLEM", help="A named problem, or a path that ends in .toml.")]
SetOption = Annotated[list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Set a key of the problem; repeatable.")]
CaseOption = Annotated[str | None, typer.Option("--case", metavar="N", help="Which case of a [sweep], from 0.")]
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
