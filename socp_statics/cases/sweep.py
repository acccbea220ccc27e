"""Sweeps: one problem file that stands for the product of the values of some of its keys."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from socp_statics.cases.dotted import key_text
from socp_statics.exceptions import InputError

Values = Sequence[Any]


def sweep_values(key: str, stated: Any) -> Values:
    """The values a swept key takes.

    Args:
        key: The dotted key, for the error sentence.
        stated: A list, or ``{ from = 0, to = 4999 }``, whole numbers, both ends included.

    Returns:
        The values in order; a range is not written out.

    Raises:
        InputError: Neither of the two, or no value at all.
    """
    if isinstance(stated, list) and stated:
        return stated
    if isinstance(stated, Mapping) and set(stated) == {"from", "to"}:
        ends = stated["from"], stated["to"]
        if all(isinstance(end, int) and not isinstance(end, bool) for end in ends) and ends[0] <= ends[1]:
            return range(ends[0], ends[1] + 1)
    message = f"a list of values or {{ from = a, to = b }} with whole numbers a <= b is expected, got {stated!r}"
    raise InputError(message, name=key, field="sweep")


def flatten_keys(table: Mapping[str, Any], leaf: Callable[[Mapping[str, Any]], bool]) -> dict[str, Any]:
    """Undo the nesting that TOML gives to dotted keys written without quotes.

    Args:
        table: For example ``{"posture": {"mass": [1, 2]}}``.
        leaf: Whether a table is a value, not a part of a dotted key.

    Returns:
        For example ``{"posture.mass": [1, 2]}``, order kept.
    """
    flat: dict[str, Any] = {}
    for key, value in table.items():
        if isinstance(value, Mapping) and value and not leaf(value):
            inner = flatten_keys({key_text((part,)): entry for part, entry in value.items()}, leaf)
            flat.update({f"{key}.{rest}": entry for rest, entry in inner.items()})
        else:
            flat[key] = value
    return flat


def is_range(table: Mapping[str, Any]) -> bool:
    """True of a table that is a range, not a part of a dotted key."""
    return "from" in table or "to" in table


def case_count(sweep: Mapping[str, Values]) -> int:
    """Number of cases, 1 without a sweep."""
    return math.prod(len(values) for values in sweep.values())


def case_values(sweep: Mapping[str, Values], number: int) -> dict[str, Any]:
    """The values of one case.

    Args:
        sweep: Dotted key -> values.
        number: From 0; the last key changes fastest.

    Returns:
        Dotted key -> value, in the order of the sweep.

    Raises:
        InputError: There is no such case.
    """
    count = case_count(sweep)
    if not 0 <= number < count:
        raise InputError(f"--case must be a number from 0 to {count - 1}, got {number}", name=str(number), field="--case")
    chosen: dict[str, Any] = {}
    for key in reversed(list(sweep)):
        number, place = divmod(number, len(sweep[key]))
        chosen[key] = sweep[key][place]
    return {key: chosen[key] for key in sweep}
