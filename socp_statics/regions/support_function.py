"""How far can the centre of mass go? The support function of a region, without tracing it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from socp_statics.cones.choice import ConeChoice, cone_choice
from socp_statics.contacts import Stance
from socp_statics.engines import compiled_first, engines_for
from socp_statics.engines.solution import INFEASIBLE, SOLVED, UNBOUNDED
from socp_statics.exceptions import EngineError, InputError
from socp_statics.regions.directions import Directions, com_plane
from socp_statics.regions.question import RegionQuestion, region_question
from socp_statics.spatial import Array
from socp_statics.statics import assemble


class SupportValues(NamedTuple):
    """Of each direction: ``max d . c``, and a position that attains it.

    Attributes:
        height: ``max d . c`` over the region, inf where it has no end, -inf where it is empty, shape (k,) [m].
        position: Where it is attained, nan where it is not, shape (k, 2) [m].
    """

    height: Array
    position: Array


def support_function(
    contacts: Any,
    directions: ArrayLike,
    *,
    height: float = 0.0,
    mass: float | None = None,
    cone: str | ConeChoice = "exact",
    sides: int | None = None,
    heading: float | None = None,
    form: str = "socp",
    engine: str | Sequence[str] = "auto",
    gravity: Any = None,
    external_wrenches: Any = (),
    torque_limits: Any = False,
) -> SupportValues:
    """How far the centre of mass can go in some directions, one conic program each.

    Args:
        contacts: As for `trace_support_region`.
        directions: Horizontal directions, of any length > 0, shape (k, 2).
        height: Height of the centre of mass [m].
        mass: Mass [kg].
        cone: "exact", "inscribed" or "circumscribed", or a ConeChoice.
        sides: Sides of the pyramids.
        heading: Heading of the pyramids [rad].
        form: "socp" or "sdp".
        engine: "auto", the name of an engine, or several to be tried in turn.
        gravity: Acceleration of gravity in world axes, shape (3,) [m/s^2].
        external_wrenches: Wrenches impressed on the robot.
        torque_limits: Whether forces have to respect joint-torque limits, and which.

    Returns:
        Heights along the unit directions, and positions.

    Raises:
        InputError: A number, name or choice is wrong.
        EngineError: No engine settled a program.
    """
    choice = cone_choice(cone, sides, heading)
    question = region_question(contacts, height, mass, gravity, external_wrenches, torque_limits)
    unit = _unit(directions)
    values = SupportValues(np.full(len(unit), np.nan), np.full((len(unit), 2), np.nan))
    if compiled_first(engine, form) and question.compiled:
        _by_the_kernel(question, choice, unit, values)
    left = np.flatnonzero(np.isnan(values.height))
    if len(left):
        _one_by_one(question.stance(), choice, form, engine, unit, left, values)
    return values


def _unit(directions: ArrayLike) -> Array:
    """Directions of length one.

    Raises:
        InputError: They are not (k, 2) finite numbers, or one is zero.
    """
    given = np.array(directions, dtype=float)
    if given.ndim != 2 or given.shape[1] != 2 or not np.isfinite(given).all():
        message = f"directions must be finite numbers of shape (k, 2), got shape {given.shape}"
        raise InputError(message, name="directions", field="directions")
    length = np.linalg.norm(given, axis=1)
    if (length == 0.0).any():
        bad = int(np.flatnonzero(length == 0.0)[0])
        raise InputError(f"directions must not be zero, entry {bad} is", name="directions", field="directions")
    return given / length[:, None]


def _by_the_kernel(question: RegionQuestion, cone: ConeChoice, unit: Array, values: SupportValues) -> None:
    """What the compiled program settles."""
    from socp_statics.engines.kernel.directions import support_values
    from socp_statics.engines.kernel.five_unknowns import SOLVED as FOUND
    from socp_statics.engines.kernel.pyramids import cone_rows

    points = question.contacts.friction_points
    assert points is not None
    status, found = support_values(cone_rows(points, cone), question.load(), unit)
    mine = status == FOUND
    values.position[mine], values.height[mine] = found[mine, :2], found[mine, 2]


def _one_by_one(
    stance: Stance, cone: ConeChoice, form: str, engine: str | Sequence[str], unit: Array, left: NDArray[np.int_], values: SupportValues
) -> None:
    """The rest, by the first engine that settles each."""
    data = assemble(stance)
    plane, units = com_plane(data), data.units
    if plane.twist is not None:
        values.height[left] = -np.inf
        return
    for k in left:
        d = unit[k]
        along = plane.axes.T @ d
        broken: EngineError | None = None
        for one in engines_for(engine, form):
            try:
                solution = Directions(data, plane, cone, form, one).solve(tuple(along)) if len(along) else None
            except EngineError as error:
                broken = error
                continue
            if solution is None or solution.status == SOLVED:
                s = np.zeros(0) if solution is None else np.asarray(solution.variables["s"])
                position = plane.origin + plane.axes @ s
                values.position[k] = units.origin[:2] + units.length * position
                values.height[k] = float(d @ values.position[k])
            elif solution.status in (UNBOUNDED, INFEASIBLE):
                values.height[k] = np.inf if solution.status == UNBOUNDED else -np.inf
            break
        else:
            assert broken is not None
            raise broken
