"""The problems that come with the toolkit, found by name from any folder."""

from __future__ import annotations

import tomllib
from functools import cache
from pathlib import Path

from socp_statics.exceptions import InputError
from socp_statics.registry import suggestion


@cache
def problems_folder() -> Path:
    """Where the named problems are: inside the installed package, else in the checkout beside it."""
    package = Path(__file__).resolve().parents[1]
    installed = package / "named_problems"
    return installed if installed.is_dir() else package.parent / "problems"


def problem_names() -> list[str]:
    """All names, sorted, such as ``contacts/flat_double_stance``."""
    folder = problems_folder()
    return sorted(path.relative_to(folder).with_suffix("").as_posix() for path in folder.rglob("*.toml"))


def problem_path(name: str) -> Path:
    """The file of a named problem.

    Args:
        name: Its name without ``.toml``.

    Raises:
        InputError: There is none; the sentence offers near names, the problems of a family, or says how paths are written.
    """
    names = problem_names()
    if name in names:
        return problems_folder() / f"{name}.toml"
    family = name.rstrip("/")
    members = [known for known in names if known.startswith(f"{family}/")]
    if members:
        message = f"{name!r} is a family of problems, one problem is expected: {', '.join(members)}"
    elif name and Path(name).is_dir():
        message = f"{name!r} is a folder, the name of a problem or a path that ends in .toml is expected"
    else:
        same_end = [known for known in names if family and known.rpartition("/")[2] == family]
        hint = file_beside(name) or (f" (did you mean {same_end[0]!r}?)" if same_end else suggestion(name, names))
        listed = hint or " (they are listed by socp-statics list problems)"
        message = f"{name!r} is not a named problem{listed}; a path must end in .toml"
    raise InputError(message, name=name, field="PROBLEM")


def file_beside(name: str) -> str:
    """The end of a sentence that offers the file which someone named without its ending; nothing where there is none.

    Args:
        name: What was written.
    """
    try:
        return f" (did you mean '{name}.toml'?)" if name and Path(f"{name}.toml").is_file() else ""
    except (OSError, ValueError):
        return ""


def describe_problems() -> dict[str, str]:
    """The description of every named problem, in the order of `problem_names`."""
    lines = {}
    for name in problem_names():
        try:
            stated = tomllib.loads((problems_folder() / f"{name}.toml").read_text(encoding="utf-8"))
        except (OSError, ValueError):
            stated = {"description": "(cannot be read)"}
        lines[name] = str(stated.get("description", ""))
    return lines
