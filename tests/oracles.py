"""Independent oracles: linear programs over pyramids, and checks of forces and motions from scratch.

Nothing is shared with the package but the attributes of contacts and stances: points, wrench matrices, scales, ranks and cones
are built here again, from positions and rotations. Programs are solved by HiGHS in units of the weight and the size.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.optimize import linprog
from scipy.spatial import ConvexHull

HIGHS = {"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10}
COMPONENTS = ("fx", "fy", "fz", "mx", "my", "mz")
CAP = 1e4
LATITUDES = 8


class LinearStance(NamedTuple):
    """``A z + T t + load + D s = 0`` with z the multipliers of cone generators (>= 0, each of normal force 1) and handle forces.

    f_i = g_i + t n_i with g_i inside its pyramid, so a reserve t is one more column. Bounded contacts:
    ``lo + t <= N + k t <= hi - t`` with N = sums z, k their number of points.
    """

    A: np.ndarray
    T: np.ndarray
    load: np.ndarray
    D: np.ndarray
    box: list[tuple[float, float]]
    sums: np.ndarray
    count: np.ndarray
    lo: np.ndarray
    hi: np.ndarray
    owner: np.ndarray
    names: tuple[str, ...]
    handles: tuple[str, ...]
    inside: np.ndarray
    outside: np.ndarray
    weight: float
    size: float
    centre: np.ndarray
    com: np.ndarray


def points_of(contact) -> np.ndarray:
    """Contact points in world axes, shape (k, 3) [m]."""
    p, R = np.asarray(contact.position), np.asarray(contact.rotation)
    if contact.type in ("surface", "frictionless_surface"):
        return np.array([p + x * R[:, 0] + y * R[:, 1] for x, y in contact.vertices])
    if contact.type == "line":
        return np.array([p + 0.5 * contact.length * R[:, 0], p - 0.5 * contact.length * R[:, 0]])
    return p[None, :].copy()


def scales(stance) -> tuple[float, float, np.ndarray]:
    """W [N], size [m] and mean contact point [m] as the contract defines them."""
    P = np.vstack([points_of(c) for c in stance.contacts])
    size = max(np.linalg.norm(P - q, axis=1).max() for q in P) or 1.0
    loads = [stance.mass * np.linalg.norm(stance.gravity)]
    for w in stance.external_wrenches:
        loads += [np.linalg.norm(w.force), np.linalg.norm(w.moment) / size]
    return float(max(loads)) or 1.0, float(size), P[0] + (P - P[0]).mean(axis=0)


def polygon_edges(kind: str, sides: int, heading: float) -> np.ndarray:
    """Corners of the pyramid's section at unit friction and unit normal force, shape (sides, 2)."""
    a = heading + 2 * np.pi * np.arange(sides) / sides + np.pi / sides
    radius = 1.0 if kind == "inscribed" else 1.0 / np.cos(np.pi / sides)
    return radius * np.column_stack([np.cos(a), np.sin(a)])


def ball_corners(kind: str, sides: int, heading: float) -> np.ndarray:
    """Corners of a polyhedron inside or outside the unit ball, shape (m, 3): the section of an elliptic soft finger."""
    ring = polygon_edges("inscribed", sides, heading)
    rows = [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]
    for k in range(1, LATITUDES):
        lat = np.pi * k / LATITUDES - np.pi / 2
        rows += [[np.cos(lat) * x, np.cos(lat) * y, np.sin(lat)] for x, y in ring]
    corners = np.array(rows)
    return corners if kind == "inscribed" else corners / -ConvexHull(corners).equations[:, 3].max()


def sections(contact, kind: str, sides: int, heading: float, stated: bool) -> np.ndarray:
    """Corners (f_x, f_y, m_z) of a contact's cone at unit normal force, shape (m, 3).

    Args:
        stated: True for the contract's pyramids of an elliptic soft finger, False for a close bracket of its exact cone.
    """
    mu = contact.friction
    if mu == 0.0:
        return np.zeros((1, 3))
    disc = np.column_stack([mu * polygon_edges(kind, sides, heading), np.zeros(sides)])
    if contact.type != "soft_finger":
        return disc
    gamma = contact.torsional_friction
    if contact.shape == "elliptic" and not stated:
        return ball_corners(kind, sides, heading) * [mu, mu, gamma]
    if contact.shape == "elliptic" and kind == "inscribed":
        return np.vstack([disc, [[0.0, 0.0, gamma], [0.0, 0.0, -gamma]]])
    return np.vstack([disc + [0.0, 0.0, gamma], disc - [0.0, 0.0, gamma]])


