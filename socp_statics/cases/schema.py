"""The problem file as a whole: every fault of every table, found in one pass and named by its key path."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from pydantic import Field

from socp_statics.cases.answers import ANSWERS
from socp_statics.cases.dotted import key_text, parse_key, resolve, with_value
from socp_statics.cases.expect import ExpectationStatement, check_expected_key, is_expectation
from socp_statics.cases.generators import WITHOUT_ROBOT, check_generator
from socp_statics.cases.robot_posture import check_torque_limits, read_robot_posture
from socp_statics.cases.robotless import robotless_names, robotless_statement
from socp_statics.cases.statement import Statement, read_statement
from socp_statics.cases.sweep import Values, case_values, flatten_keys, is_range, sweep_values
from socp_statics.exceptions import InputError
from socp_statics.postures import Posture

Table = dict[str, Any]


class ProblemStatement(Statement):
    """The top of a problem file."""

    description: str = Field("", description="a sentence in quotes")
    model: str = Field(description="the name of a model, see socp-statics list models")
    reference: str = Field("", description="a sentence in quotes")
    posture: Table = Field(description="a table [posture]")
    parameters: Table = Field({}, description="a table [parameters]")
    sweep: Table = Field({}, description="a table [sweep]")
    expect: Table = Field({}, description="a table [expect]")


class Reading(NamedTuple):
    """A valid problem: the tables with their defaults filled in, and the robot's posture where there is a robot."""

    top: ProblemStatement
    posture: Table
    parameters: Table
    sweep: dict[str, Values]
    expect: dict[str, Table]
    robot_posture: Posture | None


class Names(NamedTuple):
    """Contacts and joints of the problem, which parameters and expectations may name; None where they are not known."""

    contacts: tuple[str, ...] | None = None
    joints: tuple[str, ...] | None = None


def read_problem(raw: Mapping[str, Any], label: str, folder: Path | None = None) -> Reading:
    """Validate a problem.

    Args:
        raw: The file as TOML reads it.
        label: The file or problem, for the error sentence.
        folder: Where relative paths of the file start; the working directory where there is no file.

    Returns:
        The tables with their defaults. With a ``[sweep]``, posture and parameters are those of its first case.

    Raises:
        InputError: One sentence with every fault: ``label: key ...; key ...``.
    """
    faults: dict[str, str] = {}
    sweep = _read_sweep(raw, faults)
    first = raw if faults else _first_case(raw, sweep, faults)
    top = read_statement(ProblemStatement, first, (), faults)
    tables = {key: first[key] for key in ("posture", "parameters", "expect") if isinstance(first.get(key), Mapping)}
    posture, made, names = _read_posture(tables["posture"], folder, faults) if "posture" in tables else (None, None, Names())
    parameters, expect = _read_model(first.get("model"), tables, names, faults)
    if posture is not None and made is not None:
        check_torque_limits(posture, made, parameters.get("torque_limits", False), faults)
    for key in sweep:
        path = key_text(resolve(first, parse_key(key, "sweep"), "sweep"))
        if path in faults:
            faults[path] += f" (set by sweep key {key})"
    if faults or top is None or posture is None:
        raise InputError(f"{label}: {'; '.join(faults.values())}", name=label, field=next(iter(faults)))
    return Reading(top, posture, parameters, sweep, expect, made)


def _collect(faults: dict[str, str], path: str, error: InputError) -> None:
    faults.setdefault(path, f"{path}: {str(error).removeprefix('sweep: ').removeprefix('expect: ')}")


def read_sweep(raw: Mapping[str, Any], label: str) -> dict[str, Values]:
    """The sweep of a problem, nothing else of which is looked at.

    Args:
        raw: The file as TOML reads it.
        label: The file or problem, for the error sentence.

    Returns:
        Dotted key -> values; empty without a sweep.

    Raises:
        InputError: One sentence with every fault.
    """
    faults: dict[str, str] = {}
    if not isinstance(raw.get("sweep", {}), Mapping):
        faults["sweep"] = "sweep must be a table [sweep]"
    sweep = _read_sweep(raw, faults)
    if faults:
        raise InputError(f"{label}: {'; '.join(faults.values())}", name=label, field=next(iter(faults)))
    return sweep


