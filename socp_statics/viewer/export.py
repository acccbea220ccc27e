"""A page of one file: the scene, its answer in words and, where there is one, the certified motion, without a server."""

from __future__ import annotations

import os
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from socp_statics.cases.writing import finished_or_absent
from socp_statics.colours import GREY
from socp_statics.viewer.page import Page, start_server, stop_server
from socp_statics.viewer.question import Question
from socp_statics.viewer.scene import Following, following, scene_of
from socp_statics.viewer.words import answer_html, title

FRAMES, FRAME, REST = 30, 1.0 / 15.0, 1.0
PANEL = (
    "position:fixed;bottom:3.5em;left:0.8em;z-index:2;max-width:24em;background:rgba(255,255,255,0.85);border-radius:4px;"
    "font-family:sans-serif"
)


def save_page(question: Question, path: str | os.PathLike[str]) -> None:
    """Write the scene of a question as one HTML file that refers to nothing outside; the same question gives the same bytes.

    Args:
        question: The question with its answer.
        path: The file; it is complete or not there.

    Raises:
        OSError: The file cannot be written.
    """
    html = page_html(question)
    with finished_or_absent(Path(path)) as draft:
        draft.write_text(html, encoding="utf-8")


def page_html(question: Question) -> str:
    """The scene of a question as one HTML page.

    Args:
        question: The question with its answer.
    """
    scene = scene_of(question)
    moving = following(scene, question.stance, question.record)
    server = start_server()
    try:
        page = Page(server, scene)
        page.follow(moving)
        recording = server.get_scene_serializer()
        if moving.motion is not None:
            _play(page, moving, recording)
        html: str = recording.as_html()
    finally:
        stop_server(server)
    return _with_words(html, question)


def _play(page: Page, moving: Following, recording: Any) -> None:
    """The motion from its start to its end, with a rest at both."""
    recording.insert_sleep(REST)
    for share in np.linspace(0.0, 1.0, FRAMES + 1)[1:]:
        page.play(moving, float(share))
        recording.insert_sleep(FRAME)
    recording.insert_sleep(REST)


def _with_words(html: str, question: Question) -> str:
    """The page with a title of its own and the answer in a corner."""
    record = question.record
    name = escape(title(record))
    note = f'<div style="font-size:0.8em;color:{GREY};padding:0.4em 0.6em 0">{name}</div>'
    panel = f'<div id="answer" style="{PANEL}">{note}{answer_html(record)}</div>'
    start, end = html.index("<title>"), html.index("</title>")
    html = f"{html[:start]}<title>{name}{html[end:]}"
    body = html.rindex("</body>")
    return html[:body] + panel + html[body:]
