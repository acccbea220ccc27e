"""Pieces of a list of problems in threads: compiled code runs without the interpreter's lock."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from typing import Any

from socp_statics.exceptions import InputError


@cache
def _helpers(threads: int) -> ThreadPoolExecutor:
    """Threads that wait for work; starting them takes as long as a dozen regions."""
    return ThreadPoolExecutor(threads, thread_name_prefix="socp_statics")


if hasattr(os, "register_at_fork"):
    # Threads do not live on in a child process.
    os.register_at_fork(after_in_child=_helpers.cache_clear)


def checked_threads(threads: int) -> int:
    """The number of threads.

    Raises:
        InputError: It is not a whole number >= 1.
    """
    if isinstance(threads, bool) or not isinstance(threads, int) or threads < 1:
        raise InputError(f"threads must be a whole number >= 1, got {threads!r}", name="threads", field="threads")
    return threads


def _pieces(items: Sequence[Any], longest: int, threads: int) -> list[Sequence[Any]]:
    """A list in pieces: short ones first, so that no thread waits while another one prepares a long one, and short ones at the end."""
    if threads == 1:
        return [items[i : i + longest] for i in range(0, len(items), longest)]
    pieces: list[Sequence[Any]] = []
    at = 0
    while at < len(items):
        length = max(1, min(longest, 1 << len(pieces), (len(items) - at) // (4 * threads)))
        pieces.append(items[at : at + length])
        at += length
    return pieces


def in_chunks(work: Callable[[Sequence[Any]], list[Any]], items: Sequence[Any], longest: int, threads: int) -> list[Any]:
    """Results of some work on pieces of a list, in the order of the list, whatever the number of threads.

    Args:
        work: From a piece to the results of its items, none of which depends on what else is in the piece.
        items: The list.
        longest: Length of the longest piece.
        threads: Number of threads, the calling one among them.

    Raises:
        BaseException: What work raised for the first piece for which it did.
    """
    pieces = _pieces(items, longest, threads)
    others = min(threads, len(pieces)) - 1
    if others < 1:
        return [result for piece in pieces for result in work(piece)]
    done: list[list[Any]] = [[] for _ in pieces]
    failed: dict[int, BaseException] = {}
    left = iter(range(len(pieces)))

    def some() -> None:
        # One thread at a time takes the next piece: the interpreter's lock sees to that.
        for i in left:
            if failed:
                return
            try:
                done[i] = work(pieces[i])
            except BaseException as error:
                failed[i] = error

    # The caller works too: a thread that only waits leaves its processor idle, and two others may be put on the same one.
    helping = [_helpers(threads - 1).submit(some) for _ in range(others)]
    some()
    for one in helping:
        # Helpers that are busy for other callers are not waited for: nothing is left for them.
        if not one.cancel():
            one.result()
    if failed:
        # Pieces are taken in order: every earlier one is done, so this is the first that fails on one thread, too.
        raise failed[min(failed)]
    return [result for results in done for result in results]
