"""Joint torques of a posture as an affine function of the contact forces, and the rows that keep them inside their limits."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from socp_statics.contacts import ExternalWrench, Stance
from socp_statics.spatial import Array, cross
from socp_statics.statics.units import Units


class JointTorques(NamedTuple):
    """``tau = passive - map x`` in scaled units (force times length).

    Attributes:
        names: Joint names, length n.
        map: Torque that the unknown forces produce, shape (n, nx).
        passive: Torque without contact forces: gravity less external wrenches, shape (n,).
        limits: Lower and upper torques, infinite where there is none, shape (n, 2).
        jacobian: Velocity of each contact frame due to joint rates, ``[linear; angular]``, shape (contacts, 6, n).
    """

    names: tuple[str, ...]
    map: Array
    passive: Array
    limits: Array
    jacobian: Array

    @property
    def limited(self) -> bool:
        """Whether any joint torque is limited."""
        return bool(np.isfinite(self.limits).any())

    def of(self, x: Array) -> Array:
        """Scaled joint torques of scaled forces, shape (n,)."""
        return self.passive - self.map @ x


NONE = JointTorques((), np.zeros((0, 0)), np.zeros(0), np.zeros((0, 2)), np.zeros((0, 6, 0)))


def gravity_torque(com_jacobian: Array, mass: float, gravity: Array) -> Array:
    """Torque that holds the links against gravity with the base fixed, ``g_theta = -M J_CB^T a_g``.

    Implements (3.60), corrected: J_CB is the Jacobian of the centre of mass relative to the base; the printed one is its negative.

    Args:
        com_jacobian: J_CB, shape (3, n).
        mass: M [kg].
        gravity: a_g, world axes, shape (3,) [m/s^2].

    Returns:
        Shape (n,) [N m].
    """
    return -mass * com_jacobian.T @ gravity


def static_torque(passive_torque: Array, contact_jacobian: Array, wrenches: Array) -> Array:
    """Torque of a posture at rest under contact reactions, ``tau = g_theta - J_cB^T F``.

    Implements (3.74).

    Args:
        passive_torque: g_theta, less J^T F of external wrenches, shape (n,) [N m].
        contact_jacobian: Rows of J_cB, shape (m, n).
        wrenches: Reactions along those rows, shape (m,) [N, N m].

    Returns:
        Shape (n,) [N m].
    """
    return passive_torque - contact_jacobian.T @ wrenches


def passive_torque(stance: Stance) -> Array:
    """Torque of gravity and external wrenches without contact forces, shape (n,) [N m].

    Args:
        stance: A stance with a posture.
    """
    posture = stance.posture
    torque = gravity_torque(posture.com_jacobian, stance.mass, stance.gravity)
    for wrench in stance.external_wrenches:
        torque = torque - external_torque(posture, wrench)
    return torque


def external_torque(posture: object, wrench: ExternalWrench) -> Array:
    """``J^T F`` of an external wrench; zero on the base.

    Args:
        posture: A `socp_statics.postures.Posture`.
        wrench: The wrench and its link.

    Returns:
        Shape (n,) [N m].
    """
    robot = posture.robot  # type: ignore[attr-defined]
    if wrench.link is None or wrench.link == robot.base:
        return np.zeros(len(robot.joints))
    point = np.zeros(3) if wrench.point is None else wrench.point
    J = posture.point_jacobian(wrench.link, point)  # type: ignore[attr-defined]
    return J.T @ np.concatenate([wrench.force, wrench.moment])


def joint_torques(stance: Stance, units: Units, wrench_map: Array, contact_of_column: NDArray[np.int_], position: Array) -> JointTorques:
    """Torques of a stance's unknown forces.

    Args:
        stance: The stance.
        units: Its units.
        wrench_map: G, wrench of each unknown about the origin, scaled, shape (6, nx).
        contact_of_column: Index of each unknown's contact, shape (nx,).
        position: Position of each contact relative to the origin, scaled, shape (contacts, 3).

    Returns:
        The torques, without entries where there is no robot.
    """
    posture = stance.posture
    if posture is None:
        return NONE
    local = wrench_map.copy()
    local[3:] -= cross(position[contact_of_column], wrench_map[:3].T).T
    J = np.array([posture.jacobian[contact.name] for contact in stance.contacts])
    J[:, :3] /= units.length
    produced = np.empty((J.shape[2], wrench_map.shape[1]))
    for k in range(len(J)):
        mine = contact_of_column == k
        produced[:, mine] = J[k].T @ local[:, mine]
    scale = units.force * units.length
    limits = stance.torque_limits
    if limits is None:
        limits = np.full((J.shape[2], 2), np.inf)
        limits[:, 0] = -np.inf
    return JointTorques(posture.robot.joints, produced, passive_torque(stance) / scale, limits / scale, J)


def limit_rows(torques: JointTorques) -> tuple[Array, Array, tuple[str, ...]]:
    """Hard rows ``H x <= d`` of the finite torque limits: ``-map x <= upper - passive`` and ``map x <= passive - lower``.

    Returns:
        H, d and the joint of each row.
    """
    lower, upper = torques.limits[:, 0], torques.limits[:, 1]
    above, below = np.flatnonzero(np.isfinite(upper)), np.flatnonzero(np.isfinite(lower))
    rows = np.vstack([-torques.map[above], torques.map[below]])
    values = np.concatenate([upper[above] - torques.passive[above], torques.passive[below] - lower[below]])
    return rows, values, tuple(torques.names[k] for k in (*above, *below))


def joint_rates(torques: JointTorques, multipliers: Array) -> Array:
    """Joint rates of a motion from the multipliers of the torque rows: a joint moves against the limit that holds it back.

    Args:
        torques: The torques.
        multipliers: Of the rows of `limit_rows`, >= 0.

    Returns:
        Scaled rates, shape (n,); zero where a joint has no limit.
    """
    above, below = np.isfinite(torques.limits[:, 1]), np.isfinite(torques.limits[:, 0])
    rates = np.zeros(len(torques.names))
    rates[above] -= multipliers[: above.sum()]
    rates[below] += multipliers[above.sum() :]
    return rates


def torques_by_name(torques: JointTorques, units: Units, x: Array) -> dict[str, float]:
    """Joint torques of scaled forces by joint [N m]."""
    return dict(zip(torques.names, (units.force * units.length * torques.of(x)).tolist(), strict=True))


def limits_by_name(torques: JointTorques, units: Units) -> dict[str, tuple[float, float]]:
    """Torque limits by joint [N m]."""
    ends = units.force * units.length * torques.limits
    return {name: (float(lower), float(upper)) for name, (lower, upper) in zip(torques.names, ends, strict=True)}
