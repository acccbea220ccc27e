"""Where things stand on the sheet: title and words above, panels below each other, the legend at the bottom."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from socp_statics.figures.marks import LEGEND_MARKS, legend_entries
from socp_statics.figures.place_names import text_width
from socp_statics.figures.style import BLACK, COLUMN
from socp_statics.figures.window import Window

RIM = 0.06
LINE = 0.135
TICKS = 0.34
LEFT, RIGHT = 0.5, 0.12
SHEET_AXES = COLUMN - LEFT - RIGHT
TALLEST, TALLEST_OF_TWO, LOWEST = 3.2, 2.4, 1.1


class Words(NamedTuple):
    """A line of text above the panels."""

    text: str
    color: str = BLACK
    weight: str = "normal"
    size: float = 7.0


def new_axes(count: int = 1) -> Axes:
    """Axes of a new figure without a window of the screen; further axes are in ``sheet_of(ax).axes``."""
    figure = Figure(figsize=(COLUMN, COLUMN))
    FigureCanvasAgg(figure)
    for _ in range(count):
        figure.add_axes((0.1, 0.1, 0.8, 0.8))
    return figure.axes[0]


def sheet_of(ax: Axes) -> Figure:
    """The whole figure that axes belong to."""
    figure = ax.get_figure(root=True)
    assert figure is not None
    return figure


def shaped_for_sheet(window: Window, panels: int = 1) -> Window:
    """What a panel will show of a window once it has its shape, up to the room that its tick labels take."""
    return window.shaped(LOWEST / SHEET_AXES, (TALLEST if panels == 1 else TALLEST_OF_TWO) / SHEET_AXES)


def wrapped(text: str, width: float, size: float = 7.0, weight: str = "normal") -> list[str]:
    """A text in lines no wider than a width in points; a word that is wider is cut."""
    lines: list[str] = []
    for word in text.split():
        while text_width(word, size, weight) > width:
            cut = max(1, int(0.95 * len(word) * width / text_width(word, size, weight)))
            while cut > 1 and text_width(word[:cut], size, weight) > width:
                cut -= 1
            lines.append(word[:cut])
            word = word[cut:]
        if lines and text_width(f"{lines[-1]} {word}", size, weight) <= width:
            lines[-1] = f"{lines[-1]} {word}"
        else:
            lines.append(word)
    return lines


def arrange(figure: Figure, panels: Sequence[tuple[Axes, Window]], title: str = "", words: Iterable[Words] = ()) -> None:
    """Give panels, words and legend their places and the sheet its height; the width is one column.

    Args:
        figure: A figure of `new_axes`.
        panels: Axes from top to bottom, each with what it has to show.
        title: Above everything.
        words: Lines under the title, wrapped where they are too long.
    """
    inches = 72.0 * (COLUMN - 2 * RIM)
    paragraphs = [Words(title, BLACK, "bold", 8.0), *words]
    head = [p._replace(text=line) for p in paragraphs for line in wrapped(p.text, inches, p.size, p.weight)]
    top = RIM + LINE * len(head) + 0.04
    legend = _legend(figure, [ax for ax, _ in panels])
    foot = 0.0 if legend is None else legend.get_window_extent(_renderer(figure)).height / figure.dpi
    left = LEFT
    for _ in range(2):
        heights = _fit(panels, left, TALLEST if len(panels) == 1 else TALLEST_OF_TWO)
        tall = top + sum(heights) + TICKS * len(panels) + 0.06 * (len(panels) - 1) + foot + RIM
        _place(figure, panels, heights, left, top, tall)
        left = _left(panels)
    for k, line in enumerate(head):
        y = 1.0 - (RIM + LINE * (k + 0.8)) / tall
        figure.text(RIM / COLUMN, y, line.text, fontsize=line.size, color=line.color, weight=line.weight, ha="left", va="baseline")
    if legend is not None:
        legend.set_bbox_to_anchor((0.5, 0.5 * RIM / tall), transform=figure.transFigure)


def _renderer(figure: Figure):  # type: ignore[no-untyped-def]
    canvas = figure.canvas
    assert isinstance(canvas, FigureCanvasAgg)
    return canvas.get_renderer()


def _legend(figure: Figure, axes: Sequence[Axes]) -> Legend | None:
    """A legend below everything, in two columns where they are narrow enough."""
    entries = legend_entries(*axes)
    if not entries:
        return None
    handles, labels = list(entries.values()), list(entries)
    measured = sum(", " in label for label in labels)
    for columns in (2, 1):
        # regions with their areas have long labels: all of them stand in the first column
        blank = max(2 * measured - len(labels), 0) if columns == 2 and len(labels) > measured else 0
        legend = figure.legend(
            handles + blank * [Line2D([], [], linestyle="none")],
            labels + blank * [" "],
            ncols=columns,
            loc="lower center",
            handler_map=LEGEND_MARKS,
            borderpad=0.1,
            borderaxespad=0.0,
            labelspacing=0.35,
            columnspacing=0.9,
            handlelength=1.8,
            handletextpad=0.5,
        )
        if columns == 1 or legend.get_window_extent(_renderer(figure)).width <= figure.dpi * (COLUMN - RIM):
            return legend
        legend.remove()
    return None


def _fit(panels: Sequence[tuple[Axes, Window]], left: float, tallest: float) -> list[float]:
    """Widen windows to the shape of their panels; heights of the panels in inches."""
    wide = COLUMN - left - RIGHT
    heights = []
    for ax, window in panels:
        shown = window.shaped(LOWEST / wide, tallest / wide)
        ax.set_xlim(shown.x_min, shown.x_max)
        ax.set_ylim(shown.y_min, shown.y_max)
        ax.set_aspect("equal", adjustable="box")
        heights.append(wide * shown.height / shown.width)
    return heights


def _place(figure: Figure, panels: Sequence[tuple[Axes, Window]], heights: list[float], left: float, top: float, tall: float) -> None:
    figure.set_size_inches(COLUMN, tall)
    wide = COLUMN - left - RIGHT
    edge = tall - top
    for (ax, _), high in zip(panels, heights, strict=True):
        ax.set_position((left / COLUMN, (edge - high) / tall, wide / COLUMN, high / tall))
        edge -= high + TICKS + 0.06
        ax.yaxis.set_label_coords((RIM + 0.11 - left) / wide, 0.5)
        _set_ticks(ax, wide, high)


def _set_ticks(ax: Axes, wide: float, high: float) -> None:
    """As many ticks as there is room for their labels."""
    for axis, limits, room in ((ax.xaxis, ax.get_xlim(), wide), (ax.yaxis, ax.get_ylim(), high)):
        for count in (7, 6, 5, 4, 3, 2):
            locator = MaxNLocator(count, steps=[1, 2, 5, 10])
            ticks = [t for t in locator.tick_values(*limits) if limits[0] <= t <= limits[1]]
            labels = axis.get_major_formatter().format_ticks(ticks)
            axis.set_major_locator(locator)
            needs = max(map(text_width, labels), default=0.0) / 72.0 + 0.12 if axis is ax.xaxis else 0.3
            if needs * len(ticks) <= room:
                break


def _left(panels: Sequence[tuple[Axes, Window]]) -> float:
    """Room for tick labels and the axis label at the left, in inches."""
    widest = 0.0
    for ax, _ in panels:
        limits = ax.get_ylim()
        ticks = [t for t in ax.yaxis.get_major_locator().tick_values(*limits) if limits[0] <= t <= limits[1]]
        labels = ax.yaxis.get_major_formatter().format_ticks(ticks)
        widest = max([widest, *(text_width(label) / 72.0 for label in labels)])
    return float(np.ceil(100 * (RIM + 0.17 + widest + 0.06))) / 100
