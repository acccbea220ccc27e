"""Tracing by any engine, one program at a time: empty, point, segment, polygon or without end, each with its witnesses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from socp_statics.certificates import Motion
from socp_statics.cones.choice import ConeChoice
from socp_statics.engines.engine import Engine
from socp_statics.engines.solution import INFEASIBLE, SOLVED, UNBOUNDED, Solution
from socp_statics.exceptions import EngineError
from socp_statics.models.contact_forces_set import force_shape
from socp_statics.models.equilibrium import MODEL as EQUILIBRIUM
from socp_statics.models.hard_rows import MODEL as HARD_ROWS
from socp_statics.models.hard_rows import hard_values
from socp_statics.models.largest_reserve import MODEL as LARGEST_RESERVE
from socp_statics.models.support_region import RegionShape
from socp_statics.regions import polygon
from socp_statics.regions.com_margin import on_edge_or, refined_margin
from socp_statics.regions.directions import (
    CoMPlane,
    Directions,
    EmptyRegion,
    UnboundedDirection,
    load_at,
    plane_values,
    recession,
    widened,
)
from socp_statics.regions.polygon import NARROW
from socp_statics.regions.sandwich import START, Sandwich
from socp_statics.regions.support_region import SupportRegion
from socp_statics.regions.witnesses import SolvedWitnesses
from socp_statics.spatial import Array
from socp_statics.statics import StaticsData
from socp_statics.statics.units import BOUNDARY

CLIP = 10.0
FARTHEST = 1e6
CORNER = 1e-11


class Tracer:
    """One tracing with one engine; scaled coordinates about the centre of the contacts."""

    def __init__(self, data: StaticsData, plane: CoMPlane, cone: ConeChoice, form: str, engine: Engine, tolerance: float,
                 com: Array | None, handovers: int):  # fmt: skip
        self.data, self.plane, self.cone, self.form, self.engine = data, plane, cone, form, engine
        self.tolerance, self.com, self.handovers = tolerance, com, handovers
        self.solves = 0

    def region(self) -> SupportRegion:
        """The region."""
        if self.plane.twist is not None:
            return self._empty()
        try:
            return self._traced()
        except EngineError as error:
            return self._without_interior(error)

    def _traced(self) -> SupportRegion:
        return (self._point, self._segment, self._plane)[self.plane.axes.shape[1]]()

    def _without_interior(self, error: EngineError) -> SupportRegion:
        """What no engine settles because the set of forces has no interior: empty, or traced with cones 1e-7 W wider."""
        if not self.plane.axes.shape[1]:
            raise error
        start = load_at(self.data, self.plane.origin)
        hard, rows = hard_values(self.data, self.plane.basis, start, self.data.com_load @ self.plane.axes)
        missing = self.engine.compile(HARD_ROWS, hard).solve(rows)
        self.solves += 1
        if missing.status == SOLVED and missing.objective > BOUNDARY:
            return self._empty()
        solution = self._largest_reserve()
        if self._none_in_balance(solution):
            return self._empty()
        if solution.status != SOLVED or solution.objective > BOUNDARY:
            raise error
        wide, shift = widened(self.data, BOUNDARY + max(-solution.objective, 0.0))
        tracer = Tracer(wide, self.plane, self.cone, self.form, self.engine, self.tolerance, self.com, self.handovers)
        traced = tracer._traced()
        witnesses = replace(traced.witnesses, data=self.data, shift=shift)  # type: ignore[type-var]
        return replace(traced, witnesses=witnesses, widened=-float(shift.min(initial=0.0)) * self.data.units.force)

    def _largest_reserve(self) -> Solution:
        """The position with the largest reserve, wherever it is."""
        shape = RegionShape(force_shape(self.data, self.cone, self.form, self.plane.basis.shape[1]), self.plane.axes.shape[1], False)
        self.solves += 1
        return self.engine.compile(LARGEST_RESERVE, shape).solve(plane_values(self.data, self.plane, self.cone) | {"cap": np.array(1.0)})

    @staticmethod
    def _none_in_balance(largest: Solution) -> bool:
        return largest.status == INFEASIBLE or (largest.status == SOLVED and largest.objective < -BOUNDARY)

    @property
    def _unrestricted(self) -> bool:
        """Whether nothing but the range of G restricts the forces: handles without limits."""
        return self.data.points == 0 and len(self.data.limit_values) == 0

    @property
    def _standing(self) -> Motion:
        """No motion: that of an edge which nothing but the clipping square or the range of G makes."""
        return Motion(np.zeros(6), np.zeros(len(self.data.torques.names)))

    def _point(self) -> SupportRegion:
        """No free coordinate: one position is in reach, it is the region or there is none."""
        position = self.plane.origin
        compiled = self.engine.compile(EQUILIBRIUM, force_shape(self.data, self.cone, self.form, self.plane.basis.shape[1]))
        values = plane_values(self.data, self.plane, self.cone) | {"cap": np.array(1.0)}
        solution = compiled.solve(values)
        self.solves += 1
        if solution.status == INFEASIBLE or (solution.status == SOLVED and solution.objective < -NARROW):
            return self._empty()
        if solution.status != SOLVED:
            raise EngineError(f"engine {self.engine.name} did not settle whether a point is in balance", name=self.engine.name)
        return self._flat([position], [solution], [])

    def _segment(self) -> SupportRegion:
        """One free coordinate: its two ends."""
        if self._unrestricted:
            return self._endless_line([-1.0, 1.0], [])
        directions = Directions(self.data, self.plane, self.cone, self.form, self.engine)
        ends = [directions.solve((sign,)) for sign in (-1.0, 1.0)]
        self.solves += 2
        if ends[0].status == INFEASIBLE:
            return self._empty()
        endless = [sign for sign, end in zip((-1.0, 1.0), ends, strict=True) if end.status == UNBOUNDED]
        if endless:
            return self._endless_line(endless, ends)
        points = [directions.position(e.variables["s"]) for e in ends]
        bounds = [directions.position(np.array([sign * e.bound])) for sign, e in zip((-1.0, 1.0), ends, strict=True)]
        return self._flat(points, ends, bounds)

    def _flat(self, points: list[Array], solutions: list[Solution], bounds: list[Array]) -> SupportRegion:
        """A segment, or a point where it is too short to be one."""
        length = float(np.linalg.norm(points[-1] - points[0]))
        if length < NARROW:
            points, solutions, bounds = points[:1], solutions[:1], points[:1]
            gap = 0.0
        else:
            outer = float(np.linalg.norm(bounds[-1] - bounds[0]))
            gap = max(outer - length, 0.0) / max(outer, length)
        kind = "segment" if len(points) == 2 else "point"
        inner = np.array(points)
        margin = None if self.com is None else float(polygon.distance(inner, self.com))
        none = [self._standing] * len(bounds)
        return self._result(kind, inner, np.array(bounds), np.zeros((0, 2)), gap, margin, solutions, none)

    def _endless_line(self, signs: list[float], ends: list[Solution]) -> SupportRegion:
        """One free coordinate without an end on one side or both: a ray or a line, clipped to the square."""
        axis = self.plane.axes[:, 0]
        rays = np.array([sign * axis + 0.0 for sign in signs])
        low = -np.inf if -1.0 in signs else float(ends[0].variable("s")[0])
        high = np.inf if 1.0 in signs else float(ends[1].variable("s")[0])
        margin = None
        if self.com is not None:
            along = float(np.clip(axis @ (self.com - self.plane.origin), low, high))
            margin = -float(np.linalg.norm(self.com - self.plane.origin - along * axis))
        start, stop = self._inside_square(axis)
        if start >= stop or start > high or stop < low:
            none = np.zeros((0, 2))
            return self._result("unbounded", none, none, rays, 0.0, margin, [], [])
        centred = replace(self.plane, origin=self.plane.origin + 0.5 * (start + stop) * axis)
        clipped = Directions(self.data, centred, self.cone, self.form, self.engine, clip=0.5 * (stop - start))
        found = [clipped.solve((sign,)) for sign in (-1.0, 1.0)]
        self.solves += 2
        # An engine may say first that something grows without end where there is nothing at all.
        if any(s.status == INFEASIBLE for s in found) and self._none_in_balance(self._largest_reserve()):
            return self._empty()
        if any(s.status != SOLVED for s in found):
            raise EngineError(f"engine {self.engine.name} did not settle an endless segment", name=self.engine.name)
        points = np.array([clipped.position(s.variables["s"]) for s in found])
        return self._result("unbounded", points, points, rays, 0.0, margin, found, [self._standing] * 2)

    def _inside_square(self, axis: Array) -> tuple[float, float]:
        """Between which coordinates a line lies in the clipping square."""
        start, stop = -np.inf, np.inf
        for a, o in zip(axis, self.plane.origin, strict=True):
            if abs(a) > 1e-12:
                ends = sorted(((-CLIP - o) / a, (CLIP - o) / a))
                start, stop = max(start, ends[0]), min(stop, ends[1])
            elif abs(o) > CLIP:
                return 0.0, 0.0
        return start, stop

    def _plane(self) -> SupportRegion:
        """Two free coordinates."""
        if self._unrestricted:
            return self._endless()
        directions = Directions(self.data, self.plane, self.cone, self.form, self.engine)
        try:
            sandwich = Sandwich(directions.support, [directions.support(d) for d in START])
        except EmptyRegion:
            self.solves += directions.queries
            return self._empty()
        except UnboundedDirection:
            self.solves += directions.queries
            return self._endless()
        return self._enclosed(directions, sandwich)

    def _enclosed(self, directions: Directions, sandwich: Sandwich) -> SupportRegion:
        thin = not sandwich.refine(self.tolerance, self._is_thin) or self._is_thin(sandwich)
        if thin:
            self.solves += directions.queries
            return self._narrow(directions, sandwich)
        margin = None if self.com is None else refined_margin(sandwich, self.com, None)
        self.solves += directions.queries
        return self._polygon("polygon", directions, sandwich, np.zeros((0, 2)), margin)

    @staticmethod
    def _is_thin(sandwich: Sandwich) -> bool:
        return polygon.width(sandwich.polygon()) < NARROW

    def _narrow(self, directions: Directions, sandwich: Sandwich) -> SupportRegion:
        """A region without width: its two farthest attained points."""
        supports = sandwich.supports()
        P = np.array([s.c for s in supports])
        away = np.linalg.norm(P[:, None] - P[None], axis=2)
        i, j = (int(k) for k in np.unravel_index(int(np.argmax(away)), away.shape))
        if away[i, j] < NARROW:
            return self._flat([P[i]], [supports[i].kept], [])
        u = (P[j] - P[i]) / away[i, j]
        ends = [directions.support((float(-u[0]), float(-u[1]))), directions.support((float(u[0]), float(u[1])))]
        self.solves += 2
        bounds = [np.array(e.c) + (e.h - float(np.dot(e.d, e.c))) * np.array(e.d) for e in ends]
        return self._flat([np.array(e.c) for e in ends], [e.kept for e in ends], bounds)

    def _endless(self) -> SupportRegion:
        """A region without end: its recession cone, and what lies in the clipping square."""
        cone = Directions(recession(self.data), CoMPlane(np.zeros(2), np.eye(2), self.plane.basis, None), self.cone, self.form,
                          self.engine, clip=1.0)  # fmt: skip
        growth = Sandwich(cone.support, [cone.support(d) for d in START])
        growth.refine(1e-7, self._is_thin)
        rays = _recession_rays(np.array([s.c for s in growth.supports()]))
        self.solves += cone.queries
        if not len(rays):
            raise EngineError(f"engine {self.engine.name} found a region without end but no direction of growth", name=self.engine.name)
        directions = Directions(self.data, self.plane, self.cone, self.form, self.engine, clip=CLIP)
        try:
            sandwich = Sandwich(directions.support, [directions.support(d) for d in START])
        except EmptyRegion:
            self.solves += directions.queries
            # An engine may say first that something grows without end where there is nothing at all.
            if len(rays) == 4 or self._none_in_balance(self._largest_reserve()):
                return self._empty()
            margin = self._endless_margin(rays)
            return self._result("unbounded", np.zeros((0, 2)), np.zeros((0, 2)), rays, 0.0, margin, [], [])
        margin = self._endless_margin(rays)
        sandwich.refine(self.tolerance, self._is_thin)
        self.solves += directions.queries
        return self._polygon("unbounded", directions, sandwich, rays, margin)

    def _endless_margin(self, rays: Array) -> float | None:
        """CoM margin in a region without end, seen through a square that holds the centre of mass."""
        if self.com is None:
            return None
        if len(rays) == 4:
            return np.inf
        clip = max(CLIP, 4.0 * float(np.abs(self.com).max()))
        while True:
            directions = Directions(self.data, self.plane, self.cone, self.form, self.engine, clip=clip)
            try:
                sandwich = Sandwich(directions.support, [directions.support(d) for d in START])
                break
            except EmptyRegion:
                self.solves += directions.queries
                clip *= 4.0
            if clip > FARTHEST:
                raise EngineError(f"engine {self.engine.name} found a region without end but not where it begins", name=self.engine.name)
        margin = refined_margin(sandwich, self.com, clip)
        self.solves += directions.queries
        return margin

    def _polygon(self, kind: str, directions: Directions, sandwich: Sandwich, rays: Array, margin: float | None) -> SupportRegion:
        supports = sandwich.supports()
        inner = np.array([s.c for s in supports])
        mine = polygon.corners(inner, CORNER)
        used, outer = sandwich.outer_polygon()
        a, b = polygon.area(inner[mine]), polygon.area(outer)
        gap = max(0.0, (b - a) / b)
        motions = [directions.motion(supports[k].kept) for k in used]
        units = self.data.units
        d, h = np.array([supports[k].d for k in used]), np.array([supports[k].h for k in used])
        # Lines reach the attained points that rounding left outside of them, as the outer polygon's do.
        lines = np.column_stack([d, np.maximum(h, (inner @ d.T).max(axis=0)) * units.length + d @ units.origin[:2]])
        region = self._result(kind, inner[mine], outer, rays, gap, margin, [supports[k].kept for k in mine], motions)
        return replace(region, lines=lines)

    def _empty(self) -> SupportRegion:
        none = np.zeros((0, 2))
        return self._result("empty", none, none, none, 0.0, None, [], [])

    def _result(self, kind: str, inner: Array, outer: Array, rays: Array, gap: float, margin: float | None,
                solutions: list[Solution], motions: list[Motion]) -> SupportRegion:  # fmt: skip
        units = self.data.units
        origin, length = units.origin[:2], units.length
        reach = CLIP * length
        square = (origin[0] - reach, origin[0] + reach, origin[1] - reach, origin[1] + reach)
        return SupportRegion(
            kind=kind,
            inner=origin + length * inner,
            outer=origin + length * outer,
            rays=rays,
            relative_gap=gap,
            solves=self.solves,
            cone=self.cone,
            engine=self.engine.name,
            handovers=self.handovers,
            com_margin=None if margin is None else on_edge_or(margin, 1.0) * length,
            clip=tuple(float(v) for v in square) if kind == "unbounded" else None,  # type: ignore[arg-type]
            size=length,
            frozen=self.data.torques.limited,
            witnesses=SolvedWitnesses(self.data, self.cone, tuple(solutions), inner, tuple(motions)),
        )


def _recession_rays(points: Array) -> Array:
    """Generators of a plane cone from the corners of its part in the unit square; none for the origin alone."""
    far = points[np.abs(points).max(axis=1) > 0.5]
    if not len(far):
        return np.zeros((0, 2))
    angles = np.sort(np.arctan2(far[:, 1], far[:, 0]))
    gaps = np.diff(np.append(angles, angles[0] + 2 * np.pi))
    k = int(np.argmax(gaps))
    if gaps[k] < np.pi - 1e-6:
        return np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
    first, last = angles[(k + 1) % len(angles)], angles[k]
    span = (last - first) % (2 * np.pi)
    at = [first] if span < 1e-6 else [first, first + span]
    between = (angles - first) % (2 * np.pi)
    if span >= np.pi - 1e-6 and ((between > 1e-6) & (between < span - 1e-6)).any():
        # Two opposite rays alone would only generate a line; a strip has no more than that.
        at.insert(1, first + span / 2)
    rays = np.column_stack([np.cos(at), np.sin(at)])
    rays[np.abs(rays) < 1e-9] = 0.0
    return rays
