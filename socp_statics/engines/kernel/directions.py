"""The support function of a region in compiled code: many directions, each its own program."""

from __future__ import annotations

import numpy as np

from socp_statics.engines.kernel.compilation import entry
from socp_statics.engines.kernel.five_unknowns import SOLVED
from socp_statics.engines.kernel.friction_points import centre_and_size, full_rank, prepare_support, scaled_load, set_direction
from socp_statics.engines.kernel.lanes import buffer_size, padded
from socp_statics.engines.kernel.normal_matrix import factor, with_pad
from socp_statics.engines.kernel.projection_newton import EQUATION
from socp_statics.engines.kernel.starting_point import normal_matrix_of_rows
from socp_statics.engines.kernel.supports import BOUND, CX, CY, NODE, support

# Status of a direction whose programs are not for this method: the points do not reach every wrench.
RANK = -1


@entry("Tuple((int64[::1], float64[:,::1]))(float64[:,::1], float64[::1], float64[:,::1])")
def support_values(points, load13, directions):
    """How far the centre of mass can go in some directions.

    Args:
        points: Rows of one set, shape (n, 14), see `friction_points`.
        load13: See `tracing.trace`.
        directions: Unit vectors, shape (k, 2).

    Returns:
        Of each direction: the status of its program (RANK: not asked), shape (k,); attained position and bound of ``d . c`` [m], shape
        (k, 3).
    """
    cones, asked = points.shape[0], directions.shape[0]
    X, held = np.empty(buffer_size(cones)), np.empty(3 * cones)
    centre, load, pull, q, y, reference, node = (
        np.empty(3), np.empty(6), np.empty(3), np.empty(5), np.empty(5), np.empty(2), np.empty(NODE),
    )  # fmt: skip
    lift, gram, out = np.empty((3, 3)), np.empty((6, 6)), np.empty((asked, 3))
    rows, equations, guess = np.empty(cones, np.int64), np.empty((3 * cones, EQUATION)), np.empty(5)
    statuses = np.empty(asked, np.int64)
    size = centre_and_size(points, centre)
    scaled_load(load13, centre, size, load, pull)
    known = full_rank(points, centre, size, gram)
    prepare_support(X, points, load, pull, centre, size, lift, q, reference)
    factors = factor(with_pad(normal_matrix_of_rows(X, padded(cones))))
    for i in range(asked):
        dx, dy = directions[i, 0], directions[i, 1]
        statuses[i] = RANK
        if known:
            set_direction(X, cones, dx, dy)
            statuses[i] = support(X, cones, points, factors, q, reference, dx, dy, rows, equations, guess, node, y, held)
        if statuses[i] == SOLVED:
            out[i, 0], out[i, 1] = centre[0] + size * node[CX], centre[1] + size * node[CY]
            out[i, 2] = dx * centre[0] + dy * centre[1] + size * node[BOUND]
    return statuses, out
