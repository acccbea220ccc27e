"""A robot from a URDF: checked, then given to Pinocchio with a free flyer."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from socp_statics.exceptions import InputError
from socp_statics.robots.mechanism import above_leaders, bare_text, check_mechanism
from socp_statics.robots.robot import Robot
from socp_statics.robots.shapes import primitive_shapes
from socp_statics.robots.urdf_text import UrdfText, read_urdf


def robot_from_urdf(
    path: str | Path,
    frames: Mapping[str, Any] | None = None,
    *,
    name: str | None = None,
    source: str | None = None,
    licence: str = "not stated",
    torque_limits_real: bool = True,
    torque_limits_note: str = "",
    reference: Mapping[str, float] | None = None,
) -> Robot:
    """A robot from a URDF.

    Joints are revolute, continuous (no limits), prismatic (its angle is a length [m], its torque a force [N]) or fixed. A mimic joint
    is not a joint of its own: it follows its leader, whose torque carries both. Meshes are opened only by the 3-D view.

    Args:
        path: The URDF.
        frames: What the robot can touch with: contact name to `ContactFrame`, or to its keys as in ``[posture.frames]``.
        name: Name of the robot; the URDF's by default.
        source: Where the numbers come from; the file by default.
        licence: Licence of the URDF.
        torque_limits_real: False where the effort limits are known not to be those of the motors.
        torque_limits_note: Why.
        reference: Joint angles from which inverse kinematics starts, the others neutral; all neutral by default [rad].

    Returns:
        The robot.

    Raises:
        InputError: The file cannot be read or is wrong; the sentence names the file and the element.
    """
    urdf = read_urdf(path)
    check_mechanism(urdf)
    return Robot(
        _pin_model(urdf),
        frames or {},
        name=name or urdf.root.get("name") or Path(path).stem,
        source=source or f"the URDF {path}",
        licence=licence,
        content=urdf.text,
        shapes=primitive_shapes(urdf),
        urdf_file=Path(path),
        torque_limits_real=torque_limits_real,
        torque_limits_note=torque_limits_note,
        reference=reference,
    )


def _pin_model(urdf: UrdfText) -> Any:
    """The Pinocchio model; where a leader would come after the joint that mimics it, its branch is put first."""
    leaders = above_leaders(urdf)
    try:
        return _build(urdf, frozenset())
    except InputError:
        if not leaders:
            raise
    model = _build(urdf, leaders)
    for leader in leaders:
        # a fixed joint above a leader is a frame of the model and no joint
        if model.existJointName(f"!{leader}"):
            model.names[model.getJointId(f"!{leader}")] = leader
        model.frames[model.getFrameId(f"!{leader}")].name = leader
    return model


def _build(urdf: UrdfText, first: frozenset[str]) -> Any:
    import pinocchio

    try:
        return pinocchio.buildModelFromXML(bare_text(urdf, first), pinocchio.JointModelFreeFlyer(), True)
    except (ValueError, RuntimeError) as error:
        reason = " ".join(str(error).split()) or "no reason given"
        raise urdf.wrong("<robot>", f"is refused by Pinocchio ({reason})") from error
