"""A record in a few lines for a person."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from socp_statics.cases.answers.simple_test import simple_test_lines
from socp_statics.cases.distribution_words import distribution_lines, window_lines
from socp_statics.cases.optimized_words import optimized_lines
from socp_statics.cases.price_words import price_lines
from socp_statics.cases.robustness_words import robustness_lines
from socp_statics.certificates.reading import direction_words

SHOWN_JOINTS = 3


def summarise(record: Mapping[str, Any]) -> str:
    """Verdict, margins, region, certificate, expectations and who computed it.

    Args:
        record: Of `socp_statics.cases.solve`.

    Returns:
        One line for each, without a newline at the end.
    """
    return "\n".join(f"{word:<11} {text}" for word, text in summary_lines(record))


def summary_lines(record: Mapping[str, Any]) -> list[tuple[str, str]]:
    """The lines of `summarise`, each as its first word and the rest.

    Args:
        record: Of `socp_statics.cases.solve`.
    """
    cone = record["cone"]
    cones = "exact cones" if cone["kind"] == "exact" else f"{cone['kind']} pyramids with {cone['sides']} sides"
    verdict = record["verdict"] + (f" ({_REASONS[record['reason']]})" if record["reason"] else "")
    lines = [("problem", f"{record['problem']}, {record['model']}, {cones}"), ("verdict", verdict)]
    if record["status"] != "solved":
        lines.append(("status", record["status"]))
    if "strong" in record:
        lines.append(("weak/strong", _strong(record)))
    lines.append(("margin", _margin(record)))
    if record["idle"]:
        rest = "" if record["idle_margin"] is None else f"; margin of the others {_newtons(record['idle_margin'])}"
        lines.append(("idle", f"{', '.join(record['idle'])} (cannot be loaded wherever the CoM is){rest}"))
    if record.get("com_margin") is not None:
        lines.append(("CoM margin", _millimetres(record["com_margin"])))
    if "region" in record:
        lines.append(("region", _region(record["region"])))
    if "following" in record:
        lines += _following(record["following"])
    if record["objective"] is not None and not {"optimized", "distribution", "window"} & set(record):
        lines.append(("objective", _objective(record)))
    if "optimized" in record:
        lines += [("optimised", line) for line in optimized_lines(record)]
    if "safety" in record:
        lines.append(("safety", _safety(record["safety"])))
    lines += simple_test_lines(record)
    if "robustness" in record:
        lines += [("robustness", line) for line in robustness_lines(record)]
    if "keyframes" in record:
        lines.append(("keyframes", _keyframes(record)))
    if record["certificate"]:
        lines.append(("because", record["certificate"].get("reading") or "forces inside every cone balance the load"))
    if record.get("capability", {}).get("beyond"):
        lines.append(("beyond it", record["capability"]["beyond"]["reading"]))
    lines += price_lines(record)
    if "distribution" in record:
        lines += [("methods", line) for line in distribution_lines(record)]
    if "window" in record:
        lines += [("window", line) for line in window_lines(record)]
    shown = _shown(record)
    largest = max((abs(value) for entry in shown.get("wrenches", []) for value in entry["force"]), default=0.0)
    lines += [("contact", _wrench(entry, 1e-9 * largest)) for entry in shown.get("wrenches", [])]
    lines += [("torque", line) for line in _torques(shown.get("torques") or {}, record.get("torque_limits") or {})]
    for entry in record["expect"]:
        lines.append(
            ("expect", f"{entry['key']} {'holds' if entry['ok'] else 'DOES NOT HOLD'}: {entry['value']!r}, expected {entry['expected']!r}")
        )
    residuals = ", ".join(f"{name} {value:.1e}" for name, value in record["residuals"].items() if value is not None)
    handed = f", {record['handovers']} handed over" if record["handovers"] else ""
    lines.append(("engine", f"{record['engine']}{handed}" + (f"; residuals {residuals}" if residuals else "")))
    return lines


def _shown(record: Mapping[str, Any]) -> Mapping[str, Any]:
    """Whose wrenches and torques are printed: those of the largest load, or of the method that was asked for; none of many methods."""
    if record.get("capability", {}).get("wrenches"):
        return record["capability"]
    if "distribution" in record:
        return record["distribution"]["methods"].get(record["distribution"]["method"]) or {"wrenches": []}
    return record


_REASONS = {
    "boundary": "on the boundary of what can be held",
    "rank": "the load lies within rounding of what the contacts can carry",
    "torque": "only because of the torque limits",
}


def _strong(record: Mapping[str, Any]) -> str:
    """Which of the four labels of Section 3.7.1 hold, and why."""
    labels = {
        ("stable", "strong"): "weakly and strongly stable",
        ("stable", "not_strong"): "weakly stable and weakly unstable, not strongly stable",
        ("stable", "undecided"): "weakly stable, whether strongly is undecided",
        ("unstable", "not_strong"): "strongly unstable",
    }
    return f"{labels.get((record['verdict'], record['strong']), 'undecided')}: {record['strong_by']['statement']}"


def _keyframes(record: Mapping[str, Any]) -> str:
    checked, failure = record["keyframes"], record["first_failure"]
    if failure is None:
        return f"all {len(checked)} postures hold"
    support = ", ".join(failure["support"])
    return f"{failure['where']}, at {failure['progress']:.3g} of the way, is the first of {len(checked)} that fails, on {support}"


def _newtons(value: Any) -> str:
    return value if isinstance(value, str) else f"{value:.6g} N"


def _margin(record: Mapping[str, Any]) -> str:
    margin = record["margin"]
    if margin is None:
        return "not known"
    if isinstance(margin, str):
        within = " within the torque limits" if record["reason"] == "torque" else ""
        held = {
            "inf": "nothing stops the internal forces, every contact can be loaded at will",
            "-inf": f"no forces balance the load{within}",
        }
        return f"{margin} ({held[margin]})"
    gravity = record["case"]["posture"].get("gravity", [0.0, 0.0, -9.81])
    weight = record["case"]["generated"]["mass"] * math.hypot(*gravity)
    share = f" ({100 * margin / weight:.3g} % of the weight)" if weight > 0 else ""
    meaning = "every contact point can spare it" if margin > 0 else "every contact point lacks it" if margin < 0 else "nothing to spare"
    return f"{_newtons(margin)}{share} of normal force: {meaning}"


def _objective(record: Mapping[str, Any]) -> str:
    if record["model"] == "torque_feasibility":
        return f"the worst joint has to use {100 * record['objective']:.5g} % of its torque limit"
    if record["model"] == "capability":
        return capability_words(record)
    return f"{record['objective']:.6g}"


def capability_words(record: Mapping[str, Any]) -> str:
    """The largest load in words: how much of what where."""
    load, most = record["capability"], record["objective"]
    link = f"{load['link']} at " if load["link"] else ""
    place = f"at {link}[{', '.join(f'{value:.4g}' for value in load['point'])}] m"
    along = f" along {direction_words(np.array(load['direction']))}" if load["kind"] == "push" else ""
    if isinstance(most, str):
        return f"any {load['kind']}{along} {place}: contact forces can grow with it without end"
    return f"{load['kind']} of at most {most:.6g} {load['unit']}{along} {place}"


def _millimetres(value: Any) -> str:
    if isinstance(value, str):
        return "inf (the region has no edge)"
    if abs(value) < 1e-9:
        return "0 mm, on the edge of the region"
    return f"{abs(1e3 * value):.4g} mm {'inside' if value > 0 else 'outside'} the region"


def _region(region: Mapping[str, Any]) -> str:
    frozen = ", torque limits of the frozen posture" if region.get("posture") == "frozen" else ""
    if region["kind"] == "polygon":
        area = f"{1e4 * region['inner_area']:.5g} cm^2"
        return f"polygon of {area}, relative gap {region['relative_gap']:.1e}, {region['solves']} programs{frozen}"
    if region["kind"] == "unbounded":
        return f"unbounded along {len(region['rays'])} rays, {region['solves']} programs{frozen}"
    return f"{region['kind']}, {region['solves']} programs{frozen}"


def _following(following: Mapping[str, Any]) -> list[tuple[str, str]]:
    """How far the posture follows, what stops it, and the shortest ray."""
    rays = following["rays"]
    shortest = min(rays, key=lambda ray: round(ray["distance"], 9))
    ends = sorted(1e3 * ray["distance"] for ray in rays)
    free = "free" if following["height"] == "free" else f"{following['height']:g} m"
    reach = f"{ends[0]:.4g} to {ends[-1]:.4g} mm, star of {1e4 * following['area']:.5g} cm^2 attained along the rays only, height {free}"
    toward = ", ".join(f"{value + 0.0:.2f}" for value in shortest["direction"])
    return [
        ("following", f"{len(rays)} rays, {reach}"),
        ("stopped by", ", ".join(f"{reason} {count}" for reason, count in following["reasons"].items())),
        ("shortest", f"along ({toward}): {shortest['reading']}"),
    ]


def _safety(safety: Mapping[str, Any]) -> str:
    sides = [
        f"{'inside' if safety[key] else 'outside'} {words}"
        for key, words in (("in_region", "the region"), ("in_base", "the base of support"))
    ]
    return f"the CoM is {sides[0]} and {sides[1]} offset by {1e3 * safety['offset']:.4g} mm"


def _wrench(entry: Mapping[str, Any], nothing: float) -> str:
    force, moment = (", ".join(f"{value if abs(value) > nothing else 0.0:.4g}" for value in entry[key]) for key in ("force", "moment"))
    return f"{entry['contact']}: force [{force}] N, moment [{moment}] N m"


def _torques(torques: Mapping[str, Any], limits: Mapping[str, Any]) -> list[str]:
    """The joints that use most of their limits, or, where no limit counts, that carry most."""

    def use(joint: str) -> float:
        lower, upper = (float(end) for end in limits.get(joint, ("-inf", "inf")))
        limit = upper if torques[joint] > 0.0 else -lower
        return abs(torques[joint]) / limit if limit else math.inf if torques[joint] else 0.0

    order = sorted(torques, key=lambda joint: (-round(use(joint), 9), -round(abs(torques[joint]), 9)))
    lines = []
    for joint in order[:SHOWN_JOINTS]:
        share = use(joint)
        words = f", {100 * share:.3g} % of its limit" if share and math.isfinite(share) else ""
        lines.append(f"{joint} {torques[joint]:.4g} N m{words}")
    return lines
