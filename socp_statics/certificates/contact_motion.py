"""What a rigid motion does to the contacts: velocities, and the least work admissible forces do on it.

The least work of a unit normal force in a cone K on a velocity u is min { f . u : f in K, f_n = 1 }; it is >= 0 exactly where
u is in the dual cone, v_n >= mu |v_t| for the exact cone.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from socp_statics.cones.choice import ConeChoice
from socp_statics.spatial import Array
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


def contact_motion(data: StaticsData, cone: ConeChoice, twist: Array) -> ContactMotion:
    """Velocities and least works of a twist.

    Args:
        data: The stance's arrays.
        cone: Exact cones or pyramids.
        twist: Scaled ``[v; w]`` about the origin, dual of a scaled wrench, shape (6,).

    Returns:
        The motion at the contacts.
    """
    rates = data.wrench_map.T @ twist
    velocity_W = twist[:3] + np.cross(twist[3:], data.point)
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
        power: Load plus bounded contacts plus limited handles, at their least; scaled.
        violation: Largest way an unbounded force could work against the motion, 0 for a certificate; scaled.
    """

    power: float
    violation: float


def least_work(data: StaticsData, motion: ContactMotion, twist: Array) -> Work:
    """Least power of load and admissible forces on a motion.

    Args:
        data: The stance's arrays.
        motion: The motion at the contacts.
        twist: The scaled twist, shape (6,).

    Returns:
        Power and violation; power > 0 with violation 0 proves that no admissible force balances the load.
    """
    power = float(data.load @ twist)
    bounded = dict(zip(data.bounded.tolist(), data.bounds, strict=True))
    violation = 0.0
    for k in np.unique(data.contact_of_point):
        grip = float(motion.grip[data.contact_of_point == k].min())
        lo, hi = bounded.get(int(k), (0.0, np.inf))
        if grip >= 0.0 or np.isfinite(hi):
            power += (lo if grip >= 0.0 else hi) * grip
        else:
            violation = max(violation, -grip)
            power += lo * grip
    limits = np.full((len(motion.handle), 2), np.inf)
    for row, value in zip(data.limit_rows, data.limit_values, strict=True):
        (j,) = np.flatnonzero(row[data.handle])
        limits[j, 0 if row[data.handle][j] < 0 else 1] = value
    for rate, (low, high) in zip(motion.handle, limits, strict=True):
        reach = low if rate > 0 else high
        if np.isfinite(reach):
            power -= reach * abs(rate)
        else:
            violation = max(violation, abs(rate))
    return Work(power, violation)
