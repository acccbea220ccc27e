"""How the cones of a program with five unknowns lie in memory, so that the compiler works on several of them at once.

One flat buffer holds blocks of 16 cones; within a block every number has a field of 16 neighbours. With one base address, fixed
strides and unsigned indices the compiler can prove that no store touches another field, and vectorises every loop over cones.
"""

from __future__ import annotations

import numpy as np

from socp_statics.engines.kernel.compilation import inner

U = np.uint64
WIDTH = 16
PADDING = 4

# Strides of one, two, three and four fields.
S = U(WIDTH)
S2, S3, S4 = U(2 * WIDTH), U(3 * WIDTH), U(4 * WIDTH)

# Fields of a cone: three rows of five coefficients, right-hand side, slack, multiplier, their steps, scaling, residual.
ROW0, ROW1, ROW2 = U(0), U(5 * WIDTH), U(10 * WIDTH)
RHS = U(15 * WIDTH)
SLACK = U(18 * WIDTH)
MULTIPLIER = U(21 * WIDTH)
SLACK_STEP = U(24 * WIDTH)
MULTIPLIER_STEP = U(27 * WIDTH)
SCALING = U(30 * WIDTH)
RESIDUAL = U(34 * WIDTH)
REACH = U(37 * WIDTH)
# How the right-hand side changes with the first and second coordinate of a direction.
RHS_X = U(38 * WIDTH)
RHS_Y = U(41 * WIDTH)
BLOCK = U(44 * WIDTH)
FIELDS = 44


@inner
def buffer_size(cones):
    """Length of the buffer of some cones."""
    return ((cones + WIDTH - 1) // WIDTH) * FIELDS * WIDTH


@inner
def lane(cone):
    """Where a cone's first field is."""
    return U(cone // WIDTH) * BLOCK + U(cone % WIDTH)


@inner
def padded(cones):
    """The number of lanes that the loops run over: whole vectors."""
    return U((cones + PADDING - 1) // PADDING * PADDING)


@inner
def row(X, at, y0, y1, y2, y3, y4):
    """One row of a cone times the unknowns."""
    return X[at] * y0 + X[at + S] * y1 + X[at + S2] * y2 + X[at + S3] * y3 + X[at + S4] * y4


@inner
def column(X, at, v0, v1, v2):
    """One column of a cone times a vector of the cone."""
    return X[at] * v0 + X[at + ROW1] * v1 + X[at + ROW2] * v2
