"""A record in a few lines for a person."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any


def summarise(record: Mapping[str, Any]) -> str:
    """Verdict, margins, region, certificate, expectations and who computed it.

    Args:
        record: Of `socp_statics.cases.solve`.

    Returns:
        One line for each, without a newline at the end.
    """
    cone = record["cone"]
    cones = "exact cones" if cone["kind"] == "exact" else f"{cone['kind']} pyramids with {cone['sides']} sides"
    verdict = record["verdict"] + (f" ({_REASONS[record['reason']]})" if record["reason"] else "")
    lines = [("problem", f"{record['problem']}, {record['model']}, {cones}"), ("verdict", verdict)]
    if record["status"] != "solved":
        lines.append(("status", record["status"]))
    lines.append(("margin", _margin(record)))
    if record["idle"]:
        rest = "" if record["idle_margin"] is None else f"; margin of the others {_newtons(record['idle_margin'])}"
        lines.append(("idle", f"{', '.join(record['idle'])} (cannot be loaded wherever the CoM is){rest}"))
    if record.get("com_margin") is not None:
        lines.append(("CoM margin", _millimetres(record["com_margin"])))
    if "region" in record:
        lines.append(("region", _region(record["region"])))
    if record["objective"] is not None:
        lines.append(("objective", f"{record['objective']:.6g}"))
    if "safety" in record:
        lines.append(("safety", _safety(record["safety"])))
    if record["certificate"]:
        lines.append(("because", record["certificate"].get("reading") or "forces inside every cone balance the load"))
    largest = max((abs(value) for entry in record["wrenches"] for value in entry["force"]), default=0.0)
    lines += [("contact", _wrench(entry, 1e-9 * largest)) for entry in record["wrenches"]]
    for entry in record["expect"]:
        lines.append(
            ("expect", f"{entry['key']} {'holds' if entry['ok'] else 'DOES NOT HOLD'}: {entry['value']!r}, expected {entry['expected']!r}")
        )
    residuals = ", ".join(f"{name} {value:.1e}" for name, value in record["residuals"].items() if value is not None)
    handed = f", {record['handovers']} handed over" if record["handovers"] else ""
    lines.append(("engine", f"{record['engine']}{handed}" + (f"; residuals {residuals}" if residuals else "")))
    return "\n".join(f"{word:<11} {text}" for word, text in lines)


_REASONS = {
    "boundary": "on the boundary of what can be held",
    "rank": "the load lies within rounding of what the contacts can carry",
    "torque": "only because of the torque limits",
}


def _newtons(value: Any) -> str:
    return value if isinstance(value, str) else f"{value:.6g} N"


def _margin(record: Mapping[str, Any]) -> str:
    margin = record["margin"]
    if margin is None:
        return "not known"
    if isinstance(margin, str):
        held = {"inf": "nothing stops the internal forces, every contact can be loaded at will", "-inf": "no forces balance the load"}
        return f"{margin} ({held[margin]})"
    gravity = record["case"]["posture"].get("gravity", [0.0, 0.0, -9.81])
    weight = record["case"]["generated"]["mass"] * math.hypot(*gravity)
    share = f" ({100 * margin / weight:.3g} % of the weight)" if weight > 0 else ""
    meaning = "every contact point can spare it" if margin > 0 else "every contact point lacks it" if margin < 0 else "nothing to spare"
    return f"{_newtons(margin)}{share} of normal force: {meaning}"


def _millimetres(value: Any) -> str:
    if isinstance(value, str):
        return "inf (the region has no edge)"
    if abs(value) < 1e-9:
        return "0 mm, on the edge of the region"
    return f"{abs(1e3 * value):.4g} mm {'inside' if value > 0 else 'outside'} the region"


def _region(region: Mapping[str, Any]) -> str:
    if region["kind"] == "polygon":
        area = f"{1e4 * region['inner_area']:.5g} cm^2"
        return f"polygon of {area}, relative gap {region['relative_gap']:.1e}, {region['solves']} programs"
    if region["kind"] == "unbounded":
        return f"unbounded along {len(region['rays'])} rays, {region['solves']} programs"
    return f"{region['kind']}, {region['solves']} programs"


def _safety(safety: Mapping[str, Any]) -> str:
    sides = [
        f"{'inside' if safety[key] else 'outside'} {words}"
        for key, words in (("in_region", "the region"), ("in_base", "the base of support"))
    ]
    return f"the CoM is {sides[0]} and {sides[1]} offset by {1e3 * safety['offset']:.4g} mm"


def _wrench(entry: Mapping[str, Any], nothing: float) -> str:
    force, moment = (", ".join(f"{value if abs(value) > nothing else 0.0:.4g}" for value in entry[key]) for key in ("force", "moment"))
    return f"{entry['contact']}: force [{force}] N, moment [{moment}] N m"
