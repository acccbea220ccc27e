"""From a problem to its record."""

from __future__ import annotations

import platform
from collections.abc import Mapping, Sequence
from functools import cache
from importlib import metadata
from typing import Any

import socp_statics
from socp_statics.cases.answers import ANSWERS
from socp_statics.cases.answers.equilibrium import torque_keys
from socp_statics.cases.expect import evaluate
from socp_statics.cases.hashing import SCHEMA, case_hash, hash_of_plain, plain
from socp_statics.cases.problem import Problem, require_problem
from socp_statics.cases.record import Record
from socp_statics.contacts import Stance
from socp_statics.exceptions import InputError
from socp_statics.registry import nearest

DISTRIBUTIONS = ("numpy", "scipy", "cvxpy-base", "clarabel", "numba")
KINEMATICS = "pin"
KEY_ORDER = (
    "schema", "problem", "model", "hash", "sweep", "case", "status", "verdict", "reason", "strong", "strong_by", "cone", "objective",
    "margin", "idle", "idle_margin", "com_margin", "wrenches", "forces", "torques", "torque_limits", "region", "following", "capability",
    "distribution", "window", "certificate", "strong_witness", "prices", "safety", "simple_test", "robustness", "optimized", "residuals",
    "expect", "engine", "handovers", "versions",
)  # fmt: skip


def solve(problem: Problem, engine: str | Sequence[str] = "auto") -> Record:
    """Answer a problem.

    Args:
        problem: A single problem, or one case of a sweep.
        engine: ``"auto"``, a registered engine, or several in the order they are to be tried.

    Returns:
        The record, with its expectations compared.

    Raises:
        InputError: It is no problem, or a sweep, the engine is unknown, or the stance makes no sense for the model.
        EngineError: The computation broke down.
    """
    require_problem(problem)
    problem.require_single()
    chosen = first_engine(engine)
    try:
        stance = problem.stance()
        keys = ANSWERS.load(problem.model).compute(problem, stance, engine)
    except InputError as error:
        raise InputError(f"{problem.label}: {_key_of(error, problem)}{error}", name=problem.label, field=error.field) from error
    return record_of(problem, stance, keys, chosen)


def shown_stance(problem: Problem, record: Mapping[str, Any]) -> Stance:
    """The stance that the forces and the certificate of a record belong to, for example to draw them.

    Args:
        problem: A single problem.
        record: Its record.
    """
    shown = ANSWERS.load(problem.model).shown
    return problem.stance() if shown is None else shown(problem, record)


def first_engine(engine: str | Sequence[str]) -> str:
    """The engine that is asked first, before any handover.

    Args:
        engine: ``"auto"``, a registered name, or several.

    Raises:
        InputError: There is no such engine.
    """
    # the engines' room imports solvers, which listing and showing do without
    from socp_statics.engines import ENGINES, engine_names

    if isinstance(engine, str) and engine != "auto" and engine not in ENGINES.names():
        known = nearest(engine, ("auto", *ENGINES.names()))
        raise InputError(f"engine {engine!r} is not known{known}", name=engine, field="engine")
    return engine_names(engine)[0]


def failed_record(problem: Problem, engine: str | Sequence[str], reason: str, failure: str = "engine") -> Record:
    """The record of a problem that has a stance and no answer: verdict undecided, no margin, no forces.

    Args:
        problem: A single problem.
        engine: As for `solve`.
        reason: Why there is no answer.
        failure: "engine" where the computation broke down, "input" where the model refuses the stance.
    """
    stance, first = problem.stance(), first_engine(engine)
    keys = no_answer(first, reason, failure) | {"cone": problem.cone.as_record(), **torque_keys(None, stance)}
    return record_of(problem, stance, keys, first)


def no_answer(engine: str, reason: str, failure: str) -> dict[str, Any]:
    """What the record of a failure says instead of an answer, in the order of its keys.

    Args:
        engine: The engine that was asked first.
        reason: What went wrong.
        failure: "engine", "input" or "process".
    """
    return {
        "status": "failed",
        "verdict": "undecided",
        "reason": None,
        "cone": {"kind": None, "sides": None, "heading": None},
        "objective": None,
        "margin": None,
        "idle": [],
        "idle_margin": None,
        "com_margin": None,
        "wrenches": [],
        "forces": [],
        "certificate": None,
        "prices": {},
        "residuals": {"balance": None, "cone": None, "gap": None},
        "expect": [],
        "engine": engine,
        "handovers": 0,
        "versions": versions(),
        "failure": reason,
        "failure_kind": failure,
    }


def unmet(record: Record) -> list[str]:
    """One sentence for each expectation that does not hold.

    Args:
        record: Of `solve`.
    """
    return [
        f"[expect] {entry['key']} is {entry['value']!r}, expected {entry['expected']!r}"
        + (f" within {entry['tolerance']:g}" if entry["tolerance"] else "")
        + (f" ({entry['source']})" if entry["source"] else "")
        for entry in record["expect"]
        if not entry["ok"]
    ]


@cache
def versions(robot: bool = False) -> dict[str, str]:
    """Versions of the toolkit, of Python and of the libraries that decide the numbers.

    Args:
        robot: Whether a robot was posed.
    """
    own = {"socp_statics": socp_statics.__version__, "python": platform.python_version()}
    names = (*DISTRIBUTIONS, KINEMATICS) if robot else DISTRIBUTIONS
    return own | {name.removesuffix("-base"): metadata.version(name) for name in names}


def problem_hash(problem: Problem, engine: str) -> str:
    """The hash of a problem: of its statement, the engine, the schema and its robot.

    Args:
        problem: A single problem.
        engine: The engine that is asked first.
    """
    posture = problem.robot_posture
    return case_hash(problem.stated(), engine, None if posture is None else posture.robot.digest)


def record_of(problem: Problem, stance: Stance, keys: dict[str, Any], engine: str) -> Record:
    """The record of an answer.

    Args:
        problem: A single problem.
        stance: Its stance.
        keys: What its answer computed; changed.
        engine: The engine that was asked first.
    """
    stance = keys.pop("stance", stance)
    stated, posture = plain(problem.stated()), stance.posture
    generated = {"contacts": [contact.statement() for contact in stance.contacts], "com": stance.com, "mass": stance.mass}
    if posture is not None:
        generated["angles"] = posture.as_record()["angles"]
        if posture.loads:
            generated["external_wrenches"] = [{"link": w.link, "force": w.force, "point": w.point} for w in posture.loads]
    entries = {
        "schema": SCHEMA,
        "problem": problem.name,
        "model": problem.model,
        "hash": hash_of_plain(stated, engine, None if posture is None else posture.robot.digest),
        "case": stated | {"generated": plain(generated)},
        "com_margin": None,
        **keys,
        **({} if problem.number is None else {"sweep": {"case": problem.number, "values": problem.swept}}),
        "versions": versions(posture is not None),
    }
    order = [*(key for key in KEY_ORDER if key in entries or key == "expect"), *(key for key in entries if key not in KEY_ORDER)]
    record = {key: [] if key == "expect" else entries[key] if key == "case" else plain(entries[key]) for key in order}
    if problem.expect:
        # What is expected may be anything but an expectation.
        found = {key: value for key, value in record.items() if key != "expect"}
        record["expect"] = plain(evaluate(problem.expect, found))
    return Record.of_plain(record)


def _key_of(error: InputError, problem: Problem) -> str:
    """The key path of what the solving layers complain about, where it is a key of the file."""
    for table in ("posture", "parameters"):
        if error.field in getattr(problem, table):
            return f"{table}.{error.field}: "
    return ""
