"""Where the optimal forces and multipliers of a program lie: the linear spaces of their optimal faces.

An optimum is unique where its face is a point. The spaces are those of complementary faces: a force inside its cone leaves its
multiplier no freedom, a force on the boundary leaves it a ray, no force leaves it everything; and the other way round. What is
neither clearly zero nor clearly positive counts as free on both sides, so that a unique optimum may be called doubtful, never the other
way round.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from socp_statics.certificates.optimum import Optimum, closed_limits
from socp_statics.cones.choice import ConeChoice
from socp_statics.models.contact_forces_set import bound_rows
from socp_statics.spatial import Array

ACTIVE = 1e-6
RANK = 1e-6
DISC, BALL, BOX, PYRAMID, DOUBLE_PYRAMID, PRISM, RAY = range(7)


class Faces(NamedTuple):
    """Bases of the directions in which optimal points can differ.

    Attributes:
        forces: Directions of x, one a row, shape (p, nx).
        multipliers: Directions of the packed multipliers, one a row, shape (q, ny).
    """

    forces: Array
    multipliers: Array


class _Point(NamedTuple):
    """A contact point in coordinates in which its cone has slope one: reserve-free normal part first, then slopes.

    Attributes:
        columns: Where its components are in x: normal, then tangential, then torsional.
        scale: What divides the force components (and multiplies the multipliers), shape (1 to 4,).
        kind: Shape of the section of its cone.
    """

    columns: list[int]
    scale: Array
    kind: int


def optimal_faces(optimum: Optimum) -> Faces:
    """The spaces of the optimal faces of a program.

    Args:
        optimum: Forces and multipliers.

    Returns:
        Bases of the directions in which optimal forces and multipliers can differ.
    """
    data, points = optimum.data, _points(optimum) if optimum.coned else []
    nx, k = len(optimum.x), len(optimum.shares)
    lam = optimum.contact_multipliers
    # Unknowns of the forces are (x, e), of the multipliers the packed vector.
    force_rows = [np.hstack([data.wrench_map, optimum.columns])]
    multiplier_rows = [optimum.contact_map[data.handle] if optimum.coned else optimum.contact_map]
    for point in points:
        shifted = np.zeros((len(point.columns), nx + k))
        shifted[np.arange(len(point.columns)), point.columns] = 1.0 / point.scale
        shifted[0, nx:] -= optimum.shares
        f = optimum.x[point.columns] / point.scale
        f[0] -= optimum.reserve
        u = lam[point.columns] * point.scale
        force_rows.append(_off(_exposed(point.kind, u, optimum.cone)) @ shifted)
        multiplier_rows.append(_off(_supporting(point.kind, f, optimum.cone)) @ (point.scale[:, None] * optimum.contact_map[point.columns]))
    fixed_forces, fixed_multipliers = _inequalities(optimum)
    force_rows.append(fixed_forces)
    if optimum.pinned:
        force_rows.append(np.eye(nx + k)[nx:])
    multiplier_rows += [fixed_multipliers, _stationarity(optimum)]
    forces = _null(np.vstack(force_rows))[:, :nx]
    return Faces(forces, _null(np.vstack(multiplier_rows)))


def _points(optimum: Optimum) -> list[_Point]:
    data, cone = optimum.data, optimum.cone
    n = data.normal.start
    soft = data.circular - data.box
    out = []
    for i in range(data.points):
        columns, scale = [n + i], [1.0]
        if i < data.slipping:
            mu = data.friction[i] * (1.0 if cone.kind == "exact" else cone.slope_factor())
            columns, scale = [n + i, 2 * i, 2 * i + 1], [1.0, mu, mu]
        if soft <= i < data.slipping:
            columns.append(data.torsional.start + i - soft)
            scale.append(data.torsion[i - soft])
        out.append(_Point(columns, np.array(scale), _kind(optimum, i)))
    return out


def _kind(optimum: Optimum, i: int) -> int:
    data, exact = optimum.data, optimum.cone.kind == "exact"
    if i >= data.slipping:
        return RAY
    if i < data.circular - data.box:
        return DISC if exact else PYRAMID
    if i < data.circular:
        return BOX if exact else PRISM
    return BALL if exact else PRISM if optimum.cone.kind == "circumscribed" else DOUBLE_PYRAMID


def _vertices(kind: int, cone: ConeChoice) -> Array:
    """Corners of the section of a polyhedral cone at normal force one, shape (m, 2 or 3)."""
    flat = cone.edge_directions() / np.cos(np.pi / cone.sides)  # type: ignore[operator]
    if kind == PYRAMID:
        return flat
    if kind == PRISM:
        return np.vstack([np.column_stack([flat, np.full(len(flat), s)]) for s in (-1.0, 1.0)])
    return np.vstack([np.column_stack([flat, np.zeros(len(flat))]), [[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]]])


def _normals(kind: int, cone: ConeChoice) -> Array:
    """Faces ``a . q <= 1`` of the section of a polyhedral cone, shape (m, 2 or 3)."""
    flat = cone.face_normals()
    if kind == PYRAMID:
        return flat
    if kind == PRISM:
        return np.vstack([np.column_stack([flat, np.zeros(len(flat))]), [[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]]])
    return np.vstack([np.column_stack([flat, np.full(len(flat), s)]) for s in (-1.0, 1.0)])


def _exposed(kind: int, u: Array, cone: ConeChoice) -> Array:
    """Span of the forces in the cone that do no work on a velocity u, as columns."""
    n, everything = len(u), np.eye(len(u))
    if np.abs(u).max() <= ACTIVE:
        return everything
    if kind in (DISC, BALL, RAY):
        slip = float(np.linalg.norm(u[1:]))
        return np.zeros((n, 0)) if u[0] - slip > ACTIVE else np.concatenate([[slip], -u[1:]])[:, None]
    if kind == BOX:
        slip, spin = float(np.linalg.norm(u[1:3])), abs(float(u[3]))
        if u[0] - slip - spin > ACTIVE:
            return np.zeros((n, 0))
        corner = np.array([1.0, *(-u[1:3] / slip if slip > ACTIVE else (0.0, 0.0)), -np.sign(u[3]) if spin > ACTIVE else 0.0])
        free = [e for e, fixed in zip(everything[1:], (slip, slip, spin), strict=True) if fixed <= ACTIVE]
        return np.column_stack([corner, *free])
    rays = np.column_stack([np.ones(len(v := _vertices(kind, cone))), v])
    return rays[rays @ u <= ACTIVE].T


def _supporting(kind: int, f: Array, cone: ConeChoice) -> Array:
    """Span of the velocities of the dual cone on which a force f in the cone does no work, as columns."""
    n, everything = len(f), np.eye(len(f))
    if f[0] <= ACTIVE:
        return everything
    if kind in (DISC, BALL, BOX):
        parts = [np.arange(1, n)] if kind != BOX else [np.array([1, 2]), np.array([3])]
        rays = []
        for part in parts:
            size = float(np.linalg.norm(f[part]))
            if f[0] - size <= ACTIVE:
                ray = np.zeros(n)
                ray[0], ray[part] = 1.0, -f[part] / size
                rays.append(ray)
        return np.array(rays).reshape(-1, n).T
    if kind == RAY:
        return np.zeros((1, 0))
    a = _normals(kind, cone)
    tight = a[f[0] - a @ f[1:] <= ACTIVE]
    return np.column_stack([np.ones(len(tight)), -tight]).T


def _off(span: Array) -> Array:
    """Rows that vanish exactly on a span."""
    U, s, _ = np.linalg.svd(span, full_matrices=True)
    return U[:, int((s > ACTIVE).sum()) :].T


def _inequalities(optimum: Optimum) -> tuple[Array, Array]:
    """Rows over (x, e) of bounds and limits that stay tight, and rows over the multipliers of those that stay slack."""
    data, m, rows = optimum.data, optimum.multipliers, bound_rows(optimum.data)
    nx, k = len(optimum.x), len(optimum.shares)
    N = optimum.x[data.normal]
    t, shift = optimum.reserve, optimum.shares
    forces, slack = [], []
    for sums, values, sign in ((rows.lower, rows.lower_values, -1.0), (rows.upper, rows.upper_values, 1.0)):
        row = np.zeros((len(sums), nx + k))
        row[:, data.normal], row[:, nx:] = sign * sums, shift
        forces.append(row)
        slack.append(sign * (values - sums @ N) - t if optimum.coned else np.full(len(sums), np.inf))
    equal = np.zeros((len(rows.equal), nx + k))
    equal[:, data.normal] = rows.equal
    limits = np.hstack([data.limit_rows, -optimum.relief])
    forces += [equal, limits]
    slack += [np.zeros(len(equal)), data.limit_values - data.limit_rows @ optimum.x + optimum.relief @ _unknowns(optimum)]
    tight = [m.lower > ACTIVE, m.upper > ACTIVE, np.ones(len(equal), dtype=bool), m.limits > ACTIVE]
    closed = [min(pair, key=lambda i: m.limits[i]) for pair in closed_limits(data)]
    slack[-1][closed] = np.inf
    loose = np.flatnonzero(np.concatenate(slack) > ACTIVE)
    still = np.zeros((len(loose), len(m.packed)))
    still[np.arange(len(loose)), 6 + loose] = 1.0
    return np.vstack(forces)[np.concatenate(tight)], still


def _unknowns(optimum: Optimum) -> Array:
    """The further unknowns e at the optimum, from the balance and the reserve."""
    left = np.append(-(optimum.data.load + optimum.data.wrench_map @ optimum.x), optimum.reserve)
    return np.linalg.lstsq(np.vstack([optimum.columns, optimum.shares]), left, rcond=None)[0]


def _stationarity(optimum: Optimum) -> Array:
    """Rows over the multipliers that keep the Lagrangian stationary in the further unknowns."""
    rows, normal = bound_rows(optimum.data), optimum.data.normal
    out = np.zeros((len(optimum.shares), len(optimum.multipliers.packed)))
    out[:, :6] = optimum.columns.T
    bounded = np.zeros(out.shape[1])
    bounded[6 : 6 + len(rows.lower) + len(rows.upper)] = 1.0
    out += optimum.shares[:, None] * (optimum.contact_map[normal].sum(axis=0) + bounded)
    out[:, out.shape[1] - len(optimum.multipliers.limits) :] -= optimum.relief.T
    return out


def _null(rows: Array) -> Array:
    """Orthonormal rows of the null space, directions that rounding cannot tell from it included."""
    _, s, Vt = np.linalg.svd(rows, full_matrices=True)
    return Vt[int((s > RANK * max(1.0, float(s.max(initial=0.0)))).sum()) :]
