"""The largest shape inside a convex set of disturbances, between an inner polytope of attained ones and the outer half-spaces."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, QhullError

from socp_statics.exceptions import EngineError
from socp_statics.spatial import Array
from socp_statics.stability.robustness.load_slice import EDGE, FAR, LoadSlice, Support

# The largest size of a shape inside half-spaces: unit normals (m, k) and offsets (m,) -> sizes (m,).
Gauge = Callable[[Array, Array], Array]

# Farthest disturbances looked at, in units of W, in turn where the engine does not settle programs with so much room.
CLIPS = (FAR, 30.0, 3.0)
FLAT = 1e-9
NOTHING = 1e-9
# How many times as far as the least upper bound to look: far points make facets that are tangent far away.
CLOSE = 3.0
# The clip is drawn in again where the upper bound has fallen below this share of it.
DRAWN_IN = 0.1
# With more coordinates the round clip has too many facets of its own: it stays at about the load.
DRAWN_COORDINATES = 3
# Facets refined before the polytope is rebuilt.
ROUND = 4


class Inscribed(NamedTuple):
    """Sizes between which the largest one lies.

    Attributes:
        lower: The shape of this size is inside a polytope whose corners are attained; inf where all disturbances can be balanced.
        upper: A larger one leaves a half-space that holds every disturbance that can be balanced.
        tightest: That half-space; None where none was found.
    """

    lower: float
    upper: float
    tightest: Support | None


def distances(normals: Array, offsets: Array) -> Array:
    """Gauge of a ball about the load as it is."""
    return offsets


def tilts(nominal: Array) -> Gauge:
    """Gauge of a cap of directions about a nominal one, by its angle [rad]; disturbances are changes of the unit vector.

    Args:
        nominal: Unit vector, shape (3,).
    """

    def angles(normals: Array, offsets: Array) -> Array:
        along = normals @ nominal
        ends = offsets + along
        between = np.arctan2(np.linalg.norm(np.cross(normals, nominal), axis=1), along) - np.arccos(np.clip(ends, -1.0, 1.0))
        return np.where(ends >= 1.0, np.pi, between)

    return angles


def largest_inscribed(slice_: LoadSlice, gauge: Gauge, tolerance: float, queries: int) -> Inscribed:
    """Refine both polytopes where the inner one is tightest.

    Args:
        slice_: The disturbances that can be balanced, zero among them, k >= 1 coordinates, none out of reach.
        gauge: What is to fit.
        tolerance: Width of the bracket, relative to its upper end, that is enough.
        queries: How many programs at most; the bracket is as wide as it then is.

    Returns:
        The bracket.

    Raises:
        EngineError: The engine did not settle a program.
    """
    k = slice_.coordinates
    axes = np.vstack([np.eye(k), -np.eye(k)])
    supports = _first(slice_, axes)
    if min(s.height for s in supports) >= EDGE * slice_.clip and slice_.endless(axes):
        return Inscribed(np.inf, np.inf, None)
    lower = 0.0
    while True:
        upper, _ = _tightest(supports, gauge)
        near = upper if k <= DRAWN_COORDINATES else max(upper, 1.0)
        if NOTHING < near < DRAWN_IN * slice_.clip:
            slice_.clip_at(CLOSE * near)
            supports = [s if float(np.linalg.norm(s.point)) <= slice_.clip else slice_.support(s.direction) for s in supports]
        normals, offsets = inner_facets(slice_, supports)
        upper, tightest = _tightest(supports, gauge)
        if upper <= NOTHING:
            return Inscribed(0.0, max(upper, 0.0), tightest)
        if normals is None:
            return Inscribed(min(lower, upper), upper, tightest)
        sizes = gauge(normals, offsets) if len(normals) else np.zeros(1)
        lower = max(float(sizes.min()), lower)
        wanting = np.flatnonzero(sizes < (1.0 - tolerance) * upper)
        asked = outer_planes(supports)[0]
        fresh = [i for i in _apart(normals, wanting[np.argsort(sizes[wanting], kind="stable")]) if not _among(asked, normals[i])]
        if not fresh or upper == np.inf or slice_.queries >= queries:
            return Inscribed(min(lower, upper), upper, tightest)
        found = [_tried(slice_, normals[i]) for i in fresh]
        if not any(found):
            return Inscribed(min(lower, upper), upper, tightest)
        supports += [s for s in found if s is not None]


def _first(slice_: LoadSlice, axes: Array) -> list[Support]:
    """Supports along the axes, looking as far as the engine can."""
    for far in CLIPS:
        if far != slice_.clip:
            slice_.clip_at(far)
        try:
            return [slice_.support(axis) for axis in axes]
        except EngineError:
            if far == CLIPS[-1]:
                raise
    raise EngineError("no clip was tried", name=slice_.engine.name)


def _tried(slice_: LoadSlice, direction: Array) -> Support | None:
    """A support that only narrows a bracket; None where the engine does not settle it."""
    try:
        return slice_.support(direction)
    except EngineError:
        return None


def _tightest(supports: list[Support], gauge: Gauge) -> tuple[float, Support | None]:
    """The least size that a half-space allows; those of the clip itself allow any."""
    sizes = np.where([s.clipped for s in supports], np.inf, gauge(*outer_planes(supports)))
    best = int(np.argmin(sizes))
    return (np.inf, None) if sizes[best] == np.inf else (float(sizes[best]), supports[best])


def _points(supports: list[Support]) -> Array:
    return np.array([s.point for s in supports])


def outer_planes(supports: list[Support]) -> tuple[Array, Array]:
    """Half-spaces that hold every disturbance that can be balanced, unit normals and offsets."""
    return np.array([s.direction for s in supports]), np.array([s.height for s in supports])


def _among(directions: Array, direction: Array) -> bool:
    """Whether a direction was asked before, to rounding."""
    return bool((np.abs(directions - direction).max(axis=1) < 1e-12).any())


def _apart(normals: Array, order: NDArray[np.int_]) -> list[int]:
    """The first few facets that are not one facet in several pieces."""
    chosen: list[int] = []
    for i in order:
        if all(float(normals[i] @ normals[j]) < 1.0 - 1e-9 for j in chosen):
            chosen.append(int(i))
        if len(chosen) == ROUND:
            break
    return chosen


def inner_facets(slice_: LoadSlice, supports: list[Support]) -> tuple[Array | None, Array]:
    """Facets of the inner polytope, unit normals and offsets.

    No facets where the set is flat, whose sides are then among the supports; None where rounding keeps the polytope from being built.
    """
    points = _points(supports)
    k = slice_.coordinates
    scale = float(np.abs(points).max(initial=0.0))
    while True:
        _, s, Vt = np.linalg.svd(points - points[0], full_matrices=True)
        rank = int((s > FLAT * max(scale, NOTHING)).sum())
        if rank == k:
            break
        for v in (Vt[rank], -Vt[rank]):
            supports.append(slice_.support(v))
        wider = _points(supports)
        if float(np.ptp(wider @ Vt[rank])) <= FLAT * max(scale, NOTHING):
            return np.zeros((0, k)), np.zeros(0)
        points = wider
    if k == 1:
        return np.array([[1.0], [-1.0]]), np.array([points.max(), -points.min()])
    # Facets of points whose spread differs much between directions are lost to rounding: equal spreads first.
    centre, (_, spread, axes) = points.mean(axis=0), np.linalg.svd(points - points.mean(axis=0), full_matrices=False)
    even = axes / spread[:, None]
    try:
        equations = ConvexHull((points - centre) @ even.T, qhull_options="Qt Qx Q12" if k > 4 else "Qt Q12").equations
    except QhullError:
        return None, np.zeros(0)
    normals = equations[:, :-1] @ even
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    # An offset is what the points say, never more.
    return normals, (points @ normals.T).max(axis=0)
