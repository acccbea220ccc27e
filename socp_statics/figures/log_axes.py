"""Logarithmic axes: plain numbers also within one decade, a place for what is too small to have one."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FixedLocator, FuncFormatter, LogLocator, MaxNLocator, NullFormatter, NullLocator

from socp_statics.figures.style import GREY
from socp_statics.spatial import Array


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


def plain_ticks(ax: Axes, text: Callable[[float], str] = "{:g}".format) -> None:
    """Ticks of a logarithmic vertical axis whose limits are final: powers of ten, or round numbers where it spans less than a decade.

    Args:
        ax: The axes.
        text: What a tick says of its value.
    """
    low, high = ax.get_ylim()
    ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: text(value)))
    ax.yaxis.set_minor_formatter(NullFormatter())
    if high < 10.0 * low:
        ticks = MaxNLocator(5, steps=[1, 2, 2.5, 5, 10]).tick_values(low, high)
        ax.yaxis.set_major_locator(FixedLocator([tick for tick in ticks if low <= tick <= high]))
        ax.yaxis.set_minor_locator(NullLocator())


def percent(share: float) -> str:
    """A share in per cent."""
    return f"{100.0 * share:g} %"


class LogPercent:
    """A logarithmic axis of shares with a place below its least value for everything less, zero too.

    Args:
        least: The least share that has its own place.
        most: The upper end of the axis.
    """

    def __init__(self, least: float, most: float):
        self.least, self.most, self.less = least, most, least / 3.0

    def place(self, shares: Array) -> Array:
        """Where shares are drawn: at their value, at the place of everything less, or beyond the upper end."""
        return np.where(np.isfinite(shares), np.where(shares < self.least, self.less, shares), 1e3 * self.most)

    def set(self, ax: Axes) -> None:
        """Scale, limits and ticks of a vertical axis."""
        ax.set_yscale("log")
        ax.set_ylim(self.less / 2.0, self.most)
        ax.axhline(self.least, color=GREY, linewidth=0.5, linestyle=(0, (1.0, 2.0)), zorder=0.5)
        decades = np.arange(round(math.log10(self.least)), round(math.log10(self.most)) + 1)
        ax.yaxis.set_major_locator(FixedLocator([self.less, *(10.0**decades)]))
        ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: "less" if value < self.least * (1.0 - 1e-9) else percent(value)))
        minor = LogLocator(subs=range(2, 10)).tick_values(self.least, self.most)
        ax.yaxis.set_minor_locator(FixedLocator([tick for tick in minor if tick > self.least]))
        ax.yaxis.set_minor_formatter(NullFormatter())
