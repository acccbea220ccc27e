"""The compiled engine: a program canonicalised once, its numbers updated in place, solved by Clarabel directly."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import clarabel
import numpy as np
from numpy.typing import ArrayLike

from socp_statics.engines.conic_form import Cones, ConicData, ConicForm
from socp_statics.engines.conic_session import ACCEPTED, ConicEngine, ConicSession, ConicSolution
from socp_statics.engines.solution import FAILED, INFEASIBLE, SOLVED, UNBOUNDED
from socp_statics.spatial import Array

NAME = "clarabel"
TOLERANCE = 1e-11
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


class Session(ConicSession):
    """One instance of a program in one solver."""

    def __init__(self, form: ConicForm, values: Mapping[str, ArrayLike]):
        super().__init__(form, values)
        self._solver = clarabel.DefaultSolver(*self.data, clarabel_cones(form.cones), solver_settings())

    def take_cost(self, q: Array) -> None:
        """Update the cost in place."""
        self._solver.update(q=q)

    def take_data(self) -> None:
        """Update all numbers in place."""
        self._solver.update(**{key: value for key, value in self.data._asdict().items() if key != "P" or value.nnz})

    def answer(self) -> ConicSolution:
        """Solve; where the solver stops short, on from there to rounding, and where it fails, again with another regularisation."""
        solution = self._finished(self._solver.solve())
        for regularisation in OTHER_REGULARISATIONS:
            if solution.status != FAILED:
                break
            # Sets with hardly any interior are lost in Clarabel's usual regularisation, rows that nearly repeat each other need more.
            settings = solver_settings()
            settings.static_regularization_constant = regularisation
            solution = self._finished(clarabel.DefaultSolver(*self.data, clarabel_cones(self.form.cones), settings).solve())
        return solution

    def _finished(self, raw: Any) -> ConicSolution:
        """Clarabel's answer, solved on to rounding where it is one that this can mend."""
        solution = CompiledSolution(self.form, self.data, self.offset, raw)
        return self.finish(solution, np.asarray(raw.s)) if solution.status in (SOLVED, FAILED) else solution


class CompiledSolution(ConicSolution):
    """Clarabel's answer to one instance."""

    engine = NAME

    def __init__(self, form: ConicForm, data: ConicData, offset: float, raw: Any):
        self._raw = raw
        detail = str(raw.status)
        super().__init__(form, data, offset, STATUS.get(detail, FAILED), detail, (raw.obj_val, raw.obj_val_dual))
        # The solver stopped short of what it was asked for: what it has is judged by its residuals.
        if self.status == FAILED and max(self.residuals) <= ACCEPTED:
            self.status = SOLVED

    @cached_property
    def x(self) -> Array:
        """The canonical variables."""
        return np.asarray(self._raw.x)

    @cached_property
    def y(self) -> Array:
        """The conic multipliers."""
        return np.asarray(self._raw.z)

    def variable(self, name: str) -> Sequence[float]:
        """One variable without the others."""
        x = self._raw.x
        return [x[i] for i in self.form.variable_places[name]]


class CompiledEngine(ConicEngine):
    """Clarabel on canonical data: every model in every form."""

    name = NAME
    session = Session
