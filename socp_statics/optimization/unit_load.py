"""A load of unit size whose largest multiple is asked for: a payload or a push, at a point of the robot."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from socp_statics.contacts import ExternalWrench, Stance
from socp_statics.contacts.numbers import vector
from socp_statics.exceptions import InputError
from socp_statics.spatial import Array, cross
from socp_statics.statics import StaticsData
from socp_statics.statics.joint_torques import external_torque


@dataclass(frozen=True, eq=False)
class UnitLoad:
    """What is multiplied, and where it acts.

    Attributes:
        kind: "payload" or "push".
        link: Link or frame of the robot that it acts on, None without a robot.
        point: Where it acts, world axes, shape (3,) [m].
        direction: Unit vector of the force, world axes, shape (3,).
        newtons: Force of one unit: 1 N of a push, the weight of 1 kg of a payload [N].
    """

    kind: str
    link: str | None
    point: Array
    direction: Array
    newtons: float

    @property
    def unit(self) -> str:
        """Unit of the multiple: "kg" or "N"."""
        return "kg" if self.kind == "payload" else "N"

    def wrench(self, amount: float) -> ExternalWrench:
        """The load of an amount [kg or N] as an external wrench."""
        return ExternalWrench(force=amount * self.newtons * self.direction, point=self.point, link=self.link, name=self.kind)

    def scaled(self, stance: Stance, data: StaticsData) -> tuple[Array, Array]:
        """Wrench of one scaled unit of force about the origin, and the torques it takes from the joints.

        Args:
            stance: The stance.
            data: Its arrays.

        Returns:
            P, shape (6,), and ``J_P' d``, shape (n,) (empty without a robot).
        """
        arm = (self.point - data.units.origin) / data.units.length
        P = np.concatenate([self.direction, cross(arm, self.direction)])
        if stance.posture is None:
            return P, np.zeros(0)
        one = ExternalWrench(force=self.direction, point=self.point, link=self.link)
        return P, external_torque(stance.posture, one) / data.units.length


def unit_load(stance: Stance, kind: str, link: Any, point: Any, direction: Any) -> UnitLoad:
    """A unit load, checked.

    Args:
        stance: The stance it is put on.
        kind: "payload" or "push".
        link: Link or frame of the robot, the base by default; None without a robot.
        point: Where it acts, world axes [m]; the origin of the link or frame by default.
        direction: Of a push, world axes, of any length > 0; None of a payload, which hangs along gravity.

    Raises:
        InputError: A link without a robot or an unknown one, no point without a robot, no direction, or no gravity.
    """
    if kind == "payload":
        size = float(np.linalg.norm(stance.gravity))
        if size == 0.0:
            raise InputError("a payload has no weight without gravity, a push is expected", name=kind, field=kind)
        along, newtons = stance.gravity, size
    else:
        along, newtons = vector(kind, "direction", direction, 3, kind="load"), 1.0
        if not along.any():
            raise InputError("the direction of a push must not be zero", name=kind, field=kind)
    posture = stance.posture
    if posture is None:
        if link is not None:
            raise InputError(f"link {link!r} of the {kind} needs a robot, this stance has none", name=kind, field=kind)
        if point is None:
            raise InputError(f"the point of the {kind} is missing, without a robot it is needed", name=kind, field=kind)
        at = vector(kind, "point", point, 3, kind="load")
    else:
        link = posture.robot.base if link is None else link
        try:
            _, origin = posture.link_placement(link)
        except InputError as error:
            raise InputError(f"link of the {kind}: {error}", name=str(link), field=kind) from error
        at = origin if point is None else vector(kind, "point", point, 3, kind="load")
    return UnitLoad(kind, link, at, along / np.linalg.norm(along), newtons)
