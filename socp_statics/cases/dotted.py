"""Dotted keys: the paths by which ``--set``, ``[sweep]`` and ``[expect]`` point into tables and lists.

A key is written as TOML writes dotted keys, quoted parts allowed; an entry of a list is chosen by its index (``contacts.1`` or
``contacts[1]``) or by its name (``contacts.left_foot``).
"""

from __future__ import annotations

import copy
import json
import re
import tomllib
from collections.abc import Mapping
from typing import Any

from socp_statics.exceptions import InputError
from socp_statics.registry import nearest

Part = str | int

_BARE = re.compile(r"[A-Za-z0-9_-]+")
_TOKEN = re.compile(
    r"""\s*(?:(?P<bare>[A-Za-z0-9_-]+)|(?P<quoted>"(?:[^"\\\n]|\\.)*"|'[^'\n]*'))\s*|\s*\[(?P<index>\d{1,9})\]\s*""",
)


def key_text(parts: tuple[Part, ...] | list[Part]) -> str:
    """A path as a user reads it: ``posture.contacts[1].friction``.

    Args:
        parts: Keys and list indices.
    """
    text = ""
    for part in parts:
        if isinstance(part, int):
            text += f"[{part}]"
        else:
            quoted = part if _BARE.fullmatch(part) else json.dumps(part, ensure_ascii=False)
            text += f".{quoted}" if text else quoted
    return text


def _scan(text: str, origin: str) -> tuple[tuple[Part, ...], str]:
    """The key at the start of the text and what follows it."""
    parts: list[Part] = []
    at, wants_part = 0, True
    while True:
        token = _TOKEN.match(text, at)
        if token is None or (token["index"] is None) != wants_part:
            break
        if token["index"] is not None:
            parts.append(int(token["index"]))
        elif token["bare"] is not None:
            parts.append(token["bare"])
        else:
            try:
                parts.append(tomllib.loads(f"part = {token['quoted']}")["part"])
            except tomllib.TOMLDecodeError as error:
                raise InputError(f"{origin}: {token['quoted']} is not a TOML string", name=text, field=origin) from error
        at, wants_part = token.end(), False
        if at < len(text) and text[at] == ".":
            at, wants_part = at + 1, True
    if wants_part or not parts:
        raise InputError(f"{origin}: a dotted TOML key is expected, such as posture.mass, got {text!r}", name=text, field=origin)
    return tuple(parts), text[at:]


def parse_key(text: str, origin: str = "key") -> tuple[Part, ...]:
    """Split a dotted key.

    Args:
        text: For example ``wrenches.left_foot.force[2]`` or ``posture."odd name".mass``.
        origin: Where the key was written, for the error sentence.

    Returns:
        Its parts; ``[2]`` becomes the integer 2, a bare ``2`` stays a word and is read as an index where a list is.

    Raises:
        InputError: It is not a dotted key.
    """
    parts, rest = _scan(text, origin)
    if rest:
        raise InputError(f"{origin}: a dotted TOML key is expected, such as posture.mass, got {text!r}", name=text, field=origin)
    return parts


def parse_assignment(text: str, origin: str = "--set") -> tuple[tuple[Part, ...], Any]:
    """Split ``KEY=VALUE``.

    Args:
        text: KEY as TOML writes dotted keys; VALUE is read as TOML and, where it is none, as a string.
        origin: The option, for the error sentence.

    Returns:
        The parts of the key and the value.

    Raises:
        InputError: There is no ``=``, or KEY is not a dotted key.
    """
    parts, rest = _scan(text, origin)
    if not rest.startswith("="):
        raise InputError(f"{origin}: KEY=VALUE is expected, such as posture.mass=60.0, got {text!r}", name=text, field=origin)
    return parts, toml_value(rest[1:])


def toml_value(text: str) -> Any:
    """The text read as one TOML value, else the text itself.

    Args:
        text: For example ``0.4``, ``[1, 2]``, ``"word"`` or ``word``.
    """
    try:
        table = tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError):
        return text.strip()
    return table["value"] if len(table) == 1 else text.strip()


def _entry_index(entries: list[Any], part: Part, where: tuple[Part, ...], origin: str) -> int:
    names = [entry.get("name", entry.get("contact")) if isinstance(entry, Mapping) else None for entry in entries]
    if isinstance(part, str) and part in names:
        return names.index(part)
    index = part if isinstance(part, int) else int(part) if part.isdecimal() and len(part) < 10 else None
    if index is None:
        known = [name for name in names if isinstance(name, str)]
        message = f"{origin}: {key_text(where)} has no entry {part!r}{nearest(str(part), known)}"
        raise InputError(message, name=str(part), field=key_text(where))
    if index >= len(entries):
        message = f"{origin}: {key_text(where)} has {len(entries)} entries, counted from 0, there is no [{index}]"
        raise InputError(message, name=str(part), field=key_text(where))
    return index


def resolve(data: Mapping[str, Any], parts: tuple[Part, ...], origin: str = "key") -> tuple[Part, ...]:
    """The path with entries of lists named by their index, so that two spellings of one key compare equal.

    Args:
        data: The tables the path leads into; keys that do not exist yet are left as they are.
        parts: From `parse_key`.
        origin: Where the key was written, for the error sentence.

    Raises:
        InputError: A list has no such entry, or the path goes on beyond a value that holds none.
    """
    node: Any = data
    done: tuple[Part, ...] = ()
    for part in parts:
        if isinstance(node, list):
            index = _entry_index(node, part, done, origin)
            node, done = node[index], (*done, index)
        elif isinstance(node, Mapping):
            if isinstance(part, int):
                what = "a table" if node else "not a list"
                raise InputError(f"{origin}: {key_text(done)} is {what}, it has no entry [{part}]", name=str(part), field=key_text(done))
            node, done = node.get(part, {}), (*done, part)
        else:
            message = f"{origin}: {key_text(done)} is {node!r}, it holds no key {part!r}"
            raise InputError(message, name=str(part), field=key_text(done))
    return done


def with_value(data: Mapping[str, Any], parts: tuple[Part, ...], value: Any, origin: str = "key") -> dict[str, Any]:
    """A copy of nested tables with one value replaced or added.

    Args:
        data: Nested tables and lists.
        parts: Where; tables on the way are made, entries of lists must exist.
        value: The new value.
        origin: Where the key was written, for the error sentence.

    Returns:
        A deep copy; the argument stays as it is.

    Raises:
        InputError: As `resolve`.
    """
    path = resolve(data, parts, origin)
    changed: Any = copy.deepcopy(dict(data))
    node = changed
    for part in path[:-1]:
        node = node.setdefault(part, {}) if isinstance(node, dict) else node[part]
    node[path[-1]] = copy.deepcopy(value)
    return changed
