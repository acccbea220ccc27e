"""Measures of robustness in words: what may go wrong, by how much, on which side of the truth the number is, and what stops more."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

MEANINGS = {
    "push": "pushed in any horizontal direction at {point} m",
    "force": "any force at the CoM",
    "wrench": "any wrench about the CoM, moments over {length:g} m",
    "com": "CoM displaced in any direction",
    "tilt": "gravity tilted in any direction",
    "friction": "friction needed, as a multiple of what there is",
    "friction_interval": "least margin over the friction intervals",
    "mass_and_com": "ellipsoid of errors of mass and first moment, as a multiple of the one given",
    "push_ellipsoid": "largest ellipsoid of horizontal pushes at {point} m, mean radius",
    "moment_ellipsoid": "largest ellipsoid of moments, mean radius",
    "push_rule": "pushed in any horizontal direction at {point} m, forces by an affine rule",
    "placement": "every contact displaced in any direction",
}
SCALED = {"m": (1e3, "mm"), "1": (1.0, "")}


def robustness_lines(record: Mapping[str, Any]) -> list[str]:
    """One line a measure.

    Args:
        record: With ``robustness``.
    """
    return [f"{_meaning(name, entry)}: {_amount(entry)}" for name, entry in record["robustness"].items()]


def _meaning(name: str, entry: Mapping[str, Any]) -> str:
    point = f"[{', '.join(f'{round(v, 9) + 0.0:.4g}' for v in entry['point'])}]" if entry.get("point") else ""
    return MEANINGS[name].format(point=point, length=entry.get("length") or 1.0)


def _amount(entry: Mapping[str, Any]) -> str:
    value, note = entry["value"], entry["note"]
    if value is None:
        return str(note)
    scale, unit = SCALED.get(entry["unit"], (1.0, entry["unit"]))
    number = str(value) if isinstance(value, str) else f"{scale * value:.5g}"
    kind = {"exact": "", "lower bound": ", a lower bound", "upper bound": ", an upper bound"}[entry["kind"]]
    words = [f"{number} {unit}".rstrip() + kind]
    if kind:
        ends = [f"{scale * end:.5g}" if not isinstance(end, str) else end for end in entry["bracket"]]
        words.append(f"the truth is between {ends[0]} and {ends[1]}")
    if note:
        words.append(note)
    if entry["beyond"]:
        words.append(f"beyond it {entry['beyond']['reading']}")
    return "; ".join(words)
