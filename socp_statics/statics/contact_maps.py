"""Contact maps and Jacobians of a posture, and the wrench of the composite rigid body, with the chapter's symbols."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.contacts import ContactSet
from socp_statics.contacts.joint import constraint_basis
from socp_statics.spatial import Array, cross, skew


def contact_map(contacts: ContactSet, point_W: ArrayLike, bases: Sequence[Array] | None = None) -> Array:
    """C_cB or C_cC: contact components to the wrench about a point, ``[[E, 0], [S(r_k - r), E]] diag(R_k, R_k) B_c`` side by side.

    Args:
        contacts: The contacts.
        point_W: Base origin or centre of mass, world axes, shape (3,) [m].
        bases: Constraint bases, one a contact, shapes (6, c_k); by default what each contact transmits.

    Returns:
        Shape (6, c): ``[force; moment about the point]`` in world axes.
    """
    point = np.asarray(point_W, dtype=float)
    blocks = []
    for k, contact in enumerate(contacts):
        B = constraint_basis(contact) if bases is None else bases[k]
        T = np.eye(6)
        T[3:, :3] = skew(contact.position - point)
        blocks.append(T @ np.kron(np.eye(2), contact.rotation) @ B)
    return np.hstack(blocks)


def contact_maps(positions: Array, rotations: Array, bases: Sequence[Array]) -> Array:
    """The contact maps of a batch of postures with equal contacts, as `contact_map` gives them one by one.

    Args:
        positions: Of the contacts relative to the point of the map, shape (..., k, 3) [m].
        rotations: R_WC, shape (..., k, 3, 3).
        bases: Constraint bases, one a contact, identity columns of shapes (6, c_k).

    Returns:
        Shape (..., 6, c).
    """
    blocks = []
    for k, B in enumerate(bases):
        R, arm = rotations[..., k, :, :], positions[..., k, :]
        whole = np.zeros((*R.shape[:-2], 6, 6))
        whole[..., :3, :3] = whole[..., 3:, 3:] = R
        whole[..., 3:, :3] = cross(arm[..., None, :], R.swapaxes(-1, -2)).swapaxes(-1, -2)
        blocks.append(whole[..., B.any(axis=1)])
    return np.concatenate(blocks, axis=-1)


def body_wrench(C: Array, components: Array) -> Array:
    """Wrench of the contact reactions on the composite rigid body, ``F_B = C_cB F`` or ``F_C = C_cC F``.

    Implements (3.55).
    Implements (3.56).

    Args:
        C: Contact map to the base or the centre of mass, shape (6, c).
        components: Contact components, shape (c,) [N, N m].

    Returns:
        Shape (6,) [N, N m].
    """
    return C @ components


def summed_wrench(point_W: ArrayLike, positions_W: Array, forces_W: Array, moments_W: Array) -> Array:
    """Wrench of contact forces and moments about a point, written out: ``[sum f; sum m - S(r_o - r_k) f]``.

    Implements (3.57).

    Args:
        point_W: r_o, shape (3,) [m].
        positions_W: r_k, shape (k, 3) [m].
        forces_W: f_k, shape (k, 3) [N].
        moments_W: m_k about r_k, shape (k, 3) [N m].

    Returns:
        Shape (6,).
    """
    arm = positions_W - np.asarray(point_W, dtype=float)
    return np.concatenate([forces_W.sum(axis=0), (moments_W + np.cross(arm, forces_W)).sum(axis=0)])


def net_wrench(body: Array, point_W: ArrayLike, positions_W: Array, forces_W: Array) -> Array:
    """Sum of the contact wrenches without lever arms, ``F_net = F_o + sum [0; S(r_o - r_k) f_k]``.

    Implements (3.58), corrected: with ``r_(o)k = r_o - r_k`` the sign is plus.

    Args:
        body: F_o about the point, shape (6,).
        point_W: r_o, shape (3,) [m].
        positions_W: r_k, shape (k, 3) [m].
        forces_W: f_k, shape (k, 3) [N].

    Returns:
        Shape (6,).
    """
    arm = np.asarray(point_W, dtype=float) - positions_W
    return body + np.concatenate([np.zeros(3), np.cross(arm, forces_W).sum(axis=0)])


def gravity_wrench(mass: float, gravity: ArrayLike, base_W: ArrayLike, com_W: ArrayLike) -> Array:
    """Reaction to gravity at the base, ``G_B = M [-E; S(r_B - r_C)] a_g``.

    Implements (3.59).

    Args:
        mass: M [kg].
        gravity: a_g, shape (3,) [m/s^2].
        base_W: r_B, shape (3,) [m].
        com_W: r_C, shape (3,) [m].

    Returns:
        Shape (6,): an upward force and its moment about the base.
    """
    g, arm = np.asarray(gravity, dtype=float), np.asarray(base_W, dtype=float) - np.asarray(com_W, dtype=float)
    return mass * np.concatenate([-g, np.cross(arm, g)])


def contact_jacobian(contacts: ContactSet, jacobian: Sequence[Array], bases: Sequence[Array] | None = None) -> Array:
    """J_cB: velocity along the constrained directions due to joint rates with the base fixed, contact frames, shape (c, n).

    Args:
        contacts: The contacts.
        jacobian: ``[linear; angular]`` of each contact frame in world axes, shapes (6, n).
        bases: Constraint bases, one a contact; by default what each contact transmits.
    """
    rows = []
    for k, contact in enumerate(contacts):
        B = constraint_basis(contact) if bases is None else bases[k]
        rows.append(B.T @ np.kron(np.eye(2), contact.rotation.T) @ jacobian[k])
    return np.vstack(rows)


def mixed_jacobian(J_cB: Array, C_cC: Array, com_jacobian: Array) -> Array:
    """J_cM of the mixed quasi-coordinates (CoM velocity, base angular velocity): ``J_cM = J_cB - C_cf^T J_CB``.

    C_cf are the force rows of the contact map. Then the contact velocity is ``C_cC^T [v_C; w_B] + J_cM theta_dot``.

    Args:
        J_cB: Shape (c, n).
        C_cC: Contact map to the centre of mass, shape (6, c).
        com_jacobian: J_CB, shape (3, n).

    Returns:
        Shape (c, n).
    """
    return J_cB - C_cC[:3].T @ com_jacobian


def lumped_torque(J_cM: Array, components: Array) -> Array:
    """Torque with gravity lumped at the centre of mass, ``tau_M = -J_cM^T F``; equals (3.74) where the forces balance gravity.

    Implements (3.75).

    Args:
        J_cM: Shape (c, n).
        components: Reactions, shape (c,) [N, N m].

    Returns:
        Shape (n,) [N m].
    """
    return -J_cM.T @ components
