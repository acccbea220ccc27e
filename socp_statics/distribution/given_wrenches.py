"""A closed-form distribution in which some contacts, say the hands, have the wrenches they are asked for.

The linear inverses take the references into the null space of the whole map, (3.66). The lever rules put the hands first (5.10.4): what the
hands give is taken off the load, and the others share the rest by where it then acts.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.contacts import ContactSet, Stance
from socp_statics.distribution.closed_form import checked_form, closed_forms, inverses
from socp_statics.distribution.distributions import load_reaction, question_of
from socp_statics.distribution.interdependent_loops import chosen_components, reference_components, with_references
from socp_statics.distribution.scaled_question import DistributionQuestion, Geometry
from socp_statics.exceptions import InputError
from socp_statics.registry import nearest
from socp_statics.spatial import Array
from socp_statics.statics.contact_maps import contact_map


class GivenWrenches(NamedTuple):
    """A distribution with references.

    Attributes:
        components: Of all contacts, shape (c,) [N, N m].
        met: Whether the references are met.
        missed: The largest component of what they miss [N, N m].
        words: Reference directions that the other contacts cannot make up for, empty where there are none.
    """

    components: Array
    met: bool
    missed: float
    words: str


def distribute_around(stance: Stance, method: str, references: Mapping[str, ArrayLike], friction_exponent: float = 2.0) -> GivenWrenches:
    """Contact components of a stance in which some contacts have given wrenches.

    Args:
        stance: The stance.
        method: A closed-form method.
        references: By contact, a force (3) or a wrench (6) in world axes about the contact's position [N, N m].
        friction_exponent: Of the friction weights.

    Returns:
        The distribution; it balances also where references are not met.

    Raises:
        InputError: A contact that is not there, a reference of the wrong size or along what the contact does not transmit, or references
            for all contacts.
    """
    contacts = stance.contacts
    for name in references:
        if name not in contacts.names:
            raise InputError(f"references: contact '{name}' is not there{nearest(name, contacts.names)}", name=name, field="references")
    wanted = {name: reference_components(contacts[name], value) for name, value in references.items()}
    others = [contact for contact in contacts if contact.name not in wanted]
    if not others:
        raise InputError("references: every contact has one, at least one has to be free to balance", name="references", field="references")
    checked = checked_form(method, ContactSet(others) if method == "statics_consistent" else contacts)
    if checked.by_lever:
        return _the_given_first(stance, method, wanted, ContactSet(others))
    question = question_of([stance], friction_exponent)
    sharp, origin = inverses(question, method)[0], question.origin[0]
    found = with_references(contacts, contact_map(contacts, origin), load_reaction(stance, origin), wanted, sharp)
    return GivenWrenches(found.components, found.met, float(np.abs(found.missed).max(initial=0.0)), found.words)


def _the_given_first(stance: Stance, method: str, wanted: Mapping[str, Array], others: ContactSet) -> GivenWrenches:
    contacts = stance.contacts
    mine = chosen_components(contacts, list(wanted))
    components = np.zeros(len(mine))
    components[mine] = np.concatenate([wanted[name] for name in contacts.names if name in wanted])
    positions = np.array([c.position for c in others])
    centre = positions.mean(axis=0)
    rest = load_reaction(stance, centre) - contact_map(contacts, centre) @ components
    geometry = Geometry(
        positions[None], np.array([[c.rotation for c in others]]), np.array([[c.friction for c in others]]),
        rest[None], -stance.gravity[None],
    )  # fmt: skip
    components[~mine] = closed_forms(DistributionQuestion(others, geometry), [method])[method][0]
    return GivenWrenches(components, True, 0.0, "")
