"""Equality rows of a support direction with limited joints, from contact points and Jacobians in the world, in compiled code."""

from __future__ import annotations

import numpy as np

from socp_statics.engines.kernel.compilation import entry
from socp_statics.engines.kernel.friction_points import centre_and_size, cross, lifted, scaled_load


@entry(
    "Tuple((float64[:,::1], float64[::1], float64[:,::1], float64[:,::1], float64[:,::1], float64[::1], float64))"
    "(float64[:,::1], int64, int64[::1], float64[:,::1], float64[:,:,::1], int64[::1], float64[::1])"
)
def limited_rows(points, slipping, owner, frames, jacobian, joints, load13):
    """The rows of `support_rows.SupportRows` that depend on where the contacts are.

    Args:
        points: Contact points, those with friction first, shape (n, 14), see `friction_points`.
        slipping: How many have friction.
        owner: Index of each point's contact, shape (n,).
        frames: Position of each contact, shape (c, 3) [m].
        jacobian: Velocity of each contact frame due to joint rates, ``[linear; angular]``, shape (c, 6, all joints).
        joints: Indices of the limited joints.
        load13: See `tracing.trace`.

    Returns:
        A, b, position, wrench map and lift, scaled; mean contact point and size [m].
    """
    n = points.shape[0]
    nx = 2 * slipping + n
    A, b, position = np.zeros((4 + len(joints), nx + len(joints))), np.zeros(4 + len(joints)), np.zeros((2, nx + len(joints) + 1))
    G, lift, centre, load, pull = np.empty((6, nx)), np.empty((3, 3)), np.empty(3), np.empty(6), np.empty(3)
    size = centre_and_size(points, centre)
    scaled_load(load13, centre, size, load, pull)
    lifted(pull, lift)
    for k in range(n):
        frame, J = frames[owner[k]], jacobian[owner[k]]
        x, y, z = (points[k, 0] - centre[0]) / size, (points[k, 1] - centre[1]) / size, (points[k, 2] - centre[2]) / size
        u, v, w = (points[k, 0] - frame[0]) / size, (points[k, 1] - frame[1]) / size, (points[k, 2] - frame[2]) / size
        for axis in range(0 if k < slipping else 2, 3):
            j, at = 2 * slipping + k if axis == 2 else 2 * k + axis, 3 + 3 * axis
            f0, f1, f2 = points[k, at], points[k, at + 1], points[k, at + 2]
            m0, m1, m2 = cross(x, y, z, f0, f1, f2)
            G[0, j], G[1, j], G[2, j], G[3, j], G[4, j], G[5, j] = f0, f1, f2, m0, m1, m2
            A[0, j], A[1, j], A[2, j] = f0, f1, f2
            A[3, j] = lift[2, 0] * m0 + lift[2, 1] * m1 + lift[2, 2] * m2
            for i in range(2):
                position[i, j] = -lift[i, 0] * m0 - lift[i, 1] * m1 - lift[i, 2] * m2
            t0, t1, t2 = cross(u, v, w, f0, f1, f2)
            for r in range(len(joints)):
                c = joints[r]
                A[4 + r, j] = (J[0, c] * f0 + J[1, c] * f1 + J[2, c] * f2) / size + J[3, c] * t0 + J[4, c] * t1 + J[5, c] * t2
    for r in range(len(joints)):
        A[4 + r, nx + r] = -1.0
    for i in range(3):
        b[i] = -load[i]
        about = lift[i, 0] * load[3] + lift[i, 1] * load[4] + lift[i, 2] * load[5]
        if i < 2:
            position[i, nx + len(joints)] = -about
        else:
            b[3] = -about
    return A, b, position, G, lift, centre, size
