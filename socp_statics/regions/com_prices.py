"""What the distance of the centre of mass to the edge of its region gains per unit of friction, limit or contact displacement.

The distance is ``min over unit d of h(d) - d . c`` with the support function h; at the nearest edge its derivatives are those of h(d)
with d held (envelope theorem), taken at forces that attain the nearest point. Prices therefore need two programs at the direction d of
the nearest edge: the support direction for the multipliers, the ray from the centre of mass along d for the forces.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from socp_statics.certificates.optimum import Multipliers, Optimum
from socp_statics.certificates.prices import Prices, Scale, prices_of
from socp_statics.cones.choice import ConeChoice
from socp_statics.contacts.stance import stance_of
from socp_statics.engines import engines_for
from socp_statics.engines.engine import Engine
from socp_statics.engines.solution import SOLVED, Solution
from socp_statics.exceptions import EngineError
from socp_statics.models.contact_forces_set import force_shape, force_values
from socp_statics.models.support_region import MODEL, RegionShape
from socp_statics.regions.com_margin import RELATIVE, on_clip
from socp_statics.regions.directions import CoMPlane, Directions, com_plane
from socp_statics.regions.support_region import SupportRegion
from socp_statics.regions.tracer import CLIP
from socp_statics.spatial import Array
from socp_statics.statics import StaticsData, assemble

FIRST_ANGLE = 1e-4
MOST_QUERIES = 60
SAME_POINT = 1e-9
SAME_ANGLE = 1e-9
SAME_EDGE = 1e-6


class _Support(NamedTuple):
    """A support query: its attained point and its solution."""

    point: Array
    solution: Solution


def _queried(directions: Directions, d: tuple[float, float]) -> _Support:
    solution = directions.solve(d)
    if solution.status != SOLVED:
        raise EngineError(f"engine {directions.engine} did not settle the nearest edge: {solution.status}", name=directions.engine)
    return _Support(np.array(solution.variable("s")), solution)


class _Query(NamedTuple):
    """A support query near the nearest edge: angle, attained point and multipliers' solution, and how far it is along the edge."""

    angle: float
    point: Array
    solution: Solution
    along: float


def com_margin_prices(
    stance: Any,
    region: SupportRegion,
    *,
    form: str = "socp",
    engine: str | Sequence[str] = "auto",
    torque_limits: bool | Mapping[str, Any] = False,
) -> Prices | None:
    """Prices of the CoM margin: multipliers of the edge nearest to the centre of mass.

    Args:
        stance: A Stance or a Posture.
        region: Its support region, as `trace_support_region` found it.
        form: "socp" or "sdp".
        engine: "auto", the name of an engine, or several to be tried in turn.
        torque_limits: As the region was asked for.

    Returns:
        How many metres the CoM margin gains per unit of friction, bound, limit and contact displacement; a displaced contact leaves the
        centre of mass where it is, and with a robot moves on its link. None where the region is no polygon, has no edge, or the
        set of forces has no interior.

    Raises:
        EngineError: No engine settled a program.
        InputError: There is no such engine.
    """
    margin = region.com_margin
    if region.kind not in ("polygon", "unbounded") or margin is None or not np.isfinite(margin) or region.widened:
        return None
    stance = stance_of(stance, torque_limits=torque_limits)
    data = assemble(stance)
    plane = com_plane(data)
    if plane.twist is not None or plane.axes.shape[1] < 2:
        return None
    com, inner = _coordinates(data, plane, stance.com[:2]), _coordinates(data, plane, region.inner)
    clip = None if region.kind == "polygon" else CLIP
    if not _own_edges(inner, clip):
        return None
    broken: EngineError | None = None
    for one in engines_for(engine, form):
        try:
            directions = Directions(data, plane, region.cone, form, one, clip)
            start, alone = _nearest_edge(directions, inner, com, clip)
            optimum = _optimum(data, plane, region.cone, form, one, directions, start)
        except EngineError as error:
            broken = error
            continue
        prices = prices_of(optimum, Scale("com_margin", "m", data.units.length))
        return prices if alone else prices.doubtful()
    assert broken is not None
    raise broken


def _coordinates(data: StaticsData, plane: CoMPlane, xy: Array) -> Array:
    """Positions in world axes as free coordinates of the plane, shape (..., 2)."""
    return ((xy - data.units.origin[:2]) / data.units.length - plane.origin) @ plane.axes


def _own_edges(P: Array, clip: float | None) -> list[int]:
    """Edges of a polygon that the clipping square did not make; none where the square holds nothing of the region."""
    Q = np.roll(P, -1, axis=0)
    return [k for k in range(len(P)) if np.linalg.norm(Q[k] - P[k]) > SAME_POINT and not on_clip(P[k], Q[k], clip)]


