"""Robots: a Pinocchio model with a free flyer, what it can touch with, and what its motors can do.

Pinocchio is imported when a robot is loaded, not before.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from socp_statics.exceptions import InputError
from socp_statics.registry import nearest
from socp_statics.robots.catalogue import ROBOTS as ROBOTS
from socp_statics.robots.contact_frame import ContactFrame as ContactFrame
from socp_statics.robots.robot import Robot as Robot
from socp_statics.robots.shapes import Shape as Shape
from socp_statics.robots.urdf import robot_from_urdf as robot_from_urdf


def load_robot(name: str | Path, frames: Mapping[str, Any] | None = None, *, folder: str | Path | None = None) -> Robot:
    """A robot by its name in the catalogue, or from a URDF.

    Args:
        name: A catalogue name; or a URDF path, which ends in ``.urdf``, has a folder in it, or is a `Path`.
        frames: What the robot can touch with: contact name to `ContactFrame`, or to its keys as in ``[posture.frames]``.
            They join the contacts of a catalogue robot; one of the same name takes its place.
        folder: Where relative paths start; the working directory by default.

    Returns:
        The robot.

    Raises:
        InputError: The name is not known, the URDF is wrong, or a frame is not one of the robot; the sentence names it.
    """
    written = str(name)
    if isinstance(name, Path) or written.lower().endswith(".urdf") or "/" in written or "\\" in written:
        return robot_from_urdf(Path(folder or "") / name, frames)
    if written not in ROBOTS.names():
        message = f"robot {written!r} is not known{nearest(written, ROBOTS.names())}; a path must end in .urdf"
        raise InputError(message, name=written, field="robot")
    return ROBOTS.load(written)().with_frames(frames or {})
