"""How a run is going: a bar on a terminal, a line now and then elsewhere, nothing when asked to be quiet."""

from __future__ import annotations

import sys
import time
from types import TracebackType
from typing import Any, Self

EVERY = 10.0


class Progress:
    """Counts finished cases and says so on standard error.

    Args:
        total: Number of cases to compute.
        quiet: Whether to say nothing.
    """

    def __init__(self, total: int, quiet: bool):
        self.total, self.quiet = total, quiet
        self.done = self.failed = 0
        self._bar: Any = None
        self._began = self._said = time.monotonic()

    def __enter__(self) -> Self:
        self._began = self._said = time.monotonic()
        if not self.quiet and self.total and sys.stderr is not None and sys.stderr.isatty():
            from rich.console import Console
            from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn
            from rich.progress import Progress as Bar

            columns = (BarColumn(), MofNCompleteColumn(), TextColumn("{task.fields[rate]} {task.fields[failed]}"), TimeRemainingColumn())
            self._bar = Bar(*columns, console=Console(stderr=True), transient=True, refresh_per_second=4)
            self._task = self._bar.add_task("", total=self.total, rate="", failed="")
            self._bar.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if self._bar is not None:
            self._bar.stop()

    @property
    def elapsed(self) -> float:
        """Time since the start [s]."""
        return time.monotonic() - self._began

    def advance(self, done: int, failed: int) -> None:
        """Count finished cases.

        Args:
            done: How many.
            failed: How many of them failed.
        """
        self.done, self.failed = self.done + done, self.failed + failed
        self.tick()

    def tick(self) -> None:
        """Say how it is going, where it is time to."""
        rate = self.done / max(self.elapsed, 1e-9)
        failed = f"{self.failed} failed" if self.failed else ""
        if self._bar is not None:
            self._bar.update(self._task, completed=self.done, rate=f"{rate:.3g} a second", failed=failed)
        elif not self.quiet and self.total and time.monotonic() - self._said >= EVERY:
            self._said = time.monotonic()
            left = f", {_duration((self.total - self.done) / rate)} left" if self.done else ""
            line = f"{self.done} of {self.total} cases, {rate:.3g} a second, {self.failed} failed{left}"
            print(line, file=sys.stderr, flush=True)


def _duration(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes} min" if hours else f"{minutes} min {rest} s" if minutes else f"{rest} s"
