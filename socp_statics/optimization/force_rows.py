"""The force components that an objective measures, as rows over the unknown x."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from socp_statics.spatial import Array
from socp_statics.statics import StaticsData


class Group(NamedTuple):
    """What is measured together: one contact point, or all that acts at one contact."""

    contact: int
    points: NDArray[np.int_]
    handles: NDArray[np.int_]


def groups(data: StaticsData, level: str) -> list[Group]:
    """Groups of a level.

    Args:
        data: The stance's arrays.
        level: "point" or "contact"; a handle is one group at either level.

    Returns:
        The groups, in the order of the contacts.
    """
    none = np.zeros(0, dtype=int)
    out = []
    for k in range(len(data.names)):
        mine = np.flatnonzero(data.contact_of_point == k)
        held = np.flatnonzero(data.contact_of_handle == k)
        if len(held):
            out.append(Group(k, none, held))
        elif level == "contact":
            out.append(Group(k, mine, none))
        else:
            out += [Group(k, np.array([i]), none) for i in mine]
    return out


def slipping(data: StaticsData, group: Group) -> bool:
    """Whether friction acts at a group."""
    return len(group.points) > 0 and bool((group.points < data.slipping).all())


def normal_row(data: StaticsData, group: Group) -> Array:
    """Normal force of a group, shape (nx,)."""
    row = np.zeros(data.wrench_map.shape[1])
    row[data.normal.start + group.points] = 1.0
    return row


def tangential_rows(data: StaticsData, group: Group) -> Array:
    """Tangential force of a group with friction in its contact frame, shape (2, nx)."""
    rows = np.zeros((2, data.wrench_map.shape[1]))
    for axis in (0, 1):
        rows[axis, 2 * group.points + axis] = 1.0
    return rows


def force_rows(data: StaticsData, group: Group) -> Array:
    """Resultant force of a group in its contact frame, shape (3, nx)."""
    return wrench_rows(data, group, about_position=False)[:3]


def wrench_rows(data: StaticsData, group: Group, *, about_position: bool) -> Array:
    """Wrench of a group in its contact frame, moments about the contact's position or, for a point, about the point.

    Args:
        data: The stance's arrays.
        group: The group.
        about_position: Whether lever arms of the points count.

    Returns:
        Rows over x in scaled units, shape (6, nx).
    """
    rows = np.zeros((6, data.wrench_map.shape[1]))
    rows[2] = normal_row(data, group)
    arms = (data.point[group.points] - data.position[group.contact]) @ data.rotation[group.contact][:, :2]
    for i, (x, y) in zip(group.points, arms if about_position else np.zeros_like(arms), strict=True):
        n = data.normal.start + i
        rows[3, n], rows[4, n] = y, -x
        if i < data.slipping:
            rows[0, 2 * i] = rows[1, 2 * i + 1] = 1.0
            rows[5, 2 * i], rows[5, 2 * i + 1] = -y, x
        if data.circular - data.box <= i < data.slipping:
            rows[5, data.torsional.start + i - (data.circular - data.box)] = 1.0
    for j in group.handles:
        rows[data.component_of_handle[j], data.handle.start + j] = 1.0
    return rows


