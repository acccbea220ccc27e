"""Torque-limited support regions of a frozen posture, nested by the limit of its leg joints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.figure import Figure

from socp_statics.figures.draw_region import add_base_of_support
from socp_statics.figures.draw_robot import Pushes, add_robot
from socp_statics.figures.draw_stance import add_contacts
from socp_statics.figures.marks import add_com, add_line
from socp_statics.figures.outlines import VIEWS
from socp_statics.figures.panels import fill_panel, legend_below, panels, title_panels
from socp_statics.figures.region_shape import shape_in_record
from socp_statics.figures.window import choose_window, label_axes
from socp_statics.regions import base_of_support
from socp_statics.report_figures import Need, stance_of

NEEDS = {"sweep": Need("hoap2/half_squat_sweep")}
JOINT = "LLEG_JOINT4"


def _limit(record: Mapping[str, Any]) -> float:
    return float(record["torque_limits"][JOINT][1])


def draw(records: Mapping[str, Sequence[Any]]) -> Figure:
    """The robot, and its regions from the strongest to the weakest legs."""
    figure, (side, plan) = panels(1, 2, high=2.35, foot=0.36, left=0.54)
    stance = stance_of(records["sweep"][0])
    assert stance.posture is not None
    window = add_robot(side, stance.posture, VIEWS["side"], Pushes([], [], []), named=False)
    label_axes(side, ("x [m]", "z [m]"))
    fill_panel(side, window)
    contacts = stance.contacts
    view = choose_window(contacts.points_W[:, :2], np.array([stance.com[:2]]), [], [])
    add_contacts(plan, contacts, view)
    add_base_of_support(plan, base_of_support(contacts))
    shades = colormaps["viridis_r"](np.linspace(0.05, 0.95, len(records["sweep"])))
    for record, shade in zip(records["sweep"], shades, strict=True):
        shape = shape_in_record(record)
        assert shape is not None
        words = f"{_limit(record):g} N m"
        add_line(plan, shape.outer, closed=True, color=shade, linewidth=1.3, zorder=3.0, label=words)
    add_com(plan, stance.com[:2])
    label_axes(plan)
    fill_panel(plan, view)
    legend_below(figure, [plan], 6)
    title_panels((side, plan), ("HOAP-2, half squat", "regions by the limit of the leg joints [N m]"))
    return figure


def caption(records: Mapping[str, Sequence[Any]]) -> str:
    """The areas."""
    areas = ", ".join(f"{1e4 * r['region']['inner_area']:.1f} cm^2 at {_limit(r):g} N m" for r in records["sweep"])
    base = 1e4 * base_of_support(stance_of(records["sweep"][0]).contacts).area
    return (
        f"Torque-limited support regions of HOAP-2 in a half squat (frozen posture, exact cones): {areas}; the base of support has "
        f"{base:.1f} cm^2. The limits are those of all leg joints."
    )
