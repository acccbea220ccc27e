"""The points of a contact set as one array, where nothing but friction and unilaterality limits their forces."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from socp_statics.contacts.contact import Contact, Handle, SoftFingerContact
from socp_statics.spatial import Array


def friction_points(contacts: Sequence[Contact]) -> Array | None:
    """Contact points, one a row, those with friction first: the order of the unknown forces in `statics.StaticsData`.

    Args:
        contacts: The contacts.

    Returns:
        Shape (n, 14): position (3) [m], t1, t2 and normal (9), friction, and 1, the share that its margin has in the point's;
        None where a contact is bounded, a handle or a soft finger.
    """
    rows: tuple[list[tuple[float, ...]], list[tuple[float, ...]]] = ([], [])
    # Python's floats are faster than small arrays, and every batch goes through here.
    for contact in contacts:
        if contact.normal_force is not None or isinstance(contact, Handle | SoftFingerContact):
            return None
        (a, b, n), (d, e, o), (g, h, p) = contact.rotation.tolist()
        x, y, z = contact.position.tolist()
        mu = contact.friction
        mine = rows[mu == 0.0]
        for u, v in contact.points_C.tolist():
            mine.append((x + a * u + b * v, y + d * u + e * v, z + g * u + h * v, a, d, g, b, e, h, n, o, p, mu, 1.0))
    return np.array(rows[0] + rows[1])
