"""How often a pyramid's verdict is false, and what it does to areas, over a population and under each circumstance.

A circumscribed pyramid errs on the unsafe side: it can call an unstable stance stable. An inscribed one can call a stable stance
unstable. Rates are shares of the stances that can be misjudged that way: falsely stable of the truly unstable, falsely unstable of
the truly stable ones; their confidence intervals are Wilson's.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import combinations
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import binomtest

from socp_statics.cases.hashing import plain
from socp_statics.comparison.population import Population
from socp_statics.comparison.pyramids import shown_sides
from socp_statics.comparison.stance import ONE_PERCENT
from socp_statics.exceptions import EngineError

CONFIDENCE = 0.95
MOST = 0.95
FALSE = {"inscribed": ("falsely unstable", "stable", "unstable"), "circumscribed": ("falsely stable", "unstable", "stable")}
IMPOSSIBLE = {"inscribed": ("unstable", "stable"), "circumscribed": ("stable", "unstable")}
AREA_ROUNDING = 2e-3


def population_tables(population: Population) -> dict[str, Any]:
    """Rates of false verdicts and errors of areas.

    Args:
        population: The stances.

    Returns:
        ``stances``, ``verdicts`` (counts with the exact cone), ``rates``, ``areas`` and ``sides_for_one_percent``. A row of ``rates``
        has kind, sides, error, where (the circumstance, empty for all), of, false, rate, low and high; rate and interval are None
        where no stance could be misjudged. A row of ``areas`` has kind, sides, where, regions (polygons with the exact cone), the
        median, low and high (5 and 95 %) and worst relative error, within (share of regions within 1 %), lost (regions of which
        nothing is left) and endless (regions that the pyramid gives no end).

    Raises:
        EngineError: A verdict or an area is on the side of the cone where its pyramid cannot be.
    """
    _require_order(population)
    rates = [_rate(population, kind, sides, where, mine) for kind, sides, where, mine in _groups(population)]
    areas = [_area(population, kind, sides, where, mine) for kind, sides, where, mine in _groups(population)]
    counts = {word: int((population.exact.verdict == word).sum()) for word in ("stable", "unstable", "undecided")}
    few = {kind: _fewest(areas, kind) for kind in FALSE}
    tables: dict[str, Any] = plain(
        {
            "stances": len(population),
            "verdicts": counts,
            "confidence": CONFIDENCE,
            "engines": population.engines,
            "rates": rates,
            "areas": [row for row in areas if row["regions"]],
            "sides_for_one_percent": few,
        }
    )
    return tables


def _groups(population: Population) -> Iterator[tuple[str, int, dict[str, Any], NDArray[np.bool_]]]:
    """Every pyramid with all stances and with those of each circumstance; pairs of circumstances for the one that sentences speak of."""
    shown = shown_sides([sides for _, sides in population.pyramids])
    everything = np.ones(len(population), dtype=bool)
    for kind, sides in population.pyramids:
        yield kind, sides, {}, everything
        for count in (1, 2) if sides == shown else (1,):
            for names in combinations(population.circumstances, count):
                columns = [population.circumstances[name] for name in names]
                for values in sorted({tuple(row) for row in zip(*(c.tolist() for c in columns), strict=True)}):
                    mine = np.all([column == value for column, value in zip(columns, values, strict=True)], axis=0)
                    yield kind, sides, dict(zip(names, values, strict=True)), mine


def _rate(population: Population, kind: str, sides: int, where: Mapping[str, Any], mine: NDArray[np.bool_]) -> dict[str, Any]:
    words, truth, said = FALSE[kind]
    verdict = population.pyramids[kind, sides].verdict
    at_risk = mine & (population.exact.verdict == truth) & np.isin(verdict, ("stable", "unstable"))
    of, false = int(at_risk.sum()), int((at_risk & (verdict == said)).sum())
    row: dict[str, Any] = {"kind": kind, "sides": sides, "error": words, "where": dict(where), "of": of, "false": false}
    if not of:
        return row | {"rate": None, "low": None, "high": None}
    interval = binomtest(false, of).proportion_ci(CONFIDENCE, method="wilson")
    return row | {"rate": false / of, "low": float(interval.low), "high": float(interval.high)}


def _area(population: Population, kind: str, sides: int, where: Mapping[str, Any], mine: NDArray[np.bool_]) -> dict[str, Any]:
    true, found = population.exact.area, population.pyramids[kind, sides].area
    mine = mine & (true > 0.0) & np.isfinite(true) & ~np.isnan(found)
    error = found[mine] / true[mine] - 1.0
    row = {"kind": kind, "sides": sides, "where": dict(where), "regions": int(mine.sum())}
    if not mine.any():
        return row
    # Order statistics, not interpolated ones: some errors have no end.
    low, median, high = (float(np.quantile(error, q, method="nearest")) for q in (0.05, 0.5, 0.95))
    return row | {
        "median": median,
        "low": low,
        "high": high,
        "worst": float(error[int(np.argmax(np.abs(error)))]),
        "within": float((np.abs(error) <= ONE_PERCENT).mean()),
        "lost": int((found[mine] == 0.0).sum()),
        "endless": int(np.isinf(found[mine]).sum()),
    }


def _fewest(areas: list[dict[str, Any]], kind: str) -> dict[str, int | None]:
    """The fewest sides from which on the median error, and that of 95 % of the regions, is within 1 %."""
    mine = sorted((row for row in areas if row["kind"] == kind and not row["where"] and row["regions"]), key=lambda row: -row["sides"])
    out: dict[str, int | None] = {}
    for word, holds in (("median", lambda row: abs(row["median"]) <= ONE_PERCENT), ("most", lambda row: row["within"] >= MOST)):
        out[word] = None
        for row in mine:
            if not holds(row):
                break
            out[word] = row["sides"]
    return out


def _require_order(population: Population) -> None:
    true = population.exact
    for (kind, sides), found in population.pyramids.items():
        exact, said = IMPOSSIBLE[kind]
        wrong = (true.verdict == exact) & (found.verdict == said)
        small, large = (found.area, true.area) if kind == "inscribed" else (true.area, found.area)
        wrong |= small > large * (1.0 + AREA_ROUNDING) + 1e-12
        for k in np.flatnonzero(wrong)[:1]:
            here = f"{found.verdict[k]}, {found.area[k]:.9g} m^2"
            there = f"{true.verdict[k]}, {true.area[k]:.9g} m^2 with the exact cone"
            message = f"stance {k}: {here} with the {kind} pyramid of {sides} sides is on the wrong side of {there}"
            raise EngineError(message, name=f"stance {k}")
