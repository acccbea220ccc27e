"""Pyramids beside the exact cone, over a population: rates of false verdicts with their confidence, and errors of areas."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter

from socp_statics.figures.log_axes import LogPercent, log_sides, percent
from socp_statics.figures.style import GREY, REGION_LINES
from socp_statics.spatial import Array

RATES, ERRORS = LogPercent(1e-4, 1.0), LogPercent(1e-4, 10.0)
BESIDE = {"inscribed": 0.985, "circumscribed": 1.015}
MARKERS = {"inscribed": "s", "circumscribed": "o"}
WORDS = {"inscribed": "inscribed: falsely unstable", "circumscribed": "circumscribed: falsely stable"}


def draw_rates(comparison: Mapping[str, Any], ax: Axes) -> Axes:
    """Rates of false verdicts against the number of sides, with bands of confidence.

    Args:
        comparison: Of a population.
        ax: Axes to draw into, logarithmic both ways.
    """
    for kind, words in WORDS.items():
        rows = [r for r in comparison["rates"] if r["kind"] == kind and not r["where"] and r["rate"] is not None]
        if not rows:
            continue
        sides = [r["sides"] for r in rows]
        low, rate, high = (np.array([r[key] for r in rows]) for key in ("low", "rate", "high"))
        _add_banded(ax, kind, sides, RATES.place(low), RATES.place(rate), RATES.place(high), words)
    RATES.set(ax)
    log_sides(ax, comparison["sides"])
    ax.set_ylabel("share of those that can be misjudged")
    return ax


def _add_banded(ax: Axes, kind: str, sides: list[int], low: Array, middle: Array, high: Array, words: str | None = None) -> None:
    """A line with a band around it; a mark with a bar where there is one number of sides only."""
    style: dict[str, Any] = {"color": REGION_LINES[kind]["color"], "marker": MARKERS[kind], "markersize": 2.8, "label": words}
    if len(sides) == 1:
        ax.errorbar([sides[0] * BESIDE[kind]], middle, [middle - low, high - middle], linestyle="none", elinewidth=0.8, **style)
        return
    ax.fill_between(sides, low, high, color=style["color"], alpha=0.22, linewidth=0.0)
    ax.plot(sides, middle, **style)


def draw_rates_by(comparison: Mapping[str, Any], name: str, sides: int, ax: Axes) -> Axes:
    """Rates of false verdicts of one pyramid under each value of a circumstance, bars of confidence.

    Args:
        comparison: Of a population.
        name: The circumstance.
        sides: Of the pyramid.
        ax: Axes to draw into.
    """
    values: list[Any] = []
    for row in comparison["rates"]:
        if list(row["where"]) == [name] and row["where"][name] not in values:
            values.append(row["where"][name])
    for kind, shift in (("inscribed", -0.12), ("circumscribed", 0.12)):
        rows = [r for r in comparison["rates"] if r["kind"] == kind and r["sides"] == sides and list(r["where"]) == [name]]
        rows = [r for r in rows if r["rate"] is not None]
        at = np.array([values.index(r["where"][name]) for r in rows]) + shift
        rate = np.array([r["rate"] for r in rows])
        ends = np.array([[r["rate"] - r["low"] for r in rows], [r["high"] - r["rate"] for r in rows]])
        colour = REGION_LINES[kind]["color"]
        ax.errorbar(at, rate, np.maximum(ends, 0.0), color=colour, marker=MARKERS[kind], markersize=2.8, linestyle="none", elinewidth=0.8)
    ax.set_xticks(range(len(values)), [_named(value) for value in values])
    if values and all(isinstance(value, str) for value in values):
        ax.tick_params(axis="x", labelrotation=40.0)
        for label in ax.get_xticklabels():
            label.set_horizontalalignment("right")
            label.set_rotation_mode("anchor")
    ax.set_xlim(-0.5, max(len(values), 1) - 0.5)
    # room for the marks of rates that are zero
    ax.set_ylim(bottom=-0.03 * ax.get_ylim()[1])
    ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: percent(value)))
    ax.set_xlabel(name)
    ax.set_ylabel(f"false verdicts, {sides} sides")
    return ax


def draw_area_errors(comparison: Mapping[str, Any], ax: Axes) -> Axes:
    """Magnitude of the error of the region's area against the number of sides: median, and the band of 5 to 95 % of the regions.

    Args:
        comparison: Of a population.
        ax: Axes to draw into, logarithmic both ways.
    """
    for kind in ("inscribed", "circumscribed"):
        rows = [r for r in comparison["areas"] if r["kind"] == kind and not r["where"]]
        if not rows:
            continue
        sides = [r["sides"] for r in rows]
        ends = np.array([[abs(float(r[key])) for key in ("low", "median", "high")] for r in rows])
        low, high = np.sort(ends[:, (0, 2)], axis=1).T
        _add_banded(ax, kind, sides, ERRORS.place(low), ERRORS.place(ends[:, 1]), ERRORS.place(high))
    ax.axhline(0.01, color=GREY, linewidth=0.5, zorder=0.5)
    ERRORS.set(ax)
    log_sides(ax, comparison["sides"])
    ax.set_ylabel("error of the area: median, 5 to 95 %")
    return ax


def _named(value: Any) -> str:
    return value.replace("_", " ") if isinstance(value, str) else f"{value:g}"


def circumstances(comparison: Mapping[str, Any]) -> Sequence[str]:
    """Circumstances with a panel of their own: up to three, those with words last."""
    by: list[str] = comparison["by"]
    words = [name for name in by if any(isinstance(row["where"].get(name), str) for row in comparison["rates"])]
    return [*(name for name in by if name not in words), *words][:3]
