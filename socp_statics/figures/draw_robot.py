"""A robot seen from its side and from the front: its shapes, its contacts with friction cones, the forces on it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from socp_statics.exceptions import InputError
from socp_statics.figures.draw_stance import AXIS_WORDS, add_forces, force_sizes, merged
from socp_statics.figures.layout import Row, arrange, new_axes, sheet_of, show_alone_or_in
from socp_statics.figures.marks import add_com, add_line
from socp_statics.figures.outlines import VIEWS, View
from socp_statics.figures.robot_marks import add_body, add_cones, add_ground, add_touching
from socp_statics.figures.style import BLACK, COLUMN, GREY, PURPLE, TWO_COLUMNS, house_style
from socp_statics.figures.window import Window, around, label_axes
from socp_statics.postures import Posture
from socp_statics.statics import PointForces

FORCE_SHARE, CONE_SHARE, RIM_SHARE = 0.28, 0.15, 0.05
HEAD = 0.13


class Pushes(NamedTuple):
    """What pushes a robot, as mappings with "point" [m] and "force" [N], world axes.

    Attributes:
        forces: Of the contacts.
        weight: At the centre of mass, one or none.
        loads: From outside.
    """

    forces: Sequence[Mapping[str, Any]]
    weight: Sequence[Mapping[str, Any]]
    loads: Sequence[Mapping[str, Any]]

    def styles(self, view: View) -> list[tuple[list[dict[str, Any]], str, str]]:
        """What is seen as one arrow each, its colour, and its words for the legend."""
        kinds = ((self.forces, PURPLE, "forces up to"), (self.weight, GREY, "weight"), (self.loads, BLACK, "load"))
        return [(merged(pushes, view.axes), colour, words) for pushes, colour, words in kinds]


def draw_robot(
    posture: Posture,
    ax: Axes | None = None,
    *,
    view: str = "side",
    forces: Iterable[Mapping[str, Any]] | PointForces | None = None,
    cones: bool = True,
) -> Axes:
    """Draw a robot from its side or from the front.

    Boxes, cylinders and spheres of its URDF are drawn as the outlines of their projections, what is farther lighter; a robot
    with fewer such shapes than joints as lines from joint to joint. Friction cones have their true angle, their size says nothing.

    Args:
        posture: The posture.
        ax: Axes to draw into, the view grows as needed; by default those of a new figure with a legend.
        view: ``"side"``, x to the right and z up, seen from the robot's right; or ``"front"``, y to the right and z up.
        forces: Contact forces of an answer, or entries of a record ("point", "force"); those seen at one point are added up.
        cones: Whether to draw the friction cones.

    Returns:
        The axes, equal and in metres.

    Raises:
        InputError: There is no such view.
    """
    if view not in VIEWS:
        raise InputError(f"draw_robot: view must be 'side' or 'front', got {view!r}", name="draw_robot", field="view")
    pushes = Pushes(_entries(forces), [], [])
    with house_style():
        own = new_axes() if ax is None else ax
        window = add_robot(own, posture, VIEWS[view], pushes, cones=cones)
        show_alone_or_in(own, ax, window, head=HEAD)
    return own


def robot_views(
    posture: Posture, forces: Iterable[Mapping[str, Any]] | PointForces | None = None, *, columns: int = 2, cones: bool = True
) -> Figure:
    """A robot from its side and from the front, beside each other and to one scale.

    Args:
        posture: The posture.
        forces: Contact forces of an answer, or entries of a record ("point", "force").
        columns: Width of the figure: 1 column of a paper (3.4 in) or 2 (7 in).
        cones: Whether to draw the friction cones.

    Returns:
        The figure.

    Raises:
        InputError: The figure is to be neither one nor two columns wide.
    """
    if columns not in (1, 2):
        raise InputError(f"robot_views: columns must be 1 or 2, got {columns!r}", name="robot_views", field="columns")
    with house_style():
        figure = sheet_of(new_axes(2))
        row = add_views(figure.axes[0], figure.axes[1], posture, Pushes(_entries(forces), [], []), cones=cones)
        arrange(figure, [row], wide=COLUMN if columns == 1 else TWO_COLUMNS)
    return figure


def add_views(side: Axes, front: Axes, posture: Posture, pushes: Pushes, *, cones: bool = True) -> Row:
    """Add the view from the side and that from the front to their axes; returns them as a row of the sheet."""
    windows = [add_robot(ax, posture, view, pushes, cones=cones) for ax, view in zip((side, front), VIEWS.values(), strict=True)]
    return Row((side, front), tuple(windows), HEAD)


def add_robot(ax: Axes, posture: Posture, view: View, pushes: Pushes, *, cones: bool = True, named: bool = True) -> Window:
    """Add a robot and what pushes it.

    Args:
        ax: The axes.
        posture: The posture.
        view: The view.
        pushes: Forces, weight and loads; the longest arrow in any view is a fixed share of the robot's extent.
        cones: Whether to add the friction cones.
        named: Whether to say above the axes where the reader stands.

    Returns:
        What the axes have to show.
    """
    contacts = list(posture.contacts)
    body = add_body(ax, posture, view)
    com = posture.com_W[list(view.axes)]
    shown = [body, posture.contacts.points_W[:, view.axes], com[None]]
    # the same in all views
    size = max(float(np.ptp(body[:, 1])), posture.contacts.size)
    add_ground(ax, contacts, size, view)
    add_touching(ax, contacts, size, view)
    if cones:
        shown.append(add_cones(ax, contacts, CONE_SHARE * size, view))
    lowest = float(posture.contacts.points_W[:, 2].min())
    add_line(ax, np.array([com, [com[0], lowest]]), color=BLACK, linewidth=0.6, linestyle=(0, (4, 2.5)), zorder=4.3)
    longest = max((_longest(pushes, each) for each in VIEWS.values()), default=0.0)
    sizes = force_sizes(pushes.forces, [each.axes for each in VIEWS.values()]) if pushes.forces else None
    for entries, colour, words in pushes.styles(view):
        if longest > 0.0 and entries:
            reach = FORCE_SHARE * size / longest
            shown += [np.array([f["point"], np.asarray(f["point"]) + reach * np.asarray(f["force"])])[:, view.axes] for f in entries]
            add_forces(ax, entries, around(body), color=colour, words=words, axes=view.axes, longest=longest,
                       share=FORCE_SHARE * size / around(body).span, size=sizes if colour == PURPLE else None)  # fmt: skip
    add_com(ax, com)
    label_axes(ax, (AXIS_WORDS[view.axes[0]], AXIS_WORDS[view.axes[1]]))
    if named:
        ax.annotate(view.words, (0.0, 1.0), (0.0, 2.5), xycoords="axes fraction", textcoords="offset points", ha="left", va="bottom",
                    fontsize=7.0, color=GREY, annotation_clip=False)  # fmt: skip
    return around(np.vstack(shown)).grown(RIM_SHARE * size)


def _entries(forces: Iterable[Mapping[str, Any]] | PointForces | None) -> list[Mapping[str, Any]]:
    return [] if forces is None else list(forces.entries() if isinstance(forces, PointForces) else forces)


def _longest(pushes: Pushes, view: View) -> float:
    arrows = [f["force"] for entries, _, _ in pushes.styles(view) for f in entries]
    return max((float(np.linalg.norm(np.asarray(force)[list(view.axes)])) for force in arrows), default=0.0)
