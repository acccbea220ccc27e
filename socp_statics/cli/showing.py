"""The verb ``show``: the expanded problem and its program."""

from __future__ import annotations

from typing import Annotated

import typer

from socp_statics.cli.app import ProblemArgument, app


@app.command()
def show(
    problem: ProblemArgument,
    toml: Annotated[bool, typer.Option("--toml", help="Print a problem file to copy and edit.")] = False,
) -> None:
    """The expanded problem and its mathematical program."""
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
