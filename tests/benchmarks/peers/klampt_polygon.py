"""Klampt: the support polygon as half-planes and the test of one centre of mass, from lists of contact points."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from benchmarks.peers import not_installed
from benchmarks.questions import Case, in_order
from benchmarks.suite import Array
from benchmarks.timing import Trial, Way

EDGES = {"region": (4, 8, 16), "verdict": (4,)}
MOST = 200
REACH = 10.0


def _contact_points(case: Case) -> list[list[float]]:
    """Seven numbers a point: position, normal, friction."""
    points, normals, friction = case.points()
    return [[*p, *n, mu] for p, n, mu in zip(points.tolist(), normals.tolist(), friction.tolist(), strict=True)]


def area_within(planes: list[list[float]], middle: Array, reach: float) -> float:
    """Area of the half-planes a x + b y <= c within a square [m^2]."""
    corners = [middle + reach * np.array(sign) for sign in ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))]
    for a, b, c in planes:
        kept = []
        for here, there in zip(corners, corners[1:] + corners[:1], strict=True):
            over, beyond = np.array([a, b]) @ here - c, np.array([a, b]) @ there - c
            if over <= 0.0:
                kept.append(here)
            if over < 0.0 < beyond or beyond < 0.0 < over:
                kept.append(here + over / (over - beyond) * (there - here))
        corners = kept
        if len(corners) < 3:
            return 0.0
    return in_order(np.array(corners))


def _polygon(edges: int, case: Case) -> Trial:
    from klampt import robotsim

    points = case.points()[0]
    middle, reach = points.mean(axis=0)[:2], REACH * float(np.ptp(points, axis=0).max())

    def fresh() -> list[list[float]]:
        # The number of edges is global to Klampt.
        robotsim.set_friction_cone_approximation_edges(edges)
        return _contact_points(case)

    return Trial(robotsim.support_polygon, lambda planes: area_within(planes, middle, reach), fresh)


def _equilibrium(edges: int, case: Case) -> Trial:
    from klampt import robotsim

    coms = case.coms[:MOST].tolist()

    def fresh() -> list[list[float]]:
        robotsim.set_friction_cone_approximation_edges(edges)
        return _contact_points(case)

    def run(contacts: list[list[float]]) -> list[Any]:
        return [robotsim.com_equilibrium(contacts, (0.0, 0.0, -1.0), com) for com in coms]

    return Trial(run, lambda found: (np.array([f is not None for f in found]), None), fresh, len(coms))


def ways(question: str) -> list[Way]:
    """Support polygons and verdicts with inner pyramids."""
    name, make = {"region": ("Klampt polygon", _polygon), "verdict": ("Klampt equilibrium", _equilibrium)}.get(question, ("", None))
    why = not_installed("klampt", "klampt")
    return [
        Way(f"{name}, {k} sides", "GLPK simplex", f"{k}-sided pyramids inside", partial(make, k), side="inscribed", missing=why)
        for k in EDGES.get(question, ())
        if make is not None
    ]
