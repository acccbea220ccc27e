"""The robot as one body at rest: its inertia, and what an acceleration of it does at every contact."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from socp_statics.contacts import Stance
from socp_statics.exceptions import InputError
from socp_statics.spatial import Array, skew
from socp_statics.statics import StaticsData


@dataclass(frozen=True, eq=False)
class OneBody:
    """Equation of motion ``M a = L + G x`` of a body at rest, in the units of its stance.

    The acceleration ``a = [dv; dw]`` is that of the body's point at the origin of the units; one unit of dv is W / mass, the fall under
    the load. There are no velocities, hence no other terms.

    Attributes:
        data: The convex set of the stance.
        inertia: M about the origin, shape (6, 6).
        acceleration: What one unit of linear acceleration is [m/s^2].
    """

    data: StaticsData
    inertia: Array
    acceleration: float

    @cached_property
    def point_rows(self) -> Array:
        """Acceleration of each unilateral point along its t1, t2, n due to a, shape (points, 3, 6)."""
        R, p = self.data.rotation[self.data.contact_of_point], self.data.point
        axes = np.swapaxes(R, 1, 2)
        return np.concatenate([axes, -axes @ np.array([skew(one) for one in p]).reshape(-1, 3, 3)], axis=2)

    @cached_property
    def handle_rows(self) -> Array:
        """Acceleration along each handle component due to a, shape (nh, 6)."""
        rows: Array = self.data.wrench_map[:, self.data.handle].T
        return rows

    @cached_property
    def normal_bounds(self) -> dict[int, tuple[float, float]]:
        """Bounds of the resultant normal force by index of the contact, without those that bound nothing."""
        pairs = zip(self.data.bounded.tolist(), self.data.bounds.tolist(), strict=True)
        return {k: (lo, hi) for k, (lo, hi) in pairs if lo > 0.0 or np.isfinite(hi)}

    @cached_property
    def handle_bounds(self) -> Array:
        """Lower and upper limit of each handle component, shape (nh, 2)."""
        columns = np.arange(self.data.wrench_map.shape[1])[self.data.handle]
        bounds = np.tile([-np.inf, np.inf], (len(columns), 1))
        rows = self.data.limit_rows[: self.data.handle_limits]
        for row, value in zip(rows[:, columns], self.data.limit_values, strict=False):
            (j,) = np.flatnonzero(row)
            bounds[j, 1 if row[j] > 0.0 else 0] = row[j] * value
        return bounds

    def length(self, rows: Array) -> Array:
        """Norm of rows in the metric of the inverse inertia, a bound of ``|J a|`` where ``|a|_M`` is one, shape (..., 6) -> (...)."""
        solved = np.linalg.solve(self.inertia, np.asarray(rows)[..., None])[..., 0]
        return np.sqrt(np.maximum((rows * solved).sum(axis=-1), 0.0))

    @cached_property
    def fastest(self) -> float:
        """Bound of ``|a|_M`` over all contact forces that contacts can exert while they obey (3.8) and (3.10).

        Friction and unilateral contacts never do positive work on a body that starts to move, so ``a' M a <= a' L`` and what forces with
        a lower bound add.
        """
        pushed = 0.0
        for k, (lo, _) in self.normal_bounds.items():
            pushed += lo * float(self.length(self.point_rows[self.data.contact_of_point == k, 2]).max())
        for row, (lo, hi) in zip(self.handle_rows, self.handle_bounds, strict=True):
            pushed += max(lo, -hi, 0.0) * float(self.length(row))
        return float(self.length(self.data.load)) + pushed

    def point_map(self, i: int) -> Array:
        """Wrench of the force (t1, t2, n) of one point, zero columns where there is no friction, shape (6, 3)."""
        data, columns = self.data, np.zeros((6, 3))
        columns[:, 2] = data.wrench_map[:, data.normal.start + i]
        if i < data.slipping:
            columns[:, :2] = data.wrench_map[:, 2 * i : 2 * i + 2]
        return columns

    def put_force(self, x: Array, i: int, force_C: Array) -> None:
        """Write the force (t1, t2, n) of one point into x."""
        x[self.data.normal.start + i] = force_C[2]
        if i < self.data.slipping:
            x[2 * i : 2 * i + 2] = force_C[:2]

    def gives(self, give: dict[int, float]) -> Array:
        """What the surfaces of bounded contacts give way along their normals at each point, shape (points,)."""
        return np.array([give.get(int(k), 0.0) for k in self.data.contact_of_point])

    def imbalance(self, a: Array, x: Array) -> Array:
        """``M a - L - G x``, shape (6,)."""
        out: Array = self.inertia @ a - self.data.load - self.data.wrench_map @ x
        return out

    def power(self, a: Array, x: Array, give: dict[int, float]) -> float:
        """Power of the load, and of what bounded forces do on surfaces that give way; it is ``a' M a`` and what friction takes.

        Args:
            a: Acceleration, shape (6,).
            x: Forces, shape (nx,).
            give: Acceleration of the surfaces of bounded contacts by index.
        """
        normal = float(x[self.data.normal] @ self.gives(give))
        return float(a @ self.data.load) + normal + float(x[self.data.handle] @ (self.handle_rows @ a))

    def in_si(self, a: Array) -> tuple[Array, Array]:
        """Acceleration of the centre of mass and angular acceleration.

        Args:
            a: Scaled, shape (6,).

        Returns:
            Shapes (3,) [m/s^2] and (3,) [rad/s^2], world axes.
        """
        linear = a[:3] + np.cross(a[3:], self.data.com)
        return self.acceleration * linear, self.acceleration / self.data.units.length * a[3:]


def one_body(stance: Stance, data: StaticsData) -> OneBody:
    """The robot of a stance as one body.

    Args:
        stance: The stance, with its inertia or with a robot's posture, whose joints are taken as locked.
        data: Its arrays.

    Raises:
        InputError: Neither an inertia nor a robot is given.
    """
    inertia = stance.inertia
    if inertia is None and stance.posture is not None:
        inertia = stance.posture.inertia_W
    if inertia is None:
        message = (
            "stance 'posture': inertia is missing, whether every contact force keeps the robot at rest depends on it here: "
            "a symmetric positive definite 3 x 3 matrix about the centre of mass is expected [kg m^2]"
        )
        raise InputError(message, name="posture", field="inertia")
    S = skew(data.com)
    M = np.eye(6)
    M[:3, 3:], M[3:, :3] = -S, S
    M[3:, 3:] = np.asarray(inertia) / (stance.mass * data.units.length**2) - S @ S
    return OneBody(data, M, data.units.force / stance.mass)
