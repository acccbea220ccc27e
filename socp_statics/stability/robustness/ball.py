"""Largest balls of disturbances, and the largest tilt of gravity: brackets turned into measures."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from socp_statics.cones.choice import ConeChoice
from socp_statics.contacts import Stance
from socp_statics.engines import engines_for
from socp_statics.engines.engine import Engine
from socp_statics.exceptions import EngineError
from socp_statics.spatial import Array
from socp_statics.stability.robustness.disturbances import Disturbance, gravity_changes
from socp_statics.stability.robustness.inscribed import Inscribed, distances, largest_inscribed, tilts
from socp_statics.stability.robustness.load_slice import LoadSlice
from socp_statics.stability.robustness.measure import EXACT, LOWER, Measure, bracketed
from socp_statics.statics import StaticsData

# Programs a measure may ask, by the number of coordinates; a bracket that is still wide then is the answer.
QUERIES = {1: 40, 2: 400, 3: 400, 4: 200, 5: 140, 6: 110}


class Settings(NamedTuple):
    """How questions are asked: cones, form, engines, and the width of a bracket that counts as exact."""

    cone: ConeChoice
    form: str
    engine: str | Sequence[str]
    tolerance: float


def settled(settings: Settings, what: str, ask: Callable[[Engine], Measure]) -> Measure:
    """The answer of the first engine that settles a question.

    Args:
        settings: Which engines.
        what: The question, for the error sentence.
        ask: The question.

    Raises:
        EngineError: None settles it.
    """
    details = []
    for one in engines_for(settings.engine, settings.form):
        try:
            return ask(one)
        except EngineError as error:
            details.append(str(error))
    raise EngineError(f"{what} was not settled: {'; '.join(details)}", name=what)


def largest_ball(name: str, unit: str, data: StaticsData, disturbance: Disturbance, settings: Settings) -> Measure:
    """Radius of the largest ball of disturbances that can all be balanced.

    Args:
        name: Its word.
        unit: Its unit.
        data: Arrays of a stance that holds.
        disturbance: The disturbances.
        settings: How to ask.

    Returns:
        The radius: exact where inner polytope and outer half-spaces agree to the tolerance, else a lower bound.

    Raises:
        EngineError: No engine settled it.
    """
    seen = disturbance.seen()
    if not seen.wrench.shape[1]:
        return Measure(name, np.inf, unit, EXACT, (np.inf, np.inf), note="neither load nor torques depend on it")

    def ask(engine: Engine) -> Measure:
        slice_ = LoadSlice(data, seen, settings.cone, settings.form, engine)
        if slice_.unreachable is not None:
            return _none(name, unit, slice_, seen)
        queries = QUERIES[slice_.coordinates]
        return _ball_measure(name, unit, slice_, seen, largest_inscribed(slice_, distances, settings.tolerance, queries), settings)

    return settled(settings, name, ask)


def _none(name: str, unit: str, slice_: LoadSlice, seen: Disturbance) -> Measure:
    """No contact force resists some direction, however small the disturbance."""
    v = slice_.unreachable
    assert v is not None
    beyond = slice_.unresisted(v)
    return Measure(name, 0.0, unit, EXACT, (0.0, 0.0), direction=seen.axes @ v, beyond=beyond)


def _ball_measure(name: str, unit: str, slice_: LoadSlice, seen: Disturbance, found: Inscribed, settings: Settings) -> Measure:
    if found.lower == np.inf:
        return Measure(name, np.inf, unit, EXACT, (np.inf, np.inf), note="contact forces grow with it without end")
    if found.tightest is None:
        return Measure(name, seen.one * found.lower, unit, LOWER, (seen.one * found.lower, np.inf), note="no larger one was looked at")
    v = found.tightest.direction
    beyond = slice_.beyond(lambda share: (found.upper + share * max(1.0, found.upper)) * v, found.tightest)
    if beyond is None:
        raise EngineError(f"the motion beyond {name} does not check", name=slice_.engine.name)
    lower, upper = seen.one * found.lower, seen.one * found.upper
    return bracketed(name, unit, lower, upper, settings.tolerance, direction=seen.axes @ v, beyond=beyond)


def largest_tilt(stance: Stance, data: StaticsData, settings: Settings) -> Measure:
    """How far gravity may turn in any direction, contacts and centre of mass staying where they are [deg].

    Args:
        stance: A stance that holds, with gravity.
        data: Its arrays.
        settings: How to ask.

    Returns:
        The angle; exact where the bracket is narrow. Turning gravity is turning the whole scene the other way.

    Raises:
        EngineError: No engine settled it.
    """
    name, unit = "tilt", "deg"
    if stance.weight == 0.0:
        return Measure(name, np.inf, unit, EXACT, (np.inf, np.inf), note="there is no gravity to tilt")
    down = np.array(stance.gravity) / float(np.linalg.norm(stance.gravity))
    changes = gravity_changes(stance, data)

    def ask(engine: Engine) -> Measure:
        slice_ = LoadSlice(data, changes, settings.cone, settings.form, engine)
        if slice_.unreachable is not None and abs(slice_.unreachable @ down) < 1.0 - 1e-9:
            return _none(name, unit, slice_, changes)
        found = largest_inscribed(slice_, tilts(down), settings.tolerance, QUERIES[3])
        if found.lower >= np.pi:
            return Measure(name, 180.0, unit, EXACT, (180.0, 180.0), note="it holds whichever way gravity points")
        if found.tightest is None:
            lower = float(np.degrees(found.lower))
            return Measure(name, lower, unit, LOWER, (lower, 180.0), note="no larger one was looked at")
        normal = found.tightest.direction
        turned = _turned(down, normal, found.upper)
        beyond = slice_.beyond(lambda share: _turned(down, normal, min(found.upper + share, np.pi)) - down, found.tightest)
        return bracketed(
            name, unit, float(np.degrees(found.lower)), float(np.degrees(found.upper)), settings.tolerance,
            direction=turned, beyond=beyond,
        )  # fmt: skip

    return settled(settings, name, ask)


def _turned(down: Array, normal: Array, angle: float) -> Array:
    """Gravity's direction turned by an angle towards a normal."""
    side = normal - (normal @ down) * down
    size = float(np.linalg.norm(side))
    side = side / size if size > 0.0 else np.zeros(3)
    return np.cos(angle) * down + np.sin(angle) * side