def wrench_columns(contact, corners: np.ndarray, centre: np.ndarray, size: float) -> np.ndarray:
    """Scaled wrenches about the centre of the generators of all points of a contact, shape (6, points * m)."""
    R = np.asarray(contact.rotation)
    f = np.column_stack([corners[:, :2], np.ones(len(corners))]) @ R.T
    spin = corners[:, 2:] / size * R[:, 2]
    blocks = [np.vstack([f.T, (np.cross((p - centre) / size, f) + spin).T]) for p in points_of(contact)]
    return np.hstack(blocks)


def linear_stance(stance, kind: str, sides: int, heading: float = 0.0, stated: bool = False) -> LinearStance:
    """The linear program's numbers of a stance with pyramids of one kind."""
    W, size, centre = scales(stance)
    blocks, box, owner = [], [], []
    T = np.zeros(6)
    bounded = [c for c in stance.contacts if c.type != "handle" and c.normal_force is not None]
    for k, c in enumerate(stance.contacts):
        if c.type == "handle":
            block = handle_columns(c, centre, size)
            for word in c.transmits:
                lo, hi = c.limits.get(word, (-np.inf, np.inf))
                unit = W if word[0] == "f" else W * size
                box.append((lo / unit, hi / unit))
        else:
            block = wrench_columns(c, sections(c, kind, sides, heading, stated), centre, size)
            T += wrench_columns(c, np.zeros((1, 3)), centre, size).sum(axis=1)
            box += [(0.0, np.inf)] * block.shape[1]
        blocks.append(block)
        owner += [k] * block.shape[1]
    owner = np.array(owner)
    names = tuple(c.name for c in stance.contacts)
    sums = np.array([owner == names.index(c.name) for c in bounded], dtype=float).reshape(-1, len(owner))
    load, D, com = loads_of(stance, W, size, centre)
    return LinearStance(
        np.hstack(blocks), T, load, D, box, sums, np.array([len(points_of(c)) for c in bounded], dtype=float),
        np.array([c.normal_force[0] / W for c in bounded]), np.array([c.normal_force[1] / W for c in bounded]),
        owner, names, tuple(c.name for c in stance.contacts if c.type == "handle"), *wrench_range(stance), W, size, centre, com,
    )  # fmt: skip


def handle_columns(contact, centre: np.ndarray, size: float) -> np.ndarray:
    """Scaled wrenches of the components a handle transmits, shape (6, h)."""
    columns = []
    for word in contact.transmits:
        axis = np.asarray(contact.rotation)[:, "xyz".index(word[1])]
        r = (np.asarray(contact.position) - centre) / size
        columns.append(np.concatenate([axis, np.cross(r, axis)] if word[0] == "f" else [np.zeros(3), axis]))
    return np.array(columns).T


