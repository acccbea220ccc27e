"""The support region: every horizontal CoM position in balance, between an inner and an outer polygon."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.cones.choice import ConeChoice
from socp_statics.regions import polygon as polygons
from socp_statics.regions.witnesses import Witnesses
from socp_statics.spatial import Array
from socp_statics.statics import PointForces

POLYGON: dict[str, Any] = {
    "kind": "polygon", "rays": np.zeros((0, 2)), "engine": "kernel", "handovers": 0, "clip": None, "widened": 0.0,
}  # fmt: skip


@dataclass(frozen=True, eq=False)
class SupportRegion:
    """Horizontal section of the CoM positions in balance, at one height.

    Attributes:
        kind: "polygon", "segment", "point", "empty" or "unbounded".
        inner: Attained positions, counter-clockwise corners, shape (k, 2) [m].
        outer: Corners of a polygon that contains the region, counter-clockwise, shape (l, 2) [m].
        rays: Generators of the recession cone where the region has no end, shape (r, 2), unit vectors; the polygons are then
            clipped to a square of half-side 10 times the size about the mean contact point.
        relative_gap: (outer - inner) / outer area; of a segment, of its length.
        solves: Number of conic programs.
        cone: Exact cones or pyramids.
        engine: Name of the engine that answered.
        handovers: How many engines did not settle before; the compiled programs of the kernel and its general method are one engine.
        com_margin: Of the stance's own centre of mass: distance to the edge, minus the distance outside [m]; inf where the
            region is the whole plane; None where the region is empty or no centre of mass was given.
        clip: The clipping square ``(x_min, x_max, y_min, y_max)`` [m], or None.
        size: Largest distance between contact points [m].
        frozen: Whether joint-torque limits count, for the posture as it is while the centre of mass moves.
        witnesses: Forces and motions behind corners and edges.
        widened: By how much normal force a point every cone was widened, where the set of forces has no interior; else 0 [N].
        lines: Unit normal and offset [m] of the supporting line behind each outer edge, shape (l, 3); None unless it is a polygon.
    """

    kind: str
    inner: Array
    outer: Array
    rays: Array
    relative_gap: float
    solves: int
    cone: ConeChoice
    engine: str
    handovers: int
    com_margin: float | None
    clip: tuple[float, float, float, float] | None
    size: float
    frozen: bool
    witnesses: Witnesses = field(repr=False)
    widened: float = 0.0
    lines: Array | None = None

    @classmethod
    def polygon(
        cls, inner: Array, outer: Array, lines: Array, witnesses: Witnesses, cone: ConeChoice, relative_gap: float, solves: int,
        com_margin: float | None, size: float, inner_area: float, outer_area: float, frozen: bool = False,
    ) -> Self:  # fmt: skip
        """A polygon as the kernel's compiled tracer finds it; one is made in less than a microsecond, where a trace takes a few dozen."""
        region = object.__new__(cls)
        own = region.__dict__
        own.update(POLYGON)
        own["inner"], own["outer"], own["lines"] = inner, outer, lines
        own["witnesses"], own["cone"], own["relative_gap"], own["solves"] = witnesses, cone, relative_gap, solves
        own["com_margin"], own["size"], own["frozen"] = com_margin, size, frozen
        own["inner_area"], own["outer_area"] = inner_area, outer_area
        return region

    @cached_property
    def inner_area(self) -> float:
        """Area of the inner polygon, 0 unless it is one [m^2]."""
        return max(polygons.area(self.inner), 0.0) if self.kind in ("polygon", "unbounded") else 0.0

    @cached_property
    def outer_area(self) -> float:
        """Area of the outer polygon, 0 unless it is one [m^2]."""
        return max(polygons.area(self.outer), 0.0) if self.kind in ("polygon", "unbounded") else 0.0

    @cached_property
    def inner_forces(self) -> tuple[PointForces, ...]:
        """Balancing forces inside the cones for each inner corner."""
        return self.witnesses.forces()

    @cached_property
    def outer_multipliers(self) -> tuple[tuple[Array, Array], ...]:
        """For each outer edge (from a corner to the next) the motion that rules out everything beyond it.

        Pairs (linear, angular) [m/s, rad/s] about the mean contact point, world axes: no admissible force prevents the motion
        for a centre of mass beyond the edge. Edges of the clipping square have zeros.
        """
        return self.witnesses.motions()

    @cached_property
    def outer_joint_rates(self) -> tuple[dict[str, float], ...]:
        """For each outer edge the rates of the joints that move with its motion, where torque limits count [rad/s]."""
        names = self.witnesses.data.torques.names
        return tuple({names[k]: float(row[k]) for k in np.flatnonzero(row)} for row in self.witnesses.joint_rates())

    @cached_property
    def halfplanes(self) -> tuple[Array, Array]:
        """Half-planes ``A x <= b`` of the outer polygon, unit rows, shapes (l, 2) and (l,) [m].

        A segment or point has the half-planes of its ends and sides; an empty region one that nothing satisfies.
        """
        if self.kind == "empty":
            return np.array([[0.0, 0.0]]), np.array([-1.0])
        if self.lines is not None:
            return self.lines[:, :2], self.lines[:, 2]
        if self.kind == "unbounded":
            return polygons.halfplanes(self.outer)
        a, b = self.outer[0], self.outer[-1]
        along = (b - a) / np.linalg.norm(b - a) if self.kind == "segment" else np.array([1.0, 0.0])
        across = np.array([-along[1], along[0]])
        A = np.array([along, across, -along, -across])
        return A, np.array([along @ b, across @ a, -along @ a, -across @ a])

    def contains(self, xy: ArrayLike) -> Any:
        """Whether positions are attained: inside or on the inner polygon (1e-12 of the size forgiven).

        Args:
            xy: Positions, shape (..., 2) [m].

        Returns:
            Booleans, shape (...).
        """
        return self.margin(xy) >= -1e-12 * self.size

    def margin(self, xy: ArrayLike) -> Any:
        """Distance of positions to the edge of the inner polygon, minus the distance outside.

        Args:
            xy: Positions, shape (..., 2) [m].

        Returns:
            Shape (...) [m]; -inf for an empty region.
        """
        points = np.asarray(xy, dtype=float)
        if self.kind == "empty" or not len(self.inner):
            return np.full(points.shape[:-1], -np.inf)
        return polygons.distance(self.inner, points)

    def as_record(self) -> dict[str, Any]:
        """The record's entry; arrays where it has lists of numbers."""
        forces, multipliers = self.inner_forces, self.outer_multipliers
        acting = list(zip(forces[0].contact, forces[0].point_W.tolist(), strict=True)) if forces else []
        notes = ({"posture": "frozen"} if self.frozen else {}) | ({"widened": self.widened} if self.widened else {})
        return notes | {
            "kind": self.kind,
            "inner": self.inner,
            "outer": self.outer,
            "inner_area": self.inner_area,
            "outer_area": self.outer_area,
            "relative_gap": self.relative_gap,
            "rays": self.rays,
            "solves": self.solves,
            "points": [{"contact": contact, "point": point} for contact, point in acting],
            "inner_forces": np.array([_components(f) for f in forces]),
            "outer_multipliers": np.array(multipliers).reshape(-1, 6),
            **({"outer_joint_rates": list(self.outer_joint_rates)} if self.frozen else {}),
        }


def _components(forces: PointForces) -> Array:
    """Forces of all points, shape (n, 3), with their moments, (n, 6), where any point can carry one."""
    return np.hstack([forces.force_W, forces.moment_W]) if forces.moment_carrying.any() else forces.force_W
