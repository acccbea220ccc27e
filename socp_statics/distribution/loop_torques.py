"""From the wrench distribution of a loop to the torques of its limbs: compensation of the load, and internal torque (3.5.3)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.contacts import ContactSet
from socp_statics.contacts.joint import constraint_basis
from socp_statics.spatial import Array


def component_slices(contacts: ContactSet) -> dict[str, slice]:
    """Where each contact's components are in the stacked vector."""
    ends = np.cumsum([0, *(constraint_basis(contact).shape[1] for contact in contacts)])
    return {name: slice(int(a), int(b)) for name, a, b in zip(contacts.names, ends[:-1], ends[1:], strict=True)}


def contact_components(
    contacts: ContactSet, inverse: ArrayLike, wrench: ArrayLike, projector: ArrayLike, F_a: ArrayLike
) -> dict[str, tuple[Array, Array]]:
    """What each contact carries of the load and of the internal wrench: ``F_k = C_k^# F_e + N_k F_a``.

    Implements (3.51).

    Args:
        contacts: The contacts.
        inverse: C^#, shape (c, 6).
        wrench: F_e, shape (6,) [N, N m].
        projector: N(C), shape (c, c).
        F_a: Shape (c,) [N, N m].

    Returns:
        ``(C_k^# F_e, F_k^n)`` by contact, each of shape (c_k,).
    """
    load = np.asarray(inverse, dtype=float) @ np.asarray(wrench, dtype=float)
    internal = np.asarray(projector, dtype=float) @ np.asarray(F_a, dtype=float)
    return {name: (load[part], internal[part]) for name, part in component_slices(contacts).items()}


class LoopTorque(NamedTuple):
    """A limb's torque from its contact: ``ext`` compensates the load, ``internal`` tightens the loop; shapes (n,) [N m]."""

    ext: Array
    internal: Array

    @property
    def total(self) -> Array:
        """``tau_k^c``."""
        return self.ext + self.internal


def limb_loop_torque(J_cR: ArrayLike, load: ArrayLike, internal: ArrayLike) -> LoopTorque:
    """``tau_k^c = tau_k^ext + tau_k^int = -J_cR^T C_k^# F_e - J_cR^T F_k^n``.

    Implements (3.52), corrected: minus, since the contact components are reactions; with gravity, ``tau = g_theta + tau^ext + tau^int``.

    Args:
        J_cR: Shape (c_k, n).
        load: C_k^# F_e, shape (c_k,) [N, N m].
        internal: F_k^n, shape (c_k,) [N, N m].

    Returns:
        The two parts.
    """
    J = np.asarray(J_cR, dtype=float)
    return LoopTorque(-J.T @ np.asarray(load, dtype=float), -J.T @ np.asarray(internal, dtype=float))