def loads_of(stance, W: float, size: float, centre: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Scaled impressed wrench about the centre, its change with the CoM's x and y, and the scaled CoM."""
    g = stance.mass * np.asarray(stance.gravity) / W
    com = (np.asarray(stance.com) - centre) / size
    load = np.concatenate([g, np.cross(com, g)])
    for w in stance.external_wrenches:
        arm = np.zeros(3) if w.point is None else (np.asarray(w.point) - centre) / size
        load += np.concatenate([w.force, np.cross(arm, w.force) + np.asarray(w.moment) / size]) / W
    return load, np.column_stack([np.concatenate([np.zeros(3), np.cross(e, g)]) for e in np.eye(3)[:2]]), com


def wrench_range(stance) -> tuple[np.ndarray, np.ndarray]:
    """Rows that read a scaled wrench inside and outside the range of the contacts' wrench map, shapes (r, 6) and (6 - r, 6).

    Rows inside are divided by their singular values, so that stances of nearly collinear contacts stay well conditioned.
    """
    _, size, centre = scales(stance)
    columns = []
    for c in stance.contacts:
        if c.type == "handle":
            columns.append(handle_columns(c, centre, size))
            continue
        tangents = [] if c.friction == 0 else [c.rotation[:, 0], c.rotation[:, 1]]
        for p in points_of(c):
            columns += [np.concatenate([a, np.cross((p - centre) / size, a)])[:, None] for a in (*tangents, c.rotation[:, 2])]
        if c.type == "soft_finger" and c.friction > 0:
            columns.append(np.concatenate([np.zeros(3), c.rotation[:, 2]])[:, None])
    U, s, _ = np.linalg.svd(np.hstack(columns))
    rank = int((s > 1e-9).sum())
    return U[:, :rank].T / s[:rank, None], U[:, rank:].T


def out_of_reach(model: LinearStance) -> tuple[np.ndarray, np.ndarray]:
    """Rows ``C s = d`` that the range of the wrench map leaves of the balance: zero coefficients where the CoM does not matter."""
    return model.outside @ model.D, model.outside @ (model.D @ model.com[:2] - model.load)


def solve(model: LinearStance, t_range, s_range, cost_t=0.0, cost_s=(0.0, 0.0), cost_z=None, without_load=False, fixed_com=False):
    """Maximise over z, t and s; returns scipy's result with `fun` the maximum (status 0, 2 infeasible, 3 unbounded)."""
    n = model.A.shape[1]
    lo, hi, load = model.lo, model.hi, model.load - model.D @ model.com[:2]
    box = model.box
    if without_load:
        load, lo = 0.0 * load, 0.0 * lo
        hi = np.where(np.isfinite(hi), 0.0, hi)
        box = [(0.0 if np.isfinite(a) else a, 0.0 if np.isfinite(b) else b) for a, b in box]
    equal = model.lo == model.hi
    A_eq = [model.inside @ np.hstack([model.A, model.T[:, None], model.D])]
    b_eq = [-model.inside @ load]
    C, d = out_of_reach(model)
    U, sigma, Vt = np.linalg.svd(C)
    q = int((sigma > 1e-9).sum())
    if q and not fixed_com:
        A_eq.append(np.hstack([np.zeros((q, n + 1)), Vt[:q]]))
        b_eq.append(0.0 * sigma[:q] if without_load else U[:, :q].T @ d / sigma[:q])
    A_ub, b_ub = [], []
    for row, k, low, high, fixed in zip(model.sums, model.count, lo, hi, equal, strict=True):
        if fixed:
            A_eq.append(np.hstack([row, k, 0.0, 0.0])[None, :])
            b_eq.append(np.array([low]))
            continue
        A_ub.append(np.hstack([-row, 1.0 - k, 0.0, 0.0]))
        b_ub.append(-low)
        if np.isfinite(high):
            A_ub.append(np.hstack([row, 1.0 + k, 0.0, 0.0]))
            b_ub.append(high)
    c = -np.hstack([np.zeros(n) if cost_z is None else cost_z, cost_t, cost_s])
    result = linprog(
        c, A_ub=np.array(A_ub) if A_ub else None, b_ub=b_ub or None, A_eq=np.vstack(A_eq), b_eq=np.concatenate(b_eq),
        bounds=[*box, t_range, *s_range], method="highs", options=HIGHS,
    )  # fmt: skip
    if result.fun is not None:
        result.fun = -result.fun
    return result


def margin(model: LinearStance) -> float:
    """Normal-force reserve over the pyramids [N]; inf, -inf, or nan where the rank leaves it open or HiGHS gave up."""
    missed = float(np.linalg.norm(model.outside @ model.load))
    if missed > 1e-12:
        return -np.inf if missed > 1e-7 else np.nan
    result = solve(model, (None, CAP), [(v, v) for v in model.com[:2]], cost_t=1.0, fixed_com=True)
    if result.status == 2:
        return -np.inf
    if result.status != 0:
        return np.nan
    t = float(result.x[-3])
    if t > CAP * (1 - 1e-9):
        growth = solve(model, (None, 1.0), [(0.0, 0.0)] * 2, cost_t=1.0, without_load=True, fixed_com=True)
        return np.inf if growth.status == 0 and growth.x[-3] > 0.5 else np.nan
    return t * model.weight


def support(model: LinearStance, direction) -> tuple[str, float]:
    """Support function of the CoM region at the CoM's height: ("solved", h [m, world axes]), ("empty", nan) or ("unbounded", inf)."""
    C, d = out_of_reach(model)
    U, sigma, _ = np.linalg.svd(C)
    q = int((sigma > 1e-9).sum())
    if np.linalg.norm(U[:, q:].T @ d) > 1e-7:
        return "empty", np.nan
    result = solve(model, (0.0, 0.0), [(None, None)] * 2, cost_s=tuple(direction))
    if result.status == 0:
        return "solved", float(model.size * result.fun + np.dot(direction, model.centre[:2]))
    if result.status == 2:
        return "empty", np.nan
    feasible = solve(model, (0.0, 0.0), [(None, None)] * 2)
    return ("unbounded", np.inf) if feasible.status == 0 else ("empty", np.nan) if feasible.status == 2 else ("failed", np.nan)


def grows_along(model: LinearStance, ray) -> bool:
    """Whether the region can grow without end along a direction: forces of the recession cone balance it."""
    result = solve(model, (0.0, 0.0), [(v, v) for v in ray], without_load=True)
    return result.status == 0


def largest_loads(model: LinearStance) -> dict[str, float]:
    """Largest normal force of each unilateral contact over all horizontal CoM positions, capped at 1 W [W]."""
    out = {}
    for k, name in enumerate(model.names):
        mine = model.owner == k
        if name in model.handles:
            continue
        extra = model._replace(
            sums=np.vstack([model.sums, mine.astype(float)]), count=np.append(model.count, 0.0),
            lo=np.append(model.lo, 0.0), hi=np.append(model.hi, 1.0),
        )  # fmt: skip
        result = solve(extra, (0.0, 0.0), [(None, None)] * 2, cost_z=mine.astype(float))
        out[name] = float(result.fun) if result.status == 0 else np.nan
    return out
