"""The orientation of a contact frame: given as a rotation matrix, as a normal, or as roll, pitch, yaw."""

from __future__ import annotations

from typing import Any

import numpy as np

from socp_statics.contacts.numbers import vector
from socp_statics.exceptions import InputError
from socp_statics.spatial import Array

ORTHONORMALITY = 1e-6


def rotation_from_normal(normal: Array) -> Array:
    """Contact frame of a unit normal: t1 is world x projected on the contact plane, world y where the normal is nearly x.

    Args:
        normal: Unit normal in world axes, shape (3,), from the environment into the robot.

    Returns:
        ``R_WC`` with columns t1, t2, n, shape (3, 3).
    """
    axis = np.array([0.0, 1.0, 0.0]) if abs(normal[0]) > 0.99 else np.array([1.0, 0.0, 0.0])
    t1 = axis - (axis @ normal) * normal
    t1 /= np.linalg.norm(t1)
    return np.column_stack([t1, np.cross(normal, t1), normal])


def rotation_from_rpy(rpy: Array) -> Array:
    """``R = Rz(yaw) Ry(pitch) Rx(roll)``.

    Args:
        rpy: Roll, pitch and yaw [rad], shape (3,).

    Returns:
        Rotation matrix, shape (3, 3).
    """
    (cr, cp, cy), (sr, sp, sy) = np.cos(rpy), np.sin(rpy)
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def contact_rotation(name: str, rotation: Any, normal: Any, rpy: Any) -> Array:
    """The one orientation of a contact, checked.

    Args:
        name: Contact name, for the error sentence.
        rotation: Columns t1, t2, n in world axes, shape (3, 3), or None.
        normal: Any positive multiple of the normal, shape (3,), or None.
        rpy: Roll, pitch, yaw [rad], shape (3,), or None.

    Returns:
        Orthonormal right-handed ``R_WC``, shape (3, 3).

    Raises:
        InputError: None or several of the three are given, or the one given is not an orientation.
    """
    given = [field for field, value in (("rotation", rotation), ("normal", normal), ("rpy", rpy)) if value is not None]
    if len(given) != 1:
        had = "none" if not given else " and ".join(given)
        raise InputError(f"contact '{name}': exactly one of rotation, normal and rpy is expected, got {had}", name=name, field="rotation")
    if normal is not None:
        n = vector(name, "normal", normal, 3)
        scale = float(np.abs(n).max())
        if scale == 0.0:
            raise InputError(f"contact '{name}': normal must not be zero", name=name, field="normal")
        n = n / scale
        return rotation_from_normal(n / np.linalg.norm(n))
    if rpy is not None:
        return rotation_from_rpy(vector(name, "rpy", rpy, 3))
    R = vector(name, "rotation", rotation, 9, shape=(3, 3))
    if np.abs(R.T @ R - np.eye(3)).max() > ORTHONORMALITY:
        raise InputError(f"contact '{name}': rotation must be orthonormal within 1e-6 (columns t1, t2, n)", name=name, field="rotation")
    if np.linalg.det(R) < 0.0:
        raise InputError(f"contact '{name}': rotation must be right-handed, its determinant is -1", name=name, field="rotation")
    U, _, Vt = np.linalg.svd(R)
    return U @ Vt
