"""Machine code that calls nothing but its own: each entry with its own copies of the inner functions it uses.

Numba gives the inner functions of all entries the same names and lets the loader take whichever copy came first. Copies were
optimised in different surroundings and differ in the last digit, so that an answer would depend on what was asked before it.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from numba.core.codegen import JITCodeLibrary


class EnclosedLibrary(JITCodeLibrary):
    """A library whose functions from other libraries are seen by nobody else; only the outermost one of a compilation is enclosed."""

    outermost = ""

    def _optimize_final_module(self) -> None:
        super()._optimize_final_module()
        if self.name != self.outermost:
            return
        for value in (*self._final_module.functions, *self._final_module.global_variables):
            if not value.is_declaration and value.linkage.name == "linkonce_odr":
                value.linkage = "internal"


@contextmanager
def enclosed(dispatcher: Any, name: str) -> Iterator[None]:
    """Compile a dispatcher's function as an enclosed library.

    Args:
        dispatcher: The Numba dispatcher.
        name: Qualified name of its function.
    """
    codegen = dispatcher.targetctx.codegen()
    usual = codegen._library_class
    codegen._library_class = type("EnclosedLibrary", (EnclosedLibrary,), {"outermost": name})
    try:
        yield
    finally:
        codegen._library_class = usual
