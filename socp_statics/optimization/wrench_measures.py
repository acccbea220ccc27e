"""What given contact wrenches do: shares, centres of pressure, use of friction, reserve in the cones, joint torques, internal forces."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from socp_statics.cones.choice import ConeChoice
from socp_statics.contacts import Stance
from socp_statics.distribution.virtual_linkage import member_forces, members
from socp_statics.optimization.wrench_reserve import wrench_reserve
from socp_statics.spatial import Array
from socp_statics.statics import StaticsData
from socp_statics.statics.joint_torques import passive_torque, static_torque
from socp_statics.statics.units import BOUNDARY

UNLOADED = 1e-9


@dataclass(frozen=True)
class Measures:
    """Numbers of one distribution.

    Attributes:
        normal_force: Of each unilateral contact by name [N].
        normal_share: Its part of their sum, None where the sum is zero.
        cop: Centre of pressure in the contact plane, shape (2,) [m]; None where the contact is not loaded or is no surface or line.
        friction_use: ``|f_t| / (mu f_n)`` of the resultant; inf where a tangential force has no normal force; None without friction.
        reserve: Normal force that every contact point can spare inside its cone, negative where the wrenches are outside [N].
        inside: Whether the reserve is not negative, to 1e-7 of the load.
        torques: Joint torques [N m], empty without a robot.
        worst_joint: The joint with the largest torque, or with torque limits the largest share of its limit; None without a robot.
        worst_share: That share, None without limits.
        internal_forces: Member forces of the virtual linkage by pair of contacts, tension positive [N].
    """

    normal_force: dict[str, float]
    normal_share: dict[str, float | None]
    cop: dict[str, list[float] | None]
    friction_use: dict[str, float | None]
    reserve: float
    inside: bool
    torques: dict[str, float]
    worst_joint: str | None
    worst_share: float | None
    internal_forces: dict[str, float]

    @property
    def cone_violation(self) -> float:
        """How much normal force the worst contact point lacks, 0 inside the cones [N]."""
        return 0.0 if self.inside else -self.reserve

    @property
    def worst_torque(self) -> float | None:
        """The torque of the worst joint [N m]."""
        return None if self.worst_joint is None else self.torques[self.worst_joint]


def measures_of(
    stance: Stance, data: StaticsData, world: Array, local: Array, *, cone: ConeChoice, form: str, engine: str | Sequence[str]
) -> Measures:
    """Measures of contact wrenches.

    Args:
        stance: The stance.
        data: Its arrays.
        world: ``[force; moment]`` about each contact's position, world axes, shape (k, 6) [N, N m].
        local: The same in contact frames.
        cone: Exact cones or pyramids.
        form: "socp" or "sdp".
        engine: "auto", the name of an engine, or several to be tried in turn.
    """
    W = data.units.force
    unilateral = [(k, c) for k, c in enumerate(stance.contacts) if c.unilateral]
    normal = {c.name: float(local[k, 2]) for k, c in unilateral}
    total = sum(normal.values())
    cop: dict[str, list[float] | None] = {}
    use: dict[str, float | None] = {}
    for k, c in unilateral:
        f_n, flat = local[k, 2], len(c.points_C) > 1
        loaded = abs(f_n) > UNLOADED * W
        cop[c.name] = [float(-local[k, 4] / f_n), float(local[k, 3] / f_n)] if flat and loaded else None
        f_t = float(np.linalg.norm(local[k, :2]))
        if c.frictionless:
            use[c.name] = None
        else:
            use[c.name] = float(f_t / (c.friction * f_n)) if f_n > UNLOADED * W else 0.0 if f_t <= UNLOADED * W else np.inf
    reserve = wrench_reserve(data, local, cone, form, engine)
    torques, joint, share = _torques(stance, world)
    return Measures(
        normal_force=normal,
        normal_share={name: f / total if abs(total) > UNLOADED * W else None for name, f in normal.items()},
        cop=cop,
        friction_use=use,
        reserve=reserve,
        inside=reserve >= -BOUNDARY * W,
        torques=torques,
        worst_joint=joint,
        worst_share=share,
        internal_forces=internal_forces_by_pair(stance, world),
    )


def internal_forces_by_pair(stance: Stance, world: Array) -> dict[str, float]:
    """Member forces of the virtual linkage behind given contact wrenches, by ``"a - b"`` [N]; none where contacts coincide."""
    positions = np.array([c.position for c in stance.contacts])
    pairs = members(len(positions))
    if not pairs or min(np.linalg.norm(positions[i] - positions[j]) for i, j in pairs) == 0.0:
        return {}
    names = stance.contacts.names
    found = member_forces(positions, world[:, :3])
    return {f"{names[i]} - {names[j]}": float(f) for (i, j), f in zip(pairs, found, strict=True)}


def torques_of(stance: Stance, world: Array) -> Array:
    """Joint torques of contact wrenches in world axes, shape (n,) [N m]."""
    J = np.vstack([stance.posture.jacobian[c.name] for c in stance.contacts])
    return static_torque(passive_torque(stance), J, world.ravel())


def _torques(stance: Stance, world: Array) -> tuple[dict[str, float], str | None, float | None]:
    """Torques by joint, the worst joint, and its share of its limit where there are limits."""
    if stance.posture is None:
        return {}, None, None
    joints, tau = stance.posture.robot.joints, torques_of(stance, world)
    by_name = dict(zip(joints, tau.tolist(), strict=True))
    if stance.torque_limits is None or not np.isfinite(stance.torque_limits).any():
        return by_name, joints[int(np.abs(tau).argmax())], None
    room = np.where(tau > 0.0, stance.torque_limits[:, 1], -stance.torque_limits[:, 0])
    share = np.where(room > 0.0, np.abs(tau) / np.where(room > 0.0, room, 1.0), np.where(tau == 0.0, 0.0, np.inf))
    worst = int(share.argmax())
    return by_name, joints[worst], float(share[worst])
