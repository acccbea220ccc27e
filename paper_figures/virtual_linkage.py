"""Fig. 3.4: virtual linkages of two feet, two feet and a hand, two feet and two hands, with the internal forces of given reactions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from socp_statics.colours import EDGE, ROUND_PART
from socp_statics.distribution import linkage_matrix
from socp_statics.distribution.virtual_linkage import members
from socp_statics.figures.axonometric import Axonometry, add_axes_of_space, seen_from
from socp_statics.figures.marks import add_arrow, add_dots, add_filled, add_line
from socp_statics.figures.panels import fill_panel, legend_below, panels, title_panels
from socp_statics.figures.robot_marks import robot_bones
from socp_statics.figures.style import BLUE, PURPLE, SOLE, VERMILLION
from socp_statics.figures.window import around
from socp_statics.report_figures import Need, stance_of
from socp_statics.spatial import Array

LEAST = {"expect": {}, "parameters.method": "least_squares"}
NEEDS = {
    "two feet in a valley": Need("chapter/noncoplanar_double_stance", LEAST),
    "two feet and a hand": Need("chapter/linkage_feet_and_hand"),
    "two feet and two hands": Need("chapter/linkage_feet_and_hands"),
}
VIEW = seen_from(np.deg2rad(-24.0), np.deg2rad(16.0))
PER_NEWTON, MEMBER = 0.12 / 30.0, 0.35
SHORT = {"left_foot": "LF", "right_foot": "RF", "left_hand": "LH", "right_hand": "RH"}
# in points from the contact, on the side where no member leaves
BESIDE = {"left_foot": (21.0, 1.0), "right_foot": (-12.0, -7.0), "left_hand": (-3.0, 8.0), "right_hand": (5.0, -5.0)}
# how far along a member its number stands, so that members that cross keep theirs apart
ALONG = {"LF-LH": 0.36, "RF-LH": 0.62, "LF-RH": 0.5, "RF-RH": 0.74}


def _internal(record: Mapping[str, Any]) -> list[tuple[str, str, float]]:
    """The members of a record: their two contacts and the internal force [N]."""
    entries = record["distribution"]["methods"]["least_squares"]["internal_forces"]
    return [(*entry["between"], entry["force"]) for entry in entries]


def draw(records: Mapping[str, Sequence[Any]]) -> Figure:
    """A panel for each set of contacts."""
    figure, axes = panels(1, 3, high=2.5, foot=0.18, left=0.05, right=0.05, between=0.02)
    for ax, name in zip(axes, NEEDS, strict=True):
        _add_linkage(ax, records[name][0])
    title_panels(axes, list(NEEDS))
    legend_below(figure, axes, 4)
    return figure


def _add_linkage(ax: Axes, record: Mapping[str, Any]) -> None:
    stance = stance_of(record)
    assert stance.posture is not None
    shown = []
    for ends in robot_bones(stance.posture):
        flat = VIEW.flat(ends)
        shown.append(flat)
        add_line(ax, flat, color=ROUND_PART, alpha=0.45, linewidth=3.0, solid_capstyle="round", zorder=1.6)
        add_dots(ax, flat[:1], "o", 3.0, markerfacecolor="white", markeredgecolor=EDGE, markeredgewidth=0.4, alpha=0.6, zorder=1.7)
    place = {c.name: c.position for c in stance.contacts}
    for contact in stance.contacts:
        corners = VIEW.flat(contact.points_W)
        shown.append(corners)
        if len(corners) > 2:
            add_filled(ax, corners, facecolor=SOLE, edgecolor="#333333", linewidth=0.7, zorder=1.4)
    for wrench in record["wrenches"]:
        tail = place[wrench["contact"]]
        force = np.array(wrench["force"])
        ends = VIEW.flat([tail, tail + PER_NEWTON * force])
        shown.append(ends)
        add_arrow(ax, *ends, color=PURPLE, linewidth=1.2, zorder=5.0, label="reaction")
    for a, b, force in _internal(record):
        _add_member(ax, VIEW, np.array([place[a], place[b]]), force, ALONG.get(f"{SHORT[a]}-{SHORT[b]}"))
    for name, position in place.items():
        flat = VIEW.flat(position)
        add_dots(ax, flat[None], "o", 3.0, markerfacecolor="#333333", markeredgecolor="#333333", zorder=4.8)
        ax.annotate(SHORT[name], flat, BESIDE[name], textcoords="offset points", fontsize=6.5, zorder=6.0, va="center",
                    ha="right" if name == "right_foot" else "left")  # fmt: skip
    corner = np.array([0.0, -0.26, 0.0])
    shown.append(add_axes_of_space(ax, VIEW, corner, [0.08] * 3, ("x", "y", "z")))
    ax.set_xticks([])
    ax.set_yticks([])
    fill_panel(ax, around(np.vstack(shown)).grown(0.03))


def _add_member(ax: Axes, view: Axonometry, ends: Array, force: float, along: float | None) -> None:
    """A virtual link, as thick as its force is large; its number on it, or below where the link is short."""
    tension = force > 0.0
    flat = view.flat(ends)
    style = {"color": BLUE, "linestyle": "-"} if tension else {"color": VERMILLION, "linestyle": (0, (3, 1.5))}
    add_line(ax, flat, linewidth=0.6 + MEMBER * abs(force) ** 0.5, zorder=4.0, label="tension" if tension else "compression", **style)
    at, below = (0.5, -7.0) if along is None else (along, 0.0)
    ax.annotate(f"{force:.1f}", flat[0] + at * (flat[1] - flat[0]), (0.0, below), textcoords="offset points", fontsize=6.0, ha="center",
                va="center", zorder=6.0, color=style["color"],
                bbox={"boxstyle": "square,pad=0.1", "facecolor": "white", "edgecolor": "none", "alpha": 0.85})  # fmt: skip


def caption(records: Mapping[str, Sequence[Any]]) -> str:
    """Members, ranks and forces."""
    parts = []
    for name in NEEDS:
        stance = stance_of(records[name][0])
        r = np.array([c.position for c in stance.contacts])
        rank = int(np.linalg.matrix_rank(linkage_matrix(r), tol=1e-9))
        words = ", ".join(f"{SHORT[a]}-{SHORT[b]} {force:.2f} N" for a, b, force in _internal(records[name][0]))
        parts.append(f"{name}: {len(members(len(r)))} member{'s' if len(r) > 2 else ''}, rank of V_L {rank}; {words}")
    return (
        "Virtual linkages of HOAP-2 and the internal forces of its least-squares reactions along them (tension positive, V_L^+ f: what the "
        f"contact forces hold beyond the least ones that carry the load). {'. '.join(parts)}. Arrows of the axes: 80 mm; reactions to one "
        "scale."
    )
