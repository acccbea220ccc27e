"""Fig. 3.5: internal force of a five-link double stance through fifth-order splines, the joint torques and ground reactions it causes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from socp_statics.figures.draw_robot import Pushes, add_robot
from socp_statics.figures.marks import add_line
from socp_statics.figures.outlines import VIEWS
from socp_statics.figures.panels import fill_panel, panels, title_panels
from socp_statics.figures.style import BLACK, BLUE, GREY, VERMILLION
from socp_statics.report_figures import Need, stance_of
from socp_statics.spatial import Array

NEEDS = {"sweep": Need("chapter/five_link_sweep")}
STEP = 0.1
NAMED_AT = 10
DASHED = (0, (4, 2))
# joint: its name, the height of the name over the curve at 1 s in points, colour, dashes
JOINTS = {
    "RLEG_JOINT2": ("right hip", -10.0, BLUE, DASHED),
    "RLEG_JOINT6": ("right ankle", 6.0, BLUE, "-"),
    "LLEG_JOINT6": ("left ankle", -7.0, VERMILLION, "-"),
    "LLEG_JOINT2": ("left hip", 10.0, VERMILLION, DASHED),
}


def _found(record: Mapping[str, Any]) -> Mapping[str, Any]:
    found: Mapping[str, Any] = record["distribution"]["methods"]["barycentric"]
    return found


def _internal(records: Sequence[Any]) -> Array:
    return np.array([_found(record)["internal_forces"][0]["force"] for record in records])


def _torque(records: Sequence[Any], joint: str) -> Array:
    return np.array([_found(record)["torques"][joint] for record in records])


def _reaction(records: Sequence[Any], foot: str) -> Array:
    """Force of a foot, shape (n, 3) [N]."""
    return np.array([next(w["force"] for w in _found(record)["wrenches"] if w["contact"] == foot) for record in records])


def draw(records: Mapping[str, Sequence[Any]]) -> Figure:
    """The robot, its internal force, torques, reactions and use of friction over time."""
    sweep = records["sweep"]
    figure, axes = panels(2, 3, high=1.25, foot=0.0, left=0.42, right=0.06)
    robot, internal, torques, below, reactions, friction = axes
    low, high = below.get_position(), robot.get_position()
    robot.set_position((low.x0, low.y0, low.width, high.y1 - low.y0))
    below.remove()
    _add_robot(robot, sweep)
    _over_time(internal, "internal force [N]", [(_internal(sweep), "", 0.0, BLACK, "-")])
    _over_time(torques, "joint torque [N m]", [(_torque(sweep, joint), *look) for joint, look in JOINTS.items()])
    right, left = (_reaction(sweep, foot) for foot in ("right_foot", "left_foot"))
    forces = [(right[:, 1], "right foot, y", -6.0, BLUE, "-"), (left[:, 1], "left foot, y", 6.0, VERMILLION, "-"),
              (right[:, 2], "each foot, z", -7.0, BLACK, DASHED)]  # fmt: skip
    _over_time(reactions, "ground reaction [N]", forces)
    _over_time(friction, "friction used, of 1", [(_use(sweep), "", 0.0, BLACK, "-")])
    friction.set_ylim(0.0, 1.0)
    mu = stance_of(sweep[0]).contacts["right_foot"].friction
    words = ("HOAP-2, legs apart by 5 deg", "internal force of the feet", "hips and ankles, roll", "reactions of the floor",
             f"use of friction {mu:g}")  # fmt: skip
    title_panels((robot, internal, torques, reactions, friction), words)
    return figure


def _use(records: Sequence[Any]) -> Array:
    return np.array([max(_found(record)["friction_use"].values()) for record in records])


def _add_robot(ax: Axes, sweep: Sequence[Any]) -> None:
    """The legs where the feet are pressed apart most."""
    strongest = sweep[int(np.argmin(_internal(sweep)))]
    posture = stance_of(strongest).posture
    assert posture is not None
    places = {c.name: c.position for c in posture.contacts}
    forces = [{"point": places[w["contact"]], "force": w["force"]} for w in _found(strongest)["wrenches"]]
    window = add_robot(ax, posture, VIEWS["front"], Pushes(forces, [], []), named=False)
    ax.set_xlabel("y [m]", labelpad=1.0)
    ax.set_ylabel("z [m]", labelpad=1.0)
    fill_panel(ax, window)
    ax.locator_params(nbins=4)


def _over_time(ax: Axes, words: str, lines: Sequence[tuple[Array, str, float, str, Any]]) -> None:
    """Curves with their names beside them."""
    t = STEP * np.arange(len(lines[0][0]))
    for values, name, beside, colour, dashes in lines:
        add_line(ax, np.column_stack([t, values]), color=colour, linestyle=dashes, linewidth=1.1, zorder=3.0)
        ax.annotate(name, (t[NAMED_AT], values[NAMED_AT]), (0.0, beside), textcoords="offset points", ha="center", va="center",
                    fontsize=6.0, color=colour)  # fmt: skip
    everything = np.concatenate([values for values, *_ in lines])
    room = 0.16 * float(np.ptp(everything))
    ax.set_xlim(t[0], t[-1])
    ax.set_ylim(everything.min() - room, everything.max() + room)
    ax.axhline(0.0, color=GREY, linewidth=0.4, zorder=1.0)
    ax.set_xlabel("t [s]", labelpad=1.0)
    ax.set_ylabel(words, labelpad=1.0)
    ax.xaxis.set_major_locator(MaxNLocator(4, integer=True))


def caption(records: Mapping[str, Sequence[Any]]) -> str:
    """Extremes of everything drawn."""
    sweep = records["sweep"]
    f = _internal(sweep)
    low, high = int(np.argmin(f)), int(np.argmax(f))
    hips, ankles = _torque(sweep, "RLEG_JOINT2"), _torque(sweep, "RLEG_JOINT6")
    vertical = _reaction(sweep, "right_foot")[:, 2]
    return (
        f"Double stance of HOAP-2 with hips and ankles rolled by 5 deg: the internal force between the soles goes through "
        f"fifth-order splines to {f[low]:.0f} N (compression) at {STEP * low:.1f} s and {f[high]:.0f} N (tension) at {STEP * high:.1f} s. "
        f"The right hip roll has {hips[0]:.3f} N m without it, {hips[low]:.3f} N m and {hips[high]:.3f} N m at its extremes, the ankle "
        f"roll {abs(ankles[0]):.3f}, {ankles[low]:.3f} and {ankles[high]:.3f} N m, the left side the opposite. The vertical reactions "
        f"stay {vertical.min():.2f} N each, and the friction used is at most {_use(sweep).max():.3f} of all."
    )
