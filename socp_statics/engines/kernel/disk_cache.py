"""Keeping the kernel's machine code on disk: where, under which name, and never trusting what is found there.

Compiled code is only as fresh as everything it was made from, so it lives in a folder named by a digest of all sources of the kernel,
of the versions, and of the processor; any change starts a new folder, and folders nobody used for a month go. A file starts with the
digest of its own content: what was truncated or damaged never reaches the loader, and is compiled afresh like what is missing.
"""

from __future__ import annotations

import hashlib
import os
import pickle
import platform
import shutil
import sys
import threading
import time
import uuid
import warnings
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import llvmlite
import llvmlite.binding
import numba
import numpy as np
from numba.core.compiler import CompileResult
from numba.core.runtime import rtsys
from numba.core.serialize import dumps

# Settings of Numba that change the code it makes.
CODE_SETTINGS = (
    "OPT",
    "LOOP_VECTORIZE",
    "SLP_VECTORIZE",
    "ENABLE_AVX",
    "CPU_NAME",
    "CPU_FEATURES",
    "BOUNDSCHECK",
    "USING_SVML",
    "DEBUGINFO_DEFAULT",
    "LLVM_REFPRUNE_PASS",
    "LLVM_REFPRUNE_FLAGS",
)
FOLDER_PREFIX = "compiled-"
DAY = 86400.0
UNUSED = 30 * DAY
CHECKSUM = hashlib.sha256().digest_size
# What reading a damaged or foreign file can raise: the file system, unpickling, and the loader of machine code.
UNREADABLE = (
    OSError,
    EOFError,
    ValueError,
    TypeError,
    LookupError,
    AttributeError,
    ImportError,
    RuntimeError,
    MemoryError,
    pickle.PickleError,
    numba.errors.NumbaError,
)

_sources: dict[Path, str] = {}
_warned = threading.Event()


def _source_digest(source: Path) -> str:
    """SHA-256 of the names and bytes of all Python files below a folder."""
    digest = hashlib.sha256()
    for path in sorted(source.rglob("*.py")):
        content = path.read_bytes()
        digest.update(f"{path.relative_to(source).as_posix()} {len(content)}\n".encode())
        digest.update(content)
    return digest.hexdigest()


def note_source(source: Path) -> None:
    """Take the digest of a folder now, before anybody can edit what is being imported from it; the first one counts.

    Args:
        source: A folder of Python files. One that does not exist (a module in an archive) is left out, and its code is not kept.
    """
    if source not in _sources and source.is_dir():
        _sources[source] = _source_digest(source)


@cache
def _machine() -> tuple[str, ...]:
    """Everything besides the sources that the machine code depends on."""
    settings = (f"{name}={getattr(numba.config, name, None)}" for name in CODE_SETTINGS)
    return (
        numba.__version__,
        llvmlite.__version__,
        np.__version__,
        sys.version,
        sys.platform,
        platform.machine(),
        llvmlite.binding.get_host_cpu_name(),
        llvmlite.binding.get_host_cpu_features().flatten(),
        *settings,
    )


def _folder_name(source: Path, package: str) -> str:
    key = "\n".join((_sources[source], package, *_machine()))
    return FOLDER_PREFIX + hashlib.sha256(key.encode()).hexdigest()[:20]


def _user_cache() -> Path | None:
    """The user's cache folder, or None when there is no home."""
    stated = os.environ.get({"win32": "LOCALAPPDATA", "darwin": ""}.get(sys.platform, "XDG_CACHE_HOME"), "")
    if os.path.isabs(stated):
        return Path(stated)
    home = Path(os.path.expanduser("~"))
    # A home that does not exist is not made: accounts without one are written that way.
    if not (home.is_absolute() and home.is_dir()):
        return None
    return home / {"win32": "AppData/Local", "darwin": "Library/Caches"}.get(sys.platform, ".cache")


def _places(source: Path) -> tuple[Path, ...]:
    """The folders that may hold what was compiled from a source folder, best first."""
    stated = os.environ.get("SOCP_STATICS_CACHE")
    if stated:
        return (Path(stated).absolute(),)
    user = _user_cache()
    return (source / "__pycache__",) + ((user / "socp_statics",) if user else ())


