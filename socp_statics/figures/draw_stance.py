"""Contacts and stances seen from above, or from the side."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from socp_statics.contacts import Contact, ContactSet, Stance
from socp_statics.figures.layout import SHEET_AXES, new_axes, show_alone_or_in
from socp_statics.figures.marks import add_arrow, add_com, add_dots, add_filled, add_line
from socp_statics.figures.place_names import place_names, with_room_for_names
from socp_statics.figures.quantities import force_text
from socp_statics.figures.style import BLACK, GREY, PURPLE, SOLE, house_style
from socp_statics.figures.window import Window, choose_window, label_axes
from socp_statics.regions.polygon import width
from socp_statics.spatial import Array

PLAN = (0, 1)
AXIS_WORDS = ("x [m]", "y [m]", "z [m]")
LEVEL = 0.02


def draw_stance(
    stance: Stance | ContactSet | Iterable[Contact], ax: Axes | None = None, *, forces: Iterable[Mapping[str, Any]] = ()
) -> Axes:
    """Draw contacts seen from above: soles with names, points, lines, handles, the centre of mass of a stance, its loads.

    Args:
        stance: The stance, or contacts.
        ax: Axes to draw into, the view grows as needed; by default those of a new figure with a legend.
        forces: Point forces as in a record ("point", "force"), drawn as their projections on the floor.

    Returns:
        The axes, equal and in metres.
    """
    whole = stance if isinstance(stance, Stance) else None
    contacts = whole.contacts if whole else stance if isinstance(stance, ContactSet) else ContactSet(stance)  # type: ignore[arg-type]
    com = np.zeros((0, 2)) if whole is None else np.array([whole.com[:2]])
    named = {c.name: c.points_W[:, :2] for c in contacts}
    window = with_room_for_names(choose_window(contacts.points_W[:, :2], com, [], []), named, SHEET_AXES)
    with house_style():
        own = new_axes() if ax is None else ax
        add_contacts(own, contacts, window)
        if whole is not None and window.holds(com[0]):
            add_com(own, com[0])
        pushes = [] if whole is None else [{"point": w.point, "force": w.force} for w in whole.external_wrenches if w.point is not None]
        add_forces(own, list(forces), window, color=PURPLE, words="forces up to")
        add_forces(own, pushes, window, color=GREY, words="load")
        label_axes(own)
        show_alone_or_in(own, ax, window)
        place_names(own, named)
    return own


def add_contacts(ax: Axes, contacts: Iterable[Contact], window: Window, axes: tuple[int, int] = PLAN, *, normals: bool = True) -> None:
    """Add contacts, projected on two of the world axes.

    Args:
        ax: The axes.
        contacts: The contacts.
        window: What the figure shows.
        axes: The two world axes; (0, 1) looks from above.
        normals: Whether to add short arrows along the normals (seen from above along those that lean).
    """
    said: set[str] = set()
    for contact in contacts:
        points = contact.points_W[:, axes]
        label = once(contact_words(contact), said)
        if not contact.unilateral:
            add_dots(ax, points, "s", 5.0, markerfacecolor=SOLE, markeredgecolor="#333333", zorder=2.2, label=label)
        elif len(points) > 2 and width(points - points[0]) > 1e-6 * window.span:
            face = "none" if contact.frictionless else (*(int(SOLE[k : k + 2], 16) / 255 for k in (1, 3, 5)), 0.75)
            add_filled(ax, points, facecolor=face, edgecolor="#333333", linewidth=0.8, zorder=2.0, label=label)
        elif len(points) > 1 and float(np.ptp(points, axis=0).max()) > 1e-6 * window.span:
            add_line(ax, _ends(points), linewidth=2.2, solid_capstyle="round", label=label, color="#333333", zorder=2.2)
        else:
            face = "white" if contact.frictionless else "#333333"
            add_dots(ax, points[:1], "o", 4.0, markerfacecolor=face, markeredgecolor="#333333", zorder=2.4, label=label)
        lean = contact.normal_W[list(axes)]
        if normals and (axes != PLAN or float(np.linalg.norm(lean)) > LEVEL):
            start = contact.points_W.mean(axis=0)[list(axes)]
            head = start + 0.11 * window.span * lean
            add_arrow(ax, start, head, head_size=5.0, color="#333333", linewidth=0.7, zorder=2.5, label=once("contact normal", said))


def contact_words(contact: Contact) -> str:
    """What the legend calls a contact."""
    return "handle" if not contact.unilateral else "contact without friction" if contact.frictionless else "contact"


def once(words: str, said: set[str]) -> str | None:
    """A label for the first of its kind, none for those that follow."""
    if words in said:
        return None
    said.add(words)
    return words


def _ends(points: Array) -> Array:
    """The two farthest of some points on a line."""
    away = np.linalg.norm(points[:, None] - points[None], axis=2)
    return points[list(np.unravel_index(int(np.argmax(away)), away.shape))]


def add_forces(
    ax: Axes,
    forces: Iterable[Mapping[str, Any]],
    window: Window,
    *,
    color: str,
    words: str,
    axes: tuple[int, int] = PLAN,
    longest: float | None = None,
    share: float = 0.22,
    size: str | None = None,
) -> None:
    """Add forces as arrows from their points, the longest a fixed share of the view.

    Args:
        ax: The axes.
        forces: Mappings with "point" [m] and "force" [N], shape (3,) each.
        window: What the figure shows.
        color: Of the arrows.
        words: For the legend, which adds a size.
        axes: The two world axes they are projected on.
        longest: The force drawn longest; by default the largest of these, projected [N].
        share: Length of that force over the span of the view.
        size: What the legend says of the sizes, of `force_sizes`; by default the largest of these.
    """
    entries = [(np.asarray(f["point"], dtype=float)[list(axes)], np.asarray(f["force"], dtype=float)) for f in forces]
    sizes = [float(np.linalg.norm(f[list(axes)])) for _, f in entries]
    scale = longest or max(sizes, default=0.0)
    if not entries or not scale > 0.0:
        return
    label: str | None = f"{words} {size or force_text(max(float(np.linalg.norm(f)) for _, f in entries))}"
    for (point, force), length in zip(entries, sizes, strict=True):
        if length > 0.02 * scale:
            head = point + share * window.span * force[list(axes)] / scale
            add_arrow(ax, point, head, color=color, linewidth=1.1, zorder=5.0, label=label)
            label = None


def force_sizes(forces: Iterable[Mapping[str, Any]], views: Iterable[tuple[int, int]]) -> str:
    """Sizes of point forces for the legend: the largest, and the largest arrow where arrows are sums of forces that coincide in a view.

    Args:
        forces: Mappings with "point" [m] and "force" [N], shape (3,) each, at least one.
        views: The two world axes of each drawing plane.
    """
    entries = list(forces)
    alone = max(float(np.linalg.norm(f["force"])) for f in entries)
    summed = max(float(np.linalg.norm(f["force"])) for axes in views for f in merged(entries, axes))
    return force_text(alone) + (f",\nsums up to {force_text(summed)}" if summed > (1.0 + 1e-6) * alone else "")


def merged(forces: Iterable[Mapping[str, Any]], axes: tuple[int, int]) -> list[dict[str, Any]]:
    """Forces whose points lie behind each other in a view, added up.

    Args:
        forces: Mappings with "point" [m] and "force" [N], shape (3,) each.
        axes: The two world axes of the drawing plane.

    Returns:
        Mappings of the same keys.
    """
    out: list[dict[str, Any]] = []
    for f in forces:
        point, force = np.asarray(f["point"], dtype=float), np.asarray(f["force"], dtype=float)
        for other in out:
            if np.abs((other["point"] - point)[list(axes)]).max() <= 1e-9 * (1.0 + np.abs(point).max()):
                other["force"] = other["force"] + force
                break
        else:
            out.append({"point": point, "force": force})
    return out


def add_com_or_direction(ax: Axes, com: Array, window: Window) -> None:
    """Add the centre of mass, or where it lies far outside the view, an arrow that points to it."""
    if window.holds(com):
        add_com(ax, com)
        return
    centre = np.array([0.5 * (window.x_min + window.x_max), 0.5 * (window.y_min + window.y_max)])
    way = com - centre
    away = float(np.linalg.norm(way))
    half = 0.5 * np.array([window.width, window.height])
    reach = float((half / np.maximum(np.abs(way / away), 1e-12)).min())
    head = centre + 0.97 * reach * way / away
    tail = head - 0.15 * window.span * way / away
    add_arrow(ax, tail, head, color=BLACK, linewidth=1.2, zorder=6.0, label=f"CoM {away:.3g} m this way")
