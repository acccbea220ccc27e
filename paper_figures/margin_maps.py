"""Two margins over the floor: the normal-force reserve and the distance to the edge of the support region."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.colors import TwoSlopeNorm
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from socp_statics.colours import SOLE_LINE
from socp_statics.figures.draw_region import add_base_of_support
from socp_statics.figures.marks import add_line
from socp_statics.figures.panels import panels, title_panels
from socp_statics.figures.region_shape import shape_in_record
from socp_statics.figures.style import BLACK
from socp_statics.figures.window import Window, label_axes
from socp_statics.regions import base_of_support
from socp_statics.regions.polygon import distance
from socp_statics.report_figures import Need, stance_of
from socp_statics.spatial import Array

NEEDS = {
    "map": Need("maps/foot_and_wall_hand"),
    "region": Need("contacts/foot_and_wall_hand", {"model": "support_region", "expect": {}}),
}
FINE = 201


def _grid(records: Sequence[Any]) -> tuple[Array, Array, Array]:
    """Positions along x and y [m], and the margin at each, shape (len(y), len(x)) [N]."""
    coms = np.array([record["case"]["generated"]["com"] for record in records])
    x, y = np.unique(coms[:, 0]), np.unique(coms[:, 1])
    values = np.full((len(y), len(x)), np.nan)
    for com, record in zip(coms, records, strict=True):
        values[np.searchsorted(y, com[1]), np.searchsorted(x, com[0])] = record["margin"]
    return x, y, values


def draw(records: Mapping[str, Sequence[Any]]) -> Figure:
    """Both maps to one scale, the edge of the region on both."""
    figure, axes = panels(1, 2, high=1.3, foot=0.0, left=0.5, right=0.62)
    x, y, reserve = _grid(records["map"])
    shape, stance = shape_in_record(records["region"][0]), stance_of(records["region"][0])
    assert shape is not None
    fine_x, fine_y = np.linspace(x[0], x[-1], FINE), np.linspace(y[0], y[-1], FINE)
    points = np.stack(np.meshgrid(fine_x, fine_y), axis=-1)
    com_margin = 1e3 * np.asarray(distance(shape.inner, points.reshape(-1, 2))).reshape(FINE, FINE)
    maps = ((x, y, reserve, "normal-force reserve [N]"), (fine_x, fine_y, com_margin, "CoM margin [mm]"))
    window = Window(float(x[0]), float(x[-1]), float(y[0]), float(y[-1]))
    for ax, (along, across, values, words) in zip(axes, maps, strict=True):
        norm = TwoSlopeNorm(0.0, float(values.min()), float(values.max()))
        levels = MaxNLocator(18, steps=[1, 2, 5, 10]).tick_values(values.min(), values.max())
        filled = ax.contourf(along, across, values, levels=levels, norm=norm, cmap="RdBu")
        add_line(ax, shape.inner, closed=True, color=BLACK, linewidth=1.2, zorder=4.0)
        add_base_of_support(ax, base_of_support(stance.contacts))
        for contact in stance.contacts:
            add_line(ax, contact.points_W[:, :2], closed=True, color=SOLE_LINE, linewidth=0.8, marker="o", markersize=2.0, zorder=3.8)
        label_axes(ax)
        ax.set_xlim(window.x_min, window.x_max)
        ax.set_ylim(window.y_min, window.y_max)
        ax.set_aspect("equal", adjustable="box")
        place = ax.get_position(original=False)
        bar = figure.add_axes((place.x1 + 0.008, place.y0, 0.012, place.height))
        figure.colorbar(filled, cax=bar, ticks=levels[levels % (2 * (levels[1] - levels[0])) == 0])
        bar.set_ylabel(words, labelpad=2.5)
    title_panels(axes, ("how much every contact can lose", "how far the CoM is from the edge"))
    return figure


def caption(records: Mapping[str, Sequence[Any]]) -> str:
    """The largest of both, and where."""
    reserve = _grid(records["map"])[2]
    shape = shape_in_record(records["region"][0])
    assert shape is not None
    agree = sum(
        (float(distance(shape.inner, np.array(r["case"]["generated"]["com"][:2]))) > 0.0) == (r["margin"] > 0.0) for r in records["map"]
    )
    return (
        f"One foot and one hand against a wall (friction 0.4, 60 kg), CoM at 0.9 m over {reserve.size} positions: (a) normal-force "
        f"reserve, at most {reserve.max():.1f} N on this grid; (b) CoM margin. Blue: stable. "
        f"Black: edge of the exact support region ({1e4 * shape.area:.1f} cm^2), on which both vanish; they agree in sign at {agree} of "
        f"{len(records['map'])} positions. Dotted: base of support."
    )
