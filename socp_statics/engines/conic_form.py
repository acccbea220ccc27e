"""The canonical conic data of a declared program, as functions of its parameters.

    minimise 1/2 z' P z + q' z   subject to   A z + s = b,   s in {0} x R+ x second-order cones x svec semidefinite cones

cvxpy canonicalises a program once; afterwards P, q, A and b are linear in the parameter vector, and the variables and
multipliers of the declared program are entries of z and of the conic multipliers.
"""

from __future__ import annotations

from collections.abc import Mapping
from copy import copy
from types import SimpleNamespace
from typing import Any, NamedTuple

import cvxpy as cp
import numpy as np
import scipy.sparse as sp
from numpy.typing import ArrayLike, NDArray

from socp_statics.engines.solution import Residuals
from socp_statics.exceptions import EngineError
from socp_statics.models.program import Program
from socp_statics.spatial import Array

DENSE_LIMIT = 200_000


class Cones(NamedTuple):
    """Sizes of the cones, in the order of the rows of A."""

    zero: int
    nonneg: int
    soc: tuple[int, ...]
    psd: tuple[int, ...]


class ConicData(NamedTuple):
    """One instance: P (upper triangle, CSC), q, A (CSC), b."""

    P: sp.csc_array
    q: Array
    A: sp.csc_array
    b: Array


