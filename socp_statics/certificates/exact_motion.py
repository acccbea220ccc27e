"""From a floating-point motion to a rational one that admissible forces cannot prevent."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import islice
from typing import Any

import numpy as np

from socp_statics.certificates.contact_motion import ContactMotion, Motion, contact_motion
from socp_statics.certificates.exact_elimination import eliminate, independent_columns
from socp_statics.certificates.exact_forces import places
from socp_statics.certificates.exact_statement import rationals
from socp_statics.certificates.opening_motion import Opening, limited, opening_motion, rates_map
from socp_statics.certificates.verify_proof import Statement, add, cross, dot, sub
from socp_statics.cones.choice import ConeChoice
from socp_statics.spatial import Array
from socp_statics.statics.statics_data import StaticsData
from socp_statics.statics.wrench_range import SINGULAR

ROOM = 1e-14
LARGER = 16.0
TRIALS = 7


def motion_tables(
    statement: Statement, data: StaticsData, cone: ConeChoice, motion: Motion, first: Opening | None = None
) -> Iterator[dict[str, Any]]:
    """Motions for the proof file next to a given one, each a little further from it than the one before; for the verifier to judge.

    Args:
        statement: The statement.
        data: The same stance in floats.
        cone: Exact cones or pyramids.
        motion: A certificate, scaled.
        first: A motion that opens every contact, tried before one is looked for that opens those that matter.
    """
    size = max(float(np.abs(motion.twist).max()), float(np.abs(motion.joints).max(initial=0.0)))
    if not np.isfinite(size) or size == 0.0:
        return
    motion = Motion(motion.twist / size, motion.joints / size)
    yield _table(data, cone, _as_rationals(data, motion))
    if first is not None:
        for candidate in islice(_opened(data, cone, motion, first), 2):
            yield _table(data, cone, _as_rationals(data, candidate))
    opening = opening_motion(data, cone, motion)
    if opening is None:
        return
    for candidate in _opened(data, cone, motion, opening):
        exact = _as_rationals(data, candidate)
        if opening.still:
            projected = _standing_still(statement, data, exact, opening.still)
            if projected is None:
                return
            exact = projected
        yield _table(data, cone, exact)


def _opened(data: StaticsData, cone: ConeChoice, motion: Motion, opening: Opening) -> Iterator[Motion]:
    """The motion with more and more of one that opens what it holds."""
    at_contacts = contact_motion(data, cone, motion)
    bounded = _with_upper_bound(data)
    still = {i for i in range(data.points) if data.normal.start + i in opening.still}
    worst = [-g for i, g in enumerate(at_contacts.grip) if int(data.contact_of_point[i]) not in bounded and i not in still]
    share = max([2.0 * w for w in worst] + [ROOM])
    for _ in range(TRIALS):
        yield Motion(motion.twist + share * opening.motion.twist, motion.joints + share * opening.motion.joints)
        share *= LARGER


def _with_upper_bound(data: StaticsData) -> set[int]:
    return {int(k) for k, (_, hi) in zip(data.bounded, data.bounds, strict=True) if np.isfinite(hi)}


def _as_rationals(data: StaticsData, motion: Motion) -> list[Fraction]:
    """Velocity of the mean contact point [m/s], angular velocity [rad/s], rates of the limited joints [rad/s]."""
    linear, angular = data.units.twist_in_si(motion.twist)
    joints = motion.joints[limited(data)] / data.units.length
    return [Fraction(float(v)) for v in (*linear, *angular, *joints)]


def _standing_still(statement: Statement, data: StaticsData, exact: list[Fraction], still: list[int]) -> list[Fraction] | None:
    """The exact motion next to one whose velocity along some unknowns is zero: the pivots give, the other coordinates stay."""
    rates = rates_map(data)[still]
    pivots = independent_columns(rates, SINGULAR)
    where = places(data)
    by_name = {contact.name: contact for contact in statement.contacts}
    about = [Fraction(float(v)) for v in data.units.origin]
    rows: list[list[Fraction]] = []
    for j in still:
        if j >= len(where):
            rows.append([Fraction(k == 6 + j - len(where)) for k in range(len(exact))])
            continue
        name, point, component = where[j]
        contact = by_name[name]
        unit = contact.units[point][component]
        wrench = [*unit[:3], *add(unit[3:], cross(sub(contact.position, about), unit[:3]))]
        if statement.joints:
            columns = zip(*statement.jacobians[name], strict=True)
            wrench += [dot(column, unit) for column in columns]
        rows.append(wrench)
    value = [dot(row, exact) for row in rows]
    change = eliminate([[row[j] for row in rows] for j in pivots], [-v for v in value])
    if change is None:
        return None
    out = list(exact)
    for j, c in zip(pivots, change, strict=True):
        out[j] += c
    return out


def _table(data: StaticsData, cone: ConeChoice, exact: list[Fraction]) -> dict[str, Any]:
    joints = np.zeros(len(data.torques.names))
    joints[limited(data)] = [float(v) for v in exact[6:]]
    linear, angular = (np.array([float(v) for v in part]) for part in (exact[:3], exact[3:6]))
    motion = scaled_motion(data, linear, angular, data.units.origin, joints)
    return {
        "linear": rationals(exact[:3]),
        "angular": rationals(exact[3:6]),
        "point": rationals(data.units.origin),
        "joints": rationals(exact[6:]),
        "grips": _grips(data, contact_motion(data, cone, motion)),
    }


def _grips(data: StaticsData, at_contacts: ContactMotion) -> dict[str, Any]:
    """A lower bound of the least work per unit of normal force at each bounded contact."""
    out = {}
    for k, (_, hi) in zip(data.bounded, data.bounds, strict=True):
        mine = data.contact_of_point == k
        speed = 1.0 + float(np.abs(at_contacts.velocity[mine]).max())
        grip = float(at_contacts.grip[mine].min()) - ROOM * speed
        out[data.names[int(k)]] = rationals(grip if np.isfinite(hi) else max(grip, 0.0))
    return out


def scaled_motion(data: StaticsData, linear: Array, angular: Array, point: Array, joints: Array) -> Motion:
    """A motion in SI, as records have it, about the centre and in the units of a stance.

    Args:
        data: The stance's arrays.
        linear: Velocity of ``point``, shape (3,) [m/s].
        angular: Angular velocity, shape (3,) [rad/s].
        point: Where, shape (3,) [m].
        joints: Rates of all joints, shape (n,) [rad/s].
    """
    at_centre = linear + np.cross(angular, data.units.origin - point)
    return Motion(np.concatenate([at_centre, angular * data.units.length]), joints * data.units.length)
