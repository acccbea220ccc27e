"""How far the centre of mass goes while the posture follows it, beside the region of the frozen posture."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from socp_statics.figures.draw_following import add_following, following_in_record
from socp_statics.figures.draw_region import add_base_of_support, add_region
from socp_statics.figures.draw_stance import add_contacts
from socp_statics.figures.marks import add_com
from socp_statics.figures.panels import fill_panel, legend_below, panels, relabel, title_panels
from socp_statics.figures.region_shape import shape_in_record
from socp_statics.figures.window import choose_window, label_axes
from socp_statics.regions import base_of_support
from socp_statics.report_figures import Need, stance_of

NEEDS = {"weak": Need("hoap2/following_half_squat_2"), "standing": Need("hoap2/following_standing")}
GENERAL = {
    "torque-limited region": "frozen posture",
    "exact region": "frozen posture",
    "the posture follows": "the posture follows",
    "base": "base of support",
    "stopped by contacts": "stopped by contacts and load",
    "stopped by a torque": "by a torque limit",
    "stopped by a joint": "by a joint limit",
}


def draw(records: Mapping[str, Sequence[Any]]) -> Figure:
    """A panel for each posture."""
    figure, axes = panels(1, 2, high=2.6, foot=0.34, left=0.54)
    for ax, key in zip(axes, NEEDS, strict=True):
        record = records[key][0]
        stance, shape, star = stance_of(record), shape_in_record(record), following_in_record(record)
        assert shape is not None and star is not None
        window = choose_window(stance.contacts.points_W[:, :2], np.array([stance.com[:2]]), [shape.inner, star.ends], [])
        add_region(ax, shape, filled=True)
        add_base_of_support(ax, base_of_support(stance.contacts))
        add_following(ax, star)
        add_contacts(ax, stance.contacts, window)
        add_com(ax, stance.com[:2])
        label_axes(ax)
        fill_panel(ax, window)
        relabel(ax, GENERAL)
    title_panels(axes, ("HOAP-2, half squat, leg joints 2 N m", "HOAP-2, standing"))
    legend_below(figure, axes, 5)
    return figure


def caption(records: Mapping[str, Sequence[Any]]) -> str:
    """Areas and what stops the rays."""
    parts = []
    for key, words in (("weak", "in a half squat with leg joints of 2 N m"), ("standing", "standing")):
        record = records[key][0]
        star = following_in_record(record)
        assert star is not None
        stops = ", ".join(f"{star.reasons.count(reason)} by {reason}" for reason in dict.fromkeys(star.reasons))
        parts.append(
            f"{words} the frozen posture has {1e4 * record['region']['inner_area']:.1f} cm^2, the {len(star.ends)} rays of the posture "
            f"that follows span {1e4 * star.area:.1f} cm^2 ({stops})"
        )
    return (
        "Support region of the frozen posture beside the ends of horizontal rays along which HOAP-2 follows its centre of mass: "
        f"{'; '.join(parts)}."
    )
