"""How much of its motor each joint uses: joint torques against their limits, out of a record or two mappings."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from socp_statics.exceptions import InputError
from socp_statics.registry import nearest

NOTHING = 1e-9


class JointTorque(NamedTuple):
    """The torque of a joint and the limit on its side.

    Attributes:
        joint: Name of the joint.
        torque: The torque [N m].
        limit: The limit in the direction of the torque, lower <= 0 or upper >= 0; the upper one where the torque is nothing;
            infinite where there is none [N m].
    """

    joint: str
    torque: float
    limit: float

    @property
    def limited(self) -> bool:
        """Whether the motor has a limit in this direction."""
        return bool(np.isfinite(self.limit))

    @property
    def share(self) -> float | None:
        """Torque over limit, >= 0: at most 1 where the limit is kept; None without a limit; inf against a limit of zero."""
        if not self.limited:
            return None
        if self.limit == 0.0:
            return 0.0 if abs(self.torque) <= NOTHING else float("inf")
        return self.torque / self.limit


def torque_uses(torques: Mapping[str, Any], torque_limits: Mapping[str, Any] | None = None) -> list[JointTorque]:
    """The torque of each joint and the limit on its side.

    Args:
        torques: A record or other mapping with "torques" and, where there are limits, "torque_limits"; or joint name to torque [N m].
        torque_limits: Joint name to (lower, upper) [N m], infinite where there is no limit; those of the record by default.

    Returns:
        One entry a joint, in the order of the torques.

    Raises:
        InputError: There are no torques, something is not a number, or there is a limit for a joint without a torque.
    """
    if "torques" in torques:
        limits = torque_limits or torques.get("torque_limits") or {}
        torques = torques["torques"] or {}
    else:
        limits = torque_limits or {}
    if not torques:
        raise InputError("draw_torques: there are no joint torques, a record of a robot's answer is expected", name="draw_torques",
                         field="torques")  # fmt: skip
    for joint in limits:
        if joint not in torques:
            message = f"draw_torques: there is a torque limit for joint '{joint}', which has no torque{nearest(joint, torques)}"
            raise InputError(message, name=joint, field="torque_limits")
    out = []
    for joint, torque in torques.items():
        tau = _number(joint, "torque", torque)
        pair = limits.get(joint, (-np.inf, np.inf))
        if isinstance(pair, str) or np.ndim(pair) != 1 or len(pair) != 2:
            message = f"draw_torques: the torque limits of joint '{joint}' must be (lower, upper), got {pair!r}"
            raise InputError(message, name=joint, field="torque_limits")
        lower, upper = (_number(joint, "torque limit", end) for end in pair)
        if not lower <= 0.0 <= upper:
            message = f"draw_torques: the torque limits of joint '{joint}' must hold 0, got [{lower:g}, {upper:g}]"
            raise InputError(message, name=joint, field="torque_limits")
        out.append(JointTorque(joint, tau, lower if tau < -NOTHING else upper))
    return out


def _number(joint: str, what: str, value: Any) -> float:
    try:
        number = float(value)
    except (TypeError, ValueError):
        number = float("nan")
    if np.isnan(number) or (what == "torque" and np.isinf(number)):
        raise InputError(f"draw_torques: the {what} of joint '{joint}' must be a number, got {value!r}", name=joint, field="torques")
    return number
