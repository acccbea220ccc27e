"""Proofs of answers and of records: what the numbers say in exact arithmetic."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from socp_statics.cases.record_audit import (
    HELD,
    recorded_forces,
    recorded_motion,
    recorded_stance,
    refute,
    stated_problem,
)
from socp_statics.cases.region_proving import joint_rates, with_region
from socp_statics.certificates import Motion
from socp_statics.certificates.exact_motion import scaled_motion
from socp_statics.certificates.proof import ExactStance, Proof, stable_proof, undecided, unstable_proof
from socp_statics.certificates.scaled_forces import scaled_forces
from socp_statics.exceptions import EngineError, InputError, StaticsError
from socp_statics.spatial import Array
from socp_statics.statics import PointForces, StaticsData

if TYPE_CHECKING:
    from socp_statics.stability import EquilibriumAnswer

OPEN = {
    "boundary": "boundary: the margin is zero within 1e-7 W",
    "rank": "rank: rounding decides whether the contacts reach the load",
    None: "the record leaves it open",
}
ENDLESS = 1e6


def prove(answer: Mapping[str, Any] | EquilibriumAnswer, engine: str | Sequence[str] = "auto") -> Proof:
    """Prove the verdict of an answer in exact rational arithmetic, and the polygons of a support region.

    The theorem is about the floating-point numbers of the answer, which are rationals. Forces of the answer are corrected until they
    balance the load exactly, and every cone, bound and limit is checked; motions are corrected until no admissible force can prevent
    them. Where its own forces lie on the boundary of a cone, those of the margin prove the verdict.

    Args:
        answer: A record, which is looked through first: an edited one fails; or an answer of `check_equilibrium`.
        engine: "auto", the name of an engine, or several in turn, for the programs that a record's own numbers leave to be solved.

    Returns:
        The proof: "stable", "unstable", or "undecided" with the reason.

    Raises:
        InputError: Neither a record nor such an answer.
        StaticsError: The record does not hold; the message says where.
        EngineError: No engine settled a program.
    """
    if not isinstance(answer, Mapping):
        stance = getattr(answer, "stance", None)
        if stance is None:
            message = f"answer: a record or an answer of check_equilibrium is expected, got {answer!r}"
            raise InputError(message, name="answer", field="answer")
        return _of_answer(ExactStance.of(stance, answer.cone), answer, engine)
    try:
        return _of_record(answer, engine)
    except StaticsError:
        raise
    except (KeyError, TypeError, ValueError, IndexError, AttributeError) as error:
        raise InputError(f"a record is expected, something in it has another form ({error})", name="record", field="record") from error


def _of_answer(exact: ExactStance, answer: EquilibriumAnswer, engine: str | Sequence[str]) -> Proof:
    if answer.verdict == "undecided":
        return undecided(exact, OPEN[answer.reason])
    proof, why = _by(exact, *_numbers(exact.data, answer))
    return proof or _solved_again(exact, answer.verdict, why, engine)


def _numbers(data: StaticsData, answer: EquilibriumAnswer) -> tuple[Array | None, Motion | None]:
    """Scaled forces of a stable answer, or the scaled motion of an unstable one."""
    if answer.verdict == "stable" and answer.forces is not None:
        return _scaled(data, answer.forces), None
    certificate = answer.certificate.as_record() if answer.verdict == "unstable" and answer.certificate is not None else None
    return None, None if certificate is None else _motion(data, certificate)


def _scaled(data: StaticsData, forces: PointForces) -> Array:
    return scaled_forces(data, forces.contact, forces.force_W, forces.moment_W)


def _motion(data: StaticsData, certificate: Mapping[str, Any]) -> Motion:
    linear, angular, point = (np.array(certificate[key], dtype=float) for key in ("linear", "angular", "point"))
    return scaled_motion(data, linear, angular, point, joint_rates(data, certificate.get("joints") or {}))


def _by(exact: ExactStance, x: Array | None, motion: Motion | None) -> tuple[Proof | None, str]:
    if x is not None:
        return stable_proof(exact, x)
    if motion is not None:
        return unstable_proof(exact, motion)
    return None, "there are neither forces nor a motion"


def _solved_again(exact: ExactStance, verdict: str, why: str, engine: str | Sequence[str]) -> Proof:
    """The proof by the numbers of further engines; undecided where none of them proves it, or what they say is another verdict."""
    from socp_statics.engines import engines_for
    from socp_statics.stability import check_equilibrium

    for one in engines_for(engine, "socp"):
        try:
            again = check_equilibrium(exact.stance, cone=exact.cone, engine=one.name)
        except EngineError:
            continue
        proof, _ = _by(exact, *_numbers(exact.data, again))
        if proof is not None:
            if proof.verdict != verdict:
                raise refute("verdict", f"it is said to be {verdict}, and proved {proof.verdict}")
            return proof
    return undecided(exact, why if why.startswith("rank") else f"rounding: {why}")


def _of_record(record: Mapping[str, Any], engine: str | Sequence[str]) -> Proof:
    from socp_statics.stability import check_equilibrium

    problem = stated_problem(record)
    stance, cone = recorded_stance(problem, record), problem.cone
    exact = ExactStance.of(stance, cone)
    x = recorded_forces(record, stance, cone, exact.data)
    certificate = record["certificate"] or {}
    kind = {"stable": "forces", "unstable": "motion", "undecided": None}[record["verdict"]]
    if certificate.get("kind") != kind or (kind == "forces" and x is None):
        raise refute("verdict", f"it is {record['verdict']}, the certificate is {certificate.get('kind')}")
    motion = recorded_motion(record, cone, exact.data, _motion(exact.data, certificate)) if kind == "motion" else None
    if kind is None:
        proof = undecided(exact, OPEN.get(record["reason"], OPEN[None]))
    else:
        found, why = _by(exact, x if kind == "forces" else None, motion)
        proof = found or _solved_again(exact, record["verdict"], why, engine)
    _check_margin(record, exact.data, check_equilibrium(stance, cone=cone, form=problem.parameters["form"], engine=engine))
    return proof if record.get("region") is None else with_region(proof, exact, record["region"], engine)


def _check_margin(record: Mapping[str, Any], data: StaticsData, again: EquilibriumAnswer) -> None:
    """Refute a margin that solving again does not find."""
    if {record["verdict"], again.verdict} == {"stable", "unstable"}:
        raise refute("verdict", f"it is said to be {record['verdict']}, solving again says {again.verdict}")
    given = float("nan") if record["margin"] is None else float(record["margin"])
    found, W = again.margin, data.units.force
    same = given == found or (np.isnan(given) and np.isnan(found)) or min(abs(given), abs(found)) > ENDLESS * W
    if not same and not abs(given - found) <= HELD * (W + abs(found)):
        raise refute("margin", f"solving again finds {found:.6g} N, the record says {record['margin']}")
