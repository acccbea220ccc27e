"""Directions of internal force: contact wrenches without net wrench, stated by a pair of contacts or in full."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from socp_statics.contacts import ContactSet
from socp_statics.distribution.distributions import wrenches_C
from socp_statics.distribution.general_solution import direction_words
from socp_statics.distribution.interdependent_loops import reference_components, stacked_components
from socp_statics.exceptions import InputError
from socp_statics.registry import nearest
from socp_statics.spatial import Array
from socp_statics.statics.contact_maps import contact_map

INTERNAL = 1e-9


def null_direction(contacts: ContactSet, stated: Any) -> Array:
    """A direction of internal force.

    Args:
        contacts: The contacts.
        stated: Two names: a unit of the member between them, tension positive (it pulls them together); or by contact a force (3) or a
            wrench (6) about the contact's position in world axes, per unit of internal force.

    Returns:
        Wrenches in contact frames per unit, shape (k, 6).

    Raises:
        InputError: Contacts that are not there or coincide, wrenches that a contact does not transmit, or a net wrench that is not zero.
    """
    wrenches = dict(stated) if isinstance(stated, Mapping) else _member(contacts, stated)
    zeros = {c.name: np.zeros(len(reference_components(c, np.zeros(3)))) for c in contacts}
    for name in wrenches:
        _refuse_unknown(contacts, name)
    try:
        given = {name: reference_components(contacts[name], value) for name, value in wrenches.items()}
    except InputError as error:
        raise InputError(str(error).replace("references", "directions", 1), name=error.name, field="directions") from error
    components = stacked_components(contacts, zeros | given)
    size = float(np.abs(components).max(initial=0.0))
    if size == 0.0:
        raise InputError("directions: a direction that is not zero is expected", name="directions", field="directions")
    net = contact_map(contacts, contacts.centre) @ components
    net[3:] /= contacts.size
    if np.abs(net).max() > INTERNAL * size:
        words = direction_words(np.where(np.abs(net) > INTERNAL * size, net, 0.0))
        message = f"directions: internal wrenches have no net wrench, these have {words} (moments over {contacts.size:.4g} m)"
        raise InputError(message, name="directions", field="directions")
    return wrenches_C(contacts, components)


def independent(contacts: ContactSet, directions: Sequence[Array]) -> None:
    """Refuse two directions that are the same but for a factor.

    Raises:
        InputError: They are not independent.
    """
    scale = np.repeat([1.0, 1.0 / contacts.size], 3)
    rows = np.array([(d * scale).ravel() for d in directions])
    rows /= np.linalg.norm(rows, axis=1, keepdims=True)
    if len(rows) > 1 and np.linalg.svd(rows, compute_uv=False)[-1] < 1e-9:
        raise InputError("directions: two independent directions are expected, these are one", name="directions", field="directions")


def _member(contacts: ContactSet, pair: Any) -> dict[str, Array]:
    names = list(pair) if isinstance(pair, Iterable) and not isinstance(pair, str) else [pair]
    if len(names) != 2 or names[0] == names[1]:
        raise InputError(f"directions: two different contacts are expected, got {names!r}", name="directions", field="directions")
    for name in names:
        _refuse_unknown(contacts, name)
    a, b = (contacts[name].position for name in names)
    length = float(np.linalg.norm(b - a))
    if length == 0.0:
        message = f"directions: contacts '{names[0]}' and '{names[1]}' are at the same place, no member joins them"
        raise InputError(message, name=names[0], field="directions")
    return {names[0]: (b - a) / length, names[1]: (a - b) / length}


def _refuse_unknown(contacts: ContactSet, name: Any) -> None:
    if name not in contacts.names:
        message = f"directions: contact {name!r} is not there{nearest(str(name), contacts.names)}"
        raise InputError(message, name=str(name), field="directions")
