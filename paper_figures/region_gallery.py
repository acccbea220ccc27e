"""Support regions of sixteen stances with exact cones, beside four-sided pyramids and the base of support."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from socp_statics.cones.choice import KINDS
from socp_statics.figures.draw_region import add_base_of_support, add_rays, add_region
from socp_statics.figures.draw_stance import add_com_or_direction, add_contacts
from socp_statics.figures.panels import fill_panel, legend_below, panels, relabel, title_panels
from socp_statics.figures.region_shape import shape_in_record
from socp_statics.figures.window import choose_window, label_axes
from socp_statics.regions import base_of_support
from socp_statics.report_figures import Need, stance_of

STANCES = {
    "contacts/flat_double_stance": "flat floor",
    "contacts/roof_double_stance": "roof",
    "contacts/valley_double_stance": "valley",
    "contacts/staggered_pitched_feet": "pitched feet",
    "contacts/foot_and_wall_hand": "foot and wall",
    "contacts/chimney": "chimney",
    "contacts/leaning_chimney": "leaning chimney",
    "contacts/ladder": "ladder",
    "contacts/climber": "climber",
    "contacts/ceiling_brace": "ceiling brace",
    "contacts/three_points_tilted": "three tilted points",
    "contacts/pymanoid_triple_stance": "three soles",
    "quadrupeds/slope": "ANYmal, slope",
    "talos/leaning_wall": "TALOS, wall",
    "talos/stairs": "TALOS, stairs",
    "hoap2/hands_on_the_wall": "HOAP-2, two hands",
}
GENERAL = {
    "exact region": "exact",
    "inscribed": "inscribed, 4 sides",
    "circumscribed": "circumscribed, 4 sides",
    "base of support": "base of support",
    "CoM ": "_nolegend_",
}
LEGEND = (
    "exact",
    "circumscribed, 4 sides",
    "inscribed, 4 sides",
    "base of support",
    "contact",
    "handle",
    "contact normal",
    "CoM",
    "the region has no end",
)


def _values(kind: str) -> dict[str, Any]:
    pyramid = {} if kind == "exact" else {"parameters.sides": 4}
    return {"model": "support_region", "parameters": {}, "expect": {}, "parameters.cone": kind} | pyramid


NEEDS = {f"{name} {kind}": Need(name, _values(kind)) for name in STANCES for kind in KINDS}


def draw(records: Mapping[str, Sequence[Any]]) -> Figure:
    """A panel for each stance."""
    figure, axes = panels(4, 4, high=1.25, foot=0.24)
    for ax, name in zip(axes, STANCES, strict=True):
        _add_stance(ax, {kind: records[f"{name} {kind}"][0] for kind in KINDS})
    title_panels(axes, list(STANCES.values()))
    for k, ax in enumerate(axes):
        ax.set_xlabel("x [m]" if k >= 12 else "", labelpad=1.0)
        ax.set_ylabel("y [m]" if k % 4 == 0 else "", labelpad=1.0)
    legend_below(figure, axes, 5, LEGEND)
    return figure


def _add_stance(ax: Any, records: Mapping[str, Any]) -> None:
    stance = stance_of(records["exact"])
    shapes = {kind: shape_in_record(record) for kind, record in records.items()}
    drawn = {kind: shape for kind, shape in shapes.items() if shape is not None and len(shape.inner)}
    bounded = [shape.inner for shape in drawn.values() if shape.kind != "unbounded"]
    endless = [shape.inner for shape in drawn.values() if shape.kind == "unbounded"]
    window = choose_window(stance.contacts.points_W[:, :2], np.array([stance.com[:2]]), bounded, endless)
    for kind in ("exact", "circumscribed", "inscribed"):
        if kind in drawn:
            add_region(ax, drawn[kind], filled=kind == "exact")
    base = base_of_support(stance.contacts)
    add_base_of_support(ax, base)
    add_contacts(ax, stance.contacts, window)
    if "exact" in drawn:
        add_rays(ax, drawn["exact"], window)
    add_com_or_direction(ax, stance.com[:2], window)
    label_axes(ax)
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_locator(MaxNLocator(4, steps=[1, 2, 5, 10]))
    fill_panel(ax, window)
    relabel(ax, GENERAL)


def caption(records: Mapping[str, Sequence[Any]]) -> str:
    """How much the pyramids miss and add."""
    losses, gains, empty = [], [], []
    for name, words in STANCES.items():
        inner, exact, outer = (records[f"{name} {kind}"][0]["region"] for kind in ("inscribed", "exact", "circumscribed"))
        if exact["kind"] == "polygon" and inner["kind"] == "empty":
            empty.append(words)
        if exact["kind"] == inner["kind"] == outer["kind"] == "polygon":
            losses.append(round(100.0 * (1.0 - inner["inner_area"] / exact["inner_area"]), 1))
            gains.append(round(100.0 * (outer["inner_area"] / exact["inner_area"] - 1.0), 1))
    return (
        f"Support regions of {len(STANCES)} stances (gap at most 1e-3) with exact friction cones and with four-sided pyramids of "
        f"heading 0. Inscribed pyramids lose {abs(min(losses)):.0f} to {max(losses):.0f} % of the area (median {np.median(losses):.1f} %)"
        f"{f' and all of it for {chr(44).join(empty)}' if empty else ''}, circumscribed ones add {abs(min(gains)):.0f} to "
        f"{max(gains):.0f} % (median {np.median(gains):.1f} %) that no exact force attains. Away from "
        "level floors the region is not the base of support."
    )
