"""Support queries of a stance: how far can the centre of mass go in a direction?"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from socp_statics.certificates import Motion, motion_of
from socp_statics.cones.choice import ConeChoice
from socp_statics.engines.engine import Engine
from socp_statics.engines.solution import FAILED, INFEASIBLE, UNBOUNDED, Solution
from socp_statics.exceptions import EngineError
from socp_statics.models.contact_forces_set import force_shape, force_values
from socp_statics.models.support_region import MODEL, RegionShape
from socp_statics.regions.sandwich import Support
from socp_statics.spatial import Array
from socp_statics.statics.statics_data import StaticsData
from socp_statics.statics.wrench_range import OUTSIDE, SINGULAR, wrench_range


class UnboundedDirection(Exception):
    """The centre of mass can go without end in a direction; only ever seen by the tracer."""


class EmptyRegion(Exception):
    """No position of the centre of mass is in balance; only ever seen by the tracer."""


@dataclass(frozen=True, eq=False)
class CoMPlane:
    """The horizontal CoM positions that the range of the wrench map leaves free: ``c = origin + axes s``.

    Attributes:
        origin: Relative to the centre of the contacts, scaled, shape (2,).
        axes: Orthonormal columns, shape (2, k), k = 0, 1 or 2.
        basis: Orthonormal rows of the balance that are kept, shape (6, r).
        twist: Where no position is in reach, the scaled motion that shows it; else None.
    """

    origin: Array
    axes: Array
    basis: Array
    twist: Array | None


def load_at(data: StaticsData, position: Array) -> Array:
    """The load with the centre of mass at another horizontal position, relative to the centre of the contacts, shape (6,)."""
    return data.load + data.com_load @ (position - data.com[:2])


def plane_values(data: StaticsData, plane: CoMPlane, cone: ConeChoice) -> dict[str, Array]:
    """Numbers of any program over the free coordinates: the set of forces, the load at their origin, and D."""
    return force_values(data, cone, plane.basis) | {
        "load": plane.basis.T @ load_at(data, plane.origin),
        "D": plane.basis.T @ data.com_load @ plane.axes,
    }


def com_plane(data: StaticsData) -> CoMPlane:
    """Free coordinates of the centre of mass.

    Args:
        data: The stance's arrays; only the height of its centre of mass matters.

    Returns:
        The affine set of positions for which the load is in the range of G.
    """
    load = load_at(data, np.zeros(2))
    reach = wrench_range(data.wrench_map)
    rows, misses = reach.null.T @ data.com_load, reach.null.T @ load
    U, s, Vt = np.linalg.svd(rows) if reach.rank < 6 else (np.zeros((0, 0)), np.zeros(0), np.eye(2))
    q = int((s > SINGULAR).sum())
    origin = -Vt[:q].T @ ((U[:, :q].T @ misses) / s[:q])
    left = U[:, q:].T @ misses
    twist = reach.null @ (U[:, q:] @ left) if np.linalg.norm(left) > OUTSIDE else None
    axes = np.eye(2) if q == 0 else Vt[q:].T
    return CoMPlane(origin, axes, reach.basis, twist)


class Directions:
    """Support queries in one session of an engine.

    Args:
        data: The stance's arrays.
        plane: Free coordinates of the centre of mass, k >= 1.
        cone: Exact cones or pyramids.
        form: "socp" or "sdp".
        engine: The engine.
        clip: Half-side of a square about the centre of the contacts that clips the region, or None.
    """

    def __init__(self, data: StaticsData, plane: CoMPlane, cone: ConeChoice, form: str, engine: Engine, clip: float | None = None):
        shape = RegionShape(force_shape(data, cone, form, plane.basis.shape[1]), plane.axes.shape[1], clip is not None)
        values = plane_values(data, plane, cone) | {
            "direction": np.eye(shape.coordinates)[0],
            "box": np.full(shape.coordinates, clip or 0.0),
        }
        self._session = engine.compile(MODEL, shape).session(values)
        self._data, self._plane = data, plane
        self.engine = engine.name
        self.queries = 0

    def solve(self, direction: tuple[float, ...]) -> Solution:
        """One query in the free coordinates; solved, infeasible or unbounded.

        Raises:
            EngineError: The engine did not settle it.
        """
        self.queries += 1
        solution = self._session.solve(direction=direction)
        if solution.status == FAILED:
            raise EngineError(f"engine {self.engine} did not settle a support direction: {solution.detail}", name=self.engine)
        return solution

    def support(self, direction: tuple[float, float]) -> Support:
        """One query of a region with two free coordinates, as the sandwich asks it.

        Raises:
            UnboundedDirection: There is no end in this direction.
            EmptyRegion: There is no position at all.
            EngineError: The engine did not settle it.
        """
        solution = self.solve(direction)
        if solution.status == UNBOUNDED:
            raise UnboundedDirection
        if solution.status == INFEASIBLE:
            raise EmptyRegion
        x, y = solution.variable("s")
        return Support(direction, (x, y), max(direction[0] * x + direction[1] * y, solution.bound), solution)

    def position(self, s: Array) -> Array:
        """Free coordinates as a position relative to the centre of the contacts, scaled."""
        return self._plane.origin + self._plane.axes @ s

    def motion(self, solution: Solution) -> Motion:
        """Scaled motion whose power certifies a query's bound."""
        return motion_of(self._data, self._plane.basis @ solution.duals["balance"], solution.duals.get("limits"))


def recession(data: StaticsData) -> StaticsData:
    """The set of directions in which the region and its forces can grow without end: no load, no finite bound."""
    bounds = np.where(np.isfinite(data.bounds), 0.0, data.bounds)
    return replace(data, load=np.zeros(6), com=np.zeros(3), bounds=bounds, limit_values=np.zeros_like(data.limit_values))




def widened(data: StaticsData, reserve: float) -> tuple[StaticsData, Array]:
    """The set with every cone and bound widened by a reserve of normal force, in shifted unknowns ``z = x + reserve n``.

    Args:
        data: The stance's arrays.
        reserve: How much normal force every point may lack, scaled.

    Returns:
        The widened set, and what to add to z to get the forces x.
    """
    shift = np.zeros(data.wrench_map.shape[1])
    shift[data.normal] = -reserve
    counts = np.array([(data.contact_of_point == k).sum() for k in data.bounded], dtype=float).reshape(-1, 1)
    equal = data.bounds[:, :1] == data.bounds[:, 1:]
    ends = data.bounds + np.where(equal, 0.0, np.array([[-reserve, reserve]])) + counts * reserve
    wide = replace(data, load=data.load + data.wrench_map @ shift, bounds=ends, limit_values=data.limit_values - data.limit_rows @ shift)
    return wide, shift
