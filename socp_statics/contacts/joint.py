"""Contact joints: which wrench components a contact transmits and which motions it leaves free or damps.

All bases are columns of the 6 x 6 identity in the contact frame, order (fx, fy, fz, mx, my, mz), moments about the position.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.contacts.contact import COMPONENTS, Contact
from socp_statics.spatial import Array


def basis(components: Iterable[str]) -> Array:
    """Identity columns of the named components, in the order of the wrench.

    Args:
        components: Of "fx", "fy", "fz", "mx", "my", "mz".

    Returns:
        Shape (6, c).
    """
    chosen = set(components)
    return np.eye(6)[:, [i for i, word in enumerate(COMPONENTS) if word in chosen]]


def complement(B: ArrayLike) -> Array:
    """The identity columns that a basis of identity columns lacks.

    Implements (3.19), corrected: the complement is this set of columns, ``E - B`` has no meaning for a 6 x c matrix.

    Args:
        B: Identity columns, shape (6, c).

    Returns:
        Shape (6, 6 - c).
    """
    return np.eye(6)[:, ~np.asarray(B, dtype=bool).any(axis=1)]


def constraint_basis(contact: Contact) -> Array:
    """B_c: the components the contact transmits, friction included.

    For a handle on a bar this is (3.6), for a frictionless sole (3.7).

    Implements (3.6).
    Implements (3.7).

    Returns:
        Shape (6, c_k).
    """
    return basis((*contact.hard, *contact.soft))


def hard_basis(contact: Contact) -> Array:
    """Columns of the hard constraint directions (normal), shape (6, c_h)."""
    return basis(contact.hard)


def soft_basis(contact: Contact) -> Array:
    """Columns of the soft constraint directions (friction), shape (6, c_s)."""
    return basis(contact.soft)


def mobility_basis(contact: Contact) -> Array:
    """B_m of the joint with its friction: the motions that the contact leaves free, shape (6, 6 - c_k)."""
    return complement(constraint_basis(contact))


def contact_wrench(B_c: ArrayLike, components: ArrayLike) -> Array:
    """Contact wrench of the transmitted components: ``F = B_c F_bar``.

    Implements (3.5).
    Implements (3.15).

    Args:
        B_c: Constraint basis, shape (6, c).
        components: Transmitted components [N, N m], shape (c,).

    Returns:
        Wrench in the contact frame, shape (6,).
    """
    return np.asarray(B_c, dtype=float) @ np.asarray(components, dtype=float)


def contact_twist(B_m: ArrayLike, components: ArrayLike) -> Array:
    """Relative twist of the free motions: ``V = B_m V_bar``.

    Implements (3.16).

    Args:
        B_m: Mobility basis, shape (6, 6 - c).
        components: Free velocity components [m/s, rad/s], shape (6 - c,).

    Returns:
        Twist in the contact frame, shape (6,).
    """
    return np.asarray(B_m, dtype=float) @ np.asarray(components, dtype=float)


def untransmitted_wrench(B_m: ArrayLike, wrench: ArrayLike) -> Array:
    """Components of a wrench along the free motions; zero for any wrench of a frictionless joint, ``B_m^T F = 0``.

    Implements (3.17).

    Returns:
        Shape (6 - c,).
    """
    return np.asarray(B_m, dtype=float).T @ np.asarray(wrench, dtype=float)


def suppressed_twist(B_c: ArrayLike, twist: ArrayLike) -> Array:
    """Components of a twist along the constraints; zero for any motion the joint admits, ``B_c^T V = 0``.

    Implements (3.18).

    Returns:
        Shape (c,).
    """
    return np.asarray(B_c, dtype=float).T @ np.asarray(twist, dtype=float)


def friction_wrench(contact: Contact, soft_components: ArrayLike) -> Array:
    """Wrench of the friction components: ``F = B_m F_s`` with B_m the soft directions of the frictionless joint.

    Implements (3.20).

    Args:
        contact: The contact.
        soft_components: Along the soft directions [N, N m], shape (c_s,).

    Returns:
        Wrench in the contact frame, shape (6,).
    """
    return soft_basis(contact) @ np.asarray(soft_components, dtype=float)


def sliding_twist(contact: Contact, soft_velocity: ArrayLike) -> Array:
    """Twist of a sliding contact: ``V = B_m V_s``.

    Implements (3.21), corrected: sliding lies in the soft directions; the printed B_c has the wrong size for a point.

    Args:
        contact: The contact.
        soft_velocity: Along the soft directions [m/s, rad/s], shape (c_s,).

    Returns:
        Twist in the contact frame, shape (6,).
    """
    return soft_basis(contact) @ np.asarray(soft_velocity, dtype=float)


def friction_components(contact: Contact, wrench: ArrayLike) -> Array:
    """Friction components that a wrench induces: ``F_s = B_m^T F``.

    Implements (3.22).

    Returns:
        Shape (c_s,) [N, N m].
    """
    return soft_basis(contact).T @ np.asarray(wrench, dtype=float)


def sliding_velocity(contact: Contact, twist: ArrayLike) -> Array:
    """Sliding components of a twist: ``V_s = B_m^T V``.

    Implements (3.23), corrected: the printed B_c picks the wrong directions.

    Returns:
        Shape (c_s,) [m/s, rad/s].
    """
    return soft_basis(contact).T @ np.asarray(twist, dtype=float)


def complementarity(normal_force: ArrayLike, normal_acceleration: ArrayLike) -> Array:
    """Product of normal force and normal acceleration: zero while a unilateral contact holds or opens, ``f_z dv_z = 0``.

    Implements (3.8).

    Returns:
        Same shape as the arguments [N m/s^2].
    """
    return np.asarray(normal_force, dtype=float) * np.asarray(normal_acceleration, dtype=float)


def sliding_friction_residual(force_C: ArrayLike, velocity_C: ArrayLike, friction: float) -> Array:
    """How far a force is from opposing its sliding velocity on the cone: ``mu f_z v_t + f_t |v_t|``, zero while sliding.

    Implements (3.10).

    Args:
        force_C: Contact forces (f_x, f_y, f_z) in the contact frame, shape (..., 3) [N].
        velocity_C: Tangential velocities or accelerations, shape (..., 2) [m/s].
        friction: Coulomb coefficient.

    Returns:
        Shape (..., 2) [N m/s].
    """
    f, v = np.asarray(force_C, dtype=float), np.asarray(velocity_C, dtype=float)
    return friction * f[..., 2:] * v + f[..., :2] * np.linalg.norm(v, axis=-1, keepdims=True)
