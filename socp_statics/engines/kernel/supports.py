"""Support directions of the centre of mass in compiled code: one program each, an attained point and a line that holds the region."""

from __future__ import annotations

import math

from socp_statics.engines.kernel.compilation import inner
from socp_statics.engines.kernel.five_unknowns import SOLVED, UNSETTLED
from socp_statics.engines.kernel.lanes import RHS_X, RHS_Y, S2, S, lane
from socp_statics.engines.kernel.projection_newton import slack
from socp_statics.engines.kernel.settling import settle

# Columns of a node of the traced region: direction, attained point, bound, crossing with the next line, uncertain area.
DX, DY, CX, CY, BOUND, PX, PY, AREA = range(8)
NODE = 8
# By how much a point may lie beyond the line of its own motion, for rounding: forces and motion were both found to no better than this.
CROSSED = 1e-8


@inner
def finish(X, cones, q, reference, dx, dy, node, y, kept):
    """Attained point and bound of a solution, written into its node.

    Args:
        X: Buffer of the cones with the direction set.
        cones: Number of cones.
        q: Cost, shape (5,).
        reference: Position without contact forces, shape (2,).
        dx: First coordinate of the unit direction.
        dy: Second coordinate.
        node: Written: direction, attained point, bound, shape (8,).
        y: The motion, shape (5,).
        kept: The forces, shape (3 * cones,).

    Returns:
        By how much the point lies beyond the motion's line, which then is moved out to it.
    """
    x, z = reference[0], reference[1]
    bound = dx * x + dy * z
    for j in range(5):
        bound += q[j] * y[j]
    # A motion that misses a cone by rounding bounds the region a little farther out: by what the forces could gain there.
    misses, carried = 0.0, 0.0
    for k in range(cones):
        a = lane(k)
        z0, z1, z2 = kept[3 * k], kept[3 * k + 1], kept[3 * k + 2]
        x -= X[a + RHS_X] * z0 + X[a + RHS_X + S] * z1 + X[a + RHS_X + S2] * z2
        z -= X[a + RHS_Y] * z0 + X[a + RHS_Y + S] * z1 + X[a + RHS_Y + S2] * z2
        s0, s1, s2 = slack(X, a, y)
        misses = max(misses, math.sqrt(s1 * s1 + s2 * s2) - s0)
        carried += z0
    bound += misses * carried
    node[DX], node[DY], node[CX], node[CY] = dx, dy, x, z
    beyond = max(0.0, dx * x + dy * z - bound)
    node[BOUND] = bound + beyond
    return beyond


@inner
def support(X, cones, points, factors, q, reference, dx, dy, rows, equations, guess, node, y, kept):
    """One support direction.

    Args:
        X: Buffer of the cones with the direction set.
        cones: Number of cones.
        points: Shape (n, 14).
        factors: Of their normal matrix.
        q: Cost, shape (5,).
        reference: Position without contact forces, shape (2,).
        dx: First coordinate of the unit direction.
        dy: Second coordinate.
        rows: Scratch of `projection_newton.optimum`.
        equations: Scratch of `projection_newton.optimum`.
        guess: Scratch, shape (5,).
        node: Written: direction, attained point, bound, shape (8,).
        y: Written: the motion, shape (5,).
        kept: Written: the forces, shape (3 * cones,).

    Returns:
        Status of the program.
    """
    status, _ = settle(X, cones, points, 1.0, factors, q, rows, equations, guess, y, kept)
    if status == SOLVED and finish(X, cones, q, reference, dx, dy, node, y, kept) > CROSSED:
        return UNSETTLED
    return status
