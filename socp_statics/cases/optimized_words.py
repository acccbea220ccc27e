"""A posture optimisation in words: before, after, whether it is a local optimum, and which joints moved most."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

SHOWN_JOINTS = 3
UNMOVED = 5e-4


def optimized_lines(record: Mapping[str, Any]) -> list[str]:
    """What was gained and how.

    Args:
        record: A record with ``optimized``.

    Returns:
        Before and after; the local optimum or the reason why not; the joints that moved most, if any did.
    """
    found = record["optimized"]
    lines = [f"{before_and_after(found)} after {found['steps']} step{'' if found['steps'] == 1 else 's'}"]
    promise = "" if found["optimality"] is None else f" (optimality {found['optimality']:.1e})"
    lines.append(f"local optimum{promise}" if found["local_optimum"] else f"no local optimum{promise}: {found['reason']}")
    given = record["case"]["generated"]["angles"]
    moved = sorted(given, key=lambda joint: (-round(abs(found["angles"][joint] - given[joint]), 6), joint))
    shown = [joint for joint in moved if abs(found["angles"][joint] - given[joint]) > UNMOVED][:SHOWN_JOINTS]
    if shown:
        lines.append("moved most: " + ", ".join(f"{joint} {given[joint]:.3g} to {found['angles'][joint]:.3g} rad" for joint in shown))
    return lines


def before_and_after(found: Mapping[str, Any]) -> str:
    """The objective at both postures in words.

    Args:
        found: A record's ``optimized``.
    """
    before, after = found["objective_before"], found["objective_after"]
    if found["objective"] == "torque":
        return f"worst share of a torque limit from {_share(before)} to {_share(after)}"
    if found["objective"] == "com_margin":
        return f"CoM margin from {_millimetres(before)} to {_millimetres(after)}"
    return f"margin from {_newtons(before)} to {_newtons(after)}"


def _share(value: Any) -> str:
    return value if isinstance(value, str) else f"{100 * value:.4g} %"


def _millimetres(value: Any) -> str:
    return "none" if value is None else value if isinstance(value, str) else f"{1e3 * value:.5g} mm"


def _newtons(value: Any) -> str:
    return value if isinstance(value, str) else f"{value:.6g} N"
