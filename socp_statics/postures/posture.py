"""A posture: a robot whose kinematics are done; holding one means that everything in it belongs to the same configuration."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.contacts import ContactSet, ExternalWrench, Stance
from socp_statics.contacts.numbers import vector
from socp_statics.contacts.stance import GRAVITY_W, as_external_wrench
from socp_statics.exceptions import InputError
from socp_statics.postures.support import checked_friction, checked_support
from socp_statics.postures.torque_limits import resolve_torque_limits
from socp_statics.postures.working_memory import working_memory
from socp_statics.robots import Robot
from socp_statics.spatial import Array, skew

UNIT_QUATERNION = 1e-6


@dataclass(frozen=True, eq=False)
class Posture:
    """A robot at rest on its contacts. Arrays are read-only.

    Attributes:
        robot: The robot.
        q: Pinocchio configuration: base position, base quaternion, joints, shape (nq,).
        angles: Joint angles in the order of ``robot.joints``, shape (n,) [rad].
        contacts: The contacts that touch, where the kinematics put them.
        com_W: Net centre of mass, shape (3,) [m].
        p_WB: Origin of the base, shape (3,) [m].
        R_WB: Orientation of the base, shape (3, 3).
        jacobian: For each contact, velocity of its frame due to joint rates with the base fixed, ``[linear; angular]`` at the
            contact's position, world axes: J_cB of full contacts, shape (6, n).
        com_jacobian: J_CB, velocity of the centre of mass due to joint rates with the base fixed, world axes, shape (3, n).
        loads: Wrenches impressed on the robot by what it holds, in balance among themselves; every stance of the posture has them, and
            they stay in the world when the robot moves.
    """

    robot: Robot
    q: Array
    angles: Array
    contacts: ContactSet
    com_W: Array
    p_WB: Array
    R_WB: Array
    jacobian: Mapping[str, Array]
    com_jacobian: Array
    loads: tuple[ExternalWrench, ...] = ()

    @property
    def support(self) -> tuple[str, ...]:
        """Names of the contacts that touch, in order."""
        return self.contacts.names

    @property
    def mass(self) -> float:
        """Mass of the robot [kg]."""
        return self.robot.mass

    @property
    def inertia_W(self) -> Array:
        """Inertia of the robot with its joints locked, about the centre of mass in world axes, shape (3, 3) [kg m^2]."""
        import pinocchio

        model = self.robot.pin_model
        data = model.createData()
        pinocchio.ccrba(model, data, self.q, np.zeros(model.nv))
        inertia: Array = data.Ig.inertia.copy()
        return inertia

    def as_record(self) -> dict[str, Any]:
        """Joint angles by name and the placement of the base: what records say of a configuration."""
        angles = dict(zip(self.robot.joints, self.angles.tolist(), strict=True))
        return {"angles": angles, "base": {"position": self.p_WB, "rotation": self.R_WB}}

    def link_placement(self, link: str) -> tuple[Array, Array]:
        """Where a link or other frame of the robot is.

        Args:
            link: Its name.

        Returns:
            ``(R_WF, p_WF)``, shapes (3, 3) and (3,) [m].

        Raises:
            InputError: The robot has no such frame.
        """
        import pinocchio

        index = self.robot.frame_id(link)
        data = self.robot.pin_model.createData()
        pinocchio.forwardKinematics(self.robot.pin_model, data, self.q)
        placement = pinocchio.updateFramePlacement(self.robot.pin_model, data, index)
        return placement.rotation.copy(), placement.translation.copy()

    def point_jacobian(self, link: str, point_W: ArrayLike) -> Array:
        """Velocity of a point of a link due to joint rates with the base fixed.

        Args:
            link: Name of the link.
            point_W: The point, world axes, shape (3,) [m].

        Returns:
            ``[linear; angular]`` in world axes, shape (6, n).

        Raises:
            InputError: The robot has no such link.
        """
        import pinocchio

        model, index = self.robot.pin_model, self.robot.frame_id(link)
        data = model.createData()
        pinocchio.computeJointJacobians(model, data, self.q)
        placement = pinocchio.updateFramePlacement(model, data, index)
        J = pinocchio.getFrameJacobian(model, data, index, pinocchio.LOCAL_WORLD_ALIGNED)[:, 6:]
        return moved_jacobian(J, np.asarray(point_W, dtype=float) - placement.translation)

    def torque_limits(self, limits: bool | Mapping[str, Any] = True) -> Array:
        """Lower and upper joint torques.

        Args:
            limits: True for the robot's own, or a mapping that overrides them: joint or pattern or "default" to a number or a pair.

        Returns:
            Shape (n, 2) [N m], infinite where there is no limit.

        Raises:
            InputError: An unknown joint, a pattern without or against another, an interval without 0, or placeholder limits.
        """
        return resolve_torque_limits(self.robot, {} if isinstance(limits, bool) else limits)

    def stance(
        self,
        gravity: Any = None,
        external_wrenches: Iterable[ExternalWrench | Mapping[str, Any]] = (),
        torque_limits: bool | Mapping[str, Any] = False,
    ) -> Stance:
        """The stance of the posture.

        Args:
            gravity: Acceleration of gravity, shape (3,) [m/s^2].
            external_wrenches: Wrenches impressed on the robot; with ``link`` on a link, else on the base.
            torque_limits: Whether forces have to respect torque limits, and which.

        Returns:
            Contacts, centre of mass, mass and loads, and the posture itself.

        Raises:
            InputError: A wrench names an unknown link, or the torque limits are wrong.
        """
        wrenches = (*self.loads, *(as_external_wrench(w) for w in external_wrenches))
        for wrench in wrenches:
            if wrench.link is not None:
                self.robot.frame_id(wrench.link)
        return Stance(
            self.contacts,
            self.com_W,
            self.mass,
            GRAVITY_W if gravity is None else gravity,
            wrenches,
            posture=self,
            torque_limits=None if torque_limits is False else self.torque_limits(torque_limits),
        )


def moved_jacobian(J: Array, arm: Array) -> Array:
    """A Jacobian ``[linear; angular]`` of a frame at a point of the same body that is ``arm`` away, shape (6, n)."""
    out = J.copy()
    out[:3] -= skew(arm) @ J[3:]
    return out


def pose(
    robot: Robot,
    q: Mapping[str, float] | ArrayLike,
    support: Sequence[str] = ("left_foot", "right_foot"),
    friction: float | Mapping[str, float] = 0.5,
    at: ArrayLike = (0.0, 0.0, 0.0),
) -> Posture:
    """Pose a robot: the first support is placed at ``at``, level; the others are where the kinematics put them.

    Args:
        robot: The robot.
        q: Joint angles by name, the others neutral; or all in the order of ``robot.joints`` [rad].
        support: Contacts of the robot that touch.
        friction: Coulomb coefficient of all of them, or by contact.
        at: Position of the first contact frame, world axes, shape (3,) [m].

    Returns:
        The posture.

    Raises:
        InputError: An unknown joint or contact, a contact named twice, an angle outside its limits, or a missing friction.
    """
    names = checked_support(robot, support)
    mu = checked_friction(robot, names, friction)
    angles = robot.angles(q)
    start = vector(robot.name, "at", at, 3, kind="robot")
    data = _from_the_base(robot, angles)
    first, F = _frame_placement(robot, data, names[0]), robot.frames[names[0]]
    R_WB = (first.rotation @ F.rotation).T
    p_WB = start - R_WB @ (first.translation + first.rotation @ F.position)
    return _placed(robot, angles, data, p_WB, R_WB, mu, {})


def posture_at(
    robot: Robot,
    q: ArrayLike,
    support: Sequence[str] = ("left_foot", "right_foot"),
    friction: float | Mapping[str, float] = 0.5,
    orientations: Mapping[str, Array] | None = None,
) -> Posture:
    """The posture of a whole configuration: base and joints.

    Args:
        robot: The robot.
        q: Pinocchio configuration: base position, base quaternion (x, y, z, w), joints, shape (nq,).
        support: Contacts of the robot that touch, where the kinematics put them.
        friction: Coulomb coefficient of all of them, or by contact.
        orientations: ``R_WC`` of contacts at a point by name, where what they touch decides it and not the link, shape (3, 3).

    Returns:
        The posture.

    Raises:
        InputError: An unknown contact, a contact named twice, an angle outside its limits, a missing friction, or no configuration.
    """
    names = checked_support(robot, support)
    mu = checked_friction(robot, names, friction)
    configuration = vector(robot.name, "q", q, robot.pin_model.nq, kind="robot")
    quaternion = configuration[3:7]
    if abs(float(quaternion @ quaternion) - 1.0) > UNIT_QUATERNION:
        message = f"robot '{robot.name}': q[3:7] must be a unit quaternion (x, y, z, w), got {quaternion.tolist()}"
        raise InputError(message, name=robot.name, field="q")
    robot.angles(robot.joint_angles(configuration))
    return configured(robot, configuration, mu, orientations or {})


def configured(robot: Robot, q: Array, friction: Mapping[str, float], orientations: Mapping[str, Array]) -> Posture:
    """The posture of a configuration that needs no check; its joints may be outside their limits, as on the way of an iteration.

    Args:
        robot: The robot.
        q: Pinocchio configuration, shape (nq,).
        friction: Coulomb coefficient of each contact that touches.
        orientations: As in `posture_at`.

    Returns:
        The posture.
    """
    import pinocchio

    angles = robot.joint_angles(q)
    R_WB = pinocchio.Quaternion(*np.roll(q[3:7], 1)).toRotationMatrix()
    return _placed(robot, angles, _from_the_base(robot, angles), np.array(q[:3]), R_WB, friction, orientations)


def _from_the_base(robot: Robot, angles: Array) -> Any:
    """Joint placements, Jacobians and centre of mass with the base at the origin."""
    import pinocchio

    data, configuration = working_memory(robot), robot.configuration(angles)
    pinocchio.computeJointJacobians(robot.pin_model, data, configuration)
    pinocchio.jacobianCenterOfMass(robot.pin_model, data, configuration)
    return data


def _frame_placement(robot: Robot, data: Any, contact: str) -> Any:
    import pinocchio

    frame = robot.frames[contact]
    return pinocchio.updateFramePlacement(robot.pin_model, data, robot.frame_id(frame.frame, contact))


def _placed(
    robot: Robot, angles: Array, data: Any, p_WB: Array, R_WB: Array, friction: Mapping[str, float], orientations: Mapping[str, Array]
) -> Posture:
    """The posture whose kinematics were done with the base at the origin, moved to where the base is."""
    import pinocchio

    contacts, jacobian = [], {}
    for name, mu in friction.items():
        frame, placement = robot.frames[name], _frame_placement(robot, data, name)
        R_WF, p_WF = R_WB @ placement.rotation, p_WB + R_WB @ placement.translation
        contacts.append(frame.contact(R_WF, p_WF, mu, orientations.get(name)))
        index = robot.frame_id(frame.frame, name)
        J = pinocchio.getFrameJacobian(robot.pin_model, data, index, pinocchio.LOCAL_WORLD_ALIGNED)[:, 6:]
        J_W = (R_WB @ J.reshape(2, 3, -1)).reshape(6, -1)
        jacobian[name] = _fixed(moved_jacobian(J_W, R_WF @ frame.position))
    return Posture(
        robot=robot,
        q=_fixed(robot.configuration(angles, p_WB, R_WB)),
        angles=_fixed(angles),
        contacts=ContactSet(contacts),
        com_W=_fixed(p_WB + R_WB @ data.com[0]),
        p_WB=_fixed(p_WB),
        R_WB=_fixed(R_WB),
        jacobian=jacobian,
        com_jacobian=_fixed(R_WB @ data.Jcom[:, 6:]),
    )


def _fixed(array: Array) -> Array:
    array.setflags(write=False)
    return array