class ConicForm:
    """Canonical form of a program, computed once a shape.

    Args:
        program: The declared program; its parameters' values are overwritten.

    Raises:
        EngineError: The program is not affine in its parameters (DPP).
    """

    def __init__(self, program: Program):
        problem = program.problem
        if not problem.is_dpp():
            raise EngineError(f"the program over {', '.join(program.variables)} is not affine in its parameters (DPP)")
        for parameter in problem.parameters():
            parameter.value = np.ones(parameter.shape)
        data, chain, inverse = problem.get_problem_data(cp.CLARABEL)
        stuffed = data[cp.settings.PARAM_PROB]
        dims = data["dims"]
        self.cones = Cones(dims.zero, dims.nonneg, tuple(dims.soc), tuple(dims.psd))
        self.maximise = isinstance(problem.objective, cp.Maximize)
        self.columns = stuffed.x.size
        self.rows = data["A"].shape[0]

        self.parameter_size = stuffed.total_param_size + 1
        name_of = {p.id: p.name() for p in problem.parameters()}
        self.where = {
            name_of[i]: slice(stuffed.param_id_to_col[i], stuffed.param_id_to_col[i] + p.size) for i, p in stuffed.id_to_param.items()
        }
        self.shape_of = {p.name(): p.shape for p in problem.parameters()}
        self._q_map = sp.csr_array(stuffed.q)
        stuffed.reduced_A.cache(True)
        self._A_map = sp.csr_array(stuffed.reduced_A.reduced_mat)
        indices, indptr, _ = stuffed.reduced_A.problem_data_index
        self._A_indices, self._A_indptr = np.asarray(indices), np.asarray(indptr)
        columns = slice(0, self._A_indptr[self.columns])
        none = np.zeros(columns.stop)
        self._A_template = sp.csc_array((none, self._A_indices[columns], self._A_indptr[: self.columns + 1]), (self.rows, self.columns))
        self._P_none = sp.csc_array((self.columns, self.columns))
        self._P_map = None
        if stuffed.P is not None:
            stuffed.reduced_P.cache(True)
            self._P_map = sp.csr_array(stuffed.reduced_P.reduced_mat)
            self._P_index = stuffed.reduced_P.problem_data_index
        self.diagonal_cost = self._P_map is None or self._is_diagonal(*self._P_index[:2])
        self._offset_row = self._q_map[[-1]]
        dense = self._q_map.shape[0] * self._q_map.shape[1] <= DENSE_LIMIT
        self._q_linear = self._q_map[:-1].toarray() if dense else sp.csr_array(self._q_map[:-1])
        self.only_q = {name: self._touches_only_q(s) for name, s in self.where.items()}
        self._read_solution_maps(program, chain, inverse)

    @staticmethod
    def _is_diagonal(indices: NDArray[np.int_], indptr: NDArray[np.int_]) -> bool:
        """Whether a sparsity pattern (CSC) has entries on the diagonal only."""
        return bool((np.asarray(indices) == np.repeat(np.arange(len(indptr) - 1), np.diff(indptr))).all())

    def _touches_only_q(self, columns: slice) -> bool:
        in_P = self._P_map is not None and self._P_map[:, columns].nnz > 0
        return not in_P and self._A_map[:, columns].nnz == 0

    def _read_solution_maps(self, program: Program, chain: Any, inverse: list) -> None:
        """Find every variable in z and every multiplier in the conic multipliers.

        cvxpy's own inversion is fed two known vectors, k and k^2: an entry s k and s k^2 names its index k and its scale s.
        """
        inverse[-1].solver_options = {}
        seen = []
        for power in (1, 2):
            z = (np.arange(self.columns) + 1.0) ** power
            y = (np.arange(self.rows) + 1.0) ** power
            fake = SimpleNamespace(status="Solved", solve_time=0.0, iterations=0, obj_val=0.0, x=z, z=y)
            program.problem.unpack_results(fake, chain, inverse)
            variables = {name: np.array(v.value, dtype=float) for name, v in program.variables.items()}
            duals = {name: flat_multiplier(c.dual_value) for name, c in program.constraints.items()}
            seen.append((variables, duals))
        (v1, d1), (v2, d2) = seen
        self.variable_index = {k: np.rint(v2[k] / v1[k]).astype(int) - 1 for k in v1}
        self.variable_places = {k: tuple(index.ravel().tolist()) for k, index in self.variable_index.items()}
        self.dual_index = {k: np.rint(d2[k] / d1[k]).astype(int) - 1 for k in d1}
        self.dual_scale = {k: d1[k] / (self.dual_index[k] + 1.0) for k in d1}

    def parameter_vector(self, values: Mapping[str, ArrayLike]) -> Array:
        """Values by name as the vector the data are linear in.

        Args:
            values: At least one value for each parameter of the program; others are ignored.

        Returns:
            Shape (parameter_size,).
        """
        p = np.empty(self.parameter_size)
        p[-1] = 1.0
        for name in self.where:
            self.put(p, name, values[name])
        return p

    def put(self, p: Array, name: str, value: ArrayLike) -> None:
        """Write one parameter into the parameter vector."""
        array = np.asarray(value, dtype=float)
        if array.shape != self.shape_of[name]:
            raise EngineError(f"parameter {name} has shape {array.shape}, the program was compiled for {self.shape_of[name]}", name=name)
        p[self.where[name]] = array.ravel(order="F")

    def linear_cost(self, p: Array) -> Array:
        """Q of a parameter vector, shape (columns,)."""
        return self._q_linear @ p

    def cost_slope(self, name: str) -> Array:
        """How q depends on one parameter, shape (columns, size of the parameter)."""
        return self._q_map[:-1, self.where[name]].toarray()

    def offset(self, p: Array) -> float:
        """Constant of the objective."""
        return float((self._offset_row @ p)[0]) if self._offset_row.nnz else 0.0

    def data(self, p: Array) -> ConicData:
        """P, q, A, b of a parameter vector; the sparsity pattern never changes."""
        entries = self._A_map @ p
        split = self._A_indptr[self.columns]
        A = copy(self._A_template)
        A.data = -entries[:split]
        b = np.zeros(self.rows)
        b[self._A_indices[split:]] = entries[split:]
        if self._P_map is None:
            P = self._P_none
        else:
            indices, indptr, shape = self._P_index
            P = sp.csc_array(sp.triu(sp.csc_array((self._P_map @ p, indices, indptr), shape), format="csc"))
        return ConicData(P, self.linear_cost(p), A, b)

    def variables(self, z: Array) -> dict[str, Array]:
        """Variables of the declared program."""
        return {name: z[index] for name, index in self.variable_index.items()}

    def duals(self, y: Array) -> dict[str, Array]:
        """Multipliers of the declared constraints, flat."""
        return {name: self.dual_scale[name] * y[index] for name, index in self.dual_index.items()}

    def conic_multipliers(self, duals: Mapping[str, Array]) -> Array:
        """The conic multipliers of multipliers by name, the inverse of `duals`."""
        y = np.zeros(self.rows)
        for name, value in duals.items():
            y[self.dual_index[name]] = value / self.dual_scale[name]
        return y

    def primal_vector(self, variables: Mapping[str, Array]) -> Array:
        """Z of the variables by name, the inverse of `variables`."""
        z = np.zeros(self.columns)
        for name, value in variables.items():
            z[self.variable_index[name]] = value
        return z

    def gap(self, data: ConicData, z: Array, y: Array) -> float:
        """Difference of the primal and the dual objective over 1 + |objective|, from the data alone."""
        primal, dual = self.values(data, z, y)
        return abs(primal - dual) / (1.0 + abs(primal))

    def values(self, data: ConicData, z: Array, y: Array) -> tuple[float, float]:
        """Primal and dual objective, from the data alone."""
        quadratic = float(z @ (data.P @ z + data.P.T @ z - data.P.diagonal() * z)) if data.P.nnz else 0.0
        return 0.5 * quadratic + float(data.q @ z), -0.5 * quadratic - float(data.b @ y)

    def residuals(self, data: ConicData, z: Array, y: Array) -> Residuals:
        """Residuals of a primal-dual pair, from the data alone.

        Args:
            data: The instance.
            z: Variables, shape (columns,).
            y: Conic multipliers, shape (rows,).

        Returns:
            Primal and dual violation and relative gap.
        """
        slack = data.b - data.A @ z
        primal = cone_violation(slack, self.cones, dual=False)
        dual = max(float(np.abs(cost_gradient(data, z, y)).max(initial=0.0)), cone_violation(y, self.cones, dual=True))
        return Residuals(primal, dual, self.gap(data, z, y))


