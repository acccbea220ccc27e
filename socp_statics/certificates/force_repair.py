"""Floating-point forces moved by next to nothing: balanced to the last bits, and inside every cone, bound and limit by a little.

An answer's forces miss the balance by a solver's tolerance and touch active limits from either side. Exact arithmetic forgives neither.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from socp_statics.certificates.optimum import closed_limits
from socp_statics.cones.choice import ConeChoice
from socp_statics.models.contact_forces_set import bound_rows
from socp_statics.spatial import Array
from socp_statics.statics.statics_data import StaticsData
from socp_statics.statics.wrench_range import SINGULAR

ROOM = 1e-13
ROUNDS = 12
STIFFEST = 1e-7


class Slacks(NamedTuple):
    """How far forces are inside every inequality, and the derivative by x, shapes (m,) and (m, nx); whose contact or limit each is."""

    values: Array
    rows: Array
    owners: tuple[str, ...]


def force_slacks(data: StaticsData, cone: ConeChoice, x: Array) -> Slacks:
    """Slacks of cones (in normal force), bounds and hard rows at a point.

    Args:
        data: The stance's arrays.
        cone: Exact cones or pyramids.
        x: Scaled unknowns, shape (nx,).
    """
    values: list[float] = []
    rows: list[Array] = []
    owners: list[str] = []
    normal, first_spin = data.normal.start, data.torsional.start - (data.circular - data.box)

    def add(terms: dict[int, float]) -> None:
        owners.append(data.names[data.contact_of_point[i]])
        row = np.zeros(len(x))
        for j, v in terms.items():
            row[j] = v
        values.append(float(row @ x))
        rows.append(row)

    for i in range(data.points):
        n = normal + i
        if i >= data.slipping:
            add({n: 1.0})
            continue
        mu, t = data.friction[i] * (1.0 if cone.is_exact else cone.slope_factor()), (2 * i, 2 * i + 1)
        elliptic = i >= data.circular and cone.kind != "circumscribed"
        spin = i >= data.circular - data.box
        gamma = data.torsion[i - (data.circular - data.box)] if spin else 0.0
        if cone.is_exact:
            place = [*t, first_spin + i] if elliptic else [*t]
            f = x[place] / np.array([mu, mu, gamma][: len(place)])
            size = float(np.linalg.norm(f))
            along = f / size if size > 0.0 else f
            add({n: 1.0} | {j: -float(a) / s for j, a, s in zip(place, along, (mu, mu, gamma), strict=False)})
        else:
            for a, b in cone.face_normals():
                for sign in (1.0, -1.0) if elliptic else (0.0,):
                    add({n: 1.0, t[0]: -a / mu, t[1]: -b / mu} | ({first_spin + i: -sign / gamma} if elliptic else {}))
        if spin and not elliptic:
            add({n: 1.0, first_spin + i: -1.0 / gamma})
            add({n: 1.0, first_spin + i: 1.0 / gamma})
    bounds = bound_rows(data)
    for ends, limits, sign in ((bounds.lower, bounds.lower_values, 1.0), (bounds.upper, bounds.upper_values, -1.0)):
        for end, limit in zip(ends, limits, strict=True):
            row = np.zeros(len(x))
            row[data.normal] = sign * end
            rows.append(row)
            values.append(float(row @ x) - sign * limit)
            owners.append(data.names[data.contact_of_point[int(np.argmax(end))]])
    closed = {k for pair in closed_limits(data) for k in pair}
    for k in range(len(data.limit_values)):
        if k not in closed:
            rows.append(-data.limit_rows[k])
            values.append(float(data.limit_values[k] - data.limit_rows[k] @ x))
            owners.append(data.limit_names[k])
    return Slacks(np.array(values), np.array(rows).reshape(-1, len(x)), tuple(owners))


def equality_rows(data: StaticsData) -> tuple[Array, Array]:
    """Rows beside the balance that forces meet exactly, and their values: equal bounds, limits without room.

    Args:
        data: The stance's arrays.

    Returns:
        Shapes (k, nx) and (k,); equal bounds first, then closed limits by their upper end.
    """
    bounds = bound_rows(data)
    rows = np.zeros((len(bounds.equal), data.wrench_map.shape[1]))
    rows[:, data.normal] = bounds.equal
    upper = [a for a, _ in closed_limits(data)]
    return np.vstack([rows, data.limit_rows[upper]]), np.concatenate([bounds.equal_values, data.limit_values[upper]])


def unloaded(data: StaticsData, x: Array) -> Array:
    """Columns of x that stay zero: those of contact points without any force."""
    none = x[data.normal] == 0.0
    fixed = np.zeros(len(x), dtype=bool)
    fixed[data.normal] = none
    fixed[data.tangential] = np.repeat(none[: data.slipping], 2)
    fixed[data.torsional] = none[data.circular - data.box : data.slipping]
    return fixed


def column_weights(data: StaticsData, x: Array) -> Array:
    """How readily each component gives: by the force that its point carries, the more the better; never none, but for unloaded points."""
    fraction = np.clip(x[data.normal], STIFFEST, 1.0)
    weights = np.ones(len(x))
    weights[data.normal] = fraction
    weights[data.tangential] = np.repeat(fraction[: data.slipping] * np.minimum(data.friction, 1.0), 2)
    weights[data.torsional] = fraction[data.circular - data.box : data.slipping] * np.minimum(data.torsion, 1.0)
    weights[unloaded(data, x)] = 0.0
    return weights


def repaired(data: StaticsData, cone: ConeChoice, x: Array, room: float = ROOM) -> Array:
    """Forces next to the given ones with their balance restored and ``room`` to every inequality, where that can be had.

    Args:
        data: The stance's arrays.
        cone: Exact cones or pyramids.
        x: Scaled unknowns, shape (nx,).
        room: Slack asked for, in units of W, times the largest force.
    """
    more, values = equality_rows(data)
    E = np.vstack([data.wrench_map, more])
    weights = column_weights(data, x)
    asked = room * max(1.0, float(np.abs(x).max(initial=0.0)))
    active = np.zeros(0, dtype=bool)
    for _ in range(ROUNDS):
        missing = np.concatenate([-(data.wrench_map @ x + data.load), values - more @ x])
        slacks = force_slacks(data, cone, x)
        seen = np.abs(slacks.rows) @ weights > 0.0
        active = (active if len(active) else np.zeros(len(seen), dtype=bool)) | (seen & (slacks.values < asked))
        short = active & (slacks.values < 2.0 * asked)
        if (
            float(np.abs(missing).max(initial=0.0)) < 1e-15 * max(1.0, float(np.abs(x).max(initial=0.0)))
            and not (seen & (slacks.values < asked)).any()
        ):
            break
        rows, wanted = slacks.rows[short], 3.0 * asked - slacks.values[short]
        A = np.vstack([E, rows]) * weights
        step = np.linalg.lstsq(A, np.concatenate([missing, wanted]), rcond=SINGULAR)[0]
        x = x + weights * step
    return x
