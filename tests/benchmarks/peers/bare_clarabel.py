"""Clarabel alone: data built outside the clock, then one vector updated and the program solved, to Clarabel's own 1e-8."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import clarabel
import numpy as np
import scipy.sparse as sp

from benchmarks.posed import Posed, posed, read
from benchmarks.questions import Case
from benchmarks.timing import PeerFailed, Trial, Way
from socp_statics.engines.compiled import clarabel_cones
from socp_statics.spatial import skew

MOST = 100


def settings() -> clarabel.DefaultSettings:
    """Clarabel's own tolerances; without presolve, so that data can be updated."""
    chosen = clarabel.DefaultSettings()
    chosen.verbose = False
    chosen.presolve_enable = False
    chosen.max_threads = 1
    return chosen


def solved(solution: Any) -> Any:
    """The solution, if it is one."""
    if str(solution.status) not in ("Solved", "AlmostSolved"):
        raise PeerFailed(f"Clarabel: {solution.status}")
    return solution


def _declared(question: str, case: Case) -> Trial:
    """The declared program, one vector of it updated in turn."""
    programs: Posed = posed(question, case, MOST)
    solver = clarabel.DefaultSolver(*programs.form.data(programs.parameters), clarabel_cones(programs.form.cones), settings())
    vectors, where = list(programs.vectors), "q" if programs.in_the_cost else "b"

    def run(_: None) -> list[Any]:
        found = []
        for vector in vectors:
            solver.update(**{where: vector})
            found.append(solver.solve())
        return found

    def answer(found: list[Any]) -> Any:
        objectives = np.array([programs.objective(solved(s).obj_val) for s in found])
        places = np.array([[s.x[i] for i in programs.places] for s in found]) if question in ("region", "torque") else None
        return read(question, case, objectives, places)

    return Trial(run, answer, count=1 if question in ("region", "torque") else len(vectors))


def _dual(case: Case) -> Trial:
    """The dual of a support direction: four unknowns, one cone a contact point.

    With the horizontal CoM position c = L f and the other balance rows E f = e, max d'L f is min e'y over E_i'y - L_i'd in the
    dual cones, z_n >= mu |z_t|.
    """
    points, normals, friction = case.points()
    units = case.data.units
    arms = (points - units.origin) / units.length
    E, L, slopes = [], [], []
    for p, n, mu in zip(arms, normals, friction, strict=True):
        t = np.cross(n, np.eye(3)[int(np.argmin(np.abs(n)))])
        t /= np.linalg.norm(t)
        frame = np.column_stack([n, t, np.cross(n, t)])
        wrench = np.vstack([frame, skew(p) @ frame])
        E.append(wrench[[0, 1, 2, 5]])
        L.append(np.vstack([-wrench[4], wrench[3]]))
        slopes.append([1.0, mu, mu])
    scale = np.concatenate(slopes)
    A = sp.csc_array(-scale[:, None] * np.hstack(E).T)
    along = -scale[:, None] * np.hstack(L).T
    rights = [along @ d for d in case.directions[:MOST]]
    cones = [clarabel.SecondOrderConeT(3)] * len(points)
    cost = np.array([0.0, 0.0, 1.0, 0.0])
    solver = clarabel.DefaultSolver(sp.csc_array((4, 4)), cost, A, rights[0], cones, settings())

    def run(_: None) -> list[Any]:
        found = []
        for right in rights:
            solver.update(b=right)
            found.append(solver.solve())
        return found

    return Trial(run, lambda found: units.length * np.array([solved(s).obj_val for s in found]), count=len(rights))


def ways(question: str) -> list[Way]:
    """Clarabel on the declared program; for a direction also on its dual."""
    cone = "second-order cones"
    found = [Way("bare Clarabel", "Clarabel, update and solve", cone, partial(_declared, question))]
    if question == "direction":
        ready: Callable[[Case], Trial] = _dual
        found.append(Way("bare Clarabel, dual", "Clarabel, update and solve, 4 unknowns", cone, ready))
    return found
