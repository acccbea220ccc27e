"""Numbers given by a user, checked once: finite, of the right size, in the right range."""

from __future__ import annotations

from typing import Any

import numpy as np

from socp_statics.exceptions import InputError
from socp_statics.spatial import Array


def vector(name: str, field: str, value: Any, size: int, *, shape: tuple[int, ...] | None = None, kind: str = "contact") -> Array:
    """A finite vector or matrix.

    Args:
        name: What the value belongs to, for the error sentence.
        field: The key of the value.
        value: Anything array-like.
        size: Number of entries expected.
        shape: Shape expected, ``(size,)`` by default.
        kind: The word before the name in the sentence.

    Returns:
        Read-only array of the shape expected.

    Raises:
        InputError: The size is wrong, or an entry is not a finite number.
    """
    expected = (size,) if shape is None else shape
    words = "x".join(str(n) for n in expected) if len(expected) > 1 else str(size)
    try:
        array = np.array(value, dtype=float)
    except (TypeError, ValueError) as error:
        raise InputError(f"{kind} '{name}': {field} must be {words} numbers, got {value!r}", name=name, field=field) from error
    if array.shape != expected:
        raise InputError(f"{kind} '{name}': {field} must be {words} numbers, got an array of shape {array.shape}", name=name, field=field)
    if not np.isfinite(array).all():
        raise InputError(f"{kind} '{name}': {field} must be finite, got {array.tolist()}", name=name, field=field)
    array.setflags(write=False)
    return array


def scalar(name: str, field: str, value: Any, *, above: float | None = None, least: float | None = None, kind: str = "contact") -> float:
    """A finite number in a range.

    Args:
        name: What the value belongs to, for the error sentence.
        field: The key of the value.
        value: A number.
        above: The value must be greater than this.
        least: The value must be at least this.
        kind: The word before the name in the sentence.

    Returns:
        The number as a float.

    Raises:
        InputError: Not a number, not finite, or out of range.
    """
    bound = f" > {above:g}" if above is not None else f" >= {least:g}" if least is not None else ""
    number = float("nan")
    if isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool):
        try:
            number = float(value)
        except OverflowError:
            number = float("inf")
    wrong = not np.isfinite(number) or (above is not None and number <= above) or (least is not None and number < least)
    if wrong:
        raise InputError(f"{kind} '{name}': {field} must be a finite number{bound}, got {value!r}", name=name, field=field)
    return number


def interval(name: str, field: str, value: Any, *, least: float | None = None, kind: str = "contact") -> tuple[float, float]:
    """A pair ``lo <= hi``; the ends may be infinite, except that an interval is never empty.

    Args:
        name: What the value belongs to, for the error sentence.
        field: The key of the value.
        value: Two numbers.
        least: The lower end must be at least this.
        kind: The word before the name in the sentence.

    Returns:
        ``(lo, hi)``.

    Raises:
        InputError: Not two numbers, NaN, out of order or out of range.
    """
    floor = f"{least:g} <= " if least is not None else ""
    sentence = f"{kind} '{name}': {field} must be [lo, hi] with {floor}lo <= hi, got {value!r}"
    try:
        lo, hi = (float(end) for end in value)
    except (TypeError, ValueError) as error:
        raise InputError(sentence, name=name, field=field) from error
    if not lo <= hi or (least is not None and lo < least) or lo == np.inf or hi == -np.inf:
        raise InputError(sentence, name=name, field=field)
    return lo, hi
