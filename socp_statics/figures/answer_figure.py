"""One figure for each answer: contacts, base of support, regions, centre of mass, and the motion or the forces."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from socp_statics.cases.writing import finished_or_absent
from socp_statics.cones.choice import KINDS, ConeChoice
from socp_statics.contacts import ContactSet, contact_from_statement
from socp_statics.exceptions import InputError
from socp_statics.figures.draw_motion import add_motion
from socp_statics.figures.draw_region import add_base_of_support, add_com_margin, add_rays, add_region
from socp_statics.figures.draw_stance import AXIS_WORDS, add_com_or_direction, add_contacts, add_forces
from socp_statics.figures.layout import SHEET_AXES, Words, arrange, new_axes, shaped_for_sheet, sheet_of
from socp_statics.figures.place_names import place_names, with_room_for_names
from socp_statics.figures.quantities import force_text, length_text
from socp_statics.figures.region_shape import RegionShape, shape_in_record, shape_of_region
from socp_statics.figures.style import BLACK, GREEN, GREY, PURPLE, VERMILLION, house_style
from socp_statics.figures.window import Window, around, choose_window, inside, label_axes, show_window
from socp_statics.regions import SupportRegion, base_of_support
from socp_statics.regions.polygon import area
from socp_statics.spatial import Array

# a creation date would make every file different
METADATA: dict[str, dict[str, Any]] = {".pdf": {"CreationDate": None}, ".png": {}, ".svg": {"Date": None}}
VERDICT_COLOURS = {"stable": GREEN, "unstable": VERMILLION, "undecided": GREY}
GRAVITY_W = (0.0, 0.0, -9.81)


class Answer(NamedTuple):
    """What a record holds that can be drawn; world axes, SI."""

    contacts: ContactSet
    com: Array
    weight: Array
    loads: list[dict[str, Any]]
    forces: list[Mapping[str, Any]]
    motion: Mapping[str, Any] | None
    shapes: dict[str, RegionShape]
    asked: RegionShape | None

    @property
    def com_margin(self) -> float | None:
        """Margin of the centre of mass in the region of the cones that were asked for [m]."""
        return None if self.asked is None else self.asked.com_margin


def save_figure(record: Mapping[str, Any], path: str | os.PathLike[str], regions: Mapping[str, SupportRegion] | None = None) -> None:
    """Draw an answer into a file; the same record gives the same bytes.

    Args:
        record: The record.
        path: A name that ends in .pdf, .png or .svg; the file is complete or not there.
        regions: Regions of `socp_statics.comparison.compare_regions`, drawn beside the record's own.

    Raises:
        InputError: The name ends otherwise.
        OSError: The file cannot be written.
    """
    target = Path(path)
    ending = target.suffix.lower()
    if ending not in METADATA:
        raise InputError(f"figure {target}: a file that ends in {', '.join(METADATA)} is expected", name=str(target), field="path")
    with house_style():
        figure = answer_figure(record, regions)
        metadata = METADATA[ending] | {"Title": _title(record)}
        with finished_or_absent(target) as draft:
            figure.savefig(draft, format=ending[1:], metadata=metadata)


def answer_figure(record: Mapping[str, Any], regions: Mapping[str, SupportRegion] | None = None) -> Figure:
    """The figure of an answer, one column wide.

    Args:
        record: The record.
        regions: Regions of `socp_statics.comparison.compare_regions`, drawn beside the record's own.

    Returns:
        The figure: the floor plan and, where the record has no region, a side view with the forces.
    """
    answer = _answer(record, regions)
    with house_style():
        from_the_side = "region" not in record
        plan = new_axes(2 if from_the_side else 1)
        figure = sheet_of(plan)
        panels = [(plan, _add_plan(plan, answer, 2 if from_the_side else 1))]
        if from_the_side:
            panels.append((figure.axes[1], _add_side(figure.axes[1], answer)))
        arrange(figure, panels, _title(record), _words(record, answer, panels[0][1]))
        for ax, axes in zip(figure.axes, ((0, 1), (_across(answer), 2)), strict=False):
            place_names(ax, {c.name: c.points_W[:, axes] for c in answer.contacts})
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
    answer = _answer(record, None)
    with house_style():
        show_window(ax, _add_plan(ax, answer))
        place_names(ax, {c.name: c.points_W[:, :2] for c in answer.contacts})
    return ax


def _answer(record: Mapping[str, Any], regions: Mapping[str, SupportRegion] | None) -> Answer:
    case = record["case"]
    generated, posture = case["generated"], case.get("posture", {})
    shapes = {kind: shape_of_region(region) for kind, region in (regions or {}).items()}
    own = shape_in_record(record)
    if own is not None:
        shapes[own.cone.kind] = own
    cone = record["cone"]
    asked = own or next((s for s in shapes.values() if s.cone == ConeChoice(cone["kind"], cone["sides"], cone["heading"])), None)
    certificate = record.get("certificate") or {}
    mass = float(generated["mass"])
    return Answer(
        contacts=ContactSet(contact_from_statement(entry) for entry in generated["contacts"]),
        com=np.array(generated["com"], dtype=float),
        weight=mass * np.array(posture.get("gravity", GRAVITY_W), dtype=float),
        loads=[w for w in posture.get("external_wrenches", []) if w.get("point") is not None and any(w.get("force", ()))],
        forces=list(record.get("forces") or []),
        motion=certificate if certificate.get("kind") == "motion" else None,
        shapes={kind: shapes[kind] for kind in KINDS if kind in shapes},
        asked=asked,
    )


def _title(record: Mapping[str, Any]) -> str:
    return str(record.get("problem") or record["model"])


def _add_plan(ax: Axes, answer: Answer, panels: int = 1) -> Window:
    """The floor plan; returns what it has to show."""
    points, shapes = answer.contacts.points_W[:, :2], answer.shapes
    others = np.array([answer.com[:2], *(load["point"][:2] for load in answer.loads)], dtype=float)
    drawn = [s for s in shapes.values() if len(s.inner)]
    bounded = [s.inner for s in drawn if s.kind != "unbounded"]
    window = choose_window(points, others, bounded, [s.inner for s in drawn if s.kind == "unbounded"])
    window = with_room_for_names(shaped_for_sheet(window, panels), {c.name: c.points_W[:, :2] for c in answer.contacts}, SHEET_AXES)
    window = shaped_for_sheet(window, panels)
    filled = "exact" if "exact" in shapes else next(iter(shapes), None)
    for kind, shape in shapes.items():
        add_region(ax, shape, filled=kind == filled)
    add_base_of_support(ax, base_of_support(answer.contacts))
    if filled is not None:
        add_rays(ax, shapes[filled], window)
    add_contacts(ax, answer.contacts, window)
    add_com_or_direction(ax, answer.com[:2], window)
    if answer.asked is not None and answer.com_margin is not None:
        add_com_margin(ax, answer.com[:2], answer.com_margin, answer.asked.inner, window)
    if answer.motion is not None:
        window = add_motion(ax, answer.motion, answer.contacts, answer.com, window)
    add_forces(ax, answer.loads, window, color=BLACK, words="load")
    label_axes(ax)
    return window


def _add_side(ax: Axes, answer: Answer) -> Window:
    """The view from the side; returns what it has to show."""
    points = np.vstack([answer.contacts.points_W, answer.com])
    across = _across(answer)
    axes = (across, 2)
    flat = points[:, axes]
    window = around(flat)
    size = max(window.span, 1e-3 * answer.contacts.size)
    weight = {"point": answer.com, "force": answer.weight}
    longest = max(float(np.linalg.norm(np.asarray(f["force"])[list(axes)])) for f in [*_merged(answer.forces, axes), *answer.loads, weight])
    window = window.grown(0.06 * size)
    room = [flat]
    for f in [*_merged(answer.forces, axes), *answer.loads, weight]:
        start = np.asarray(f["point"], dtype=float)[list(axes)]
        room.append(np.array([start, start + 0.3 * window.span * np.asarray(f["force"], dtype=float)[list(axes)] / (longest or 1.0)]))
    shown = around(np.vstack(room)).grown(0.08 * size)
    scale: dict[str, Any] = {"axes": axes, "longest": longest, "share": 0.3 * window.span / shown.span}
    add_contacts(ax, answer.contacts, shown, axes, normals=not answer.forces)
    add_com_or_direction(ax, answer.com[list(axes)], shown)
    if answer.motion is not None:
        shown = add_motion(ax, answer.motion, answer.contacts, answer.com, shown, axes)
    add_forces(ax, _merged(answer.forces, axes), shown, color=PURPLE, words="forces up to", **scale)
    add_forces(ax, [weight], shown, color=GREY, words="weight", **scale)
    add_forces(ax, answer.loads, shown, color=BLACK, words="load", **scale)
    label_axes(ax, (AXIS_WORDS[across], AXIS_WORDS[2]))
    return shown


def _merged(forces: list[Mapping[str, Any]], axes: tuple[int, int]) -> list[dict[str, Any]]:
    """Forces whose points lie behind each other from the side, added up."""
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


def _across(answer: Answer) -> int:
    """The horizontal axis that tells more: of the motion, else of the loads, else of the contacts and the centre of mass."""
    if answer.motion is not None:
        linear, angular, point = (np.asarray(answer.motion[key], dtype=float) for key in ("linear", "angular", "point"))
        tell = np.abs(linear + np.cross(angular, answer.com - point))
    else:
        tell = np.abs(sum((np.asarray(load["force"], dtype=float) for load in answer.loads), np.zeros(3)))
    if not tell[:2].max() > 1e-6 * np.linalg.norm(answer.weight if answer.motion is None else tell):
        tell = np.ptp(np.vstack([answer.contacts.points_W, answer.com]), axis=0)
    return 0 if tell[0] >= tell[1] else 1


def _words(record: Mapping[str, Any], answer: Answer, window: Window) -> list[Words]:
    """Verdict, margins, and why."""
    verdict, reason = record["verdict"], record.get("reason")
    parts = [verdict + (f" ({reason})" if reason else "")]
    margin = record.get("margin")
    if margin is not None:
        parts.append(f"margin {_newtons(margin, answer)}")
    if record.get("idle"):
        rest = record.get("idle_margin")
        parts.append(f"{', '.join(record['idle'])} idle" + ("" if rest is None else f", margin of the others {_newtons(rest, answer)}"))
    if answer.com_margin is not None:
        parts.append("CoM margin " + (length_text(answer.com_margin) if np.isfinite(answer.com_margin) else _endless("inf")))
    out = [Words("; ".join(parts), VERDICT_COLOURS.get(verdict, BLACK), "bold")]
    if answer.motion is not None and answer.motion.get("reading"):
        out.append(Words(answer.motion["reading"]))
    notes = [f"the {kind} region is empty" for kind, shape in answer.shapes.items() if shape.kind == "empty"]
    if len(notes) == len(KINDS):
        notes = ["the region is empty, with pyramids too"]
    beyond = []
    for kind, shape in answer.shapes.items():
        part = inside(shape.outer, window) if shape.kind == "polygon" else shape.outer
        if shape.kind == "polygon" and area(part) < 0.999 * area(shape.outer):
            beyond.append(kind)
    if beyond:
        notes.append(f"{' and '.join(beyond)} region{'s go' if len(beyond) > 1 else ' goes'} on beyond this view")
    return out + [Words("; ".join(notes))] if notes else out


def _newtons(value: Any, answer: Answer) -> str:
    """A margin, where less than the boundary of the verdict is nothing."""
    if isinstance(value, str):
        return _endless(value)
    return force_text(value if abs(value) > 1e-7 * np.linalg.norm(answer.weight) else 0.0)


def _endless(word: str) -> str:
    return {"inf": "\N{INFINITY}", "-inf": "\N{MINUS SIGN}\N{INFINITY}"}.get(word, word)
