"""Fig. 3.9: HOAP-2 pushes on level feet and with its rear leg against an inclined surface, the friction of the feet swept."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from socp_statics.figures.draw_robot import Pushes, add_robot
from socp_statics.figures.draw_stance import merged
from socp_statics.figures.marks import add_line
from socp_statics.figures.outlines import VIEWS
from socp_statics.figures.panels import fill_panel, legend_below, panels, relabel, title_panels
from socp_statics.figures.style import BLUE, GREY, VERMILLION
from socp_statics.figures.window import Window
from socp_statics.report_figures import Need, stance_of
from socp_statics.spatial import Array

STANCES = {"A": "push/hoap2_a_holds", "B": "push/hoap2_b_holds"}
FRICTION = (0.0, 0.05, 0.1, 0.15, 0.2, 0.3, 0.5)
DRAWN = {"A": 0.3, "B": 0.1}
LOWEST, HIGHEST = -0.05, 0.53
LEAST = 0.08


def _with_friction(name: str, friction: float) -> Need:
    both = {"left_foot": friction, "right_foot": friction, "left_hand": 0.0, "right_hand": 0.0}
    return Need(name, {"posture.friction": both, "expect": {}})


NEEDS = {f"{key} {mu:g}": _with_friction(name, mu) for key, name in STANCES.items() for mu in FRICTION} | {
    "A strong": Need("push/fig_3_9_a"),
    "B strong": Need("push/fig_3_9_b"),
}


def _margins(records: Mapping[str, Sequence[Any]], key: str) -> Array:
    """Normal-force reserve at each friction [N], shape (n,)."""
    return np.array([float(records[f"{key} {mu:g}"][0]["margin"]) for mu in FRICTION])


def _least(records: Mapping[str, Sequence[Any]], key: str) -> float:
    """Friction at which the margin goes through zero, between two of those swept."""
    m = _margins(records, key)
    k = int(np.flatnonzero(m > 0.0)[0])
    return float(np.interp(0.0, m[k - 1 : k + 1], FRICTION[k - 1 : k + 1])) if k else 0.0


def draw(records: Mapping[str, Sequence[Any]]) -> Figure:
    """Both stances from the side, and their margins."""
    figure, axes = panels(1, 3, high=2.1, foot=0.18, left=0.42, right=0.12, between=0.3)
    for ax, key in zip(axes, STANCES, strict=False):
        _add_stance(ax, records[f"{key} {DRAWN[key]:g}"][0])
    curves = axes[2]
    for key, colour, dashes, named_at, beside in (("A", BLUE, "-", 3, (8.0, -2.0)), ("B", VERMILLION, (0, (4, 2)), 2, (-3.0, 7.0))):
        points = np.column_stack([FRICTION, _margins(records, key)])
        add_line(curves, points, color=colour, linestyle=dashes, linewidth=1.2, marker="o", markersize=2.5, zorder=3.0)
        curves.annotate(key, points[named_at], beside, textcoords="offset points", ha="center", va="center", fontsize=7.0, color=colour)
    curves.axhspan(-100.0, 0.0, facecolor="#EEEEEE", edgecolor="none", zorder=0.5)
    curves.axhline(0.0, color=GREY, linewidth=0.6, zorder=1.0)
    every = np.concatenate([_margins(records, key) for key in STANCES])
    curves.set_ylim(-10.0, 1.2 * every.max())
    curves.text(0.98, 0.05, "slides", transform=curves.transAxes, ha="right", va="bottom", fontsize=6.5, color=GREY)
    curves.set_xlim(FRICTION[0], FRICTION[-1])
    curves.set_xlabel("friction of the feet", labelpad=1.0)
    curves.set_ylabel("margin [N]", labelpad=1.0)
    words = (f"level feet, friction {DRAWN['A']:g}", f"leg on a slope, friction {DRAWN['B']:g}", "margin of both")
    title_panels(axes, [f"{key}: {text}" for key, text in zip(("A", "B"), words, strict=False)] + [words[2]])
    for ax in axes:
        relabel(ax, {"forces up to": "reaction"})
    legend_below(figure, axes, 4, ("friction cone", "reaction", "CoM"))
    return figure


def _add_stance(ax: Axes, record: Mapping[str, Any]) -> None:
    posture = stance_of(record).posture
    assert posture is not None
    view = VIEWS["side"]
    seen = merged(record["forces"], view.axes)
    largest = max(float(np.linalg.norm(f["force"])) for f in seen)
    # an arrow shorter than its head points nowhere
    window = add_robot(ax, posture, view, Pushes([f for f in seen if np.linalg.norm(f["force"]) > LEAST * largest], [], []), named=False)
    fill_panel(ax, Window(window.x_min, window.x_max, LOWEST, HIGHEST))
    ax.set_xlabel("x [m]", labelpad=1.0)
    ax.set_ylabel("z [m]", labelpad=1.0)
    ax.locator_params(nbins=5)


def caption(records: Mapping[str, Sequence[Any]]) -> str:
    """Least frictions, and what strong stability says."""
    posture = records["A 0.3"][0]["case"]["posture"]
    slope = np.degrees(records["B 0.3"][0]["case"]["posture"]["slope"])
    weight = 9.81 * records["A 0.3"][0]["case"]["generated"]["mass"]
    strong = {key: records[f"{key} strong"][0] for key in STANCES}
    mu = {key: r["case"]["posture"]["contacts"][0]["friction"] for key, r in strong.items()}
    said = [f"{key} {r['strong'].replace('_', ' ')} at friction {mu[key]:g}" for key, r in strong.items()]
    return (
        f"HOAP-2 pushes with {posture['force']:.0f} N; arrows are reactions that attain the margin, added up as seen, small ones left "
        f"out. On level feet (A) the push needs the friction {_least(records, 'A'):.3f} "
        f"(push over weight: {posture['force'] / weight:.3f}); with the rear leg on a surface inclined by {slope:.0f} deg (B) it needs "
        f"{_least(records, 'B'):.3f}. Margin: normal-force reserve, interpolated between {len(FRICTION)} frictions. Of the reduced stances "
        f"of Fig. 3.9 (front edge and toe) strong stability, every force that obeys the contact laws, says: {'; '.join(said)}."
    )
