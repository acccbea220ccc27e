"""What a traced region rests on: forces at its inner corners and motions at its outer edges, made when somebody looks at them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from socp_statics.certificates import Motion
from socp_statics.certificates.bracing import least_braced
from socp_statics.cones.choice import ConeChoice
from socp_statics.contacts import Stance
from socp_statics.engines.solution import Solution
from socp_statics.regions.directions import load_at
from socp_statics.spatial import Array
from socp_statics.statics import PointForces, StaticsData, assemble, point_forces
from socp_statics.statics.point_forces import many_point_forces


class Witnesses(Protocol):
    """Forces and motions behind the corners and edges of a region."""

    @property
    def data(self) -> StaticsData:
        """The arrays of the stance."""
        ...

    def forces(self) -> tuple[PointForces, ...]:
        """Balancing forces for each inner corner."""
        ...

    def motions(self) -> tuple[tuple[Array, Array], ...]:
        """(linear, angular) about the mean contact point for each outer edge [m/s, rad/s]."""
        ...

    def joint_rates(self) -> Array:
        """Rates of all joints in the motion of each outer edge, zero where a joint has no limit, shape (l, n) [rad/s]."""
        ...


@dataclass(frozen=True, eq=False)
class SolvedWitnesses:
    """Of solutions, one a support direction.

    Attributes:
        data: The stance's arrays.
        cone: Exact cones or pyramids.
        solutions: One for each inner corner.
        corners: Inner corners relative to the centre of the contacts, scaled, shape (k, 2).
        edges: Motion of each outer edge.
        shift: Added to the unknowns of solutions with widened cones.
    """

    data: StaticsData
    cone: ConeChoice
    solutions: tuple[Solution, ...]
    corners: Array
    edges: tuple[Motion, ...]
    shift: Array | float = 0.0

    def forces(self) -> tuple[PointForces, ...]:
        """Balancing forces for each inner corner."""
        loaded = (replace(self.data, load=load_at(self.data, c)) for c in self.corners)
        found = (s.variables["x"] + self.shift for s in self.solutions)
        return tuple(point_forces(self.data, least_braced(data, self.cone, x)) for data, x in zip(loaded, found, strict=True))

    def motions(self) -> tuple[tuple[Array, Array], ...]:
        """(linear, angular) about the mean contact point for each outer edge [m/s, rad/s]."""
        return tuple(self.data.units.twist_in_si(edge.twist) for edge in self.edges)

    def joint_rates(self) -> Array:
        """Rates of all joints in the motion of each outer edge, shape (l, n) [rad/s]."""
        return np.array([edge.joints for edge in self.edges]).reshape(len(self.edges), -1) / self.data.units.length


class TracedWitnesses:
    """Of the compiled tracer: multipliers of the cones and motions, as it leaves them.

    Args:
        stance: Makes the stance that was traced.
        cone: Exact cones or pyramids.
        multipliers: Three numbers a row of the compiled program, all rows of a corner one after the other, shape (k * rows, 3).
        motions: Scaled, shape (l, 6).
    """

    def __init__(self, stance: Callable[[], Stance], cone: ConeChoice, multipliers: Array, motions: Array):
        self._stance, self._cone, self._multipliers, self._motions = stance, cone, multipliers, motions

    @cached_property
    def data(self) -> StaticsData:
        """The arrays of the stance."""
        return assemble(self._stance())

    def forces(self) -> tuple[PointForces, ...]:
        """Balancing forces for each inner corner."""
        from socp_statics.engines.kernel.pyramids import cone_rows, unknowns

        points = self._stance().contacts.friction_points
        assert points is not None
        each = self._multipliers.reshape(-1, 3 * len(cone_rows(points, self._cone)))
        return many_point_forces(self.data, unknowns(points, self._cone, each))

    def motions(self) -> tuple[tuple[Array, Array], ...]:
        """(linear, angular) about the mean contact point for each outer edge [m/s, rad/s]."""
        linear, angular = self._motions[:, :3], self._motions[:, 3:] / self.data.units.length
        return tuple(zip(linear, angular, strict=True))

    def joint_rates(self) -> Array:
        """No joint matters, shape (l, 0)."""
        return np.zeros((len(self._motions), 0))


class LimitedWitnesses:
    """Of the compiled tracer of stances with limits.

    Args:
        stance: The stance that was traced.
        unknowns: Forces at each inner corner, shape (k, nx).
        multipliers: Of each outer edge: velocity (3), rate of turning about the direction of gravity, rates of the limited joints, of
            bounded contacts; at the end, unit normal (2) and offset. Scaled.
        lift: The two rates of turning that a unit normal asks for, shape (2, 3), then the direction of gravity.
        joints: Indices of the limited joints.
    """

    def __init__(self, stance: Stance, unknowns: Array, multipliers: Array, lift: Array, joints: NDArray[np.int_]):
        self._stance, self._unknowns, self._multipliers, self._lift, self._joints = stance, unknowns, multipliers, lift, joints

    @cached_property
    def data(self) -> StaticsData:
        """The arrays of the stance."""
        return assemble(self._stance)

    def forces(self) -> tuple[PointForces, ...]:
        """Balancing forces for each inner corner."""
        return many_point_forces(self.data, self._unknowns)

    def motions(self) -> tuple[tuple[Array, Array], ...]:
        """(linear, angular) about the mean contact point for each outer edge [m/s, rad/s]."""
        turning = self._multipliers[:, -3:-1] @ self._lift[:2] + self._multipliers[:, 3:4] * self._lift[2]
        return tuple(self.data.units.twist_in_si(t) for t in np.hstack([self._multipliers[:, :3], turning]))

    def joint_rates(self) -> Array:
        """Rates of all joints in the motion of each outer edge, zero where a joint has no limit, shape (l, n) [rad/s]."""
        rates = np.zeros((len(self._multipliers), len(self.data.torques.names)))
        rates[:, self._joints] = self._multipliers[:, 4 : 4 + len(self._joints)] / self.data.units.length
        return rates
