"""Moreau: the declared programs as one batch, on one thread."""

from __future__ import annotations

import os
from functools import cache, partial
from typing import Any

import numpy as np
import scipy.sparse as sp

from benchmarks.peers import not_installed
from benchmarks.posed import posed, read
from benchmarks.questions import Case
from benchmarks.timing import PeerFailed, Trial, Way

MOST = 1000


@cache
def _moreau() -> Any:
    """The module, with its pool of threads.

    The pool is made with the first solver, one thread for each processor the process may use, and kept: so the first solver is
    made while the process may use one.
    """
    import moreau

    allowed = os.sched_getaffinity(0) if hasattr(os, "sched_getaffinity") else set()
    if allowed:
        os.sched_setaffinity(0, {min(allowed)})
    try:
        _compiled(moreau, sp.csr_array(np.array([[1.0], [-1.0]])), moreau.Cones(num_nonneg_cones=2), 2)
    finally:
        if allowed:
            os.sched_setaffinity(0, allowed)
    return moreau


def _compiled(moreau: Any, A: sp.csr_array, cones: Any, batch: int) -> Any:
    rows, columns = A.shape
    none = np.zeros(columns + 1, dtype=np.int64)
    chosen = moreau.Settings(batch_size=batch, device="cpu", solver="ipm")
    return moreau.CompiledSolver(
        n=columns, m=rows, P_row_offsets=none, P_col_indices=none[:0], A_row_offsets=A.indptr, A_col_indices=A.indices,
        cones=cones, settings=chosen,
    )  # fmt: skip


def _batch(question: str, case: Case) -> Trial:
    """Structure compiled outside the clock; matrix and vectors given and the batch solved inside."""
    moreau = _moreau()
    programs = posed(question, case, MOST)
    data, sizes = programs.form.data(programs.parameters), programs.form.cones
    A = sp.csr_array(data.A)
    cones = moreau.Cones(num_zero_cones=sizes.zero, num_nonneg_cones=sizes.nonneg, so_cone_dims=list(sizes.soc))
    batch = len(programs.changes)
    solver = _compiled(moreau, A, cones, batch)
    fixed = np.tile(data.b if programs.in_the_cost else data.q, (batch, 1))
    q, b = (programs.vectors, fixed) if programs.in_the_cost else (fixed, programs.vectors)
    of_region = question in ("region", "torque")

    def run(_: None) -> Any:
        solver.setup(np.zeros(0), A.data)
        return solver.solve(q, b)

    def answer(solution: Any) -> Any:
        accepted = {int(moreau.SolverStatus.Solved), int(moreau.SolverStatus.AlmostSolved)}
        refused = [s for s in solver.info.status if int(s) not in accepted]
        if refused:
            raise PeerFailed(f"Moreau: {len(refused)} of {batch} programs {refused[0]}")
        x = np.asarray(solution.x)
        objectives = np.array([programs.objective(v) for v in (x * q).sum(axis=1)])
        return read(question, case, objectives, x[:, programs.places] if of_region else None)

    return Trial(run, answer, count=1 if of_region else batch)


def ways(question: str) -> list[Way]:
    """Moreau's compiled solver."""
    why = not_installed("moreau", "moreau")
    return [Way("Moreau batch", "Moreau interior point", "second-order cones", partial(_batch, question), missing=why)]
