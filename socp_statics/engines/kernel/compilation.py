"""Compiling the kernel when it is first called.

Numba turns the functions of this folder into machine code, which takes half a minute once and a fraction of a second from the disk
cache (`disk_cache`). Importing a module of the kernel compiles nothing.
"""

from __future__ import annotations

import gc
import hashlib
import sys
import threading
import time
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules
from typing import Any

import numba

from socp_statics.engines.kernel.disk_cache import DiskCache, folder_of, note_source
from socp_statics.engines.kernel.enclosed import EnclosedCompiler, Part

# Sums may be reordered and quotients become products; NaN and infinity keep their meaning, because the solver tests for them.
OPTIONS: dict[str, Any] = {"nogil": True, "error_model": "numpy", "fastmath": {"reassoc", "contract", "arcp", "nsz"}}

KERNEL = Path(__file__).resolve().parent
PACKAGE = __name__.rpartition(".")[0]
# Modules of the kernel that have no entries and import more than Numba.
WITHOUT_ENTRIES = frozenset({"engine"})

_entries: list[Entry] = []
_lock = threading.RLock()


class _Notice:
    """What a terminal is told: one line before a process first compiles, one when that entry and those asked for with it are done."""

    def __init__(self) -> None:
        self.depth = 0
        self.began: float | None = None
        self.ended = False

    def __enter__(self) -> _Notice:
        self.depth += 1
        return self

    def __exit__(self, *raised: object) -> None:
        self.depth -= 1
        if self.depth == 0 and self.began is not None and not self.ended:
            self.ended = True
            self._say(f"compiled in {time.perf_counter() - self.began:.1f} s")

    def begin(self) -> None:
        """Called before an entry is compiled."""
        if self.began is None:
            self.began = time.perf_counter()
            self._say("compiling the kernel for this machine, once; this takes about half a minute")

    def _say(self, line: str) -> None:
        # A process without a console has no stream at all, and a log should not tell a first run from a second.
        if sys.stderr is not None and sys.stderr.isatty():
            print(f"socp-statics: {line}", file=sys.stderr, flush=True)


_notice = _Notice()


def _folder(function: Callable[..., Any]) -> Path:
    """The folder of a function's file, its digest taken.

    Raises:
        TypeError: The function is not at the top level of its module. Numba names machine code by module, function, types and order
            of compilation, so two functions of one factory, compiled by two processes, get one name and are taken for each other.
    """
    if "<locals>" in function.__qualname__:
        raise TypeError(f"{function.__qualname__} must be at the top level of its module: the cache cannot tell two copies of it apart")
    source = Path(function.__code__.co_filename).resolve().parent
    note_source(source)
    return source


