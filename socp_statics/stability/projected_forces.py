"""An acceleration that obeys the contact laws, by projecting forces on their cones in turn: a guess that others refine and check.

Coulomb's law with complementarity is one inclusion, ``-(a_C + mu |a_t| n)`` is normal to the friction cone at f (De Saxce and Feng's
bipotential), hence ``f = project(f - r (a_C + mu |a_t| n))`` for any r > 0. Nothing guarantees that the sweeps end, or where.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from socp_statics.cones import FrictionCone
from socp_statics.spatial import Array
from socp_statics.stability.contact_modes import OPEN, SLIDE, STICK, Candidate
from socp_statics.stability.one_body import OneBody

Projection = Callable[[Array, Array, float], Array]
Block = tuple[Array, list[int], Projection]
SWEEPS = 2000
SETTLED = 1e-9
LOADED, MOVING = 1e-6, 1e-6


def settled_by_projection(body: OneBody, x: Array | None = None) -> Candidate | None:
    """Sweep over the contacts until the forces settle.

    Args:
        body: The body.
        x: Forces to start from, shape (nx,); zero by default, the body then starts to fall.

    Returns:
        Forces and acceleration with the modes they are nearest to, whose power is no bound of anything; None where a bound is on the
        resultant of several points, which this method does not know.
    """
    data = body.data
    if any((data.contact_of_point == k).sum() > 1 for k in body.normal_bounds):
        return None
    blocks = _blocks(body)
    maps = [G for G, *_ in blocks]
    turned = [np.linalg.solve(body.inertia, G) for G in maps]
    step = [1.0 / max(float(np.linalg.eigvalsh(G.T @ T)[-1]), 1e-12) for G, T in zip(maps, turned, strict=True)]
    forces = [np.zeros(G.shape[1]) if x is None else x[columns] for G, columns, _ in blocks]
    a = np.array(np.linalg.solve(body.inertia, data.load), dtype=np.float64)
    for T, f in zip(turned, forces, strict=True):
        a = a + T @ f
    for _ in range(SWEEPS):
        largest = 0.0
        for j, (G, _, project) in enumerate(blocks):
            new = project(forces[j], G.T @ a, step[j])
            change = new - forces[j]
            a = a + turned[j] @ change
            forces[j] = new
            largest = max(largest, float(np.abs(change).max()))
        if largest < SETTLED:
            break
    out = np.zeros(data.wrench_map.shape[1])
    for (_, columns, _), f in zip(blocks, forces, strict=True):
        out[columns] = f
    return _in_modes(body, a, out)


def _blocks(body: OneBody) -> list[Block]:
    """Of every point and handle component: wrench map, columns of x, and the projection step."""
    data = body.data
    blocks: list[Block] = []
    for i in range(data.points):
        normal = data.normal.start + i
        lo, hi = body.normal_bounds.get(int(data.contact_of_point[i]), (0.0, np.inf))
        if i >= data.slipping:
            blocks.append((data.wrench_map[:, [normal]], [normal], _clipped(lo, hi)))
            continue
        columns = [2 * i, 2 * i + 1, normal]
        mu = float(data.friction[i])
        blocks.append((data.wrench_map[:, columns], columns, _on_cone(mu) if (lo, hi) == (0.0, np.inf) else _on_bounded_cone(mu, lo, hi)))
    for column, (lo, hi) in zip(np.arange(data.wrench_map.shape[1])[data.handle].tolist(), body.handle_bounds, strict=True):
        blocks.append((data.wrench_map[:, [column]], [column], _clipped(lo, hi)))
    return blocks


def _clipped(lo: float, hi: float) -> Projection:
    return lambda f, rate, r: np.clip(f - r * rate, lo, hi)


def _on_cone(mu: float) -> Projection:
    cone = FrictionCone(mu)

    def project(f: Array, rate: Array, r: float) -> Array:
        aim = f - r * rate
        aim[2] -= r * mu * np.hypot(rate[0], rate[1])
        return cone.project(aim)

    return project


def _on_bounded_cone(mu: float, lo: float, hi: float) -> Projection:
    def project(f: Array, rate: Array, r: float) -> Array:
        aim = f - r * rate
        aim[2] = min(max(aim[2], lo), hi)
        slip = float(np.hypot(aim[0], aim[1]))
        aim[:2] *= min(1.0, mu * aim[2] / slip) if slip > 0.0 else 1.0
        return aim

    return project


def _in_modes(body: OneBody, a: Array, x: Array) -> Candidate:
    data = body.data
    slide = np.zeros(data.points)
    slide[: data.slipping] = np.linalg.norm(body.point_rows[: data.slipping, :2] @ a, axis=1)
    mode = np.where(x[data.normal] <= LOADED, OPEN, np.where(slide > MOVING, SLIDE, STICK))
    ends, give = [], {}
    for k, (lo, hi) in body.normal_bounds.items():
        force = float(x[data.normal][data.contact_of_point == k].sum())
        rate = float((body.point_rows[data.contact_of_point == k, 2] @ a).min())
        ends.append(_end(force, lo, hi, rate))
        give[k] = rate if ends[-1] >= 0 else 0.0
    handle_ends = [_end(f, lo, hi, v) for f, (lo, hi), v in zip(x[data.handle], body.handle_bounds, body.handle_rows @ a, strict=True)]
    return Candidate(float("nan"), float("nan"), a, x, mode, np.array(ends, dtype=int), np.array(handle_ends, dtype=int), give, [])


def _end(force: float, lo: float, hi: float, rate: float) -> int:
    if force <= lo + LOADED and rate > 0.0:
        return 0
    return 1 if force >= hi - LOADED and rate < 0.0 else -1
