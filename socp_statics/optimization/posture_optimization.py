"""Better postures on the same contacts: static posture optimisation (3.7.2)."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from socp_statics.cones.choice import ConeChoice, cone_choice
from socp_statics.contacts import ExternalWrench, Stance
from socp_statics.contacts.stance import stance_of
from socp_statics.exceptions import InputError
from socp_statics.optimization.posture_answer import PostureAnswer, answer_of_climb
from socp_statics.optimization.posture_program import AtPosture, Question
from socp_statics.optimization.posture_search import climbed
from socp_statics.postures import Posture
from socp_statics.postures.held_contacts import HeldContacts
from socp_statics.postures.moved import require_derivatives, require_free_hands
from socp_statics.registry import nearest

OBJECTIVES = ("margin", "com_margin", "torque")
# Share of the torque limits to be spared before the margin is asked for.
SPARE = 1e-3


def optimise_posture(
    stance: Any,
    objective: str = "margin",
    *,
    slide: Collection[str] = (),
    cone: str | ConeChoice = "exact",
    sides: int | None = None,
    heading: float | None = None,
    form: str = "socp",
    engine: str | Sequence[str] = "auto",
    gravity: Any = None,
    external_wrenches: Iterable[ExternalWrench | dict[str, Any]] = (),
    torque_limits: bool | Mapping[str, Any] = False,
) -> PostureAnswer:
    """The nearest locally optimal posture with the same contacts.

    Every step solves the statics exactly in the forces and linearised in the motion, a second-order cone program, within a trust
    radius; the result is brought back onto the contacts, and accepted if the margin recomputed there has grown.

    Args:
        stance: A Posture, or a Stance with one.
        objective: "margin" for the largest normal-force margin, "com_margin" for the largest distance of the centre of mass to the edge of
            its support region, "torque" for the least worst share of the torque limits.
        slide: Contacts that may slide in their plane, to choose where they touch.
        cone: "exact", "inscribed" or "circumscribed", or a ConeChoice.
        sides: Sides of the pyramids.
        heading: Heading of the pyramids [rad].
        form: "socp" or "sdp", of the programs that judge both postures; the search uses second-order cones.
        engine: "auto", the name of an engine, or several to be tried in turn.
        gravity: Acceleration of gravity in world axes, shape (3,) [m/s^2].
        external_wrenches: Wrenches impressed on the robot; they stay in the world when the robot moves.
        torque_limits: Whether forces have to respect joint-torque limits; "torque" needs them.

    Returns:
        The result; where nothing can be improved it is the given posture, with the reason.

    Raises:
        InputError: No robot, an unknown objective or contact, no torque limits where they are needed, an object held, or
            nothing free to move.
        EngineError: No engine settled a program.
    """
    if objective not in OBJECTIVES:
        message = f"objective must be one of {', '.join(OBJECTIVES)}, got {objective!r}{nearest(str(objective), OBJECTIVES)}"
        raise InputError(message, name="objective", field="objective")
    given = stance_of(stance, gravity=gravity, external_wrenches=external_wrenches, torque_limits=torque_limits)
    if given.posture is None:
        raise InputError("stance 'posture': a posture can only be optimised with a robot, contacts alone have no joints", name="posture")
    if objective == "torque" and (given.torque_limits is None or not np.isfinite(given.torque_limits).any()):
        message = "objective 'torque' is about the torque limits: torque_limits with at least one finite limit are expected"
        raise InputError(message, name="objective", field="objective")
    require_derivatives(given.posture.robot)
    require_free_hands(given.posture)
    held = HeldContacts(given.posture, slide)
    if held.motions(given.posture).shape[1] == 0:
        message = f"nothing is free to move: the contacts {', '.join(given.posture.support)} hold every joint"
        raise InputError(message, name="posture", field="support")
    question = Question(_restated(given), held, objective, cone_choice(cone, sides, heading), engine)
    start = AtPosture(question, given.posture)
    if start.settled or start.without_edge or objective == "torque" or given.torque_limits is None:
        return answer_of_climb(given, climbed(start), form)
    # the limits leave no forces at all: first the motors' share, until they do
    eased = climbed(AtPosture(replace(question, objective="torque"), given.posture), enough=-1.0 + SPARE)
    if not eased.at.value > -1.0:
        reason = f"no posture nearby keeps the torque limits: the least worst share found is {-eased.at.value:.4g}"
        return answer_of_climb(given, replace(eased, at=start, reason=reason, optimality=None), form)
    ended = climbed(AtPosture(question, eased.at.posture))
    return answer_of_climb(given, replace(ended, steps=ended.steps + eased.steps), form)


def _restated(given: Stance) -> Any:
    """The stance of another posture under the same loads and limits."""

    def of(posture: Posture) -> Stance:
        return Stance(posture.contacts, posture.com_W, given.mass, given.gravity, given.external_wrenches, given.inertia, posture,
                      given.torque_limits)  # fmt: skip

    return of
