"""Pyramids beside the exact cone, for one stance: the family of regions, errors against sides, times against sides."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FixedLocator, FuncFormatter, NullFormatter, NullLocator

from socp_statics.figures.marks import add_filled, add_line
from socp_statics.figures.style import BLACK, BLUE, GREY, PURPLE, REGION_LINES, SKY, VERMILLION

QUANTITIES = {
    "margin": ("margin", BLACK, "o"),
    "region": ("area", BLUE, "s"),
    "contact_forces": ("force optimisation", VERMILLION, "^"),
    "minimax_wrench": ("minimax", PURPLE, "D"),
}
ENGINES = {"kernel": BLUE, "clarabel": VERMILLION, "HiGHS": BLACK, "HiGHS (SciPy)": GREY}
LEAST = 1e-4


def draw_region_family(comparison: Mapping[str, Any], ax: Axes) -> Axes:
    """The exact region, filled, with the regions of the pyramid at all its headings as thin lines.

    Args:
        comparison: Of one stance.
        ax: Axes to draw into.

    Returns:
        The axes, equal and in metres.
    """
    regions = comparison["regions"]
    exact = np.array(regions.get("exact", []), dtype=float).reshape(-1, 2)
    shown = [exact]
    if len(exact) > 2:
        add_filled(ax, exact, facecolor=SKY, alpha=0.45, edgecolor="none", zorder=1.0)
        add_line(ax, exact, closed=True, label="exact", **REGION_LINES["exact"])
    for kind in ("inscribed", "circumscribed"):
        label: str | None = f"{kind}, {regions.get('sides')} sides"
        for one in regions.get(kind, []):
            corners = np.array(one["corners"], dtype=float).reshape(-1, 2)
            if len(corners) > 2:
                add_line(ax, corners, closed=True, label=label, color=REGION_LINES[kind]["color"], linewidth=0.6, zorder=3.5)
                shown.append(corners)
                label = None
    points = np.vstack(shown)
    if len(points):
        low, high = points.min(axis=0), points.max(axis=0)
        # a square, so that the panel has the shape of those beside it
        middle, half = 0.5 * (low + high), 0.56 * max(float((high - low).max()), 1e-3)
        ax.set_xlim(middle[0] - half, middle[0] + half)
        ax.set_ylim(middle[1] - half, middle[1] + half)
    else:
        ax.text(0.5, 0.5, "no region", ha="center", va="center", transform=ax.transAxes)
    ax.set_box_aspect(1.0)
    ax.set_xlabel("x [m]")
    ax.set_ylabel("y [m]")
    return ax


def draw_errors(comparison: Mapping[str, Any], ax: Axes) -> Axes:
    """Magnitude of the relative errors against the number of sides, circumscribed upwards and inscribed dashed; bars span the headings.

    Args:
        comparison: Of one stance.
        ax: Axes to draw into, logarithmic both ways.
    """
    drawn = False
    names = [name for name in QUANTITIES if name in comparison["exact"]]
    for place, name in enumerate(names):
        words, colour, marker = QUANTITIES[name]
        for kind, dashes in (("circumscribed", "-"), ("inscribed", (0, (2.5, 1.5)))):
            rows = [r for r in comparison["spread"] if r["quantity"] == name and r["kind"] == kind and _shown(r["most"])]
            if not rows:
                continue
            shift = 1.0 + 0.03 * (place - 0.5 * (len(names) - 1))
            sides = np.array([row["sides"] for row in rows]) * shift
            ends = np.array([[max(abs(row["least"]), LEAST), abs(row["most"])] for row in rows])
            ax.plot(sides, ends[:, 1], color=colour, linestyle=dashes, linewidth=0.9, marker=marker, markersize=2.6)
            ax.vlines(sides, ends[:, 0], ends[:, 1], color=colour, linewidth=0.5, alpha=0.45)
            drawn = True
        ax.plot([], [], color=colour, marker=marker, markersize=2.6, linewidth=0.9, label=words)
    ax.plot([], [], color=GREY, linewidth=0.9, label="circumscribed: unsafe")
    ax.plot([], [], color=GREY, linewidth=0.9, linestyle=(0, (2.5, 1.5)), label="inscribed: safe")
    if drawn:
        ax.set_yscale("log")
        ax.axhline(0.01, color=GREY, linewidth=0.5, zorder=0.5)
        ax.set_ylim(bottom=LEAST)
        ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{100 * value:g} %"))
    else:
        ax.text(0.5, 0.5, "no finite error", ha="center", va="center", transform=ax.transAxes)
        ax.set_yticks([])
    log_sides(ax, comparison["sides"])
    ax.set_ylabel("largest error over headings")
    return ax


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
    ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    return ax


def log_sides(ax: Axes, sides: Sequence[int]) -> None:
    """A logarithmic axis of numbers of sides with a tick at each that has room."""
    ax.set_xscale("log")
    ticks: list[int] = []
    for n in sides:
        if not ticks or math.log(n / ticks[-1]) > 0.08 * math.log(max(sides) / min(sides) + 1.0):
            ticks.append(n)
    ax.xaxis.set_major_locator(FixedLocator(ticks))
    ax.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    ax.xaxis.set_minor_locator(NullLocator())
    ax.xaxis.set_minor_formatter(NullFormatter())
    ax.set_xlim(0.9 * min(sides), 1.12 * max(sides))
    ax.set_xlabel("sides of the pyramid")


def _shown(error: Any) -> bool:
    return isinstance(error, int | float) and abs(error) > LEAST
