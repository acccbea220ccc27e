"""The marks figures are made of: arrows, dots, the centre-of-mass sign; none of them moves the limits of the axes."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.legend import Legend
from matplotlib.legend_handler import HandlerPatch, HandlerTuple
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, FancyArrowPatch, Polygon
from matplotlib.path import Path

from socp_statics.figures.style import BLACK
from socp_statics.spatial import Array

COM = "CoM"
UP, DOWN = "moves up", "moves down"
# an underscore hides a label from legends that do not know which marks lie over each other
OVER = "_over "
QUARTERS = Path.make_compound_path(Path.wedge(0, 90), Path.wedge(180, 270))


def add_line(ax: Axes, points: Array, *, closed: bool = False, **style: Any) -> Line2D:
    """A line through points, shape (n, 2); closed lines start at their lowest corner, so that dashes of equal polygons agree."""
    xy = np.asarray(points, dtype=float).reshape(-1, 2)
    if closed and len(xy):
        centred = xy - xy.mean(axis=0)
        first = int(np.argmin(np.round(centred @ (0.3, 1.0), 9)))
        xy = np.vstack([np.roll(xy, -first, axis=0), xy[first]])
    line = Line2D(xy[:, 0], xy[:, 1], **style)
    ax.add_artist(line)
    return line


def add_filled(ax: Axes, corners: Array, **style: Any) -> Polygon:
    """A filled polygon, shape (k, 2)."""
    patch = Polygon(np.asarray(corners, dtype=float), closed=True, **style)
    ax.add_artist(patch)
    return patch


def add_dots(ax: Axes, points: Array, marker: Any, size: float, **style: Any) -> Line2D:
    """Markers at points, shape (n, 2), of a size in points."""
    return add_line(ax, points, linestyle="none", marker=marker, markersize=size, **style)


def add_arrow(ax: Axes, tail: Array, head: Array, *, head_size: float = 6.0, **style: Any) -> FancyArrowPatch:
    """An arrow between two points, its head in points."""
    arrow = FancyArrowPatch(
        (float(tail[0]), float(tail[1])), (float(head[0]), float(head[1])), arrowstyle="-|>", mutation_scale=head_size, shrinkA=0.0,
        shrinkB=0.0, joinstyle="miter", capstyle="butt", **style,
    )  # fmt: skip
    ax.add_artist(arrow)
    return arrow


def add_com(ax: Axes, xy: Array) -> None:
    """The quartered disc of a centre of mass at a position, shape (2,)."""
    add_dots(ax, xy, "o", 6.5, markerfacecolor="white", markeredgecolor=BLACK, markeredgewidth=0.8, zorder=6.0, label=COM)
    add_dots(ax, xy, QUARTERS, 6.5, markerfacecolor=BLACK, markeredgewidth=0.0, zorder=6.1, label=OVER + COM)


def _legend_arrow(legend: Legend, orig_handle: FancyArrowPatch, xdescent: float, ydescent: float, width: float, height: float,
                  fontsize: float) -> FancyArrowPatch:  # fmt: skip
    middle = 0.5 * height - ydescent
    return FancyArrowPatch((-xdescent, middle), (width - xdescent, middle), arrowstyle="-|>", mutation_scale=6.0, shrinkA=0.0, shrinkB=0.0)


def _legend_circle(legend: Legend, orig_handle: Circle, xdescent: float, ydescent: float, width: float, height: float,
                   fontsize: float) -> Circle:  # fmt: skip
    return Circle((0.5 * width - xdescent, 0.5 * height - ydescent), 0.55 * height)


LEGEND_MARKS = {
    FancyArrowPatch: HandlerPatch(patch_func=_legend_arrow),
    Circle: HandlerPatch(patch_func=_legend_circle),
    tuple: HandlerTuple(ndivide=1),
}


def legend_entries(*axes: Axes) -> dict[str, Any]:
    """Labels and their marks, in the order they were drawn, each label once; signs of two marks keep both."""
    entries: dict[str, Any] = {}
    for ax in axes:
        for handle, label in zip(*ax.get_legend_handles_labels(), strict=True):
            over = [artist for artist in ax.get_children() if artist.get_label() == OVER + label]
            entries.setdefault(label, (handle, over[0]) if over else handle)
    return entries
