"""What a measure of robustness answers: a number with its unit, and which side of the truth it is on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from socp_statics.certificates import MotionCertificate
from socp_statics.spatial import Array

EXACT, LOWER, UPPER = "exact", "lower bound", "upper bound"


@dataclass(frozen=True, eq=False)
class Measure:
    """One measure of robustness.

    Attributes:
        name: Its word in ``measures``.
        value: The number; inf where nothing limits it, None where there is none (see ``note``).
        unit: "N", "m", "deg" or "1".
        kind: "exact" (within the bracket), "lower bound" or "upper bound"; None where there is no value.
        bracket: What is certified: the truth lies between, ends included.
        note: What a person has to know to read the number, or None.
        direction: The disturbance that reaches the limit first, as a unit vector in its own coordinates, or None.
        beyond: The motion that nothing can prevent just beyond the limit, or None.
        details: Further entries of the record.
    """

    name: str
    value: float | None
    unit: str
    kind: str | None
    bracket: tuple[float, float] | None = None
    note: str | None = None
    direction: Array | None = None
    beyond: MotionCertificate | None = None
    details: dict[str, Any] = field(default_factory=dict)

    def as_record(self) -> dict[str, Any]:
        """The record's entry."""
        return {
            "value": self.value,
            "unit": self.unit,
            "kind": self.kind,
            "bracket": None if self.bracket is None else list(self.bracket),
            "note": self.note,
            "direction": None if self.direction is None else (np.asarray(self.direction) + 0.0).tolist(),
            "beyond": None if self.beyond is None else self.beyond.as_record(),
            **self.details,
        }


def bracketed(name: str, unit: str, lower: float, upper: float, tolerance: float, **more: Any) -> Measure:
    """A measure whose truth lies in a bracket: exact where the bracket is narrow, else its lower end.

    Args:
        name: Its word.
        unit: Its unit.
        lower: Lower end, which is the value.
        upper: Upper end.
        tolerance: Width of the bracket relative to its upper end that counts as exact.
        **more: Further attributes.
    """
    narrow = lower == upper or upper - lower <= tolerance * upper
    return Measure(name, lower, unit, EXACT if narrow else LOWER, (lower, upper), **more)


def no_reserve(name: str, unit: str, verdict: str) -> Measure:
    """The answer where the posture itself does not hold, or does not certainly.

    Args:
        name: The measure's word.
        unit: Its unit.
        verdict: "unstable" or "undecided".
    """
    return Measure(name, None, unit, None, note=f"{verdict}: no reserve")


def listed(values: Sequence[float] | Array) -> list[float]:
    """Numbers as a plain list without negative zeros."""
    return (np.asarray(values, dtype=float) + 0.0).tolist()
