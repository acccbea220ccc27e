"""The view of an answer from the side, where there is no robot to be drawn."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from socp_statics.figures.answer_content import Answer
from socp_statics.figures.draw_motion import add_motion
from socp_statics.figures.draw_stance import AXIS_WORDS, add_com_or_direction, add_contacts, add_forces, force_sizes, merged
from socp_statics.figures.style import BLACK, GREY, PURPLE
from socp_statics.figures.window import Window, around, label_axes


def add_side(ax: Axes, answer: Answer) -> Window:
    """Add contacts, forces and motion seen along a horizontal axis; returns what the axes have to show."""
    points = np.vstack([answer.contacts.points_W, answer.com])
    across = across_axis(answer)
    axes = (across, 2)
    flat = points[:, axes]
    window = around(flat)
    size = max(window.span, 1e-3 * answer.contacts.size)
    weight = {"point": answer.com, "force": answer.weight}
    longest = max(float(np.linalg.norm(np.asarray(f["force"])[list(axes)])) for f in [*merged(answer.forces, axes), *answer.loads, weight])
    window = window.grown(0.06 * size)
    room = [flat]
    for f in [*merged(answer.forces, axes), *answer.loads, weight]:
        start = np.asarray(f["point"], dtype=float)[list(axes)]
        room.append(np.array([start, start + 0.3 * window.span * np.asarray(f["force"], dtype=float)[list(axes)] / (longest or 1.0)]))
    shown = around(np.vstack(room)).grown(0.08 * size)
    scale: dict[str, Any] = {"axes": axes, "longest": longest, "share": 0.3 * window.span / shown.span}
    add_contacts(ax, answer.contacts, shown, axes, normals=not answer.forces)
    add_com_or_direction(ax, answer.com[list(axes)], shown)
    if answer.motion is not None:
        shown = add_motion(ax, answer.motion, answer.contacts, answer.com, shown, axes, answer.posture)
    if answer.forces:
        sizes = force_sizes(answer.forces, [axes])
        add_forces(ax, merged(answer.forces, axes), shown, color=PURPLE, words="forces up to", size=sizes, **scale)
    add_forces(ax, [weight], shown, color=GREY, words="weight", **scale)
    add_forces(ax, answer.loads, shown, color=BLACK, words="load", **scale)
    label_axes(ax, (AXIS_WORDS[across], AXIS_WORDS[2]))
    return shown


def across_axis(answer: Answer) -> int:
    """The horizontal axis that tells more: of the motion, else of the loads, else of the contacts and the centre of mass."""
    if answer.motion is not None:
        linear, angular, point = (np.asarray(answer.motion[key], dtype=float) for key in ("linear", "angular", "point"))
        tell = np.abs(linear + np.cross(angular, answer.com - point))
    else:
        tell = np.abs(sum((np.asarray(load["force"], dtype=float) for load in answer.loads), np.zeros(3)))
    if not tell[:2].max() > 1e-6 * np.linalg.norm(answer.weight if answer.motion is None else tell):
        tell = np.ptp(np.vstack([answer.contacts.points_W, answer.com]), axis=0)
    return 0 if tell[0] >= tell[1] else 1
