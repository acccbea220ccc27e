"""Record keys of strong stability, which an equilibrium problem asks for by ``strong = true``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from socp_statics.cases.answers.answer import BY_CONTACT, RECORD_KEYS, VECTOR

if TYPE_CHECKING:
    from socp_statics.stability import StrongAnswer

STRONG_KEYS: dict[str, Any] = {
    "strong": None,
    "strong_by": {"by": None, "statement": None},
    "strong_witness": {
        "linear": VECTOR,
        "angular": VECTOR,
        "forces": RECORD_KEYS["forces"],
        "contacts": {BY_CONTACT: None},
        "residual": None,
    },
}


def strong_keys(found: StrongAnswer) -> dict[str, Any]:
    """The label, what decided it and why, and the acceleration that was found.

    Args:
        found: Of `socp_statics.stability.check_strong_stability`.
    """
    witness = None if found.witness is None else found.witness.as_record()
    return {"strong": found.strong, "strong_by": {"by": found.by, "statement": found.statement}, "strong_witness": witness}
