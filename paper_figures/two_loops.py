"""Fig. 3.6: HOAP-2 with two closed loops, the feet on the floor with friction, the hands on a box or on a wall without."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from socp_statics.colours import EDGE
from socp_statics.figures.draw_robot import Pushes, add_robot
from socp_statics.figures.marks import add_arrow, add_filled
from socp_statics.figures.outlines import VIEWS, View
from socp_statics.figures.panels import fill_panel, legend_below, panels, relabel, title_panels
from socp_statics.figures.style import BLUE, SOLE
from socp_statics.figures.window import Window, around
from socp_statics.postures import Posture
from socp_statics.report_figures import Need, stance_of

NEEDS = {"holding": Need("chapter/two_loops_holding", {"parameters.method": "barycentric", "expect": {}}),
         "touching": Need("chapter/two_loops_touching")}  # fmt: skip
HANDS = ("left_hand", "right_hand")
PER_NEWTON = 0.012
BOX_HIGH, BOX_LONG = 0.05, 0.04
LOWEST, HIGHEST = -0.04, 0.53


def _found(record: Mapping[str, Any]) -> Mapping[str, Any]:
    found: Mapping[str, Any] = record["distribution"]["methods"]["barycentric"]
    return found


def _force(record: Mapping[str, Any], contact: str) -> Any:
    return np.array(next(w["force"] for w in _found(record)["wrenches"] if w["contact"] == contact))


def _posture(record: Mapping[str, Any]) -> Posture:
    posture = stance_of(record).posture
    assert posture is not None
    return posture


def _squeeze(record: Mapping[str, Any]) -> float:
    return float(record["case"]["posture"]["squeeze"])


def draw(records: Mapping[str, Sequence[Any]]) -> Figure:
    """Both from the side and from the front."""
    figure, axes = panels(1, 4, high=2.2, foot=0.18, left=0.36, right=0.06, between=0.3)
    for pair, key in ((axes[:2], "holding"), (axes[2:], "touching")):
        for ax, view in zip(pair, VIEWS.values(), strict=True):
            _add_view(ax, records[key][0], view)
    title_panels(axes, ("hands hold a box", "from the front", "hands on a wall", "from the front"))
    for ax in axes:
        relabel(ax, {"forces up to": "reaction of the floor"})
    legend_below(figure, axes, 5, ("friction cone", "reaction of the floor", "hand", "box", "CoM"))
    return figure


def _add_view(ax: Axes, record: Mapping[str, Any], view: View) -> None:
    posture = _posture(record)
    feet = [c for c in posture.contacts if c.name not in HANDS]
    cops = {c.name: c.position + c.rotation[:, :2] @ _found(record)["cop"][c.name] for c in feet}
    forces = [{"point": cops[c.name], "force": _force(record, c.name)} for c in feet]
    window = add_robot(ax, posture, view, Pushes(forces, [], []), named=False)
    flat = list(view.axes)
    hands = {name: _hand(posture, name) for name in HANDS}
    if "squeeze" in record["case"]["posture"]:
        low, high = np.array(list(hands.values()))[:, 1].min(), np.array(list(hands.values()))[:, 1].max()
        x, z = hands[HANDS[0]][0], hands[HANDS[0]][2]
        corners = np.array([(x + BOX_LONG * a, y, z + BOX_HIGH * b) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1)) for y in (low, high)])
        box = corners[:, flat]
        lower, upper = box.min(axis=0), box.max(axis=0)
        rectangle = np.array([lower, (upper[0], lower[1]), upper, (lower[0], upper[1])])
        add_filled(ax, rectangle, facecolor=SOLE, edgecolor=EDGE, linewidth=0.8, alpha=0.8,
                   zorder=4.4 if view is VIEWS["front"] else 1.45, label="box")  # fmt: skip
        pushes = {name: np.sign(hands[name][1]) * np.array([0.0, _squeeze(record), 0.0]) for name in HANDS}
    else:
        pushes = {name: _force(record, name) for name in HANDS}
    heads = [np.array([[window.x_min, window.y_min], [window.x_max, window.y_max]])]
    for name, push in pushes.items():
        head = hands[name] + PER_NEWTON * push
        heads.append(head[flat][None])
        if np.linalg.norm(push[flat]) > 0.1 * np.linalg.norm(push):
            add_arrow(ax, hands[name][flat], head[flat], color=BLUE, linewidth=1.2, zorder=5.2, label="hand")
    ax.set_xlabel("x [m]" if 0 in flat else "y [m]", labelpad=1.0)
    ax.set_ylabel("z [m]" if view is VIEWS["side"] else "", labelpad=1.0)
    shown = around(np.vstack(heads))
    fill_panel(ax, Window(shown.x_min, shown.x_max, LOWEST, HIGHEST))
    ax.locator_params(nbins=4)


def _hand(posture: Posture, name: str) -> Any:
    """Where a hand is, world axes, shape (3,) [m]."""
    if name in posture.contacts.names:
        return posture.contacts[name].position
    frame = posture.robot.frames[name]
    R_WF, p_WF = posture.link_placement(frame.frame)
    return p_WF + R_WF @ frame.position


def caption(records: Mapping[str, Sequence[Any]]) -> str:
    """Forces of both loops."""
    holding, touching = records["holding"][0], records["touching"][0]
    foot, push = _force(touching, "left_foot"), _force(touching, "left_hand")
    use = 100.0 * _found(touching)["friction_use"]["left_foot"]
    cop = [1e3 * _found(record)["cop"]["left_foot"][0] for record in (holding, touching)]
    return (
        f"HOAP-2 with two closed loops: feet with friction 0.5, hands without. (a, b) The hands press a weightless box with "
        f"{_squeeze(holding):.0f} N each: an internal force of their loop, the feet carry {_force(holding, 'left_foot')[2]:.2f} N each as "
        f"if it were not there, centre of pressure {cop[0]:.1f} mm ahead of the ankle. (c, d) The hands push on a wall with "
        f"{np.linalg.norm(push):.0f} N each, a reference that is met exactly: each foot gets {foot[0]:.2f} N along the floor besides "
        f"{foot[2]:.2f} N, its centre of pressure moves to {cop[1]:.1f} mm, {use:.1f} % of the "
        "friction is used. Arrows are reactions on the robot, those of the hands to a larger scale; from the side both feet count as one."
    )
