"""One figure for each comparison, two columns wide."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from typing import Any

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from socp_statics.figures.draw_comparison import draw_errors, draw_region_family, draw_times
from socp_statics.figures.draw_rates import circumstances, draw_area_errors, draw_rates, draw_rates_by
from socp_statics.figures.figure_file import figure_path, write_figure
from socp_statics.figures.layout import wrapped
from socp_statics.figures.marks import LEGEND_MARKS
from socp_statics.figures.style import TWO_COLUMNS, house_style

HEIGHT, LINE = 2.75, 0.125


def save_comparison(comparison: Mapping[str, Any], path: str | os.PathLike[str], times: Iterable[Any] = ()) -> None:
    """Draw a comparison into a file; the same comparison and times give the same bytes.

    Args:
        comparison: Of `socp_statics.comparison`, or read from its JSON.
        path: A name that ends in .pdf, .png or .svg; the file is complete or not there.
        times: Times of a stance, drawn beside its errors where there are any.

    Raises:
        InputError: The name ends otherwise.
        OSError: The file cannot be written.
    """
    target = figure_path(path)
    write_figure(comparison_figure(comparison, times), target, str(comparison["problem"]))


def comparison_figure(comparison: Mapping[str, Any], times: Iterable[Any] = ()) -> Figure:
    """The figure of a comparison.

    Args:
        comparison: The comparison.
        times: Times of a stance.

    Returns:
        Of a stance: the family of regions, errors against sides and, where there are times, times against sides. Of a population: rates
        against sides, rates under each circumstance, and errors of the area against sides.
    """
    with house_style():
        timed = list(times)
        if comparison["comparison"] == "stance":
            return _of_stance(comparison, timed)
        return _of_population(comparison)


def _of_stance(comparison: Mapping[str, Any], times: list[Any]) -> Figure:
    known = [name for name in ("region", "margin", "contact_forces", "minimax_wrench") if any(t.quantity == name for t in times)]
    figure = _sheet(comparison, HEIGHT)
    axes = figure.subplots(1, 3 if known else 2)
    draw_region_family(comparison, axes[0])
    draw_errors(comparison, axes[1])
    if known:
        draw_times(times, comparison["sides"], axes[2], known[0])
    for ax in axes:
        _legend_below(ax)
    return figure


def _of_population(comparison: Mapping[str, Any]) -> Figure:
    names = circumstances(comparison)
    shown = 4 if 4 in comparison["sides"] else min(comparison["sides"])
    figure = _sheet(comparison, 2.0 * HEIGHT - 0.3 if names else HEIGHT)
    if not names:
        first, second = figure.subplots(1, 2)
    else:
        grid = figure.add_gridspec(2, 6)
        first, second = figure.add_subplot(grid[0, :3]), figure.add_subplot(grid[0, 3:])
        share = 6 // len(names)
        for k, name in enumerate(names):
            draw_rates_by(comparison, name, shown, figure.add_subplot(grid[1, k * share : (k + 1) * share]))
    draw_rates(comparison, first)
    draw_area_errors(comparison, second)
    figure.legend(*first.get_legend_handles_labels(), loc="outside lower center", ncols=2)
    return figure


def _sheet(comparison: Mapping[str, Any], height: float) -> Figure:
    """A new figure with the answer as its heading."""
    lines = wrapped(f"{comparison['problem'] or 'records'}: {comparison['answer']}", 72.0 * (TWO_COLUMNS - 0.15), 7.0)
    figure = Figure(figsize=(TWO_COLUMNS, height + LINE * len(lines)), layout="constrained")
    FigureCanvasAgg(figure)
    figure.suptitle("\n".join(lines), fontsize=7.0, x=0.01, ha="left")
    return figure


def _legend_below(ax: Axes) -> None:
    if ax.get_legend_handles_labels()[1]:
        ax.legend(
            loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=1, fontsize=6.0, handlelength=2.4, labelspacing=0.25,
            handler_map=LEGEND_MARKS,
        )  # fmt: skip
