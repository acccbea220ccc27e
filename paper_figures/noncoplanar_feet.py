"""Fig. 3.7: feet on the sides of a valley, the reactions without internal force and with the one that needs the least friction."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from socp_statics.colours import EDGE, GROUND
from socp_statics.contacts import ContactSet
from socp_statics.figures.draw_robot import Pushes, add_robot
from socp_statics.figures.marks import add_arrow, add_filled, add_line
from socp_statics.figures.outlines import VIEWS
from socp_statics.figures.panels import fill_panel, legend_below, panels, title_panels
from socp_statics.figures.style import GREEN, ORANGE, PURPLE, VERMILLION
from socp_statics.figures.window import Window
from socp_statics.report_figures import Need, stance_of
from socp_statics.spatial import Array

NEEDS = {
    "without": Need("chapter/noncoplanar_zero_internal_force"),
    "with": Need("chapter/noncoplanar_optimal_internal_force"),
}
FEET = ("right_foot", "left_foot")
REACH = 0.12
SHOWN = Window(-0.125, 0.125, -0.045, 0.16)


def _wrenches(record: Mapping[str, Any]) -> dict[str, Array]:
    """Force of each foot, shape (3,) [N]: of the distribution, or of the optimum."""
    methods = record.get("distribution", {}).get("methods", {})
    entries = methods["pseudoinverse"]["wrenches"] if methods else record["wrenches"]
    return {entry["contact"]: np.array(entry["force"]) for entry in entries}


def _needed(record: Mapping[str, Any]) -> float:
    """The least friction coefficient that holds both resultants."""
    contacts, forces = stance_of(record).contacts, _wrenches(record)
    parts = [contacts[name].rotation.T @ force for name, force in forces.items()]
    return max(float(np.linalg.norm(f[:2]) / f[2]) for f in parts)


def draw(records: Mapping[str, Sequence[Any]]) -> Figure:
    """The legs of the robot from the front, with friction cones about the middle of the soles."""
    figure, axes = panels(1, 2, high=2.5, foot=0.2, left=0.46, between=0.32)
    for ax, key in zip(axes, NEEDS, strict=True):
        _add_legs(ax, records[key][0])
    title_panels(axes, ("no internal force: vertical reactions slip", "least friction: reactions along the normals"))
    legend_below(figure, axes, 4, ("friction cone", "slips", "holds", "parts along plane and normal"))
    return figure


def _add_legs(ax: Axes, record: Mapping[str, Any]) -> None:
    stance = stance_of(record)
    assert stance.posture is not None
    add_robot(ax, stance.posture, VIEWS["front"], Pushes([], [], []), cones=False, named=False)
    _add_valley(ax, stance.contacts)
    forces = _wrenches(record)
    scale = REACH / 32.0
    for name in FEET:
        contact, force = stance.contacts[name], forces[name]
        slope = np.hypot(1.0, contact.friction)
        n, t = contact.rotation[:, 2], contact.rotation[:, 1]
        rim = [contact.position + REACH * (n + s * contact.friction * t) / slope for s in (-1.0, 1.0)]
        cone = np.array([contact.position, *rim])[:, 1:]
        add_filled(ax, cone, facecolor=ORANGE, alpha=0.3, edgecolor=ORANGE, linewidth=0.8, zorder=4.0, label="friction cone")
        tail = contact.position[1:]
        f_n, f_t = float(n @ force), force - (n @ force) * n
        holds = np.linalg.norm(f_t) <= contact.friction * f_n
        if np.linalg.norm(f_t) > 1e-3 * f_n:
            for part in (f_n * n, f_t):
                add_arrow(ax, tail, tail + scale * part[1:], color=PURPLE, linewidth=0.9, head_size=5.0, zorder=5.0,
                          label="parts along plane and normal")  # fmt: skip
            add_line(ax, np.array([tail + scale * f_n * n[1:], tail + scale * force[1:], tail + scale * f_t[1:]]), color=PURPLE,
                     linewidth=0.5, linestyle=(0, (2, 2)), zorder=4.9)  # fmt: skip
        add_arrow(ax, tail, tail + scale * force[1:], color=GREEN if holds else VERMILLION, linewidth=1.8, head_size=7.0, zorder=5.5,
                  label="holds" if holds else "slips")  # fmt: skip
    ax.set_xlabel("y [m]", labelpad=1.0)
    ax.set_ylabel("z [m]", labelpad=1.0)
    fill_panel(ax, SHOWN)


def _add_valley(ax: Axes, contacts: ContactSet) -> None:
    """Both planes down to the line where they meet, instead of short pieces that cross there."""
    (ry, rz), (ly, lz) = (contacts[name].position[1:] for name in FEET)
    right, left = (-contacts[name].rotation[1, 2] / contacts[name].rotation[2, 2] for name in FEET)
    meet = (rz - lz - right * ry + left * ly) / (left - right)
    line = np.array([[ry - 1.0, rz - right], [meet, rz + right * (meet - ry)], [ly + 1.0, lz + left]])
    add_filled(ax, np.vstack([line, [[ly + 1.0, -1.0], [ry - 1.0, -1.0]]]), facecolor=GROUND, edgecolor="none", zorder=1.45)
    add_line(ax, line, color=EDGE, linewidth=0.8, zorder=1.46)


def caption(records: Mapping[str, Sequence[Any]]) -> str:
    """The friction each needs."""
    without, best = records["without"][0], records["with"][0]
    tilt = np.degrees(np.arccos(stance_of(without).contacts["left_foot"].rotation[2, 2]))
    mu = stance_of(without).contacts["left_foot"].friction
    across = abs(_wrenches(best)["left_foot"][1])
    return (
        f"HOAP-2 with its feet on the sides of a valley, {tilt:.0f} deg each, friction {mu:.2f}. (a) The pseudoinverse has no internal "
        f"force: its reactions of {np.linalg.norm(_wrenches(without)['left_foot']):.2f} N are vertical, need the friction "
        f"{_needed(without):.3f} (tan {tilt:.0f} deg = {np.tan(np.radians(tilt)):.3f}) and leave the friction cones. (b) An internal force "
        f"of {across:.2f} N (tension) turns them along the normals: {np.linalg.norm(_wrenches(best)['left_foot']):.2f} N each, friction "
        f"needed {_needed(best):.3f}. Cones have the true angle."
    )
