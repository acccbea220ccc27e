"""The errors of the toolkit: one base, one for wrong input, one for a breakdown of the computation.

An answer such as "unstable", "infeasible" or "empty" is never an exception.
"""

from __future__ import annotations


class StaticsError(Exception):
    """Base of everything this package raises on purpose.

    Args:
        message: One plain sentence that says what is wrong and what was expected.
        name: The contact, joint, robot, engine or file the sentence complains about.
        field: The key or argument of it, for example ``"friction"``.
    """

    def __init__(self, message: str, *, name: str | None = None, field: str | None = None):
        super().__init__(message)
        self.name = name
        self.field = field


class InputError(StaticsError, ValueError):
    """The input is wrong; the sentence names the culprit and what was expected."""


class EngineError(StaticsError, RuntimeError):
    """The computation broke down: no engine could settle the program to the accuracy asked for."""
