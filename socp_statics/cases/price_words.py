"""Which constraint stops an answer, and what more of it would gain, in a line or two for a person."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from socp_statics.certificates.reading import direction_words

MOST_SHOWN = 3
# What a price is told per, and how much of its SI unit that is.
STEPS = {"1": ("0.1", 0.1), "m": ("mm", 1e-3), "N": ("N", 1.0), "N m": ("N m", 1.0)}
GAINS = {"m": ("mm", 1e3)}
PUSH_ONLY = "normal forces that can only push, neither friction nor a limit"
OBJECTIVES = {"com_margin": "CoM: "}


def price_lines(record: Mapping[str, Any]) -> list[tuple[str, str]]:
    """The lines of the prices.

    Args:
        record: Of `socp_statics.cases.solve`.

    Returns:
        Pairs of a label and a text: what stops each objective, the most important first, and how its contacts had better move.
    """
    lines: list[tuple[str, str]] = []
    for objective, prices in record["prices"].items():
        # What a capability asks about is its load, and without the load it stands.
        if objective == "margin" and "capability" in record and record["verdict"] == "stable":
            continue
        if lines and not prices["stopped_by"] and lines[0][1] == PUSH_ONLY:
            continue
        lines.append(("stopped by", OBJECTIVES.get(objective, "") + _stopping(objective, prices)))
        moves = _moves(prices)
        if moves:
            lines.append(("moving", OBJECTIVES.get(objective, "") + ", ".join(moves)))
    return lines


def _gain(value: float, unit: str, step: str) -> str:
    name, factor = GAINS.get(unit, (unit, 1.0))
    return f"{value * factor:+.3g} {name} per {step}"


def _stopping(objective: str, prices: Mapping[str, Any]) -> str:
    if objective == "shortfall":
        what = _shortened([entry["what"] for entry in prices["stopped_by"]])
        return f"{what}: {prices['value']:.3g} {prices['unit']} more on each would do"
    if not prices["stopped_by"]:
        return PUSH_ONLY
    words = []
    for entry in prices["stopped_by"]:
        step, amount = STEPS[entry["per"]]
        doubt = ", one way" if entry["what"] in prices["not_unique"] else ""
        words.append(f"{entry['what']} ({_gain(entry['price'] * amount, prices['unit'], step)}{doubt})")
    return _shortened(words)


def _shortened(words: list[str]) -> str:
    more = f" and {len(words) - MOST_SHOWN} more" if len(words) > MOST_SHOWN else ""
    return ", ".join(words[:MOST_SHOWN]) + more


def _moves(prices: Mapping[str, Any]) -> list[str]:
    """Contacts that had better be elsewhere, along the directions in which the gain is the same both ways."""
    found = []
    for name, vector in prices.get("displacement", {}).items():
        known = [f"{name} displacement along {axis}" not in prices["not_unique"] for axis in "xyz"]
        gain = np.where(known, vector, 0.0)
        if gain.any():
            found.append((float(np.linalg.norm(gain)), name, gain))
    most = max((size for size, _, _ in found), default=1.0)
    order = sorted(found, key=lambda entry: (-round(entry[0] / most, 6), entry[1]))
    return [f"{name} along {direction_words(gain)} ({_gain(0.01 * size, prices['unit'], 'cm')})" for size, name, gain in order[:MOST_SHOWN]]
