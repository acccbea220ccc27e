"""Fig. 3.1: a friction cone with its four-sided pyramids, and sections of the wrench cone that they give a rectangular sole."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from socp_statics.cones.choice import KINDS, ConeChoice, cone_choice
from socp_statics.contacts import Contact, SurfaceContact
from socp_statics.figures.axonometric import add_axes_of_space, seen_from
from socp_statics.figures.marks import add_filled, add_line
from socp_statics.figures.panels import fill_panel, legend_below, panels, title_panels
from socp_statics.figures.style import REGION_LINES
from socp_statics.figures.window import around
from socp_statics.regions.polygon import area
from socp_statics.report_figures import Need, stance_of
from socp_statics.spatial import Array
from socp_statics.wrench_cones import WrenchCone, WrenchSlice, contact_wrench_cone

NEEDS = {"stance": Need("contacts/hoap2_double_stance")}
SIDES, QUARTER, HALVINGS = 4, 37, 12
TURN = 0.75
ARROWS = (0.75, 0.75, 1.25)
VIEW = seen_from(np.deg2rad(-62.0), np.deg2rad(20.0))
WORDS = {"exact": "exact", "circumscribed": "circumscribed, 4 sides", "inscribed": "inscribed, 4 sides"}
# the two components of a wrench that a section shows
MOMENTS, YAW = (3, 4), (0, 5)


def _contact(records: Mapping[str, Sequence[Any]]) -> Contact:
    contact: Contact = stance_of(records["stance"][0]).contacts["left_foot"]
    return contact


def _choice(kind: str) -> ConeChoice:
    return cone_choice(kind, None if kind == "exact" else SIDES, None)


def _edges(contact: Contact, kind: str) -> Array:
    """Rays of a friction cone at 1 N of normal force, in order round it, shape (k, 3) [N]."""
    if kind == "exact":
        angle = np.linspace(0.0, 2.0 * np.pi, 120, endpoint=False)
        flat = np.column_stack([np.cos(angle), np.sin(angle)]) * contact.friction
    else:
        choice = _choice(kind)
        flat = choice.edge_directions() * contact.friction * choice.slope_factor() / np.cos(np.pi / SIDES)
    return np.column_stack([flat, np.ones(len(flat))])


def _section(cone: WrenchCone, axes: tuple[int, int], rest: Array, size: Array) -> Array:
    """Corners of a section, counter-clockwise, shape (k, 2); the exact one, which has no corners, by halving along rays.

    Args:
        cone: Symmetric about both axes of the section, as that of a rectangle is about its middle.
        axes: The two components shown.
        rest: The other components, shape (6,).
        size: Half-sides of a box about the section, shape (2,).
    """
    slope = np.zeros((6, 2))
    slope[list(axes), [0, 1]] = size
    if not cone.is_exact:
        corners: Array = WrenchSlice(cone, rest, slope, np.zeros(2), 2.0, "").vertices * size
        return corners
    angle = np.linspace(0.0, 0.5 * np.pi, QUARTER)
    ways = np.column_stack([np.cos(angle), np.sin(angle)])
    low, high = np.zeros(QUARTER), np.full(QUARTER, 1.5)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        inside = np.asarray(cone.contains(rest + (middle[:, None] * ways) @ slope.T, 1e-6))
        low, high = np.where(inside, middle, low), np.where(inside, high, middle)
    quarter = low[:, None] * ways * size
    return np.vstack([quarter, quarter[-2::-1] * (-1, 1), quarter[1:] * (-1, -1), quarter[-2:0:-1] * (1, -1)])


@cache
def _sections(friction: float, size: tuple[float, float]) -> dict[str, dict[str, Array]]:
    """Both sections of the three cones per newton of normal force: moments at a yaw moment, and f_x with m_z [N, N m]."""
    sole = SurfaceContact("sole", (0.0, 0.0, 0.0), normal=(0.0, 0.0, 1.0), friction=friction, size=size)
    half = 0.5 * np.array(size)
    found: dict[str, dict[str, Array]] = {}
    for kind in KINDS:
        cone = contact_wrench_cone(sole, cone=_choice(kind))
        still, turned = np.array([0.0, 0, 1, 0, 0, 0]), np.array([0.0, 0, 1, 0, 0, _turn(friction, size)])
        box = friction * np.array([1.0, half.sum()])
        found[kind] = {"moments": _section(cone, MOMENTS, turned, half[::-1]), "yaw": _section(cone, YAW, still, box)}
    return found


def _turn(friction: float, size: tuple[float, float]) -> float:
    """A share of the largest yaw moment, that of forces round the corners [N m per N]."""
    return TURN * friction * 0.5 * float(np.hypot(*size))


def _size(contact: Contact) -> tuple[float, float]:
    """Lengths of a rectangular sole, shape (2,) [m]."""
    long, wide = np.ptp(contact.points_C, axis=0)
    return round(float(long), 9), round(float(wide), 9)


def draw(records: Mapping[str, Sequence[Any]]) -> Figure:
    """The cone in space, its section, and two sections of the wrench cone."""
    contact = _contact(records)
    figure, axes = panels(1, 4, high=1.28, foot=0.2, left=0.4, right=0.06, between=0.32)
    space, flat, moments, yaw = axes
    _add_space(space, contact)
    for kind in ("exact", "circumscribed", "inscribed"):
        add_line(flat, _edges(contact, kind)[:, :2], closed=True, label=WORDS[kind], **REGION_LINES[kind])
    fill_panel(flat, around(_edges(contact, "circumscribed")[:, :2]).grown(0.07))
    flat.set_xlabel("f_x [N]", labelpad=1.0)
    flat.set_ylabel("f_y [N]", labelpad=0.0)
    size = _size(contact)
    sections, half = _sections(contact.friction, size), 0.5e3 * np.array(size)
    for kind in ("exact", "circumscribed", "inscribed"):
        add_line(moments, 1e3 * sections[kind]["moments"], closed=True, **REGION_LINES[kind])
        add_line(yaw, sections[kind]["yaw"] * (1.0, 1e3), closed=True, **REGION_LINES[kind])
    box = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) * half[::-1]
    add_filled(moments, box, facecolor="#EEEEEE", edgecolor="none", zorder=1.0)
    fill_panel(moments, around(box).grown(6.0))
    moments.set_xlabel("m_x [N mm]", labelpad=1.0)
    moments.set_ylabel("m_y [N mm]", labelpad=0.0)
    outer = sections["circumscribed"]["yaw"] * (1.0, 1e3)
    yaw.set_xlim(1.15 * outer[:, 0].min(), 1.15 * outer[:, 0].max())
    yaw.set_ylim(1.15 * outer[:, 1].min(), 1.15 * outer[:, 1].max())
    yaw.set_xlabel("f_x [N]", labelpad=1.0)
    yaw.set_ylabel("m_z [N mm]", labelpad=0.0)
    for ax in axes[1:]:
        ax.locator_params(nbins=4)
    turn = 1e3 * _turn(contact.friction, size)
    words = (f"friction cone, mu = {contact.friction:g}", "its section, f_z = 1 N", f"sole, m_z = {turn:.1f} N mm", "sole, m_x = m_y = 0")
    title_panels(axes, words)
    legend_below(figure, axes, 3, tuple(WORDS.values()))
    return figure


def _add_space(ax: Axes, contact: Contact) -> None:
    shown = []
    for kind in KINDS:
        rim = VIEW.flat(_edges(contact, kind))
        shown.append(rim)
        look = REGION_LINES[kind]
        add_line(ax, rim, closed=True, **look)
        if kind == "exact":
            add_filled(ax, rim, facecolor=look["color"], alpha=0.12, edgecolor="none", zorder=2.0)
            lean = np.arctan2(rim[:, 0], rim[:, 1])
            sides = rim[[int(np.argmin(lean)), int(np.argmax(lean))]]
        else:
            sides = rim
        for corner in sides:
            add_line(ax, np.array([[0.0, 0.0], corner]), **look)
    shown += [np.zeros((1, 2)), add_axes_of_space(ax, VIEW, np.zeros(3), ARROWS, ("f_x", "f_y", "f_z"))]
    ax.set_xticks([])
    ax.set_yticks([])
    fill_panel(ax, around(np.vstack(shown)).grown(0.08))


def caption(records: Mapping[str, Sequence[Any]]) -> str:
    """Shares of the areas."""
    contact = _contact(records)
    size = _size(contact)
    sections = _sections(contact.friction, size)
    areas = {name: {kind: area(s[name]) for kind, s in sections.items()} for name in ("moments", "yaw")}
    of = {name: [100 * a[kind] / a["exact"] - 100 for kind in ("inscribed", "circumscribed")] for name, a in areas.items()}
    plain = [100 * (2 / np.pi) - 100, 100 * (4 / np.pi) - 100]
    arrows = ", ".join(f"{length:g}" for length in ARROWS)
    return (
        f"(a, b) Friction cone of mu = {contact.friction:.1f} with its inscribed and circumscribed pyramids of {SIDES} sides, per newton "
        f"of normal force (arrows in (a): {arrows} N): the pyramids miss {-plain[0]:.0f} % of its area and add {plain[1]:.0f} %. (c, d) "
        f"Sections of the wrench cone of a sole of {1e3 * size[0]:.0f} x {1e3 * size[1]:.0f} mm about its middle, per newton of normal "
        f"force: (c) without tangential force, at a yaw moment of {1e3 * _turn(contact.friction, size):.1f} N mm, the grey rectangle holds "
        f"the tipping moments without it; (d) without f_y. The areas of the pyramids' sections differ by {of['moments'][0]:+.0f} and "
        f"{of['moments'][1]:+.0f} % in (c), {of['yaw'][0]:+.0f} and {of['yaw'][1]:+.0f} % in (d)."
    )
