"""Stances whose margin lies next to the boundary: the centre of mass of one of the population moved along a line until it does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import socp_statics as ss
from socp_statics.contacts import Stance

LOW, HIGH = 1e-7, 1e-6
STEPS = 80


def near_boundary(stance: Stance, rng, **asked):
    """The stance with its centre of mass moved horizontally until the margin is of the order of 1e-7 to 1e-6 W, of a random sign.

    Args:
        stance: Where to start; stable with a finite margin.
        rng: Chooses direction, sign and margin.
        asked: Further arguments of `check_equilibrium`.

    Returns:
        The stance and its answer, or None where there is none on that line.
    """
    from socp_statics.statics import assemble

    units = assemble(stance).units
    angle = rng.uniform(0, 2 * np.pi)
    way = units.length * np.array([np.cos(angle), np.sin(angle), 0.0])
    target = rng.choice([-1.0, 1.0]) * np.exp(rng.uniform(np.log(1.3 * LOW), np.log(0.8 * HIGH)))

    def at(s: float):
        moved = replace(stance, com=stance.com + s * way)
        try:
            answer = ss.check_equilibrium(moved, **asked)
        except ss.EngineError:
            return moved, None, np.nan
        return moved, answer, answer.margin / units.force

    low, high, best = 0.0, 0.25, None
    a = at(low)[2]
    if not (np.isfinite(a) and a > HIGH):
        return None
    b = at(high)[2]
    while np.isfinite(b) and b > target and high < 100.0:
        low, a, high = high, b, 2.0 * high
        b = at(high)[2]
    if np.isnan(b) or b > target:
        return None
    for k in range(STEPS):
        # the margin is concave along the line: the chord overestimates nothing, halving keeps it from creeping
        chord = low + (high - low) * (a - target) / (a - b) if np.isfinite(b) and k % 3 else 0.5 * (low + high)
        stance_there, answer, value = at(chord)
        if np.isnan(value) or chord in (low, high):
            return best
        if LOW < abs(value) < HIGH and np.sign(value) == np.sign(target):
            return stance_there, answer
        if value > target:
            low, a = chord, value
        else:
            high, b = chord, value
    return best
