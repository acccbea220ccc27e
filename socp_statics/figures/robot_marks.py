"""What a view of a robot is made of: its body, the ground, its contacts with their friction cones."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb

from socp_statics.colours import EDGE, FLAT_PART, GROUND, ROUND_PART, SOLE_LINE
from socp_statics.contacts import Contact
from socp_statics.figures.draw_stance import contact_words, once
from socp_statics.figures.marks import add_dots, add_filled, add_line
from socp_statics.figures.outlines import Body, View, back_to_front, disc, hull, outline
from socp_statics.figures.style import ORANGE
from socp_statics.postures import Posture
from socp_statics.spatial import Array

FADING = 0.5
BELOW = 100.0
LEVEL = 1e-6


def add_body(ax: Axes, posture: Posture, view: View) -> Array:
    """Add the primitive shapes of a robot, what is farther lighter; a robot with fewer shapes than joints as lines from joint to joint.

    Args:
        ax: The axes.
        posture: The posture.
        view: The view.

    Returns:
        Points that the view has to show, shape (n, 2) [m].
    """
    if len(posture.robot.shapes) < len(posture.robot.joints):
        return _add_skeleton(ax, posture, view)
    placed = {link: posture.link_placement(link) for link in dict.fromkeys(shape.link for shape in posture.robot.shapes)}
    bodies = []
    for shape in posture.robot.shapes:
        R_WF, p_WF = placed[shape.link]
        bodies.append(Body(shape, R_WF @ shape.rotation, p_WF + R_WF @ shape.position))
    outlines = [outline(body, view) for body in bodies]
    depth = np.array([body.p_WS @ view.toward for body in bodies])
    away = (depth.max() - depth) / max(float(np.ptp(depth)), 1e-9)
    for rank, k in enumerate(back_to_front(bodies, outlines, view)):
        fade = FADING * float(away[k])
        face = FLAT_PART if bodies[k].shape.kind == "box" else ROUND_PART
        style = {"facecolor": _paler(face, fade), "edgecolor": _paler(EDGE, fade), "linewidth": 0.6, "joinstyle": "round"}
        add_filled(ax, outlines[k], zorder=1.5 + rank / len(bodies), **style)
    return np.vstack(outlines)


def _paler(colour: str, share: float) -> tuple[float, float, float]:
    """A colour with a share of white."""
    red, green, blue = ((1.0 - share) * part + share for part in to_rgb(colour))
    return (red, green, blue)


def robot_bones(posture: Posture) -> list[tuple[Array, Array]]:
    """Lines between joints, and from the last ones to where the robot can touch: pairs of ends, world axes, shape (3,) each [m]."""
    robot, model = posture.robot, posture.robot.pin_model
    where = [posture.link_placement(name)[1] for name in list(model.names)[1:]]
    bones = [(where[model.parents[k] - 1], where[k - 1]) for k in range(2, model.njoints)]
    for frame in robot.frames.values():
        R_WF, p_WF = posture.link_placement(frame.frame)
        carrier = model.frames[robot.frame_id(frame.frame)].parentJoint
        bones.append((where[carrier - 1], p_WF + R_WF @ frame.position))
    return bones


def _add_skeleton(ax: Axes, posture: Posture, view: View) -> Array:
    """Lines between joints, and from the last ones to where the robot can touch."""
    points = []
    for ends in robot_bones(posture):
        flat = np.array(ends)[:, view.axes]
        points.append(flat)
        add_line(ax, flat, color=ROUND_PART, linewidth=2.4, solid_capstyle="round", zorder=1.6)
        add_dots(ax, flat[:1], "o", 3.6, markerfacecolor="white", markeredgecolor=EDGE, markeredgewidth=0.7, zorder=1.7)
    return np.vstack(points)


def add_ground(ax: Axes, contacts: list[Contact], size: float, view: View) -> None:
    """Add what carries the contacts: the ground below level ones at the lowest height, short pieces elsewhere.

    Args:
        ax: The axes.
        contacts: The contacts, one at least.
        size: Extent of the robot [m].
        view: The view.
    """
    lowest = min(float(c.points_W[:, 2].min()) for c in contacts)
    grounded = [c for c in contacts if _is_ground(c, lowest, size)]
    if grounded:
        across = ax.get_yaxis_transform()
        band = np.array([[0.0, lowest], [1.0, lowest], [1.0, lowest - BELOW * size], [0.0, lowest - BELOW * size]])
        add_filled(ax, band, facecolor=GROUND, edgecolor="none", zorder=0.5, transform=across)
        add_line(ax, band[:2], color=EDGE, linewidth=0.8, zorder=1.4, transform=across)
    for contact in contacts:
        normal = contact.normal_W[list(view.axes)]
        edge_on = abs(float(contact.normal_W @ view.toward)) < LEVEL
        if contact not in grounded and contact.unilateral and edge_on:
            middle = contact.points_W.mean(axis=0)[list(view.axes)]
            along = 0.09 * size * np.array([-normal[1], normal[0]])
            along = along + np.sign(along) * 0.5 * np.ptp(contact.points_W[:, view.axes], axis=0)
            thick = -0.025 * size * normal
            corners = np.array([middle - along, middle + along, middle + along + thick, middle - along + thick])
            add_filled(ax, corners, facecolor=GROUND, edgecolor="none", zorder=0.6)
            add_line(ax, corners[:2], color=EDGE, linewidth=0.8, zorder=1.4)


def _is_ground(contact: Contact, lowest: float, size: float) -> bool:
    level = float(contact.normal_W[2]) > 1.0 - LEVEL
    return contact.unilateral and level and float(contact.points_W[:, 2].min()) < lowest + LEVEL * size


def add_touching(ax: Axes, contacts: list[Contact], size: float, view: View) -> None:
    """Add the contacts: soles as their outlines, lines on edge; points as dots, handles as squares."""
    said: set[str] = set()
    for contact in contacts:
        points = contact.points_W[:, view.axes]
        label = once(contact_words(contact), said)
        if len(points) > 1 and float(np.ptp(points, axis=0).max()) > LEVEL * size:
            around = hull(points) if len(points) > 2 else points
            add_line(ax, around, closed=len(around) > 2, color=SOLE_LINE, linewidth=1.8, zorder=4.2, label=label,
                     solid_capstyle="butt")  # fmt: skip
        else:
            face = SOLE_LINE if contact.unilateral and not contact.frictionless else "white"
            style = {"markerfacecolor": face, "markeredgecolor": SOLE_LINE, "markeredgewidth": 0.8, "zorder": 4.2}
            add_dots(ax, points[:1], "o" if contact.unilateral else "s", 3.6, label=label, **style)


def add_cones(ax: Axes, contacts: list[Contact], length: float, view: View) -> Array:
    """Add the friction cones at the contact points: exact cones of half angle atan mu, as far as a fixed slant length.

    Args:
        ax: The axes.
        contacts: The contacts; handles have no cone, contacts without friction their normal.
        length: From the apex to the rim [m].
        view: The view.

    Returns:
        Points that the view has to show, shape (n, 2) [m].
    """
    label: str | None = "friction cone"
    seen: list[Array] = [np.zeros((0, 2))]
    for contact in contacts:
        if not contact.unilateral:
            continue
        for apex in contact.points_W:
            slope = np.hypot(1.0, contact.friction)
            rim = disc(apex + length / slope * contact.normal_W, contact.normal_W, length * contact.friction / slope, view)
            cone = hull(np.vstack([apex[list(view.axes)], rim]))
            if any(len(cone) == len(other) and np.abs(cone - other).max() < LEVEL * length for other in seen):
                continue
            seen.append(cone)
            if len(cone) > 2:
                add_filled(ax, cone, facecolor=ORANGE, alpha=0.22, edgecolor="none", zorder=4.0)
            add_line(ax, cone, closed=True, color=ORANGE, linewidth=0.7, zorder=4.1, label=label, solid_joinstyle="round")
            add_line(ax, rim, closed=True, color=ORANGE, linewidth=0.5, zorder=4.1)
            label = None
    return np.vstack(seen)
