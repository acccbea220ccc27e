"""Generator: contact states in turn, and the ways between them (Contact Planning in 3.7.1)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from numpy.typing import ArrayLike

from socp_statics.contacts.numbers import scalar
from socp_statics.exceptions import InputError
from socp_statics.postures.contact_states import keyframes_of
from socp_statics.postures.posture import Posture
from socp_statics.robots import Robot


def generate(
    robot: Robot,
    *,
    at: ArrayLike = (0.0, 0.0, 0.0),
    friction: float | Mapping[str, float] = 0.5,
    states: Sequence[Mapping[str, Any]] = (),
    progress: float = 0.0,
) -> Posture:
    """The posture of a contact state, or one on the way to the next.

    Args:
        robot: A robot with feet.
        at: The middle between the home places of the feet, shape (3,) [m].
        friction: Coulomb coefficient, of all or by contact; may name contacts that touch in some states only.
        states: Tables with ``support`` and optionally ``name``, ``com`` (x, y or x, y, z from ``at`` [m]) and ``places``: contact to
            ``position`` [m] and one of rotation, normal, rpy; level at home by default, hands against a wall in front.
        progress: 0 is the first state, 1 the second; between them the contacts that both share touch.

    Returns:
        The posture.

    Raises:
        InputError: The states are wrong or cannot be reached, neighbours share no contact, or progress is beyond the last.
    """
    frames = keyframes_of(robot, states, friction, at)
    last = len(frames.states) - 1
    along = scalar("keyframes", "progress", progress, least=0.0, kind="generator")
    if along > last:
        message = f"keyframes: progress must be at most {last}, the number of the last state, got {along:g}"
        raise InputError(message, name="keyframes", field="progress")
    number = int(along)
    return frames.postures[number] if along == number else frames.between(number, along - number)
