"""A robot: a Pinocchio model with a free flyer, its contact frames, its joint and torque limits."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.contacts.numbers import scalar
from socp_statics.exceptions import InputError
from socp_statics.registry import nearest
from socp_statics.robots.contact_frame import ContactFrame
from socp_statics.robots.shapes import Shape
from socp_statics.spatial import Array

ANGLE_TOLERANCE = 1e-9
UNLIMITED = 1e300
PLACEHOLDER_EVERYWHERE, PLACEHOLDER_FROM = 100.0, 1000.0
WORLD_AXES = np.eye(3)
ORIGIN = np.zeros(3)


class Robot:
    """A robot that can be posed; not to be changed after it was made.

    Joint vectors have one entry for each actuated joint, in the order of `joints`, which is the order of Pinocchio: entry k belongs to
    velocity index ``6 + k`` of the model. An angle is a length [m] and a torque a force [N] where the joint is prismatic.

    Attributes:
        name: Its name.
        pin_model: The Pinocchio model; joint 1 is the free flyer. Joints that mimic others have no velocity of their own.
        joints: Names of the actuated joints.
        base: Name of the frame of the free flyer: the root link.
        frames: Contact name to `ContactFrame`.
        lower: Least joint angles, shape (n,) [rad]; -inf for a continuous joint.
        upper: Largest joint angles, shape (n,) [rad].
        neutral: The zero pose, moved inside the joint limits, shape (n,) [rad].
        reference: A posture with bent limbs from which inverse kinematics starts and to which it keeps near, shape (n,) [rad].
        torque_limits: Lower and upper joint torque of the model, shape (n, 2) [N m].
        placeholder_joints: Joints whose torque limits are not those of a motor: 0, the same 100 on every joint, 1000 and more, an interval
            without 0, or all joints where ``torque_limits_real=False`` was given.
        torque_limits_real: Whether there is no placeholder joint.
        torque_limits_note: Why the torque limits are not real, where it is known.
        mass: Mass [kg].
        source: Where its numbers come from.
        licence: Licence of the model.
        shapes: Primitive shapes for drawing and viewing, fixed to links.
        urdf_file: The URDF it was read from, None where there is none; its meshes are looked for from there when somebody views it.
        digest: SHA-256 of the model's text and its contact frames.
    """

    def __init__(
        self,
        pin_model: Any,
        frames: Mapping[str, Any],
        *,
        name: str,
        source: str,
        licence: str,
        content: bytes,
        shapes: Iterable[Shape] = (),
        urdf_file: Path | None = None,
        torque_limits_real: bool = True,
        torque_limits_note: str = "",
        reference: Mapping[str, float] | None = None,
    ):
        import pinocchio

        self.name, self.source, self.licence = name, source, licence
        self.pin_model, self.shapes = pin_model, tuple(shapes)
        self.urdf_file = urdf_file
        self._read_joints()
        self.mass = float(pinocchio.computeTotalMass(pin_model))
        if not 0.0 < self.mass < np.inf:
            raise InputError(f"robot '{name}': its mass must be a finite number > 0, got {self.mass:g} kg", name=name, field="mass")
        self._read_torque_limits(torque_limits_real)
        self.torque_limits_note = torque_limits_note
        self._frame_ids = {frame.name: index for index, frame in reversed(list(enumerate(pin_model.frames))) if index}
        self._frame_ids |= {f.name: i for i, f in enumerate(pin_model.frames) if f.type == pinocchio.FrameType.BODY}
        bodies = [f.name for f in pin_model.frames if f.type == pinocchio.FrameType.BODY and f.parentJoint == 1]
        self.base = bodies[0] if bodies else pin_model.names[1]
        self._content = content
        self.reference = self.angles(reference or {})
        self.reference.setflags(write=False)
        self._set_frames(frames)

    @classmethod
    def from_pinocchio(
        cls,
        pin_model: Any,
        frames: Mapping[str, Any] | None = None,
        *,
        name: str | None = None,
        source: str = "a Pinocchio model",
        licence: str = "not stated",
        torque_limits_real: bool = True,
    ) -> Robot:
        """A robot from a Pinocchio model whose first joint is a free flyer; the model is copied.

        Args:
            pin_model: The ``pinocchio.Model``.
            frames: What the robot can touch with: contact name to `ContactFrame`, or to its keys as in ``[posture.frames]``.
            name: Name of the robot; the model's by default.
            source: Where the numbers come from.
            licence: Licence of the model.
            torque_limits_real: False where the effort limits are known not to be those of the motors.

        Returns:
            The robot.

        Raises:
            InputError: There is no free flyer, a joint has several degrees of freedom, or a frame is not one of the model.
        """
        model = pin_model.copy()
        content = model.saveToString().encode()
        return cls(model, frames or {}, name=name or model.name or "robot", source=source, licence=licence, content=content,
                   torque_limits_real=torque_limits_real)  # fmt: skip

    def __repr__(self) -> str:
        return f"Robot({self.name!r}, {len(self.joints)} joints, {self.mass:g} kg, contacts: {', '.join(self.frames) or 'none'})"

    def _wrong(self, joint: str, sentence: str, field: str = "joint") -> InputError:
        return InputError(f"robot '{self.name}': joint '{joint}' {sentence}", name=joint, field=field)

    def _read_joints(self) -> None:
        model = self.pin_model
        types = [joint.shortname() for joint in model.joints]
        if len(types) < 2 or types[1] != "JointModelFreeFlyer" or not model.jointPlacements[1].isIdentity(1e-12):
            got = types[1] if len(types) > 1 else "none"
            message = f"robot '{self.name}': the first joint of the model must be a free flyer at the origin, got {got}"
            raise InputError(message, name=self.name, field="pin_model")
        actuated = []
        for index in range(2, model.njoints):
            joint = model.joints[index]
            if model.parents[index] == 0:
                raise self._wrong(model.names[index], "is fixed to the world, every joint must be carried by the free flyer")
            if "Mimic" in types[index]:
                continue
            if joint.nv != 1:
                raise self._wrong(model.names[index], f"must have one degree of freedom, got {joint.nv} ({types[index]})")
            actuated.append(index)
        self.joints: tuple[str, ...] = tuple(model.names[index] for index in actuated)
        self._index = {joint: k for k, joint in enumerate(self.joints)}
        self._units = ["m" if types[index].startswith("JointModelP") else "rad" for index in actuated]
        self._idx_q = np.array([model.joints[index].idx_q for index in actuated], dtype=int)
        unbounded = np.array([model.joints[index].nq == 2 for index in actuated], dtype=bool)
        self._turning = np.flatnonzero(unbounded)
        lower, upper = (_without_limit(end[self._idx_q]) for end in (model.lowerPositionLimit, model.upperPositionLimit))
        self.lower, self.upper = np.where(unbounded, -np.inf, lower), np.where(unbounded, np.inf, upper)
        for joint, lo, hi in zip(self.joints, self.lower, self.upper, strict=True):
            if not lo <= hi:
                raise self._wrong(joint, f"has a lower limit {lo:g} above its upper limit {hi:g}")
        self.neutral = np.clip(np.zeros(len(self.joints)), self.lower, self.upper)
        for array in (self.lower, self.upper, self.neutral):
            array.setflags(write=False)

    def _read_torque_limits(self, real: bool) -> None:
        ends = [_without_limit(end[6:]) for end in (self.pin_model.lowerEffortLimit, self.pin_model.upperEffortLimit)]
        limits = np.column_stack(ends)
        size = np.abs(limits).max(axis=1, initial=0.0)
        doubtful = (size == 0.0) | (size >= PLACEHOLDER_FROM) | ~((limits[:, 0] <= 0.0) & (limits[:, 1] >= 0.0))
        if not real or (np.abs(limits) == PLACEHOLDER_EVERYWHERE).all():
            doubtful[:] = True
        limits.setflags(write=False)
        self.torque_limits = limits
        self.placeholder_joints = tuple(joint for joint, no in zip(self.joints, doubtful, strict=True) if no)
        self.torque_limits_real = not self.placeholder_joints

    def _set_frames(self, frames: Mapping[str, Any]) -> None:
        self.frames: dict[str, ContactFrame] = {}
        for name, given in frames.items():
            frame = given if isinstance(given, ContactFrame) else ContactFrame.from_statement(name, given)
            if frame.name != name:
                raise InputError(f"contact '{name}': its frame is named '{frame.name}'", name=name, field="name")
            self.frame_id(frame.frame, name)
            self.frames[name] = frame
        stated = json.dumps({name: frame.statement() for name, frame in self.frames.items()}, sort_keys=True)
        self.digest = hashlib.sha256(hashlib.sha256(self._content).digest() + stated.encode()).hexdigest()

    def with_frames(self, frames: Mapping[str, Any]) -> Robot:
        """The same robot with more contact frames; one of the same name takes the place of the old one.

        Args:
            frames: Contact name to `ContactFrame`, or to its keys as in ``[posture.frames]``.

        Raises:
            InputError: A frame is not one of the robot, or its keys are wrong.
        """
        if not frames:
            return self
        other = object.__new__(Robot)
        other.__dict__.update(self.__dict__)
        other._set_frames({**self.frames, **frames})
        return other

    def with_masses(self, masses: Mapping[str, float]) -> Robot:
        """The same robot with point masses at its contact frames, for example halves of an object in its hands.

        Args:
            masses: Contact name to mass >= 0 [kg].

        Raises:
            InputError: An unknown contact, or a mass that is not a finite number >= 0.
        """
        import pinocchio

        model, content = self.pin_model.copy(), self._content
        for contact, given in masses.items():
            frame, mass = self.contact_frame(contact), scalar(contact, "mass", given, least=0.0)
            carrier = model.frames[self.frame_id(frame.frame, contact)]
            point = carrier.placement.act(np.array(frame.position))
            model.appendBodyToJoint(carrier.parentJoint, pinocchio.Inertia(mass, point, np.zeros((3, 3))), pinocchio.SE3.Identity())
            content += f"{contact} {mass!r}".encode()
        other = object.__new__(Robot)
        other.__dict__.update(self.__dict__)
        other.pin_model, other._content = model, content
        other.mass = float(pinocchio.computeTotalMass(model))
        other._set_frames(self.frames)
        return other

    def frame_id(self, frame: str, contact: str | None = None) -> int:
        """Index of a link, joint or other frame in ``pin_model.frames``; a link comes before a joint of the same name.

        Args:
            frame: Its name.
            contact: The contact it is looked up for, for the error sentence.

        Raises:
            InputError: The robot has no such frame; the sentence offers near names.
        """
        if frame not in self._frame_ids:
            subject = f"robot '{self.name}'" if contact is None else f"contact '{contact}'"
            what = f"frame {frame!r} is not a link or frame of the robot '{self.name}'{nearest(str(frame), self._frame_ids)}"
            raise InputError(f"{subject}: {what}", name=contact or self.name, field="frame")
        return self._frame_ids[frame]

    def contact_frame(self, name: str) -> ContactFrame:
        """The contact frame of that name.

        Raises:
            InputError: The robot has none; the sentence offers near names.
        """
        if name not in self.frames:
            has = nearest(str(name), self.frames) or ", it has no contact frames"
            raise InputError(f"robot '{self.name}': {name!r} is not one of its contacts{has}", name=str(name), field="support")
        return self.frames[name]

    def joint_index(self, joint: str, field: str = "angles") -> int:
        """Place of a joint in joint vectors.

        Args:
            joint: Its name.
            field: The key it was written in.

        Raises:
            InputError: The robot has no such joint; the sentence offers near names.
        """
        if joint not in self._index:
            raise InputError(f"robot '{self.name}': {joint!r} is not one of its joints{nearest(str(joint), self.joints)}",
                             name=str(joint), field=field)  # fmt: skip
        return self._index[joint]

    def angles(self, angles: Mapping[str, float] | ArrayLike) -> Array:
        """Joint angles, checked.

        Args:
            angles: Joint name to angle, the others neutral; or all of them, shape (n,) [rad].

        Returns:
            Shape (n,), in the order of `joints` [rad].

        Raises:
            InputError: An unknown joint, a wrong number of angles, or an angle that is not finite or outside the limits of its joint.
        """
        if isinstance(angles, Mapping):
            result = self.neutral.copy()
            for joint, angle in angles.items():
                result[self.joint_index(joint)] = scalar(joint, "angle", angle, kind="joint")
        else:
            try:
                result = np.array(angles, dtype=float)
            except (TypeError, ValueError) as error:
                raise InputError(f"robot '{self.name}': angles must be numbers, got {angles!r}", name=self.name, field="angles") from error
            if result.shape != (len(self.joints),):
                message = f"robot '{self.name}': angles must be {len(self.joints)} numbers, one a joint, got shape {result.shape}"
                raise InputError(message, name=self.name, field="angles")
        inside = (result >= self.lower - ANGLE_TOLERANCE) & (result <= self.upper + ANGLE_TOLERANCE) & np.isfinite(result)
        if not inside.all():
            k = int(np.argmin(inside))
            limits = f"between {self.lower[k]:g} and {self.upper[k]:g} {self._units[k]}"
            raise self._wrong(self.joints[k], f"must have a finite angle {limits}, got {result[k]:g}", field="angles")
        return result

    def configuration(self, angles: Array, p_WB: Array = ORIGIN, R_WB: Array = WORLD_AXES) -> Array:
        """The configuration vector of the Pinocchio model.

        Args:
            angles: Joint angles as `angles` returns them, shape (n,) [rad].
            p_WB: Origin of the base, world axes, shape (3,) [m].
            R_WB: Orientation of the base, shape (3, 3).

        Returns:
            Base position, base quaternion (x, y, z, w), then the joints, shape (nq,); a continuous joint takes two entries (cos, sin).
        """
        import pinocchio

        q = np.empty(self.pin_model.nq)
        q[:3] = p_WB
        q[3:7] = pinocchio.Quaternion(np.asarray(R_WB, dtype=float)).coeffs()
        q[self._idx_q] = angles
        if len(self._turning):
            at, turned = self._idx_q[self._turning], np.asarray(angles)[self._turning]
            q[at], q[at + 1] = np.cos(turned), np.sin(turned)
        return q

    def joint_angles(self, q: Array) -> Array:
        """The joint angles of a configuration vector, the inverse of `configuration`.

        Args:
            q: Configuration of the Pinocchio model, shape (nq,).

        Returns:
            Shape (n,) [rad]; of a continuous joint between -pi and pi.
        """
        angles = np.asarray(q, dtype=float)[self._idx_q]
        if len(self._turning):
            at = self._idx_q[self._turning]
            angles[self._turning] = np.arctan2(q[at + 1], q[at])
        return angles


def _without_limit(ends: Array) -> Array:
    """The limits with Pinocchio's largest number read as infinity."""
    return np.where(np.abs(ends) >= UNLIMITED, np.copysign(np.inf, ends), ends)
