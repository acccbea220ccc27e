"""Statics of Fig. 3.8: the internal force of two feet in a valley lowered and raised again, and the moments at which they slip and hold."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from socp_statics.figures.marks import add_dots, add_line
from socp_statics.figures.panels import panels, title_panels
from socp_statics.figures.style import BLACK, BLUE, GREEN, GREY, VERMILLION
from socp_statics.report_figures import Need, stance_of
from socp_statics.spatial import Array

NEEDS = {"sweep": Need("chapter/internal_force_slip"), "window": Need("chapter/internal_force_window")}
STEP = 0.1


def _found(record: Mapping[str, Any]) -> Mapping[str, Any]:
    found: Mapping[str, Any] = record["distribution"]["methods"]["barycentric"]
    return found


def _internal(records: Sequence[Any]) -> Array:
    return np.array([_found(record)["internal_forces"][0]["force"] for record in records])


def _use(records: Sequence[Any]) -> Array:
    return np.array([max(_found(record)["friction_use"].values()) for record in records])


def _parts(records: Sequence[Any]) -> Array:
    """Normal and tangential force of the right foot, the latter uphill, shape (n, 2) [N]."""
    R = stance_of(records[0]).contacts["right_foot"].rotation
    forces = [next(w["force"] for w in _found(record)["wrenches"] if w["contact"] == "right_foot") for record in records]
    local = np.array(forces) @ R
    return np.column_stack([local[:, 2], -local[:, 1]])


def _crossings(records: Mapping[str, Sequence[Any]]) -> list[float]:
    """When the internal force leaves its window and enters it again [s]."""
    lower = records["window"][0]["window"]["lower"]["value"]
    above = _internal(records["sweep"]) - lower
    at = np.flatnonzero(np.diff(np.sign(above)))
    return [float(STEP * (k + above[k] / (above[k] - above[k + 1]))) for k in at]


def draw(records: Mapping[str, Sequence[Any]]) -> Figure:
    """Internal force with its window, use of friction, reactions."""
    sweep, window = records["sweep"], records["window"][0]["window"]
    figure, axes = panels(1, 3, high=1.6, foot=0.0, left=0.45, right=0.08)
    internal, friction, reaction = axes
    t = STEP * np.arange(len(sweep))
    f, use, parts = _internal(sweep), _use(sweep), _parts(sweep)
    slips, holds = _crossings(records)
    for ax in axes:
        ax.axvspan(slips, holds, facecolor=VERMILLION, alpha=0.13, edgecolor="none", zorder=0.5)
        ax.set_xlim(t[0], t[-1])
        ax.set_xlabel("t [s]", labelpad=1.0)
    lower, upper = (window[key]["value"] for key in ("lower", "upper"))
    internal.axhspan(lower, upper, facecolor=GREEN, alpha=0.2, edgecolor="none", zorder=0.6)
    _curve(internal, t, f, BLACK)
    look = {"markerfacecolor": VERMILLION, "markeredgecolor": BLACK, "zorder": 4.0}
    add_dots(internal, np.array([[slips, lower], [holds, lower]]), "o", 4.0, **look)
    words = f"slips at {slips:.2f} s, holds at {holds:.2f} s"
    internal.text(0.5 * (slips + holds), -1.4, words, ha="center", va="center", fontsize=6.0)
    internal.text(3.5, 0.5 * (lower + upper) + 2.5, "window of the internal force", ha="center", va="center", fontsize=6.0, color=GREEN)
    internal.set_ylim(-2.5, 1.08 * upper)
    internal.set_ylabel("internal force [N]", labelpad=1.0)
    _curve(friction, t, use, BLACK)
    friction.axhline(1.0, color=VERMILLION, linewidth=0.8, linestyle=(0, (4, 2)), zorder=2.0)
    friction.text(0.15, 1.03, "all of it", ha="left", va="bottom", fontsize=6.0, color=VERMILLION)
    friction.set_ylim(0.0, 1.1 * use.max())
    friction.set_ylabel("friction needed, of mu", labelpad=1.0)
    _curve(reaction, t, parts[:, 0], BLUE)
    _curve(reaction, t, parts[:, 1], VERMILLION)
    mu = stance_of(sweep[0]).contacts["right_foot"].friction
    add_line(reaction, np.column_stack([t, mu * parts[:, 0]]), color=GREY, linewidth=0.9, linestyle=(0, (4, 2)), zorder=2.0)
    middle = len(t) // 2
    names = ((0, parts[:, 0], -7.0, "normal", BLUE, "left"), (-1, mu * parts[:, 0], 5.0, "mu x normal", GREY, "right"),
             (middle, parts[:, 1], 6.0, "along the plane", VERMILLION, "center"))  # fmt: skip
    for k, values, beside, name, colour, side in names:
        along = {"left": 3.0, "right": -3.0, "center": 0.0}[side]
        reaction.annotate(name, (t[k], values[k]), (along, beside), textcoords="offset points", va="center", ha=side, fontsize=6.0,
                          color=colour)  # fmt: skip
    reaction.set_ylim(-2.0, 36.0)
    reaction.set_ylabel("reaction of a foot [N]", labelpad=1.0)
    title_panels(axes, ("internal force", "use of friction", "reaction"))
    return figure


def _curve(ax: Axes, t: Array, values: Array, colour: str) -> None:
    add_line(ax, np.column_stack([t, values]), color=colour, linewidth=1.2, zorder=3.0)


def caption(records: Mapping[str, Sequence[Any]]) -> str:
    """The window, the moments and the friction there."""
    window, sweep = records["window"][0]["window"], records["sweep"]
    slips, holds = _crossings(records)
    mu = stance_of(sweep[0]).contacts["right_foot"].friction
    outside = [k for k, record in enumerate(sweep) if not _found(record)["inside"]]
    return (
        f"HOAP-2's feet on the sides of a valley (15 deg, friction {mu:.1f}). The "
        f"internal force of {_internal(sweep)[0]:.2f} N, at which the reactions are normal, is lowered to zero and raised again. "
        f"Cones hold between {window['lower']['value']:.3f} and {window['upper']['value']:.3f} N (window of exact cones): the feet slip at "
        f"{slips:.2f} s and could hold again from {holds:.2f} s on. The {len(outside)} of {len(sweep)} cases outside their cones are those "
        f"from {STEP * outside[0]:.1f} to {STEP * outside[-1]:.1f} s; without internal force {_use(sweep).max():.3f} of the friction is "
        "needed. Red: no static equilibrium with this internal force; what the robot does then is dynamics."
    )
