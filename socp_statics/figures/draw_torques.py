"""Torque use: a bar a joint, the share of its limit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator

from socp_statics.figures.layout import Bars, arrange, new_axes, sheet_of
from socp_statics.figures.marks import add_dots, add_line
from socp_statics.figures.place_names import text_width
from socp_statics.figures.style import BLACK, BLUE, GREY, ORANGE, SOLE, VERMILLION, house_style
from socp_statics.figures.torque_use import JointTorque, torque_uses

PITCH, TICK_ROW = 0.118, 0.31
HIGH, FULL, FARTHEST = 0.8, 0.999, 3.0
TICKS_NEAR, TICKS_FAR = (-1.5, -1.0, -0.5, 0.0, 0.5, 1.0, 1.5), (-3.0, -1.0, 0.0, 1.0, 3.0)
ORDINARY, NEAR, REACHED, FREE = "torque", "from 80 % of the limit", "at or over the limit", "torque without a limit"
COLOURS = {ORDINARY: BLUE, NEAR: ORANGE, REACHED: VERMILLION, FREE: SOLE}
MINUS = "\N{MINUS SIGN}"


def draw_torques(torques: Mapping[str, Any], ax: Axes | None = None, *, torque_limits: Mapping[str, Any] | None = None) -> Axes:
    """Draw joint torques as shares of their limits: ``tau / upper`` to the right, ``tau / lower`` to the left.

    Joints without a limit on the side of their torque have no share: their thin grey bars stand below the others, on a scale in N m.
    At the right are the torques in numbers, with the limit where there is one. What is beyond 300 % is cut off and has an arrowhead.

    Args:
        torques: A record or other mapping with "torques" and "torque_limits"; or joint name to torque [N m].
        ax: Axes to draw into; by default those of a new figure of one column with a legend.
        torque_limits: Joint name to (lower, upper) [N m]; those of the record by default.

    Returns:
        The axes of the shares; those of the joints without a limit are their twin.

    Raises:
        InputError: There are no torques, or a torque or limit is not what is expected.
    """
    uses = torque_uses(torques, torque_limits)
    with house_style():
        own = new_axes() if ax is None else ax
        bars = add_torques(own, uses)
        if ax is None:
            arrange(sheet_of(own), [bars])
    return own


def add_torques(ax: Axes, uses: Sequence[JointTorque]) -> Bars:
    """Add the bars to axes that have nothing else in them; returns the room they take on a sheet."""
    limited = [use for use in uses if use.limited]
    free = [use for use in uses if not use.limited]
    rows = [*limited, *free]
    axes: tuple[Axes, ...] = (ax,)
    ax.set_ylim(len(rows) - 0.4, -0.6)
    if limited:
        _add_shares(ax, limited)
    if limited and free:
        other = ax.twiny()
        axes = (ax, other)
        add_line(ax, np.array([[0.0, len(limited) - 0.5], [1.0, len(limited) - 0.5]]), color=GREY, linewidth=0.6, zorder=3.0,
                 transform=ax.get_yaxis_transform())  # fmt: skip
        ax.xaxis.set_ticks_position("top")
        ax.xaxis.set_label_position("top")
        other.xaxis.set_ticks_position("bottom")
        other.xaxis.set_label_position("bottom")
        _add_newton_metres(other, free, len(limited), "torque of joints without a limit [N m]", FREE)
    elif free:
        _add_newton_metres(ax, free, 0, "joint torque [N m]", None)
    for one in axes:
        one.xaxis.labelpad = 2.0
        one.tick_params(axis="y", length=0.0)
    ax.set_yticks(range(len(rows)), [use.joint for use in rows])
    numbers = _numbers(rows)
    beside = ax.get_yaxis_transform()
    for k, words in enumerate(numbers):
        ax.annotate(words, (1.0, k), (4.0, 0.0), xycoords=beside, textcoords="offset points", va="center", fontsize=7.0,
                    annotation_clip=False)  # fmt: skip
    ax.annotate("[N m]", (1.0, 1.0), (4.0, 3.0), xycoords="axes fraction", textcoords="offset points", va="bottom", fontsize=7.0,
                annotation_clip=False)  # fmt: skip
    left, right = (max(map(text_width, words)) / 72.0 for words in ([use.joint for use in rows], numbers))
    return Bars(axes, PITCH * (len(rows) + 0.2), left + 0.12, right + 0.12, TICK_ROW if len(axes) > 1 else 0.15)


def _add_shares(ax: Axes, uses: Sequence[JointTorque]) -> None:
    """Bars from zero to the share, to the left where the torque is negative, and the lines of 100 %."""
    signed = [float(np.copysign(use.share or 0.0, use.torque)) for use in uses]
    most = max(np.abs(signed).max(), 1.0)
    edge = 1.12 * min(most, FARTHEST)
    ax.set_xlim(-edge, edge)
    for sign in (-1.0, 1.0):
        line = np.array([[sign, -0.6], [sign, len(uses) - 0.5]])
        add_line(ax, line, color=VERMILLION, linewidth=0.9, linestyle=(0, (4, 2)), zorder=2.5, label="torque limit" if sign > 0 else None)
    kinds = [REACHED if size >= FULL else NEAR if size >= HIGH else ORDINARY for size in np.abs(signed)]
    for kind in (ORDINARY, NEAR, REACHED):
        label: str | None = kind
        for k, share in enumerate(signed):
            if kinds[k] == kind:
                length = share if np.isfinite(share) else float(np.copysign(2.0 * edge, share))
                _add_bar(ax, k, length, 0.62, label, facecolor=COLOURS[kind], edgecolor="none", zorder=2.0)
                label = None
    for k, share in enumerate(signed):
        if abs(share) > edge:
            head = {"markerfacecolor": "white", "markeredgecolor": "none", "zorder": 2.2}
            add_dots(ax, np.array([0.955 * np.copysign(edge, share), k]), ">" if share > 0 else "<", 4.5, **head)
    _add_zero(ax, 0, len(uses) - 1)
    ax.xaxis.set_major_locator(FixedLocator(TICKS_NEAR if edge < 1.7 else TICKS_FAR))
    ax.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{100 * x:.0f}".replace("-", MINUS)))
    ax.set_xlabel("share of its torque limit [%]")


def _add_newton_metres(ax: Axes, uses: Sequence[JointTorque], first: int, words: str, label: str | None) -> None:
    """Thin bars in newton metres."""
    most = max(abs(use.torque) for use in uses)
    edge = 1.12 * most if most > 0.0 else 1.0
    ax.set_xlim(-edge, edge)
    for k, use in enumerate(uses):
        _add_bar(ax, first + k, use.torque, 0.34, None if k else label, facecolor=COLOURS[FREE], edgecolor=GREY, linewidth=0.6, zorder=2.0)
    _add_zero(ax, first, first + len(uses) - 1)
    ax.xaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10], symmetric=True))
    ax.set_xlabel(words)


def _add_bar(ax: Axes, row: int, length: float, height: float, label: str | None, **style: Any) -> None:
    ax.add_artist(Rectangle((0.0, row - 0.5 * height), length, height, label=label, **style))


def _add_zero(ax: Axes, first: float, last: float) -> None:
    add_line(ax, np.array([[0.0, first - 0.6], [0.0, last + 0.6]]), color=BLACK, linewidth=0.7, zorder=3.0)


def _numbers(uses: Sequence[JointTorque]) -> list[str]:
    """Torques with the limits on their sides, "1.45 of 4", all with as many decimals as give the largest three digits."""
    most = max(abs(use.torque) for use in uses)
    decimals = int(np.clip(2 - np.floor(np.log10(most)), 0, 6)) if most > 1e-6 else 2
    words = []
    for use in uses:
        # adding zero takes the sign from a rounded minus zero
        torque = f"{round(use.torque, decimals) + 0.0:.{decimals}f}"
        words.append((f"{torque} of {use.limit:.4g}" if use.limited else torque).replace("-", MINUS))
    return words
