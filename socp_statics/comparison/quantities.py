"""The four quantities that are compared, asked with one cone after the other.

A wider cone holds more forces: margin and region grow with it, the least of a force objective falls. Hence

    inscribed <= exact <= circumscribed     margin, area of the region
    inscribed >= exact >= circumscribed     force optimisation, minimax
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

from socp_statics.cones.choice import ConeChoice
from socp_statics.contacts import Stance
from socp_statics.exceptions import EngineError
from socp_statics.optimization import minimise_largest_wrench, optimise_contact_forces
from socp_statics.optimization.force_answer import ForceAnswer
from socp_statics.regions import trace_support_region
from socp_statics.spatial import Array
from socp_statics.stability import check_equilibrium
from socp_statics.statics import PointForces

TOLERANCE = 1e-4
SAME, NOTHING = 1e-6, 1e-8

Engines = str | Sequence[str]


class Finding(NamedTuple):
    """One quantity with one cone.

    Attributes:
        value: Margin [N], area [m^2] or objective; inf where a region or a margin has no end, or no forces balance.
        bound: The value from the other side, where an answer is enclosed: the outer area; else the value itself.
        state: Verdict, kind of region or status.
        forces: Gives the forces of the answer, of a region one choice for each corner; made when they are asked for.
        engine: Name of the engine that answered.
        polygon: Attained corners of a region, shape (k, 2) [m]; else None.
        rays: Directions in which a region has no end, shape (r, 2); else None.
    """

    value: float
    bound: float
    state: str
    forces: Callable[[], tuple[PointForces, ...]]
    engine: str
    polygon: Array | None = None
    rays: Array | None = None


Ask = Callable[[Stance, Mapping[str, Any], ConeChoice, Engines], Finding]


class Quantity(NamedTuple):
    """What is compared.

    Attributes:
        name: As in the comparison's rows.
        title: In words.
        grows: Whether a wider cone makes it larger; else smaller.
        unit: ``parameters -> unit``.
        scale: ``(stance, unit) -> value`` of the size that values usually have, for rounding.
        ask: The question.
    """

    name: str
    title: str
    grows: bool
    unit: Callable[[Mapping[str, Any]], str]
    scale: Callable[[Stance, str], float]
    ask: Ask


def _margin(stance: Stance, parameters: Mapping[str, Any], cone: ConeChoice, engine: Engines) -> Finding:
    found = check_equilibrium(stance, cone=cone, engine=engine)
    return Finding(found.margin, found.margin, found.verdict, lambda: _one(found.forces), found.engine)


def _region(stance: Stance, parameters: Mapping[str, Any], cone: ConeChoice, engine: Engines) -> Finding:
    region = trace_support_region(stance, min(parameters.get("tolerance", TOLERANCE), TOLERANCE), cone=cone, engine=engine)
    if region.kind == "unbounded":
        return Finding(math.inf, math.inf, region.kind, tuple, region.engine, region.inner, region.rays)
    return Finding(region.inner_area, region.outer_area, region.kind, lambda: region.inner_forces, region.engine, region.inner)


def _forces(stance: Stance, parameters: Mapping[str, Any], cone: ConeChoice, engine: Engines) -> Finding:
    found = optimise_contact_forces(
        stance,
        parameters.get("objective", "least_squares"),
        reference_forces=parameters.get("reference_forces"),
        rates=parameters.get("rates"),
        b=parameters.get("b"),
        cone=cone,
        engine=engine,
    )
    return _of_forces(found)


def _minimax(stance: Stance, parameters: Mapping[str, Any], cone: ConeChoice, engine: Engines) -> Finding:
    measure, level = parameters.get("measure", "force"), parameters.get("level", "point")
    found = minimise_largest_wrench(stance, measure, level, length=parameters.get("length", 0.1), cone=cone, engine=engine)
    return _of_forces(found)


def _of_forces(found: ForceAnswer) -> Finding:
    value = math.inf if found.objective is None else found.objective
    return Finding(value, value, found.status, lambda: _one(found.forces), found.engine)


def _one(forces: PointForces | None) -> tuple[PointForces, ...]:
    return () if forces is None else (forces,)


def _objective_unit(parameters: Mapping[str, Any]) -> str:
    return {"normal_force": "N", "orin_oh": "W"}.get(parameters.get("objective", "least_squares"), "N^2")


def _measure_unit(parameters: Mapping[str, Any]) -> str:
    return "1" if parameters.get("measure") == "friction_use" else "N"


def _force_scale(stance: Stance, unit: str) -> float:
    weight = stance.weight or 1.0
    return {"N": weight, "N^2": weight**2, "W": weight}.get(unit, 1.0)


def _area_scale(stance: Stance, unit: str) -> float:
    return stance.contacts.size**2


QUANTITIES = (
    Quantity("margin", "margin", True, lambda _: "N", _force_scale, _margin),
    Quantity("region", "area of the support region", True, lambda _: "m^2", _area_scale, _region),
    Quantity("contact_forces", "force optimisation", False, _objective_unit, _force_scale, _forces),
    Quantity("minimax_wrench", "minimax wrench", False, _measure_unit, _force_scale, _minimax),
)


def error_of(exact: float, found: float) -> float:
    """Found minus exact, zero where both have no end."""
    return 0.0 if found == exact else found - exact


def rounding(exact: float, scale: float) -> float:
    """Below what an error is none: a part of the value, and a smaller one of the size that values have."""
    return (SAME * abs(exact) if math.isfinite(exact) else 0.0) + NOTHING * scale


def require_order(quantity: Quantity, kind: str, exact: Finding, found: Finding, scale: float) -> None:
    """Refuse a pyramid on the wrong side of the cone, which only a numerical failure can put there.

    Args:
        quantity: Which.
        kind: "inscribed" or "circumscribed".
        exact: With the exact cone.
        found: With the pyramid.
        scale: Size that values usually have, for rounding.

    Raises:
        EngineError: It is on the wrong side.
    """
    inside, outside = (found, exact) if (kind == "inscribed") == quantity.grows else (exact, found)
    small, large = inside.value, outside.bound
    if math.isnan(small) or math.isnan(large) or small <= large or small <= large + rounding(exact.value, scale):
        return
    message = f"{quantity.title}: {found.value:.9g} with the {kind} pyramid is on the wrong side of {exact.value:.9g} with the exact cone"
    raise EngineError(message, name=quantity.name)
