"""What an engine answers: a status, the variables, the multipliers, and residuals that are computed, never believed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple, Protocol

from socp_statics.spatial import Array

SOLVED = "solved"
INFEASIBLE = "infeasible"
UNBOUNDED = "unbounded"
FAILED = "failed"


class Residuals(NamedTuple):
    """How far a solution is from optimal, in the scaled units of the program.

    Attributes:
        primal: Largest violation of the constraints.
        dual: Largest violation of the dual constraints.
        gap: Absolute difference of the primal and the dual objective over 1 + |objective|.
    """

    primal: float
    dual: float
    gap: float


class Solution(Protocol):
    """Outcome of one solve; everything but the status is extracted on first access."""

    @property
    def status(self) -> str:
        """"solved", "infeasible", "unbounded" or "failed"; the first three are answers."""
        ...

    @property
    def engine(self) -> str:
        """Name of the engine that answered."""
        ...

    @property
    def detail(self) -> str:
        """The solver's own word for the status."""
        ...

    @property
    def objective(self) -> float:
        """Value of the objective, in scaled units."""
        ...

    @property
    def bound(self) -> float:
        """Value of the dual objective, in scaled units: no feasible point is better."""
        ...

    @property
    def variables(self) -> Mapping[str, Array]:
        """Variables by name; of an unbounded program, a direction that improves the objective without end."""
        ...

    def variable(self, name: str) -> Sequence[float]:
        """One variable without the others: what a tracer asks thousands of times."""
        ...

    @property
    def duals(self) -> Mapping[str, Array]:
        """Multipliers by constraint name, flat; of an infeasible program, the multipliers that prove it."""
        ...

    @property
    def gap(self) -> float:
        """Relative difference of the primal and the dual objective, recomputed from the data of the program."""
        ...

    @property
    def residuals(self) -> Residuals:
        """Residuals recomputed from the data of the program."""
        ...
