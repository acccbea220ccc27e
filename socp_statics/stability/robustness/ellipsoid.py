"""The largest ellipsoid of pushes, or of moments, that can all be balanced: between attained ones and half-spaces."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from socp_statics.engines import engines_for
from socp_statics.engines.engine import Engine
from socp_statics.engines.solution import SOLVED
from socp_statics.exceptions import EngineError
from socp_statics.models.inscribed_ellipsoid import MODEL, EllipsoidShape, padded
from socp_statics.spatial import Array
from socp_statics.stability.robustness.ball import Settings
from socp_statics.stability.robustness.disturbances import Disturbance
from socp_statics.stability.robustness.inscribed import inner_facets, outer_planes
from socp_statics.stability.robustness.load_slice import FAR, LoadSlice, Support
from socp_statics.stability.robustness.measure import EXACT, Measure, bracketed, listed
from socp_statics.statics import StaticsData

QUERIES = {2: 200, 3: 160}


class Ellipsoid(NamedTuple):
    """``{centre + shape u : |u| <= 1}``, scaled.

    Attributes:
        mean: Geometric mean of the semi-axes.
        centre: Shape (k,).
        shape: Symmetric positive semidefinite, shape (k, k).
    """

    mean: float
    centre: Array
    shape: Array


def largest_ellipsoid(normals: Array, offsets: Array, engine: Engine) -> Ellipsoid:
    """The largest ellipsoid inside half-spaces ``a_j . z <= b_j``.

    Args:
        normals: a, shape (m, k), k = 2 or 3.
        offsets: b, shape (m,).
        engine: One that takes semidefinite cones.

    Raises:
        EngineError: The engine did not settle it.
    """
    a, b = padded(normals, offsets)
    size = float(np.abs(b).max()) or 1.0
    solution = engine.compile(MODEL, EllipsoidShape(*a.shape)).solve({"a": a, "b": b / size})
    if solution.status != SOLVED:
        raise EngineError(f"engine {engine.name} did not settle an ellipsoid: {solution.detail}", name=engine.name)
    E = solution.variables["E"]
    return Ellipsoid(size * float(solution.variables["t"]), size * solution.variables["c"], 0.5 * size * (E + E.T))


def ellipsoid_measure(name: str, unit: str, data: StaticsData, disturbance: Disturbance, settings: Settings) -> Measure:
    """Geometric mean of the semi-axes of the largest ellipsoid of disturbances, wherever its centre.

    Args:
        name: Its word.
        unit: Its unit.
        data: Arrays of a stance that holds.
        disturbance: In two or three coordinates.
        settings: How to ask.

    Returns:
        The mean, with centre and semi-axes of an ellipsoid all of whose disturbances can be balanced.

    Raises:
        EngineError: No engine settled it.
    """
    seen = disturbance.seen()
    details = []
    for one in engines_for(settings.engine, "sdp"):
        try:
            return _asked(name, unit, LoadSlice(data, seen, settings.cone, settings.form, one), settings)
        except EngineError as error:
            details.append(str(error))
    raise EngineError(f"{name} was not settled: {'; '.join(details)}", name=name)


def _asked(name: str, unit: str, slice_: LoadSlice, settings: Settings) -> Measure:
    k, seen = slice_.coordinates, slice_.disturbance
    flat = Measure(name, 0.0, unit, EXACT, (0.0, 0.0), note="what can be balanced is flat")
    if slice_.unreachable is not None:
        return flat
    supports = [slice_.support(axis) for axis in np.vstack([np.eye(k), -np.eye(k)])]
    far = [s.point / np.linalg.norm(s.point) for s in supports if np.linalg.norm(s.point) >= 0.999 * FAR]
    for direction in far:
        if slice_.endless(direction[None]):
            return Measure(name, np.inf, unit, EXACT, (np.inf, np.inf), note="along the direction it can grow without end",
                           direction=seen.axes @ direction)  # fmt: skip
    found: tuple[Ellipsoid, float] | None = None
    while True:
        normals, offsets = inner_facets(slice_, supports)
        if normals is None:
            raise EngineError(f"the polytope of {name} could not be built", name=slice_.engine.name)
        if not len(normals):
            return flat
        try:
            inner, outer = (largest_ellipsoid(*planes, slice_.engine) for planes in ((normals, offsets), outer_planes(supports)))
        except EngineError:
            # Many half-spaces that all touch can be too many to settle: the bracket of fewer is wider, and as true.
            if found is None:
                raise
            break
        found = inner, max(outer.mean, inner.mean)
        fresh = _fresh(normals, supports)
        if found[1] - inner.mean <= settings.tolerance * found[1] or slice_.queries >= QUERIES[k] or not fresh:
            break
        supports += [slice_.support(v) for v in fresh]
    inner, upper = found
    lengths, ways = np.linalg.eigh(inner.shape)
    details = {
        "centre": listed(seen.one * seen.axes @ inner.centre),
        "semi_axes": [listed(seen.one * lengths[i] * (seen.axes @ ways[:, i])) for i in reversed(range(k))],
    }
    return bracketed(name, unit, seen.one * inner.mean, seen.one * upper, settings.tolerance, details=details)


def _fresh(normals: Array, supports: list[Support]) -> list[Array]:
    """Normals of facets that were not asked yet, each once."""
    out: list[Array] = []
    known = [s.direction for s in supports]
    for v in normals:
        if all(float(v @ w) < 1.0 - 1e-9 for w in known):
            known.append(v)
            out.append(v)
    return out
