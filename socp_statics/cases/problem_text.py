"""A problem file's text: read as TOML, with one plain sentence for every way in which it can fail to be one."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

from socp_statics.exceptions import InputError

_PLACE = re.compile(r"\(at (?:line (\d+), column (\d+)|end of document)\)$")


def read_toml(path: Path, label: str) -> dict[str, Any]:
    """The tables of a TOML file.

    Args:
        path: The file.
        label: What to call it in an error sentence.

    Raises:
        InputError: It is missing, a folder, unreadable, binary, empty, or not TOML; then with line and column.
    """
    try:
        content = path.read_bytes()
    except IsADirectoryError as error:
        raise InputError(f"{label}: this is a folder, a problem file (.toml) is expected", name=label) from error
    except FileNotFoundError as error:
        raise InputError(f"{label}: there is no such file, a problem file (.toml) is expected", name=label) from error
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise InputError(f"{label}: the file cannot be read ({reason}), a problem file (.toml) is expected", name=label) from error
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        message = f"{label}: this is not a text file (byte {error.start} is no UTF-8), a problem file (.toml) is expected"
        raise InputError(message, name=label) from error
    if "\0" in text:
        raise InputError(f"{label}: this is a binary file, a problem file (.toml) is expected", name=label)
    if not text.strip():
        raise InputError(f"{label}: the file is empty, a problem with model and [posture] is expected", name=label)
    try:
        return tomllib.loads(text)
    except RecursionError as error:
        raise InputError(f"{label}: the TOML is nested too deeply to be read", name=label) from error
    except ValueError as error:
        raise InputError(f"{label}: {_toml_fault(str(error), text)}", name=label) from error


def _toml_fault(message: str, text: str) -> str:
    """What is wrong with malformed TOML, with the line and the column of the place."""
    place = _PLACE.search(message)
    what = message[: place.start()].strip() if place else message
    lines = text.replace("\r\n", "\n").split("\n")
    line, column = (int(place[1]), int(place[2])) if place and place[1] else (len(lines), len(lines[-1]) + 1)
    return f"malformed TOML at line {line}, column {column}: {what}"
