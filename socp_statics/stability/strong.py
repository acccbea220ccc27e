"""Strong stability of the robot as one body, 3.7.1: does every force that the contacts may exert keep it at rest?

Of the chapter's four labels, weakly stable is the verdict "stable", strongly unstable is "unstable"; a stance that is stable is strongly
stable if every solution of the contact laws, (3.8) and (3.10) in accelerations, is at rest, and weakly unstable if one is not. It is
not force closure: a robot braced between vertical walls can be held, and may fall all the same.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from socp_statics.contacts import ContactSet, ExternalWrench, Stance
from socp_statics.contacts.stance import stance_of
from socp_statics.exceptions import InputError
from socp_statics.spatial import Array
from socp_statics.stability.contact_modes import OPEN, SLIDE
from socp_statics.stability.equilibrium import EquilibriumAnswer, check_equilibrium
from socp_statics.stability.mode_search import search_modes
from socp_statics.stability.mode_witness import Witness
from socp_statics.stability.one_body import OneBody, one_body
from socp_statics.statics import PointForces, assemble, point_forces

Label = Literal["strong", "not_strong", "undecided"]


@dataclass(frozen=True, eq=False)
class AccelerationWitness:
    """Forces that obey every contact law on the exact cones and leave the robot accelerating.

    Attributes:
        linear: Acceleration of the centre of mass, world axes, shape (3,) [m/s^2].
        angular: Angular acceleration, world axes, shape (3,) [rad/s^2].
        forces: The reactions.
        contacts: What each contact does: "holds", "slides" or "opens"; the most that one of its points does.
        residual: Largest violation of the equation of motion and of the contact laws, in units of W and of the fall under it.
    """

    linear: Array
    angular: Array
    forces: PointForces
    contacts: dict[str, str]
    residual: float

    def as_record(self) -> dict[str, Any]:
        """The record's entry."""
        return {
            "linear": self.linear.tolist(),
            "angular": self.angular.tolist(),
            "forces": self.forces.entries(),
            "contacts": dict(self.contacts),
            "residual": self.residual,
        }


@dataclass(frozen=True, eq=False)
class StrongAnswer:
    """The answer to "does every valid contact force keep it at rest?".

    Attributes:
        strong: "strong", "not_strong" or "undecided".
        by: What decided: "verdict" (no force holds it, or whether one does is open), "frictionless" (normal forces alone hold it),
            "contact_modes" (all modes were gone through), "witness" (an acceleration was found) or "soft_finger" (not asked there).
        statement: The reason in words.
        witness: The acceleration behind "not_strong" where the stance is weakly stable, else None.
        equilibrium: The weak answer.
    """

    strong: Label
    by: str
    statement: str
    witness: AccelerationWitness | None
    equilibrium: EquilibriumAnswer


def check_strong_stability(
    contacts: Any,
    com: Any = None,
    mass: float | None = None,
    *,
    inertia: Any = None,
    engine: str | Sequence[str] = "auto",
    gravity: Any = None,
    external_wrenches: Iterable[ExternalWrench | dict[str, Any]] = (),
) -> StrongAnswer:
    """Whether the robot, as one body, stays at rest whatever its contacts do within their laws (exact cones).

    A contact whose normal force is bounded stands on something that gives way along the normal where the force is at a bound, and only
    there; equal bounds are a force that acts whatever the robot does. Handle components with limits yield likewise.

    Args:
        contacts: Contacts; a Stance, which brings everything else; or a Posture, which brings centre of mass, mass and inertia.
        com: Centre of mass in world axes, shape (3,) [m].
        mass: Mass [kg].
        inertia: Inertia about the centre of mass in world axes, shape (3, 3) [kg m^2]; that of the robot with its joints locked by default.
        engine: As for `check_equilibrium`.
        gravity: Acceleration of gravity in world axes, shape (3,) [m/s^2].
        external_wrenches: Wrenches impressed on the robot.

    Returns:
        The answer.

    Raises:
        InputError: A number, name or choice is wrong, there are torque limits, or the answer depends on an inertia that is not given.
        EngineError: No engine settled a program.
    """
    stance = stance_of(contacts, com, mass, gravity, external_wrenches)
    if inertia is not None:
        stance = replace(stance, inertia=inertia)
    if stance.torque_limits is not None:
        message = "stance 'posture': strong stability is that of one body with locked joints, torque_limits = false is expected"
        raise InputError(message, name="posture", field="torque_limits")
    return strong_answer(stance, check_equilibrium(stance, engine=engine), engine)


def strong_answer(stance: Stance, weak: EquilibriumAnswer, engine: str | Sequence[str] = "auto") -> StrongAnswer:
    """The answer of a stance whose weak answer on exact cones is known.

    Args:
        stance: The stance, without torque limits.
        weak: Of `check_equilibrium`.
        engine: As for `check_equilibrium`.

    Raises:
        InputError: The answer depends on an inertia that is not given.
        EngineError: No engine settled a program.
    """
    if weak.verdict == "unstable":
        return StrongAnswer("not_strong", "verdict", "no contact force keeps it at rest", None, weak)
    if weak.verdict != "stable":
        return StrongAnswer("undecided", "verdict", "whether any contact force keeps it at rest is open", None, weak)
    if check_equilibrium(_without_friction(stance), engine=engine).stable:
        words = "normal forces alone keep it at rest, so that no acceleration could gain energy, whatever the inertia: proved"
        return StrongAnswer("strong", "frictionless", words, None, weak)
    data = assemble(stance)
    if data.box + data.elliptic:
        return StrongAnswer("undecided", "soft_finger", "contact modes of soft fingers are not gone through", None, weak)
    body = one_body(stance, data)
    found = search_modes(body)
    if found.outcome == "rest":
        return StrongAnswer("strong", "contact_modes", f"no acceleration obeys the contact laws: {found.reason}", None, weak)
    if found.witness is None:
        return StrongAnswer("undecided", "contact_modes", found.reason, None, weak)
    witness = in_si(body, found.witness)
    moved = ", ".join(f"{name} {word}" for name, word in witness.contacts.items() if word != "holds")
    return StrongAnswer("not_strong", "witness", f"{found.reason} ({moved or 'every contact holds'})", witness, weak)


def in_si(body: OneBody, witness: Witness) -> AccelerationWitness:
    """A witness in SI units and by contact."""
    linear, angular = body.in_si(witness.a)
    data, words = body.data, {}
    for k, name in enumerate(data.names):
        mode = witness.mode[data.contact_of_point == k].tolist()
        words[name] = "opens" if mode and all(one == OPEN for one in mode) else "slides" if SLIDE in mode else "holds"
        if words[name] == "holds" and OPEN in mode and float((body.point_rows[data.contact_of_point == k, 2] @ witness.a).max()) > 1e-9:
            words[name] = "opens"
    return AccelerationWitness(linear, angular, point_forces(data, witness.x), words, witness.residual)


def _without_friction(stance: Stance) -> Stance:
    contacts = [c.placed(np.array(c.position), np.array(c.rotation), 0.0) if c.unilateral else c for c in stance.contacts]
    return replace(stance, contacts=ContactSet(contacts))
