"""Which part of the floor a figure shows."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator, ScalarFormatter

from socp_statics.spatial import Array

REACH = 2.0
BEYOND = 0.6
PADDING = 0.09


class Window(NamedTuple):
    """A rectangle of the drawing plane [m]."""

    x_min: float
    x_max: float
    y_min: float
    y_max: float

    @property
    def width(self) -> float:
        """Extent along the horizontal axis [m]."""
        return self.x_max - self.x_min

    @property
    def height(self) -> float:
        """Extent along the vertical axis [m]."""
        return self.y_max - self.y_min

    @property
    def span(self) -> float:
        """The larger extent [m]."""
        return max(self.width, self.height)

    def holds(self, xy: Array) -> bool:
        """Whether a position, shape (2,), is inside."""
        return bool(self.x_min <= xy[0] <= self.x_max and self.y_min <= xy[1] <= self.y_max)

    def grown(self, length: float) -> Window:
        """The rectangle with a rim of this width [m]."""
        return Window(self.x_min - length, self.x_max + length, self.y_min - length, self.y_max + length)

    def shaped(self, least: float, most: float) -> Window:
        """The smallest rectangle about the same centre whose height over width is between two numbers."""
        ratio = self.height / self.width
        wider = 0.5 * max(self.height / most - self.width, 0.0) if ratio > most else 0.0
        higher = 0.5 * max(self.width * least - self.height, 0.0) if ratio < least else 0.0
        return Window(self.x_min - wider, self.x_max + wider, self.y_min - higher, self.y_max + higher)


def around(points: Array) -> Window:
    """The smallest rectangle that holds points, shape (n, 2), n >= 1."""
    (x_min, y_min), (x_max, y_max) = points.min(axis=0), points.max(axis=0)
    return Window(float(x_min), float(x_max), float(y_min), float(y_max))


def inside(corners: Array, window: Window) -> Array:
    """The part of a convex polygon inside a rectangle, shape (k, 2) -> (l, 2), possibly none."""
    part = np.asarray(corners, dtype=float).reshape(-1, 2)
    sides = ((0, window.x_min, 1.0), (0, window.x_max, -1.0), (1, window.y_min, 1.0), (1, window.y_max, -1.0))
    for axis, limit, sign in sides:
        reserve = sign * (part[:, axis] - limit)
        kept = []
        for k, (p, r) in enumerate(zip(part, reserve, strict=True)):
            q, s = part[(k + 1) % len(part)], reserve[(k + 1) % len(part)]
            if r >= 0.0:
                kept.append(p)
            if (r > 0.0 > s) or (r < 0.0 < s):
                kept.append(p + r / (r - s) * (q - p))
        part = np.array(kept).reshape(-1, 2)
    return part


def choose_window(points: Array, others: Array, bounded: Iterable[Array], endless: Iterable[Array]) -> Window:
    """The contacts with a rim, and of everything else as much as is not out of proportion.

    Args:
        points: Contact points on the drawing plane, shape (n, 2), possibly none [m].
        others: Points worth showing if they are not far away: the centre of mass, loads; shape (m, 2) [m].
        bounded: Polygons with an end.
        endless: Polygons whose edges are partly those of a clipping square; a rim of them is shown.

    Returns:
        The window.
    """
    bounded, endless = list(bounded), list(endless)
    core = points if len(points) else np.vstack([*bounded, *endless, others])
    contacts = around(core)
    size = float(np.hypot(contacts.width, contacts.height))
    if size <= 1e-9 * (1.0 + float(np.abs(core).max())):
        rest = np.vstack([core, others, *bounded])
        size = 2.0 * float(np.linalg.norm(rest - core[0], axis=1).max()) or 0.2
    limit = contacts.grown(REACH * size)
    shown = [core, *(p[None] for p in others if limit.holds(p))]
    for corners in bounded:
        part = inside(corners, limit)
        shown.append(part if len(part) else corners)
    rim = around(np.vstack(shown)).grown(BEYOND * size)
    shown += [inside(corners, rim) for corners in endless]
    window = around(np.vstack(shown))
    return window.grown(PADDING * window.span if window.span > 0.1 * size else 0.5 * size)


def show_window(ax: Axes, window: Window) -> None:
    """Grow the view of axes that belong to the caller so that they hold a window; equal axes."""
    ax.set_aspect("equal", adjustable="datalim")
    ax.update_datalim([(window.x_min, window.y_min), (window.x_max, window.y_max)])
    ax.margins(0.0)
    ax.autoscale_view()


def label_axes(ax: Axes, words: Sequence[str] = ("x [m]", "y [m]")) -> None:
    """Axes in metres, ticks as plain numbers even a kilometre from the origin."""
    ax.set_xlabel(words[0])
    ax.set_ylabel(words[1])
    for axis in (ax.xaxis, ax.yaxis):
        plain = ScalarFormatter(useOffset=False)
        plain.set_scientific(False)
        axis.set_major_formatter(plain)
        axis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
