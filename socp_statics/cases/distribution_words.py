"""Wrench distributions and internal-force windows in a few lines for a person."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

HEADER = ("method", "share [%]", "CoP [mm]", "friction use", "outside cone [N]")
UNSUITABLE = "-"
NOTHING = 5e-4


def distribution_lines(record: Mapping[str, Any]) -> list[str]:
    """The table of methods.

    Per contact the share of the normal force, the centre of pressure and the use of friction; then how far the wrenches are outside their
    cones, and the worst joint torque where there is a robot.

    Args:
        record: Of model "wrench_distribution".
    """
    methods = record["distribution"]["methods"]
    contacts = [contact["name"] for contact in record["case"]["generated"]["contacts"] if contact["type"] != "handle"]
    with_torques = any(entry.get("worst_joint") for entry in methods.values())
    with_limits = any(entry.get("worst_share") is not None for entry in methods.values())
    header = [*HEADER, *(["worst torque [N m]"] if with_torques else [])]
    rows = [header]
    said: dict[str, list[str]] = {}
    for name, entry in methods.items():
        if entry.get("note"):
            said.setdefault(entry["note"], []).append(name)
        if "reserve" not in entry:
            rows.append([name, *[UNSUITABLE] * (len(header) - 1)])
            continue
        row = [
            name,
            _each(contacts, entry["normal_share"], lambda value: f"{_zero(100 * value):.1f}"),
            _each(contacts, entry["cop"], lambda value: ",".join(f"{_zero(1e3 * x):.1f}" for x in value)),
            _each(contacts, entry["friction_use"], lambda value: value if isinstance(value, str) else f"{value:.3f}"),
            _number(entry["cone_violation"]),
        ]
        if with_torques:
            share = f" ({100 * float(entry['worst_share']):.0f} %)" if with_limits and entry["worst_share"] is not None else ""
            row.append(f"{entry['worst_joint']} {entry['worst_torque']:.4g}{share}")
        rows.append(row)
    notes = [f"{', '.join(names)}: {note}" for note, names in said.items()]
    if len(methods) == 1:
        notes += [_internal(entry) for entry in next(iter(methods.values())).get("internal_forces", [])]
    widths = [max(len(row[i]) for row in rows) for i in range(len(header))]
    table = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows]
    return [f"in the order {', '.join(contacts)}", *table, *notes]


def window_lines(record: Mapping[str, Any]) -> list[str]:
    """The window: its interval, what stops it at either end, and the feasible set of two directions.

    Args:
        record: Of model "internal_force_window".
    """
    window, directions = record["window"], record["case"]["parameters"]["directions"]
    words = [" - ".join(d) if isinstance(d, list) else "direction " + str(i + 1) for i, d in enumerate(directions)]
    lines = []
    if window["lower"] is None:
        lines.append(f"no internal force along {words[0]} keeps the contacts in their cones and the torques in their limits")
    else:
        low, high = window["lower"], window["upper"]
        lines.append(f"{_newtons(low['value'])} to {_newtons(high['value'])} along {words[0]}, tension positive, others {window['others']}")
        for word, end in (("below", low), ("above", high)):
            if end["stopped_by"]:
                lines.append(f"{word} it gives way: {', '.join(end['stopped_by'])}")
    if "set" in window:
        found = window["set"]
        lines.append(f"with {words[1]}: {window['kind']}, area {found['inner_area']:.6g} in units of both, {found['solves']} programs")
    return lines


def _internal(entry: Mapping[str, Any]) -> str:
    force = entry["force"]
    word = "tension" if force > 0 else "compression"
    return f"internal force {' - '.join(entry['between'])} {abs(force) if abs(force) > NOTHING else 0.0:.4g} N ({word})"


def _each(contacts: list[str], values: Mapping[str, Any], words: Callable[[Any], str]) -> str:
    return " ".join(UNSUITABLE if values.get(name) is None else words(values[name]) for name in contacts)


def _zero(value: float) -> float:
    return 0.0 if abs(value) < 0.05 else value


def _number(value: Any) -> str:
    return value if isinstance(value, str) else "0" if abs(value) < NOTHING else f"{value:.3g}"


def _newtons(value: Any) -> str:
    return {"inf": "any tension", "-inf": "any compression"}[value] if isinstance(value, str) else f"{value:.6g} N"
