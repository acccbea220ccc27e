"""The verb ``figures``: the report figures of a checkout."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from socp_statics.cli.app import app


@app.command()
def figures(
    names: Annotated[list[str] | None, typer.Argument(metavar="NAME", help="Figures to make; all of them by default.")] = None,
    out: Annotated[str | None, typer.Option("--out", metavar="DIR", help="Where to write; paper_figures/made by default.")] = None,
) -> None:
    """The report figures as PDF and PNG, with captions."""
    from socp_statics.report_figures import make_figures

    for path in make_figures(names or (), None if out is None else Path(out)):
        typer.echo(path)
