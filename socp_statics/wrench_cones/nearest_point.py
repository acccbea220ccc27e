"""The nearest point of a cone that is known by the ray that a direction likes best.

Rays are collected one round after the other: the nearest point of the cone over those collected (non-negative least squares) leaves a
rest, and the rays that the rest likes best are added, until it likes none. The last rest is then the normal of a plane that
supports the whole cone: the projection is proved by Moreau's conditions, not by a stopping rule.
"""

from __future__ import annotations

import numpy as np

from socp_statics.exceptions import EngineError
from socp_statics.spatial import Array
from socp_statics.wrench_cones.combination import nearest_combination
from socp_statics.wrench_cones.generators import Generators

ROUNDS = 200
OPTIMAL = 1e-12
ACCEPTED = 1e-9
RANK = 1e-12


def nearest_point(generators: Generators, wrench: Array) -> Array:
    """Euclidean projection on the cone.

    Args:
        generators: What spans the cone, in units in which wrenches are measured by their Euclidean length.
        wrench: Shape (6,).

    Returns:
        Shape (6,).

    Raises:
        EngineError: Moreau's conditions do not hold to 1e-9 after 200 rounds.
    """
    size = float(np.abs(wrench).max(initial=0.0))
    if size == 0.0:
        return np.zeros(6)
    across = _complement(generators.lines)
    target = (wrench / size) @ across
    rest = _rest_of_rays(generators, across, target) if generators.polyhedral else _rest_of_cones(generators, across, target)
    return wrench - size * (across @ rest)


def _rest_of_rays(generators: Generators, across: Array, target: Array) -> Array:
    rays = _unit(generators.rays() @ across)
    rest = target - nearest_combination(rays, target) @ rays
    _check(rest, target, float((rays @ rest).max(initial=0.0)))
    return rest


def _rest_of_cones(generators: Generators, across: Array, target: Array) -> Array:
    points = np.arange(len(generators.columns))
    one_way = _unit(generators.half_lines @ across)
    force, owner = np.zeros((0, 4)), np.zeros(0, dtype=int)
    rest = target
    for _ in range(ROUNDS):
        best = generators.best(across @ rest)
        force, owner = np.vstack([force, best]), np.concatenate([owner, points])
        wrenches = np.einsum("nij,nj->ni", generators.columns[owner], force) @ across
        lengths = np.linalg.norm(wrenches, axis=1)
        seen = lengths > RANK
        force, owner, lengths = force[seen], owner[seen], lengths[seen]
        rays = np.vstack([wrenches[seen] / lengths[:, None], one_way])
        gain = float((rays @ rest).max(initial=0.0))
        if gain <= OPTIMAL * np.linalg.norm(rest):
            break
        amounts = nearest_combination(rays, target)
        left = target - amounts @ rays
        if np.linalg.norm(left) >= np.linalg.norm(rest):
            break
        rest = left
        mine = amounts[: len(lengths)] / lengths
        used = mine > 0.0
        total = np.zeros((len(points), 4))
        np.add.at(total, owner[used], mine[used, None] * force[used])
        loaded = points[total[:, 2] > 0.0]
        # Rays that come ever closer halve the error a round; where they add up to inside their cone is quadratically near the end.
        guessed = generators.on_boundary(total)[loaded] / total[loaded, 2:3]
        force, owner = np.vstack([force[used], guessed]), np.concatenate([owner[used], loaded])
    _check(rest, target, gain)
    return rest


def _check(rest: Array, target: Array, gain: float) -> None:
    """Moreau's conditions: no ray gains, and the rest is orthogonal to the nearest point."""
    if max(gain, abs(float(rest @ (target - rest)))) > ACCEPTED:
        raise EngineError(f"the nearest wrench of the cone was not found, a ray still gains {gain:.0e}", name="wrench cone")


def _complement(lines: Array) -> Array:
    """Orthonormal columns of what is orthogonal to the lines."""
    if not len(lines):
        return np.eye(6)
    _, s, Vt = np.linalg.svd(lines)
    return Vt[int((s > RANK * s[0]).sum()) :].T


def _unit(rows: Array) -> Array:
    """Rows of unit length; those along a line vanish and are left out."""
    lengths = np.linalg.norm(rows, axis=1)
    kept = lengths > RANK * lengths.max(initial=0.0)
    unit: Array = rows[kept] / lengths[kept, None]
    return unit