def _write(path: Path, content: bytes) -> None:
    """Write a file so that another process sees all of it or nothing."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(f"{uuid.uuid4().hex}.part")
    try:
        part.write_bytes(content)
        os.replace(part, path)
    finally:
        part.unlink(missing_ok=True)


def _prune(place: Path, keep: str) -> None:
    """Remove the folders of a place that nobody used for a month."""
    oldest = time.time() - UNUSED
    for folder in place.glob(f"{FOLDER_PREFIX}*"):
        try:
            if folder.name != keep and folder.stat().st_mtime < oldest:
                shutil.rmtree(folder)
        except OSError:
            continue


def _mark_used(folder: Path) -> None:
    """Renew the date that `_prune` goes by; once a day is enough."""
    try:
        if time.time() - folder.stat().st_mtime > DAY:
            os.utime(folder)
    except OSError:
        return


def _warn_once(places: tuple[Path, ...]) -> None:
    if _warned.is_set():
        return
    _warned.set()
    tried = " or in ".join(str(place) for place in places) or "any folder"
    warnings.warn(
        f"the compiled kernel could not be kept in {tried}, so every process compiles it again; "
        "set SOCP_STATICS_CACHE to a folder that can be written",
        RuntimeWarning,
        stacklevel=2,
    )


def _outer_symbols(result: CompileResult) -> tuple[str, ...]:
    """Names of the functions and variables that compiled code takes from elsewhere."""
    module = result.library._final_module
    declared = (value.name for values in (module.functions, module.global_variables) for value in values if value.is_declaration)
    return tuple(name for name in declared if not name.startswith("llvm."))


def _without_bitcode(result: CompileResult) -> tuple[Any, ...]:
    """A compiled function taken apart for the file, without the intermediate code that Numba keeps for inlining it elsewhere.

    Parsing that code would be most of the time of loading; only the names it defines are looked at, and a function that does nothing
    defines them as well.
    """
    (name, kind, (machine_code, _)), *others = result._reduce()
    wrappers = (result.fndesc.llvm_cpython_wrapper_name, result.fndesc.llvm_cfunc_wrapper_name)
    assembly = "".join(f'define void @"{wrapper}"() {{ ret void }}\n' for wrapper in wrappers)
    return ((name, kind, (machine_code, llvmlite.binding.parse_assembly(assembly).as_bitcode())), *others)


class DiskCache:
    """One compiled function on disk, with the methods that a Numba dispatcher calls on its cache.

    Args:
        name: File name, unique in the package.
        source: Folder of the function's file, given to `note_source` before.
        package: Name of the package the function is in.
        missed: Called when nothing usable was found, before the compiler starts.
    """

    def __init__(self, name: str, source: Path, package: str, missed: Callable[[], None]):
        self.name = name
        self.source = source
        self.missed = missed
        known = source in _sources
        self.folder = _folder_name(source, package) if known else ""
        self.places = _places(source) if known else ()

    @property
    def cache_path(self) -> str | None:
        """The folder that is tried first."""
        return str(self.places[0] / self.folder) if self.places else None

    def found(self) -> bool:
        """Whether a place holds a copy, sound or not."""
        return any((place / self.folder / self.name).is_file() for place in self.places)

    def load_overload(self, signature: Any, target: Any) -> CompileResult | None:
        """The compiled function, or None when no place holds a sound copy.

        Args:
            signature: Not looked at: a file holds one function with one signature.
            target: Numba's target context.
        """
        # Numba's own cache refreshes the whole target first, which takes longer than importing Numba; loaded code needs the runtime only.
        rtsys.initialize(target)
        for place in self.places:
            path = place / self.folder / self.name
            try:
                content = path.read_bytes()
                if hashlib.sha256(content[CHECKSUM:]).digest() != content[:CHECKSUM]:
                    continue
                symbols, parts = pickle.loads(content[CHECKSUM:])
                # The loader ends the process at a name it cannot find, so what is not there yet is brought in.
                if not all(llvmlite.binding.address_of_symbol(symbol) for symbol in symbols):
                    target.refresh()
                result = CompileResult._rebuild(target, *parts)
            except UNREADABLE:
                continue
            _mark_used(path.parent)
            return result
        self.missed()
        return None

    def save_overload(self, signature: Any, result: CompileResult) -> None:
        """Keep a compiled function in the first place that can be written; warn once a process when there is none.

        Args:
            signature: Not looked at.
            result: What the compiler made.

        Raises:
            TypeError: The function freezes a pointer or a large global array, which no file can hold.
        """
        if result.library.has_dynamic_globals:
            raise TypeError(f"{self.name} cannot be kept: it freezes a pointer or a large global array")
        # Sources edited since they were imported would file the old code under the new digest.
        if self.places and _source_digest(self.source) != _sources[self.source]:
            return
        content = dumps((_outer_symbols(result), _without_bitcode(result)))
        for place in self.places:
            try:
                _write(place / self.folder / self.name, hashlib.sha256(content).digest() + content)
            except OSError:
                continue
            _prune(place, self.folder)
            return
        _warn_once(self.places)

    def flush(self) -> None:
        """Called by Numba to empty the cache; a new digest is a new file, so nothing is ever emptied."""


def folder_of(source: Path, package: str) -> Path | None:
    """The folder that holds what was compiled from a source folder, or will.

    Args:
        source: A folder given to `note_source`.
        package: Name of its package.

    Returns:
        The first place that has files; else the first that can be written; None when there is none.
    """
    folders = [place / _folder_name(source, package) for place in _places(source)]
    for folder in folders:
        if folder.is_dir() and any(folder.iterdir()):
            return folder
    for folder in folders:
        probe = folder / f"{uuid.uuid4().hex}.part"
        try:
            _write(probe, b"")
            probe.unlink()
        except OSError:
            continue
        return folder
    return None
