"""Named things that can be listed without importing them.

Each room owns one instance. An entry is a name, one line that says what it is, and ``"module:attribute"`` where it lives; other
packages add entries through entry points of the registry's group.
"""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from importlib import import_module, metadata
from typing import Any

from socp_statics.exceptions import InputError, StaticsError

# Fewer letters than this are the start of too much.
LEAST_START = 3


def suggestion(word: str, known: Iterable[str]) -> str:
    """The end of a sentence that offers someone who mistyped a name what it may have been.

    Args:
        word: What was written.
        known: The names that exist.

    Returns:
        ``" (did you mean 'a'?)"`` with up to two names, those that begin with the word where there are any; nothing where none is near.
    """
    names = list(known)
    begun = [name for name in names if len(word) >= LEAST_START and name.startswith(word)]
    near = begun[:2] or difflib.get_close_matches(word, names, n=2, cutoff=0.6)
    return f" (did you mean {' or '.join(repr(name) for name in near)}?)" if near else ""


def nearest(word: str, known: Iterable[str]) -> str:
    """The end of a sentence that helps someone who mistyped a name.

    Args:
        word: What was written.
        known: The names that exist.

    Returns:
        ``" (did you mean 'a'?)"`` where something is near, else ``" (known: a, b, c)"``, or nothing if nothing is known.
    """
    names = list(known)
    return suggestion(word, names) or (f" (known: {', '.join(names)})" if names else "")


@dataclass(frozen=True)
class Entry:
    """One registered thing.

    Attributes:
        name: What users write.
        line: What it is, in one line.
        target: ``"module:attribute"``.
    """

    name: str
    line: str
    target: str


class Registry:
    """Names, what they are, and where they live.

    Args:
        kind: The word for one entry in sentences, for example ``"model"``.
        group: Entry-point group through which other packages add entries. A plugin never replaces an entry of the package.
    """

    def __init__(self, kind: str, *, group: str | None = None):
        self.kind = kind
        self.group = group
        self._own: dict[str, Entry] = {}

    def add(self, name: str, line: str, target: str) -> None:
        """Register an entry.

        Args:
            name: A new name.
            line: What it is, in one line.
            target: ``"module:attribute"``, imported by `load` only.

        Raises:
            ValueError: The name is taken, or the target names no attribute.
        """
        if name in self._own:
            raise ValueError(f"{self.kind} '{name}' is registered twice")
        if not all(target.partition(":")):
            raise ValueError(f"{self.kind} '{name}': target must be 'module:attribute', got '{target}'")
        self._own[name] = Entry(name, line, target)

    @cached_property
    def _plugins(self) -> dict[str, Entry]:
        found = metadata.entry_points(group=self.group) if self.group else ()
        return {point.name: Entry(point.name, f"from the plugin {point.value}", point.value) for point in found}

    @property
    def _entries(self) -> dict[str, Entry]:
        return {**self._plugins, **self._own}

    def names(self) -> tuple[str, ...]:
        """All names: those of the package in the order they were added, then those of plugins."""
        return (*self._own, *sorted(set(self._plugins) - set(self._own)))

    def describe(self) -> dict[str, str]:
        """One line for each name, in the order of `names`."""
        return {name: self._entries[name].line for name in self.names()}

    def check(self, name: str, field: str | None = None) -> str:
        """The name, if it is registered.

        Args:
            name: What a user wrote.
            field: The key or option it was written for.

        Raises:
            InputError: There is no such entry; the sentence offers near names.
        """
        if name not in self._entries:
            raise InputError(
                f"{self.kind} {name!r} is not known{nearest(str(name), self.names())}", name=str(name), field=field or self.kind
            )
        return name

    def load(self, name: str) -> Any:
        """Import the entry and return the object it names.

        Args:
            name: A registered name.

        Raises:
            InputError: There is no such entry.
            StaticsError: A plugin cannot be imported.
        """
        target = self._entries[self.check(name)].target
        module, _, attribute = target.partition(":")
        try:
            return getattr(import_module(module), attribute)
        except (ImportError, AttributeError) as error:
            if name in self._own:
                raise
            raise StaticsError(f"{self.kind} '{name}': its plugin {target} cannot be loaded ({error})", name=name) from error
