"""What a pyramid costs, and when it is unsafe, in one sentence."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from socp_statics.comparison.pyramids import PYRAMIDS, shown_sides
from socp_statics.comparison.times import Timed

NUMBERS = {3: "three", 4: "four", 5: "five", 6: "six", 8: "eight"}
# Fewer stances that could be misjudged than these say little about where a rate is highest.
ENOUGH = 20
NO_CHANGE = 1e-9
TITLES = {
    "margin": "of the weight in margin",
    "region": "of the region's area",
    "contact_forces": "of the force objective",
    "minimax_wrench": "of the minimax wrench",
}


def stance_sentence(keys: Mapping[str, Any], sides: Sequence[int]) -> str:
    """What the pyramid of four sides, or the fewest, costs one stance.

    Args:
        keys: Of `stance.compared_stance`.
        sides: Numbers of sides.
    """
    shown = shown_sides(sides)
    name = f"A {NUMBERS.get(shown, str(shown))}-sided pyramid"
    rows = {(row["quantity"], row["kind"]): row for row in keys["spread"] if row["sides"] == shown}
    costs = {kind: [_cost(row, keys["exact"]) for (_, k), row in rows.items() if k == kind and row["side"] != "none"] for kind in PYRAMIDS}
    lost, won = (list(dict.fromkeys(costs[kind])) for kind in PYRAMIDS)
    if not lost and not won:
        return f"{name} costs nothing here and is not unsafe: none of the answers depends on the shape of the friction cones."
    safe = f"costs {_joined(lost)} when it is inscribed, which is safe" if lost else "costs nothing here when it is inscribed"
    unsafe = f"is wrong by {_joined(won)} when it is circumscribed, which is unsafe" if won else "is not unsafe when it is circumscribed"
    worst = max((row["violation"] for (_, kind), row in rows.items() if kind == "circumscribed"), default=0.0)
    beyond = f": its forces exceed the true cones by up to {_percent(worst)}" if won and worst > 0.0 else ""
    told = ", and it calls an unstable stance stable" if _changes_verdict(keys, shown) else ""
    return f"{name} {safe}, and {unsafe}{beyond}{told}; ranges are over its arbitrary heading."


def population_sentence(tables: Mapping[str, Any], sides: Sequence[int]) -> str:
    """What the pyramid of four sides, or the fewest, costs a population.

    Args:
        tables: Of `rates.population_tables`.
        sides: Numbers of sides.
    """
    shown = shown_sides(sides)
    rates = {row["kind"]: row for row in tables["rates"] if row["sides"] == shown and not row["where"]}
    areas = {row["kind"]: row for row in tables["areas"] if row["sides"] == shown and not row["where"]}
    parts = []
    for kind in PYRAMIDS:
        if kind in rates and rates[kind]["of"]:
            parts.append(_population_part(kind, rates[kind], areas.get(kind), _extremes(tables, kind, shown)))
    told = "; ".join(parts) if parts else "no stance could be misjudged"
    return f"Over {tables['stances']} stances a {NUMBERS.get(shown, str(shown))}-sided pyramid costs this: {told}{_one_percent(tables)}."


def _population_part(kind: str, rate: Mapping[str, Any], area: Mapping[str, Any] | None, most: str) -> str:
    """What one kind of pyramid does to verdicts and areas."""
    truth, said = ("stable", "unstable") if kind == "inscribed" else ("unstable", "stable")
    part = f"{kind} it calls {_interval(rate)} of the {truth} ones {said}{most}"
    changed = rate["false"] > 0
    if area is not None:
        worst = abs(float(area["worst"]))
        changed = changed or worst > NO_CHANGE
        verb = "loses" if kind == "inscribed" else "adds"
        median = _percent(abs(float(area["median"])))
        part += f" and {verb} {median} of a region's area (median)" if worst > NO_CHANGE else " and changes no area"
    return part + (f", which is {'safe' if kind == 'inscribed' else 'unsafe'}" if changed else "")


def time_sentence(times: Sequence[Timed], sides: Sequence[int]) -> str:
    """What the exact cone takes beside the pyramid of four sides, or the fewest: the region, or whatever was timed first.

    Args:
        times: Of `times.times`.
        sides: Numbers of sides.
    """
    shown, names = shown_sides(sides), list(dict.fromkeys(t.quantity for t in times))
    if not names:
        return ""
    name = "region" if "region" in names else names[0]
    mine = [t for t in times if t.quantity == name]
    exact = [f"{1e3 * t.seconds:.2g} ms by {t.engine}" for t in mine if t.cone == "exact"]
    pyramid = [
        f"{1e3 * t.seconds:.2g} ms by {t.engine}" + (f" ({1e3 * t.inside:.2g} ms of it inside)" if t.inside is not None else "")
        for t in mine
        if t.sides == shown
    ]
    if not exact or not pyramid:
        return ""
    words = NUMBERS.get(shown, str(shown))
    return f"The exact {name} takes {_joined(exact)}, that of the inscribed {words}-sided pyramid {_joined(pyramid)} (CPU time)."


def _extremes(tables: Mapping[str, Any], kind: str, sides: int) -> str:
    """Where the rate is highest, among single circumstances with enough stances."""
    rows = [r for r in tables["rates"] if (r["kind"], r["sides"]) == (kind, sides) and len(r["where"]) == 1 and r["of"] >= ENOUGH]
    if not rows:
        return ""
    most = max(rows, key=lambda row: row["rate"])
    ((name, value),) = most["where"].items()
    return f", most at {name} {value} ({_percent(most['rate'])})" if most["rate"] > 0.0 else ""


def _one_percent(tables: Mapping[str, Any]) -> str:
    few = tables["sides_for_one_percent"]
    if not tables["areas"] or set(few) != {"inscribed", "circumscribed"}:
        return ""
    half = [few[kind]["median"] for kind in few]
    most = [few[kind]["most"] for kind in few]
    asked = max(row["sides"] for row in tables["areas"])
    if None in half:
        return f"; even {asked} sides do not bring the median area within 1 %"
    near = f"; {max(half)} sides bring the median area within 1 %"
    if None in most:
        return f"{near}, but even with {asked} more than 5 % of the regions are farther off"
    return f"{near}, {max(most)} that of 95 % of the regions"


def _changes_verdict(keys: Mapping[str, Any], sides: int) -> bool:
    margin = keys["exact"].get("margin")
    rows = [row for row in keys["pyramids"] if row["quantity"] == "margin" and row["sides"] == sides]
    return bool(margin) and margin["state"] == "unstable" and any(row["state"] == "stable" for row in rows)


def _cost(row: Mapping[str, Any], exact: Mapping[str, Any]) -> str:
    name, least, most = row["quantity"], abs(float(row["least"])), abs(float(row["most"]))
    if math.isinf(most):
        nothing = exact[name]["value"] == 0.0
        wide = {"margin": "an infinite margin", "region": "a region where there is none" if nothing else "a region without end"}
        narrow = {"margin": "all that is infinite of the margin", "region": "all that has no end of the region"}
        return (wide if row["kind"] == "circumscribed" else narrow).get(
            name, "forces where none balance" if row["kind"] == "circumscribed" else "all balancing forces"
        )
    low, high = _percent(least), _percent(most)
    span = high if low == high else f"up to {high}" if least == 0.0 else f"{low.removesuffix(' %')} to {high}"
    return f"{span} {TITLES[name]}"


def _interval(row: Mapping[str, Any]) -> str:
    return f"{_percent(row['rate'])} ({_percent(row['low']).removesuffix(' %')} to {_percent(row['high'])})"


def _percent(share: float) -> str:
    if not math.isfinite(share):
        return "without end"
    return f"{100.0 * share:.2g} %" if abs(share) < 0.995 else f"{100.0 * share:.0f} %"


def _joined(parts: Sequence[str]) -> str:
    return parts[0] if len(parts) == 1 else f"{', '.join(parts[:-1])} and {parts[-1]}"
