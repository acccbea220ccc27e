"""The directions in which the centre of mass is nearest to the edge of its region: what a CoM margin depends on."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.optimize import minimize_scalar

from socp_statics.cones.choice import ConeChoice
from socp_statics.contacts import Stance
from socp_statics.regions import support_function, trace_support_region
from socp_statics.spatial import Array

MOST = 5
APART = 0.2
NEAR = 0.05
FINE, REFINEMENTS = 1e-6, 24


def com_directions(stance: Stance, cone: ConeChoice, engine: str | Sequence[str]) -> Array | None:
    """Normals of the nearest edges of the support region, those that compete for the nearest refined where the edge is curved.

    Args:
        stance: The stance.
        cone: Exact cones or pyramids.
        engine: Which engines to try.

    Returns:
        Unit vectors, the nearest first, shape (k, 2); None where the region is no bounded polygon.
    """
    region = trace_support_region(stance, cone=cone, engine=engine)
    if region.kind != "polygon":
        return None
    com = stance.com[:2]
    normals, offsets = region.halfplanes
    away = offsets - normals @ com
    chosen: list[Array] = []
    for k in np.argsort(away, kind="stable"):
        d = normals[k]
        if all(float(d @ other) < np.cos(APART) for other in chosen):
            competes = away[k] - away.min() <= NEAR * abs(away.min())
            chosen.append(_refined(stance, d, com, float(away[k]), cone, engine) if competes else d)
        if len(chosen) == MOST:
            break
    return np.array(chosen)


def _refined(stance: Stance, d: Array, com: Array, known: float, cone: ConeChoice, engine: str | Sequence[str]) -> Array:
    """The direction of the least distance near one."""
    angle = float(np.arctan2(d[1], d[0]))

    def distance(turn: float) -> float:
        unit = np.array([np.cos(angle + turn), np.sin(angle + turn)])
        return float(support_function(stance, unit[None], cone=cone, engine=engine).height[0] - unit @ com)

    found = minimize_scalar(distance, bounds=(-APART, APART), method="bounded", options={"xatol": FINE, "maxiter": REFINEMENTS})
    if not found.fun < known:
        return d
    return np.array([np.cos(angle + found.x), np.sin(angle + found.x)])
