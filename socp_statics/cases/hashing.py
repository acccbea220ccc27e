"""The hash of a case: the same question gets the same name, however it was written down."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Mapping
from typing import Any

SCHEMA = 1
NOT_HASHED = ("description", "reference", "expect")


def plain(value: Any) -> Any:
    """A value as JSON can hold it exactly.

    Args:
        value: Nested mappings, sequences, arrays, numbers, words.

    Returns:
        Dicts, lists, words, booleans, integers, finite floats, ``"inf"``, ``"-inf"`` and, for NaN, None. Minus zero becomes zero.
    """
    if isinstance(value, Mapping):
        return {str(key): plain(entry) for key, entry in value.items()}
    if isinstance(value, str | bool | int | None):
        return value
    if isinstance(value, float):
        if math.isnan(value):
            return None
        return float(value) + 0.0 if math.isfinite(value) else "inf" if value > 0 else "-inf"
    return plain(value.tolist()) if hasattr(value, "tolist") else [plain(entry) for entry in value]


def canonical_json(value: Any) -> str:
    """JSON with sorted keys, no spaces and ASCII only: equal values give equal text.

    Args:
        value: Anything `plain` takes.
    """
    return json.dumps(plain(value), sort_keys=True, separators=(",", ":"), ensure_ascii=True, allow_nan=False)


def case_hash(stated: Mapping[str, Any], engine: str, robot_digest: str | None = None) -> str:
    """SHA-256 of a case: its statement without description, reference and expect, the engine, the schema and the robot.

    Args:
        stated: The stated problem with defaults filled in.
        engine: The engine chosen before any handover.
        robot_digest: Digest of the robot's description, None without a robot.

    Returns:
        64 hexadecimal digits.
    """
    problem = {key: value for key, value in stated.items() if key not in NOT_HASHED}
    text = canonical_json({"schema": SCHEMA, "engine": engine, "robot": robot_digest, "problem": problem})
    return hashlib.sha256(text.encode("ascii")).hexdigest()
