"""What every engine offers: compile a model for a shape once, solve instances of it often."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

from numpy.typing import ArrayLike

from socp_statics.engines.solution import Solution
from socp_statics.models.program import ConicModel


class EngineSession(Protocol):
    """One instance whose parameters change a little from solve to solve."""

    def solve(self, **changed: ArrayLike) -> Solution:
        """Solve with some parameters changed; they stay changed."""
        ...


class CompiledModel(Protocol):
    """A model compiled for one shape."""

    def session(self, values: Mapping[str, ArrayLike]) -> EngineSession:
        """An instance for many solves; values of all parameters by name."""
        ...

    def solve(self, values: Mapping[str, ArrayLike]) -> Solution:
        """One solve."""
        ...


class Engine(Protocol):
    """A way to solve conic programs."""

    name: str

    def accepts(self, model: ConicModel | None, form: str) -> bool:
        """Whether the engine solves this model, or without one any model, in this form ("socp" or "sdp")."""
        ...

    def compile(self, model: ConicModel, shape: Any) -> CompiledModel:
        """The model compiled for a shape; made once and kept."""
        ...
