"""Independent loops (3.6.3): the feet stand on the floor, the hands hold an object; each loop has its own internal wrench.

The hands' components are printed as reactions on the *object* (``F_H = G_O``) while F_B contains the object's weight; taken together, the
feet would carry the robot alone. There are two consistent readings, and they agree:

- ``"system"``: robot and object together, ``F_B = G_B + T^T G_O``; the hands are inside the system and do not appear at the feet;
- ``"robot"``: the robot alone, ``F_B = G_B``; the hand reactions on the robot are minus those on the object.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.contacts import ContactSet
from socp_statics.contacts.stance import as_contact_set
from socp_statics.distribution.dual_null_space import null_basis
from socp_statics.distribution.general_solution import refuse_out_of_reach
from socp_statics.distribution.generalized_inverses import pseudoinverse
from socp_statics.exceptions import InputError
from socp_statics.spatial import Array, wrench_translation
from socp_statics.statics.contact_maps import contact_map

READINGS = ("system", "robot")


class IndependentLoops(NamedTuple):
    """Wrenches of two loops.

    Attributes:
        feet: Components at the feet, shape (c_F,) [N, N m].
        hands_on_object: Components of the hands' reactions on the object, shape (c_H,) [N, N m].
        hands_on_robot: What acts on the robot in turn: minus those.
        base: F_B of the reading, about the base, shape (6,) [N, N m].
        feet_internal: Number of internal components of the feet, c_F - rank.
        hands_internal: Number of internal components of the hands, c_H - rank.
    """

    feet: Array
    hands_on_object: Array
    hands_on_robot: Array
    base: Array
    feet_internal: int
    hands_internal: int


def base_wrench(C_F: ArrayLike, feet: ArrayLike, C_H: ArrayLike, hands: ArrayLike) -> Array:
    """``F_B = C_cB(q_F) F_F + C_cB(q_H) F_H``: the reactions of both loops on the robot at its base.

    Implements (3.67), corrected: both are reactions on the robot, so F_B is that of the robot alone.

    Args:
        C_F: Contact map of the feet to the base, shape (6, c_F).
        feet: Shape (c_F,) [N, N m].
        C_H: Contact map of the hands to the base, shape (6, c_H).
        hands: Reactions on the robot, shape (c_H,) [N, N m].

    Returns:
        Shape (6,).
    """
    return np.asarray(C_F, dtype=float) @ np.asarray(feet, dtype=float) + np.asarray(C_H, dtype=float) @ np.asarray(hands, dtype=float)


def object_wrench(C_H: ArrayLike, hands_on_object: ArrayLike) -> Array:
    """``F_H = C_cH F_H^c``: the hands' reactions on the object at its origin; at rest it is G_O.

    Implements (3.68).

    Args:
        C_H: Contact map of the hands to the object's origin, shape (6, c_H).
        hands_on_object: Shape (c_H,) [N, N m].

    Returns:
        Shape (6,).
    """
    return np.asarray(C_H, dtype=float) @ np.asarray(hands_on_object, dtype=float)


def hand_components(C_H: ArrayLike, F_H: ArrayLike, F_H_int: ArrayLike | None = None, inverse: ArrayLike | None = None) -> Array:
    """``F_H^c = C_cH^# F_H + V(C_cH) F_H^int``: reactions on the object.

    Implements (3.69).

    Args:
        C_H: Contact map of the hands to the object's origin, shape (6, c_H).
        F_H: Reaction to what acts on the object, shape (6,) [N, N m].
        F_H_int: Internal components, shape (c_H - rank,); none by default.
        inverse: C_cH^#, shape (c_H, 6), the pseudoinverse by default.

    Returns:
        Shape (c_H,) [N, N m].

    Raises:
        InputError: The wrong number of internal components.
    """
    return _loop(C_H, F_H, F_H_int, inverse, "hand_internal")


def foot_components(
    C_F: ArrayLike, F_B: ArrayLike, F_BH: ArrayLike, F_F_int: ArrayLike | None = None, inverse: ArrayLike | None = None
) -> Array:
    """``F_F^c = C_cB(q_F)^# (F_B - F_BH) + V(C_cB(q_F)) F_F^int``.

    Implements (3.70), corrected: F_BH is the wrench of the hand reactions on the *robot* where F_B is that of the robot alone, and zero
    where F_B is that of robot and object; the printed mixture takes the object's weight off the feet.

    Args:
        C_F: Contact map of the feet to the base, shape (6, c_F).
        F_B: Shape (6,) [N, N m].
        F_BH: Hand reactions on the robot at the base, or zero, shape (6,) [N, N m].
        F_F_int: Internal components, shape (c_F - rank,); none by default.
        inverse: C_cB(q_F)^#, shape (c_F, 6), the pseudoinverse by default.

    Returns:
        Shape (c_F,) [N, N m].

    Raises:
        InputError: The wrong number of internal components.
    """
    return _loop(C_F, np.asarray(F_B, dtype=float) - np.asarray(F_BH, dtype=float), F_F_int, inverse, "foot_internal")


def independent_loops(
    feet: Any,
    hands: Any,
    base_W: ArrayLike,
    G_B: ArrayLike,
    object_W: ArrayLike,
    G_O: ArrayLike,
    *,
    reading: str = "system",
    foot_internal: ArrayLike | None = None,
    hand_internal: ArrayLike | None = None,
) -> IndependentLoops:
    """Wrenches of a robot that stands on its feet and holds an object in its hands.

    Args:
        feet: Contacts of the feet.
        hands: Contacts of the hands with the object; normals point from the object into the hands, as of any contact of the robot.
        base_W: Origin of the base, shape (3,) [m].
        G_B: Reaction to the gravity of the robot alone at the base, shape (6,) [N, N m].
        object_W: Origin of the object, shape (3,) [m].
        G_O: Reaction to what acts on the object, about its origin, shape (6,) [N, N m].
        reading: "system" or "robot"; the answers agree.
        foot_internal: Internal components of the feet, shape (c_F - rank,).
        hand_internal: Internal components of the hands, shape (c_H - rank,).

    Returns:
        The wrenches.

    Raises:
        InputError: An object held by nothing or by contacts that cannot hold it, an unknown reading, or numbers of the wrong size.
    """
    if reading not in READINGS:
        raise InputError(f"reading must be one of {', '.join(READINGS)}, got {reading!r}", name="reading", field="reading")
    held = hands if isinstance(hands, ContactSet) else list(hands)
    if not len(held):
        raise InputError("the object is held by nothing: hands must name at least one contact", name="hands", field="hands")
    standing, holding = as_contact_set(feet), as_contact_set(held)
    base, place = np.asarray(base_W, dtype=float), np.asarray(object_W, dtype=float)
    G_B, G_O = np.asarray(G_B, dtype=float), np.asarray(G_O, dtype=float)
    C_F, C_H = contact_map(standing, base), contact_map(holding, place)
    refuse_out_of_reach(C_H, G_O, holding.size, "the object")
    on_object = hand_components(C_H, G_O, hand_internal)
    if reading == "system":
        F_B, F_BH = G_B + wrench_translation(base - place) @ G_O, np.zeros(6)
    else:
        F_B, F_BH = G_B, contact_map(holding, base) @ -on_object
    refuse_out_of_reach(C_F, F_B - F_BH, standing.size)
    below = foot_components(C_F, F_B, F_BH, foot_internal)
    return IndependentLoops(below, on_object, -on_object, F_B, null_basis(C_F).shape[1], null_basis(C_H).shape[1])


def _loop(C: ArrayLike, wrench: ArrayLike, internal: ArrayLike | None, inverse: ArrayLike | None, word: str) -> Array:
    C = np.asarray(C, dtype=float)
    F = (pseudoinverse(C) if inverse is None else np.asarray(inverse, dtype=float)) @ np.asarray(wrench, dtype=float)
    if internal is None:
        return F
    V, given = null_basis(C), np.asarray(internal, dtype=float)
    if given.shape != (V.shape[1],):
        raise InputError(f"{word}: {V.shape[1]} internal components are expected, got shape {given.shape}", name=word, field=word)
    return F + V @ given
