"""One stance with the exact cone and with pyramids: values, errors and the side of the error, forces that violate the true cone."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from socp_statics.cases.hashing import plain
from socp_statics.comparison.pyramids import HEADINGS, PYRAMIDS, SIDES, checked_headings, checked_sides, pyramids, shown_sides
from socp_statics.comparison.quantities import QUANTITIES, Finding, Quantity, error_of, require_order, rounding
from socp_statics.comparison.violations import violation
from socp_statics.cones.choice import EXACT
from socp_statics.contacts import Stance
from socp_statics.exceptions import InputError

ONE_PERCENT = 0.01


def compared_stance(
    stance: Stance, parameters: Mapping[str, Any], sides: Sequence[int] = SIDES, headings: int = HEADINGS,
    engine: str | Sequence[str] = "auto",
) -> dict[str, Any]:  # fmt: skip
    """All four quantities of a stance with the exact cone and with inscribed and circumscribed pyramids.

    Args:
        stance: The stance.
        parameters: Objective, measure, level, length and tolerance where they are not the usual ones; ``heading`` of the first pyramid.
        sides: Numbers of sides.
        headings: How many headings of each pyramid, spread evenly over what its symmetry leaves.
        engine: "auto", the name of an engine, or several to be tried in turn; the same for cones and pyramids.

    Returns:
        ``exact``, ``left_out``, ``pyramids``, ``spread``, ``sides_for_one_percent`` and ``regions``.

        A row of ``pyramids`` has quantity, kind, sides, heading, value, state, error, relative_error (of a margin over the weight,
        else over the exact value), side ("safe", "unsafe" or "none"), violation (see `violations.Violation`) and engine. ``spread``
        sums them up over the headings, ``regions`` has the corners of the pyramids of four sides, or of the fewest, and the
        ``rays`` of those without end.

    Raises:
        InputError: Sides or headings are wrong.
        EngineError: No engine settled an answer, or a pyramid came out on the wrong side of the cone.
    """
    sides, headings = checked_sides(sides), checked_headings(headings)
    exact: dict[str, Any] = {}
    left_out: dict[str, str] = {}
    rows: list[dict[str, Any]] = []
    regions: dict[str, Any] = {}
    for quantity in QUANTITIES:
        try:
            true = quantity.ask(stance, parameters, EXACT, engine)
        except InputError as error:
            left_out[quantity.name] = str(error)
            continue
        unit = quantity.unit(parameters)
        scale = quantity.scale(stance, unit)
        exact[quantity.name] = {"value": true.value, "unit": unit, "state": true.state, "engine": true.engine}
        for cone in (cone for n in sides for cone in pyramids(n, headings, parameters.get("heading", 0.0))):
            found = quantity.ask(stance, parameters, cone, engine)
            require_order(quantity, cone.kind, true, found, scale)
            rows.append({"quantity": quantity.name, **cone.as_record(), **_row(quantity, true, found, scale, stance)})
            if quantity.name == "region" and cone.sides == shown_sides(sides) and found.polygon is not None:
                regions.setdefault(cone.kind, []).append({"heading": cone.heading, "corners": found.polygon, **_ends(found)})
        if true.polygon is not None:
            regions = {"exact": true.polygon, **_ends(true), "sides": shown_sides(sides), **regions}
    spread = [_spread(rows, q, kind, n) for q in exact for kind in PYRAMIDS for n in sides]
    few = {q: {kind: fewest_sides(spread, q, kind) for kind in PYRAMIDS} for q in exact}
    keys = {"exact": exact, "left_out": left_out, "pyramids": rows, "spread": spread, "sides_for_one_percent": few, "regions": regions}
    found_plain: dict[str, Any] = plain(keys)
    return found_plain


def _ends(found: Finding) -> dict[str, Any]:
    """Directions in which a region has no end, where there are any."""
    return {} if found.rays is None else {"rays": found.rays}


def _row(quantity: Quantity, true: Finding, found: Finding, scale: float, stance: Stance) -> dict[str, Any]:
    """Value, error, its side, and what the forces of the pyramid do to the true cone."""
    error = error_of(true.value, found.value)
    open_ends = sum(one.bound - one.value for one in (true, found) if math.isfinite(one.value))
    none = math.isnan(error) or abs(error) <= rounding(true.value, scale) + open_ends
    unit = scale if quantity.name == "margin" else abs(true.value)
    relative = error / unit if 0.0 < unit < math.inf else math.copysign(math.inf, error)
    beyond = violation(stance.contacts, found.forces())
    return {
        "value": found.value,
        "state": found.state,
        "error": error,
        "relative_error": 0.0 if none else relative,
        "side": "none" if none else "unsafe" if (error > 0.0) == quantity.grows else "safe",
        "violation": beyond._asdict(),
        "engine": found.engine,
    }


def _spread(rows: Sequence[Mapping[str, Any]], quantity: str, kind: str, sides: int) -> dict[str, Any]:
    """Relative errors of one kind of pyramid over its headings: nearest to zero, mean and farthest; the worst violation."""
    mine = [row for row in rows if (row["quantity"], row["kind"], row["sides"]) == (quantity, kind, sides)]
    errors = np.array([row["relative_error"] for row in mine], dtype=float)
    least, most = (errors[int(pick(np.abs(errors)))] for pick in (np.argmin, np.argmax))
    shares, forces = ([row["violation"][key] for row in mine] for key in ("share", "force"))
    return {
        "quantity": quantity,
        "kind": kind,
        "sides": sides,
        "side": next((row["side"] for row in mine if row["side"] != "none"), "none"),
        "least": least,
        "mean": errors.mean() if np.isfinite(errors).all() else most,
        "most": most,
        "violation": max(shares),
        "violating_force": max(forces),
    }


def fewest_sides(spread: Sequence[Mapping[str, Any]], quantity: str, kind: str) -> int | None:
    """The fewest of the sides asked for whose error is within 1 % whatever the heading, and of all with more; None without."""
    mine = [row for row in spread if row["quantity"] == quantity and row["kind"] == kind]
    enough: int | None = None
    for row in sorted(mine, key=lambda r: -r["sides"]):
        if not abs(row["most"]) <= ONE_PERCENT:
            break
        enough = row["sides"]
    return enough
