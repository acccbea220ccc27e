"""Output files: refused before anything is computed, and never left half written."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from socp_statics.exceptions import InputError


def check_writable(path: Path, option: str) -> None:
    """Refuse an output file that cannot be written.

    Args:
        path: The file; it need not exist.
        option: The option that named it, for the error sentence.

    Raises:
        InputError: It is a folder, its folder does not exist, or one of them may not be written.
    """
    try:
        if path.is_dir():
            raise InputError(f"{option} {path}: this is a folder, a file that can be written is expected", name=str(path), field=option)
        if path.exists() and not os.access(path, os.W_OK):
            raise InputError(f"{option} {path}: this file may not be written", name=str(path), field=option)
        if not path.exists() or path.is_file():
            probe = _beside(path)
            probe.touch(exist_ok=False)
            probe.unlink()
    except (OSError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        message = f"{option} {path}: a file that can be written is expected ({reason})"
        raise InputError(message, name=str(path), field=option) from error


def _beside(path: Path) -> Path:
    """A name in the folder of the file that a link leads to, with its ending, for a file that is not finished."""
    final = Path(os.path.realpath(path))
    return final.with_name(f".{os.getpid()}.{final.name[-200:]}")


@contextmanager
def finished_or_absent(path: Path) -> Iterator[Path]:
    """Write a file under another name, and give it its own when it is complete.

    Args:
        path: Where the file shall be.

    Yields:
        Where to write; with the same ending. A device or pipe is written directly.
    """
    if path.exists() and not path.is_file():
        yield path
        return
    draft = _beside(path)
    try:
        yield draft
        os.replace(draft, os.path.realpath(path))
    finally:
        draft.unlink(missing_ok=True)
