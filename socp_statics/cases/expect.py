"""``[expect]``: numbers or words that an answer must reproduce, and where each comes from."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from pydantic import Field, field_validator

from socp_statics.cases.answers.answer import BY_CONTACT, BY_JOINT
from socp_statics.cases.dotted import Part, key_text, parse_key
from socp_statics.cases.hashing import plain
from socp_statics.cases.statement import Statement
from socp_statics.exceptions import InputError
from socp_statics.registry import nearest


class ExpectationStatement(Statement):
    """One line of ``[expect]``."""

    value: Any = Field(description="the number, word or list expected")
    tolerance: float = Field(0.0, ge=0, description="a finite number >= 0")
    source: str = Field("", description="a sentence in quotes that says where the value comes from")

    @field_validator("value")
    @classmethod
    def _can_be_compared(cls, value: Any) -> Any:
        if not _comparable(value):
            raise InputError(f"a number, a word, true, false or a list of them is expected, got {value!r}")
        return value


def _comparable(value: Any) -> bool:
    if isinstance(value, list):
        return all(_comparable(entry) for entry in value)
    return isinstance(value, str | bool | int) or (isinstance(value, float) and not math.isnan(value))


def is_expectation(table: Mapping[str, Any]) -> bool:
    """True of a table that is an expectation, not a part of a dotted key."""
    return bool({"value", "tolerance", "source"} & set(table))


def check_expected_key(
    key: str, record_keys: Mapping[str, Any], model: str, contacts: Sequence[str] | None, joints: Sequence[str] | None = None
) -> None:
    """Refuse a key that no record of the model has.

    Args:
        key: Dotted path into the record; list entries by index, wrenches also by the name of their contact.
        record_keys: The keys that records of the model can have, as an `Answer` declares them.
        model: Name of the model, for the error sentence.
        contacts: Names of the problem's contacts; None where they are not known, then any name passes.
        joints: Names of the robot's joints, in the same way; empty without a robot.

    Raises:
        InputError: No record of the model can have this key.
    """
    node: Any = record_keys
    parts = parse_key(key, "expect")
    for at, part in enumerate(parts):
        where = f"{key_text(parts[:at])} of " if at else ""
        if isinstance(node, list):
            named = node[0] is not None and contacts is not None
            if not _is_index(part) and not (isinstance(node[0], Mapping) and (contacts is None or part in contacts)):
                known = nearest(str(part), contacts or ()) if named else "; an index counted from 0 is expected"
                raise InputError(f"{where}a record of model '{model}' has no entry {part!r}{known}", name=key, field="expect")
            node = node[0]
        elif isinstance(node, Mapping) and (BY_CONTACT in node or BY_JOINT in node):
            names, node = (contacts, node[BY_CONTACT]) if BY_CONTACT in node else (joints, node[BY_JOINT])
            if names is not None and part not in names:
                known = nearest(str(part), names) or ", it needs a robot"
                raise InputError(f"{where}a record of model '{model}' has no entry {part!r}{known}", name=key, field="expect")
        elif isinstance(node, Mapping) and part in node:
            node = node[part]
        else:
            known = nearest(str(part), node) if isinstance(node, Mapping) else ""
            raise InputError(f"{where}a record of model '{model}' has no key {part!r}{known}", name=key, field="expect")


def _is_index(part: Part) -> bool:
    return isinstance(part, int) or (part.isdecimal() and len(part) < 10)


def look_up(record: Any, key: str) -> Any:
    """The value that a dotted path leads to, None where this record has none.

    Args:
        record: A record, or any nested mappings and lists.
        key: As in ``[expect]``.
    """
    node = record
    for part in parse_key(key, "expect"):
        if isinstance(node, Mapping):
            node = node.get(part)
        elif isinstance(node, list):
            named = [entry for entry in node if isinstance(entry, Mapping) and part in (entry.get("name"), entry.get("contact"))]
            if named:
                node = named[0]
            elif _is_index(part) and int(part) < len(node):
                node = node[int(part)]
            else:
                return None
        else:
            return None
    return node


def _holds(value: Any, expected: Any, tolerance: float) -> bool:
    if isinstance(expected, list):
        same_length = isinstance(value, list) and len(value) == len(expected)
        return same_length and all(_holds(one, other, tolerance) for one, other in zip(value, expected, strict=True))
    if isinstance(expected, str | bool) or isinstance(value, str | bool | None):
        return type(value) is type(expected) and value == expected
    return isinstance(value, int | float) and abs(value - expected) <= tolerance


def evaluate(expect: Mapping[str, Mapping[str, Any]], record: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Compare a record with what is expected of it.

    Args:
        expect: Dotted key -> value, tolerance (absolute), source.
        record: The record, as plain JSON values.

    Returns:
        The record's ``expect`` entries, in the order stated.
    """
    entries = []
    for key, stated in expect.items():
        value, expected = look_up(record, key), plain(stated["value"])
        ok = _holds(value, expected, stated["tolerance"])
        entry = {"key": key, "value": value, "expected": expected, "tolerance": stated["tolerance"], "source": stated["source"], "ok": ok}
        entries.append(entry)
    return entries
