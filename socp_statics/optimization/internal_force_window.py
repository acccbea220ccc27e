"""The internal-force window: how much internal force keeps every contact in its exact cone and every torque in its limit.

The internal force ``sum_i s_i D_i`` is added to a particular solution F_0 that balances the load; D_i are directions without net wrench.
Two programs give the interval of one direction, support programs in turn the feasible set of two (`window_programs`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from socp_statics.cones.choice import ConeChoice, cone_choice
from socp_statics.contacts.numbers import scalar
from socp_statics.contacts.stance import stance_of
from socp_statics.distribution.closed_form import CLOSED_FORMS
from socp_statics.exceptions import InputError
from socp_statics.optimization.null_directions import independent, null_direction
from socp_statics.optimization.window_programs import WindowEnd, WindowQuestion
from socp_statics.optimization.window_set import WindowSet, empty_set
from socp_statics.optimization.wrench_distribution import distribute
from socp_statics.spatial import Array
from socp_statics.stability import EquilibriumAnswer, check_equilibrium

OTHERS = ("fixed", "free")


@dataclass(frozen=True, eq=False)
class InternalForceWindow:
    """The window of a stance.

    Attributes:
        kind: "interval", "point" or "empty" of one direction, of two also "segment" and "polygon"; "unbounded" where there is an end
            missing.
        lower: The least internal force along the first direction, others as they are asked for; None where empty.
        upper: The largest.
        particular_W: Contact wrenches of the particular solution, world axes, shape (k, 6) [N, N m]; None where the contacts cannot
            balance the load whatever their cones, and the window is empty.
        directions: Contact wrenches per unit in contact frames, shape (1 or 2, k, 6).
        set: Of two directions, the feasible set between an inner and an outer polygon [N]; None of one.
        others: "fixed" or "free".
        engine: Name of the engine.
        equilibrium: Verdict of the stance.
    """

    kind: str
    lower: WindowEnd | None
    upper: WindowEnd | None
    particular_W: Array | None
    directions: Array
    set: WindowSet | None
    others: str
    engine: str
    equilibrium: EquilibriumAnswer = field(repr=False)

    @property
    def width(self) -> float:
        """Upper less lower end [N], 0 where empty."""
        return 0.0 if self.lower is None or self.upper is None else self.upper.value - self.lower.value

    def holds(self, internal_force: float) -> bool:
        """Whether an internal force along the first direction is inside the window."""
        return self.lower is not None and self.upper is not None and self.lower.value <= internal_force <= self.upper.value


def internal_force_window(
    stance: Any,
    directions: Sequence[Any],
    *,
    particular: str = "barycentric",
    others: str = "fixed",
    tolerance: float = 1e-3,
    cone: str | ConeChoice = "exact",
    sides: int | None = None,
    heading: float | None = None,
    form: str = "socp",
    engine: str | Sequence[str] = "auto",
    torque_limits: bool | Mapping[str, Any] = False,
) -> InternalForceWindow:
    """How much internal force keeps every contact in its cone and every torque in its limit.

    Args:
        stance: A Stance or a Posture.
        directions: One or two directions of internal force: each two names of contacts, for the member between them, tension positive; or
            a mapping of contact to force (3) or wrench (6) in world axes about the contact, per unit, without net wrench.
        particular: The closed-form method whose solution the internal force is added to.
        others: "fixed": nothing else changes; "free": all other internal forces may be chosen to keep the contacts in their cones.
        tolerance: Of two directions: (outer area - inner area) / outer area.
        cone: "exact", "inscribed" or "circumscribed", or a ConeChoice.
        sides: Sides of the pyramids.
        heading: Heading of the pyramids [rad].
        form: "socp" or "sdp".
        engine: "auto", the name of an engine, or several to be tried in turn.
        torque_limits: Whether joint-torque limits have to be respected: the robot's own, or a mapping of limits.

    Returns:
        The window. With two directions the interval is that of the first with the second at zero.

    Raises:
        InputError: Not one or two directions, one with a net wrench, or an unknown word.
        EngineError: No engine settled a program.
    """
    if others not in OTHERS:
        raise InputError(f"others must be one of {', '.join(OTHERS)}, got {others!r}", name="others", field="others")
    if particular not in CLOSED_FORMS:
        known = ", ".join(CLOSED_FORMS)
        raise InputError(f"particular must be one of {known}, got {particular!r}", name=str(particular), field="particular")
    if not isinstance(directions, Sequence) or isinstance(directions, str) or len(directions) not in (1, 2):
        raise InputError("directions: one or two directions of internal force are expected", name="directions", field="directions")
    scalar("internal_force_window", "tolerance", tolerance, above=0.0, kind="model")
    choice, posed = cone_choice(cone, sides, heading), stance_of(stance, torque_limits=torque_limits)
    given = [null_direction(posed.contacts, stated) for stated in directions]
    independent(posed.contacts, given)
    base = distribute(posed, particular, cone=choice, form=form, engine=engine)
    equilibrium = check_equilibrium(posed, cone=choice, form=form, engine=engine)
    if base.wrenches_C is None:
        nothing = empty_set(0) if len(given) == 2 else None
        return InternalForceWindow("empty", None, None, None, np.array(given), nothing, others, equilibrium.engine, equilibrium)
    question = WindowQuestion(posed, np.array(given), base.wrenches_C, others, choice, form, engine)
    ends = question.ends()
    found = question.set(tolerance) if len(given) == 2 else None
    kind = _kind(ends, question.data.units.force) if found is None else found.kind
    lower, upper = (None, None) if ends is None else ends
    return InternalForceWindow(kind, lower, upper, base.wrenches_W, np.array(given), found, others, question.engine_used, equilibrium)


def _kind(ends: tuple[WindowEnd, WindowEnd] | None, W: float) -> str:
    if ends is None:
        return "empty"
    lower, upper = (end.value for end in ends)
    if not (np.isfinite(lower) and np.isfinite(upper)):
        return "unbounded"
    return "point" if upper - lower <= 1e-9 * W else "interval"
