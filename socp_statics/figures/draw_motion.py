"""The motion that proves "unstable": which way everything moves, and the axis it turns about."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from socp_statics.certificates import MotionCertificate
from socp_statics.certificates.velocities import velocities
from socp_statics.contacts import ContactSet, Stance
from socp_statics.figures.draw_stance import PLAN, add_contacts
from socp_statics.figures.layout import Words, new_axes, show_alone_or_in
from socp_statics.figures.marks import DOWN, OVER, UP, add_arrow, add_com, add_dots, add_line
from socp_statics.figures.place_names import place_names
from socp_statics.figures.style import VERMILLION, house_style
from socp_statics.figures.window import Window, around, choose_window, label_axes
from socp_statics.postures import Posture
from socp_statics.spatial import Array

NOTHING = 0.02
SHARE = 0.2


def draw_motion(motion: MotionCertificate | Mapping[str, Any], stance: Stance, ax: Axes | None = None) -> Axes:
    """Draw the certificate motion of an unstable answer on the floor plan.

    Args:
        motion: The certificate, or the "certificate" of a record.
        stance: What moves.
        ax: Axes to draw into, the view grows as needed; by default those of a new figure with a legend.

    Returns:
        The axes, equal and in metres.
    """
    entry = motion.as_record() if isinstance(motion, MotionCertificate) else motion
    window = choose_window(stance.contacts.points_W[:, :2], np.array([stance.com[:2]]), [], [])
    with house_style():
        own = new_axes() if ax is None else ax
        add_contacts(own, stance.contacts, window)
        add_com(own, stance.com[:2])
        window = add_motion(own, entry, stance.contacts, stance.com, window, posture=stance.posture)
        label_axes(own)
        show_alone_or_in(own, ax, window, words=[Words(entry["reading"], VERMILLION)])
        place_names(own, {c.name: c.points_W[:, :2] for c in stance.contacts})
    return own


def add_motion(
    ax: Axes,
    motion: Mapping[str, Any],
    contacts: ContactSet,
    com: Array,
    window: Window,
    axes: tuple[int, int] = PLAN,
    posture: Posture | None = None,
    to_scale: bool = False,
) -> Window:
    """Add velocities of the contact points and of the centre of mass, and the axis of rotation of a rigid motion.

    Args:
        ax: The axes.
        motion: Mapping with "linear" [m/s], "angular" [rad/s] and "point" [m], world axes, and "joints" [rad/s] where joints move.
        contacts: The contacts.
        com: Centre of mass, shape (3,) [m].
        window: What the figure shows.
        axes: The two world axes of the drawing plane; (0, 1) looks from above.
        posture: The posture; without it nothing is drawn of a motion in which joints move.

        to_scale: Whether an arrow of the fastest velocity in space has the fixed length, so that views can be compared; else the
            longest arrow has it.

    Returns:
        The window, grown where an arrow needs it.
    """
    joints = motion.get("joints") or {}
    if joints and posture is None:
        return window
    linear, angular, point = (np.asarray(motion[key], dtype=float) for key in ("linear", "angular", "point"))
    bodies = np.vstack([contacts.points_W, com])
    velocity = velocities(motion, contacts, com, posture)
    fastest = float(np.linalg.norm(velocity, axis=1).max())
    if not fastest > 0.0:
        return window
    flat = velocity[:, axes]
    longest = fastest if to_scale else float(np.linalg.norm(flat, axis=1).max())
    label: str | None = "certified motion"
    seen = [np.array([[window.x_min, window.y_min], [window.x_max, window.y_max]])]
    for body, v in zip(bodies[:, axes], flat, strict=True):
        if np.linalg.norm(v) > NOTHING * fastest and window.holds(body):
            head = body + SHARE * window.span * v / longest
            add_arrow(ax, body, head, color=VERMILLION, linewidth=1.1, zorder=5.0, label=label)
            seen.append(head + 0.04 * window.span * np.array([[-1.0, -1.0], [1.0, 1.0]]))
            label = None
    window = around(np.vstack(seen))
    if axes == PLAN:
        _add_heave(ax, contacts.points_W, velocity[:-1, 2] / fastest)
    size = float(np.linalg.norm(bodies - bodies.mean(axis=0), axis=1).max())
    if not joints and np.linalg.norm(angular) * size > NOTHING * fastest:
        along = angular / np.linalg.norm(angular)
        words = "screw axis" if abs(float(linear @ along)) > NOTHING * fastest else "axis of rotation"
        _add_axis(ax, linear, angular, point, window, axes, words)
    return window


def _add_heave(ax: Axes, points: Array, rate: Array) -> None:
    """Signs for what moves towards the reader (a dot in a ring) and away (a cross in a ring)."""
    up, down = points[rate > NOTHING, :2], points[rate < -NOTHING, :2]
    ring = {"markerfacecolor": "white", "markeredgecolor": VERMILLION, "markeredgewidth": 0.9, "zorder": 5.2}
    for where, sign, size, words in ((up, "o", 1.6, UP), (down, "x", 3.2, DOWN)):
        if len(where):
            add_dots(ax, where, "o", 4.8, label=words, **ring)
            inner = {"markerfacecolor": VERMILLION, "markeredgecolor": VERMILLION, "markeredgewidth": 0.8, "zorder": 5.3}
            add_dots(ax, where, sign, size, label=OVER + words, **inner)


def _add_axis(ax: Axes, linear: Array, angular: Array, point: Array, window: Window, axes: tuple[int, int], words: str) -> None:
    """The axis of rotation: a line where it lies in the drawing plane, a dot where it stands on it; nothing where it is out of sight."""
    speed = float(np.linalg.norm(angular))
    through = (point + np.cross(angular, linear) / speed**2)[list(axes)]
    along = angular[list(axes)] / speed
    if np.linalg.norm(along) > 0.3:
        way = along / np.linalg.norm(along)
        centre = np.array([0.5 * (window.x_min + window.x_max), 0.5 * (window.y_min + window.y_max)])
        foot = through + float((centre - through) @ way) * way
        if not _crosses(foot, way, window):
            return
        ends = np.array([foot - 4.0 * window.span * way, foot + 4.0 * window.span * way])
        add_line(ax, ends, color=VERMILLION, linestyle=(0, (7, 1.5, 1.2, 1.5)), linewidth=1.0, zorder=4.5, label=words)
    elif window.holds(through):
        style = {"markerfacecolor": "none", "markeredgecolor": VERMILLION, "markeredgewidth": 1.0, "zorder": 4.5}
        add_dots(ax, through, "P", 5.0, label=words, **style)


def _crosses(foot: Array, way: Array, window: Window) -> bool:
    """Whether a line through a point, shape (2,), has corners of the window on both of its sides."""
    corners = np.array([(x, y) for x in (window.x_min, window.x_max) for y in (window.y_min, window.y_max)]) - foot
    beside = corners[:, 0] * way[1] - corners[:, 1] * way[0]
    return bool(beside.min() < 0.0 < beside.max())
