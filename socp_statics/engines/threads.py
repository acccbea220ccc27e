"""Pieces of a list of problems in threads: compiled code runs without the interpreter's lock."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from socp_statics.exceptions import InputError


def checked_threads(threads: int) -> int:
    """The number of threads.

    Raises:
        InputError: It is not a whole number >= 1.
    """
    if isinstance(threads, bool) or not isinstance(threads, int) or threads < 1:
        raise InputError(f"threads must be a whole number >= 1, got {threads!r}", name="threads", field="threads")
    return threads


def in_chunks(work: Callable[[Sequence[Any]], list[Any]], items: Sequence[Any], chunk: int, threads: int) -> list[Any]:
    """Results of some work on pieces of a list, in the order of the list, whatever the number of threads.

    Args:
        work: From a piece to the results of its items.
        items: The list.
        chunk: Length of a piece; it does not depend on the threads, so that neither do the results.
        threads: Number of threads.
    """
    pieces = [items[i : i + chunk] for i in range(0, len(items), chunk)]
    if threads == 1 or len(pieces) < 2:
        return [result for piece in pieces for result in work(piece)]
    with ThreadPoolExecutor(threads) as pool:
        return [result for results in pool.map(work, pieces) for result in results]
