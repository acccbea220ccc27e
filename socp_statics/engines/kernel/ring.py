"""A convex region of the plane as a ring of supports in compiled code: the sandwich of `regions.sandwich` in flat arrays.

Between two neighbouring directions lies an uncertain triangle: the two attained points and the crossing of the two lines.
"""

from __future__ import annotations

import math

from socp_statics.engines.kernel.compilation import inner
from socp_statics.engines.kernel.supports import AREA, BOUND, CX, CY, DX, DY, PX, PY

PARALLEL = 1e-9
ROUNDING = 1e-10
# Points that nearly repeat may lie in the wrong order along their edge, by a few times the accuracy of each.
OVERSHOOT = 10.0


@inner
def crossing(nodes, i, j):
    """Where the lines of two supports cross, and whether they do."""
    turn = nodes[i, DX] * nodes[j, DY] - nodes[i, DY] * nodes[j, DX]
    if turn <= PARALLEL:
        return 0.0, 0.0, False
    # Along the first line: where the two are nearly parallel, rounding moves their crossing along both and off neither.
    bound = nodes[i, BOUND]
    along = (nodes[j, BOUND] - bound * (nodes[i, DX] * nodes[j, DX] + nodes[i, DY] * nodes[j, DY])) / turn
    return bound * nodes[i, DX] - along * nodes[i, DY], bound * nodes[i, DY] + along * nodes[i, DX], True


@inner
def measure(nodes, after, i):
    """Crossing of a support's line with the next one's, and the area that it leaves uncertain."""
    j = after[i]
    x, y, crosses = crossing(nodes, i, j)
    if not crosses:
        x, y = 0.5 * (nodes[i, CX] + nodes[j, CX]), 0.5 * (nodes[i, CY] + nodes[j, CY])
    ex, ey = nodes[j, CX] - nodes[i, CX], nodes[j, CY] - nodes[i, CY]
    nodes[i, PX], nodes[i, PY] = x, y
    nodes[i, AREA] = max(0.0, 0.5 * ((x - nodes[i, CX]) * ey - (y - nodes[i, CY]) * ex))


@inner
def triangle(nodes, i, j, k):
    """Area of the triangle of three attained points, counter-clockwise."""
    ax, ay = nodes[i, CX], nodes[i, CY]
    return 0.5 * ((nodes[j, CX] - ax) * (nodes[k, CY] - ay) - (nodes[j, CY] - ay) * (nodes[k, CX] - ax))


@inner
def parallel(nodes, i, dx, dy):
    """Whether a direction is that of a support."""
    return abs(nodes[i, DX] * dy - nodes[i, DY] * dx) < PARALLEL and nodes[i, DX] * dx + nodes[i, DY] * dy > 0.0


@inner
def between(nodes, i, dx, dy, j):
    """Whether a direction lies in the counter-clockwise sector between two supports."""
    after_i = nodes[i, DX] * dy - nodes[i, DY] * dx >= 0.0 and nodes[i, DX] * dx + nodes[i, DY] * dy > -1.0 + 1e-15
    return after_i and dx * nodes[j, DY] - dy * nodes[j, DX] >= 0.0


@inner
def ring_order(after, order):
    """Write the indices of the ring from the first on; returns how many there are."""
    i, count = 0, 0
    while True:
        order[count] = i
        count += 1
        i = after[i]
        if i == 0:
            return count


@inner
def inner_corners(nodes, order, count, tolerance, keep):
    """Indices of the attained points that are corners: points nearer than the tolerance to the chord of their neighbours go."""
    kept = count
    for i in range(count):
        keep[i] = order[i]
    changed = True
    while changed and kept > 1:
        changed = False
        i = 0
        while i < kept and kept > 1:
            a, b, c = keep[(i + kept - 1) % kept], keep[i], keep[(i + 1) % kept]
            ex, ey = nodes[c, CX] - nodes[a, CX], nodes[c, CY] - nodes[a, CY]
            bx, by = nodes[b, CX] - nodes[a, CX], nodes[b, CY] - nodes[a, CY]
            length = math.sqrt(ex * ex + ey * ey)
            if length <= tolerance:
                redundant = math.sqrt(bx * bx + by * by) <= tolerance
            else:
                along, off = (bx * ex + by * ey) / length, (ex * by - ey * bx) / length
                redundant = off >= -tolerance and -OVERSHOOT * tolerance <= along <= length + OVERSHOOT * tolerance
            if redundant:
                for j in range(i, kept - 1):
                    keep[j] = keep[j + 1]
                kept -= 1
                changed = True
            else:
                i += 1
    return kept


@inner
def _cuts_nothing(nodes, before, here, following, rounding):
    """Whether a line leaves the corner of its neighbours as it is, or moves it by less than rounding."""
    if parallel(nodes, before, nodes[here, DX], nodes[here, DY]):
        return nodes[here, BOUND] >= nodes[before, BOUND]
    if parallel(nodes, here, nodes[following, DX], nodes[following, DY]):
        return nodes[here, BOUND] > nodes[following, BOUND]
    x, y, crosses = crossing(nodes, before, following)
    return crosses and nodes[here, DX] * x + nodes[here, DY] * y <= nodes[here, BOUND] + rounding


@inner
def outer_polygon(nodes, order, count, rounding, used, corners):
    """The polygon of the supporting lines without those that cut off nothing.

    Lines are first moved out to attained points that rounding left outside of them.

    Args:
        nodes: The supports.
        order: Their ring.
        count: How many there are.
        rounding: By how much a line may move a corner and still count as cutting off nothing.
        used: Written: indices of the supports whose lines are edges.
        corners: Written: edge k runs from corner k to corner k + 1.

    Returns:
        The number of edges; 0 where the lines do not enclose anything.
    """
    for a in range(count):
        i = order[a]
        for b in range(count):
            j = order[b]
            nodes[i, BOUND] = max(nodes[i, BOUND], nodes[i, DX] * nodes[j, CX] + nodes[i, DY] * nodes[j, CY])
    edges = count
    for a in range(count):
        used[a] = order[a]
    at, settled = 0, 0
    while settled < edges and edges > 3:
        here = at % edges
        if _cuts_nothing(nodes, used[(at + edges - 1) % edges], used[here], used[(at + 1) % edges], rounding):
            for j in range(here, edges - 1):
                used[j] = used[j + 1]
            edges -= 1
            at, settled = (here + edges - 1) % edges, 0
        else:
            at, settled = (at + 1) % edges, settled + 1
    for k in range(edges):
        x, y, crosses = crossing(nodes, used[(k + edges - 1) % edges], used[k])
        if not crosses:
            return 0
        corners[k, 0], corners[k, 1] = x, y
    return edges


@inner
def width(nodes, order, count):
    """Least distance between two parallel lines that hold all crossings, 0 below three."""
    if count < 3:
        return 0.0
    least = math.inf
    for a in range(count):
        i, j = order[a], order[(a + 1) % count]
        ex, ey = nodes[j, PX] - nodes[i, PX], nodes[j, PY] - nodes[i, PY]
        length = math.sqrt(ex * ex + ey * ey)
        if length == 0.0:
            continue
        low, high = math.inf, -math.inf
        for b in range(count):
            k = order[b]
            height = (ey * nodes[k, PX] - ex * nodes[k, PY]) / length
            low, high = min(low, height), max(high, height)
        least = min(least, high - low)
    return least if least < math.inf else 0.0
