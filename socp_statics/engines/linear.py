"""Linear programs by HiGHS: what pyramids can be solved with and cones cannot. For comparisons; no question is answered by it.

HiGHS is asked through its own interface (``highspy``), with which the next direction of a region starts from the last basis and
quadratic objectives are accepted; without it through SciPy, which has neither.
"""

from __future__ import annotations

import os
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import cache, partial
from importlib.util import find_spec
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import ArrayLike
from scipy.optimize import linprog

from socp_statics.engines.conic_form import ConicData, ConicForm
from socp_statics.engines.conic_session import ConicEngine, ConicSession, HeldSolution
from socp_statics.engines.solution import FAILED, INFEASIBLE, SOLVED, UNBOUNDED
from socp_statics.exceptions import EngineError
from socp_statics.spatial import Array

# Without presolve and by the primal simplex method, the next direction of a region starts from the vertex before: half the time.
OPTIONS: dict[str, bool | int | str] = {"output_flag": False, "threads": 1, "presolve": "off", "simplex_strategy": 4}
SCIPY_STATUS = {0: SOLVED, 2: INFEASIBLE, 3: UNBOUNDED}


@cache
def interface() -> str:
    """How HiGHS is asked: "HiGHS" through highspy, else "HiGHS (SciPy)"."""
    return "HiGHS" if find_spec("highspy") else "HiGHS (SciPy)"


class LinearSolution(HeldSolution):
    """An answer of HiGHS."""

    engine = "highs"

    def __init__(self, form: ConicForm, data: ConicData, offset: float, status: str, detail: str, x: Array, y: Array):
        value = float(data.q @ x) + 0.5 * float(x @ (data.P @ x + sp.triu(data.P, 1).T @ x)) if status == SOLVED else np.nan
        super().__init__(form, data, offset, status, detail, (value, value), x, y)


class LinearSession(ConicSession):
    """One instance in HiGHS.

    Args:
        form: Canonical form of the program.
        values: Values of all its parameters.
        spent: CPU seconds of every solve are added here.

    Raises:
        EngineError: The program has second-order or semidefinite cones; or a quadratic objective, and HiGHS is only there through SciPy.
    """

    def __init__(self, form: ConicForm, values: Mapping[str, ArrayLike], spent: list[float]):
        super().__init__(form, values)
        if form.cones.soc or form.cones.psd:
            raise EngineError("the program is not linear: it has second-order or semidefinite cones", name="highs")
        self._spent = spent
        self._highs: Any = None
        if interface() == "HiGHS":
            self._highs = _model(self.data, form.cones.zero)
        elif self.data.P.nnz:
            raise EngineError("the objective is quadratic, which SciPy's HiGHS does not take", name="highs")

    def take_cost(self, q: Array) -> None:
        """Change the cost and keep the basis."""
        if self._highs is not None:
            self._highs.changeColsCost(len(q), np.arange(len(q), dtype=np.int32), q)

    def take_data(self) -> None:
        """A new model."""
        if self._highs is not None:
            self._highs = _model(self.data, self.form.cones.zero)

    def answer(self) -> LinearSolution:
        """Solve, and note the time inside the solver."""
        start = time.process_time()
        status, detail, x, y = self._by_scipy() if self._highs is None else self._by_highspy()
        self._spent.append(time.process_time() - start)
        return LinearSolution(self.form, self.data, self.offset, status, detail, x, y)

    def _by_highspy(self) -> tuple[str, str, Array, Array]:
        import highspy

        words = {
            highspy.HighsModelStatus.kOptimal: SOLVED,
            highspy.HighsModelStatus.kInfeasible: INFEASIBLE,
            highspy.HighsModelStatus.kUnbounded: UNBOUNDED,
        }
        self._highs.run()
        status = self._highs.getModelStatus()
        found = self._highs.getSolution()
        return words.get(status, FAILED), str(status), np.array(found.col_value), -np.array(found.row_dual)

    def _by_scipy(self) -> tuple[str, str, Array, Array]:
        equal = self.form.cones.zero
        A, b = self.data.A.tocsr(), self.data.b
        found = linprog(self.data.q, A[equal:], b[equal:], A[:equal], b[:equal], bounds=(None, None), method="highs")
        if found.x is None:
            return SCIPY_STATUS.get(found.status, FAILED), found.message, np.zeros(self.form.columns), np.zeros(self.form.rows)
        y = -np.concatenate([found.eqlin.marginals, found.ineqlin.marginals])
        return SCIPY_STATUS.get(found.status, FAILED), found.message, found.x, y


class LinearEngine(ConicEngine):
    """HiGHS on canonical data, for programs without second-order cones.

    Attributes:
        spent: CPU seconds inside the solver, one entry a solve.
    """

    name = "highs"

    def __init__(self) -> None:
        super().__init__()
        self.spent: list[float] = []
        self.session = partial(LinearSession, spent=self.spent)  # type: ignore[assignment]


def _model(data: ConicData, equal: int) -> Any:
    """A HiGHS instance of ``A z = b`` above, ``A z <= b`` below, z free."""
    import highspy

    rows, columns = data.A.shape
    lp = highspy.HighsLp()
    lp.num_col_, lp.num_row_ = columns, rows
    lp.col_cost_ = data.q
    lp.col_lower_, lp.col_upper_ = np.full(columns, -highspy.kHighsInf), np.full(columns, highspy.kHighsInf)
    lp.row_lower_ = np.concatenate([data.b[:equal], np.full(rows - equal, -highspy.kHighsInf)])
    lp.row_upper_ = data.b
    lp.a_matrix_.format_ = highspy.MatrixFormat.kColwise
    lp.a_matrix_.start_, lp.a_matrix_.index_, lp.a_matrix_.value_ = data.A.indptr, data.A.indices, data.A.data
    model = highspy.HighsModel()
    model.lp_ = lp
    if data.P.nnz:
        lower = sp.csc_array(data.P.T)
        model.hessian_.dim_ = columns
        model.hessian_.format_ = highspy.HessianFormat.kTriangular
        model.hessian_.start_, model.hessian_.index_, model.hessian_.value_ = lower.indptr, lower.indices, lower.data
    with _silence():
        highs = highspy.Highs()
    for option, value in OPTIONS.items():
        highs.setOptionValue(option, value)
    highs.passModel(model)
    return highs


@contextmanager
def _silence() -> Iterator[None]:
    """Nothing on standard output: the first instance of HiGHS in a process says its name there, before any option can forbid it."""
    kept, nowhere = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 1)
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)
