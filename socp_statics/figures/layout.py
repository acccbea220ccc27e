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
from socp_statics.figures.window import Window, show_window

RIM = 0.06
LINE = 0.135
TICKS = 0.34
LEFT, RIGHT = 0.5, 0.12
SHEET_AXES = COLUMN - LEFT - RIGHT
SPACE, BESIDE = 0.06, 0.16
TALLEST, TALLEST_OF_TWO, TALLEST_ABOVE_BARS, TALLEST_BESIDE, LOWEST = 3.2, 2.4, 2.05, 4.4, 1.1


class Row(NamedTuple):
    """Panels beside each other, to one scale.

    Attributes:
        axes: From left to right; the second and later ones take the vertical axis of the first.
        windows: What each has to show [m].
        head: Room above the axes [in].
    """

    axes: tuple[Axes, ...]
    windows: tuple[Window, ...]
    head: float = 0.0


class Bars(NamedTuple):
    """Axes of a fixed height with words at both sides, all in inches.

    Attributes:
        axes: The axes, and others in the same place with scales of their own.
        height: Of the axes.
        left: Room for words at the left.
        right: Room for words at the right.
        head: Room above the axes.
    """

    axes: tuple[Axes, ...]
    height: float
    left: float
    right: float
    head: float


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


def show_alone_or_in(own: Axes, given: Axes | None, window: Window, words: Sequence[Words] = (), head: float = 0.0) -> None:
    """Arrange the sheet of new axes, or grow the view of axes that belong to the caller.

    Args:
        own: The axes that were drawn into.
        given: Those of the caller, None where ``own`` are new.
        window: What to show [m].
        words: Lines above new axes.
        head: Room above new axes [in].
    """
    if given is None:
        arrange(sheet_of(own), [Row((own,), (window,), head)], words=words)
    else:
        show_window(own, window)


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


def arrange(figure: Figure, rows: Sequence[Row | Bars], title: str = "", words: Iterable[Words] = (), wide: float = COLUMN) -> None:
    """Give panels, words and legend their places and the sheet its height.

    Args:
        figure: A figure of `new_axes`.
        rows: What stands below each other, from top to bottom.
        title: Above everything.
        words: Lines under the title, wrapped where they are too long.
        wide: Width of the sheet [in].
    """
    figure.set_figwidth(wide)
    inches = 72.0 * (wide - 2 * RIM)
    paragraphs = [Words(title, BLACK, "bold", 8.0), *words]
    head = [p._replace(text=line) for p in paragraphs for line in wrapped(p.text, inches, p.size, p.weight)]
    top = RIM + LINE * len(head) + 0.04
    legend = _legend(figure, [ax for row in rows for ax in row.axes], wide)
    foot = 0.0 if legend is None else legend.get_window_extent(_renderer(figure)).height / figure.dpi
    tallest = _tallest(rows, wide)
    left = LEFT
    for _ in range(2):
        heights = [row.height if isinstance(row, Bars) else _fit(row, wide - left - RIGHT, tallest) for row in rows]
        tall = top + sum(heights) + sum(row.head for row in rows) + TICKS * len(rows) + SPACE * (len(rows) - 1) + foot + RIM
        figure.set_size_inches(wide, tall)
        edge = tall - top
        for row, high in zip(rows, heights, strict=True):
            edge -= row.head
            if isinstance(row, Bars):
                row.axes[0].set_position((row.left / wide, (edge - high) / tall, (wide - row.left - row.right) / wide, high / tall))
            else:
                _place(row, left, edge, high, (wide, tall))
            edge -= high + TICKS + SPACE
        left = _left(rows)
    for k, line in enumerate(head):
        y = 1.0 - (RIM + LINE * (k + 0.8)) / tall
        figure.text(RIM / wide, y, line.text, fontsize=line.size, color=line.color, weight=line.weight, ha="left", va="baseline")
    if legend is not None:
        legend.set_bbox_to_anchor((0.5, 0.5 * RIM / tall), transform=figure.transFigure)


def _renderer(figure: Figure):  # type: ignore[no-untyped-def]
    canvas = figure.canvas
    assert isinstance(canvas, FigureCanvasAgg)
    return canvas.get_renderer()


def _legend(figure: Figure, axes: Sequence[Axes], wide: float) -> Legend | None:
    """A legend below everything, in two columns where they are narrow enough."""
    entries = legend_entries(*axes)
    if not entries:
        return None
    handles, labels = list(entries.values()), list(entries)
    measured = sum(", " in label for label in labels)
    for columns, tight in ((4, 1.0), (2, 1.0), (2, 0.75), (1, 1.0))[int(wide <= COLUMN) :]:
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
            columnspacing=0.9 * tight,
            handlelength=1.8 * tight,
            handletextpad=0.5 * tight,
        )
        if columns == 1 or legend.get_window_extent(_renderer(figure)).width <= figure.dpi * (wide - RIM):
            return legend
        legend.remove()
    return None


def _tallest(rows: Sequence[Row | Bars], wide: float) -> float:
    """Of one row of panels, in inches."""
    panels = [row for row in rows if isinstance(row, Row)]
    if len(panels) > 1:
        return TALLEST_OF_TWO if len(panels) == len(rows) else TALLEST_ABOVE_BARS
    return TALLEST_BESIDE if wide > COLUMN else TALLEST


def _fit(row: Row, room: float, tallest: float) -> float:
    """Widen windows to the shape of their panels; height of the panels in inches."""
    room -= BESIDE * (len(row.axes) - 1)
    low, high = min(w.y_min for w in row.windows), max(w.y_max for w in row.windows)
    width = sum(w.width for w in row.windows)
    height = max(high - low, width * LOWEST / room)
    wider = max(height * room / tallest - width, 0.0) / len(row.axes)
    for ax, window in zip(row.axes, row.windows, strict=True):
        ax.set_xlim(window.x_min - 0.5 * wider, window.x_max + 0.5 * wider)
        ax.set_ylim(0.5 * (low + high - height), 0.5 * (low + high + height))
        ax.set_aspect("equal", adjustable="box")
    return height * room / (width + wider * len(row.axes))


def _place(row: Row, left: float, edge: float, high: float, sheet: tuple[float, float]) -> None:
    """Put the panels of a row between its left margin and the right one, their upper edge so far above the foot of the sheet."""
    wide, tall = sheet
    room = wide - left - RIGHT - BESIDE * (len(row.axes) - 1)
    total = sum(float(np.ptp(ax.get_xlim())) for ax in row.axes)
    start = left
    for k, ax in enumerate(row.axes):
        own = room * float(np.ptp(ax.get_xlim())) / total
        ax.set_position((start / wide, (edge - high) / tall, own / wide, high / tall))
        start += own + BESIDE
        if k == 0:
            ax.yaxis.set_label_coords((RIM + 0.11 - left) / own, 0.5)
        else:
            ax.yaxis.label.set_visible(False)
            ax.tick_params(labelleft=False)
        _set_ticks(ax, own, high)


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


def _left(rows: Sequence[Row | Bars]) -> float:
    """Room for tick labels and the axis label at the left, in inches."""
    widest = 0.0
    for row in rows:
        if isinstance(row, Row):
            limits = row.axes[0].get_ylim()
            axis = row.axes[0].yaxis
            ticks = [t for t in axis.get_major_locator().tick_values(*limits) if limits[0] <= t <= limits[1]]
            widest = max([widest, *(text_width(label) / 72.0 for label in axis.get_major_formatter().format_ticks(ticks))])
    return float(np.ceil(100 * (RIM + 0.17 + widest + 0.06))) / 100
