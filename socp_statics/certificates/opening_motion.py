"""A motion that opens what a certificate only just holds, so that a little of it takes a certificate clear of rounding.

A certificate's multipliers satisfy the dual cones to a solver's tolerance, and where a contact slides or holds they do so with equality. A
small linear program finds a second motion that opens every such contact: along the direction it slides, or, where it holds, against every
ray of a polyhedral cone around its own. Contacts that no motion opens are braced by internal forces: exactly zero velocity is
imposed on them instead.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.optimize import linprog

from socp_statics.certificates.contact_motion import Motion
from socp_statics.cones.choice import ConeChoice
from socp_statics.spatial import Array
from socp_statics.statics.statics_data import StaticsData

STILL = 1e-6
TIGHT = 1e-5
MOST = 1e7
RING = 2 * np.pi * np.arange(16) / 16
WIDER = 1.0 / np.cos(np.pi / 16)


class Opening(NamedTuple):
    """A motion that opens contact points, and the rows of `rates_map` that have to be exactly zero, braced or without limit."""

    motion: Motion
    still: list[int]


def rates_map(data: StaticsData) -> Array:
    """Velocity along each unknown of x, then rates of the n limited joints, per unit of twist and of these, shape (nx + n, 6 + n)."""
    free = limited(data)
    if not free:
        return data.wrench_map.T
    return np.vstack([np.hstack([data.wrench_map.T, data.torques.map[free].T]), np.eye(len(free), 6 + len(free), 6)])


def limited(data: StaticsData) -> list[int]:
    """Indices of the joints with a limit."""
    return [int(k) for k in np.flatnonzero(np.isfinite(data.torques.limits).any(axis=1))]


def point_columns(data: StaticsData, i: int) -> list[int]:
    """Where the components of a contact point are in x: tangential, normal, torsional."""
    soft = data.circular - data.box
    columns = [2 * i, 2 * i + 1] if i < data.slipping else []
    columns.append(data.normal.start + i)
    return [*columns, data.torsional.start + i - soft] if soft <= i < data.slipping else columns


def opening_motion(data: StaticsData, cone: ConeChoice, motion: Motion) -> Opening | None:
    """The motion that opens what a certificate holds or lets slide.

    Args:
        data: The stance's arrays.
        cone: Exact cones or pyramids.
        motion: The certificate's, scaled.

    Returns:
        The motion and what is to stand still; None where the linear program fails.
    """
    rates, free = rates_map(data), limited(data)
    y = np.concatenate([motion.twist, motion.joints[free]])
    size = float(np.abs(y).max()) or 1.0
    rows: list[Array] = []
    owner: list[tuple[int, ...]] = []
    for i in _unbounded_points(data):
        columns = point_columns(data, i)
        for ray in _tight_rays(data, cone, i, rates[columns] @ y / size):
            rows.append(ray @ rates[columns])
            owner.append(tuple(columns))
    for j, sign in _half_limited(data, free):
        if sign * (rates[j] @ y) < TIGHT * size:
            rows.append(sign * rates[j])
            owner.append((j,))
    still = _unlimited(data)
    found = _least_opening(rows, rates[still])
    if found is None:
        openable = _openable(rows, owner, rates[still])
        if openable is None:
            return None
        still = [*still, *(j for columns in dict.fromkeys(owner) if columns not in openable for j in columns)]
        found = _least_opening([row for row, columns in zip(rows, owner, strict=True) if columns in openable], rates[still])
        if found is None:
            return None
    joints = np.zeros(len(data.torques.names))
    joints[free] = found[6:]
    return Opening(Motion(found[:6], joints), still)


def _least_opening(rows: list[Array], still: Array) -> Array | None:
    """The smallest motion that opens every row by one, None where there is none."""
    n = still.shape[1]
    if not rows:
        return np.zeros(n)
    eye, ones = np.eye(n), np.ones((n, 1))
    A = np.vstack([np.hstack([-np.array(rows), np.zeros((len(rows), 1))]), np.hstack([eye, -ones]), np.hstack([-eye, -ones])])
    right = np.concatenate([-np.ones(len(rows)), np.zeros(2 * n)])
    equal, zero = _at_rest(still, 1)
    solved = linprog(np.append(np.zeros(n), 1.0), A, right, equal, zero, [(None, None)] * n + [(0.0, MOST)], method="highs")
    return solved.x[:n] if solved.status == 0 else None


def _openable(rows: list[Array], owner: list[tuple[int, ...]], still: Array) -> set[tuple[int, ...]] | None:
    """The owners of rows that a motion opens without closing others; None where the program fails."""
    n, names = still.shape[1], list(dict.fromkeys(owner))
    A = np.zeros((len(rows), n + len(names)))
    A[:, :n] = -np.array(rows)
    A[np.arange(len(rows)), [n + names.index(one) for one in owner]] = 1.0
    cost = np.concatenate([np.zeros(n), -np.ones(len(names))])
    bounds = [(-MOST, MOST)] * n + [(0.0, 1.0)] * len(names)
    solved = linprog(cost, A, np.zeros(len(A)), *_at_rest(still, len(names)), bounds, method="highs")
    return {one for one, s in zip(names, solved.x[n:], strict=True) if s > 0.5} if solved.status == 0 else None


def _at_rest(still: Array, more: int) -> tuple[Array, Array] | tuple[None, None]:
    """The equations of the rates that are zero, with columns for further unknowns."""
    return (np.hstack([still, np.zeros((len(still), more))]), np.zeros(len(still))) if len(still) else (None, None)


def _unbounded_points(data: StaticsData) -> list[int]:
    """Points of the contacts whose normal force has no upper bound."""
    bounded = {int(k) for k, (_, hi) in zip(data.bounded, data.bounds, strict=True) if np.isfinite(hi)}
    return [i for i in range(data.points) if int(data.contact_of_point[i]) not in bounded]


def handle_limits(data: StaticsData) -> Array:
    """Lower and upper end of every handle component, infinite where there is none, scaled, shape (nh, 2)."""
    ends = np.tile([-np.inf, np.inf], (len(data.contact_of_handle), 1))
    for row, value in zip(data.limit_rows[: data.handle_limits], data.limit_values, strict=False):
        (j,) = np.flatnonzero(row[data.handle])
        upper = bool(row[data.handle][j] > 0)
        ends[j, int(upper)] = value if upper else -value
    return ends


def _unlimited(data: StaticsData) -> list[int]:
    """Columns of the handle components without any limit."""
    return [data.handle.start + int(j) for j in np.flatnonzero(~np.isfinite(handle_limits(data)).any(axis=1))]


def _half_limited(data: StaticsData, free: list[int]) -> list[tuple[int, float]]:
    """Rows of the rates that may have one sign only, that of the end that limits them, with that sign."""
    ends = np.vstack([handle_limits(data), data.torques.limits[free] if free else np.zeros((0, 2))])
    half = np.flatnonzero(np.isfinite(ends[:, 0]) != np.isfinite(ends[:, 1]))
    return [(data.handle.start + int(j), 1.0 if np.isfinite(ends[j, 0]) else -1.0) for j in half]


def _tight_rays(data: StaticsData, cone: ConeChoice, i: int, u: Array) -> Array:
    """Rays of unit normal component on which a velocity has to do no negative work and does next to none."""
    if i >= data.slipping:
        return np.ones((1, 1)) if u[0] < TIGHT else np.zeros((0, 1))
    soft = data.circular - data.box
    mu, spins, elliptic = float(data.friction[i]), i >= soft, i >= data.circular
    gamma = float(data.torsion[i - soft]) if spins else 0.0
    still = float(np.linalg.norm(u[:2])) < STILL and (not spins or gamma * abs(u[3]) < STILL)
    if not cone.is_exact:
        rays = _pyramid_rays(cone, mu, gamma, spins, elliptic)
    elif still:
        rays = _enclosing_rays(mu, gamma, spins, elliptic)
    else:
        rays = _active_rays(mu, gamma, spins, elliptic, u)
    return rays if still else rays[rays @ u < TIGHT]


def _ring(directions: Array, radius: float, spins: bool, moments: tuple[float, ...] = (0.0,)) -> Array:
    ones = np.ones((len(directions), 1))
    if not spins:
        return np.hstack([radius * directions, ones])
    return np.vstack([np.hstack([radius * directions, ones, m * ones]) for m in moments])


def _pyramid_rays(cone: ConeChoice, mu: float, gamma: float, spins: bool, elliptic: bool) -> Array:
    edges, reach = cone.edge_directions(), mu * cone.slope_factor() / np.cos(np.pi / (cone.sides or 1))
    if spins and elliptic and cone.kind == "inscribed":
        return np.vstack([_ring(edges, reach, True), _ring(edges, 0.0, True, (gamma, -gamma))])
    return _ring(edges, reach, spins, (gamma, -gamma))


def _enclosing_rays(mu: float, gamma: float, spins: bool, elliptic: bool) -> Array:
    """Rays whose cone holds the exact cone."""
    ring = np.column_stack([np.cos(RING), np.sin(RING)])
    if not spins or not elliptic:
        return _ring(ring, mu * WIDER, spins, (gamma, -gamma))
    up = np.pi * np.arange(-3, 4) / 7
    wider = WIDER / np.cos(np.pi / 14)
    rings = [_ring(ring, mu * wider * np.cos(a), True, (gamma * wider * np.sin(a),)) for a in up]
    return np.vstack([*rings, _ring(ring[:1], 0.0, True, (gamma * wider, -gamma * wider))])


def _active_rays(mu: float, gamma: float, spins: bool, elliptic: bool, u: Array) -> Array:
    """The ray of the exact cone that does least work on a velocity."""
    slide = mu * u[:2]
    if spins and elliptic:
        size = float(np.hypot(np.linalg.norm(slide), gamma * u[3]))
        return np.array([[*(-mu * slide / size), 1.0, -(gamma**2) * u[3] / size]])
    size = float(np.linalg.norm(slide))
    if not spins:
        return np.array([[*(-mu * slide / size), 1.0]])
    signs = (1.0, -1.0) if gamma * abs(u[3]) < STILL else (-float(np.sign(u[3])),)
    directions = np.column_stack([np.cos(RING), np.sin(RING)]) * WIDER if size < STILL * mu else -slide[None] / size
    return _ring(directions, mu, True, tuple(s * gamma for s in signs))
