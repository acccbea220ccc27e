"""How balance and joint torques change when the posture moves and the contact forces stay what they are in their contact frames.

The statics of the whole robot are one vector, ``T = [g_B; g_theta] - J' F``: the reaction the base would need and the joint torques. With
u = (base twist, joint rates), ``u . T`` is minus the power of all loads on u. Pinocchio differentiates T for loads that ride on their
links; a contact whose frame does not turn with its link, and an external wrench, which stays in the world, need a correction each.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from socp_statics.contacts import Stance
from socp_statics.postures.moved import contact_jacobians, require_derivatives, whole_jacobian
from socp_statics.spatial import Array, skew


class _Load(NamedTuple):
    """Something that acts on a link: the index of its joint, its point, the point's Jacobian, and how it fails to ride."""

    joint: int
    point: Array
    jacobian: Array
    held: Array
    shift: Array | None


class StaticDerivatives:
    """dT/dv along the tangent v of the configuration, SI; rows are force and moment at the base origin in base axes, then joint torques.

    Args:
        stance: A stance with a posture.
        turning: How each contact frame turns with its link, shape (3, 3): zero for a point, whose normal is the environment's; n n' for a
            sole that may only turn about its normal. By default contact frames ride on their links.

    Raises:
        InputError: The robot has mimic joints.
    """

    def __init__(self, stance: Stance, turning: Mapping[str, Array] | None = None):
        import pinocchio

        posture = stance.posture
        require_derivatives(posture.robot)
        self._q, self._model = posture.q, _model_with(posture.robot.pin_model, stance.gravity)
        self._data = self._model.createData()
        pinocchio.forwardKinematics(self._model, self._data, self._q)
        self._places = [self._data.oMi[i].copy() for i in range(self._model.njoints)]
        frame_id, frames = posture.robot.frame_id, self._model.frames
        self._contacts = []
        for name, J in contact_jacobians(posture).items():
            joint = frames[frame_id(posture.robot.frames[name].frame)].parentJoint
            held = np.zeros((3, 3)) if turning is None else np.eye(3) - turning[name]
            self._contacts.append(_Load(joint, posture.contacts[name].position, J, held, None))
        self._gravity = self._riding([], [])
        loads, wrenches = [], []
        for wrench in stance.external_wrenches:
            link, point = wrench.link or posture.robot.base, np.zeros(3) if wrench.point is None else wrench.point
            J = whole_jacobian(posture, point, posture.point_jacobian(link, point))
            loads.append(_Load(frames[frame_id(link)].parentJoint, point, J, np.eye(3), J[:3]))
            wrenches.append(np.concatenate([wrench.force, wrench.moment]))
        self.load = self._riding(loads, wrenches)

    def of(self, wrenches: Array) -> Array:
        """dT/dv under gravity, external wrenches and contact wrenches ``[force; moment]`` at the contacts' positions, world axes.

        Args:
            wrenches: Shape (contacts, 6) [N, N m].

        Returns:
            Shape (nv, nv).
        """
        return self.load + self.produced(wrenches)

    def produced(self, wrenches: Array) -> Array:
        """The share of the contact wrenches alone, shape (nv, nv)."""
        return self._riding(self._contacts, list(wrenches)) - self._gravity

    def _riding(self, loads: list[_Load], wrenches: list[Array]) -> Array:
        """dT/dv under gravity and wrenches on links."""
        import pinocchio

        at_joints = pinocchio.StdVec_Force([pinocchio.Force.Zero() for _ in range(self._model.njoints)])
        out = np.zeros((self._model.nv, self._model.nv))
        for load, F in zip(loads, wrenches, strict=True):
            place = self._places[load.joint]
            at_joints[load.joint] += pinocchio.SE3(place.rotation, place.translation - load.point).actInv(pinocchio.Force(F))
            turned = np.vstack([skew(F[:3]), skew(F[3:])])
            out -= load.jacobian.T @ (turned @ (load.held @ load.jacobian[3:]))
            if load.shift is not None:
                out -= load.jacobian[3:].T @ (skew(F[:3]) @ load.shift)
        return out + pinocchio.computeStaticTorqueDerivatives(self._model, self._data, self._q, at_joints)


def _model_with(model: Any, gravity: Array) -> Any:
    """The Pinocchio model under the stance's gravity."""
    if np.array_equal(model.gravity.linear, gravity):
        return model
    model = model.copy()
    model.gravity.linear = np.array(gravity)
    return model
