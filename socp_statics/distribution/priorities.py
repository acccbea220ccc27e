"""Priorities among the components of a joint torque (3.4.3, 3.5.5): none of a lower level disturbs what a higher one holds.

A level disturbs another when it changes the contact force that the limb would exert along that level's directions, read by J_cR^#T.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.distribution.dual_null_space import dual_projector, null_projector
from socp_statics.distribution.generalized_inverses import pseudoinverse
from socp_statics.spatial import Array

# From the highest to the lowest.
LEVELS = ("ext", "int", "m", "n")


class PrioritisedTorque(NamedTuple):
    """A limb's torque by priority: ``tau^c`` above ``tau^m`` above ``tau^n``, shapes (n_k,) [N m]."""

    constraint: Array
    mobility: Array
    null: Array

    @property
    def total(self) -> Array:
        """The torque of the limb."""
        return self.constraint + self.mobility + self.null


def restricted_mobility(J_cR: ArrayLike, J_mR: ArrayLike) -> Array:
    """``J_mR N(J_cR)``: what the limb can still do along its mobility when its constraints are held, shape (6 - c_k, n_k)."""
    return np.asarray(J_mR, dtype=float) @ null_projector(J_cR)


def prioritised_torque(
    J_cR: ArrayLike, J_mR: ArrayLike, constrained: ArrayLike, mobile: ArrayLike | None = None, tau_u: ArrayLike | None = None
) -> PrioritisedTorque:
    """``tau_k = -J_cR^T F^c - (J_mR N)^T F~^m + (E - J_R^T J_R^#T) tau_u`` with ``F~^m = F^m - J_mR^#T J_cR^T F^c``.

    Implements (3.37), corrected: the mobility Jacobian stands transposed, ``(J_mR N)^T``, and F~^m takes off what F^c, not a component n,
    already exerts along the mobility. Minus on reactions.

    Args:
        J_cR: Shape (c_k, n_k).
        J_mR: Shape (6 - c_k, n_k).
        constrained: F_k^c, shape (c_k,) [N, N m].
        mobile: F_k^m wanted along the mobility, shape (6 - c_k,) [N, N m]; None in statics, where the contact holds the limb: no tau^m.
        tau_u: Torque of which the dual null space of the limb takes its part, shape (n_k,) [N m]; none by default, as statics asks.

    Returns:
        The three components.
    """
    J_c, J_m = np.asarray(J_cR, dtype=float), np.asarray(J_mR, dtype=float)
    F_c = np.asarray(constrained, dtype=float)
    constraint = -J_c.T @ F_c
    mobility = null = np.zeros(J_c.shape[1])
    if mobile is not None:
        mobility = -restricted_mobility(J_c, J_m).T @ (np.asarray(mobile, dtype=float) - pseudoinverse(J_m).T @ (J_c.T @ F_c))
    if tau_u is not None:
        null = dual_projector(np.vstack([J_c, J_m])) @ np.asarray(tau_u, dtype=float)
    return PrioritisedTorque(constraint, mobility, null)


def stacked_by_priority(components: dict[str, ArrayLike]) -> tuple[tuple[str, Array], ...]:
    """Torque components from the highest priority to the lowest: ``tau^ext > tau^int > tau^m > tau^n``.

    Implements (3.54).

    Args:
        components: Of "ext", "int", "m" and "n"; those left out are zero in statics and do not appear.

    Returns:
        Pairs of level and torque, in order.
    """
    return tuple((level, np.asarray(components[level], dtype=float)) for level in LEVELS if level in components)
