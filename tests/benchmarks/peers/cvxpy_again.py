"""cvxpy: the declared program with its Parameters (DPP), given one new value and solved again."""

from __future__ import annotations

from functools import partial
from typing import Any

import cvxpy as cp
import numpy as np

from benchmarks.posed import posed, read
from benchmarks.questions import Case
from benchmarks.timing import PeerFailed, Trial, Way

MOST = 20


def _again(question: str, case: Case) -> Trial:
    """A program declared and canonicalised outside the clock, solved again for every value of one parameter."""
    programs = posed(question, case, MOST)
    program = programs.model.declare(programs.shape)
    for name, parameter in program.parameters.items():
        parameter.value = np.asarray(programs.values[name], dtype=float)
    changing, problem = program.parameters[programs.parameter], program.problem
    of_region = question in ("region", "torque")

    def run(_: None) -> list[tuple[float, Any]]:
        found = []
        for change in programs.changes:
            changing.value = change
            problem.solve(solver=cp.CLARABEL)
            if problem.status not in (cp.OPTIMAL, cp.OPTIMAL_INACCURATE):
                raise PeerFailed(f"cvxpy: {problem.status}")
            found.append((problem.value, program.variables["s"].value if of_region else None))
        return found

    def answer(found: list[tuple[float, Any]]) -> Any:
        places = np.array([s for _, s in found]) if of_region else None
        return read(question, case, np.array([value for value, _ in found]), places)

    return Trial(run, answer, count=1 if of_region else len(programs.changes))


def ways(question: str) -> list[Way]:
    """cvxpy with Clarabel."""
    return [Way("cvxpy, solved again", "cvxpy DPP, Clarabel", "second-order cones", partial(_again, question))]
