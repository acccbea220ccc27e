"""Truth of robustness: whether a posture holds with a disturbance, by a conic program that shares no code with the package."""

from __future__ import annotations

from dataclasses import replace

import cvxpy as cp
import numpy as np
from oracles import points_of, scales

from socp_statics.contacts import Stance

# Families of random stances made of points, lines and surfaces without bounds, which this oracle knows.
PLAIN = ("flat", "sloped", "feet_and_hands", "points", "near_vertical", "tilted_gravity", "slivers")
LENGTH = 0.3


def slack(stance: Stance, force=(0.0, 0.0, 0.0), moment=(0.0, 0.0, 0.0), point=None) -> float:
    """Largest t with |f_t| <= mu (f_n - t) at every point, with a wrench more, scaled: an independent program; negative: unstable."""
    W, size, centre = scales(stance)
    total, turning = np.array(force, dtype=float), np.array(moment, dtype=float)
    turning += np.cross((stance.com if point is None else point) - centre, force)
    weight = stance.mass * np.asarray(stance.gravity)
    total = total + weight
    turning += np.cross(np.asarray(stance.com) - centre, weight)
    for w in stance.external_wrenches:
        total = total + w.force
        turning += w.moment + (np.cross(w.point - centre, w.force) if w.point is not None else 0.0)
    t, sums, turns, rows = cp.Variable(), total / W, turning / (W * size), []
    for c in stance.contacts:
        for p in points_of(c):
            f, n, r = cp.Variable(3), c.rotation[:, 2], (p - centre) / size
            grip = f @ n - t
            rows += [cp.norm(c.rotation[:, :2].T @ f) <= c.friction * grip] if c.friction else [c.rotation[:, :2].T @ f == 0, grip >= 0]
            sums = sums + f
            turns = turns + np.array([[0, -r[2], r[1]], [r[2], 0, -r[0]], [-r[1], r[0], 0]]) @ f
    # the six rows of the balance may depend on each other, so that they are kept to 1e-9 only
    problem = cp.Problem(cp.Maximize(t), [*rows, cp.abs(sums) <= 1e-9, cp.abs(turns) <= 1e-9, t <= 1.0])
    problem.solve(solver="CLARABEL")
    return float(t.value) if problem.status in ("optimal", "optimal_inaccurate") else -np.inf


def disturbed(stance: Stance, name: str, way: np.ndarray, size: float) -> float:
    """Slack with a disturbance by its meaning in words.

    Args:
        stance: The stance.
        name: Of the measure: "push", "force", "wrench" (moments over 0.3 m), "com", "mass_and_com" (the default ellipsoid) or "tilt".
        way: Its direction, a unit vector; of a tilt, any direction that gravity turns towards.
        size: How much, in the unit of the measure.
    """
    mass, g, c = stance.mass, np.asarray(stance.gravity), np.asarray(stance.com)
    match name:
        case "push" | "force":
            return slack(stance, size * way)
        case "wrench":
            return slack(stance, size * way[:3], LENGTH * size * way[3:])
        case "com":
            return slack(replace(stance, com=c + size * way))
        case "mass_and_com":
            dm, dmc = 0.1 * mass * size * way[0], 0.01 * mass * size * way[1:]
            return slack(stance, dm * g, np.cross(dmc - c * dm, g))
        case "tilt":
            down = g / np.linalg.norm(g)
            side = way - way @ down * down
            turned = np.cos(np.radians(size)) * down + np.sin(np.radians(size)) * side / np.linalg.norm(side)
            return slack(replace(stance, gravity=np.linalg.norm(g) * turned))
    raise KeyError(name)
