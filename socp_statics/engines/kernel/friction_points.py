"""From contact points in the world to the cones of a support direction: data preparation in compiled code.

A point is a row of 14 numbers: position (3), unit tangents (6), normal (3), friction, share of its contact point in the reserve.
A point without friction, and each edge of a pyramid, is a row with friction 0 whose "normal" is the direction of its force.
"""

from __future__ import annotations

import math

from socp_statics.engines.kernel.compilation import inner
from socp_statics.engines.kernel.lanes import BLOCK, PADDING, RHS, RHS_X, RHS_Y, ROW1, S2, S3, S4, S, U, lane

# Pivots of the Gram matrix of G above which it has full rank beyond doubt; singular values then are above 1e-5 or so.
FULL_RANK = 1e-8


@inner
def centre_and_size(points, centre):
    """Mean contact point, written, and the largest distance between points (1 if there is none); the edges of a pyramid share one point."""
    n = points.shape[0]
    for i in range(3):
        total = shares = 0.0
        for k in range(n):
            total += points[k, 13] * (points[k, i] - points[0, i])
            shares += points[k, 13]
        centre[i] = points[0, i] + total / shares
    largest = 0.0
    for k in range(n):
        x, y, z = points[k, 0], points[k, 1], points[k, 2]
        for j in range(k):
            a, b, c = points[j, 0] - x, points[j, 1] - y, points[j, 2] - z
            away = a * a + b * b + c * c
            largest = away if away > largest else largest
    return math.sqrt(largest) if largest > 0.0 else 1.0


@inner
def cross(a0, a1, a2, b0, b1, b2):
    """The cross product."""
    return a1 * b2 - a2 * b1, a2 * b0 - a0 * b2, a0 * b1 - a1 * b0


@inner
def unit_wrench(points, k, c, centre, size):
    """Wrench of the unit of one component of a point's cone (c = 0: normal force; 1, 2: friction) about the centre, scaled."""
    x, y, z = (points[k, 0] - centre[0]) / size, (points[k, 1] - centre[1]) / size, (points[k, 2] - centre[2]) / size
    if c == 0:
        f0, f1, f2 = points[k, 9], points[k, 10], points[k, 11]
    else:
        mu, at = points[k, 12], 3 * c
        f0, f1, f2 = mu * points[k, at], mu * points[k, at + 1], mu * points[k, at + 2]
    m0, m1, m2 = cross(x, y, z, f0, f1, f2)
    return f0, f1, f2, m0, m1, m2


@inner
def eliminated(gram):
    """Whether a Gram matrix (lower triangle, overwritten by its factors), shape (6, 6), has full rank beyond doubt."""
    for j in range(6):
        pivot = gram[j, j]
        for i in range(j):
            pivot -= gram[j, i] * gram[j, i] * gram[i, i]
        if not pivot > FULL_RANK:
            return False
        gram[j, j] = pivot
        for i in range(j + 1, 6):
            value = gram[i, j]
            for m in range(j):
                value -= gram[i, m] * gram[j, m] * gram[m, m]
            gram[i, j] = value / pivot
    return True


@inner
def full_rank(points, centre, size, gram):
    """Whether the forces of the points reach every wrench, beyond doubt.

    Args:
        points: Shape (n, 14).
        centre: Mean contact point, shape (3,).
        size: Largest distance.
        gram: Scratch, shape (6, 6).
    """
    for i in range(6):
        for j in range(6):
            gram[i, j] = 0.0
    for k in range(points.shape[0]):
        x, y, z = (points[k, 0] - centre[0]) / size, (points[k, 1] - centre[1]) / size, (points[k, 2] - centre[2]) / size
        for axis in range(3):
            if axis < 2 and points[k, 12] == 0.0:
                continue
            at = 3 + 3 * axis
            f0, f1, f2 = points[k, at], points[k, at + 1], points[k, at + 2]
            m0, m1, m2 = cross(x, y, z, f0, f1, f2)
            wrench = (f0, f1, f2, m0, m1, m2)
            for i in range(6):
                for j in range(i + 1):
                    gram[i, j] += wrench[i] * wrench[j]
    return eliminated(gram)


@inner
def scaled_load(load13, centre, size, load, pull):
    """Impressed wrench about the centre with the centre of mass above it, and the force of gravity, both scaled; written."""
    force, lift = load13[9], (load13[10] - centre[2]) / size
    for i in range(3):
        pull[i] = load13[i] / force
        load[i] = (load13[i] + load13[3 + i]) / force
        load[3 + i] = load13[6 + i] / (force * size)
    load[3] -= lift * pull[1]
    load[4] += lift * pull[0]