def _nearest_edge(directions: Directions, P: Array, com: Array, clip: float | None) -> tuple[Array, bool]:
    """Outward direction of the part of the edge nearest to a position, and whether no other part is as near.

    The inner polygon may be coarse there: it is refined at its nearest edge until that edge is one of the region, within 1e-3.
    """
    for _ in range(MOST_QUERIES):
        Q = np.roll(P, -1, axis=0)
        length = np.linalg.norm(Q - P, axis=1)
        real = _own_edges(P, clip)
        E = (Q - P)[real]
        normals = np.column_stack([E[:, 1], -E[:, 0]]) / length[real, None]
        away = (normals * (P[real] - com)).sum(axis=1)
        if away.min() < -SAME_EDGE:
            along = np.clip(((com - P[real]) * E).sum(axis=1) / length[real] ** 2, 0.0, 1.0)
            gaps = com - (P[real] + along[:, None] * E)
            distance = np.linalg.norm(gaps, axis=1)
            k = int(np.argmin(distance))
            return gaps[k] / distance[k], True
        k = int(np.argmin(away))
        d = normals[k]
        point = _queried(directions, (float(d[0]), float(d[1]))).point
        if float(d @ (point - P[real[k]])) <= max(RELATIVE * away[k], SAME_POINT):
            break
        P = np.insert(P, real[k] + 1, point, axis=0)
    rivals = (away - away[k] <= SAME_EDGE) & (normals @ d < 1.0 - 1e-3)
    return d, not rivals.any()


def _optimum(
    data: StaticsData, plane: CoMPlane, cone: ConeChoice, form: str, engine: Engine, directions: Directions, start: Array
) -> Optimum:
    """Multipliers of the nearest edge with forces of its nearest point."""
    com = (data.com[:2] - plane.origin) @ plane.axes
    nearest = _nearest(directions, com, start)
    d = plane.axes @ np.array([np.cos(nearest.angle), np.sin(nearest.angle)])
    ray = data.com_load @ d[:, None]
    shape = RegionShape(force_shape(data, cone, form, plane.basis.shape[1]), 1, False)
    values = force_values(data, cone, plane.basis) | {"D": plane.basis.T @ ray, "direction": np.ones(1)}
    solution = engine.compile(MODEL, shape).solve(values)
    if solution.status != SOLVED:
        raise EngineError(f"engine {engine.name} did not settle the ray to the nearest edge: {solution.detail}", name=engine.name)
    multipliers = Multipliers.read(data, directions.motion(nearest.solution).twist, nearest.solution.duals)
    none = np.zeros((len(data.limit_values), 2))
    margin = float(solution.objective)
    x = solution.variables["x"]
    return Optimum(data, cone, x, 0.0, multipliers, data.com_load @ plane.axes, np.zeros(2), none, margin, pinned=True)


def _nearest(directions: Directions, com: Array, start: Array) -> _Query:
    """The support query whose line is nearest: its attained points lie on both sides of the foot of the centre of mass."""

    def query(angle: float) -> _Query:
        d = (float(np.cos(angle)), float(np.sin(angle)))
        support = _queried(directions, d)
        return _Query(angle, support.point, support.solution, float((support.point - com) @ np.array([-d[1], d[0]])))

    first, step = float(np.arctan2(start[1], start[0])), FIRST_ANGLE
    before, after = query(first - step), query(first + step)
    for _ in range(MOST_QUERIES):
        if before.along <= 0.0 <= after.along:
            break
        step *= 2.0
        if before.along > 0.0:
            before, after = query(first - step), before
        else:
            before, after = after, query(first + step)
    for turn in range(MOST_QUERIES):
        chord = after.point - before.point
        if np.linalg.norm(chord) <= SAME_POINT or after.angle - before.angle <= SAME_ANGLE:
            break
        angle = 0.5 * (before.angle + after.angle)
        if turn % 2 == 0:
            edge = float(np.arctan2(-chord[0], chord[1]))
            edge += 2.0 * np.pi * np.rint((angle - edge) / (2.0 * np.pi))
            angle = edge if before.angle < edge < after.angle else angle
        here = query(angle)
        d = np.array([np.cos(angle), np.sin(angle)])
        if float(d @ here.point - max(d @ before.point, d @ after.point)) <= SAME_POINT:
            return here
        before, after = (here, after) if here.along < 0.0 else (before, here)
    away = com - 0.5 * (before.point + after.point)
    if np.linalg.norm(away) <= SAME_POINT:
        return query(0.5 * (before.angle + after.angle))
    angle = float(np.arctan2(away[1], away[0]))
    middle = 0.5 * (before.angle + after.angle)
    # Inside, the edge lies beyond the centre of mass; outside, the centre of mass lies beyond the edge.
    angle = min((angle, angle + np.pi), key=lambda a: abs(np.angle(np.exp(1j * (a - middle)))))
    return query(angle)
