"""The reference engine: cvxpy itself, with any installed solver; slow, and what the others are tested against."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import cvxpy as cp
import numpy as np
from numpy.typing import ArrayLike

from socp_statics.engines.conic_form import ConicForm, flat_multiplier
from socp_statics.engines.solution import FAILED, INFEASIBLE, SOLVED, UNBOUNDED, Residuals, Solution
from socp_statics.exceptions import EngineError
from socp_statics.models.program import ConicModel, Program
from socp_statics.spatial import Array

NAME = "cvxpy"
STATUS = {
    cp.OPTIMAL: SOLVED,
    cp.INFEASIBLE: INFEASIBLE,
    cp.UNBOUNDED: UNBOUNDED,
}
OPTIONS: dict[str, dict[str, Any]] = {
    "CLARABEL": {"tol_gap_abs": 1e-11, "tol_gap_rel": 1e-11, "tol_feas": 1e-11, "max_threads": 1,
                 "reduced_tol_gap_abs": 1e-8, "reduced_tol_gap_rel": 1e-8, "reduced_tol_feas": 1e-8},
    "SCS": {"eps_abs": 1e-9, "eps_rel": 1e-9, "max_iters": 200_000},
}  # fmt: skip


class ReferenceSession:
    """A declared program whose parameters change from solve to solve.

    Args:
        program: The declared program.
        solver: Name of a solver cvxpy knows.
        values: Values of all its parameters.
    """

    def __init__(self, program: Program, solver: str, values: Mapping[str, ArrayLike]):
        self._program, self._solver = program, solver
        self._values = {name: np.asarray(values[name], dtype=float) for name in program.parameters}

    def solve(self, **changed: ArrayLike) -> Solution:
        """Solve with some parameters changed; they stay changed."""
        program = self._program
        self._values |= {name: np.asarray(value, dtype=float) for name, value in changed.items()}
        for name, parameter in program.parameters.items():
            parameter.value = self._values[name]
        try:
            with warnings.catch_warnings():
                # An inaccurate status is judged here, by the residuals.
                warnings.filterwarnings("ignore", "Solution may be inaccurate", UserWarning)
                # Warm-started solvers are kept by cvxpy and make the answer depend on earlier questions.
                program.problem.solve(solver=self._solver, warm_start=False, **OPTIONS.get(self._solver, {}))
            detail = program.problem.status
        except cp.SolverError as error:
            detail = f"{cp.SOLVER_ERROR}: {error}"
        if detail == cp.OPTIMAL_INACCURATE and self._solver == "CLARABEL":
            status = SOLVED
        else:
            status = STATUS.get(detail, FAILED)
        return ReferenceSolution(program, dict(self._values), status, f"{self._solver} {detail}")


class ReferenceSolution:
    """cvxpy's answer to one instance; see `engines.solution.Solution`."""

    engine = NAME

    def __init__(self, program: Program, values: Mapping[str, Array], status: str, detail: str):
        self.status, self.detail = status, detail
        self._program, self._values = program, values
        answered = status == SOLVED
        self.objective = float(program.problem.value) if answered else float("nan")
        self.bound = self.objective
        self.variables = {name: np.array(v.value, dtype=float) for name, v in program.variables.items()} if answered else {}
        multipliers = {name: c.dual_value for name, c in program.constraints.items()}
        known = all(y is not None for y in multipliers.values())
        self.duals = {name: flat_multiplier(y) for name, y in multipliers.items()} if known else {}

    def variable(self, name: str) -> Sequence[float]:
        """One variable without the others."""
        return self.variables[name].ravel().tolist()

    @property
    def gap(self) -> float:
        """Relative gap recomputed from the data."""
        return self.residuals.gap

    @cached_property
    def residuals(self) -> Residuals:
        """Residuals recomputed from the data."""
        if not self.variables or not self.duals:
            raise EngineError("residuals need a solution with multipliers, the solver returned none", name=NAME)
        form = ConicForm(self._program)
        data = form.data(form.parameter_vector(self._values))
        return form.residuals(data, form.primal_vector(self.variables), form.conic_multipliers(self.duals))


class Declared:
    """A model declared for one shape."""

    def __init__(self, model: ConicModel, shape: Any, solver: str):
        self._program, self._solver = model.declare(shape), solver

    def session(self, values: Mapping[str, ArrayLike]) -> ReferenceSession:
        """The program with its values, for many solves that differ in few parameters."""
        return ReferenceSession(self._program, self._solver, values)

    def solve(self, values: Mapping[str, ArrayLike]) -> Solution:
        """One solve."""
        return self.session(values).solve()


class ReferenceEngine:
    """cvxpy with a named solver.

    Args:
        solver: A solver cvxpy knows and finds installed.

    Raises:
        EngineError: The solver is not installed.
    """

    name = NAME

    def __init__(self, solver: str = "CLARABEL"):
        if solver not in cp.installed_solvers():
            raise EngineError(f"solver {solver} is not installed, cvxpy finds {', '.join(cp.installed_solvers())}", name=solver)
        self._solver = solver
        self._cache: dict[tuple[str, Any], Declared] = {}

    def accepts(self, model: ConicModel | None, form: str) -> bool:
        """Every model in every form, as far as the solver has the cones."""
        return True

    def compile(self, model: ConicModel, shape: Any) -> Declared:
        """The declared model, made once for each shape."""
        key = (model.name, shape)
        if key not in self._cache:
            self._cache[key] = Declared(model, shape, self._solver)
        return self._cache[key]
