"""Which problems a run is about: names, globs, families, folders and files, each read as text and no further."""

from __future__ import annotations

import glob
from collections.abc import Iterable, Iterator
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any, NamedTuple

from socp_statics.cases.named_problems import problem_names, problems_folder
from socp_statics.cases.problem_text import read_toml
from socp_statics.exceptions import InputError
from socp_statics.registry import nearest

WILD = "*?["


class Source(NamedTuple):
    """A problem file that was selected.

    Attributes:
        name: What records call it.
        label: What sentences call it.
        path: The file.
        tables: What is in it.
        chosen: Whether it was named, not found by a pattern or in a folder.
    """

    name: str
    label: str
    path: Path
    tables: dict[str, Any]
    chosen: bool


def select(selectors: Iterable[str]) -> list[Source]:
    """The problems of some selectors, each once, in the order they are named.

    Args:
        selectors: Names, globs of names, families, folders, paths (and globs of paths) that end in .toml; none: all named problems.

    Raises:
        InputError: A selector matches nothing, a file is not TOML, or two files would have one name in the records.
    """
    known = problem_names()
    found: dict[Path, tuple[str, str, bool]] = {}
    for selector in list(selectors) or ["*"]:
        for name, label, path, chosen in _matches(selector, known):
            before = found.get(path)
            found[path] = (name, label, chosen or (before is not None and before[2]))
    by_name: dict[str, Path] = {}
    for path, (name, _, _) in found.items():
        other = by_name.setdefault(name, path)
        if other != path:
            message = f"{path}: its records would have the same name as those of {other}, files of different names are expected"
            raise InputError(message, name=name, field="SELECTOR")
    return [Source(name, label, path, read_toml(path, label), chosen) for path, (name, label, chosen) in found.items()]


def _matches(selector: str, known: list[str]) -> Iterator[tuple[str, str, Path, bool]]:
    """Name, label, file of each problem that a selector means, and whether it names it."""
    wild = any(c in selector for c in WILD)
    family = selector.rstrip("/")
    if selector.endswith(".toml"):
        paths = [Path(p) for p in sorted(glob.glob(selector))] if wild and not Path(selector).exists() else [Path(selector)]
        if not paths:
            raise InputError(f"{selector}: no file matches this pattern", name=selector, field="SELECTOR")
        yield from ((path.stem, str(path), path.resolve(), not wild) for path in paths)
        return
    names = [name for name in known if (fnmatchcase(name, selector) if wild else name == selector or name.startswith(f"{family}/"))]
    if names:
        yield from ((name, name, (problems_folder() / f"{name}.toml").resolve(), name == selector) for name in names)
        return
    if not wild and family and Path(selector).is_dir():
        paths = sorted(Path(selector).rglob("*.toml"))
        if not paths:
            raise InputError(f"{selector}: this folder holds no problem file (.toml)", name=selector, field="SELECTOR")
        yield from ((path.relative_to(selector).with_suffix("").as_posix(), str(path), path.resolve(), False) for path in paths)
        return
    raise InputError(_nothing(selector, known), name=selector, field="SELECTOR")


def _nothing(selector: str, known: list[str]) -> str:
    """The sentence about a selector that matches nothing, with names that are near."""
    families = sorted({name.partition("/")[0] for name in known})
    words = selector.rstrip("/")
    end = words.rpartition("/")[2]
    same_end = [name for name in known if end and name.rpartition("/")[2] == end]
    plain = words.translate(str.maketrans("", "", "*?[]")).strip("/")
    near = nearest(plain, [*families, *known])
    hint = f" (did you mean {same_end[0]!r}?)" if same_end else near if "did you mean" in near else f" (families: {', '.join(families)})"
    what = "matches no named problem" if any(c in selector for c in WILD) else "is no named problem, family or folder"
    return f"{selector!r} {what}{hint}; a path must end in .toml"
