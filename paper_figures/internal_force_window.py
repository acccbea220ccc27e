"""The internal-force window for two null directions: squeeze and twist of two feet in a valley that cones and motors allow together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.figure import Figure

from socp_statics.figures.draw_window import window_in_record
from socp_statics.figures.marks import add_dots, add_filled, add_line
from socp_statics.figures.panels import legend_below, panels
from socp_statics.figures.style import COLUMN, GREY, VERMILLION
from socp_statics.regions.polygon import area
from socp_statics.report_figures import Need
from socp_statics.spatial import Array

FRICTION = (0.3, 0.4, 0.5, 0.6)
FREE = 0.4
NAME = "chapter/internal_force_set"
NEEDS = {f"{mu:g}": Need(NAME, {"posture.friction": mu, "expect": {}}) for mu in FRICTION} | {
    "no limits": Need(NAME, {"posture.friction": FREE, "parameters.torque_limits": False, "expect": {}})
}


def _corners(record: Mapping[str, Any]) -> Array:
    """Attained squeeze [N] and twist [N m], shape (k, 2)."""
    shape = window_in_record(record)
    assert shape is not None
    return shape.inner


def _limit(record: Mapping[str, Any]) -> float:
    """Torque limit of the leg joints [N m]."""
    return float(record["torque_limits"]["LLEG_JOINT2"][1])


def draw(records: Mapping[str, Sequence[Any]]) -> Figure:
    """Sets of four friction coefficients, and one without torque limits."""
    figure, (ax,) = panels(1, 1, wide=COLUMN, high=2.2, foot=0.36, left=0.48)
    for mu, shade in zip(FRICTION, colormaps["viridis_r"](np.linspace(0.1, 0.95, len(FRICTION))), strict=True):
        corners = _corners(records[f"{mu:g}"][0])
        add_filled(ax, corners, facecolor=shade, alpha=0.12, edgecolor="none", zorder=2.0)
        add_line(ax, corners, closed=True, color=shade, linewidth=1.2, zorder=3.0, label=f"friction {mu:g}")
    free = _corners(records["no limits"][0])
    add_line(ax, free, closed=True, color=GREY, linewidth=1.0, linestyle=(0, (3, 2)), zorder=3.5, label=f"friction {FREE:g}, strong motors")
    look = {"markerfacecolor": VERMILLION, "markeredgecolor": VERMILLION, "zorder": 5.0}
    add_dots(ax, np.zeros((1, 2)), "o", 4.0, label="no internal force", **look)
    everything = np.vstack([free, *(_corners(records[f"{mu:g}"][0]) for mu in FRICTION)])
    room = 0.06 * np.ptp(everything, axis=0)
    (x_min, y_min), (x_max, y_max) = everything.min(axis=0) - room, everything.max(axis=0) + room
    ax.set_xlim(x_min, x_max)
    ax.set_ylim(y_min, y_max)
    ax.axhline(0.0, color=GREY, linewidth=0.4, zorder=1.0)
    ax.axvline(0.0, color=GREY, linewidth=0.4, zorder=1.0)
    ax.set_xlabel("internal force of the feet, tension positive [N]", labelpad=1.0)
    ax.set_ylabel("twist of the feet about y [N m]", labelpad=1.0)
    legend_below(figure, [ax], 3)
    return figure


def caption(records: Mapping[str, Sequence[Any]]) -> str:
    """Sizes and ends."""
    words = []
    for mu in FRICTION:
        window = records[f"{mu:g}"][0]["window"]
        words.append(
            f"{mu:g}: {window['lower']['value']:.2f} to {window['upper']['value']:.2f} N without twist, area "
            f"{area(_corners(records[f'{mu:g}'][0])):.2f} N x N m"
        )
    first = records[f"{FRICTION[0]:g}"][0]
    return (
        "Internal forces of HOAP-2 with its feet on the sides of a valley (15 deg) that exact friction cones and leg joints of "
        f"{_limit(first):g} N m allow: feasible set of the force between the feet and of a moment about y that one foot holds against the "
        f"other. By friction {'; '.join(words)}. Dashed: friction {FREE:g} without torque limits, area "
        f"{area(_corners(records['no limits'][0])):.2f} N x N m."
    )
