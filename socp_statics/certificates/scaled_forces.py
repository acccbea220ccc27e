"""From forces in newtons and world axes, as answers and records have them, back to the scaled unknowns of the convex set."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from socp_statics.spatial import Array
from socp_statics.statics.statics_data import StaticsData


def scaled_forces(data: StaticsData, contact: Sequence[str], force_W: Array, moment_W: Array) -> Array:
    """The inverse of `point_forces`.

    Args:
        data: The stance's arrays.
        contact: Name of the contact of each entry, points of a contact in their order, length n.
        force_W: Forces, shape (n, 3) [N].
        moment_W: Moments at the points, shape (n, 3) [N m].

    Returns:
        x, shape (nx,).
    """
    x = np.zeros(data.wrench_map.shape[1])
    order = np.argsort(data.contact_of_point, kind="stable")
    entries = {name: [i for i, c in enumerate(contact) if c == name] for name in data.names}
    taken = dict.fromkeys(data.names, 0)
    soft = data.circular - data.box
    for i in order.tolist():
        k = int(data.contact_of_point[i])
        name = data.names[k]
        entry = entries[name][taken[name]]
        taken[name] += 1
        local = data.rotation[k].T @ force_W[entry] / data.units.force
        x[data.normal.start + i] = local[2]
        if i < data.slipping:
            x[2 * i : 2 * i + 2] = local[:2]
        if soft <= i < data.slipping:
            x[data.torsional.start + i - soft] = data.rotation[k][:, 2] @ moment_W[entry] / (data.units.force * data.units.length)
    for j, (k, i) in enumerate(zip(data.contact_of_handle.tolist(), data.component_of_handle.tolist(), strict=True)):
        (entry,) = entries[data.names[k]]
        vector = force_W[entry] if i < 3 else moment_W[entry] / data.units.length
        x[data.handle.start + j] = data.rotation[k][:, i % 3] @ vector / data.units.force
    return x
