"""The contact forces of an answer, in newtons and world axes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from socp_statics.spatial import Array, cross
from socp_statics.statics.statics_data import StaticsData


@dataclass(frozen=True, eq=False)
class PointForces:
    """Reactions of the environment on the robot at the contact points.

    Attributes:
        contact: Name of the contact of each entry, length n.
        point_W: Where it acts, shape (n, 3) [m].
        force_W: Force, shape (n, 3) [N].
        moment_W: Moment at the point (soft fingers and handles), shape (n, 3) [N m].
        moment_carrying: Which entries can carry a moment, shape (n,).
        position_W: Position of each contact by name [m].
    """

    contact: tuple[str, ...]
    point_W: Array
    force_W: Array
    moment_W: Array
    moment_carrying: Array
    position_W: dict[str, Array]

    def entries(self) -> list[dict[str, Any]]:
        """Records of the forces, one a point: contact, point, force and, where it can be carried, moment."""
        out: list[dict[str, Any]] = [
            {"contact": name, "point": point, "force": force}
            for name, point, force in zip(self.contact, self.point_W.tolist(), self.force_W.tolist(), strict=True)
        ]
        for i in np.flatnonzero(self.moment_carrying):
            out[i]["moment"] = self.moment_W[i].tolist()
        return out

    def wrenches(self) -> list[dict[str, Any]]:
        """Records of the contact wrenches, moments about each contact's position."""
        out = []
        for name, position in self.position_W.items():
            mine = np.array([c == name for c in self.contact])
            force = self.force_W[mine].sum(axis=0)
            moment = (cross(self.point_W[mine] - position, self.force_W[mine]) + self.moment_W[mine]).sum(axis=0)
            out.append({"contact": name, "force": force.tolist(), "moment": moment.tolist()})
        return out


def point_forces(data: StaticsData, x: Array) -> PointForces:
    """The forces behind a point of the convex set.

    Args:
        data: The set.
        x: Scaled unknowns, shape (nx,).

    Returns:
        Forces in SI and world axes, in the order of the contacts.
    """
    return many_point_forces(data, x[None])[0]


def many_point_forces(data: StaticsData, x: Array) -> tuple[PointForces, ...]:
    """The forces behind several points of the convex set.

    Args:
        data: The set.
        x: Scaled unknowns, shape (k, nx).

    Returns:
        Of each point, forces in SI and world axes, in the order of the contacts.
    """
    units, batch = data.units, len(x)
    local = np.zeros((batch, data.points, 3))
    local[:, : data.slipping, :2] = x[:, data.tangential].reshape(batch, -1, 2)
    local[:, :, 2] = x[:, data.normal]
    R = data.rotation[data.contact_of_point]
    force = np.einsum("nij,knj->kni", R, local)
    moment = np.zeros_like(force)
    soft = slice(data.circular - data.box, data.slipping)
    moment[:, soft] = R[soft, :, 2] * x[:, data.torsional][:, :, None]
    carries = np.zeros(data.points, dtype=bool)
    carries[soft] = True

    grips = sorted(set(data.contact_of_handle.tolist()))
    grip_force, grip_moment = np.zeros((batch, len(grips), 3)), np.zeros((batch, len(grips), 3))
    for value, k, i in zip(x[:, data.handle].T, data.contact_of_handle, data.component_of_handle, strict=True):
        target = grip_force if i < 3 else grip_moment
        target[:, grips.index(k)] += value[:, None] * data.rotation[k, :, i % 3]

    owner = np.concatenate([data.contact_of_point, np.array(grips, dtype=int)])
    order = np.argsort(owner, kind="stable")
    origin, length, W = units.origin, units.length, units.force
    points = origin + length * np.concatenate([data.point, data.position[grips].reshape(-1, 3)])[order]
    forces = W * np.concatenate([force, grip_force], axis=1)[:, order]
    moments = W * length * np.concatenate([moment, grip_moment], axis=1)[:, order]
    names = tuple(data.names[k] for k in owner[order])
    carrying = np.concatenate([carries, np.ones(len(grips), dtype=bool)])[order]
    places = {name: origin + length * data.position[k] for k, name in enumerate(data.names)}
    return tuple(PointForces(names, points, forces[k], moments[k], carrying, places) for k in range(batch))
