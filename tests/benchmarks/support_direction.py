"""Time of one support direction of the compiled engine over a bare Clarabel update-and-solve on the same data.

Run as a program; nothing is asserted. Both sides are Clarabel with exact second-order cones, the same data and settings, in one run;
directions alternate between the sides so that a drift of the machine touches both.
"""

from __future__ import annotations

import statistics
import time

import clarabel
import numpy as np

from socp_statics import Stance, SurfaceContact
from socp_statics.cones import ConeChoice
from socp_statics.engines import engines_for
from socp_statics.engines.compiled import clarabel_cones, solver_settings
from socp_statics.regions.directions import Directions, com_plane
from socp_statics.statics import assemble

ROUNDS = 7
DIRECTIONS = 200


def stance(points: int) -> Stance:
    """Tilted soles, four contact points each."""
    rolls = np.linspace(-0.35, 0.35, points // 4)
    soles = [
        SurfaceContact(f"sole{i}", (0.02 * i, 0.2 * i, 0.03 * i), rpy=(r, 0.1 * r, 0.0), friction=0.5, size=(0.2, 0.1))
        for i, r in enumerate(rolls)
    ]
    return Stance(soles, (0.0, 0.1 * len(soles), 0.5), 60.0)


def measure(points: int) -> tuple[float, float]:
    """Median microseconds of a direction by the tracer's query and by bare Clarabel."""
    data = assemble(stance(points))
    (engine,) = engines_for("clarabel")
    directions = Directions(data, com_plane(data), ConeChoice(), "socp", engine)
    angles = np.linspace(0.0, 2 * np.pi, DIRECTIONS, endpoint=False)
    ways = [(float(np.cos(a)), float(np.sin(a))) for a in angles]
    form, session = directions._session._form, directions._session
    costs = []
    for way in ways:
        form.put(session._p, "direction", way)
        costs.append(form.linear_cost(session._p))
    bare = clarabel.DefaultSolver(*session._data, clarabel_cones(form.cones), solver_settings())
    ours, theirs = [], []
    for _ in range(ROUNDS):
        start = time.perf_counter()
        for way in ways:
            directions.support(way)
        middle = time.perf_counter()
        for q in costs:
            bare.update(q=q)
            bare.solve()
        ours.append((middle - start) / DIRECTIONS * 1e6)
        theirs.append((time.perf_counter() - middle) / DIRECTIONS * 1e6)
    return statistics.median(ours), statistics.median(theirs)


if __name__ == "__main__":
    print("support direction, exact second-order cones, median microseconds")
    print(f"{'points':>7} {'compiled engine':>16} {'bare Clarabel':>14} {'ratio':>6}")
    for points in (4, 8, 12, 16):
        ours, theirs = measure(points)
        print(f"{points:>7} {ours:>16.1f} {theirs:>14.1f} {ours / theirs:>6.2f}")
