"""Contact states in turn: which contacts touch and where, a posture for each, and the postures between one and the next."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.contacts.numbers import vector
from socp_statics.contacts.orientation import contact_rotation
from socp_statics.exceptions import InputError
from socp_statics.postures.home import hands_of, home
from socp_statics.postures.inverse_kinematics import reach
from socp_statics.postures.posture import Posture, posture_at
from socp_statics.postures.scene import LEVEL, take_places
from socp_statics.registry import nearest
from socp_statics.robots import Robot
from socp_statics.spatial import Array

KEYS, PLACE_KEYS = ("name", "support", "places", "com"), ("position", "rotation", "normal", "rpy")
FACING = np.array([-1.0, 0.0, 0.0])
SAME = 1e-12


@dataclass(frozen=True, eq=False)
class ContactState:
    """One contact state.

    Attributes:
        name: What to call it.
        places: Contact that touches to position relative to the origin [m] and rotation ``R_WC``.
        com: Centre of mass relative to the origin: (x, y) or (x, y, z) [m]; None over the middle of its soles.
    """

    name: str
    places: Mapping[str, tuple[Array, Array]]
    com: Sequence[float] | None


def read_states(robot: Robot, states: Sequence[Mapping[str, Any]]) -> tuple[ContactState, ...]:
    """Contact states as they are written, checked.

    Args:
        robot: The robot.
        states: Tables of ``support``, and optionally ``name``, ``com`` and ``places``: contact to ``position`` and one of rotation,
            normal, rpy. Feet are level at their home places by default, hands at theirs against a wall in front.

    Raises:
        InputError: No state, an unknown key or contact, a place of a contact that does not touch, or a wrong number.
    """
    if not states:
        raise InputError("keyframes: states must hold at least one contact state", name="keyframes", field="states")
    return tuple(_state(robot, number, keys) for number, keys in enumerate(states))


def _state(robot: Robot, number: int, keys: Mapping[str, Any]) -> ContactState:
    where = f"states[{number}]"
    for key in keys:
        if key not in KEYS:
            raise InputError(f"keyframes: {where}.{key} is not a known key{nearest(str(key), KEYS)}", name="keyframes", field="states")
    support, given = keys.get("support"), keys.get("places", {})
    if not isinstance(support, Sequence) or isinstance(support, str) or not support:
        message = f"keyframes: {where}.support must be a list of at least one contact of the robot, got {support!r}"
        raise InputError(message, name="keyframes", field="states")
    if not isinstance(given, Mapping):
        message = f"keyframes: {where}.places must be a table of contact = place, got {given!r}"
        raise InputError(message, name="keyframes", field="states")
    for contact in given:
        if contact not in support:
            message = f"keyframes: {where}.places has {contact!r}, which does not touch{nearest(str(contact), support)}"
            raise InputError(message, name=str(contact), field="states")
    standing, places = home(robot), {}
    for contact in support:
        try:
            robot.contact_frame(contact)
        except InputError as error:
            raise InputError(f"keyframes: {where}.support: {error}", name=str(contact), field="states") from error
        default = (
            standing.contacts[contact].position,
            contact_rotation(contact, None, FACING, None) if contact in hands_of(robot) else LEVEL,
        )
        places[contact] = _place(where, contact, given[contact], default) if contact in given else default
    com = keys.get("com")
    if com is not None and np.size(com) not in (2, 3):
        raise InputError(f"keyframes: {where}.com must be two or three numbers, got {com!r}", name="keyframes", field="states")
    return ContactState(str(keys.get("name", f"state {number}")), places, com)


def _place(where: str, contact: str, keys: Any, default: tuple[Array, Array]) -> tuple[Array, Array]:
    if not isinstance(keys, Mapping):
        message = f"keyframes: {where}.places.{contact} must be a table of {', '.join(PLACE_KEYS)}, got {keys!r}"
        raise InputError(message, name=contact, field="states")
    for key in keys:
        if key not in PLACE_KEYS:
            message = f"keyframes: {where}.places.{contact}.{key} is not a known key{nearest(str(key), PLACE_KEYS)}"
            raise InputError(message, name=contact, field="states")
    position = vector(contact, "position", keys["position"], 3) if "position" in keys else default[0]
    turned = {key: keys.get(key) for key in PLACE_KEYS[1:]}
    return position, contact_rotation(contact, **turned) if any(value is not None for value in turned.values()) else default[1]


def shared(one: ContactState, other: ContactState) -> tuple[str, ...]:
    """Contacts that touch at the same place in both states, and so all the way between them.

    Raises:
        InputError: There is none.
    """
    names = tuple(
        name
        for name, (position, rotation) in one.places.items()
        if name in other.places
        and np.abs(position - other.places[name][0]).max() < SAME
        and np.abs(rotation - other.places[name][1]).max() < SAME
    )
    if not names:
        message = f"keyframes: '{one.name}' and '{other.name}' share no contact that stays in its place"
        raise InputError(message, name=other.name, field="states")
    return names


@dataclass(frozen=True, eq=False)
class Keyframes:
    """Contact states with a posture each; `between` gives the postures of the transitions.

    Attributes:
        states: The contact states.
        postures: A posture for each.
        friction: Coulomb coefficient, of all contacts or by contact.
    """

    states: tuple[ContactState, ...]
    postures: tuple[Posture, ...]
    friction: float | Mapping[str, float]

    def between(self, number: int, share: float) -> Posture:
        """A posture of a transition: on the contacts that both states share.

        The joints are interpolated, the centre of mass (x, y) goes straight from one posture's to the other's, and inverse kinematics
        keeps the shared contacts in their places.

        Args:
            number: The transition from state ``number`` to the next.
            share: 0 at the first, 1 at the second.

        Raises:
            InputError: The states share no contact, or the way between them cannot be reached; the sentence names the transition.
        """
        import pinocchio

        one, other = self.postures[number], self.postures[number + 1]
        names = shared(self.states[number], self.states[number + 1])
        rough = rough_of(self.friction, names)
        places = {name: (one.contacts[name].position, one.contacts[name].rotation) for name in names}
        halfway = posture_at(one.robot, pinocchio.interpolate(one.robot.pin_model, one.q, other.q, float(share)), names, rough)
        com = (1.0 - share) * one.com_W[:2] + share * other.com_W[:2]
        try:
            return reach(one.robot, places, friction=rough, com=com, reference=halfway)
        except InputError as error:
            way = f"from '{self.states[number].name}' to '{self.states[number + 1].name}' at {share:g}"
            raise InputError(f"keyframes: {way}: {error}", name=error.name, field="states") from error


def keyframes_of(robot: Robot, states: Sequence[Mapping[str, Any]], friction: float | Mapping[str, float], at: ArrayLike) -> Keyframes:
    """Contact states with a posture for each.

    Args:
        robot: The robot.
        states: As `read_states` takes them.
        friction: Coulomb coefficient, of all contacts or by contact.
        at: The origin between the feet, world axes, shape (3,) [m].

    Raises:
        InputError: The states are wrong, two neighbours share no contact, or one cannot be reached; the sentence names it.
    """
    read, postures = read_states(robot, states), []
    for state in read:
        try:
            postures.append(take_places(robot, state.places, at=at, friction=rough_of(friction, tuple(state.places)), com=state.com))
        except InputError as error:
            raise InputError(f"keyframes: '{state.name}': {error}", name=error.name, field="states") from error
    for one, other in zip(read, read[1:], strict=False):
        shared(one, other)
    return Keyframes(read, tuple(postures), friction)


def rough_of(friction: float | Mapping[str, float], names: Sequence[str]) -> float | dict[str, float]:
    """The friction of those contacts, which may be some of those it names."""
    if not isinstance(friction, Mapping):
        return friction
    for name in names:
        if name not in friction:
            raise InputError(f"keyframes: friction of {name!r} is missing", name=name, field="friction")
    return {name: friction[name] for name in names}
