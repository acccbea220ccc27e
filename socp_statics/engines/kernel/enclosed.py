"""Machine code that calls nothing but its own: each entry with its own copies of the inner functions it uses, compiled as one piece.

Numba gives the inner functions of all entries the same names and lets the loader take whichever copy came first. Copies were
optimised in different surroundings and differ in the last digit, so that an answer would depend on what was asked before it.
It also optimises an inner function and turns it into machine code by itself, and again with everything that calls it. Here an inner
function stays as it was lowered, and what it becomes part of is optimised once.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler
from numba.core.compiler_machinery import register_pass
from numba.core.registry import CPUDispatcher
from numba.core.typed_passes import NativeLowering


class PartLibrary(JITCodeLibrary):
    """The code of one function as it was lowered; the entry that needs it links it, and nobody else can."""

    def add_linking_library(self, library: JITCodeLibrary) -> None:
        """Remember what the function calls.

        Args:
            library: A part, or a library of Numba's own, which is finished first.
        """
        if not isinstance(library, PartLibrary):
            library._ensure_finalized()
        self._linking_libraries.append(library)

    def finalize(self) -> None:
        """Refuse.

        Raises:
            TypeError: Always.
        """
        raise TypeError(f"{self.name} is an inner function: only entries can call it")


class EnclosedLibrary(PartLibrary):
    """The code of an entry and of all its parts, seen by nobody else."""

    def __init__(self, codegen: Any, name: str):
        super().__init__(codegen, name)
        self._part_names: set[str] = set()

    def finalize(self) -> None:
        """Link the parts, optimise and make machine code."""
        parts, others = _parts_of(self)
        for part in parts:
            self._part_names.update(one.name for one in part._final_module.functions if not one.is_declaration)
            self._final_module.link_in(part._final_module, preserve=True)
        self._linking_libraries = others
        super(PartLibrary, self).finalize()

    def _optimize_final_module(self) -> None:
        super()._optimize_final_module()
        self._enclose()

    def _enclose(self) -> None:
        for value in (*self._final_module.functions, *self._final_module.global_variables):
            if not value.is_declaration and (value.linkage.name == "linkonce_odr" or value.name in self._part_names):
                value.linkage = "internal"


def _parts_of(library: PartLibrary) -> tuple[list[PartLibrary], list[JITCodeLibrary]]:
    """All parts below a library, and the other libraries that it and they call, each once and callers first."""
    parts: dict[PartLibrary, None] = {}
    others: dict[JITCodeLibrary, None] = {}
    waiting = [library]
    while waiting:
        for one in waiting.pop()._linking_libraries:
            if not isinstance(one, PartLibrary):
                others.setdefault(one)
            elif one not in parts:
                parts[one] = None
                waiting.append(one)
    return list(parts), list(others)


@register_pass(mutates_CFG=True, analysis_only=False)
class _PartLowering(NativeLowering):
    """Lowering of an inner function, without anything that Python or the loader would need."""

    _name = "part_lowering"

    def run_pass(self, state: Any) -> bool:
        state.library = PartLibrary(state.targetctx.codegen(), state.func_id.func_qualname)
        # What is not compiled has neither an address nor a wrapper.
        state.flags.no_compile = state.flags.no_cpython_wrapper = state.flags.no_cfunc_wrapper = True
        super().run_pass(state)
        lowered = state["cr"]
        # Callers look the function up by this key; for what is compiled it is the function that Python calls.
        key = object()
        state.targetctx.insert_user_function(key, lowered.fndesc, [state.library])
        state["cr"] = lowered._replace(cfunc=key)
        return True


@register_pass(mutates_CFG=True, analysis_only=False)
class _EnclosedLowering(NativeLowering):
    """Lowering of an entry."""

    _name = "enclosed_lowering"

    def run_pass(self, state: Any) -> bool:
        state.library = EnclosedLibrary(state.targetctx.codegen(), state.func_id.func_qualname)
        state.library.enable_object_caching()
        return bool(super().run_pass(state))


class _PartCompiler(Compiler):
    """Numba's passes with the lowering of inner functions."""

    lowering: type[NativeLowering] = _PartLowering

    def define_pipelines(self) -> list[Any]:
        pipelines: list[Any] = super().define_pipelines()
        for one in pipelines:
            one.passes = [(self.lowering if which is NativeLowering else which, about) for which, about in one.passes]
        return pipelines


class EnclosedCompiler(_PartCompiler):
    """Numba's passes with the lowering of entries; the ``pipeline_class`` of a dispatcher."""

    lowering = _EnclosedLowering


class Part(CPUDispatcher):
    """An inner function: entries and other inner functions call it, Python cannot.

    Args:
        function: The Python function.
        options: Options of `numba.njit`.
    """

    def __init__(self, function: Callable[..., Any], options: dict[str, Any]):
        super().__init__(function, targetoptions={"nopython": True, **options}, pipeline_class=_PartCompiler)

    def add_overload(self, result: Any) -> None:
        """Keep what was compiled for callers that are compiled; there is nothing for Python to call."""
        self.overloads[tuple(result.signature.args)] = result

    def _compile_for_args(self, *arguments: Any, **named: Any) -> Any:
        raise TypeError(f"{self.__qualname__} is an inner function: only entries can call it; Python can call its py_func")
