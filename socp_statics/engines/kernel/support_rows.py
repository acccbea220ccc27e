"""The support direction of any stance as rows of the general method; unknowns are forces, and torques of limited joints.

    E x = e      forces, and moments about the direction of gravity, balance
    T x - y = 0  torques y of the joints that are limited, each beside its limits: they keep the rows sparse
    S x = n      normal forces of contacts with equal bounds
    c = r + C x  the other two moments say where the centre of mass is

What the rows of cones and limits are does not depend on where the contacts are; they are made once for contacts of a kind.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from socp_statics.cones.choice import ConeChoice
from socp_statics.spatial import Array
from socp_statics.statics.statics_data import StaticsData


class SupportRows(NamedTuple):
    """A program without its cost; see `plan_tracing.trace_plan` and `plan.plan_rows`.

    Attributes:
        A: Equality rows, shape (p, n).
        b: Their right-hand sides.
        start: Where each row of G begins, shape (m + 1,).
        column: Columns of G's entries.
        value: Values of G's entries.
        h: Right-hand sides of the cone rows, shape (m,).
        orthant: Number of rows of the orthant, the first ones.
        soc: Dimensions of the second-order cones.
        position: ``[C r]``, shape (2, n + 1).
        lift: Pseudoinverse of the moments of a displacement along x and y, shape (2, 3), then the direction of gravity.
        joints: Indices of the limited joints, whose rows of A follow the four of the balance.
    """

    A: Array
    b: Array
    start: NDArray[np.int64]
    column: NDArray[np.int64]
    value: Array
    h: Array
    orthant: int
    soc: NDArray[np.int64]
    position: Array
    lift: Array
    joints: NDArray[np.int_]


def lifted(com_load: Array) -> Array:
    """Rows that turn moments into horizontal displacements of the centre of mass, and the direction of gravity, shape (3, 3).

    Args:
        com_load: Change of the load per displacement along world x and y, shape (6, 2).
    """
    wx, wy, wz = -float(com_load[5, 1]), float(com_load[5, 0]), float(com_load[3, 1])
    xx, yy, xy = wy * wy + wz * wz, wx * wx + wz * wz, -wx * wy
    det, norm = xx * yy - xy * xy, (wx * wx + wy * wy + wz * wz) ** 0.5
    return np.array([
        [-xy * wz / det, -yy * wz / det, (yy * wy + xy * wx) / det],
        [xx * wz / det, xy * wz / det, (-xy * wy - xx * wx) / det],
        [wx / norm, wy / norm, wz / norm],
    ])  # fmt: skip


class _Cones(NamedTuple):
    """Everything that the cone rows depend on; where contacts are does not matter. Arrays are given as bytes, so that this is a key."""

    circular: int
    box: int
    elliptic: int
    frictionless: int
    columns: int
    cone: ConeChoice
    friction: bytes
    torsion: bytes
    owner: bytes
    below: bytes
    above: bytes
    handles: bytes
    lower: bytes
    upper: bytes


class _ConeRows(NamedTuple):
    """Cone rows: see `SupportRows`; how many of the orthant's come before those of bounds and limits, which alone have right-hand sides."""

    start: NDArray[np.int64]
    column: NDArray[np.int64]
    value: Array
    orthant: int
    soc: NDArray[np.int64]
    homogeneous: int


def support_rows(data: StaticsData, cone: ConeChoice) -> SupportRows:
    """The rows of a stance.

    Args:
        data: The stance's arrays; gravity is neither zero nor horizontal.
        cone: Exact cones or pyramids.
    """
    G, nx = data.wrench_map, data.wrench_map.shape[1]
    lift = lifted(data.com_load)
    limits = data.torques.limits
    finite = np.isfinite(limits)
    joints = np.flatnonzero(finite[:, 0] | finite[:, 1])
    n, rest = nx + len(joints), 4 + len(joints)
    bounds, (equal, below, above) = data.bounds, _bounded_ends(data.bounds)
    A, b = np.zeros((rest + len(equal), n)), np.zeros(rest + len(equal))
    A[:3, :nx], b[:3] = G[:3], -data.load[:3]
    moments = lift @ G[3:]
    about = lift @ data.load[3:]
    A[3, :nx], b[3] = moments[2], -about[2]
    position = np.zeros((2, n + 1))
    # The load has the centre of mass where it is.
    position[:, :nx], position[:, n] = -moments[:2], data.com[:2] - about[:2]
    if len(joints):
        A[4:rest, :nx] = data.torques.map[joints]
        A[4:rest, nx:] = -np.eye(len(joints))
    if len(equal):
        A[rest:, data.normal], b[rest:] = data.contact_of_point == data.bounded[equal, None], bounds[equal, 0]

    handles = data.handle_limits
    rows = _cone_rows(_Cones(
        data.circular, data.box, data.elliptic, data.frictionless, nx, cone, data.friction.tobytes(), data.torsion.tobytes(),
        data.contact_of_point.tobytes(), data.bounded[below].tobytes(), data.bounded[above].tobytes(),
        data.limit_rows[:handles].tobytes(), finite[joints, 0].tobytes(), finite[joints, 1].tobytes(),
    ))  # fmt: skip
    h = np.zeros(len(rows.start) - 1)
    # ``passive - y`` is the torque.
    ends = data.torques.passive[joints] - limits[joints].T
    h[rows.homogeneous : rows.orthant] = np.concatenate(
        [-bounds[below, 0], bounds[above, 1], data.limit_values[:handles], ends[0, finite[joints, 0]], -ends[1, finite[joints, 1]]]
    )
    return SupportRows(A, b, rows.start, rows.column, rows.value, h, rows.orthant, rows.soc, position, lift, joints)


