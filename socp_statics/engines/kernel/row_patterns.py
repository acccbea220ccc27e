"""Rows of cones, bounds and limits for the general method; contacts of a kind share them, wherever they are.

    g x <= h    frictionless points, box soft fingers and pyramids, with h = 0; bounds of normal forces; limits of grips and torques
    |(f_t, (mu / gamma) m_n)| <= mu f_n    points with friction, elliptic soft fingers; over mu where it is below 1

Torques are unknowns of their own, behind the forces.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from socp_statics.cones.choice import ConeChoice
from socp_statics.spatial import Array


class Cones(NamedTuple):
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


class ConeRows(NamedTuple):
    """Cone rows, see `support_rows.SupportRows`; how many of them come before those of bounds and limits, which have right-hand sides."""

    start: NDArray[np.int64]
    column: NDArray[np.int64]
    value: Array
    orthant: int
    soc: NDArray[np.int64]
    homogeneous: int


@lru_cache(maxsize=256)
def rows_of(key: Cones) -> ConeRows:
    """Rows of the cones, bounds and limits."""
    n = key.columns + len(key.lower)
    flat, limited, (tip, soc) = _flat_rows(key, n), [*_bound_rows(key, n), *_limit_rows(key, n)], _round_rows(key, n)
    homogeneous = sum(map(len, flat))
    rows = np.concatenate([np.zeros((0, n)), *flat, *limited, tip])
    some = np.flatnonzero(rows)
    start = np.searchsorted(some, n * np.arange(len(rows) + 1))
    return ConeRows(start, some % n, rows.ravel()[some], homogeneous + sum(map(len, limited)), soc, homogeneous)


def _flat_rows(key: Cones, n: int) -> list[Array]:
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
        # In units of the normal force, like everything else that is compared with a tolerance.
        spin[0, each, turning + each], spin[1, each, turning + each] = 1.0 / torsion[:boxes], -1.0 / torsion[:boxes]
        spin[:, each, first + circular - boxes + each] = -1.0
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


def _bound_rows(key: Cones, n: int) -> list[Array]:
    """Rows of the bounds of normal forces."""
    owner, first = np.frombuffer(key.owner, dtype=int), 2 * (key.circular + key.elliptic)
    out = []
    for sign, bounded in ((-1.0, key.below), (1.0, key.above)):
        mine = np.frombuffer(bounded, dtype=int)
        rows = np.zeros((len(mine), n))
        rows[:, first : first + len(owner)] = sign * (owner == mine[:, None])
        out.append(rows)
    return out


def _limit_rows(key: Cones, n: int) -> list[Array]:
    """Rows of the finite limits of handles, and of the torques, which are unknowns of their own."""
    handles = np.frombuffer(key.handles).reshape(-1, key.columns)
    some, other = (np.frombuffer(end, dtype=bool).nonzero()[0] for end in (key.lower, key.upper))
    rows = np.zeros((len(handles) + len(some) + len(other), n))
    rows[: len(handles), : key.columns] = handles
    rows[range(len(handles), len(rows) - len(other)), key.columns + some] = 1.0
    rows[range(len(rows) - len(other), len(rows)), key.columns + other] = -1.0
    return [rows]


def _round_rows(key: Cones, n: int) -> tuple[Array, NDArray[np.int64]]:
    """Rows of the second-order cones ``(mu f_n, f_t)`` and ``(mu f_n, f_t, (mu / gamma) m_n)``, and their dimensions."""
    if not key.cone.is_exact:
        return np.zeros((0, n)), np.zeros(0, np.int64)
    slipping, circular = key.circular + key.elliptic, key.circular
    friction, torsion = np.frombuffer(key.friction), np.frombuffer(key.torsion)
    rows = np.zeros((3 * slipping + key.elliptic, n))
    each = np.arange(slipping)
    head = 3 * each + np.maximum(each - circular, 0)
    # What misses a cone by little has a normal force that misses zero by as little, however small the friction is.
    unit = np.maximum(1.0, 1.0 / friction)
    rows[head, 2 * slipping + each] = -friction * unit
    rows[head + 1, 2 * each] = rows[head + 2, 2 * each + 1] = -unit
    turning = 3 * slipping + key.frictionless + key.box
    rows[head[circular:] + 3, turning + np.arange(key.elliptic)] = -(friction * unit)[circular:] / torsion[key.box :]
    return rows, np.array([3] * circular + [4] * key.elliptic, dtype=np.int64)
