"""The verb ``view``: the 3-D page."""

from __future__ import annotations

import sys
from typing import Annotated

import typer

from socp_statics.cli.app import CaseOption, EngineOption, ProblemArgument, SetOption, app
from socp_statics.cli.arguments import check_engine, check_expectations, check_outputs, chosen_case, engines_of
from socp_statics.exceptions import StaticsError


@app.command()
def view(
    problem: ProblemArgument,
    values: SetOption = None,
    case: CaseOption = None,
    engine: EngineOption = "auto",
    html_file: Annotated[str | None, typer.Option("--html", metavar="FILE", help="Write the view as one HTML file and exit.")] = None,
) -> None:
    """3-D view in the browser.

    Drag the centre of mass, and the answer follows.
    """
    from socp_statics.cases.problem import load_problem
    from socp_statics.cases.solve import solve as answer
    from socp_statics.exceptions import EngineError
    from socp_statics.viewer import LiveView, ask, require_viewer, save_page

    loaded = chosen_case(load_problem(problem), values or [], case)
    check_engine(loaded, engine)
    check_outputs(loaded, {"--html": html_file})
    require_viewer()
    asked = engines_of(engine)
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
    check_expectations(loaded, record)
