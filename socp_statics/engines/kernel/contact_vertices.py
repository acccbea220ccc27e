"""Vertices of a support region that are contact points, in closed form.

Where the cone of a point holds the vertical, the point carries the whole weight and is in the region. It is the vertex of a direction
exactly if some motion keeps it at rest and is resisted by no other contact: the rates of turning that the direction asks for,
with any rate tau about the vertical. Each cone leaves an interval of tau; a common tau certifies vertex and supporting line.
"""

from __future__ import annotations

import math

from socp_statics.engines.kernel.compilation import inner
from socp_statics.engines.kernel.lanes import RHS_X, RHS_Y, ROW1, S2, S3, S, lane
from socp_statics.engines.kernel.supports import BOUND, CX, CY, DX, DY

# By how much a certified motion may miss a cone, for a motion of size one, and a force its cone, for a force of size one: rounding on an
# edge between two contact points, and of a contact that leans by its friction angle.
ROUNDING = 1e-12
FLAT = 1e-14


@inner
def carrying_points(X, points, load, reference, carrying, force):
    """Find the points that can carry the weight alone.

    Args:
        X: Buffer of the cones, prepared.
        points: Shape (n, 14).
        load: Scaled impressed wrench of gravity alone with the centre of mass above the centre, shape (6,).
        reference: Position without contact forces, shape (2,).
        carrying: Written: indices of the points, shape (n,).
        force: Written: components of their forces in their cones, and the position of the centre of mass, shape (n, 5).

    Returns:
        How many there are.
    """
    count = 0
    for k in range(points.shape[0]):
        mu = points[k, 12]
        n0 = n1 = n2 = square = 0.0
        for i in range(3):
            n0 -= load[i] * points[k, 9 + i]
            n1 -= load[i] * points[k, 3 + i]
            n2 -= load[i] * points[k, 6 + i]
            square += points[k, 9 + i] * points[k, 9 + i]
        slide = math.hypot(n1, n2)
        if mu == 0.0:
            # A single direction, which need not be a unit vector: the edge of a pyramid.
            n0 /= square
            f0, f1, f2 = load[0] + n0 * points[k, 9], load[1] + n0 * points[k, 10], load[2] + n0 * points[k, 11]
            slide = math.sqrt(f0 * f0 + f1 * f1 + f2 * f2)
        if n0 <= 0.0 or slide > max(mu * (1.0 + ROUNDING), FLAT) * n0:
            continue
        carrying[count] = k
        z0, z1, z2 = n0, 0.0, 0.0
        if mu > 0.0:
            z1, z2 = n1 / mu, n2 / mu
        force[count, 0], force[count, 1], force[count, 2] = z0, z1, z2
        a = lane(k)
        force[count, 3] = reference[0] - X[a + RHS_X] * z0 - X[a + RHS_X + S] * z1 - X[a + RHS_X + S2] * z2
        force[count, 4] = reference[1] - X[a + RHS_Y] * z0 - X[a + RHS_Y + S] * z1 - X[a + RHS_Y + S2] * z2
        count += 1
    return count


@inner
def _interval(a0, a1, a2, b0, b1, b2, low, high):
    """The part of an interval of tau in which ``a + tau b`` is in the cone, rounding forgiven."""
    square = b1 * b1 + b2 * b2
    # From the tau where the sliding velocity is least: near an edge between two points nothing else is left of it but rounding.
    shift = -(a1 * b1 + a2 * b2) / square if square > FLAT * FLAT else 0.0
    a0, least = a0 + shift * b0 + ROUNDING, math.sqrt((a1 + shift * b1) ** 2 + (a2 + shift * b2) ** 2)
    A = b0 * b0 - square
    B = a0 * b0
    C = (a0 - least) * (a0 + least)
    scale = b0 * b0 + square
    if scale <= FLAT * FLAT:
        return (low, high) if a0 >= least else (1.0, -1.0)
    if abs(A) <= FLAT * scale:
        if abs(B) <= FLAT:
            return (low, high) if a0 >= least else (1.0, -1.0)
        end = shift - 0.5 * C / B
        return (max(low, end), high) if b0 > 0.0 else (low, min(high, end))
    root = B * B - A * C
    if root < 0.0:
        return 1.0, -1.0
    root = math.sqrt(root)
    # The larger root in magnitude first, the other from the product of the roots.
    q = -(B + (root if B >= 0.0 else -root))
    first = q / A
    second = C / q if q != 0.0 else first
    near, far = min(first, second), max(first, second)
    if A < 0.0:
        middle = 0.5 * (near + far)
        return (max(low, shift + near), min(high, shift + far)) if a0 + middle * b0 >= 0.0 else (1.0, -1.0)
    return (max(low, shift + far), high) if b0 > 0.0 else (low, min(high, shift + near))


