"""Forces and motions of a whole region checked at once, from positions, rotations and newtons; vectorised twins of `rechecks`."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from sweeps.layout import COMPONENTS, Layout


class Motions(NamedTuple):
    """What k motions do against a load and every admissible force, scaled.

    Attributes:
        power: Least power with the centre of mass at the origin of the layout's x and y, shape (k,) [W m/s over the size's unit].
        slope: Its change with the CoM's scaled x and y, shape (k, 2).
        against: By how much a unit of unbounded normal force could work against each, a velocity, shape (k,).
        speed: Largest of |v| and |w| times the size, shape (k,).
    """

    power: np.ndarray
    slope: np.ndarray
    against: np.ndarray
    speed: np.ndarray


def force_faults(numbers: Layout, stance, com_xy, forces) -> tuple[np.ndarray, np.ndarray]:
    """Balance and largest violation of cones, bounds and limits of several force sets, in units of W, shapes (v,).

    Args:
        numbers: Numbers of the stance.
        stance: The stance.
        com_xy: Where its centre of mass is for each set, world axes, shape (v, 2) [m].
        forces: One PointForces for each, all over the same points.
    """
    W, size = numbers.W, numbers.size
    F = np.array([f.force_W for f in forces]) / W
    M = np.array([f.moment_W for f in forces]) / (W * size)
    names = [c.name for c in stance.contacts]
    at = np.array([names.index(name) for name in forces[0].contact])
    handle = np.array([c.type == "handle" for c in stance.contacts])[at]
    P = np.empty((len(at), 3))
    P[~handle] = numbers.points
    for i in np.flatnonzero(handle):
        P[i] = numbers.scaled(stance.contacts[int(at[i])].position)
    far = np.abs(forces[0].point_W).max() * 1e-15 / size
    assert (np.sort(at) == at).all() and np.abs(numbers.scaled(forces[0].point_W) - P).max() <= 1e-12 + far, "forces act elsewhere"
    xy = (np.asarray(com_xy) - (numbers.anchor + numbers.centre)[:2]) / size
    total = numbers.load + (xy - numbers.com[:2]) @ numbers.com_load.T
    total[:, :3] += F.sum(axis=1)
    total[:, 3:] += np.cross(P, F).sum(axis=1) + M.sum(axis=1)

    f = np.einsum("nji,vnj->vni", numbers.frames, F[:, ~handle])
    m = np.einsum("nji,vnj->vni", numbers.frames, M[:, ~handle])
    mu, gamma = numbers.friction, numbers.torsion
    slip, spin, fn = np.hypot(f[..., 0], f[..., 1]), np.abs(m[..., 2]), f[..., 2]
    turn = np.divide(mu * spin, gamma, out=np.zeros_like(spin), where=gamma > 0)
    cone = np.maximum(np.where(numbers.elliptic, np.hypot(slip, turn), slip) - mu * fn, -fn)
    box = (gamma > 0) & ~numbers.elliptic
    cone = np.maximum(cone, np.where(box, spin / np.where(gamma > 0, gamma, 1.0) - fn, -fn))
    cone = np.maximum(cone, np.where(gamma > 0, 0.0, spin))
    worst = np.maximum(cone, np.abs(m[..., :2]).max(axis=2)).max(axis=1, initial=0.0)
    for k, (lo, hi) in numbers.bounds.items():
        normal = fn[:, numbers.owner == k].sum(axis=1)
        worst = np.maximum(worst, np.maximum(lo - normal, normal - hi))
    for i in np.flatnonzero(handle):
        contact = stance.contacts[int(at[i])]
        held = np.concatenate([F[:, i] @ contact.rotation, M[:, i] @ contact.rotation], axis=1)
        for word, value in zip(COMPONENTS, held.T, strict=True):
            lo, hi = contact.limits.get(word, (-np.inf, np.inf)) if word in contact.transmits else (0.0, 0.0)
            unit = W if word[0] == "f" else W * size
            worst = np.maximum(worst, np.maximum(lo / unit - value, value - hi / unit))
    return np.linalg.norm(total, axis=1), worst


def motions(numbers: Layout, linear, angular) -> Motions:
    """Least power of several motions about the mean contact point, shapes (k, 3) [m/s, rad/s]."""
    v, w = np.asarray(linear, dtype=float), np.asarray(angular, dtype=float) * numbers.size
    speed = np.maximum(np.linalg.norm(v, axis=1), np.linalg.norm(w, axis=1))
    twist = np.hstack([v, w])
    power = twist @ (numbers.load - numbers.com_load @ numbers.com[:2])
    against = np.zeros(len(v))
    u = np.einsum("nji,knj->kni", numbers.frames, v[:, None] + np.cross(w[:, None], numbers.points))
    spin = np.abs(np.einsum("nj,kj->kn", numbers.frames[:, :, 2], w)) * numbers.torsion
    slide = numbers.friction * np.hypot(u[..., 0], u[..., 1])
    least = u[..., 2] - np.where(numbers.elliptic, np.hypot(slide, spin), slide + spin)
    for k in np.unique(numbers.owner):
        mine = least[:, numbers.owner == k].min(axis=1)
        lo, hi = numbers.bounds.get(int(k), (0.0, np.inf))
        power += lo * np.maximum(mine, 0.0)
        if np.isfinite(hi):
            power += hi * np.minimum(mine, 0.0)
        else:
            against = np.maximum(against, -mine)
            power += lo * np.minimum(mine, 0.0)
    for grip in numbers.grips:
        rate = twist @ grip.wrench
        for end, part in ((grip.lo, np.maximum(rate, 0.0)), (grip.hi, np.minimum(rate, 0.0))):
            if np.isfinite(end):
                power += end * part
            else:
                against = np.maximum(against, np.abs(part))
    return Motions(power, twist @ numbers.com_load, against, speed)