class Entry:
    """A compiled function that Python calls; made by `entry`.

    Args:
        function: The Python function.
        signature: Its Numba signature.
        options: Options of `numba.njit`.

    Attributes:
        py_func: The Python function.
        signature: Its Numba signature.
    """

    def __init__(self, function: Callable[..., Any], signature: str, options: dict[str, Any]):
        self.py_func = function
        self.signature = signature
        self._options = options
        self._source = _folder(function)
        self._call: Callable[..., Any] = self._first
        self._address: int | None = None
        self.__name__ = function.__name__
        self.__qualname__ = function.__qualname__
        self.__module__ = function.__module__
        self.__doc__ = function.__doc__
        _entries.append(self)

    def __call__(self, *arguments: Any) -> Any:
        """Call the compiled function; the first call compiles it or loads it from the cache."""
        return self._call(*arguments)

    def __repr__(self) -> str:
        return f"<entry {self.__module__}.{self.__qualname__}>"

    def _first(self, *arguments: Any) -> Any:
        return self.load()(*arguments)

    def load(self) -> Callable[..., Any]:
        """Compile the function, or load it from the cache, now.

        Returns:
            The compiled function itself, which a tight loop may call directly.
        """
        with _lock, _notice:
            if self._call == self._first:
                self._call = self._compiled()
            return self._call

    def address(self) -> int:
        """Where the compiled function is, for other entries to call it by (`by_address`); compiles or loads it if need be.

        Returns:
            The address; 0 where nothing is compiled.
        """
        if numba.config.DISABLE_JIT:
            return 0
        if self._address is None:
            (one,) = self.load().overloads.values()  # type: ignore[attr-defined]
            self._address = int(one.library.get_pointer_to_function(one.fndesc.llvm_cfunc_wrapper_name))
        return self._address

    def _compiled(self) -> Callable[..., Any]:
        dispatcher = numba.njit(**self._options, pipeline_class=EnclosedCompiler)(self.py_func)
        if numba.config.DISABLE_JIT:
            return dispatcher
        dispatcher._cache = self._cache()
        # The compiler makes millions of objects that live on; looking through them for garbage is an eighth of its time.
        collecting = gc.isenabled()
        gc.disable()
        try:
            dispatcher.compile(self.signature)
        finally:
            if collecting:
                gc.enable()
        dispatcher.disable_compile()
        return dispatcher

    def _cache(self) -> DiskCache:
        package, _, module = self.__module__.rpartition(".")
        unique = f"{self.__module__} {self.py_func.__code__.co_firstlineno} {self.signature}"
        name = f"{module}.{self.__qualname__}-{hashlib.sha256(unique.encode()).hexdigest()[:10]}"
        return DiskCache(name, self._source, package, _notice.begin)

    def kept(self) -> bool:
        """Whether the function is compiled already, in this process or on disk, or never will be."""
        return self._call != self._first or numba.config.DISABLE_JIT or self._cache().found()


def inner(function: Callable[..., Any] | None = None, **options: Any) -> Any:
    """Decorate a function that entries call: it becomes part of each entry that uses it.

    Args:
        function: The function, when the decorator is used without options.
        options: Options of `numba.njit` that replace those of the kernel, for example ``fastmath=False``.

    Returns:
        What entries call, or a decorator when only options were given.

    Raises:
        TypeError: The function is not at the top level of its module.
    """
    if function is None:
        return lambda decorated: inner(decorated, **options)
    _folder(function)
    return function if numba.config.DISABLE_JIT else Part(function, {**OPTIONS, **options})


def entry(signature: str, **options: Any) -> Callable[[Callable[..., Any]], Entry]:
    """Decorate a function that Python calls: compiled with one signature, or loaded from the disk cache, when first called.

    Every number the function freezes must come from the files of its own folder: those are what the cache compares.

    Args:
        signature: Numba signature with the return type, for example ``"int64(float64[::1], int64)"``.
        options: Options of `numba.njit` that replace those of the kernel.

    Returns:
        The decorator; what it makes is called like the function, without keywords.

    Raises:
        TypeError: The function is not at the top level of its module.
    """
    return lambda function: Entry(function, signature, {**OPTIONS, **options})


def compiling() -> _Notice:
    """A context for several entries that a terminal is told of as one."""
    return _notice


def entries_of(package: str) -> tuple[Entry, ...]:
    """Every entry of a package, its modules imported.

    Args:
        package: Name of the package.
    """
    for module in iter_modules(import_module(package).__path__, f"{package}."):
        if module.name.rpartition(".")[2] not in WITHOUT_ENTRIES:
            import_module(module.name)
    return tuple(one for one in _entries if one.__module__.startswith(f"{package}."))


def compile_all(package: str = PACKAGE) -> None:
    """Compile every entry of a package now, or load it from the cache, for callers that want to pay up front.

    Args:
        package: Name of the package; by default the kernel.
    """
    from socp_statics.engines.kernel.side_by_side import load_side_by_side

    load_side_by_side(entries_of(package))


def entry_folder(one: Entry) -> Path | None:
    """The folder that holds an entry, or will; None when no place can be written."""
    return folder_of(one._source, one.__module__.rpartition(".")[0])


note_source(KERNEL)
