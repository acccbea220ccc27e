"""Linear and mixed-integer programs whose variables and rows are collected as they are stated, solved by HiGHS through SciPy."""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from threading import Lock
from typing import Any

import numpy as np
from scipy.optimize import Bounds, LinearConstraint, linprog, milp
from scipy.sparse import coo_matrix, csr_matrix

from socp_statics.spatial import Array

TOLERANCE = 1e-10
GAP = 0.5
_OUTPUT = Lock()
Terms = Sequence[tuple[int, float]]


@dataclass(eq=False)
class ProgramRows:
    """Rows ``lower <= A v <= upper`` over variables with bounds.

    Attributes:
        lower: Of each row.
        upper: Of each row.
        bounds: Of each variable.
        whole: Whether each variable is a whole number.
    """

    lower: list[float] = field(default_factory=list)
    upper: list[float] = field(default_factory=list)
    bounds: list[tuple[float, float]] = field(default_factory=list)
    whole: list[bool] = field(default_factory=list)
    _entries: list[tuple[int, int, float]] = field(default_factory=list)

    def variables(self, count: int, low: float = 0.0, high: float = np.inf, whole: bool = False) -> list[int]:
        """New variables, their columns."""
        first = len(self.bounds)
        self.bounds += [(low, high)] * count
        self.whole += [whole] * count
        return list(range(first, first + count))

    def row(self, lower: float, upper: float, terms: Terms) -> None:
        """A row from its terms, pairs of column and factor; terms of one column add up."""
        number = len(self.lower)
        self.lower.append(lower)
        self.upper.append(upper)
        self._entries += [(number, column, value) for column, value in terms if value]

    def most(self, terms: Terms, ceiling: float, switches: Sequence[int]) -> None:
        """The terms add up to at most the ceiling times the sum of the switches."""
        self.row(-np.inf, 0.0, [*terms, *((z, -ceiling) for z in switches)])

    def matrix(self) -> csr_matrix:
        """A, shape (rows, variables)."""
        rows, columns, values = zip(*self._entries, strict=True)
        return coo_matrix((values, (rows, columns)), shape=(len(self.lower), len(self.bounds))).tocsr()

    def largest(self, gain: Mapping[int, float]) -> Array | None:
        """The point where the gain is largest, whole numbers taken as real ones.

        Args:
            gain: Factor of each column in the objective.

        Returns:
            The variables; None where there is no such point.
        """
        A, lower, upper = self.matrix(), np.array(self.lower), np.array(self.upper)
        same = lower == upper
        below, above = ~same & np.isfinite(upper), ~same & np.isfinite(lower)
        found = linprog(
            -self._objective(gain), A_ub=np.vstack([A[below].toarray(), -A[above].toarray()]),
            b_ub=np.concatenate([upper[below], -lower[above]]), A_eq=A[same].toarray(), b_eq=upper[same], bounds=self.bounds,
            options={"primal_feasibility_tolerance": TOLERANCE, "dual_feasibility_tolerance": TOLERANCE},
        )  # fmt: skip
        return found.x if found.status == 0 else None

    def largest_mixed(self, gain: Mapping[int, float], nodes: int) -> Any:
        """SciPy's result of the mixed-integer program, minus the gain as its objective.

        Args:
            gain: Factor of each column in the objective.
            nodes: Nodes after which the search ends. It also ends once the best point is within half of the bound, which leaves a
                bound of zero to be reached.
        """
        low, high = np.array(self.bounds).T
        with _said_on_stderr():
            return milp(
                -self._objective(gain), integrality=np.array(self.whole, dtype=int), bounds=Bounds(low, high),
                constraints=LinearConstraint(self.matrix(), self.lower, self.upper), options={"node_limit": nodes, "mip_rel_gap": GAP},
            )  # fmt: skip

    def _objective(self, gain: Mapping[int, float]) -> Array:
        c = np.zeros(len(self.bounds))
        c[list(gain)] = list(gain.values())
        return c


@contextmanager
def _said_on_stderr() -> Iterator[None]:
    """HiGHS prints remarks of its developers with plain ``printf``: they must not get among records on standard output."""
    try:
        streams = ctypes.CDLL(None)
    except (OSError, TypeError):
        yield
        return
    with _OUTPUT:
        sys.stdout.flush()
        kept = os.dup(1)
        os.dup2(2, 1)
        try:
            yield
        finally:
            streams.fflush(None)
            os.dup2(kept, 1)
            os.close(kept)
