"""The kernel as an engine: canonical programs without semidefinite cones, solved by our own compiled interior-point method."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.engines.conic_form import ConicData, ConicForm
from socp_statics.engines.conic_session import ACCEPTED, ConicEngine, ConicSession, ConicSolution, HeldSolution
from socp_statics.engines.kernel import conic
from socp_statics.engines.kernel.side_by_side import load_side_by_side
from socp_statics.engines.solution import FAILED, INFEASIBLE, SOLVED, UNBOUNDED
from socp_statics.exceptions import EngineError
from socp_statics.models.program import ConicModel
from socp_statics.spatial import Array

NAME = "kernel"
ROUNDING = 1e-14
ANSWERS = {
    conic.SOLVED: (SOLVED, "solved"),
    conic.INFEASIBLE: (INFEASIBLE, "infeasible"),
    conic.UNBOUNDED: (UNBOUNDED, "unbounded"),
    conic.ITERATION_LIMIT: (FAILED, "iteration limit"),
    conic.STALLED: (FAILED, "stalled"),
}


@cache
def _compile_once() -> None:
    """Both entries at the same time, where they are not on disk."""
    load_side_by_side((conic.prepare, conic.solve))


class Session(ConicSession):
    """One instance of a program, prepared for many solves."""

    def __init__(self, form: ConicForm, values: Mapping[str, ArrayLike]):
        super().__init__(form, values)
        _compile_once()
        zero, A = form.cones.zero, self.data.A
        self._soc = np.array(form.cones.soc, dtype=np.int64)
        self._right = np.empty(form.columns), np.empty(zero), np.empty(form.rows - zero)
        self._slack = np.empty(form.rows - zero)
        # The pattern of the canonical matrix never changes, so where its entries go is found once.
        column = np.repeat(np.arange(form.columns), np.diff(A.indptr))
        order = np.lexsort((column, A.indices))
        equal, below = np.split(order, [np.searchsorted(A.indices[order], zero)])
        self._equal, self._place = equal, A.indices[equal] * form.columns + column[equal]
        self._below, self._row, self._column = below, A.indices[below] - zero, column[below].astype(np.int64)
        self.take_data()

    def take_cost(self, q: Array) -> None:
        """A new cost needs no preparation."""
        self._right[0][:] = q

    def take_data(self) -> None:
        """Prepare the new matrices."""
        form, data = self.form, self.data
        q, b, h = self._right
        q[:], b[:], h[:] = data.q, data.b[: len(b)], data.b[len(b) :]
        A = np.zeros((form.cones.zero, form.columns))
        A.ravel()[self._place] = data.A.data[self._equal]
        value = data.A.data[self._below]
        # Entries that are zero but for rounding would couple unknowns that have nothing to do with each other.
        some = np.flatnonzero(np.abs(value) > ROUNDING * np.abs(value).max(initial=0.0))
        start = np.concatenate([[0], np.cumsum(np.bincount(self._row[some], minlength=form.rows - form.cones.zero))])
        diagonal = data.P.diagonal() if data.P.nnz else np.zeros(form.columns)
        self._plan = conic.prepare(diagonal, A, start, self._column[some], value[some], form.cones.nonneg, self._soc)

    def answer(self) -> ConicSolution:
        """Solve; where rounding keeps the method from the end, on from there by another one."""
        form, (W, F), s, zero = self.form, self._plan, self._slack, self.form.cones.zero
        x, y = np.empty(form.columns), np.empty(form.rows)
        status, steps = conic.solve(W, F, *self._right, conic.ITERATIONS, x, y[:zero], y[zero:], s)
        if status == conic.SOLVED and not self._holds(x, s):
            status = conic.STALLED
        solution = KernelSolution(form, self.data, self.offset, status, steps, x, y, conic.values(W, F))
        if status in (conic.INFEASIBLE, conic.UNBOUNDED):
            return solution
        return self.finish(solution, np.concatenate([np.zeros(zero), s]))

    def _holds(self, x: Array, s: Array) -> bool:
        """Whether a solution keeps its constraints in the units of the data, to what is accepted."""
        left = self.data.A @ x - self.data.b
        left[self.form.cones.zero :] += s
        return bool(np.abs(left).max(initial=0.0) <= ACCEPTED * max(1.0, float(np.abs(x).max(initial=0.0))))


class KernelSolution(HeldSolution):
    """The kernel's answer to one instance.

    Attributes:
        steps: How many steps the method took.
    """

    engine = NAME

    def __init__(
        self, form: ConicForm, data: ConicData, offset: float, status: int, steps: int, x: Array, y: Array, values: tuple[float, float]
    ):
        word, detail = ANSWERS[status]
        self.steps = steps
        super().__init__(form, data, offset, word, detail, values, x, y)
        # The solver stopped short of what it was asked for: what it has is judged by its residuals.
        if word == FAILED and max(self.residuals) <= ACCEPTED:
            self.status = SOLVED


class KernelEngine(ConicEngine):
    """The kernel on canonical data: every model whose cones are not semidefinite."""

    name = NAME
    session = Session

    def accepts(self, model: ConicModel | None, form: str) -> bool:
        """Every model as a second-order cone program, where it is one."""
        return form != "sdp" and (model is None or not model.semidefinite)

    def form_of(self, model: ConicModel, shape: Any) -> ConicForm:
        """The canonical form of a model's program for a shape.

        Raises:
            EngineError: The program has semidefinite cones, or a quadratic cost with products of different unknowns.
        """
        form = super().form_of(model, shape)
        if form.cones.psd:
            raise EngineError(f"the kernel takes no semidefinite cones, {model.name} in this shape has {len(form.cones.psd)}", name=NAME)
        if not form.diagonal_cost:
            raise EngineError(f"the kernel takes no products of different unknowns in a cost, {model.name} has some", name=NAME)
        return form