@inner(inline="always")
def contact_vertex(X, points, centre, size, lift, carrying, force, count, dx, dy, node, y, kept):
    """The vertex of a direction if it is a contact point.

    Args:
        X: Buffer of the cones, prepared.
        points: Shape (n, 14).
        centre: Mean contact point.
        size: Largest distance.
        lift: As `friction_points.prepare_support` writes it.
        carrying: Points that can carry the load alone.
        force: Their forces and positions.
        count: How many they are.
        dx: First coordinate of the unit direction.
        dy: Second coordinate.
        node: Written where it is one, as by `supports.support`.
        y: Written: the motion.
        kept: Written: the forces.

    Returns:
        Whether it is one.
    """
    if count == 0:
        return False
    best, which = -math.inf, 0
    for i in range(count):
        value = dx * force[i, 3] + dy * force[i, 4]
        if value > best:
            best, which = value, i
    k = carrying[which]
    px, py, pz = (points[k, 0] - centre[0]) / size, (points[k, 1] - centre[1]) / size, (points[k, 2] - centre[2]) / size
    # Velocity of the point due to the two rates of the direction, and due to a unit rate about the vertical: both are undone.
    w0, w1, w2 = dx * lift[0, 0] + dy * lift[1, 0], dx * lift[0, 1] + dy * lift[1, 1], dx * lift[0, 2] + dy * lift[1, 2]
    u0, u1, u2 = w1 * pz - w2 * py, w2 * px - w0 * pz, w0 * py - w1 * px
    g0, g1, g2 = lift[2, 0], lift[2, 1], lift[2, 2]
    t0, t1, t2 = g1 * pz - g2 * py, g2 * px - g0 * pz, g0 * py - g1 * px
    low, high = -math.inf, math.inf
    for i in range(points.shape[0]):
        if i == k:
            continue
        o = lane(i)
        r1, r2 = o + ROW1, o + ROW1 + ROW1
        a0 = dx * X[o + RHS_X] + dy * X[o + RHS_Y] + X[o] * u0 + X[o + S] * u1 + X[o + S2] * u2
        a1 = dx * X[o + RHS_X + S] + dy * X[o + RHS_Y + S] + X[r1] * u0 + X[r1 + S] * u1 + X[r1 + S2] * u2
        a2 = dx * X[o + RHS_X + S2] + dy * X[o + RHS_Y + S2] + X[r2] * u0 + X[r2 + S] * u1 + X[r2 + S2] * u2
        b0 = -X[o + S3] + X[o] * t0 + X[o + S] * t1 + X[o + S2] * t2
        b1 = -X[r1 + S3] + X[r1] * t0 + X[r1 + S] * t1 + X[r1 + S2] * t2
        b2 = -X[r2 + S3] + X[r2] * t0 + X[r2 + S] * t1 + X[r2 + S2] * t2
        low, high = _interval(a0, a1, a2, b0, b1, b2, low, high)
        if low > high:
            return False
    tau = low if low > 0.0 else high if high < 0.0 else 0.0
    y[0], y[1], y[2], y[3], y[4] = -u0 - tau * t0, -u1 - tau * t1, -u2 - tau * t2, tau, 0.0
    node[DX], node[DY], node[CX], node[CY], node[BOUND] = dx, dy, force[which, 3], force[which, 4], best
    for i in range(kept.shape[0]):
        kept[i] = 0.0
    kept[3 * k], kept[3 * k + 1], kept[3 * k + 2] = force[which, 0], force[which, 1], force[which, 2]
    return True
