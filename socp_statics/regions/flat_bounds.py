"""Motions that bound a support region without edges: a segment, a point, or one that is too narrow for its edges to be of any use."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from socp_statics.certificates import Motion
from socp_statics.cones.choice import ConeChoice
from socp_statics.engines.engine import Engine
from socp_statics.engines.solution import SOLVED
from socp_statics.regions.directions import Directions, com_plane
from socp_statics.spatial import Array
from socp_statics.statics import StaticsData
from socp_statics.statics.wrench_range import SINGULAR, wrench_range


def bounding_motions(data: StaticsData, cone: ConeChoice, normals: Sequence[Array], engine: Engine) -> list[Motion]:
    """For each outward normal a motion whose half-plane, the centres of mass for which the load does no work on it, holds the region.

    Where the contacts give no moment about some line, every turn about it is such a motion, either way; elsewhere it is that of the
    support program.

    Args:
        data: The stance's arrays.
        cone: Exact cones or pyramids.
        normals: Unit vectors in the horizontal plane, shape (2,) each.
        engine: That solves the programs.

    Returns:
        The motions, scaled; none for a normal along which the region has no end.

    Raises:
        EngineError: A program was not settled.
    """
    plane, null = com_plane(data), wrench_range(data.wrench_map).null
    turns = null.T @ data.com_load
    directions = Directions(data, plane, cone, "socp", engine) if plane.axes.shape[1] else None
    out = []
    for normal in normals:
        free = plane.axes.T @ normal
        motion = Motion(np.zeros(6), np.zeros(len(data.torques.names)))
        if directions is not None and np.linalg.norm(free) > SINGULAR:
            solution = directions.solve(tuple(free.tolist()))
            if solution.status != SOLVED:
                continue
            motion = directions.motion(solution)
        rest = normal - data.com_load.T @ motion.twist
        turn = null @ np.linalg.lstsq(turns.T, rest, rcond=SINGULAR)[0] if len(turns) else np.zeros(6)
        out.append(Motion(motion.twist + turn, motion.joints))
    return out
