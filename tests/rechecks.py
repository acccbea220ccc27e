"""Answers checked from scratch: forces balance the load inside every cone; no admissible force prevents a motion."""

from __future__ import annotations

import numpy as np
from oracles import points_of, scales

COMPONENTS = ("fx", "fy", "fz", "mx", "my", "mz")


def _faces(choice):
    a = choice.heading + 2 * np.pi * np.arange(choice.sides) / choice.sides
    return np.column_stack([np.cos(a), np.sin(a)]), np.cos(np.pi / choice.sides) if choice.kind == "inscribed" else 1.0


def slip(contact, f_C, m_n: float, choice) -> float:
    """Violation of the friction cone of one point force in contact axes [N]."""
    mu, fn = contact.friction, f_C[2]
    if mu == 0.0:
        return float(max(np.abs(f_C[:2]).max(), abs(m_n), -fn))
    soft = contact.type == "soft_finger"
    spin = abs(m_n) / contact.torsional_friction if soft else abs(m_n)
    if choice.is_exact:
        if soft and contact.shape == "elliptic":
            return float(np.sqrt(f_C[0] ** 2 + f_C[1] ** 2 + (mu * spin) ** 2) - mu * fn)
        return float(max(np.hypot(f_C[0], f_C[1]) - mu * fn, (spin - fn) if soft else spin, -fn))
    n, factor = _faces(choice)
    slide = (n @ f_C[:2]).max()
    if soft and contact.shape == "elliptic" and choice.kind == "inscribed":
        return float(slide / (mu * factor) + spin - fn)
    return float(max(slide - mu * factor * fn, (spin - fn) if soft else spin, -fn))


def force_violations(stance, forces, choice) -> tuple[float, float]:
    """Balance and largest violation of cones, bounds and limits of an answer's forces, in units of W (moments: W times the size)."""
    W, size, centre = scales(stance)
    total = np.zeros(6)
    g = stance.mass * np.asarray(stance.gravity)
    total[:3] += g
    total[3:] += np.cross(np.asarray(stance.com) - centre, g)
    for w in stance.external_wrenches:
        total[:3] += w.force
        total[3:] += np.asarray(w.moment) + (0 if w.point is None else np.cross(np.asarray(w.point) - centre, w.force))
    worst = 0.0
    entries = forces.entries()
    for c in stance.contacts:
        mine = [e for e in entries if e["contact"] == c.name]
        P, R = points_of(c), np.asarray(c.rotation)
        assert len(mine) == len(P)
        normal = 0.0
        for e, p in zip(mine, P, strict=True):
            assert np.abs(np.array(e["point"]) - p).max() <= 1e-12 * max(size, np.abs(p).max())
            f, m = np.array(e["force"]), np.array(e.get("moment", [0.0, 0.0, 0.0]))
            total[:3] += f
            total[3:] += np.cross(p - centre, f) + m
            f_C, m_C = R.T @ f, R.T @ m
            if c.type == "handle":
                worst = max(worst, _grip_violation(c, f_C, m_C, size) / W)
                continue
            normal += f_C[2]
            worst = max(worst, slip(c, f_C, m_C[2], choice) / W, np.abs(m_C[:2]).max() / (W * size))
        if c.type != "handle" and c.normal_force is not None:
            worst = max(worst, (c.normal_force[0] - normal) / W, (normal - c.normal_force[1]) / W)
    assert len(entries) == sum(len(points_of(c)) for c in stance.contacts)
    return float(np.linalg.norm(total / W / np.repeat([1.0, size], 3))), float(worst)


def _grip_violation(contact, f_C, m_C, size: float) -> float:
    """Violation of a handle's limits and of what it cannot transmit [N], moments over the size."""
    worst = 0.0
    for word, value in zip(COMPONENTS, [*f_C, *m_C], strict=True):
        lo, hi = contact.limits.get(word, (-np.inf, np.inf)) if word in contact.transmits else (0.0, 0.0)
        worst = max(worst, (lo - value) / (1.0 if word[0] == "f" else size), (value - hi) / (1.0 if word[0] == "f" else size))
    return float(worst)


def resistance(contact, u_C, spin: float, choice) -> float:
    """Least power of a unit normal force in the contact's cone on a velocity in contact axes."""
    mu = contact.friction
    if mu == 0.0:
        return float(u_C[2])
    soft = contact.type == "soft_finger"
    turn = contact.torsional_friction * abs(spin) if soft else 0.0
    elliptic = soft and contact.shape == "elliptic"
    if choice.is_exact:
        slide = mu * np.hypot(u_C[0], u_C[1])
        return float(u_C[2] - (np.hypot(slide, turn) if elliptic else slide + turn))
    n, factor = _faces(choice)
    half = np.pi / choice.sides
    corners = mu * factor / np.cos(half) * (np.array([[np.cos(half), -np.sin(half)], [np.sin(half), np.cos(half)]]) @ n.T).T
    slide = -(corners @ u_C[:2]).min()
    return float(u_C[2] - (max(slide, turn) if elliptic and choice.kind == "inscribed" else slide + turn))


def motion_power(stance, certificate, choice) -> tuple[float, float]:
    """Least power of load and admissible forces on a motion [W], and how far unbounded forces could still work against it.

    The second number is a velocity over the largest of |v| and |w| times the size.
    """
    W, size, centre = scales(stance)
    v, w, at = (np.asarray(a) for a in (certificate.linear, certificate.angular, certificate.point))
    scale = max(np.linalg.norm(v), np.linalg.norm(w) * size)
    assert scale > 0

    def velocity(p):
        return v + np.cross(w, np.asarray(p) - at)

    power = stance.mass * np.asarray(stance.gravity) @ velocity(stance.com)
    for load in stance.external_wrenches:
        power += load.moment @ w + (0.0 if load.point is None else load.force @ velocity(load.point))
    violation = 0.0
    for c in stance.contacts:
        R = np.asarray(c.rotation)
        if c.type == "handle":
            for word in c.transmits:
                axis = R[:, "xyz".index(word[1])]
                rate = axis @ (velocity(c.position) if word[0] == "f" else w)
                lo, hi = c.limits.get(word, (-np.inf, np.inf))
                worst = lo if rate > 0 else hi
                if np.isfinite(worst):
                    power += worst * rate
                else:
                    violation = max(violation, abs(rate) * (1.0 if word[0] == "f" else size))
            continue
        least = min(resistance(c, R.T @ velocity(p), float(w @ R[:, 2]), choice) for p in points_of(c))
        lo, hi = (0.0, np.inf) if c.normal_force is None else c.normal_force
        if least >= 0:
            power += lo * least
        elif np.isfinite(hi):
            power += hi * least
        else:
            violation = max(violation, -least)
            power += lo * least
    return float(power), float(violation / scale)
