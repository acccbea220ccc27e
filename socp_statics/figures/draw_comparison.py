"""Pyramids beside the exact cone, for one stance: the family of regions, errors against sides, times against sides."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator
from scipy.spatial import ConvexHull

from socp_statics.cones.choice import EXACT
from socp_statics.figures.draw_region import add_rays
from socp_statics.figures.log_axes import log_sides, percent, plain_ticks
from socp_statics.figures.marks import add_filled, add_line
from socp_statics.figures.region_shape import RegionShape
from socp_statics.figures.style import BLACK, BLUE, GREY, PURPLE, REGION_LINES, SKY, VERMILLION
from socp_statics.figures.window import Window
from socp_statics.spatial import Array

QUANTITIES = {
    "margin": ("margin", BLACK, "o"),
    "region": ("area", BLUE, "s"),
    "contact_forces": ("force optimisation", VERMILLION, "^"),
    "minimax_wrench": ("minimax", PURPLE, "D"),
}
ENGINES = {"kernel": BLUE, "clarabel": VERMILLION, "HiGHS": BLACK, "HiGHS (SciPy)": GREY}
LEAST = 1e-4
KINDS: dict[str, Any] = {"circumscribed": "-", "inscribed": (0, (2.5, 1.5))}


def draw_region_family(comparison: Mapping[str, Any], ax: Axes) -> Axes:
    """The exact region, filled, with the regions of the pyramid at all its headings as thin lines.

    Args:
        comparison: Of one stance.
        ax: Axes to draw into.

    Returns:
        The axes, equal and in metres.
    """
    regions = comparison["regions"]
    exact, rays = (np.array(regions.get(key, []), dtype=float).reshape(-1, 2) for key in ("exact", "rays"))
    shown = [exact]
    if len(exact) > 1:
        whole = _with_rays(exact, rays)
        if len(whole) > 2:
            add_filled(ax, whole, facecolor=SKY, alpha=0.45, edgecolor="none", zorder=1.0)
        add_line(ax, whole, closed=True, label=f"exact{_no_end(rays)}", **REGION_LINES["exact"])
    for kind in ("inscribed", "circumscribed"):
        mine = regions.get(kind, [])
        ends = _no_end(mine[0].get("rays", [])) if mine else ""
        label: str | None = f"{kind}, {regions.get('sides')} sides{ends}"
        for one in mine:
            corners = np.array(one["corners"], dtype=float).reshape(-1, 2)
            if len(corners) > 1:
                whole = _with_rays(corners, np.array(one.get("rays", []), dtype=float).reshape(-1, 2))
                add_line(ax, whole, closed=True, label=label, color=REGION_LINES[kind]["color"], linewidth=0.6, zorder=3.5)
                shown.append(corners)
                label = None
    points = np.vstack(shown)
    if len(points):
        low, high = points.min(axis=0), points.max(axis=0)
        # a square, so that the panel has the shape of those beside it
        middle, half = 0.5 * (low + high), 0.56 * max(float((high - low).max()), 1e-3)
        view = Window(middle[0] - half, middle[0] + half, middle[1] - half, middle[1] + half)
        ax.set_xlim(view.x_min, view.x_max)
        ax.set_ylim(view.y_min, view.y_max)
        if len(rays):
            add_rays(ax, RegionShape("unbounded", exact, exact, rays, np.inf, None, EXACT), view)
    else:
        ax.text(0.5, 0.5, "no region", ha="center", va="center", transform=ax.transAxes)
    ax.set_box_aspect(1.0)
    # while the sheet is laid out the box is narrower than its slot: room left of it would count as room for its labels
    ax.set_anchor("NW")
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_locator(MaxNLocator(6, steps=[1, 2, 5, 10]))
    ax.set_xlabel("x [m]")
    ax.set_ylabel("y [m]")
    return ax


def _no_end(rays: Sequence[Any] | Array) -> str:
    return ": no end" if len(rays) else ""


def _with_rays(corners: Array, rays: Array) -> Array:
    """The hull of corners and of rays from them, cut off far outside every view, counter-clockwise."""
    if not len(rays):
        return corners
    far = 100.0 * float(np.ptp(corners, axis=0).max())
    points = np.vstack([corners, (corners[:, None] + far * rays[None]).reshape(-1, 2)])
    if len(corners) == 2:
        along = points @ (corners[1] - corners[0])
        return points[[int(np.argmin(along)), int(np.argmax(along))]]
    hull: Array = points[ConvexHull(points).vertices]
    return hull


def draw_errors(comparison: Mapping[str, Any], ax: Axes) -> Axes:
    """Magnitude of the relative errors against the number of sides, circumscribed upwards and inscribed dashed; bars span the headings.

    Bars of errors that come down to nothing at some heading end in a triangle; quantities without a finite error are named only.

    Args:
        comparison: Of one stance.
        ax: Axes to draw into, logarithmic both ways.
    """
    drawn: list[float] = []
    falls: list[tuple[Array, Array, str]] = []
    blank: list[str] = []
    names = [name for name in QUANTITIES if name in comparison["exact"]]
    for place, name in enumerate(names):
        words, colour, marker = QUANTITIES[name]
        every = [r for r in comparison["spread"] if r["quantity"] == name]
        if not any(_shown(r["most"]) for r in every):
            blank.append(f"{words}: {_without_mark(every)}")
            continue
        for kind, dashes in KINDS.items():
            rows = [r for r in every if r["kind"] == kind and _shown(r["most"])]
            if not rows:
                continue
            shift = 1.0 + 0.03 * (place - 0.5 * (len(names) - 1))
            sides = np.array([row["sides"] for row in rows]) * shift
            least, most = np.abs([[row["least"], row["most"]] for row in rows]).T
            face = colour if kind == "circumscribed" else "white"
            ax.plot(
                sides, most, color=colour, linestyle=dashes, linewidth=0.9, marker=marker, markersize=2.8, markerfacecolor=face,
                markeredgewidth=0.7,
            )  # fmt: skip
            spans = least > LEAST
            ax.vlines(sides[spans], least[spans], most[spans], color=colour, linewidth=0.5, alpha=0.6)
            drawn += [*most, *least[spans]]
            falls.append((sides[~spans], most[~spans], colour))
        ax.plot([], [], color=colour, marker=marker, markersize=2.8, linewidth=0.9, label=words)
    if drawn:
        bottom = max(min(10.0 ** np.floor(np.log10(min(drawn))), 1e-3), LEAST)
        ax.set_yscale("log")
        ax.axhline(0.01, color=GREY, linewidth=0.5, zorder=0.5)
        _add_falls(ax, falls, 1.5 * bottom)
        ax.set_ylim(bottom, 1.6 * max(drawn))
        plain_ticks(ax, percent)
        ax.plot([], [], color=GREY, linewidth=0.9, marker="o", markersize=2.8, label="circumscribed: unsafe")
        hollow: dict[str, Any] = {"markerfacecolor": "white", "markeredgewidth": 0.7}
        ax.plot([], [], color=GREY, linewidth=0.9, linestyle=KINDS["inscribed"], marker="o", markersize=2.8, **hollow,
                label="inscribed: safe")  # fmt: skip
    else:
        none = all(words.endswith(": no error") for words in blank)
        ax.text(0.5, 0.5, "no error" if none else "no finite error", ha="center", va="center", transform=ax.transAxes)
        ax.set_yticks([])
    for words in blank:
        ax.add_artist(Line2D([], [], linestyle="none", label=words))
    log_sides(ax, comparison["sides"])
    ax.set_ylabel("largest error over headings")
    return ax


def _add_falls(ax: Axes, falls: Iterable[tuple[Array, Array, str]], end: float) -> None:
    """Bars of errors that come down to nothing: to the foot of the panel, where a triangle says so."""
    label: str | None = "down to 0 at some heading"
    for sides, most, colour in falls:
        if len(sides):
            ax.vlines(sides, end, most, color=colour, linewidth=0.5, alpha=0.6)
            ax.plot(sides, np.full(len(sides), end), color=colour, marker="v", markersize=2.8, linestyle="none")
    if any(len(sides) for sides, _, _ in falls):
        ax.plot([], [], color=GREY, marker="v", markersize=2.8, linestyle="none", label=label)


def _without_mark(rows: Sequence[Mapping[str, Any]]) -> str:
    """Why a quantity has no mark among the errors."""
    errors = [abs(float(row["most"])) for row in rows]
    if not np.isfinite(errors).all():
        return "error without end"
    return "no error" if max(errors, default=0.0) == 0.0 else f"error below {percent(LEAST)}"


def draw_times(times: Iterable[Any], sides: Sequence[int], ax: Axes, quantity: str = "region") -> Axes:
    """CPU time of a quantity against the number of sides, by engine; the exact cone as horizontal lines.

    Args:
        times: Rows with quantity, cone, sides, engine, seconds and inside.
        sides: Numbers of sides.
        ax: Axes to draw into, logarithmic both ways.
        quantity: Which.
    """
    mine = [t for t in times if t.quantity == quantity]
    for engine, colour in ENGINES.items():
        exact = [t.seconds for t in mine if t.engine == engine and t.cone == "exact"]
        rows = [t for t in mine if t.engine == engine and t.cone != "exact"]
        if exact:
            ax.axhline(1e3 * exact[0], color=colour, linewidth=1.3, label=f"exact cone, {engine}")
        if rows:
            ax.plot(
                [t.sides for t in rows], [1e3 * t.seconds for t in rows], color=colour, linestyle=(0, (2.5, 1.5)), marker="o",
                markersize=2.4, linewidth=0.9, label=f"pyramid, {engine}",
            )  # fmt: skip
        if any(t.inside is not None for t in rows):
            ax.plot(
                [t.sides for t in rows], [1e3 * t.inside for t in rows], color=colour, linestyle=(0, (1.0, 1.0)), linewidth=0.9,
                label=f"of it inside {engine}",
            )  # fmt: skip
    ax.set_yscale("log")
    log_sides(ax, sides)
    ax.set_ylabel(f"CPU time of the {QUANTITIES[quantity][0]} [ms]")
    plain_ticks(ax)
    return ax


def _shown(error: Any) -> bool:
    return isinstance(error, int | float) and LEAST < abs(error) < np.inf