def _bounded_ends(bounds: Array) -> tuple[NDArray[np.int_], NDArray[np.int_], NDArray[np.int_]]:
    """Which bounds are equalities, which bound from below, which from above."""
    equal = bounds[:, 0] == bounds[:, 1]
    return np.flatnonzero(equal), np.flatnonzero(~equal), np.flatnonzero(~equal & np.isfinite(bounds[:, 1]))


@lru_cache(maxsize=256)
def _cone_rows(key: _Cones) -> _ConeRows:
    """Rows of the cones, bounds and limits."""
    n = key.columns + len(key.lower)
    flat, limited, (tip, soc) = _flat_rows(key, n), [*_bound_rows(key, n), *_limit_rows(key, n)], _round_rows(key, n)
    homogeneous = sum(map(len, flat))
    rows = np.concatenate([np.zeros((0, n)), *flat, *limited, tip])
    some = np.flatnonzero(rows)
    start = np.searchsorted(some, n * np.arange(len(rows) + 1))
    return _ConeRows(start, some % n, rows.ravel()[some], homogeneous + sum(map(len, limited)), soc, homogeneous)


def _flat_rows(key: _Cones, n: int) -> list[Array]:
    """Rows ``g x <= 0`` of frictionless points, of box soft fingers and of pyramids."""
    out, cone = [], key.cone
    slipping = key.circular + key.elliptic
    first = 2 * slipping
    turning = first + slipping + key.frictionless
    friction, torsion = np.frombuffer(key.friction), np.frombuffer(key.torsion)
    if key.frictionless:
        out.append(np.zeros((key.frictionless, n)))
        out[-1][range(key.frictionless), range(first + slipping, turning)] = -1.0
    boxes = key.box + (key.elliptic if cone.kind == "circumscribed" else 0)
    circular = key.circular + boxes - key.box
    if boxes:
        spin = np.zeros((2, boxes, n))
        each = np.arange(boxes)
        spin[0, each, turning + each], spin[1, each, turning + each] = 1.0, -1.0
        spin[:, each, first + circular - boxes + each] = -torsion[:boxes]
        out.append(spin.reshape(-1, n))
    if not cone.is_exact:
        assert cone.sides is not None
        mu, faces = friction * cone.slope_factor(), cone.face_normals()
        sides = np.zeros((slipping, cone.sides, n))
        each = np.arange(slipping)
        sides[each, :, 2 * each], sides[each, :, 2 * each + 1] = faces[:, 0], faces[:, 1]
        sides[each, :, first + each] = -mu[:, None]
        out.append(sides[:circular].reshape(-1, n))
        for sign in (1.0, -1.0) if slipping > circular else ():
            turned = sides[circular:].copy()
            each = np.arange(slipping - circular)
            turned[each, :, turning + boxes + each] = (sign * mu[circular:] / torsion[boxes:])[:, None]
            out.append(turned.reshape(-1, n))
    return out


def _bound_rows(key: _Cones, n: int) -> list[Array]:
    """Rows of the bounds of normal forces."""
    owner, first = np.frombuffer(key.owner, dtype=int), 2 * (key.circular + key.elliptic)
    out = []
    for sign, bounded in ((-1.0, key.below), (1.0, key.above)):
        mine = np.frombuffer(bounded, dtype=int)
        rows = np.zeros((len(mine), n))
        rows[:, first : first + len(owner)] = sign * (owner == mine[:, None])
        out.append(rows)
    return out


def _limit_rows(key: _Cones, n: int) -> list[Array]:
    """Rows of the finite limits of handles, and of the torques, which are unknowns of their own."""
    handles = np.frombuffer(key.handles).reshape(-1, key.columns)
    some, other = (np.frombuffer(end, dtype=bool).nonzero()[0] for end in (key.lower, key.upper))
    rows = np.zeros((len(handles) + len(some) + len(other), n))
    rows[: len(handles), : key.columns] = handles
    rows[range(len(handles), len(rows) - len(other)), key.columns + some] = 1.0
    rows[range(len(rows) - len(other), len(rows)), key.columns + other] = -1.0
    return [rows]


def _round_rows(key: _Cones, n: int) -> tuple[Array, NDArray[np.int64]]:
    """Rows of the second-order cones ``(mu f_n, f_t)`` and ``(mu f_n, f_t, (mu / gamma) m_n)``, and their dimensions."""
    if not key.cone.is_exact:
        return np.zeros((0, n)), np.zeros(0, np.int64)
    slipping, circular = key.circular + key.elliptic, key.circular
    friction, torsion = np.frombuffer(key.friction), np.frombuffer(key.torsion)
    rows = np.zeros((3 * slipping + key.elliptic, n))
    each = np.arange(slipping)
    head = 3 * each + np.maximum(each - circular, 0)
    rows[head, 2 * slipping + each] = -friction
    rows[head + 1, 2 * each] = rows[head + 2, 2 * each + 1] = -1.0
    turning = 3 * slipping + key.frictionless + key.box
    rows[head[circular:] + 3, turning + np.arange(key.elliptic)] = -friction[circular:] / torsion[key.box :]
    return rows, np.array([3] * circular + [4] * key.elliptic, dtype=np.int64)
