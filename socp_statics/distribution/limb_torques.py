"""The torques of one limb from the wrench of its contact, part by part (3.4.3).

All wrenches are reactions, so every torque here is ``-J^T F``; with gravity, ``tau = g_theta + tau_c + tau_m`` (3.74). In statics the
mobility part is zero and so is every torque of the dual null space: it would only accelerate the limb.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.contacts.contact import Contact
from socp_statics.contacts.joint import constraint_basis, mobility_basis
from socp_statics.distribution.dual_null_space import dual_projector
from socp_statics.spatial import Array


def limb_jacobians(contact: Contact, J_k: ArrayLike) -> tuple[Array, Array]:
    """J_cR and J_mR: relative contact velocity along constraints and mobility due to the limb's rates, in the contact frame.

    With a moving root, ``V_c - C_cR^T V_R = J_cR theta_dot`` (the printed text leaves out the transpose), and the same with m.

    Args:
        contact: The contact.
        J_k: ``[linear; angular]`` of the contact frame with the root fixed, world axes, shape (6, n_k).

    Returns:
        Shapes (c_k, n_k) and (6 - c_k, n_k).
    """
    J = np.kron(np.eye(2), contact.rotation.T) @ np.asarray(J_k, dtype=float)
    return constraint_basis(contact).T @ J, mobility_basis(contact).T @ J


def constraint_torque(J_cR: ArrayLike, components: ArrayLike) -> Array:
    """``tau_k^c = -J_cR^T F_k^c``.

    Implements (3.31), corrected: minus, since F_k^c is the reaction.

    Args:
        J_cR: Shape (c_k, n_k).
        components: F_k^c, shape (c_k,) [N, N m].

    Returns:
        Shape (n_k,) [N m].
    """
    return -np.asarray(J_cR, dtype=float).T @ np.asarray(components, dtype=float)


def mobility_torque(J_mR: ArrayLike, components: ArrayLike) -> Array:
    """``tau_k^m = -J_mR^T F_k^m``.

    Implements (3.32), corrected: minus, since F_k^m is the reaction.

    Args:
        J_mR: Shape (6 - c_k, n_k).
        components: F_k^m, shape (6 - c_k,) [N, N m].

    Returns:
        Shape (n_k,) [N m].
    """
    return -np.asarray(J_mR, dtype=float).T @ np.asarray(components, dtype=float)


def permuted_jacobian(J_cR: ArrayLike, J_mR: ArrayLike) -> Array:
    """``J_R = [J_cR; J_mR]`` (2.77), shape (6, n_k): the rows of the limb's Jacobian, constraints first."""
    return np.vstack([np.asarray(J_cR, dtype=float), np.asarray(J_mR, dtype=float)])


def contact_torque(J_cR: ArrayLike, J_mR: ArrayLike, constrained: ArrayLike, mobile: ArrayLike) -> Array:
    """The sum of the parts, ``tau_k = tau_k^c + tau_k^m = -J_R^T [F_k^c; F_k^m]``; the two are not orthogonal.

    Implements (3.33), corrected: minus, since the components are reactions.

    Args:
        J_cR: Shape (c_k, n_k).
        J_mR: Shape (6 - c_k, n_k).
        constrained: F_k^c, shape (c_k,) [N, N m].
        mobile: F_k^m, shape (6 - c_k,) [N, N m].

    Returns:
        Shape (n_k,) [N m].
    """
    F = np.concatenate([np.asarray(constrained, dtype=float), np.asarray(mobile, dtype=float)])
    return -permuted_jacobian(J_cR, J_mR).T @ F


def redundant_limb_torque(J_R: ArrayLike, wrench: ArrayLike, tau_u: ArrayLike, inverse: ArrayLike | None = None) -> Array:
    """``tau_k = -J_R^T F_k + (E - J_R^T J_R^#T) tau_u``: the second part only moves the limb within itself and is zero in statics.

    Implements (3.34), corrected: minus on the reaction; the projector is that of the formula, not that of the line below it.

    Args:
        J_R: Shape (6, n_k).
        wrench: F_k in the rows of J_R, shape (6,) [N, N m].
        tau_u: Any torque, shape (n_k,) [N m].
        inverse: J_R^#, shape (n_k, 6), the pseudoinverse by default.

    Returns:
        Shape (n_k,) [N m].
    """
    J = np.asarray(J_R, dtype=float)
    return -J.T @ np.asarray(wrench, dtype=float) + dual_projector(J, inverse) @ np.asarray(tau_u, dtype=float)
