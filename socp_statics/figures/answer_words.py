"""The words above a figure: verdict, margins, and why."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from socp_statics.cases.optimized_words import before_and_after
from socp_statics.cases.summary import capability_words
from socp_statics.colours import VERDICT_COLOURS
from socp_statics.cones.choice import KINDS
from socp_statics.figures.answer_content import Answer
from socp_statics.figures.layout import Words
from socp_statics.figures.quantities import force_text, length_text
from socp_statics.figures.style import BLACK
from socp_statics.figures.window import Window, inside
from socp_statics.regions.polygon import area


def answer_words(record: Mapping[str, Any], answer: Answer, window: Window) -> list[Words]:
    """Verdict, margins, and why.

    Args:
        record: The record.
        answer: What is drawn of it.
        window: What the floor plan shows.

    Returns:
        Lines for the head of the sheet.
    """
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
    if record.get("capability") and record.get("objective") is not None:
        out.append(Words(capability_words(record)))
    if "optimized" in record:
        out.append(Words(f"optimised: {before_and_after(record['optimized'])}", BLACK, "bold"))
    if answer.motion is not None and answer.motion.get("reading"):
        prefix = "beyond it: " if (record.get("capability") or {}).get("beyond") else ""
        out.append(Words(prefix + answer.motion["reading"]))
    use = max((use for use in answer.torques if use.share is not None), key=lambda use: use.share or 0.0, default=None)
    if use is not None and use.share:
        often = f"at {100.0 * use.share:.3g} % of" if np.isfinite(use.share) else "beyond"
        out.append(Words(f"{use.joint} {often} its torque limit"))
    if any(shape.frozen for shape in answer.shapes.values()):
        out.append(Words("regions with torque limits: frozen posture"))
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
