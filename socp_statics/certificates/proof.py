"""Proofs of verdicts: exact forces or an exact motion next to those of an answer, judged by the verifier alone."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from socp_statics.certificates.contact_motion import Motion
from socp_statics.certificates.exact_forces import exact_forces
from socp_statics.certificates.exact_motion import motion_tables
from socp_statics.certificates.exact_statement import exact_statement, rationals
from socp_statics.certificates.force_repair import repaired
from socp_statics.certificates.verify_proof import SCHEMA, Refuted, Statement, read_statement, verify
from socp_statics.cones.choice import ConeChoice
from socp_statics.contacts import Stance
from socp_statics.spatial import Array
from socp_statics.statics import StaticsData, assemble

ROOMS = (1e-13, 1e-11, 1e-9)


@dataclass(frozen=True, eq=False)
class ExactStance:
    """A stance in floats and in rationals.

    Attributes:
        stance: The stance.
        cone: Exact cones or pyramids.
        data: Its arrays.
        table: Its statement as a proof file has it.
        statement: The same as the verifier reads it.
    """

    stance: Stance
    cone: ConeChoice
    data: StaticsData
    table: dict[str, Any] = field(repr=False)
    statement: Statement = field(repr=False)

    @classmethod
    def of(cls, stance: Stance, cone: ConeChoice) -> ExactStance:
        """The exact stance of a stance."""
        table = exact_statement(stance, cone)
        return cls(stance, cone, assemble(stance), table, read_statement(table))


def stable_proof(exact: ExactStance, x: Array) -> tuple[dict[str, Any] | None, str]:
    """A proof that forces next to x balance the load.

    Args:
        exact: The stance.
        x: Scaled unknowns, shape (nx,).

    Returns:
        The proof file's entries, or None; and why there is none.
    """
    why = ""
    for room in ROOMS:
        found = exact_forces(exact.statement, exact.data, repaired(exact.data, exact.cone, x, room), list(exact.statement.com))
        if found is None:
            return None, "rank: the contacts reach the load but for rounding"
        forces = {name: [[str(v) for v in f] for f in points] for name, points in found.forces.items()}
        document = _document(exact, "stable") | {"shift": rationals(found.shift), "forces": forces}
        try:
            verify(document)
        except Refuted as error:
            why = str(error)
            continue
        return document, ""
    return None, why


def unstable_proof(exact: ExactStance, motion: Motion) -> tuple[dict[str, Any] | None, str]:
    """A proof that nothing prevents a motion next to the given one.

    Args:
        exact: The stance.
        motion: A certificate, scaled.

    Returns:
        The proof file's entries, or None; and why there is none.
    """
    why = "motion: there is none"
    for table in motion_tables(exact.statement, exact.data, exact.cone, motion):
        document = _document(exact, "unstable") | {"motion": table}
        try:
            verify(document)
        except Refuted as error:
            why = str(error)
            continue
        return document, ""
    return None, why


def _document(exact: ExactStance, claim: str) -> dict[str, Any]:
    return {"schema": SCHEMA, "claim": claim, "reason": None, "statement": exact.table}
