"""The verb ``prove``: an answer re-checked in exact rational arithmetic."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from socp_statics.cli.app import CaseOption, EngineOption, SetOption, app
from socp_statics.cli.arguments import chosen_case, engines_of
from socp_statics.exceptions import EngineError, InputError, StaticsError

if TYPE_CHECKING:
    from socp_statics.certificates.proof import Proof

RECORD = ".json"


@app.command()
def prove(
    record_or_problem: Annotated[
        str, typer.Argument(metavar="RECORD_OR_PROBLEM", help="A record that ends in .json; else a problem, which is solved first.")
    ],
    values: SetOption = None,
    case: CaseOption = None,
    engine: EngineOption = "auto",
    proof_file: Annotated[str | None, typer.Option("--json", metavar="FILE", help="Write the proof; - prints only the proof.")] = None,
) -> None:
    """Re-check an answer in exact rational arithmetic."""
    from socp_statics.cases.proving import prove as proved
    from socp_statics.cases.writing import check_writable

    if proof_file not in (None, "-"):
        check_writable(Path(proof_file), "--json")
    record = _record(record_or_problem, values or [], case, engine, proof_file)
    try:
        proof = proved(record, engines_of(engine))
    except InputError as error:
        raise InputError(f"{record_or_problem}: {error}", name=record_or_problem, field=error.field) from error
    except EngineError as error:
        raise EngineError(f"{record_or_problem}: {error}", name=record_or_problem) from error
    except StaticsError as error:
        raise StaticsError(f"{record_or_problem}: not proved, {error}", name=record_or_problem) from error
    if proof_file == "-":
        typer.echo(proof.to_json(), nl=False)
        return
    if proof_file is not None:
        _write(proof, Path(proof_file))
    for line in _lines(record, proof):
        typer.echo(line)


def _record(name: str, values: list[str], case: str | None, engine: str, proof_file: str | None) -> Mapping[str, Any]:
    """The record of a file, or that of a problem that is solved."""
    from socp_statics.cases.record import read_record

    if not name.endswith(RECORD):
        from socp_statics.cases.problem import load_problem
        from socp_statics.cases.solve import solve
        from socp_statics.cli.arguments import check_engine, check_outputs

        loaded = chosen_case(load_problem(name), values, case)
        check_engine(loaded, engine)
        check_outputs(loaded, {"--json": None if proof_file == "-" else proof_file})
        try:
            return solve(loaded, engines_of(engine))
        except EngineError as error:
            raise EngineError(f"{loaded.label}: {error}", name=loaded.label) from error
    for option, given in (("--set", values), ("--case", case is not None)):
        if given:
            raise InputError(f"{name}: {option} changes a problem, a record is what it is", name=name, field=option)
    if proof_file not in (None, "-") and Path(proof_file).exists() and Path(name).exists() and Path(proof_file).samefile(name):
        raise InputError(f"--json {proof_file}: this is the record itself, another file is expected", name=name, field="--json")
    return read_record(name)


def _write(proof: Proof, path: Path) -> None:
    from socp_statics.cases.writing import finished_or_absent

    try:
        with finished_or_absent(path) as draft:
            draft.write_text(proof.to_json(), encoding="utf-8")
    except OSError as error:
        raise StaticsError(f"--json {path}: the proof could not be written ({error.strerror})", name=str(path), field="--json") from error


def _lines(record: Mapping[str, Any], proof: Proof) -> list[str]:
    """The proof in a few lines for a person."""
    proves = {"stable": "forces balance the load exactly, each in its cone", "unstable": "a motion that no admissible force can prevent"}
    verdict = f"proved {proof.verdict}: {proves[proof.verdict]}" if proof.proved else f"undecided ({proof.reason})"
    lines = [("problem", f"{record['problem']}, {record['model']}"), ("verdict", verdict)]
    if proof.shift:
        lines.append(("CoM", f"moved by {proof.shift:.1e} m, so that the contacts reach the load in spite of rounding"))
    if proof.region == "proved":
        moved = f"inner corners pulled in by at most {proof.pulled:.1e} m, outer edges pushed out by at most {proof.pushed:.1e} m"
        words = {0: "empty", 1: f"a point, {moved}", 2: f"a segment, {moved}"}
        lines.append(("region", f"proved: {words.get(len(record['region']['outer']), f'between its polygons, {moved}')}"))
    elif proof.region is not None:
        lines.append(("region", f"undecided ({proof.region_reason})"))
    if record.get("reason") == "torque" and proof.proved:
        lines.append(("limits", "the torque limits count; that it is stable without them was computed, not proved"))
    return [f"{word:<11} {text}" for word, text in lines]
