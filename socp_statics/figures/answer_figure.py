"""One figure for each answer: contacts, base of support, regions, centre of mass, and the motion or the forces."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from socp_statics.figures.answer_content import Answer, answer_of
from socp_statics.figures.answer_words import answer_words
from socp_statics.figures.draw_following import add_following
from socp_statics.figures.draw_motion import add_motion
from socp_statics.figures.draw_region import add_base_of_support, add_com_margin, add_rays, add_region
from socp_statics.figures.draw_robot import HEAD, Pushes, add_robot
from socp_statics.figures.draw_stance import add_com_or_direction, add_contacts, add_forces
from socp_statics.figures.draw_torques import add_torques
from socp_statics.figures.draw_window import add_window, window_in_record
from socp_statics.figures.figure_file import figure_path, write_figure
from socp_statics.figures.layout import SHEET_AXES, Bars, Row, arrange, new_axes, shaped_for_sheet, sheet_of
from socp_statics.figures.optimized_posture import optimized_posture
from socp_statics.figures.outlines import VIEWS
from socp_statics.figures.place_names import place_names, with_room_for_names
from socp_statics.figures.side_view import across_axis, add_side
from socp_statics.figures.style import BLACK, house_style
from socp_statics.figures.window import Window, choose_window, label_axes, show_window
from socp_statics.postures import Posture
from socp_statics.regions import SupportRegion, base_of_support


def save_figure(
    record: Mapping[str, Any],
    path: str | os.PathLike[str],
    regions: Mapping[str, SupportRegion] | None = None,
    posture: Posture | None = None,
) -> None:
    """Draw an answer into a file; the same record gives the same bytes.

    Args:
        record: The record.
        path: A name that ends in .pdf, .png or .svg; the file is complete or not there.
        regions: Regions of `socp_statics.comparison.compare_regions`, drawn beside the record's own.
        posture: The posture that the record is about, where it has a robot.

    Raises:
        InputError: The name ends otherwise.
        OSError: The file cannot be written.
    """
    target = figure_path(path)
    write_figure(answer_figure(record, regions, posture), target, _title(record))


def answer_figure(record: Mapping[str, Any], regions: Mapping[str, SupportRegion] | None = None, posture: Posture | None = None) -> Figure:
    """The figure of an answer, one column wide.

    Args:
        record: The record.
        regions: Regions of `socp_statics.comparison.compare_regions`, drawn beside the record's own.
        posture: The posture that the record is about, where it has a robot.

    Returns:
        The figure. From top to bottom: the floor plan; with a posture the robot from its side and from the front, else, where the
        record has no region, a view of the contacts from the side; the optimised posture where there is one; the joint torques where
        the record has any, those of the given posture; the internal-force window where there is one.
    """
    answer = answer_of(record, regions, posture)
    with house_style():
        with_side = posture is None and "region" not in record
        better = optimized_posture(record, posture)
        views = 4 if better is not None else 2 if posture is not None else int(with_side)
        internal = window_in_record(record)
        plan = new_axes(1 + views + bool(answer.torques) + (internal is not None))
        figure = sheet_of(plan)
        panels = 2 if views else 1
        shown = _add_plan(plan, answer, panels)
        rows: list[Row | Bars] = [Row((plan,), (shown,))]
        if posture is not None:
            rows.append(_add_robot(figure.axes[1:3], answer, posture, "" if better is None else ", given"))
            if better is not None:
                after = answer_of({**record, **record["optimized"], "certificate": None}, None, better)
                rows.append(_add_robot(figure.axes[3:5], after._replace(com=better.com_W), better, ", optimised"))
        elif with_side:
            rows.append(Row((figure.axes[1],), (add_side(figure.axes[1], answer),)))
        if answer.torques:
            rows.append(add_torques(figure.axes[1 + views], answer.torques))
        if internal is not None:
            rows.append(add_window(figure.axes[1 + views + bool(answer.torques)], internal))
        arrange(figure, rows, _title(record), answer_words(record, answer, shown))
        place_names(plan, {c.name: c.points_W[:, :2] for c in answer.contacts})
        if with_side:
            place_names(figure.axes[1], {c.name: c.points_W[:, (across_axis(answer), 2)] for c in answer.contacts})
    return figure


def draw_answer(record: Mapping[str, Any], ax: Axes | None = None) -> Axes:
    """Draw the floor plan of an answer.

    Args:
        record: The record.
        ax: Axes to draw into, the view grows as needed; by default those of a new figure with title, words and legend.

    Returns:
        The axes, equal and in metres.
    """
    if ax is None:
        return answer_figure(record).axes[0]
    answer = answer_of(record, None)
    with house_style():
        show_window(ax, _add_plan(ax, answer))
        place_names(ax, {c.name: c.points_W[:, :2] for c in answer.contacts})
    return ax


def _title(record: Mapping[str, Any]) -> str:
    return str(record.get("problem") or record["model"])


def _add_robot(axes: list[Axes], answer: Answer, posture: Posture, which: str = "") -> Row:
    """The robot from its side and from the front, with everything that pushes it and the motion that nothing prevents."""
    weight = [{"point": answer.com, "force": answer.weight}] if answer.forces or answer.loads else []
    pushes = Pushes(answer.forces, weight, answer.loads)
    windows = []
    for ax, view in zip(axes, VIEWS.values(), strict=True):
        window = add_robot(ax, posture, view._replace(words=view.words + which), pushes)
        if answer.motion is not None:
            window = add_motion(ax, answer.motion, answer.contacts, answer.com, window, view.axes, posture, to_scale=True)
        windows.append(window)
    return Row(tuple(axes), tuple(windows), HEAD)


def _add_plan(ax: Axes, answer: Answer, panels: int = 1) -> Window:
    """The floor plan; returns what it has to show."""
    points, shapes = answer.contacts.points_W[:, :2], answer.shapes
    others = np.array([answer.com[:2], *(load["point"][:2] for load in answer.loads)], dtype=float)
    drawn = [s for s in shapes.values() if len(s.inner)]
    bounded = [s.inner for s in drawn if s.kind != "unbounded"] + ([] if answer.following is None else [answer.following.ends])
    window = choose_window(points, others, bounded, [s.inner for s in drawn if s.kind == "unbounded"])
    window = with_room_for_names(shaped_for_sheet(window, panels), {c.name: c.points_W[:, :2] for c in answer.contacts}, SHEET_AXES)
    window = shaped_for_sheet(window, panels)
    filled = "exact" if "exact" in shapes else next(iter(shapes), None)
    for kind, shape in shapes.items():
        add_region(ax, shape, filled=kind == filled)
    add_base_of_support(ax, base_of_support(answer.contacts))
    if filled is not None:
        add_rays(ax, shapes[filled], window)
    if answer.following is not None:
        add_following(ax, answer.following)
    add_contacts(ax, answer.contacts, window)
    add_com_or_direction(ax, answer.com[:2], window)
    if answer.asked is not None and answer.com_margin is not None:
        add_com_margin(ax, answer.com[:2], answer.com_margin, answer.asked.inner, window)
    if answer.motion is not None:
        window = add_motion(ax, answer.motion, answer.contacts, answer.com, window, posture=answer.posture)
    add_forces(ax, answer.loads, window, color=BLACK, words="load")
    label_axes(ax)
    return window
