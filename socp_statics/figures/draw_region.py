"""Support regions and bases of support on the floor plan."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle

from socp_statics.figures.layout import Words, new_axes, show_alone_or_in
from socp_statics.figures.marks import add_arrow, add_dots, add_filled, add_line
from socp_statics.figures.quantities import area_text, length_text
from socp_statics.figures.region_shape import RegionShape, shape_of_region
from socp_statics.figures.style import BASE_LINE, BLACK, REGION_LINES, SKY, house_style
from socp_statics.figures.window import Window, choose_window, inside, label_axes
from socp_statics.regions import BaseOfSupport, SupportRegion
from socp_statics.regions.polygon import distance
from socp_statics.spatial import Array


def draw_region(region: SupportRegion, ax: Axes | None = None) -> Axes:
    """Draw a support region: attained positions filled, the outer polygon as a line.

    Args:
        region: The region.
        ax: Axes to draw into, the view grows as needed; by default those of a new figure with a legend.

    Returns:
        The axes, equal and in metres.
    """
    shape = shape_of_region(region)
    if region.clip is None:
        points = shape.inner if len(shape.inner) else np.zeros((1, 2))
        window = choose_window(points, np.zeros((0, 2)), [], [])
    else:
        x_min, x_max, y_min, y_max = region.clip
        # the clipping square has ten sizes on each side of the contacts: show one and a half
        window = Window(x_min, x_max, y_min, y_max).grown(-0.425 * (x_max - x_min))
    with house_style():
        own = new_axes() if ax is None else ax
        add_region(own, shape, filled=True)
        add_rays(own, shape, window)
        label_axes(own)
        show_alone_or_in(own, ax, window, words=[Words("the region is empty")] if shape.kind == "empty" else [])
    return own


def draw_base_of_support(base: BaseOfSupport, ax: Axes | None = None) -> Axes:
    """Draw a base of support as a dashed outline.

    Args:
        base: The base of support.
        ax: Axes to draw into, the view grows as needed; by default those of a new figure with a legend.

    Returns:
        The axes, equal and in metres.
    """
    window = choose_window(base.vertices, np.zeros((0, 2)), [], [])
    with house_style():
        own = new_axes() if ax is None else ax
        add_base_of_support(own, base)
        label_axes(own)
        show_alone_or_in(own, ax, window)
    return own


def add_region(ax: Axes, shape: RegionShape, *, filled: bool) -> None:
    """Add a region to a floor plan.

    Args:
        ax: The axes.
        shape: The region.
        filled: Whether to fill what is attained.
    """
    style = REGION_LINES[shape.cone.kind]
    words = shape.words
    if shape.kind in ("segment", "point") or len(shape.inner) == 2:
        _add_flat(ax, shape, filled)
    elif shape.kind in ("polygon", "unbounded") and len(shape.inner) > 2:
        if filled:
            edge = {"edgecolor": style["color"], "linewidth": 0.0}
            add_filled(ax, shape.inner, facecolor=SKY, alpha=0.45, zorder=1.0, **edge)
            # the legend shows filling and outline in one mark
            add_filled(ax, np.zeros((0, 2)), facecolor=(*_rgb(SKY), 0.45), edgecolor=style["color"], linewidth=1.0, label=words)
        add_line(ax, shape.outer, closed=True, label=None if filled else words, **style)


def _rgb(colour: str) -> tuple[float, float, float]:
    return (int(colour[1:3], 16) / 255, int(colour[3:5], 16) / 255, int(colour[5:7], 16) / 255)


def _add_flat(ax: Axes, shape: RegionShape, filled: bool) -> None:
    """A segment or a point: a band or a diamond for the filled region, so that thinner marks stay visible on it."""
    style = REGION_LINES[shape.cone.kind]
    colour = style["color"]
    if len(shape.inner) == 2:
        if filled:
            add_line(ax, shape.inner, color=SKY, linewidth=5.0, alpha=0.6, zorder=1.5, solid_capstyle="butt")
        add_line(ax, shape.inner, label=shape.words, **style)
        return
    face = (*_rgb(SKY), 0.6) if filled else "none"
    size = {"exact": 12.0, "circumscribed": 15.0, "inscribed": 9.0}[shape.cone.kind]
    add_dots(
        ax, shape.inner, "D", size, markerfacecolor=face, markeredgecolor=colour, markeredgewidth=1.0, zorder=style["zorder"],
    )  # fmt: skip
    add_dots(ax, np.zeros((0, 2)), "D", 5.5, markerfacecolor=face, markeredgecolor=colour, markeredgewidth=1.0, label=shape.words)


def add_rays(ax: Axes, shape: RegionShape, window: Window) -> None:
    """Add arrows at the rim of the view along the directions in which a region has no end.

    Args:
        ax: The axes.
        shape: The region.
        window: What the figure shows.
    """
    seen = inside(shape.inner, window)
    if not len(seen):
        return
    start = 0.5 * (seen.min(axis=0) + seen.max(axis=0)) if len(shape.rays) > 1 else seen.mean(axis=0)
    if not len(shape.inner) < 3 and float(distance(shape.inner, start)) < 0.0:
        start = seen.mean(axis=0)
    low, high = np.array([window.x_min, window.y_min]), np.array([window.x_max, window.y_max])
    label: str | None = "the region has no end"
    for ray in shape.rays:
        with np.errstate(divide="ignore", invalid="ignore"):
            reach = np.where(ray > 0, (high - start) / ray, np.where(ray < 0, (low - start) / ray, np.inf)).min()
        head = start + 0.97 * reach * ray
        tail = head - min(0.11 * window.span, 0.6 * reach) * ray
        add_arrow(ax, tail, head, head_size=9.0, color=REGION_LINES["exact"]["color"], linewidth=2.0, zorder=3.8, label=label)
        label = None


def add_base_of_support(ax: Axes, base: BaseOfSupport) -> None:
    """Add a base of support to a floor plan."""
    if base.kind == "polygon":
        add_line(ax, base.vertices, closed=True, label=f"base of support, {area_text(base.area)}", **BASE_LINE)
    elif base.kind == "segment":
        length = float(np.linalg.norm(base.vertices[1] - base.vertices[0]))
        add_line(ax, base.vertices, label=f"base of support, {length_text(length)} long", **BASE_LINE)


def add_com_margin(ax: Axes, com: Array, margin: float, region: Array, window: Window) -> None:
    """Add the margin of a centre of mass: inside the circle that touches the edge, outside the way to the region.

    Args:
        ax: The axes.
        com: Position on the plan, shape (2,) [m].
        margin: The margin [m].
        region: Attained corners, shape (k, 2) [m].
        window: What the figure shows.
    """
    words = "CoM margin"
    if not np.isfinite(margin) or not len(region):
        return
    if margin > 0.0:
        if margin < 2.0 * window.span:
            circle = Circle((float(com[0]), float(com[1])), margin, fill=False, edgecolor=BLACK, linewidth=0.7, zorder=4.0, label=words)
            ax.add_artist(circle)
    elif margin < 0.0:
        add_line(ax, np.vstack([com, nearest_point(region, com)]), color=BLACK, linewidth=0.9, zorder=4.0, label=words)


def nearest_point(corners: Array, xy: Array) -> Array:
    """The point of the edge of a polygon, segment or point that is nearest to a position, shape (2,)."""
    edges = np.roll(corners, -1, axis=0) - corners
    along = np.clip(((xy - corners) * edges).sum(axis=1) / np.maximum((edges * edges).sum(axis=1), 1e-300), 0.0, 1.0)
    feet = corners + along[:, None] * edges
    foot: Array = feet[int(np.argmin(np.linalg.norm(feet - xy, axis=1)))]
    return foot
