"""How far contacts may be from where they are thought to be: a bound from below by a fixed point, one from above by examples.

Let every contact be displaced by at most r, each in its own direction. Forces f that would balance the load at the stated places leave
the moment ``sum d_k x F_k`` of at most ``r sum |F_k|``. Let M(s) be the radius of the largest ball of moments that can be balanced, on
top of the load, by forces with ``sum |F_k| <= s``. The forces that balance a moment e are a convex set that depends on e with a closed
graph, and so is what they leave; where ``r s <= M(s)`` what is left stays inside the ball, so that some e is left by forces that balance
it (Kakutani): these hold the displaced posture. Hence every ``r = M(s) / s`` is safe, and the best s is looked for.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from socp_statics.contacts import ContactSet, Stance
from socp_statics.engines.engine import Engine
from socp_statics.exceptions import EngineError
from socp_statics.spatial import Array
from socp_statics.stability.equilibrium import EquilibriumAnswer, check_equilibrium
from socp_statics.stability.robustness.ball import Settings, settled
from socp_statics.stability.robustness.disturbances import moments
from socp_statics.stability.robustness.inscribed import distances, largest_inscribed
from socp_statics.stability.robustness.load_slice import LoadSlice
from socp_statics.stability.robustness.measure import Measure, bracketed
from socp_statics.statics import StaticsData

# Sums of force magnitudes that are tried, in units of the load, and how closely each ball of moments is looked for.
TOTALS = tuple(float(s) for s in np.geomspace(1.0, 8.0, 7))
REFINED = 6
MOMENTS = 1e-2
QUERIES = 60
HALVINGS = 12


def contact_placement(stance: Stance, data: StaticsData, answer: EquilibriumAnswer, com_error: Measure, settings: Settings) -> Measure:
    """Displacement that every contact may have, each in any direction, while the rest of the posture stays [m].

    Args:
        stance: A stance that holds, without torque limits.
        data: Its arrays.
        answer: Its verdict, whose prices say which way each contact had better not be displaced.
        com_error: Largest ball of CoM errors: displacing all contacts alike is displacing the CoM the other way.
        settings: How to ask.

    Returns:
        A lower bound, with an upper end from displacements that are shown to fail.

    Raises:
        EngineError: No engine settled it.
    """
    name, unit = "placement", "m"

    def ask(engine: Engine) -> Measure:
        length = data.units.length
        values = {s: _safe(data, s, settings, engine) for s in TOTALS}
        best = max(values, key=lambda s: values[s])
        step = TOTALS[1] / TOTALS[0]
        for _ in range(REFINED if values[best] > 0.0 else 0):
            step = step**0.5
            for s in (best / step, best * step):
                values.setdefault(s, _safe(data, s, settings, engine))
            best = max(values, key=lambda s: values[s])
        lower = values[best] * length
        upper, worst = _fails(stance, data, answer, settings)
        if com_error.bracket is not None and com_error.bracket[1] < upper:
            upper, worst = com_error.bracket[1], "all contacts alike"
        upper = max(upper, lower)
        found = bracketed(name, unit, lower, upper, settings.tolerance, details={"fails": worst})
        return found

    return settled(settings, name, ask)


def _safe(data: StaticsData, total: float, settings: Settings, engine: Engine) -> float:
    """``M(s) / s``, scaled; 0 where forces of that sum balance no ball of moments."""
    what = moments(data)
    seen = what.seen()
    try:
        slice_ = LoadSlice(data, seen, settings.cone, settings.form, engine, total)
        if slice_.unreachable is not None:
            return 0.0
        found = largest_inscribed(slice_, distances, MOMENTS, QUERIES)
    except EngineError:
        # No forces of that sum balance the load: such a sum is no candidate.
        return 0.0
    return seen.one / what.one * found.lower / total if np.isfinite(found.lower) else 0.0


def _fails(stance: Stance, data: StaticsData, answer: EquilibriumAnswer, settings: Settings) -> tuple[float, str | None]:
    """The least displacement found that is shown to fail, along what the margin pays most for [m]."""
    if answer.prices is None:
        return np.inf, None
    ways = {name: -gain / np.linalg.norm(gain) for name, gain in answer.prices.moving}
    if not ways:
        return np.inf, None

    def unstable(r: float) -> bool:
        moved = replace(stance, contacts=_displaced(stance.contacts, {name: r * way for name, way in ways.items()}))
        return check_equilibrium(moved, cone=settings.cone, form=settings.form, engine=settings.engine).verdict == "unstable"

    holds, fails = 0.0, 0.05 * data.units.length
    while not unstable(fails):
        holds, fails = fails, 2.0 * fails
        if fails > 4.0 * data.units.length:
            return np.inf, None
    for _ in range(HALVINGS):
        middle = 0.5 * (holds + fails)
        holds, fails = (holds, middle) if unstable(middle) else (middle, fails)
    return fails, ", ".join(f"{name} along [{', '.join(f'{v:.2f}' for v in way + 0.0)}]" for name, way in ways.items())


def _displaced(contacts: ContactSet, by: dict[str, Array]) -> ContactSet:
    none = np.zeros(3)
    return ContactSet(c.placed(c.position + by.get(c.name, none), c.rotation.copy(), c.friction) for c in contacts)
