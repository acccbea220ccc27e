"""Where contacts, base and centre of mass are to be: what inverse kinematics is asked for, checked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from socp_statics.contacts.numbers import vector
from socp_statics.contacts.orientation import contact_rotation
from socp_statics.exceptions import InputError
from socp_statics.robots import Robot
from socp_statics.spatial import Array


@dataclass(frozen=True, eq=False)
class Placement:
    """Where a contact is to touch.

    Attributes:
        position: Origin of the contact frame, world axes, shape (3,) [m].
        rotation: ``R_WC`` of the contact, shape (3, 3); None where only the position is asked for.
        fixed: How much of the orientation of the robot's contact frame has to be that of ``rotation``: ``"all"`` (surfaces and
            lines), ``"normal"``, or ``"nothing"``.
    """

    position: Array
    rotation: Array | None
    fixed: str


def read_placements(robot: Robot, placements: Mapping[str, Any], aligned: Sequence[str] = ()) -> dict[str, Placement]:
    """Placements as they are written, checked.

    Args:
        robot: The robot.
        placements: Contact name to its position [m] alone, or to ``(position, orientation)``; the orientation is a normal, shape (3,), a
            rotation ``R_WC``, shape (3, 3), or None. Surfaces and lines are level by default. Of a contact at a point the
            orientation says what it touches and leaves the link free; without one the link decides.
        aligned: Contacts at a point whose own normal has to point along the one they are given.

    Returns:
        Contact name to placement, in order.

    Raises:
        InputError: No or an unknown contact, a wrong number, or a contact in ``aligned`` that is not at a point with a normal.
    """
    if not isinstance(placements, Mapping) or not placements:
        message = f"robot '{robot.name}': placements must name at least one contact and its place, got {placements!r}"
        raise InputError(message, name=robot.name, field="placements")
    read = {name: _placement(robot, name, given, name in aligned) for name, given in placements.items()}
    for name in aligned:
        if name not in read or read[name].fixed != "normal":
            message = f"contact '{name}': aligned names contacts at a point that are placed with a normal"
            raise InputError(message, name=str(name), field="aligned")
    return read


def _placement(robot: Robot, name: str, given: Any, aligned: bool) -> Placement:
    frame = robot.contact_frame(name)
    pair = isinstance(given, Sequence) and len(given) == 2
    position, orientation = given if pair else (given, None)
    position = vector(name, "position", position, 3)
    if orientation is not None:
        as_matrix = np.ndim(orientation) == 2
        rotation = contact_rotation(name, orientation if as_matrix else None, None if as_matrix else orientation, None)
    elif frame.at_a_point:
        return Placement(position, None, "nothing")
    else:
        rotation = np.eye(3)
    return Placement(position, rotation, ("normal" if aligned else "nothing") if frame.at_a_point else "all")


def read_com(com: Any) -> Array | None:
    """The centre of mass asked for: (x, y) or (x, y, z) [m], or None.

    Raises:
        InputError: Neither two nor three finite numbers.
    """
    return None if com is None else vector("com", "com", com, 2 if np.size(com) == 2 else 3, kind="target")


def read_base(base: Any) -> Placement | None:
    """The base asked for: its position [m], or ``(position, R_WB)``, or None.

    Raises:
        InputError: A wrong number or no rotation.
    """
    if base is None:
        return None
    pair = isinstance(base, Sequence) and len(base) == 2
    position, rotation = base if pair else (base, None)
    position = vector("base", "base", position, 3, kind="target")
    if rotation is None:
        return Placement(position, None, "nothing")
    return Placement(position, contact_rotation("base", rotation, None, None), "all")
