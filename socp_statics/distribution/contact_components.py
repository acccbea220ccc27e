"""What a contact wrench is made of: constraint and mobility parts, hard and soft parts, and their share in the loop's wrench (3.4.1-2)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.contacts import ContactSet
from socp_statics.contacts.contact import Contact
from socp_statics.contacts.joint import constraint_basis, hard_basis, mobility_basis, soft_basis
from socp_statics.exceptions import InputError
from socp_statics.spatial import Array
from socp_statics.statics.contact_maps import contact_map


class Parts(NamedTuple):
    """Two orthogonal parts of a contact wrench in the contact frame, as components and as wrenches.

    Attributes:
        first: Components along the constraints, or along the hard directions.
        second: Components along the mobility, or along the soft directions.
        first_wrench: Their wrench, shape (6,).
        second_wrench: Their wrench, shape (6,).
    """

    first: Array
    second: Array
    first_wrench: Array
    second_wrench: Array


def constraint_and_mobility(contact: Contact, wrench_C: ArrayLike) -> Parts:
    """``F_k = B_c F_k^c + B_m F_k^m``: reactions, and inertial parts that are zero in statics.

    Implements (3.28), corrected: the stacked components are the wrench only up to the order of its entries, so the bases are kept.

    Args:
        contact: The contact.
        wrench_C: In the contact frame about its position, shape (6,) [N, N m].

    Returns:
        The parts: c_k and 6 - c_k components.
    """
    return _parts(constraint_basis(contact), mobility_basis(contact), wrench_C)


def hard_and_soft(contact: Contact, wrench_C: ArrayLike) -> Parts:
    """``F_k^c = B_h F_k^h + B_s F_k^s``: what any friction transmits, and what stems from friction; both are reactions.

    Implements (3.29), corrected: the bases keep the order of the entries here too; they are those of the frictionless joint.

    Args:
        contact: The contact.
        wrench_C: In the contact frame about its position, shape (6,) [N, N m].

    Returns:
        The parts: c_h and c_s components.
    """
    return _parts(hard_basis(contact), soft_basis(contact), wrench_C)


def _parts(first: Array, second: Array, wrench: ArrayLike) -> Parts:
    F = np.asarray(wrench, dtype=float)
    a, b = first.T @ F, second.T @ F
    return Parts(a, b, first @ a, second @ b)


def loop_wrench_parts(
    contacts: ContactSet, point_W: ArrayLike, constrained: ArrayLike, mobile: ArrayLike | None = None
) -> tuple[Array, Array]:
    """The loop's wrench from its components: ``F_e = C_ce F^c + C_me F^m``; about the root it is the root wrench.

    Implements (3.30).

    Args:
        contacts: The contacts of the loop.
        point_W: Origin of the closure link or of the root, shape (3,) [m].
        constrained: F^c, contact by contact, shape (c,) [N, N m].
        mobile: F^m, contact by contact, shape (6 k - c,); zero by default, as in statics.

    Returns:
        ``(F_e^c, F_e^m)``, shapes (6,). The two are orthogonal contact by contact in its own frame, not as sums.

    Raises:
        InputError: The wrong number of components.
    """
    free = [mobility_basis(contact) for contact in contacts]
    C_c, C_m = contact_map(contacts, point_W), contact_map(contacts, point_W, free)
    F_c = np.asarray(constrained, dtype=float)
    F_m = np.zeros(C_m.shape[1]) if mobile is None else np.asarray(mobile, dtype=float)
    for word, given, C in (("constrained", F_c, C_c), ("mobile", F_m, C_m)):
        if given.shape != (C.shape[1],):
            message = f"{word}: {C.shape[1]} components are expected for {', '.join(contacts.names)}, got shape {given.shape}"
            raise InputError(message, name=word, field=word)
    return C_c @ F_c, C_m @ F_m
