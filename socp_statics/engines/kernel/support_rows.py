"""The support direction of any stance as rows of the general method; unknowns are forces, and torques of limited joints.

    E x = e      forces, and moments about the direction of gravity, balance
    T x - y = 0  torques y of the joints that are limited, each beside its limits: they keep the rows sparse
    S x = n      normal forces of contacts with equal bounds
    c = r + C x  the other two moments say where the centre of mass is

In units of W and size about the mean contact point.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from socp_statics.cones.choice import ConeChoice
from socp_statics.contacts import Stance
from socp_statics.engines.kernel.limited_rows import limited_rows
from socp_statics.engines.kernel.row_patterns import Cones, rows_of
from socp_statics.spatial import Array
from socp_statics.statics.joint_torques import passive_torque
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
        wrench_map: Wrenches of unit forces, shape (6, nx).
        origin: Mean contact point, world axes, shape (3,) [m].
        size: Largest distance between contact points [m].
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
    wrench_map: Array
    origin: Array
    size: float


def support_rows(data: StaticsData, cone: ConeChoice) -> SupportRows:
    """The rows of any stance.

    Args:
        data: The stance's arrays; gravity is neither zero nor horizontal.
        cone: Exact cones or pyramids.
    """
    G, nx = data.wrench_map, data.wrench_map.shape[1]
    pull = np.array([-data.com_load[5, 1], data.com_load[5, 0], data.com_load[3, 1]])
    lift = np.vstack([np.linalg.pinv(data.com_load[3:]), pull / np.linalg.norm(pull)])
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
    rows = rows_of(Cones(
        data.circular, data.box, data.elliptic, data.frictionless, nx, cone, data.friction.tobytes(), data.torsion.tobytes(),
        data.contact_of_point.tobytes(), data.bounded[below].tobytes(), data.bounded[above].tobytes(),
        data.limit_rows[:handles].tobytes(), finite[joints, 0].tobytes(), finite[joints, 1].tobytes(),
    ))  # fmt: skip
    h = np.zeros(len(rows.start) - 1)
    ends = _torque_ends(data.torques.passive[joints], limits[joints], finite[joints])
    h[rows.homogeneous : rows.orthant] = np.concatenate([-bounds[below, 0], bounds[above, 1], data.limit_values[:handles], ends])
    origin, size = data.units.origin, data.units.length
    return SupportRows(A, b, rows.start, rows.column, rows.value, h, rows.orthant, rows.soc, position, lift, joints, G, origin, size)


def point_rows(stance: Stance, load: Array, cone: ConeChoice) -> SupportRows:
    """The rows of a robot whose joints are limited and whose contacts are points with friction, without the detour of `assemble`.

    Args:
        stance: The stance, with torque limits; gravity is neither zero nor horizontal.
        load: Its load, see `tracing.trace`.
        cone: Exact cones or pyramids.
    """
    points, contacts, posture, limits = stance.contacts.friction_points, tuple(stance.contacts), stance.posture, stance.torque_limits
    assert points is not None and limits is not None
    finite = np.isfinite(limits)
    joints = np.flatnonzero(finite[:, 0] | finite[:, 1])
    first = [k for k, c in enumerate(contacts) if c.friction > 0.0 for _ in range(len(c.points_C))]
    owner = first + [k for k, c in enumerate(contacts) if c.friction == 0.0 for _ in range(len(c.points_C))]
    A, b, position, G, lift, origin, size = limited_rows(
        points, len(first), np.array(owner), np.array([c.position for c in contacts]),
        np.array([posture.jacobian[c.name] for c in contacts]), joints, load,
    )  # fmt: skip
    finite = finite[joints]
    none = b""
    rows = rows_of(Cones(
        len(first), 0, 0, len(owner) - len(first), G.shape[1], cone, points[: len(first), 12].tobytes(), none, none, none, none, none,
        finite[:, 0].tobytes(), finite[:, 1].tobytes(),
    ))  # fmt: skip
    h = np.zeros(len(rows.start) - 1)
    h[rows.homogeneous : rows.orthant] = _torque_ends(passive_torque(stance)[joints], limits[joints], finite) / (load[9] * size)
    return SupportRows(A, b, rows.start, rows.column, rows.value, h, rows.orthant, rows.soc, position, lift, joints, G, origin, size)


def _torque_ends(passive: Array, limits: Array, finite: NDArray[np.bool_]) -> Array:
    """Right-hand sides of ``y <= passive - lower`` and ``-y <= upper - passive`` where they are finite: ``passive - y`` is the torque."""
    return np.concatenate([(passive - limits[:, 0])[finite[:, 0]], (limits[:, 1] - passive)[finite[:, 1]]])


def _bounded_ends(bounds: Array) -> tuple[NDArray[np.int_], NDArray[np.int_], NDArray[np.int_]]:
    """Which bounds are equalities, which bound from below, which from above."""
    equal = bounds[:, 0] == bounds[:, 1]
    return np.flatnonzero(equal), np.flatnonzero(~equal), np.flatnonzero(~equal & np.isfinite(bounds[:, 1]))