@inner
def wrench_at_com(load13, centre, size, load):
    """Impressed wrench about the centre with the centre of mass where it is, scaled; written."""
    force = load13[9]
    x, y, z = (load13[10] - centre[0]) / size, (load13[11] - centre[1]) / size, (load13[12] - centre[2]) / size
    g0, g1, g2 = load13[0] / force, load13[1] / force, load13[2] / force
    load[0], load[1], load[2] = g0 + load13[3] / force, g1 + load13[4] / force, g2 + load13[5] / force
    load[3] = y * g2 - z * g1 + load13[6] / (force * size)
    load[4] = z * g0 - x * g2 + load13[7] / (force * size)
    load[5] = x * g1 - y * g0 + load13[8] / (force * size)


@inner
def pad_lanes(X, cones):
    """Fill the lanes behind the last cone of the last vector: zero rows, slack (1, 0, 0)."""
    for k in range(cones, (cones + PADDING - 1) // PADDING * PADDING):
        a = lane(k)
        for field in range(15):
            X[a + U(field) * S] = 0.0
        for field in range(3):
            X[a + RHS_X + U(field) * S] = 0.0
            X[a + RHS_Y + U(field) * S] = 0.0
            X[a + RHS + U(field) * S] = 0.0
        X[a + RHS] = 1.0


@inner
def lifted(weight, lift):
    """Write the pseudoinverse of the moments of a CoM displacement along x and y, shape (2, 3), then the direction of gravity."""
    w0, w1, w2 = weight[0], weight[1], weight[2]
    # Moments of unit displacements: e_x x w = (0, -w_z, w_y) and e_y x w = (w_z, 0, -w_x).
    xx, yy, xy = w1 * w1 + w2 * w2, w0 * w0 + w2 * w2, -w0 * w1
    det = xx * yy - xy * xy
    lift[0, 0], lift[0, 1], lift[0, 2] = -xy * w2 / det, -yy * w2 / det, (yy * w1 + xy * w0) / det
    lift[1, 0], lift[1, 1], lift[1, 2] = xx * w2 / det, xy * w2 / det, (-xy * w1 - xx * w0) / det
    norm = math.sqrt(w0 * w0 + w1 * w1 + w2 * w2)
    lift[2, 0], lift[2, 1], lift[2, 2] = w0 / norm, w1 / norm, w2 / norm


@inner
def prepare_support(X, points, load, weight, centre, size, lift, q, reference):
    """Rows and right-hand sides of the support direction program, ``E_i' y - L_i' d in K_i*``.

    The unknowns are the velocity (3) and the rate of turning about the direction of gravity; the other two rates are those that
    the direction d asks for.

    Args:
        X: Buffer of the cones, written.
        points: Shape (n, 14).
        load: Impressed wrench about the centre with the centre of mass at height ``reference[2]`` above the origin of its plane, scaled,
            shape (6,).
        weight: Scaled force of gravity, shape (3,).
        centre: Mean contact point, shape (3,).
        size: Largest distance.
        lift: Written: pseudoinverse of the moments of a CoM displacement along x and y, shape (2, 3), then the direction of gravity.
        q: Cost, shape (5,), written.
        reference: Written: position of the centre of mass when no contact force acts, scaled, shape (2,).
    """
    lifted(weight, lift)
    q[0], q[1], q[2] = -load[0], -load[1], -load[2]
    q[3], q[4] = -(lift[2, 0] * load[3] + lift[2, 1] * load[4] + lift[2, 2] * load[5]), 0.0
    for i in range(2):
        reference[i] = -(lift[i, 0] * load[3] + lift[i, 1] * load[4] + lift[i, 2] * load[5])
    for k in range(points.shape[0]):
        a = lane(k)
        for c in range(3):
            f0, f1, f2, m0, m1, m2 = unit_wrench(points, k, c, centre, size)
            at = a + U(c) * ROW1
            X[at], X[at + S], X[at + S2] = -f0, -f1, -f2
            X[at + S3] = -(lift[2, 0] * m0 + lift[2, 1] * m1 + lift[2, 2] * m2)
            X[at + S4] = 0.0
            X[a + RHS_X + U(c) * S] = lift[0, 0] * m0 + lift[0, 1] * m1 + lift[0, 2] * m2
            X[a + RHS_Y + U(c) * S] = lift[1, 0] * m0 + lift[1, 1] * m1 + lift[1, 2] * m2
    pad_lanes(X, points.shape[0])


@inner
def set_direction(X, cones, dx, dy):
    """The right-hand side of a direction."""
    o, left = U(0), U(cones)
    while left > U(0):
        count = min(left, S)
        for k in range(count):
            a = o + k
            X[a + RHS] = dx * X[a + RHS_X] + dy * X[a + RHS_Y]
            X[a + RHS + S] = dx * X[a + RHS_X + S] + dy * X[a + RHS_Y + S]
            X[a + RHS + S2] = dx * X[a + RHS_X + S2] + dy * X[a + RHS_Y + S2]
        left -= count
        o += BLOCK