def cost_gradient(data: ConicData, z: Array, y: Array) -> Array:
    """``P z + q + A' y``, zero at an optimum, shape (columns,)."""
    curved = data.P @ z + sp.triu(data.P, 1).T @ z if data.P.nnz else 0.0
    return data.q + data.A.T @ y + curved


def flat_multiplier(dual: object) -> Array:
    """A multiplier as a flat array; a second-order cone's (t, X) becomes cone by cone."""
    if isinstance(dual, list):
        t, X = (np.atleast_1d(np.asarray(part, dtype=float)) for part in dual)
        return np.column_stack([t, X.reshape(-1, len(t), order="A").T]).ravel()
    return np.atleast_1d(np.asarray(dual, dtype=float)).ravel(order="F")


def cone_violation(s: Array, cones: Cones, *, dual: bool) -> float:
    """Largest violation of the cones by a stacked vector; the dual of the zero cone is free.

    Args:
        s: Stacked vector, shape (rows,).
        cones: The cones.
        dual: Whether the dual cones are meant.

    Returns:
        0 inside.
    """
    worst = 0.0 if dual else float(np.abs(s[: cones.zero]).max(initial=0.0))
    at = cones.zero + cones.nonneg
    worst = max(worst, float(-s[cones.zero : at].min(initial=0.0)))
    for size in cones.soc:
        worst = max(worst, float(np.linalg.norm(s[at + 1 : at + size]) - s[at]))
        at += size
    for n in cones.psd:
        size = n * (n + 1) // 2
        M = np.zeros((n, n))
        M.T[np.tril_indices(n)] = s[at : at + size]
        M = M + np.triu(M, 1).T
        M[~np.eye(n, dtype=bool)] /= np.sqrt(2.0)
        worst = max(worst, float(-np.linalg.eigvalsh(M)[0]))
        at += size
    return max(worst, 0.0)
