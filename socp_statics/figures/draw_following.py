"""Following regions on the floor plan: rays, the ends they attain, what stops each, and the star between them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes

from socp_statics.figures.layout import new_axes, show_alone_or_in
from socp_statics.figures.marks import add_com, add_dots, add_line
from socp_statics.figures.quantities import area_text
from socp_statics.figures.style import BLACK, GREY, ORANGE, PURPLE, VERMILLION, house_style
from socp_statics.figures.window import choose_window, label_axes
from socp_statics.following import FollowingRegion
from socp_statics.spatial import Array

# marker, colour and legend of what stops a ray, in the order of the legend
STOPS: dict[str, tuple[str, str, str]] = {
    "equilibrium": ("o", PURPLE, "stopped by contacts and load"),
    "torque": ("s", VERMILLION, "stopped by a torque limit"),
    "joint limit": ("^", ORANGE, "stopped by a joint limit"),
    "cannot reach": ("D", BLACK, "out of reach"),
    "step failure": ("x", GREY, "step failed: no exit"),
}


class FollowingShape(NamedTuple):
    """A following region, ready to be drawn.

    Attributes:
        centre: Where the rays start, shape (2,) [m].
        ends: Attained ends, counter-clockwise, shape (k, 2) [m].
        reasons: What stops each ray.
        area: Of the star [m^2].
    """

    centre: Array
    ends: Array
    reasons: tuple[str, ...]
    area: float


def following_in_record(record: Mapping[str, Any]) -> FollowingShape | None:
    """The following region of a record, None where it has none."""
    found = record.get("following")
    if not found:
        return None
    reasons = tuple(ray["reason"] for ray in found["rays"])
    return FollowingShape(np.array(found["centre"], dtype=float), np.array(found["polygon"], dtype=float), reasons, found["area"])


def draw_following(region: FollowingRegion, ax: Axes | None = None) -> Axes:
    """Draw a following region: its rays, the ends they attain, and the star between them.

    Args:
        region: The region.
        ax: Axes to draw into, the view grows as needed; by default those of a new figure with a legend.

    Returns:
        The axes, equal and in metres.
    """
    shape = FollowingShape(region.centre, region.polygon, tuple(ray.reason for ray in region.rays), region.area)
    window = choose_window(shape.ends, shape.centre[None], [], [])
    with house_style():
        own = new_axes() if ax is None else ax
        add_following(own, shape)
        add_com(own, shape.centre)
        label_axes(own)
        show_alone_or_in(own, ax, window)
    return own


def add_following(ax: Axes, shape: FollowingShape) -> None:
    """Add a following region to a floor plan.

    Args:
        ax: The axes.
        shape: The region.
    """
    for end in shape.ends:
        add_line(ax, np.vstack([shape.centre, end]), color=PURPLE, linewidth=0.5, alpha=0.7, zorder=3.6)
    star = f"the posture follows: along {len(shape.ends)} rays only, {area_text(shape.area)}"
    add_line(ax, shape.ends, closed=True, color=PURPLE, linestyle=(0, (4, 1.5)), linewidth=1.0, zorder=3.7, label=star)
    for reason, (marker, colour, words) in STOPS.items():
        ends = shape.ends[[one == reason for one in shape.reasons]]
        if len(ends):
            look = {"markerfacecolor": colour, "markeredgecolor": colour, "zorder": 5.0, "label": f"{words} ({len(ends)})"}
            add_dots(ax, ends, marker, 3.2, markeredgewidth=0.8, **look)
