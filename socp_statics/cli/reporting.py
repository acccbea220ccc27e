"""The verb ``report``: a results folder on one page."""

from __future__ import annotations

from typing import Annotated

import typer

from socp_statics.cli.app import app


@app.command()
def report(folder: Annotated[str, typer.Argument(metavar="DIR", help="A folder that run has written.")] = "runs") -> None:
    """One page and tables of a results folder."""
    from socp_statics.report import write_report
    from socp_statics.report.writing import PAGE, SUMMARY

    typer.echo(f"{write_report(folder)} Written to {folder}/{PAGE} and {folder}/{SUMMARY}")
