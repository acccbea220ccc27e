"""HiGHS: linear programs over inscribed pyramids, written as sums of their edges; the last basis is kept from program to program."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import scipy.sparse as sp

from benchmarks.peers import not_installed
from benchmarks.questions import GAP, Case, in_order
from benchmarks.suite import Array
from benchmarks.timing import PeerFailed, Trial, Way
from socp_statics.regions.sandwich import START, Sandwich, Support

SIDES = {"region": (4,), "direction": (4, 8, 16), "verdict": (4,)}
MOST = 200
# Moments of the weight about the horizontal axes for a centre of mass one size away along x and y.
OF_THE_WEIGHT = np.array([[0, 0], [0, 0], [0, 0], [0, -1], [1, 0], [0, 0]], dtype=float)


def edge_wrenches(case: Case, sides: int) -> tuple[Array, Array]:
    """Wrenches of the pyramids' edges, (6, sides n), and of the unit normal forces, (6, n); units of size, about the mean point."""
    points, normals, friction = case.points()
    units = case.data.units
    edges, ups = [], []
    angles = 2 * np.pi * np.arange(sides) / sides
    for p, n, mu in zip((points - units.origin) / units.length, normals, friction, strict=True):
        t = np.cross(n, np.eye(3)[int(np.argmin(np.abs(n)))])
        t /= np.linalg.norm(t)
        F = n + mu * (np.outer(np.cos(angles), t) + np.outer(np.sin(angles), np.cross(n, t)))
        edges.append(np.hstack([F, np.cross(p, F)]))
        ups.append(np.concatenate([n, np.cross(p, n)]))
    return np.vstack(edges).T, np.array(ups).T


class _Program:
    """Maximise over edge coefficients >= 0 and a few free unknowns that follow them."""

    def __init__(self, edges: Array, free: Array, right: Array, strategy: int):
        import highspy

        self.highspy, self.solver = highspy, highspy.Highs()
        for option, value in (("output_flag", False), ("threads", 1), ("presolve", "off"), ("simplex_strategy", strategy)):
            self.solver.setOptionValue(option, value)
        A = sp.csc_array(np.hstack([edges, free]))
        rows, columns = A.shape
        count = free.shape[1]
        lp = highspy.HighsLp()
        lp.num_col_, lp.num_row_ = columns, rows
        lp.col_cost_ = np.zeros(columns)
        lp.col_lower_ = np.concatenate([np.zeros(columns - count), np.full(count, -highspy.kHighsInf)])
        lp.col_upper_ = np.full(columns, highspy.kHighsInf)
        lp.row_lower_ = lp.row_upper_ = right
        lp.sense_ = highspy.ObjSense.kMaximize
        lp.a_matrix_.format_ = highspy.MatrixFormat.kColwise
        lp.a_matrix_.start_, lp.a_matrix_.index_, lp.a_matrix_.value_ = A.indptr, A.indices, A.data
        self.solver.passModel(lp)
        self.free = np.arange(columns - count, columns, dtype=np.int32)
        self.rows = np.arange(rows, dtype=np.int32)

    def value(self) -> float:
        """The optimum."""
        self.solver.run()
        if self.solver.getModelStatus() != self.highspy.HighsModelStatus.kOptimal:
            raise PeerFailed(f"HiGHS: {self.solver.getModelStatus()}")
        return self.solver.getInfo().objective_function_value

    def towards(self, direction: Any) -> float:
        """The optimum in a direction of the free unknowns."""
        self.solver.changeColsCost(len(self.free), self.free, np.asarray(direction, dtype=float))
        return self.value()


def _directions(sides: int, case: Case) -> Trial:
    edges, _ = edge_wrenches(case, sides)
    # A new cost leaves the last basis feasible: primal simplex.
    program = _Program(edges, OF_THE_WEIGHT, np.eye(6)[2], strategy=4)
    ways = list(case.directions[:MOST])
    length = case.data.units.length
    return Trial(lambda _: [program.towards(d) for d in ways], lambda found: length * np.array(found), count=len(ways))


def _region(sides: int, case: Case) -> Trial:
    """The tracing of Bretl and Lall with a linear program for every direction."""
    edges, _ = edge_wrenches(case, sides)

    def run(_: None) -> list[Support]:
        program = _Program(edges, OF_THE_WEIGHT, np.eye(6)[2], strategy=4)

        def support(d: tuple[float, float]) -> Support:
            h = program.towards(d)
            x, y = program.solver.getSolution().col_value[-2:]
            return Support(d, (x, y), h, None)

        sandwich = Sandwich(support, [support(d) for d in START])
        sandwich.refine(GAP, lambda _: False)
        return sandwich.supports()

    length = case.data.units.length
    return Trial(run, lambda supports: in_order(np.array([s.c for s in supports])) * length**2)


def _margins(sides: int, case: Case) -> Trial:
    edges, ups = edge_wrenches(case, sides)
    units = case.data.units
    coms = case.coms[:MOST]
    rights = [np.eye(6)[2] - OF_THE_WEIGHT @ c for c in (coms[:, :2] - units.origin[:2]) / units.length]
    # A new right-hand side leaves the last basis dual feasible: dual simplex.
    program = _Program(edges, ups.sum(axis=1, keepdims=True), rights[0], strategy=1)
    program.solver.changeColCost(int(program.free[0]), 1.0)

    def run(_: None) -> list[float]:
        found = []
        for right in rights:
            program.solver.changeRowsBounds(6, program.rows, right, right)
            found.append(program.value())
        return found

    def answer(found: list[float]) -> Any:
        margins = np.array(found) * units.force
        return margins >= 0.0, margins

    return Trial(run, answer, count=len(rights))


def ways(question: str) -> list[Way]:
    """Linear programs with inner pyramids."""
    make = {"region": _region, "direction": _directions, "verdict": _margins}.get(question)
    why = not_installed("highspy", "highspy")
    return [
        Way(f"HiGHS LP, {k} sides", "HiGHS simplex", f"{k}-sided pyramids inside", partial(make, k), side="inscribed", missing=why)
        for k in SIDES.get(question, ())
        if make is not None
    ]