def _read_sweep(raw: Mapping[str, Any], faults: dict[str, str]) -> dict[str, Values]:
    stated = raw.get("sweep", {})
    sweep: dict[str, Values] = {}
    for key, values in flatten_keys(stated, is_range).items() if isinstance(stated, Mapping) else ():
        try:
            parts = resolve(raw, parse_key(key, "sweep"), "sweep")
            sweep[key] = sweep_values(key, values)
            if parts[0] in ("sweep", "expect", "description", "reference"):
                raise InputError(f"{parts[0]} cannot be swept, a key of posture or parameters is expected", name=key, field="sweep")
        except InputError as error:
            _collect(faults, key_text(("sweep", key)), error)
    return sweep


def _first_case(raw: Mapping[str, Any], sweep: dict[str, Values], faults: dict[str, str]) -> Mapping[str, Any]:
    """The raw tables of the first case of a sweep, so that a sweep over an unknown key is found without expanding it."""
    if not sweep:
        return raw
    try:
        return swept_tables(raw, sweep, 0)
    except InputError as error:
        _collect(faults, "sweep", error)
        return raw


def swept_tables(raw: Mapping[str, Any], sweep: Mapping[str, Values], number: int) -> Table:
    """The raw tables of one case: swept keys set, ``[sweep]`` removed.

    Args:
        raw: The file as TOML reads it.
        sweep: Dotted key -> values.
        number: From 0.
    """
    tables = {key: value for key, value in raw.items() if key != "sweep"}
    for key, value in case_values(sweep, number).items():
        tables = with_value(tables, parse_key(key, "sweep"), value, "sweep")
    return tables


def read_posture(stated: Mapping[str, Any], folder: Path | None) -> tuple[Table, Posture | None, Names] | None:
    """A posture by itself, for cases of one sweep that differ in nothing else.

    Args:
        stated: The table ``[posture]`` as TOML reads it.
        folder: Where relative paths of the file start.

    Returns:
        The table with defaults filled in, the posture of the robot where there is one, and the names that the rest of the file may
        mention; None where it has faults.
    """
    faults: dict[str, str] = {}
    posture, made, names = _read_posture(stated, folder, faults)
    return None if faults or posture is None else (posture, made, names)


def _read_posture(stated: Mapping[str, Any], folder: Path | None, faults: dict[str, str]) -> tuple[Table | None, Posture | None, Names]:
    try:
        generator = check_generator(stated.get("generator"))
    except InputError as error:
        _collect(faults, "posture.generator", error)
        return None, None, Names()
    if generator not in WITHOUT_ROBOT:
        posture, made = read_robot_posture(stated, folder, faults)
        return posture, made, Names() if made is None else Names(made.support, made.robot.joints)
    read = read_statement(robotless_statement(generator), stated, ("posture",), faults)
    posture = None if read is None else read.stated()
    return posture, None, Names(None if posture is None else robotless_names(posture), ())


def _read_model(model: Any, tables: Mapping[str, Any], names: Names, faults: dict[str, str]) -> tuple[Table, dict[str, Table]]:
    if not isinstance(model, str):
        return {}, {}
    try:
        answer = ANSWERS.load(model)
    except InputError as error:
        _collect(faults, "model", error)
        return {}, {}
    read = read_statement(answer.parameters, tables.get("parameters", {}), ("parameters",), faults, **names._asdict())
    expect: dict[str, Table] = {}
    for key, stated in flatten_keys(tables.get("expect", {}), is_expectation).items():
        expectation = read_statement(ExpectationStatement, stated, ("expect", key), faults)
        try:
            check_expected_key(key, answer.record_keys, model, names.contacts, names.joints)
        except InputError as error:
            _collect(faults, key_text(("expect", key)), error)
        if expectation is not None:
            expect[key] = expectation.stated()
    return read.stated() if read is not None else {}, expect
