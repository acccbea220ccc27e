"""How long each way to an answer takes: one kernel on both sides, Clarabel on both sides, and HiGHS for the pyramids.

CPU time of the whole question, from the stance to the value, medians of a few runs within one process; the time inside HiGHS is
given beside it, since what surrounds it here is Python. HiGHS is spared the checks of an answer.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from statistics import median
from typing import Any, NamedTuple

from socp_statics.comparison.linear_programs import by_linear_programs
from socp_statics.comparison.quantities import QUANTITIES, TOLERANCE
from socp_statics.cones.choice import EXACT, ConeChoice
from socp_statics.contacts import Stance
from socp_statics.engines.linear import interface
from socp_statics.exceptions import EngineError

RUNS, LONG = 5, 0.25
CONIC = ("kernel", "clarabel")


class Timed(NamedTuple):
    """Time of one quantity with one cone by one engine.

    Attributes:
        quantity: As in the comparison's rows.
        cone: "exact" or "inscribed".
        sides: Of the pyramid; None of the exact cone.
        engine: "kernel", "clarabel", "HiGHS" or "HiGHS (SciPy)".
        seconds: Median CPU time of the question [s].
        inside: Of it inside HiGHS [s]; None for the others.
    """

    quantity: str
    cone: str
    sides: int | None
    engine: str
    seconds: float
    inside: float | None = None


def times(stance: Stance, parameters: Mapping[str, Any], names: Sequence[str], sides: Sequence[int], heading: float = 0.0) -> list[Timed]:
    """Times of the exact cone and of inscribed pyramids by every engine that answers.

    Args:
        stance: The stance.
        parameters: Of the problem.
        names: Quantities to ask.
        sides: Numbers of sides.
        heading: Of the pyramids [rad].
    """
    cones = [EXACT, *(ConeChoice("inscribed", n, heading) for n in sides)]
    tolerance = min(parameters.get("tolerance", TOLERANCE), TOLERANCE)
    rows: list[Timed] = []
    for quantity in QUANTITIES:
        for cone in cones if quantity.name in names else ():
            for engine in CONIC:
                seconds, _ = _timed(lambda: quantity.ask(stance, parameters, cone, engine))  # noqa: B023
                if seconds is not None:
                    rows.append(Timed(quantity.name, cone.kind, cone.sides, engine, seconds))
            if cone.is_exact:
                continue
            seconds, found = _timed(lambda: by_linear_programs(quantity.name, stance, parameters, cone, tolerance))  # noqa: B023
            if seconds is not None and found.value is not None:
                rows.append(Timed(quantity.name, cone.kind, cone.sides, interface(), seconds, found.inside))
    return rows


def _timed(question: Callable[[], Any]) -> tuple[float | None, Any]:
    """Median CPU time of a question and its last answer; None where the engine does not settle it."""
    try:
        answer = question()
        spent: list[float] = []
        while len(spent) < RUNS and sum(spent) < LONG:
            start = time.process_time()
            answer = question()
            spent.append(time.process_time() - start)
    except EngineError:
        return None, None
    return median(spent), answer
