"""The verb ``list``: names with one line each."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from socp_statics.cli.app import app
from socp_statics.exceptions import InputError

KINDS = ("problems", "models", "postures", "robots")


@app.command("list")
def list_names(
    kind: Annotated[str, typer.Argument(metavar="problems|models|postures|robots", help="What to list; all of them by default.")] = "",
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON: kind, then name and line.")] = False,
) -> None:
    """Names with one line each."""
    if kind and kind not in KINDS:
        from socp_statics.registry import suggestion

        message = f"list: {kind!r} cannot be listed, one of {', '.join(KINDS)} is expected{suggestion(kind, KINDS)}"
        raise InputError(message, name=kind, field="list")
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
