"""The internal-force window: its interval, and the feasible set of two directions between the attained and the ruled out."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from socp_statics.figures.layout import Bars, arrange, new_axes, sheet_of
from socp_statics.figures.marks import add_dots, add_filled, add_line
from socp_statics.figures.style import BLACK, BLUE, GREY, VERMILLION, house_style
from socp_statics.optimization.internal_force_window import InternalForceWindow
from socp_statics.spatial import Array

HEIGHT_OF_A_SET, HEIGHT_OF_AN_INTERVAL = 2.0, 0.5
LEFT, RIGHT, HEAD = 0.58, 0.14, 0.08
RIM = 0.08


class WindowShape(NamedTuple):
    """A window, ready to be drawn.

    Attributes:
        lower: Lower end along the first direction, -inf without one, None where empty.
        upper: Upper end.
        inner: Attained points of the set of two directions, shape (k, 2), empty of one direction.
        outer: Corners of its supporting lines, shape (l, 2).
        names: What the axes are.
        reachable: Whether there is a particular solution, whatever the cones.
    """

    lower: float | None
    upper: float | None
    inner: Array
    outer: Array
    names: tuple[str, str]
    reachable: bool = True


def window_in_record(record: Mapping[str, Any]) -> WindowShape | None:
    """The window of a record, None where it has none."""
    window = record.get("window")
    if not window:
        return None
    directions = record["case"]["parameters"]["directions"]
    names = [f"internal force {' - '.join(d)} [N]" if isinstance(d, list) else f"direction {i + 1}" for i, d in enumerate(directions)]
    ends = [None if window[key] is None else float(window[key]["value"]) for key in ("lower", "upper")]
    inner, outer = (np.array(window.get("set", {}).get(key, []), dtype=float).reshape(-1, 2) for key in ("inner", "outer"))
    return WindowShape(ends[0], ends[1], inner, outer, (names[0], names[-1]), bool(window["particular"]))


def draw_window(window: InternalForceWindow, ax: Axes | None = None) -> Axes:
    """Draw a window: the feasible set of two directions, or the interval of one.

    Args:
        window: The window.
        ax: Axes to draw into; by default those of a new figure with a legend.

    Returns:
        The axes, in units of the directions.
    """
    none = np.zeros((0, 2))
    inner, outer = (none, none) if window.set is None else (window.set.inner, window.set.outer)
    ends = [None if end is None else end.value for end in (window.lower, window.upper)]
    shape = WindowShape(ends[0], ends[1], inner, outer, ("first direction [N]", "second direction"), window.particular_W is not None)
    with house_style():
        own = new_axes() if ax is None else ax
        bars = add_window(own, shape)
        if ax is None:
            arrange(sheet_of(own), [bars])
    return own


def add_window(ax: Axes, shape: WindowShape) -> Bars:
    """Add a window to axes that have nothing else in them; returns the room they take on a sheet."""
    flat = not len(shape.inner)
    corners = np.vstack([shape.inner, shape.outer, np.zeros((1, 2))])
    ends = [end for end in (shape.lower, shape.upper) if end is not None and np.isfinite(end)]
    along = np.array([*corners[:, 0], *ends])
    low, high = along.min(), along.max()
    size = high - low if high - low > 1e-9 else 1.0
    ax.set_xlim(low - RIM * size, high + RIM * size)
    if not flat:
        add_filled(ax, shape.inner, facecolor=BLUE, alpha=0.25, zorder=2.0, label="attained")
        add_line(ax, shape.outer, closed=True, color=BLUE, linewidth=0.9, zorder=3.0, label="nothing is feasible beyond")
        across = np.array([corners[:, 1].min(), corners[:, 1].max()])
        room = RIM * max(float(np.ptp(across)), 1e-9)
        ax.set_ylim(across[0] - room, across[1] + room)
        ax.set_ylabel(shape.names[1])
    else:
        ax.set_ylim(-1.0, 1.0)
        ax.set_yticks([])
    if shape.lower is not None and shape.upper is not None:
        shown = np.clip([shape.lower, shape.upper], *ax.get_xlim())
        add_line(ax, np.column_stack([shown, [0.0, 0.0]]), color=BLACK, linewidth=1.6, zorder=4.0, label="window of the first direction")
        add_dots(ax, np.array([[end, 0.0] for end in ends]).reshape(-1, 2), "|", 7.0, markeredgecolor=BLACK, zorder=4.5)
    if shape.reachable:
        look = {"markerfacecolor": VERMILLION, "markeredgecolor": VERMILLION, "zorder": 5.0}
        add_dots(ax, np.zeros((1, 2)), "o", 4.0, label="particular solution", **look)
        ax.axhline(0.0, color=GREY, linewidth=0.4, zorder=1.0)
        ax.axvline(0.0, color=GREY, linewidth=0.4, zorder=1.0)
    else:
        ax.text(0.5, 0.5, "empty: no forces balance the load", transform=ax.transAxes, ha="center", va="center")
    ax.set_xlabel(shape.names[0])
    ax.xaxis.set_major_locator(MaxNLocator(7, steps=[1, 2, 5, 10]))
    ax.xaxis.labelpad = 2.0
    height = HEIGHT_OF_AN_INTERVAL if flat else HEIGHT_OF_A_SET
    return Bars((ax,), height, LEFT, RIGHT, HEAD)
