"""Where the load of a stance acts: the line of its net force, seen along that force as a point p among the contacts.

On that line the load has no moment but one about the vertical, so that it meets a level floor in the centre of pressure; for gravity alone
that is the ground projection of the centre of mass. All points are taken in the plane across the load, in which the lever
rule and its kin are stated; the reference frame of that plane does not matter to them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from socp_statics.exceptions import InputError
from socp_statics.spatial import Array, cross

NOTHING = 1e-12
# A force this far from the vertical has its line found by itself.
ACROSS = 0.05


class LoadLine(NamedTuple):
    """Points in the plane across the load, for one stance or a batch.

    Attributes:
        point: p, shape (..., 2) [m].
        contacts: The contacts' positions, shape (..., k, 2) [m].
    """

    point: Array
    contacts: Array


def load_line(wrench: Array, positions: Array, up: Array | None = None) -> LoadLine:
    """The line of a load among the contacts.

    Args:
        wrench: Force and moment of the load about the point that positions are relative to, shape (..., 6) [N, N m].
        positions: Of the contacts, shape (..., k, 3) [m].
        up: Against gravity, of any length, shape (..., 3) or (3,): the moment left over is along it. Where it is zero or the force is
            across it, and without it, the moment left over is along the force.

    Returns:
        The points.

    Raises:
        InputError: A load without force has no line.
    """
    f, m = wrench[..., :3], wrench[..., 3:]
    size = np.linalg.norm(f, axis=-1)
    if not (size > NOTHING * (1.0 + np.abs(m).max(axis=-1))).all():
        raise InputError("the load has no force, so it has no line of action and no lever rule", name="posture", field="gravity")
    u = f / size[..., None]
    n = u if up is None else _upward(np.broadcast_to(up, u.shape), u)
    p = cross(n, m) / (n * f).sum(axis=-1, keepdims=True)
    # The axes across u: those of the world that lie farthest from it, made orthogonal.
    far = np.eye(3)[np.abs(u).argmin(axis=-1)]
    a = far - (far * u).sum(axis=-1, keepdims=True) * u
    a /= np.linalg.norm(a, axis=-1, keepdims=True)
    axes = np.stack([a, cross(u, a)], axis=-1)
    return LoadLine((p[..., None, :] @ axes)[..., 0, :], positions @ axes)


def _upward(up: Array, u: Array) -> Array:
    """Unit vectors against gravity, those of the force where there is no gravity or the force is across it."""
    size = np.linalg.norm(up, axis=-1, keepdims=True)
    n = up / np.where(size > 0.0, size, 1.0)
    return np.where(np.abs((n * u).sum(axis=-1, keepdims=True)) > ACROSS, n, u)
