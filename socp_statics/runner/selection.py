"""Which problems a run is about: names, globs, families, folders and files, each read as text and no further."""

from __future__ import annotations

import glob
from collections.abc import Iterable, Iterator
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any, NamedTuple

from socp_statics.cases.named_problems import file_beside, problem_names, problems_folder
from socp_statics.cases.problem_text import read_toml
from socp_statics.exceptions import InputError
from socp_statics.registry import suggestion

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


def select(selectors: str | Path | Iterable[str | Path]) -> list[Source]:
    """The problems of some selectors, each once, in the order they are named.

    Args:
        selectors: Names, globs of names, families, folders, paths (and globs of paths) that end in .toml, one of them or several; none:
            all named problems.

    Raises:
        InputError: They are no selectors, one matches nothing, a file is not TOML, or two files would have one name in the records.
    """
    known = problem_names()
    found: dict[Path, tuple[str, str, bool]] = {}
    for selector in _listed(selectors) or ["*"]:
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


def _listed(selectors: str | Path | Iterable[str | Path]) -> list[str]:
    """The selectors as text; one alone is no list of its letters."""
    if isinstance(selectors, str | Path):
        return [str(selectors)]
    listed = list(selectors) if isinstance(selectors, Iterable) else [selectors]
    for selector in listed:
        if not isinstance(selector, str | Path):
            message = f"selectors: a name, glob, family, folder or path that ends in .toml, or several, is expected, got {selector!r}"
            raise InputError(message, name=str(selector), field="selectors")
    return [str(selector) for selector in listed]


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
    near = file_beside(selector) or (f" (did you mean {same_end[0]!r}?)" if same_end else suggestion(plain, [*families, *known]))
    hint = near or f" (families: {', '.join(families)})"
    what = "matches no named problem" if any(c in selector for c in WILD) else "is no named problem, family or folder"
    return f"{selector!r} {what}{hint}; a path must end in .toml"
