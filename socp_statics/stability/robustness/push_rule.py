"""The largest disc of pushes that contact forces hold by one affine rule: what a controller without an optimiser can promise."""

from __future__ import annotations

import numpy as np

from socp_statics.engines import engines_for
from socp_statics.exceptions import EngineError
from socp_statics.stability.robustness.ball import Settings
from socp_statics.stability.robustness.disturbances import Disturbance
from socp_statics.stability.robustness.load_slice import LoadSlice
from socp_statics.stability.robustness.measure import EXACT, LOWER, Measure
from socp_statics.stability.robustness.rule import ForceRule, RuleCheck, check_rule, design_rule
from socp_statics.statics import StaticsData


def push_rule(data: StaticsData, disturbance: Disturbance, settings: Settings) -> tuple[ForceRule, RuleCheck] | None:
    """The best affine rule, and its check.

    Args:
        data: Arrays of a stance that holds.
        disturbance: The disturbances.
        settings: How to ask.

    Returns:
        None where no contact force resists some of the disturbances, however small.

    Raises:
        EngineError: No engine settled it, or the rule does not pass the check.
    """
    seen = disturbance.seen()
    details = []
    for one in engines_for(settings.engine, "sdp"):
        try:
            if LoadSlice(data, seen, settings.cone, settings.form, one).unreachable is not None:
                return None
            rule = design_rule(data, seen, settings.cone, settings.form, one)
            check = check_rule(rule, one)
        except EngineError as error:
            details.append(str(error))
            continue
        if check.holds:
            return rule, check
        details.append(f"{one.name}: the rule misses a cone by {-check.slack:.1e} W or the balance by {check.balance:.1e} W")
    raise EngineError(f"the force rule was not settled: {'; '.join(details)}", name="force_rule")


def rule_measure(name: str, unit: str, found: tuple[ForceRule, RuleCheck] | None, disc: Measure, tolerance: float) -> Measure:
    """The radius of a rule as a measure: a lower bound of that of all reactions.

    Args:
        name: Its word.
        unit: Its unit.
        found: Of `push_rule`.
        disc: The largest disc of pushes, held by whatever forces.
        tolerance: Relative difference that counts as none.
    """
    if found is None:
        return Measure(name, 0.0, unit, EXACT, (0.0, 0.0), details={"slack": None, "rule": []})
    rule, check = found
    radius = rule.radius * rule.disturbance.one
    most = max(disc.bracket[1], radius) if disc.bracket else radius
    kind = EXACT if np.isfinite(most) and most - radius <= tolerance * most else LOWER
    note = "one affine rule for all pushes: the largest there is" if kind == EXACT else "by one affine rule; other reactions may hold more"
    return Measure(name, radius, unit, kind, (radius, most), note=note, details={"slack": check.slack, "rule": rule.entries()})
