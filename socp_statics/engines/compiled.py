"""The compiled engine: a program canonicalised once, its numbers updated in place, solved by Clarabel directly."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import clarabel
import numpy as np
from numpy.typing import ArrayLike

from socp_statics.engines.conic_form import Cones, ConicData, ConicForm
from socp_statics.engines.solution import FAILED, INFEASIBLE, SOLVED, UNBOUNDED, Residuals, Solution
from socp_statics.models.program import ConicModel
from socp_statics.spatial import Array

NAME = "clarabel"
TOLERANCE = 1e-11
ACCEPTED = 1e-8
INFEASIBLE_TOLERANCE = 1e-10
OTHER_REGULARISATIONS = (1e-10, 1e-7)
STATUS = {
    "Solved": SOLVED,
    "AlmostSolved": SOLVED,
    "PrimalInfeasible": INFEASIBLE,
    "DualInfeasible": UNBOUNDED,
}


def solver_settings() -> clarabel.DefaultSettings:
    """Settings that let the data be updated in place and reproduce the same bytes."""
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.presolve_enable = False
    settings.chordal_decomposition_enable = False
    settings.input_sparse_dropzeros = False
    settings.max_threads = 1
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = TOLERANCE
    settings.reduced_tol_gap_abs = settings.reduced_tol_gap_rel = settings.reduced_tol_feas = ACCEPTED
    settings.tol_infeas_abs = settings.tol_infeas_rel = INFEASIBLE_TOLERANCE
    settings.reduced_tol_infeas_abs = settings.reduced_tol_infeas_rel = 1e-12
    return settings


def clarabel_cones(cones: Cones) -> list[Any]:
    """The cones in Clarabel's words."""
    out: list[Any] = []
    if cones.zero:
        out.append(clarabel.ZeroConeT(cones.zero))
    if cones.nonneg:
        out.append(clarabel.NonnegativeConeT(cones.nonneg))
    out += [clarabel.SecondOrderConeT(n) for n in cones.soc]
    return out + [clarabel.PSDTriangleConeT(n) for n in cones.psd]


class Session:
    """One instance of a program in one solver; a few parameters change from solve to solve.

    Args:
        form: Canonical form of the program.
        values: Values of all its parameters.
    """

    def __init__(self, form: ConicForm, values: Mapping[str, ArrayLike]):
        self._form = form
        self._p = form.parameter_vector(values)
        self._data = form.data(self._p)
        self._offset = form.offset(self._p)
        self._costs: dict[str, tuple[Array, Array]] = {}
        self._solver = clarabel.DefaultSolver(*self._data, clarabel_cones(form.cones), solver_settings())

    def solve(self, **changed: ArrayLike) -> Solution:
        """Solve with some parameters changed; they stay changed.

        Args:
            **changed: New values by parameter name.

        Returns:
            The solution.
        """
        if changed:
            form, p = self._form, self._p
            for name, value in changed.items():
                form.put(p, name, value)
            if len(changed) == 1 and form.only_q[name]:
                base, slope = self._cost(name)
                q = base + slope @ p[form.where[name]]
                self._data = ConicData(self._data.P, q, self._data.A, self._data.b)
                self._solver.update(q=q)
            else:
                self._costs.clear()
                self._data = form.data(p)
                self._solver.update(**{key: value for key, value in self._data._asdict().items() if key != "P" or value.nnz})
                self._offset = form.offset(p)
        solution = CompiledSolution(self._form, self._data, self._offset, self._solver.solve())
        for regularisation in OTHER_REGULARISATIONS:
            if solution.status != FAILED:
                break
            # Sets with hardly any interior are lost in Clarabel's usual regularisation, rows that nearly repeat each other need more.
            settings = solver_settings()
            settings.static_regularization_constant = regularisation
            raw = clarabel.DefaultSolver(*self._data, clarabel_cones(self._form.cones), settings).solve()
            solution = CompiledSolution(self._form, self._data, self._offset, raw)
        return solution

    def _cost(self, name: str) -> tuple[Array, Array]:
        """Q as an affine function of one parameter, the others as they are."""
        if name not in self._costs:
            others = self._p.copy()
            others[self._form.where[name]] = 0.0
            self._costs = {name: (self._form.linear_cost(others), self._form.cost_slope(name))}
        return self._costs[name]


class CompiledSolution:
    """Clarabel's answer to one instance; see `engines.solution.Solution`."""

    engine = NAME

    def __init__(self, form: ConicForm, data: ConicData, offset: float, raw: Any):
        self._form, self._conic, self._offset, self._raw = form, data, offset, raw
        self.detail = str(raw.status)
        self.status = STATUS.get(self.detail, FAILED)
        # The solver stopped short of what it was asked for: what it has is judged by its residuals.
        if self.status == FAILED and max(self.residuals) <= ACCEPTED:
            self.status = SOLVED

    @property
    def objective(self) -> float:
        """Value of the objective, scaled."""
        return self._in_the_sense_of_the_program(self._raw.obj_val)

    @property
    def bound(self) -> float:
        """Value of the dual objective, scaled."""
        return self._in_the_sense_of_the_program(self._raw.obj_val_dual)

    def _in_the_sense_of_the_program(self, value: float) -> float:
        return -(value + self._offset) if self._form.maximise else value + self._offset

    @cached_property
    def variables(self) -> Mapping[str, Array]:
        """Variables by name."""
        return self._form.variables(np.asarray(self._raw.x))

    def variable(self, name: str) -> Sequence[float]:
        """One variable without the others."""
        x = self._raw.x
        return [x[i] for i in self._form.variable_places[name]]

    @cached_property
    def duals(self) -> Mapping[str, Array]:
        """Multipliers by constraint name."""
        return self._form.duals(np.asarray(self._raw.z))

    @cached_property
    def gap(self) -> float:
        """Relative gap recomputed from the data."""
        return self._form.gap(self._conic, np.asarray(self._raw.x), np.asarray(self._raw.z))

    @cached_property
    def residuals(self) -> Residuals:
        """Residuals recomputed from the data."""
        return self._form.residuals(self._conic, np.asarray(self._raw.x), np.asarray(self._raw.z))


class Compiled:
    """A model compiled for one shape."""

    def __init__(self, model: ConicModel, shape: Any):
        self._form = ConicForm(model.declare(shape))

    def session(self, values: Mapping[str, ArrayLike]) -> Session:
        """A solver built on real data, for many solves that differ in few parameters."""
        return Session(self._form, values)

    def solve(self, values: Mapping[str, ArrayLike]) -> Solution:
        """One solve."""
        return self.session(values).solve()


class CompiledEngine:
    """Clarabel on canonical data; compilations are kept by model and shape."""

    name = NAME

    def __init__(self) -> None:
        self._cache: dict[tuple[str, Any], Compiled] = {}

    def accepts(self, model: ConicModel, form: str) -> bool:
        """Every model in every form."""
        return True

    def compile(self, model: ConicModel, shape: Any) -> Compiled:
        """The compiled model, made once for each shape."""
        key = (model.name, shape)
        if key not in self._cache:
            self._cache[key] = Compiled(model, shape)
        return self._cache[key]
