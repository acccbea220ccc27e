"""A posture: a robot whose kinematics are done; holding one means that everything in it belongs to the same configuration."""

from __future__ import annotations

import threading
import weakref
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.contacts import ContactSet, ExternalWrench, Stance
from socp_statics.contacts.numbers import vector
from socp_statics.contacts.stance import GRAVITY_W, as_external_wrench
from socp_statics.exceptions import InputError
from socp_statics.postures.torque_limits import resolve_torque_limits
from socp_statics.robots import Robot
from socp_statics.spatial import Array, skew


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

    @property
    def support(self) -> tuple[str, ...]:
        """Names of the contacts that touch, in order."""
        return self.contacts.names

    @property
    def mass(self) -> float:
        """Mass of the robot [kg]."""
        return self.robot.mass

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
        wrenches = tuple(as_external_wrench(w) for w in external_wrenches)
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
    import pinocchio

    names = _checked_support(robot, support)
    mu = _checked_friction(robot, names, friction)
    angles = robot.angles(q)
    start = vector(robot.name, "at", at, 3, kind="robot")
    model, data = robot.pin_model, _scratch(robot)
    configuration = robot.configuration(angles)
    pinocchio.computeJointJacobians(model, data, configuration)
    com_jacobian = pinocchio.jacobianCenterOfMass(model, data, configuration)[:, 6:]
    com_B = data.com[0]

    frames = [robot.frames[name] for name in names]
    ids = [robot.frame_id(frame.frame, frame.name) for frame in frames]
    placements = [pinocchio.updateFramePlacement(model, data, index) for index in ids]
    first, F = placements[0], frames[0]
    R_WB = (first.rotation @ F.rotation).T
    p_WB = start - R_WB @ (first.translation + first.rotation @ F.position)
    contacts, jacobian = [], {}
    for frame, index, placement in zip(frames, ids, placements, strict=True):
        R_WF, p_WF = R_WB @ placement.rotation, p_WB + R_WB @ placement.translation
        contacts.append(frame.contact(R_WF, p_WF, mu[frame.name]))
        J = pinocchio.getFrameJacobian(model, data, index, pinocchio.LOCAL_WORLD_ALIGNED)[:, 6:]
        J_W = (R_WB @ J.reshape(2, 3, -1)).reshape(6, -1)
        J_W[:3] -= skew(R_WF @ frame.position) @ J_W[3:]
        jacobian[frame.name] = _fixed(J_W)
    return Posture(
        robot=robot,
        q=_fixed(robot.configuration(angles, p_WB, R_WB)),
        angles=_fixed(angles),
        contacts=ContactSet(contacts),
        com_W=_fixed(p_WB + R_WB @ com_B),
        p_WB=_fixed(p_WB),
        R_WB=_fixed(R_WB),
        jacobian=jacobian,
        com_jacobian=_fixed(R_WB @ com_jacobian),
    )


_SCRATCH = threading.local()


def _scratch(robot: Robot) -> Any:
    """Pinocchio's working memory for a robot, one a thread: making it costs more than the kinematics."""
    kept = _SCRATCH.__dict__.setdefault("of", weakref.WeakKeyDictionary())
    if robot not in kept:
        kept[robot] = robot.pin_model.createData()
    return kept[robot]


def _fixed(array: Array) -> Array:
    array.setflags(write=False)
    return array


def _checked_support(robot: Robot, support: Sequence[str]) -> tuple[str, ...]:
    names = (support,) if isinstance(support, str) else tuple(support)
    if not names:
        raise InputError(f"robot '{robot.name}': support must name at least one contact", name=robot.name, field="support")
    for name in names:
        robot.contact_frame(name)
        if names.count(name) > 1:
            raise InputError(f"robot '{robot.name}': support names {name!r} twice", name=name, field="support")
    return names


def _checked_friction(robot: Robot, names: tuple[str, ...], friction: float | Mapping[str, float]) -> dict[str, float]:
    if not isinstance(friction, Mapping):
        return dict.fromkeys(names, friction)
    for name in friction:
        if name not in names:
            message = f"robot '{robot.name}': friction names {name!r}, which is not in support ({', '.join(names)})"
            raise InputError(message, name=str(name), field="friction")
    for name in names:
        if name not in friction:
            raise InputError(f"robot '{robot.name}': friction of {name!r} is missing", name=name, field="friction")
    return dict(friction)
