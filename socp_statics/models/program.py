"""What a model is: a program declared in cvxpy for a shape, and the numbers that go into its parameters."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import cvxpy as cp


class Program(NamedTuple):
    """A declared program.

    Attributes:
        problem: The cvxpy problem, affine in its parameters (DPP).
        variables: Variables by the symbol of the chapter.
        constraints: Constraints by name; an engine returns their multipliers under the same names.
    """

    problem: cp.Problem
    variables: dict[str, cp.Variable]
    constraints: dict[str, cp.Constraint]

    @property
    def parameters(self) -> dict[str, cp.Parameter]:
        """Parameters by name."""
        return {p.name(): p for p in self.problem.parameters()}


@dataclass(frozen=True)
class ConicModel:
    """One question of statics as a conic program.

    Attributes:
        name: Name in the registry.
        declare: Shape -> Program.
        semidefinite: Whether its programs have semidefinite cones in every form.
        only_steps: Whether its answers are steps of a search that judges where they lead by other means: the accuracy of a solver is
            enough for them, and solving them on to rounding not worth its time.
    """

    name: str
    declare: Callable[[Any], Program]
    semidefinite: bool = False
    only_steps: bool = False
