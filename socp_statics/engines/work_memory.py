"""Work arrays of compiled functions, kept by each thread: the system takes longer to hand out fresh memory than a region to trace."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

# Larger ones are made anew each time and given back.
LARGEST = 16 * 2**20


class _Kept(threading.local):
    """Of each function that makes work arrays, those that a thread made last."""

    def __init__(self) -> None:
        self.last: dict[Callable[[int, int], tuple[Any, ...]], tuple[int, int, tuple[Any, ...]]] = {}


_kept = _Kept()


def kept(make: Callable[[int, int], tuple[Any, ...]], width: int, length: int) -> tuple[Any, ...]:
    """Work arrays of this thread: those it had, where they are wide enough, else new ones.

    Args:
        make: From width and length to arrays.
        width: What they have to hold at least.
        length: What they have to hold exactly.
    """
    had = _kept.last.get(make)
    if had is not None and had[0] >= width and had[1] == length:
        return had[2]
    # Powers of two: a batch with sets of all sizes makes few.
    wide = 1 << max(width - 1, 15).bit_length()
    arrays = make(wide, length)
    if sum(a.nbytes for a in arrays) <= LARGEST:
        _kept.last[make] = wide, length, arrays
    return arrays
