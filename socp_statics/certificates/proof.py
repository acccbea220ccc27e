"""Proofs of verdicts: exact forces or an exact motion next to those of an answer, judged by the verifier alone."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from typing import Any

import numpy as np

from socp_statics.certificates.contact_motion import Motion
from socp_statics.certificates.exact_forces import Equations, exact_forces
from socp_statics.certificates.exact_motion import motion_tables
from socp_statics.certificates.exact_statement import exact_statement, rationals
from socp_statics.certificates.force_repair import repaired
from socp_statics.certificates.opening_motion import Opening, opening_motion
from socp_statics.certificates.verify_proof import SCHEMA, Place, Refuted, Statement, read_statement, verify
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
        return cls(stance, cone, assemble(stance), table, read_statement(Place(table, "statement")))

    @cached_property
    def equations(self) -> Equations:
        """What forces have to meet exactly."""
        return Equations(self.statement, self.data)

    @cached_property
    def opening(self) -> Opening | None:
        """A motion that opens every contact, where there is one."""
        still = Motion(np.zeros(6), np.zeros(len(self.data.torques.names)))
        found = opening_motion(self.data, self.cone, still)
        return found if found is not None and not found.still else None


@dataclass(frozen=True, eq=False)
class Proof:
    """What exact arithmetic says of an answer.

    Attributes:
        verdict: "stable" or "unstable", proved; or "undecided".
        reason: Why it is undecided, else None.
        document: The proof file.
        region: "proved" or "undecided" where the answer has a region, else None.
        region_reason: Why the region is undecided, else None.
        pulled: By how much inner corners were pulled in at most [m].
        pushed: By how much outer edges were pushed out at most [m].
    """

    verdict: str
    reason: str | None
    document: dict[str, Any] = field(repr=False)
    region: str | None = None
    region_reason: str | None = None
    pulled: float = 0.0
    pushed: float = 0.0

    @property
    def proved(self) -> bool:
        """Whether the verdict is proved."""
        return self.verdict != "undecided"

    @property
    def shift(self) -> float:
        """By how much the centre of mass was moved so that the load is in reach exactly [m]."""
        return math.sqrt(sum(float(Fraction(v)) ** 2 for v in self.document.get("shift", ())))

    def with_region(self, entry: dict[str, Any] | None, reason: str, moved: tuple[float, float]) -> Proof:
        """The same proof with that of a region, or with why there is none."""
        if entry is None:
            return replace(self, region="undecided", region_reason=reason)
        document = self.document | {"region": entry}
        return replace(self, document=document, region="proved", pulled=moved[0], pushed=moved[1])

    def to_json(self) -> str:
        """The proof file as text."""
        return json.dumps(self.document, indent=1) + "\n"


def undecided(exact: ExactStance, reason: str) -> Proof:
    """No proof of either verdict, and why."""
    return Proof("undecided", reason, _document(exact, "undecided") | {"reason": reason})


def stable_proof(exact: ExactStance, x: Array) -> tuple[Proof | None, str]:
    """A proof that forces next to x balance the load.

    Args:
        exact: The stance.
        x: Scaled unknowns, shape (nx,).

    Returns:
        The proof, or None; and why there is none.
    """
    why = ""
    for room in ROOMS:
        found = exact_forces(exact.equations, exact.data, repaired(exact.data, exact.cone, x, room), list(exact.statement.com))
        if found is None:
            return None, "rank: the contacts reach the load but for rounding"
        forces = {name: [[str(v) for v in f] for f in points] for name, points in found.forces.items()}
        document = _document(exact, "stable") | {"shift": rationals(found.shift), "forces": forces}
        try:
            verify(document)
        except Refuted as error:
            why = str(error)
            continue
        return Proof("stable", None, document), ""
    return None, why


def unstable_proof(exact: ExactStance, motion: Motion) -> tuple[Proof | None, str]:
    """A proof that nothing prevents a motion next to the given one.

    Args:
        exact: The stance.
        motion: A certificate, scaled.

    Returns:
        The proof, or None; and why there is none.
    """
    why = "motion: there is none"
    for table in motion_tables(exact.statement, exact.data, exact.cone, motion):
        document = _document(exact, "unstable") | {"motion": table}
        try:
            verify(document)
        except Refuted as error:
            why = str(error)
            continue
        return Proof("unstable", None, document), ""
    return None, why


def _document(exact: ExactStance, claim: str) -> dict[str, Any]:
    return {"schema": SCHEMA, "claim": claim, "reason": None, "statement": exact.table}
