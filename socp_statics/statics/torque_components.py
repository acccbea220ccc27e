"""The torque of the whole robot from the torques of its limbs and from its components (3.6.4).

Contact components are reactions, so what they add to a torque is ``-J^T F``; the torque that holds a posture still is ``g_theta`` plus
that.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from socp_statics.exceptions import InputError
from socp_statics.postures import Posture
from socp_statics.registry import nearest
from socp_statics.spatial import Array


def limb_joints(posture: Posture, contact: str) -> NDArray[np.int_]:
    """Joints between the base and a contact, from the base outwards: those that its wrench can load.

    Args:
        posture: The posture.
        contact: Name of a contact of the robot.

    Returns:
        Indices into ``posture.robot.joints``.

    Raises:
        InputError: The robot has no such contact.
    """
    robot = posture.robot
    if contact not in robot.frames:
        raise InputError(f"contact '{contact}' is not known{nearest(contact, robot.frames)}", name=contact, field="contact")
    model = robot.pin_model
    joint = model.frames[robot.frame_id(robot.frames[contact].frame)].parentJoint
    columns = [model.joints[i].idx_v - 6 + k for i in model.supports[joint] if i > 1 for k in range(model.joints[i].nv)]
    return np.array(columns, dtype=int)


def stacked_torque(joints: Sequence[str], limbs: Mapping[str, tuple[NDArray[np.int_], ArrayLike]], rest: ArrayLike | None = None) -> Array:
    """``tau``, the torques of all joints from those of the limbs.

    Implements (3.71), corrected: the torso and the head belong to the robot too. Joints that limbs share (a waist under both arms) get the
    sum of what the limbs add, and joints of no limb get what ``rest`` says, their gravity torque.

    Args:
        joints: Names of all joints.
        limbs: By limb, indices into the joints and torques, shapes (n_k,) [N m].
        rest: What is there without the limbs, shape (n,) [N m]; zero by default.

    Returns:
        Shape (n,) [N m].

    Raises:
        InputError: A limb with as many torques as it has joints is expected.
    """
    tau = np.zeros(len(joints)) if rest is None else np.array(rest, dtype=float)
    if tau.shape != (len(joints),):
        raise InputError(f"rest: {len(joints)} torques are expected, got shape {tau.shape}", name="rest", field="rest")
    for name, (index, torque) in limbs.items():
        given = np.asarray(torque, dtype=float)
        if given.shape != (len(index),):
            raise InputError(f"limb '{name}': {len(index)} torques are expected, got shape {given.shape}", name=name, field="limbs")
        tau[index] += given
    return tau


def contact_torques(J_cB: ArrayLike, J_mB: ArrayLike, constrained: ArrayLike, mobile: ArrayLike | None = None) -> tuple[Array, Array]:
    """``tau^c + tau^m = -J_cB^T F^c - J_mB^T F^m``.

    Implements (3.72), corrected: minus, since the components are reactions; in statics F^m is zero.

    Args:
        J_cB: Shape (c, n).
        J_mB: Shape (eta, n).
        constrained: F^c, shape (c,) [N, N m].
        mobile: F^m, shape (eta,) [N, N m]; zero by default.

    Returns:
        ``(tau^c, tau^m)``, shapes (n,) [N m].
    """
    J_c, J_m = np.asarray(J_cB, dtype=float), np.asarray(J_mB, dtype=float)
    tau_m = np.zeros(J_c.shape[1]) if mobile is None else -J_m.T @ np.asarray(mobile, dtype=float)
    return -J_c.T @ np.asarray(constrained, dtype=float), tau_m


class TorqueComponents(NamedTuple):
    """A static torque by components, shapes (n,) [N m].

    Attributes:
        gravity: g_theta, less what external wrenches on the links take.
        ext: Compensates the load, ``-J_cB^T C^# F_B``.
        internal: Tightens the loops, ``-J_cB^T F^n``: the only freedom that statics leaves to the motors.
    """

    gravity: Array
    ext: Array
    internal: Array

    @property
    def total(self) -> Array:
        """``tau = g_theta + tau^ext + tau^int``, as (3.74) with the whole reactions."""
        return self.gravity + self.ext + self.internal


def torque_components(gravity: ArrayLike, J_cB: ArrayLike, load: ArrayLike, internal: ArrayLike) -> TorqueComponents:
    """``tau = tau^ext + tau^int + tau^m + tau^n`` of a posture at rest.

    Implements (3.73), corrected: g_theta stands beside the four, tau^m is zero because nothing accelerates along the mobility, and tau^n is
    zero because any torque of the dual null space would move the joints; reactions enter with a minus.

    Args:
        gravity: g_theta, shape (n,) [N m].
        J_cB: Shape (c, n).
        load: ``C^# F_B``, shape (c,) [N, N m].
        internal: F^n, shape (c,) [N, N m].

    Returns:
        The components.
    """
    J = np.asarray(J_cB, dtype=float)
    return TorqueComponents(np.array(gravity, dtype=float), -J.T @ np.asarray(load, dtype=float), -J.T @ np.asarray(internal, dtype=float))
