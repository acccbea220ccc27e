"""The next vertex from its neighbours: Newton's method from their motions and forces, combined."""

from __future__ import annotations

from socp_statics.engines.kernel.compilation import inner
from socp_statics.engines.kernel.projection_newton import optimum
from socp_statics.engines.kernel.supports import DX, DY, finish


@inner(inline="always")
def _between(nodes, motions, forces, i, j, dx, dy, motion, held):
    """Motion and forces of two neighbours, combined as their directions combine to the one between them; both satisfy all cones."""
    turn = nodes[i, DX] * nodes[j, DY] - nodes[i, DY] * nodes[j, DX]
    a, b = (dx * nodes[j, DY] - dy * nodes[j, DX]) / turn, (nodes[i, DX] * dy - nodes[i, DY] * dx) / turn
    for k in range(5):
        motion[k] = a * motions[i, k] + b * motions[j, k]
    share = a / (a + b)
    for k in range(held.shape[0]):
        held[k] = share * forces[i, k] + (1.0 - share) * forces[j, k]


@inner(inline="always")
def continued(X, points, q, reference, nodes, motions, forces, i, j, dx, dy, rows, equations, node, motion, held):
    """Try to get the support of a direction from the two neighbours that it lies between.

    Args:
        X: Buffer of the cones with the direction set.
        points: Shape (n, 14).
        q: Cost, shape (5,).
        reference: Position without contact forces, shape (2,).
        nodes: The supports.
        motions: Their motions.
        forces: Their forces.
        i: The support before the direction.
        j: The support after it.
        dx: First coordinate of the unit direction.
        dy: Second coordinate.
        rows: Scratch of `projection_newton.optimum`.
        equations: Scratch of `projection_newton.optimum`.
        node: Written where it succeeds, as by `supports.support`.
        motion: Written where it succeeds, shape (5,).
        held: Written where it succeeds, shape (3 * cones,).

    Returns:
        Whether it succeeded.
    """
    cones = points.shape[0]
    _between(nodes, motions, forces, i, j, dx, dy, motion, held)
    if not optimum(X, cones, points, q, rows, equations, motion, held):
        return False
    finish(X, cones, q, reference, dx, dy, node, motion, held)
    return True
