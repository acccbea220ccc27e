"""Closed loops: the wrenches of a loop at its links, its root and its closure, and the torques of its limbs (3.4).

Every wrench is a reaction, environment on robot, ``[force; moment]`` in world axes with the moment about the origin of its own link or
contact. ``T_ab^T`` moves a wrench from b to a. The sums hold for any number of loops and limbs, two legs or two arms with an object alike.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.exceptions import InputError
from socp_statics.spatial import Array, cross


def moved_and_summed(point_W: ArrayLike, points_W: ArrayLike, wrenches: ArrayLike) -> Array:
    """``sum_k T^T F_k``: wrenches given at several points, together about one point.

    Args:
        point_W: Where the sum is wanted, shape (3,) [m].
        points_W: Where each wrench is given, shape (k, 3) [m].
        wrenches: Shape (k, 6) [N, N m].

    Returns:
        Shape (6,).

    Raises:
        InputError: As many points as wrenches are expected.
    """
    at, F = np.asarray(points_W, dtype=float).reshape(-1, 3), np.asarray(wrenches, dtype=float).reshape(-1, 6)
    if len(at) != len(F):
        raise InputError(f"wrenches: {len(at)} are expected, one for each point, got {len(F)}", name="wrenches", field="wrenches")
    arm = at - np.asarray(point_W, dtype=float)
    return np.concatenate([F[:, :3].sum(axis=0), (F[:, 3:] + cross(arm, F[:, :3])).sum(axis=0)])


def link_wrench(link_W: ArrayLike, contacts_W: ArrayLike, shares: ArrayLike) -> Array:
    """Reaction to the external wrench on a link from what of it each contact takes: ``F_l = sum_k T_lk^T F_k^l``.

    Implements (3.24).

    Args:
        link_W: Origin of the link, shape (3,) [m].
        contacts_W: Positions of the contacts, shape (k, 3) [m].
        shares: F_k^l about the contacts, shape (k, 6) [N, N m].

    Returns:
        Shape (6,).
    """
    return moved_and_summed(link_W, contacts_W, shares)


def total_contact_wrenches(shares: ArrayLike) -> Array:
    """``F_k = sum_l F_k^l``: what the contacts carry of all links together.

    Args:
        shares: F_k^l, shape (links, k, 6) [N, N m].

    Returns:
        Shape (k, 6).
    """
    return np.asarray(shares, dtype=float).sum(axis=0)


def root_wrench(root_W: ArrayLike, points_W: ArrayLike, wrenches: ArrayLike) -> Array:
    """The root wrench, from the links or from the contacts: ``F_R = sum_l T_Rl^T F_l = sum_k T_Rk^T F_k``.

    Implements (3.25).

    Args:
        root_W: Origin of the root link, shape (3,) [m].
        points_W: Origins of the links, or positions of the contacts, shape (k, 3) [m].
        wrenches: F_l or F_k, shape (k, 6) [N, N m].

    Returns:
        Shape (6,).
    """
    return moved_and_summed(root_W, points_W, wrenches)


def closure_wrench(closure_W: ArrayLike, points_W: ArrayLike, wrenches: ArrayLike) -> Array:
    """The closure-link wrench, from the links or from the contacts: ``F_e = sum_l T_el^T F_l = sum_k T_ek^T F_k``.

    Implements (3.26).

    Args:
        closure_W: Origin of the closure link: the floor, or the object held, shape (3,) [m].
        points_W: Origins of the links, or positions of the contacts, shape (k, 3) [m].
        wrenches: F_l or F_k, shape (k, 6) [N, N m].

    Returns:
        Shape (6,).
    """
    return moved_and_summed(closure_W, points_W, wrenches)


def limb_torque(J_R: ArrayLike, wrench: ArrayLike) -> Array:
    """What a contact wrench adds to the torques of its limb: ``tau_k = -J_R^T F_k``.

    Implements (3.27), corrected: F_k is the reaction here as everywhere, so the sign is minus; the printed plus belongs to the wrench that
    the robot impresses. The whole static torque is g_theta plus this, (3.74).

    Args:
        J_R: Velocity of the contact frame due to the limb's rates with the root fixed, ``[linear; angular]``, shape (6, n_k).
        wrench: F_k in the same axes, shape (6,) [N, N m].

    Returns:
        Shape (n_k,) [N m].
    """
    return -np.asarray(J_R, dtype=float).T @ np.asarray(wrench, dtype=float)
