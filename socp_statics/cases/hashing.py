"""The hash of a case: the same question gets the same name, however it was written down."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

SCHEMA = 1
NOT_HASHED = ("description", "reference", "expect")
SIMPLE = frozenset((str, int, bool, type(None)))
FLOATS = {float}
# Made once: an encoder costs as much as a short text.
_CANONICAL = json.JSONEncoder(sort_keys=True, separators=(",", ":"), ensure_ascii=True, allow_nan=False)


def plain(value: Any) -> Any:
    """A value as JSON can hold it exactly.

    Args:
        value: Nested mappings, sequences, arrays, numbers, words.

    Returns:
        Dicts, lists, words, booleans, integers, finite floats, ``"inf"``, ``"-inf"`` and, for NaN, None. Minus zero becomes zero.
    """
    kind = type(value)
    if kind is float:
        return value + 0.0 if math.isfinite(value) else None if math.isnan(value) else "inf" if value > 0 else "-inf"
    if kind in SIMPLE:
        return value
    if kind is dict:
        return _plain_dict(value)
    if kind is list or kind is tuple:
        return _plain_list(value)
    if isinstance(value, Mapping):
        return {str(key): plain(entry) for key, entry in value.items()}
    if isinstance(value, str | bool | int):
        return value
    if isinstance(value, float):
        return plain(float(value))
    if hasattr(value, "tolist"):
        # An array of finite numbers is one step; where the sum of squares is too large for a number they are looked at one by one.
        numbers = value.dtype.kind == "f" and value.ndim and value.size and math.isfinite(np.vdot(value, value))
        return (value + 0.0).tolist() if numbers else plain(value.tolist())
    return [plain(entry) for entry in value]


def _plain_dict(table: dict[Any, Any]) -> dict[str, Any]:
    """Tables of numbers or words at once, such as torques by joint."""
    kinds = set(map(type, table.values()))
    if kinds == FLOATS and math.isfinite(sum(table.values())):
        return {str(key): entry + 0.0 for key, entry in table.items()}
    if kinds <= SIMPLE:
        return {str(key): entry for key, entry in table.items()}
    return {str(key): plain(entry) for key, entry in table.items()}


def _plain_list(values: Sequence[Any]) -> list[Any]:
    """Lists of numbers at once: records hold thousands of them."""
    kinds = set(map(type, values))
    if kinds == FLOATS:
        # A sum is finite only where every term is.
        return [v + 0.0 for v in values] if math.isfinite(sum(values)) else [plain(v) for v in values]
    return list(values) if kinds <= SIMPLE else [plain(entry) for entry in values]


def canonical_json(value: Any) -> str:
    """JSON with sorted keys, no spaces and ASCII only: equal values give equal text.

    Args:
        value: Anything `plain` takes.
    """
    return _CANONICAL.encode(plain(value))


def case_hash(stated: Mapping[str, Any], engine: str, robot_digest: str | None = None) -> str:
    """SHA-256 of a case: its statement without description, reference and expect, the engine, the schema and the robot.

    Args:
        stated: The stated problem with defaults filled in.
        engine: The engine chosen before any handover.
        robot_digest: Digest of the robot's description, None without a robot.

    Returns:
        64 hexadecimal digits.
    """
    return hash_of_plain(plain(stated), engine, robot_digest)


def hash_of_plain(stated: Mapping[str, Any], engine: str, robot_digest: str | None) -> str:
    """`case_hash` of a statement that `plain` has made.

    Args:
        stated: The stated problem as plain values.
        engine: The engine chosen before any handover.
        robot_digest: Digest of the robot's description, None without a robot.
    """
    problem = {key: value for key, value in stated.items() if key not in NOT_HASHED}
    text = _CANONICAL.encode({"schema": SCHEMA, "engine": engine, "robot": robot_digest, "problem": problem})
    return hashlib.sha256(text.encode("ascii")).hexdigest()
