"""The page that answers while the centre of mass is dragged."""

from __future__ import annotations

import threading
import time
from html import escape
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.cases.record import Record
from socp_statics.exceptions import EngineError
from socp_statics.viewer.page import ROOT, Page, address, start_server, stop_server
from socp_statics.viewer.question import Question
from socp_statics.viewer.scene import LAYERS, following, scene_of
from socp_statics.viewer.words import answer_html, title

HANDLE_SHARE, HANDLE_REACH = 0.16, 10.0
PERIOD, REST, FRAME = 3.0, 1.0, 1.0 / 20.0
NOTE = "Drag the centre of mass along the floor: the answer follows. The posture stays as it is."


class LiveView:
    """A question on a page, answered again whenever its centre of mass is dragged.

    Args:
        question: The question with its answer.

    Attributes:
        record: The answer that is shown.
        page: The page.
        url: Where a browser finds it.
        solve_times: How long each answer took, from the drag to the new scene [s].
    """

    def __init__(self, question: Question):
        self._question = question
        self.record: Record = question.record
        self.solve_times: list[float] = []
        self._scene = scene_of(question)
        self._server = start_server()
        self.page = Page(self._server, self._scene)
        self.url = address(self._server)
        self._moving = following(self._scene, question.stance, question.record)
        self._asked = question.stance.com[:2].copy()
        self._turn, self._busy = threading.Lock(), threading.Lock()
        self._start = time.monotonic()
        self._at_rest = True
        self._add_handle()
        self._add_panel()
        self._show()

    def move_com(self, xy_W: ArrayLike) -> Record:
        """Answer the question with its centre of mass elsewhere, and show the answer.

        Args:
            xy_W: Where the centre of mass is, shape (2,) [m].

        Returns:
            The answer.

        Raises:
            EngineError: No engine settled a program; the page keeps the last answer.
        """
        with self._busy:
            begun = time.perf_counter()
            stance, record = self._question.moved_to(xy_W)
            moving = following(self._scene, stance, record)
            self.record, self._moving = record, moving
            self._start = time.monotonic()
            self._show()
            self.solve_times.append(time.perf_counter() - begun)
        return record

    def animate(self, seconds: float) -> None:
        """Place the bodies as the certified motion has them, over and over; where nothing moves, as the stance has them.

        Args:
            seconds: Since the motion began.
        """
        moving = self._moving
        playing = moving.motion is not None and self._play.value
        if not playing and self._at_rest:
            return
        share = min(max(seconds % (PERIOD + 2.0 * REST) - REST, 0.0) / PERIOD, 1.0)
        with self._server.atomic():
            if playing:
                self.page.play(moving, share)
            else:
                self.page.place(moving.bodies, moving.com)
        self._at_rest = not playing

    def run(self) -> None:
        """Keep the page alive until the process is interrupted."""
        try:
            while True:
                time.sleep(FRAME)
                self.animate(time.monotonic() - self._start)
        except KeyboardInterrupt:
            pass
        finally:
            self.close()

    def clients(self) -> tuple[Any, ...]:
        """The browsers that look at the page, as viser's client handles."""
        return tuple(self._server.get_clients().values())

    def close(self) -> None:
        """Stop the server."""
        stop_server(self._server)

    def _show(self) -> None:
        with self._server.atomic():
            self.page.follow(self._moving)
            self._words.content = answer_html(self.record)
        self._at_rest = True

    def _add_handle(self) -> None:
        com, scene = self._question.stance.com, self._scene
        reach = HANDLE_REACH * scene.extent
        self.handle = self._server.scene.add_transform_controls(
            f"{ROOT}/handle", scale=HANDLE_SHARE * scene.extent, active_axes=(True, True, False), disable_rotations=True, depth_test=False,
            translation_limits=((-reach, reach), (-reach, reach), (-reach, reach)), position=self.page.local(com),
        )  # fmt: skip
        self.handle.on_update(lambda event: self.drag())

    def _add_panel(self) -> None:
        gui = self._server.gui
        gui.configure_theme(control_layout="floating", control_width="large", show_logo=False, show_share_button=False)
        gui.set_panel_label(title(self.record))
        self._words = gui.add_html(answer_html(self.record))
        gui.add_markdown(NOTE)
        back = gui.add_button("put the centre of mass back")
        back.on_click(lambda event: self.put_back())
        self._play = gui.add_checkbox("play the certified motion", True)
        with gui.add_folder("show", expand_by_default=False):
            for layer, words in LAYERS.items():
                self._add_switch(layer, words)

    def _add_switch(self, layer: str, words: str) -> None:
        box = self._server.gui.add_checkbox(words, True)
        box.on_update(lambda event: self.page.show_layer(layer, box.value))

    def put_back(self) -> None:
        """Answer for where the centre of mass was first, and put the handle there."""
        self.handle.position = self.page.local(self._question.stance.com)
        self.drag()

    def drag(self) -> None:
        """Answer for where the handle is now; while one answer is being computed, later positions wait and the last one counts."""
        self._asked = np.asarray(self.handle.position, dtype=float)[:2] + self._scene.origin[:2]
        while self._turn.acquire(blocking=False):
            asked = self._asked
            try:
                self.move_com(asked)
            except EngineError as error:
                self._words.content = f"<p>{escape(str(error))}</p>"
            finally:
                self._turn.release()
            if self._asked is asked:
                return
