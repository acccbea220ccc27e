"""Fig. 3.1: a friction cone with its four-sided pyramids, and sections of the wrench cone that they give a rectangular sole."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from socp_statics.cones.choice import KINDS, ConeChoice, cone_choice
from socp_statics.contacts import Contact
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
SIDES, QUARTER, HALVINGS = 4, 13, 12
PUSH = 0.55
VIEW = seen_from(np.deg2rad(-62.0), np.deg2rad(20.0))
WORDS = {"exact": "exact", "circumscribed": "circumscribed, 4 sides", "inscribed": "inscribed, 4 sides"}
# the two components of a wrench that a section shows
MOMENTS, YAW = (3, 4), (0, 5)


def _contact(records: Mapping[str, Sequence[Any]]) -> Contact:
    contact: Contact = stance_of(records["stance"][0]).contacts["left_foot"]
    return contact


def _choice(kind: str) -> ConeChoice:
    return cone_choice(kind, None if kind == "exact" else SIDES, None)


def _cone(contact: Contact, kind: str) -> WrenchCone:
    """About the middle of the sole."""
    return contact_wrench_cone(contact, cone=_choice(kind), point_C=(*contact.points_C.mean(axis=0), 0.0))


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


def _sections(contact: Contact) -> dict[str, dict[str, Array]]:
    """Both sections of the three cones per newton of normal force: moments at a push of f_x, and f_x with m_z [N, N m]."""
    half = 0.5 * np.ptp(contact.points_C, axis=0)
    push = PUSH * contact.friction
    found: dict[str, dict[str, Array]] = {}
    for kind in KINDS:
        cone = _cone(contact, kind)
        still, pushed = np.array([0.0, 0, 1, 0, 0, 0]), np.array([push, 0, 1, 0, 0, 0])
        size = contact.friction * np.array([1.0, half.sum()])
        found[kind] = {"moments": _section(cone, MOMENTS, pushed, half[::-1]), "yaw": _section(cone, YAW, still, size)}
    return found


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
    sections, half = _sections(contact), 0.5e3 * np.ptp(contact.points_C, axis=0)
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
        ax.locator_params(nbins=5)
    title_panels(axes, ("friction cone", "its section, f_z = 1 N", f"sole, f_x = {PUSH * contact.friction:.3g} N", "sole, m_x = m_y = 0"))
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
    shown += [np.zeros((1, 2)), add_axes_of_space(ax, VIEW, np.zeros(3), [0.75, 0.75, 1.25], ("f_x", "f_y", "f_z"))]
    ax.set_xticks([])
    ax.set_yticks([])
    fill_panel(ax, around(np.vstack(shown)).grown(0.08))


def caption(records: Mapping[str, Sequence[Any]]) -> str:
    """Shares of the areas."""
    contact = _contact(records)
    sections = _sections(contact)
    areas = {name: {kind: area(s[name]) for kind, s in sections.items()} for name in ("moments", "yaw")}
    of = {name: [100 * a[kind] / a["exact"] - 100 for kind in ("inscribed", "circumscribed")] for name, a in areas.items()}
    plain = [100 * (2 / np.pi) - 100, 100 * (4 / np.pi) - 100]
    half = 0.5e3 * np.ptp(contact.points_C, axis=0)
    return (
        f"(a, b) Friction cone of mu = {contact.friction:.1f} with its inscribed and circumscribed pyramids of {SIDES} sides, per newton of "
        f"normal force: the pyramids have {plain[0]:+.0f} and {plain[1]:+.0f} % of the area. (c, d) Sections of the wrench cone of a sole of "
        f"{2 * half[0]:.0f} x {2 * half[1]:.0f} mm about its middle, f_y = 0 and m_z = 0 in (c), whose grey rectangle are the tipping moments "
        f"without a push: {of['moments'][0]:+.1f} and {of['moments'][1]:+.1f} % in (c), {of['yaw'][0]:+.1f} and {of['yaw'][1]:+.1f} % in (d)."
    )
