"""Pinocchio's working memory for a robot, one a thread: making it costs more than the kinematics."""

from __future__ import annotations

import threading
import weakref
from typing import Any

from socp_statics.robots import Robot

_KEPT = threading.local()


def working_memory(robot: Robot) -> Any:
    """The ``pinocchio.Data`` of a robot in this thread; whoever asks next writes over what is in it."""
    kept = _KEPT.__dict__.setdefault("of", weakref.WeakKeyDictionary())
    if robot not in kept:
        kept[robot] = robot.pin_model.createData()
    return kept[robot]
