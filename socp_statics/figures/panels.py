"""Sheets of many panels for report figures: their places, letters, equal scales and one legend below."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from socp_statics.figures.marks import LEGEND_MARKS, legend_entries
from socp_statics.figures.style import TWO_COLUMNS
from socp_statics.figures.window import Window

LEFT, RIGHT, FOOT, HEAD = 0.42, 0.08, 0.36, 0.2


def panels(rows: int, columns: int, *, wide: float = TWO_COLUMNS, high: float = 1.5, foot: float = 0.2,
           left: float = LEFT, right: float = RIGHT, between: float = FOOT) -> tuple[Figure, list[Axes]]:  # fmt: skip
    """A sheet of equal panels.

    Args:
        rows: Below each other.
        columns: Beside each other.
        wide: Of the sheet [in].
        high: Of one panel [in].
        foot: Room for a legend at the bottom [in].
        left: Room for tick labels at the left of each panel [in].
        right: Room at the right of each panel [in].
        between: Room for tick labels below each panel [in].

    Returns:
        The figure, and its axes row by row.
    """
    tall = foot + rows * (HEAD + high + between)
    figure = Figure(figsize=(wide, tall))
    FigureCanvasAgg(figure)
    width = wide / columns - left - right
    axes = []
    for row in range(rows):
        for column in range(columns):
            x = column * wide / columns + left
            y = tall - (row + 1) * (HEAD + high) - row * between
            axes.append(figure.add_axes((x / wide, y / tall, width / wide, high / tall)))
    return figure, axes


def title_panels(axes: Sequence[Axes], titles: Sequence[str]) -> None:
    """Give each panel its letter and its words."""
    for k, (ax, words) in enumerate(zip(axes, titles, strict=True)):
        ax.set_title(f"({chr(ord('a') + k)}) {words}", loc="left", fontsize=7.0, pad=3.0)


def fill_panel(ax: Axes, window: Window) -> None:
    """Show a window with equal scales, widened to the shape of the panel."""
    box = ax.get_position()
    figure = ax.get_figure(root=True)
    assert figure is not None
    ratio = box.height * figure.get_figheight() / (box.width * figure.get_figwidth())
    shown = window.shaped(ratio, ratio)
    ax.set_xlim(shown.x_min, shown.x_max)
    ax.set_ylim(shown.y_min, shown.y_max)
    ax.set_aspect("equal", adjustable="box")


def relabel(ax: Axes, general: Mapping[str, str]) -> None:
    """Give marks of one kind the same label in every panel, so that one legend serves all.

    Args:
        ax: The panel.
        general: What a label starts with, to what it is to be.
    """
    for artist in ax.get_children():
        label = str(artist.get_label())
        for start, words in general.items():
            if label.startswith(start):
                artist.set_label(words)
                break


def legend_below(figure: Figure, axes: Sequence[Axes], columns: int, names: Sequence[str] | None = None) -> None:
    """One legend for all panels at the bottom of the sheet.

    Args:
        figure: The sheet.
        axes: Whose marks it explains, each label once.
        columns: Of the legend.
        names: The labels to show, in this order; by default all.
    """
    entries = legend_entries(*axes)
    chosen = [name for name in (names or entries) if name in entries]
    figure.legend(
        [entries[name] for name in chosen], chosen, ncols=columns, loc="lower center", handler_map=LEGEND_MARKS, borderpad=0.1,
        borderaxespad=0.25, labelspacing=0.35, columnspacing=1.2, handlelength=1.8, handletextpad=0.5,
    )  # fmt: skip
