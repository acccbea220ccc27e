"""Disturbances of a stance: what a push, an error or a tilt adds to its load, linear in a few coordinates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from socp_statics.contacts import ExternalWrench, Stance
from socp_statics.spatial import Array, skew
from socp_statics.statics import StaticsData
from socp_statics.statics.added_load import limit_relief
from socp_statics.statics.joint_torques import external_torque

HORIZONTAL = np.eye(3)[:, :2]
# A singular value below this share of the largest is a coordinate that nothing depends on.
UNSEEN = 1e-9


@dataclass(frozen=True, eq=False)
class Disturbance:
    """``L + B z`` instead of the load L, in scaled units, for all z of a ball.

    Attributes:
        wrench: B, shape (6, k).
        torque: What a unit of each coordinate takes from the joint torques, shape (n, k).
        one: What a unit of z is in SI.
        axes: Columns are the coordinates in words a person chose: world axes, shape (m, k).
    """

    wrench: Array
    torque: Array
    one: float
    axes: Array

    def relief(self, data: StaticsData) -> Array:
        """What a unit of each coordinate adds to the values of the hard rows, shape (limits, k)."""
        return limit_relief(data, self.torque)

    def seen(self) -> Disturbance:
        """The same in the fewest orthonormal coordinates, scaled to an effect of about one: a ball projects onto a ball.

        Coordinates that move neither load nor torques are left out, such as the height of the centre of mass under vertical gravity.
        """
        _, s, Vt = np.linalg.svd(np.vstack([self.wrench, self.torque]), full_matrices=False)
        largest = float(s.max(initial=0.0))
        if largest == 0.0:
            return Disturbance(self.wrench[:, :0], self.torque[:, :0], self.one, self.axes[:, :0])
        V = Vt[s > UNSEEN * largest].T
        V = V * np.where(V[np.abs(V).argmax(axis=0), np.arange(V.shape[1])] < 0.0, -1.0, 1.0)
        if V.shape[1] == len(Vt[0]):
            V = np.eye(len(V))
        return Disturbance(self.wrench @ V / largest, self.torque @ V / largest, self.one / largest, self.axes @ V)


def pushes(stance: Stance, data: StaticsData, point: Array, link: str | None, axes: Array) -> Disturbance:
    """Forces at a point.

    Args:
        stance: The stance.
        data: Its arrays.
        point: Where they act, world axes, shape (3,) [m].
        link: Link of the robot they act on; None for the base, whose pushes take nothing from the joints.
        axes: Orthonormal directions of the forces, shape (3, k).

    Returns:
        In newtons.
    """
    arm = (point - data.units.origin) / data.units.length
    torque = np.zeros((len(data.torques.names), axes.shape[1]))
    if stance.posture is not None and link is not None:
        for j, axis in enumerate(axes.T):
            torque[:, j] = external_torque(stance.posture, ExternalWrench(force=axis, point=point, link=link)) / data.units.length
    return Disturbance(np.vstack([axes, skew(arm) @ axes]), torque, data.units.force, axes)


def wrenches(data: StaticsData, point: Array, length: float) -> Disturbance:
    """Wrenches about a point on the base, moments over a characteristic length.

    Args:
        data: The stance's arrays.
        point: About which the moments are taken, world axes, shape (3,) [m].
        length: Characteristic length [m].

    Returns:
        In newtons: the coordinates are force and moment over length.
    """
    arm = (point - data.units.origin) / data.units.length
    B = np.zeros((6, 6))
    B[:3, :3], B[3:, :3] = np.eye(3), skew(arm)
    B[3:, 3:] = length / data.units.length * np.eye(3)
    return Disturbance(B, np.zeros((len(data.torques.names), 6)), data.units.force, np.eye(6))


def moments(data: StaticsData) -> Disturbance:
    """Moments on the base, in newton metres."""
    one = data.units.force * data.units.length
    return Disturbance(np.vstack([np.zeros((3, 3)), np.eye(3)]), np.zeros((len(data.torques.names), 3)), one, np.eye(3))


def com_errors(stance: Stance, data: StaticsData) -> Disturbance:
    """Displacements of the centre of mass in any direction; joint torques stay those of the posture.

    Args:
        stance: The stance.
        data: Its arrays.

    Returns:
        In metres.
    """
    weight = stance.mass * stance.gravity / data.units.force
    B = np.vstack([np.zeros((3, 3)), -skew(weight)])
    return Disturbance(B, np.zeros((len(data.torques.names), 3)), data.units.length, np.eye(3))


def gravity_changes(stance: Stance, data: StaticsData) -> Disturbance:
    """Changes of gravity in units of its own size; they take their share from the joints.

    Args:
        stance: The stance, with gravity.
        data: Its arrays.
    """
    share = stance.weight / data.units.force
    torque = np.zeros((len(data.torques.names), 3))
    if stance.posture is not None:
        torque = share * stance.posture.com_jacobian.T / data.units.length
    return Disturbance(share * np.vstack([np.eye(3), skew(data.com)]), torque, 1.0, np.eye(3))


def mass_errors(stance: Stance, data: StaticsData, shape: Array) -> Disturbance:
    """Errors ``shape u`` of the mass m and the first moment m c; joint torques stay those of the posture.

    Args:
        stance: The stance.
        data: Its arrays.
        shape: Maps the unit ball to errors of ``(m, m c)``, shape (4, 4) [kg, kg m].

    Returns:
        In units of the shape.
    """
    units, g = data.units, stance.gravity
    force = np.outer(g, shape[0])
    moment = -skew(g) @ (shape[1:] - np.outer(units.origin, shape[0]))
    B = np.vstack([force / units.force, moment / (units.force * units.length)])
    return Disturbance(B, np.zeros((len(data.torques.names), 4)), 1.0, np.eye(4))
