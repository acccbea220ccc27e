"""What a rigid motion does to the contacts: velocities, and the least work admissible forces do on it.

The least work of a unit normal force in a cone K on a velocity u is min { f . u : f in K, f_n = 1 }; it is >= 0 exactly where
u is in the dual cone, v_n >= mu |v_t| for the exact cone.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from socp_statics.cones.choice import ConeChoice
from socp_statics.spatial import Array, cross
from socp_statics.statics.joint_torques import joint_rates
from socp_statics.statics.statics_data import StaticsData


class ContactMotion(NamedTuple):
    """Velocities of the contact points under a scaled twist.

    Attributes:
        velocity: In contact frames, shape (points, 3).
        spin: Angular velocity about the normal times gamma, 0 where no moment is transmitted, shape (points,).
        grip: Least work of a unit normal force at each point, shape (points,).
        handle: Velocity along each handle component, shape (nh,).
    """

    velocity: Array
    spin: Array
    grip: Array
    handle: Array


def polygon_support(v: Array, cone: ConeChoice, radius: Array) -> Array:
    """Support function ``max { v . f : n_j . f <= radius }`` of the pyramids' cross-sections, v (n, 2), result (n,)."""
    assert cone.sides is not None
    return radius * (v @ cone.edge_directions().T).max(axis=1) / np.cos(np.pi / cone.sides)


def _resistance(data: StaticsData, cone: ConeChoice, u_t: Array, twist: Array) -> Array:
    """Largest power of friction against a sliding velocity, for a unit normal force; shape (slipping,)."""
    mu = data.friction
    elliptic = np.arange(data.slipping) >= data.circular
    if cone.kind == "exact":
        slide = mu * np.linalg.norm(u_t, axis=1)
        return np.where(elliptic, np.hypot(slide, twist), slide + twist)
    # A pyramid with an odd number of sides is not symmetric: friction acts against the velocity.
    slide = polygon_support(-u_t, cone, mu * cone.slope_factor())
    return np.where(elliptic & (cone.kind == "inscribed"), np.maximum(slide, twist), slide + twist)


class Motion(NamedTuple):
    """A candidate motion: scaled twist ``[v; w]`` about the origin, shape (6,), and scaled joint rates, shape (n,)."""

    twist: Array
    joints: Array


def motion_of(data: StaticsData, twist: Array, limit_multipliers: Array | None = None) -> Motion:
    """The motion behind the multipliers of the balance and of the hard rows.

    Args:
        data: The stance's arrays.
        twist: Multipliers of the balance, shape (6,).
        limit_multipliers: Multipliers of the hard rows, or None where there are none.

    Returns:
        The motion; joints move only where their torque is limited.
    """
    none = np.zeros(len(data.torques.names))
    if limit_multipliers is None or not data.torques.limited:
        return Motion(twist, none)
    return Motion(twist, joint_rates(data.torques, limit_multipliers[data.handle_limits :]))


def frame_velocities(data: StaticsData, motion: Motion) -> Array:
    """Velocity of each contact's position, on the robot's side.

    Args:
        data: The stance's arrays.
        motion: Twist and joint rates.

    Returns:
        World axes, scaled, shape (contacts, 3).
    """
    twist, joints = motion
    velocity = twist[:3] + cross(twist[3:], data.position)
    return velocity + (data.torques.jacobian @ joints)[:, :3] if len(joints) else velocity


def contact_motion(data: StaticsData, cone: ConeChoice, motion: Motion) -> ContactMotion:
    """Velocities and least works of a motion.

    Args:
        data: The stance's arrays.
        cone: Exact cones or pyramids.
        motion: Twist and joint rates.

    Returns:
        The motion at the contacts.
    """
    twist, joints = motion
    velocity_W = twist[:3] + cross(twist[3:], data.point)
    rates = data.wrench_map.T @ twist
    if len(joints):
        frame = data.torques.jacobian @ joints
        k = data.contact_of_point
        velocity_W = velocity_W + frame[k, :3] + cross(frame[k, 3:], data.point - data.position[k])
        rates = rates + data.torques.map.T @ joints
    velocity = np.einsum("nij,ni->nj", data.rotation[data.contact_of_point], velocity_W)
    spin = np.zeros(data.points)
    spin[data.circular - data.box : data.slipping] = data.torsion * np.abs(rates[data.torsional])
    grip = velocity[:, 2].copy()
    if data.slipping:
        grip[: data.slipping] -= _resistance(data, cone, velocity[: data.slipping, :2], spin[: data.slipping])
    return ContactMotion(velocity, spin, grip, rates[data.handle])


class Work(NamedTuple):
    """Least power of everything on a motion, and how far its unbounded parts are from being ruled out.

    Attributes:
        power: Load, bounded contacts, limited handles and limited torques, at their least; scaled.
        violation: Largest way an unbounded force or torque could work against the motion, 0 for a certificate; scaled.
    """

    power: float
    violation: float


def least_work(data: StaticsData, motion: Motion, at_contacts: ContactMotion) -> Work:
    """Least power of load and admissible forces and torques on a motion.

    Args:
        data: The stance's arrays.
        motion: Twist and joint rates.
        at_contacts: The motion at the contacts.

    Returns:
        Power and violation; power > 0 with violation 0 proves that no admissible force and torque balance the load.
    """
    power = float(data.load @ motion.twist) - float(data.torques.passive @ motion.joints)
    bounded = dict(zip(data.bounded.tolist(), data.bounds, strict=True))
    violation = 0.0
    for k in np.unique(data.contact_of_point):
        grip = float(at_contacts.grip[data.contact_of_point == k].min())
        lo, hi = bounded.get(int(k), (0.0, np.inf))
        if grip >= 0.0 or np.isfinite(hi):
            power += (lo if grip >= 0.0 else hi) * grip
        else:
            violation = max(violation, -grip)
            power += lo * grip
    limits = np.tile([-np.inf, np.inf], (len(at_contacts.handle), 1))
    for row, value in zip(data.limit_rows[: data.handle_limits], data.limit_values, strict=False):
        (j,) = np.flatnonzero(row[data.handle])
        upper = row[data.handle][j] > 0
        limits[j, int(upper)] = value if upper else -value
    rates = np.concatenate([at_contacts.handle, motion.joints])
    for rate, (low, high) in zip(rates, np.vstack([limits, data.torques.limits]), strict=True):
        end = low if rate > 0 else high
        if np.isfinite(end):
            power += end * rate
        else:
            violation = max(violation, abs(rate))
    return Work(power, violation)
