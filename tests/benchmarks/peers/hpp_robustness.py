"""hpp-centroidal-dynamics: robustness of the equilibrium of one centre of mass after another, by its dual linear program (DLP)."""

from __future__ import annotations

import ctypes
import sys
from functools import cache, partial
from importlib import metadata
from typing import Any

import numpy as np

from benchmarks.peers import not_installed
from benchmarks.questions import Case
from benchmarks.suite import MASS, Array
from benchmarks.timing import PeerFailed, Trial, Way

DISTRIBUTION = "hpp-centroidal-dynamics"
EDGES = (4, 8, 16)
# What the extension module needs, each after what it needs itself.
LIBRARIES = ("CoinUtils", "Clp", "cdd", "qpOASES", "boost_python{0.major}{0.minor}", "eigenpy", "hpp-centroidal-dynamics")


def _missing() -> str | None:
    try:
        metadata.version(DISTRIBUTION)
    except metadata.PackageNotFoundError:
        return f"{DISTRIBUTION}: not installed (pip install socp-statics[peers])"
    return not_installed("hpp_centroidal_dynamics", DISTRIBUTION)


@cache
def _module() -> Any:
    """The extension module, whose wheel does not say where its shared libraries are: they are loaded first."""
    (library,) = (f for f in metadata.files(DISTRIBUTION) or () if f.name == "libhpp-centroidal-dynamics.so")
    folder = library.locate().parent
    for name in LIBRARIES:
        ctypes.CDLL(str(folder / f"lib{name.format(sys.version_info)}.so"))
    import hpp_centroidal_dynamics

    return hpp_centroidal_dynamics


def _robustness(edges: int, case: Case) -> Trial:
    hpp = _module()
    points, normals, friction = case.points()
    if len(set(friction)) > 1:
        raise PeerFailed("hpp-centroidal-dynamics takes one coefficient of friction for all contacts")
    mu, coms = float(friction[0]), list(case.coms)
    algorithm = hpp.EquilibriumAlgorithm.EQUILIBRIUM_ALGORITHM_DLP
    # qpOASES with its warm start is faster than without, and than CLP.
    equilibrium = hpp.Equilibrium(case.name, MASS, edges, hpp.SolverLP.SOLVER_LP_QPOASES, True)

    def run(arrays: tuple[Array, Array]) -> list[Any]:
        equilibrium.setNewContacts(*arrays, mu, algorithm)
        return [equilibrium.computeEquilibriumRobustness(com) for com in coms]

    def answer(found: list[Any]) -> Any:
        known = (hpp.LP_status.LP_STATUS_OPTIMAL, hpp.LP_status.LP_STATUS_UNBOUNDED)
        if any(status not in known for status, _ in found):
            raise PeerFailed(f"hpp-centroidal-dynamics: {next(s for s, _ in found if s not in known)}")
        return np.array([status == known[1] or b >= 0.0 for status, b in found]), None

    return Trial(run, answer, lambda: (points.copy(), normals.copy()), len(coms))


def ways(question: str) -> list[Way]:
    """Verdicts with inner pyramids."""
    if question != "verdict":
        return []
    why = _missing()
    return [
        Way(f"hpp DLP, {k} edges", "qpOASES", f"{k}-sided pyramids inside", partial(_robustness, k), side="inscribed", missing=why)
        for k in EDGES
    ]
