"""The next vertex from its neighbours: their motions and forces combined, what each contact does as at one of them."""

from __future__ import annotations

from socp_statics.engines.kernel.active_set import optimum
from socp_statics.engines.kernel.compilation import inner
from socp_statics.engines.kernel.supports import DX, DY, finish


@inner
def _same(a, b):
    """Whether every contact does the same in two solutions."""
    for k in range(len(a)):
        if a[k] != b[k]:
            return False
    return True


@inner
def _between(nodes, motions, forces, i, j, dx, dy, motion, held):
    """Motion and forces of two neighbours, combined as their directions combine to the one between them; both satisfy all cones."""
    turn = nodes[i, DX] * nodes[j, DY] - nodes[i, DY] * nodes[j, DX]
    a, b = (dx * nodes[j, DY] - dy * nodes[j, DX]) / turn, (nodes[i, DX] * dy - nodes[i, DY] * dx) / turn
    for k in range(5):
        motion[k] = a * motions[i, k] + b * motions[j, k]
    share = a / (a + b)
    for k in range(held.shape[0]):
        held[k] = share * forces[i, k] + (1.0 - share) * forces[j, k]


@inner
def continued(X, points, q, reference, nodes, motions, forces, states, known, i, j, dx, dy, mine, equations, node, motion, held):
    """Try to get the support of a direction from the two neighbours that it lies between.

    Args:
        X: Buffer of the cones with the direction set.
        points: Shape (n, 14).
        q: Cost, shape (5,).
        reference: Position without contact forces, shape (2,).
        nodes: The supports.
        motions: Their motions.
        forces: Their forces.
        states: What each contact does at each of them, where it is known.
        known: Where it is known.
        i: The support before the direction.
        j: The support after it.
        dx: First coordinate of the unit direction.
        dy: Second coordinate.
        mine: Written where it succeeds: what each contact does, shape (cones,).
        equations: Scratch of `active_set.optimum`.
        node: Written where it succeeds, as by `supports.support`.
        motion: Written where it succeeds, shape (5,).
        held: Written where it succeeds, shape (3 * cones,).

    Returns:
        Whether it succeeded.
    """
    cones = points.shape[0]
    for turn in range(2):
        which = i if turn == 0 else j
        if not known[which] or (turn == 1 and known[i] and _same(states[i, :cones], states[j, :cones])):
            continue
        for k in range(cones):
            mine[k] = states[which, k]
        _between(nodes, motions, forces, i, j, dx, dy, motion, held)
        if optimum(X, cones, points, q, mine, equations, motion, held):
            finish(X, cones, q, reference, dx, dy, node, motion, held)
            return True
    return False
