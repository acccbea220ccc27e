"""How the margin changes when the robot moves: its gradient from the multipliers of one conic program.

The margin is the value of a program whose data depend on the posture. Where its multipliers are unique, the derivative of the value is
the derivative of the Lagrangian at the forces and multipliers of the optimum: minus the power, on the motion that the multipliers are,
of how the loads change.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from socp_statics.certificates import Motion, motion_of
from socp_statics.certificates.faces import optimal_faces
from socp_statics.certificates.optimum import Multipliers
from socp_statics.cones.choice import ConeChoice, cone_choice
from socp_statics.contacts import ExternalWrench, Stance
from socp_statics.contacts.stance import stance_of
from socp_statics.spatial import Array, cross
from socp_statics.stability.margin import normal_force_margin
from socp_statics.statics import StaticsData, assemble
from socp_statics.statics.contact_wrenches import contact_wrenches
from socp_statics.statics.static_derivatives import StaticDerivatives

# How far a derivative may vary over the optimal forces and multipliers and still count as unique, relative to 1 + its size.
SMALL = 1e-6


@dataclass(frozen=True, eq=False)
class MarginGradient:
    """Derivatives of the normal-force margin.

    Attributes:
        margin: The margin [N].
        tangent: Along the tangent of the configuration, contact frames riding on their links: base linear and angular in base axes, then
            the joints, shape (nv,) [N/m, N/rad]; None without a robot.
        com: With respect to the centre of mass alone, world axes, shape (3,) [N/m].
        positions: With respect to each contact's position alone, the robot as it is, world axes, shape (3,) each [N/m].
        rotations: With respect to a rotation of each contact frame about its position alone, world axes, shape (3,) each [N/rad].
        unique: For "com", "positions", "rotations", "tangent": whether the margin is known to be differentiable there. Where forces or
            multipliers are not unique the numbers are one subgradient of many.
        kinks: How ``tangent`` changes along the optimal forces and multipliers, shape (k, nv): the margin is differentiable along
            every direction v with ``kinks @ v = 0``. None without a robot or where nothing is known.
    """

    margin: float
    tangent: Array | None
    com: Array
    positions: dict[str, Array]
    rotations: dict[str, Array]
    unique: dict[str, bool]
    kinks: Array | None


def margin_gradient(
    contacts: Any,
    com: Any = None,
    mass: float | None = None,
    *,
    cone: str | ConeChoice = "exact",
    sides: int | None = None,
    heading: float | None = None,
    engine: str | Sequence[str] = "auto",
    gravity: Any = None,
    external_wrenches: Iterable[ExternalWrench | dict[str, Any]] = (),
    torque_limits: bool | Mapping[str, Any] = False,
) -> MarginGradient:
    """Gradient of the margin of a posture, or of contacts with a centre of mass.

    Args:
        contacts: A Posture, a Stance, or contacts; a posture or a stance brings everything else.
        com: Centre of mass in world axes, shape (3,) [m].
        mass: Mass [kg].
        cone: "exact", "inscribed" or "circumscribed", or a ConeChoice.
        sides: Sides of the pyramids.
        heading: Heading of the pyramids [rad].
        engine: "auto", the name of an engine, or several to be tried in turn.
        gravity: Acceleration of gravity in world axes, shape (3,) [m/s^2].
        external_wrenches: Wrenches impressed on the robot; they stay in the world when the robot moves.
        torque_limits: Whether forces have to respect joint-torque limits.

    Returns:
        The gradient; where the margin is infinite there is none, and every derivative is nan.

    Raises:
        InputError: A number, name or choice is wrong, or the robot has mimic joints.
        EngineError: No engine settled the program.
    """
    stance = stance_of(contacts, com, mass, gravity, external_wrenches, torque_limits)
    choice = cone_choice(cone, sides, heading)
    data = assemble(stance)
    margin = normal_force_margin(data, choice, "socp", engine)
    sensitivity = Sensitivity(stance, data, None if stance.posture is None else StaticDerivatives(stance))
    optimum = margin.optimum
    if optimum is None or not np.isfinite(margin.value):
        nowhere = Motion(np.full(6, np.nan), np.full(len(data.torques.names), np.nan))
        return _parted(stance, margin.value, sensitivity.of(np.full((len(stance.contacts), 6), np.nan), nowhere), None)
    wrenches, motion = contact_wrenches(data, optimum.x), _motion(data, optimum.multipliers)
    faces = optimal_faces(optimum)
    kinks = [sensitivity.along_forces(contact_wrenches(data, dx), motion) for dx in faces.forces]
    kinks += [sensitivity.of(wrenches, _motion(data, optimum.multipliers.like(dy))) for dy in faces.multipliers]
    return _parted(stance, margin.value * data.units.force, sensitivity.of(wrenches, motion), kinks)


class Sensitivity:
    """Derivatives of ``u . T``: of minus the power of the loads on a motion, when posture or contacts move; SI.

    Args:
        stance: The stance.
        data: Its arrays.
        derivatives: Of its posture, None without a robot.
    """

    def __init__(self, stance: Stance, data: StaticsData, derivatives: StaticDerivatives | None):
        self._stance, self._data, self._derivatives = stance, data, derivatives

    def of(self, wrenches: Array, motion: Motion) -> dict[str, Array]:
        """Derivatives under all loads, by part.

        Args:
            wrenches: Contact wrenches at the contacts' positions, world axes, shape (contacts, 6) [N, N m].
            motion: Scaled motion.
        """
        _, angular = self._data.units.twist_in_si(motion.twist)
        parts = self._at_contacts(wrenches, motion) | {"com": -cross(self._stance.mass * self._stance.gravity, angular)}
        return parts if self._derivatives is None else parts | {"tangent": self._derivatives.of(wrenches).T @ self._velocity(motion)}

    def along_forces(self, wrenches: Array, motion: Motion) -> dict[str, Array]:
        """The share of the contact wrenches alone."""
        parts = self._at_contacts(wrenches, motion) | {"com": np.zeros(3)}
        if self._derivatives is None:
            return parts
        return parts | {"tangent": self._derivatives.produced(wrenches).T @ self._velocity(motion)}

    def _at_contacts(self, wrenches: Array, motion: Motion) -> dict[str, Array]:
        linear, angular = self._data.units.twist_in_si(motion.twist)
        position = np.array([c.position for c in self._stance.contacts])
        v = linear + cross(angular, position - self._data.units.origin)
        w = np.broadcast_to(angular, v.shape)
        if len(motion.joints):
            frames = self._data.torques.jacobian @ (motion.joints / self._data.units.length)
            v, w = v + frames[:, :3] * self._data.units.length, w + frames[:, 3:]
        force, moment = wrenches[:, :3], wrenches[:, 3:]
        return {"positions": -cross(force, w), "rotations": -cross(force, v) - cross(moment, w)}

    def _velocity(self, motion: Motion) -> Array:
        """The motion as velocity of the configuration, shape (nv,)."""
        posture, units = self._stance.posture, self._data.units
        linear, angular = units.twist_in_si(motion.twist)
        base = linear + cross(angular, posture.p_WB - units.origin)
        return np.concatenate([posture.R_WB.T @ base, posture.R_WB.T @ angular, motion.joints / units.length])


def _motion(data: StaticsData, multipliers: Multipliers) -> Motion:
    return motion_of(data, multipliers.twist, multipliers.limits)


def _parted(stance: Stance, margin: float, value: dict[str, Array], kinks: list[dict[str, Array]] | None) -> MarginGradient:
    """The gradient with its parts; how far each is unique."""

    def unique(part: str) -> bool:
        scale = SMALL * (1.0 + float(np.abs(value[part]).max(initial=0.0)))
        return kinks is not None and all(float(np.abs(kink[part]).max(initial=0.0)) <= scale for kink in kinks)

    names, nv = stance.contacts.names, len(value.get("tangent", ()))
    return MarginGradient(
        margin=margin,
        tangent=value.get("tangent"),
        com=value["com"],
        positions=dict(zip(names, value["positions"], strict=True)),
        rotations=dict(zip(names, value["rotations"], strict=True)),
        unique={part: unique(part) for part in value},
        kinks=None if kinks is None or not nv else np.array([kink["tangent"] for kink in kinks]).reshape(-1, nv),
    )
