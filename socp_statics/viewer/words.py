"""The answer in words beside the scene, as HTML."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from typing import Any

from socp_statics.cases.summary import summary_lines
from socp_statics.colours import BLACK, GREY, VERDICT_COLOURS

SHOWN = ("verdict", "status", "margin", "idle", "CoM margin", "objective", "safety", "because", "beyond it", "stopped by",
         "contact", "torque")  # fmt: skip


def answer_lines(record: Mapping[str, Any]) -> list[tuple[str, str]]:
    """The lines of the summary that are about the answer: verdict, margins, reading, forces of the contacts.

    Args:
        record: The record.
    """
    return [(word, text) for word, text in summary_lines(record) if word in SHOWN]


def answer_html(record: Mapping[str, Any]) -> str:
    """The answer as a piece of HTML, the verdict in its colour.

    Args:
        record: The record.
    """
    rows = []
    for word, text in answer_lines(record):
        style = f"color:{VERDICT_COLOURS.get(record['verdict'], BLACK)};font-weight:bold" if word == "verdict" else "overflow-wrap:anywhere"
        rows.append(f'<div style="color:{GREY}">{escape(word)}</div><div style="{style}">{escape(text)}</div>')
    table = "display:grid;grid-template-columns:max-content 1fr;gap:0.2em 0.7em;font-size:0.8em;line-height:1.3;padding:0.4em 0.6em"
    return f'<div style="{table}">{"".join(rows)}</div>'


def title(record: Mapping[str, Any]) -> str:
    """What the page is called.

    Args:
        record: The record.
    """
    return f"{record['problem']}, {record['model']}"
