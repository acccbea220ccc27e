"""Which torques the joints may have: the model's limits, overridden by name, by pattern, by default."""

from __future__ import annotations

from collections.abc import Mapping
from fnmatch import fnmatchcase
from typing import Any

import numpy as np

from socp_statics.contacts.numbers import interval
from socp_statics.exceptions import InputError
from socp_statics.registry import nearest
from socp_statics.robots import Robot
from socp_statics.spatial import Array

WILD = "*?["


def resolve_torque_limits(robot: Robot, limits: Mapping[str, Any]) -> Array:
    """Torque limits of all joints.

    Args:
        robot: The robot.
        limits: Joint, pattern or "default" to a number t, meaning [-t, t], or to ``[lower, upper]`` [N m]. An exact name beats a pattern,
            a pattern beats the default, the default beats the model; infinite means unlimited.

    Returns:
        Lower and upper torques, shape (n, 2) [N m].

    Raises:
        InputError: An unknown joint, a pattern that matches nothing, two patterns on one joint, an interval without 0, or joints left
            with limits that are placeholders of the model.
    """
    ends = {key: _ends(robot, key, value) for key, value in limits.items()}
    exact = {key: value for key, value in ends.items() if key != "default" and not any(c in key for c in WILD)}
    for key in exact:
        if key not in robot.joints:
            message = f"robot '{robot.name}': torque limits name {key!r}, which is not one of its joints{nearest(key, robot.joints)}"
            raise InputError(message, name=key, field="torque_limits")
    patterns = [key for key in ends if any(c in key for c in WILD)]
    matches = {key: [joint for joint in robot.joints if fnmatchcase(joint, key)] for key in patterns}
    for key, joints in matches.items():
        if not joints:
            known = f"; its joints are {', '.join(robot.joints)}"
            message = f"robot '{robot.name}': the torque limit pattern {key!r} matches no joint{known}"
            raise InputError(message, name=key, field="torque_limits")
    out = np.empty((len(robot.joints), 2))
    left = []
    for k, joint in enumerate(robot.joints):
        mine = [key for key in patterns if joint in matches[key]]
        if joint in exact:
            out[k] = exact[joint]
        elif len(mine) > 1:
            message = f"robot '{robot.name}': joint '{joint}' has torque limits from two patterns, {mine[0]!r} and {mine[1]!r}"
            raise InputError(message, name=joint, field="torque_limits")
        elif mine:
            out[k] = ends[mine[0]]
        elif "default" in ends:
            out[k] = ends["default"]
        else:
            out[k] = robot.torque_limits[k]
            if joint in robot.placeholder_joints:
                left.append(joint)
    if left:
        note = f" ({robot.torque_limits_note})" if robot.torque_limits_note else ""
        message = (
            f"robot '{robot.name}': the torque limits of {', '.join(left)} are placeholders{note}; give limits of your own, "
            "for example default = inf and one for each motor in question"
        )
        raise InputError(message, name=left[0], field="torque_limits")
    out.setflags(write=False)
    return out


def _ends(robot: Robot, key: str, value: Any) -> tuple[float, float]:
    if isinstance(value, int | float) and not isinstance(value, bool):
        value = (-value, value)
    lower, upper = interval(key, "torque_limits", value, kind="joint")
    if lower > 0.0 or upper < 0.0:
        message = f"robot '{robot.name}': torque limits of {key!r} must be lower <= 0 <= upper, got [{lower:g}, {upper:g}] N m"
        raise InputError(message, name=key, field="torque_limits")
    return lower, upper
