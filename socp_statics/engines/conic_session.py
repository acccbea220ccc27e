"""What engines on canonical conic data share: sessions whose data follow the parameters, solutions read back by name, compilations kept."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import cache, cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.engines.conic_form import ConicData, ConicForm, cost_gradient
from socp_statics.engines.equilibration import Equilibrated, equilibrated
from socp_statics.engines.smoothing_newton import approached, finished, unit_of
from socp_statics.engines.solution import SOLVED, Residuals, Solution
from socp_statics.models.program import ConicModel
from socp_statics.spatial import Array

ACCEPTED = 1e-8
# A solution that is short of more, as a share of its objective, is solved on to rounding.
PRECISE = 1e-9
# What the objective of an answer may be short of for its unknowns to meet the constraints.
SHORT = 1e-6


def _is_better(after: Residuals, before: Residuals | None) -> bool:
    """Whether an answer is accurate, or else nearer than one that the engine took, or meets constraints which that one misses."""
    if max(after) <= ACCEPTED:
        return True
    if before is None:
        return False
    meets = before.primal > ACCEPTED >= after.primal and after.dual <= before.dual and after.gap <= SHORT
    return meets or max(after) <= 0.5 * max(before)


class ConicSession:
    """One instance of a program; a few parameters change from solve to solve.

    An engine says how its solver takes over a new cost (`take_cost`) or new data (`take_data`), and how it answers (`answer`).

    Args:
        form: Canonical form of the program.
        values: Values of all its parameters.

    Attributes:
        finishes: Whether answers are solved on to rounding where the engine stops short of it.
    """

    finishes = True

    def __init__(self, form: ConicForm, values: Mapping[str, ArrayLike]):
        self.form = form
        self._p = form.parameter_vector(values)
        self.data = form.data(self._p)
        self.offset = form.offset(self._p)
        self._costs: dict[str, tuple[Array, Array]] = {}
        self._entry_column = np.repeat(np.arange(form.columns), np.diff(self.data.A.indptr))

    def solve(self, **changed: ArrayLike) -> Solution:
        """Solve with some parameters changed; they stay changed.

        Args:
            **changed: New values by parameter name.

        Returns:
            The solution.
        """
        if changed:
            form, p = self.form, self._p
            for name, value in changed.items():
                form.put(p, name, value)
            if len(changed) == 1 and form.only_q[name]:
                base, slope = self._cost(name)
                q = base + slope @ p[form.where[name]]
                self.data = ConicData(self.data.P, q, self.data.A, self.data.b)
                self.take_cost(q)
            else:
                self._costs.clear()
                self.data = form.data(p)
                self.offset = form.offset(p)
                self.take_data()
        return self.answer()

    def take_cost(self, q: Array) -> None:
        """Give the solver a new linear cost."""
        raise TypeError(f"{type(self).__name__} does not say how to change the cost")

    def take_data(self) -> None:
        """Give the solver the new `data`."""
        raise TypeError(f"{type(self).__name__} does not say how to change the data")

    def answer(self) -> Solution:
        """Solve."""
        raise TypeError(f"{type(self).__name__} does not say how to solve")

    def finish(self, solution: ConicSolution, s: Array) -> ConicSolution:
        """A solution, solved on to rounding where the engine stopped short of it.

        Args:
            solution: With finite unknowns or not.
            s: Its slack.

        Returns:
            The solution itself where it misses its equations by little, or where nothing better is found.
        """
        data, x, y = self.data, solution.x, solution.y
        if not self.finishes or (solution.status == SOLVED and self._missed(x, y, s) <= PRECISE):
            return solution
        cones = self.form.cones
        if cones.psd or not (np.isfinite(x).all() and np.isfinite(y).all()):
            return solution
        before = solution.residuals if solution.status == SOLVED else None
        # The program as it is, then equilibrated, which is work that most never need.
        ways = (lambda: Equilibrated(data, np.ones(len(x)), np.ones(len(y))), cache(lambda: equilibrated(data, cones)))
        for method in (finished, approached):
            for way in ways:
                scaled = way()
                x0, y0 = scaled.enter(x, y)
                for unit in (unit_of(x0, y0), 1.0):
                    found = method(scaled.data, cones, x0, y0, unit)
                    better = None if found is None else scaled.leave(*found)
                    if better is not None and _is_better(self.form.residuals(data, *better), before):
                        detail = f"{solution.detail}, then solved to rounding"
                        return FinishedSolution(self.form, data, self.offset, solution.engine, detail, *better)
        return solution

    def _missed(self, x: Array, y: Array, s: Array) -> float:
        """What an answer is short of, as a share of its objective: its gap, and equations times what they cost."""
        A, q, b = self.data.A, self.data.q, self.data.b
        column = self._entry_column
        unmet = np.bincount(A.indices, A.data * x[column], self.form.rows) + s - b
        slope = np.bincount(column, A.data * y[A.indices], self.form.columns) + q
        primal, dual = float(q @ x), -float(b @ y)
        if self.data.P.nnz:
            slope = cost_gradient(self.data, x, y)
            primal, dual = self.form.values(self.data, x, y)
        cost = math.sqrt(float(unmet @ unmet) * max(1.0, float(y @ y))) + math.sqrt(float(slope @ slope) * max(1.0, float(x @ x)))
        return max(cost, abs(primal - dual)) / (1.0 + abs(primal))

    def _cost(self, name: str) -> tuple[Array, Array]:
        """Q as an affine function of one parameter, the others as they are."""
        if name not in self._costs:
            others = self._p.copy()
            others[self.form.where[name]] = 0.0
            self._costs = {name: (self.form.linear_cost(others), self.form.cost_slope(name))}
        return self._costs[name]


class ConicSolution:
    """An answer to one instance; see `engines.solution.Solution`. An engine says where `x` and `y` are.

    Args:
        form: Canonical form of the program.
        data: The instance.
        offset: Constant of its objective.
        status: Status in the words of `engines.solution`.
        detail: The solver's own word.
        values: The solver's primal and dual objective.
    """

    engine = ""

    def __init__(self, form: ConicForm, data: ConicData, offset: float, status: str, detail: str, values: tuple[float, float]):
        self.form, self.data = form, data
        self.status, self.detail = status, detail
        self._offset, self._values = offset, values

    @property
    def x(self) -> Array:
        """The canonical variables, shape (columns,)."""
        raise TypeError(f"{type(self).__name__} does not say where its variables are")

    @property
    def y(self) -> Array:
        """The conic multipliers, shape (rows,)."""
        raise TypeError(f"{type(self).__name__} does not say where its multipliers are")

    @property
    def objective(self) -> float:
        """Value of the objective, scaled."""
        return self._in_the_sense_of_the_program(self._values[0])

    @property
    def bound(self) -> float:
        """Value of the dual objective, scaled."""
        return self._in_the_sense_of_the_program(self._values[1])

    def _in_the_sense_of_the_program(self, value: float) -> float:
        return -(value + self._offset) if self.form.maximise else value + self._offset

    @cached_property
    def variables(self) -> Mapping[str, Array]:
        """Variables by name."""
        return self.form.variables(self.x)

    def variable(self, name: str) -> Sequence[float]:
        """One variable without the others."""
        x = self.x
        return [float(x[i]) for i in self.form.variable_places[name]]

    @cached_property
    def duals(self) -> Mapping[str, Array]:
        """Multipliers by constraint name."""
        return self.form.duals(self.y)

    @cached_property
    def gap(self) -> float:
        """Relative gap recomputed from the data."""
        return self.form.gap(self.data, self.x, self.y)

    @cached_property
    def residuals(self) -> Residuals:
        """Residuals recomputed from the data."""
        return self.form.residuals(self.data, self.x, self.y)


class HeldSolution(ConicSolution):
    """A solution whose unknowns and multipliers are arrays of its own.

    Args:
        form: Canonical form of the program.
        data: The instance.
        offset: Constant of its objective.
        status: "solved", "infeasible", "unbounded" or "failed".
        detail: What happened, in words.
        values: Primal and dual objective without the constant.
        x: The canonical variables.
        y: The conic multipliers.
    """

    def __init__(
        self, form: ConicForm, data: ConicData, offset: float, status: str, detail: str, values: tuple[float, float], x: Array, y: Array
    ):
        self._x, self._y = x, y
        super().__init__(form, data, offset, status, detail, values)

    @property
    def x(self) -> Array:
        """The canonical variables."""
        return self._x

    @property
    def y(self) -> Array:
        """The conic multipliers."""
        return self._y


class FinishedSolution(HeldSolution):
    """A solution that Newton's method took to rounding; see `smoothing_newton`.

    Args:
        form: Canonical form of the program.
        data: The instance.
        offset: Constant of its objective.
        engine: Name of the engine that began it.
        detail: What happened, in words.
        x: The canonical variables.
        y: The conic multipliers.
    """

    def __init__(self, form: ConicForm, data: ConicData, offset: float, engine: str, detail: str, x: Array, y: Array):
        super().__init__(form, data, offset, SOLVED, detail, form.values(data, x, y), x, y)
        self.engine = engine


class ConicCompiled:
    """A model compiled for one shape.

    Args:
        form: Canonical form of its program.
        session: The engine's kind of session.
        finishes: Whether answers are solved on to rounding where the engine stops short of it.
    """

    def __init__(self, form: ConicForm, session: type[ConicSession], finishes: bool = True):
        self._form, self._session, self._finishes = form, session, finishes

    def session(self, values: Mapping[str, ArrayLike]) -> ConicSession:
        """A solver built on real data, for many solves that differ in few parameters."""
        session = self._session(self._form, values)
        session.finishes = self._finishes
        return session

    def solve(self, values: Mapping[str, ArrayLike]) -> Solution:
        """One solve."""
        return self.session(values).solve()


class ConicEngine:
    """An engine on canonical data; compilations are kept by model and shape."""

    name = ""
    session: type[ConicSession] = ConicSession

    def __init__(self) -> None:
        self._cache: dict[tuple[str, Any], ConicCompiled] = {}

    def accepts(self, model: ConicModel | None, form: str) -> bool:
        """Every model in every form."""
        return True

    def form_of(self, model: ConicModel, shape: Any) -> ConicForm:
        """The canonical form of a model's program for a shape."""
        return ConicForm(model.declare(shape))

    def compile(self, model: ConicModel, shape: Any) -> ConicCompiled:
        """The compiled model, made once for each shape."""
        key = (model.name, shape)
        if key not in self._cache:
            self._cache[key] = ConicCompiled(self.form_of(model, shape), self.session, not model.only_steps)
        return self._cache[key]
