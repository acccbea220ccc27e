"""Compiling several entries at the same time, in processes of their own: Numba compiles one function after the other in a process.

Entries that share inner functions belong together: what one has compiled, the next one in the same process does not compile again.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterable, Sequence

from socp_statics.engines.kernel.compilation import Entry, compiling, entries_of, entry_folder

# Modules of the kernel, by what they share: the programs with five unknowns, preparing and tracing plans, solving them. The first group
# takes as long as the other two.
SHARED = (
    ("directions", "largest_forces", "reserves", "tracing"),
    ("limited_rows", "plan", "plan_tracing"),
    ("conic",),
)


def load_side_by_side(entries: Iterable[Entry], shared: Sequence[Sequence[str]] = SHARED) -> None:
    """Load entries from the disk cache; those that are missing there are compiled first, groups of them at the same time.

    Args:
        entries: The entries.
        shared: Names of modules whose entries are compiled in one process; entries of other modules go with the first group. Where
            there are more groups than processors, the last ones are compiled in one process.
    """
    wanted = tuple(entries)
    groups: dict[int, list[Entry]] = {}
    for one in wanted:
        if not one.kept():
            module = one.__module__.rpartition(".")[2]
            groups.setdefault(next((i for i, names in enumerate(shared) if module in names), 0), []).append(one)
    processors = os.cpu_count() or 1
    alone = len(groups) < 2 or processors < 2 or not sys.executable
    mine, *others = (groups[which] for which in sorted(groups)) if groups else [[]]
    if len(others) >= processors:
        others = [*others[: processors - 2], [one for group in others[processors - 2 :] for one in group]]
    with compiling():
        children = [] if alone or entry_folder(mine[0]) is None else [_child(group) for group in others]
        try:
            for one in mine:
                one.load()
            for child in children:
                child.wait()
        finally:
            for child in children:
                child.kill()
        # What a child did not manage is compiled here.
        for one in wanted:
            one.load()


def load_here(package: str, names: Iterable[str]) -> None:
    """Compile entries of a package in this process, or load them from the cache: what a child is started for.

    Args:
        package: Name of the package.
        names: Module and name of each entry, ``"package.module.function"``.
    """
    named = frozenset(names)
    for one in entries_of(package):
        if f"{one.__module__}.{one.__qualname__}" in named:
            one.load()


def _child(group: Sequence[Entry]) -> subprocess.Popen[bytes]:
    """A process that compiles some entries into the disk cache."""
    names = [f"{one.__module__}.{one.__qualname__}" for one in group]
    code = f"from {__name__} import load_here; load_here({group[0].__module__.rpartition('.')[0]!r}, {names!r})"
    path = os.pathsep.join(place for place in sys.path if place)
    return subprocess.Popen(
        [sys.executable, "-c", code],
        env={**os.environ, "PYTHONPATH": path},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
