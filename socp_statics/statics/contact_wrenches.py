"""The wrenches of the contacts as arrays, without names."""

from __future__ import annotations

import numpy as np

from socp_statics.spatial import Array, cross
from socp_statics.statics.statics_data import StaticsData


def contact_wrenches(data: StaticsData, x: Array) -> Array:
    """Wrench of each contact about its position, world axes.

    Args:
        data: The stance's arrays.
        x: Scaled unknowns, shape (nx,).

    Returns:
        ``[force; moment]``, shape (contacts, 6) [N, N m].
    """
    soft = data.contact_of_point[data.circular - data.box : data.slipping]
    owner = np.concatenate(
        [np.repeat(data.contact_of_point[: data.slipping], 2), data.contact_of_point, soft, data.contact_of_handle]
    ).astype(int)
    each = (data.wrench_map * x).T
    each[:, 3:] -= cross(data.position[owner], each[:, :3])
    out = np.zeros((len(data.names), 6))
    np.add.at(out, owner, each)
    return out * data.units.wrench
