"""How much friction a posture needs, and whether it holds for all coefficients of an interval."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from socp_statics.certificates import MotionCertificate
from socp_statics.contacts import Contact, ContactSet, Handle, SoftFingerContact, Stance
from socp_statics.contacts.contact import contact_from_statement
from socp_statics.contacts.numbers import interval
from socp_statics.exceptions import EngineError, InputError
from socp_statics.stability.equilibrium import EquilibriumAnswer, check_equilibrium
from socp_statics.stability.robustness.ball import Settings
from socp_statics.stability.robustness.measure import EXACT, LOWER, UPPER, Measure, bracketed

# The bracket of the critical scale, relative; and the largest scale that is tried.
WIDTH = 1e-6
MOST = 1024.0
DEFAULT = "default"


def with_friction(contact: Contact, friction: float, scale: float = 1.0) -> Contact:
    """A contact with another coefficient.

    Args:
        contact: The contact.
        friction: Its coefficient, 0 for none.
        scale: Of the torsional coefficient of a soft finger.
    """
    if isinstance(contact, SoftFingerContact) and friction > 0.0 and scale != 1.0:
        return contact_from_statement(
            contact.statement() | {"friction": friction, "torsional_friction": scale * contact.torsional_friction}
        )
    return contact.placed(contact.position.copy(), contact.rotation.copy(), friction)


def scaled_friction(stance: Stance, scale: float) -> Stance:
    """The stance with every coefficient, torsional ones too, multiplied by a scale >= 0."""
    return replace(stance, contacts=ContactSet(with_friction(c, scale * c.friction, scale) for c in stance.contacts))


def critical_friction(stance: Stance, settings: Settings) -> Measure:
    """The smallest common scale of all friction coefficients, torsional ones too, with which the posture still holds.

    Bisected between a scale with balancing forces and one with a motion that nothing prevents; cones grow with the scale, so that the
    truth lies between. Above 1 the posture does not hold as it is.

    Args:
        stance: The stance; bounds, handle limits and torque limits stay as they are.
        settings: How to ask.

    Returns:
        The upper end of the bracket, where it holds.

    Raises:
        EngineError: A verdict was not settled.
    """
    name, unit = "friction", "1"

    def verdict(scale: float) -> EquilibriumAnswer:
        return check_equilibrium(scaled_friction(stance, scale), cone=settings.cone, form=settings.form, engine=settings.engine)

    without = verdict(0.0)
    if without.stable:
        return Measure(name, 0.0, unit, EXACT, (0.0, 0.0), note="it holds without friction")
    slides, holds, motion = 0.0, 1.0, _motion(without)
    while (answer := verdict(holds)).verdict != "stable":
        if answer.verdict == "unstable":
            slides, motion = holds, _motion(answer)
        if holds >= MOST:
            return _never(answer, slides, motion, stance, settings)
        holds *= 2.0
    while holds - slides > WIDTH * holds and holds > WIDTH:
        # Near the critical scale forces may be too large, or the margin too small, to tell: then a little aside of the middle.
        for share in (0.5, 0.75, 0.25):
            scale = slides + share * (holds - slides)
            tried = _tried(verdict, scale)
            if tried is not None:
                break
        else:
            break
        if tried.stable:
            holds = scale
        else:
            slides, motion = scale, _motion(tried)
    found = bracketed(name, unit, slides, holds, settings.tolerance, beyond=motion)
    exact = found.kind == EXACT or holds <= WIDTH
    return replace(found, value=holds, kind=EXACT if exact else UPPER, note="any friction will do" if holds <= WIDTH else None)


def _tried(verdict: Callable[[float], EquilibriumAnswer], scale: float) -> EquilibriumAnswer | None:
    """The verdict at a scale, None where it decides nothing."""
    try:
        answer = verdict(scale)
    except EngineError:
        return None
    return None if answer.verdict == "undecided" else answer


def _motion(answer: EquilibriumAnswer) -> MotionCertificate | None:
    return answer.certificate if isinstance(answer.certificate, MotionCertificate) else None


def _never(answer: EquilibriumAnswer, slides: float, motion: MotionCertificate | None, stance: Stance, settings: Settings) -> Measure:
    """The answer where the largest scale tried does not hold either: is there any that does?"""
    name, unit = "friction", "1"
    if answer.verdict != "unstable":
        return Measure(name, None, unit, None, note="undecided: on the boundary of what can be held, whatever the friction")
    if stance.torque_limits is None:
        sticking = check_equilibrium(_sticking(stance), cone="exact", form=settings.form, engine=settings.engine)
        if sticking.verdict == "unstable":
            note = "no friction can hold it"
            return Measure(name, np.inf, unit, EXACT, (np.inf, np.inf), note=note, beyond=_motion(sticking))
    note = f"it does not hold with {MOST:g} times the friction either"
    return Measure(name, np.inf, unit, LOWER, (slides, np.inf), note=note, beyond=motion)


def _sticking(stance: Stance) -> Stance:
    """The stance with friction without limit: normal forces that push, and whatever tangential forces and torsion."""
    contacts: list[Contact] = []
    for c in stance.contacts:
        if not c.unilateral or c.frictionless:
            contacts.append(c)
            continue
        contacts.append(with_friction(c, 0.0))
        words = ("fx", "fy", "mz") if isinstance(c, SoftFingerContact) else ("fx", "fy")
        contacts += [Handle(f"{c.name} (tangential {i})", p, c.rotation, transmits=words) for i, p in enumerate(c.points_W)]
    return replace(stance, contacts=ContactSet(contacts), posture=None)


def friction_interval(stance: Stance, intervals: Mapping[str, Any], settings: Settings) -> Measure:
    """Whether the posture holds for all coefficients of intervals, and with what reserve.

    Cones grow with friction, so that weak stability, and its margin, at the lower ends hold everywhere in the intervals: exact.

    Args:
        stance: The stance.
        intervals: ``[lo, hi]`` of the friction coefficient by contact, "default" for the contacts that are not named.
        settings: How to ask.

    Returns:
        The least margin over the intervals [N]; negative, or -inf, where some coefficients do not hold it.

    Raises:
        InputError: An interval that is none, or a name that is no contact with friction.
        EngineError: A verdict was not settled.
    """
    name, unit = "friction_interval", "N"
    known = {c.name for c in stance.contacts if c.unilateral and not c.frictionless}
    ends: dict[str, tuple[float, float]] = {}
    for key, pair in intervals.items():
        if key not in known and key != DEFAULT:
            message = f"friction_intervals: contact {key!r} has no friction here, known: {', '.join([DEFAULT, *sorted(known)])}"
            raise InputError(message, name=key, field="friction_intervals")
        lo, hi = interval(key, "friction_intervals", pair, least=0.0)
        if hi == float("inf"):
            message = f"contact '{key}': friction_intervals must be [lo, hi] with finite ends, got {pair!r}"
            raise InputError(message, name=key, field="friction_intervals")
        ends[key] = (lo, hi)
    answers = []
    for end in (0, 1):
        contacts = [with_friction(c, ends.get(c.name, ends.get(DEFAULT, (c.friction, c.friction)))[end]) if c.name in known else c
                    for c in stance.contacts]  # fmt: skip
        changed = replace(stance, contacts=ContactSet(contacts))
        answers.append(check_equilibrium(changed, cone=settings.cone, form=settings.form, engine=settings.engine))
    least, most = answers
    words = {("stable", "stable"): "holds for all of them", ("unstable", "unstable"): "holds for none of them"}
    note = words.get((least.verdict, most.verdict), f"{least.verdict} at the lower ends, {most.verdict} at the upper ends")
    return Measure(
        name, least.margin, unit, EXACT, (least.margin, least.margin), note=note, beyond=_motion(least),
        details={"verdicts": {"lower": least.verdict, "upper": most.verdict}},
    )  # fmt: skip
