"""How the points of a program with a common ceiling lie in memory; blocks of 16 points, as in `lanes`."""

from __future__ import annotations

from socp_statics.engines.kernel.compilation import inner
from socp_statics.engines.kernel.lanes import WIDTH, U

# Fields of a point. Wrenches of the components of its cone, component by component, six numbers each.
WRENCH = U(0)
# What elimination makes of wrenches and ceiling, component by component, seven numbers each.
REDUCED = U(18 * WIDTH)
# What the ceiling measures of the normal component, and of the two others.
NORMAL, TANGENTIAL = U(39 * WIDTH), U(40 * WIDTH)
# Force in the friction cone and its multiplier; multiplier of the ceiling; their steps, or what the steps aim at.
FORCE, GRIP, HOLD = U(41 * WIDTH), U(44 * WIDTH), U(47 * WIDTH)
FORCE_STEP, GRIP_STEP, HOLD_STEP = U(51 * WIDTH), U(54 * WIDTH), U(57 * WIDTH)
# Scaling points of both cones, each followed by eta^-2.
GRIP_SCALING, HOLD_SCALING = U(61 * WIDTH), U(65 * WIDTH)
# Axes of a point's block: direction of friction, and how far they lean from normal and friction; factors L and one over the pivots
# of the block; right-hand side; residual.
HEADING, LEAN = U(70 * WIDTH), U(72 * WIDTH)
FACTORS, PIVOTS = U(74 * WIDTH), U(77 * WIDTH)
SIDE, RESIDUAL = U(80 * WIDTH), U(83 * WIDTH)
REACH = U(86 * WIDTH)
FIELDS = 87
BLOCK = U(FIELDS * WIDTH)
# From one component to the next.
WRENCHES, NEXT, LAST = U(6 * WIDTH), U(7 * WIDTH), U(14 * WIDTH)


@inner
def buffer_size(points):
    """Length of the buffer of some points."""
    return ((points + WIDTH - 1) // WIDTH) * FIELDS * WIDTH


@inner
def place(point):
    """Where a point's first field is."""
    return U(point // WIDTH) * BLOCK + U(point % WIDTH)
