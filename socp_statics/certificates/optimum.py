"""A settled program over the set of contact forces: its forces, its multipliers, and what they say together."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from socp_statics.cones.choice import ConeChoice
from socp_statics.models.contact_forces_set import bound_rows
from socp_statics.spatial import Array
from socp_statics.statics.joint_torques import joint_rates
from socp_statics.statics.statics_data import StaticsData


@dataclass(frozen=True, eq=False)
class Multipliers:
    """Multipliers of a program, scaled; every one but those of equalities is >= 0.

    Attributes:
        twist: Of the balance: a motion of the robot, shape (6,).
        lower: Of ``lo <= N`` where the bounds of a contact differ, shape (nl,).
        upper: Of ``N <= hi`` where it is finite, shape (nu,).
        equal: Of ``N = given``, shape (ne,).
        limits: Of the hard rows, handle limits first, shape (nh,).
    """

    twist: Array
    lower: Array
    upper: Array
    equal: Array
    limits: Array

    @classmethod
    def read(cls, data: StaticsData, twist: Array, duals: Mapping[str, Array]) -> Multipliers:
        """The multipliers of a solution by the names of `models.contact_forces_set`.

        Args:
            data: The stance's arrays.
            twist: Multipliers of the balance about the origin, shape (6,).
            duals: The others by constraint name; those that a program leaves out are zero.
        """
        rows = bound_rows(data)
        bounds = {"lower_bound": rows.lower, "upper_bound": rows.upper, "equal_bound": rows.equal, "limits": data.limit_values}
        lower, upper, equal, limits = (np.array(duals.get(name, np.zeros(len(row)))).ravel() for name, row in bounds.items())
        for a, b in closed_limits(data):
            limits[[a, b]] -= min(limits[a], limits[b])
        return cls(twist, lower, upper, equal, limits)

    @property
    def packed(self) -> Array:
        """All in one vector."""
        return np.concatenate([self.twist, self.lower, self.upper, self.equal, self.limits])

    def like(self, packed: Array) -> Multipliers:
        """A vector of the same layout as multipliers."""
        ends = np.cumsum([6, len(self.lower), len(self.upper), len(self.equal)])
        return Multipliers(*np.split(packed, ends))


def closed_limits(data: StaticsData) -> list[tuple[int, int]]:
    """Pairs of hard rows whose limits leave no room between them; of their multipliers only the difference means anything.

    Args:
        data: The stance's arrays.

    Returns:
        Indices of the rows of the upper and the lower end.
    """
    n = data.handle_limits
    names, values = data.limit_names, data.limit_values
    pairs = [(i, i + 1) for i in range(n - 1) if names[i] == names[i + 1] and values[i] + values[i + 1] == 0.0]
    finite = np.isfinite(data.torques.limits)
    upper, lower = np.flatnonzero(finite[:, 1]), np.flatnonzero(finite[:, 0])
    for k in np.flatnonzero(finite.all(axis=1) & (data.torques.limits[:, 0] == data.torques.limits[:, 1])) if data.torques.limited else ():
        pairs.append((n + int(np.searchsorted(upper, k)), n + len(upper) + int(np.searchsorted(lower, k))))
    return pairs


@dataclass(frozen=True, eq=False)
class Optimum:
    """An optimal point of ``max c'e`` over the set of forces, with further unknowns e.

    The balance is ``G x + E e + L = 0``, cones and bounds are shifted by the reserve ``t = s'e`` of normal force, hard rows are
    ``H x <= d + R e``.

    Attributes:
        data: The stance's arrays, L and d included.
        cone: Exact cones or pyramids.
        x: Optimal forces, scaled, shape (nx,).
        reserve: t at the optimum, 0 where the program has none.
        multipliers: Optimal multipliers.
        columns: E, shape (6, k).
        shares: s, how much each further unknown shifts the cones, shape (k,).
        relief: R, shape (nh, k).
        value: Optimal value, scaled.
        coned: False where the program leaves cones and bounds out.
        pinned: Whether forces count as optimal only together with the e they come with.
    """

    data: StaticsData
    cone: ConeChoice
    x: Array
    reserve: float
    multipliers: Multipliers
    columns: Array
    shares: Array
    relief: Array
    value: float
    coned: bool = True
    pinned: bool = False

    @cached_property
    def contact_multipliers(self) -> Array:
        """Multiplier of every component of x: the velocity of its contact point less what bounds hold back, shape (nx,)."""
        return self.contact_map @ self.multipliers.packed

    @cached_property
    def contact_map(self) -> Array:
        """`contact_multipliers` as a linear map of the packed multipliers."""
        data, rows = self.data, bound_rows(self.data)
        bounds = np.zeros((len(self.x), len(rows.lower) + len(rows.upper) + len(rows.equal)))
        bounds[data.normal] = np.vstack([-rows.lower, rows.upper, rows.equal]).T
        return np.hstack([data.wrench_map.T, bounds, data.limit_rows.T])

    def angular_velocities(self, multipliers: Multipliers) -> Array:
        """Scaled angular velocity of the link at each contact, world axes, shape (contacts, 3)."""
        torques = self.data.torques
        turning = np.broadcast_to(multipliers.twist[3:], (len(self.data.names), 3))
        if not torques.limited:
            return turning
        return turning + torques.jacobian[:, 3:] @ joint_rates(torques, multipliers.limits[self.data.handle_limits :])

    def resultants(self, x: Array) -> Array:
        """Force of each contact in world axes, shape (contacts, 3)."""
        data = self.data
        local = np.zeros((data.points, 3))
        local[: data.slipping, :2] = x[data.tangential].reshape(-1, 2)
        local[:, 2] = x[data.normal]
        total = np.zeros((len(data.names), 3))
        np.add.at(total, data.contact_of_point, np.einsum("nij,nj->ni", data.rotation[data.contact_of_point], local))
        forces = np.flatnonzero(data.component_of_handle < 3)
        owner = data.contact_of_handle[forces]
        np.add.at(total, owner, data.rotation[owner, :, data.component_of_handle[forces]] * x[data.handle][forces, None])
        return total
