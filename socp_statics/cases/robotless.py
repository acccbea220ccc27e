"""Postures without a robot: which table each of their generators has, and the stance it makes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from socp_statics.cases.generators import CONTACTS, RANDOM_CONTACTS
from socp_statics.cases.posture_statements import ContactsPosture, contacts_stance
from socp_statics.cases.random_contacts import RandomContactsPosture, random_stance
from socp_statics.cases.statement import Statement
from socp_statics.contacts import Stance

_TABLES: dict[str, tuple[type[Statement], Callable[[dict[str, Any]], Stance]]] = {
    CONTACTS: (ContactsPosture, contacts_stance),
    RANDOM_CONTACTS: (RandomContactsPosture, random_stance),
}


def robotless_statement(generator: str) -> type[Statement]:
    """The class of the table ``[posture]`` of a generator without a robot."""
    return _TABLES[generator][0]


def robotless_stance(posture: dict[str, Any]) -> Stance:
    """The stance of a posture without a robot.

    Args:
        posture: The table with defaults filled in.

    Raises:
        InputError: Contacts or loads contradict each other.
    """
    return _TABLES[posture["generator"]][1](posture)


def robotless_names(posture: dict[str, Any]) -> tuple[str, ...]:
    """Names of the contacts of a posture without a robot; its table has no faults."""
    if posture["generator"] == CONTACTS:
        return tuple(contact["name"] for contact in posture["contacts"])
    return tuple(contact.name for contact in robotless_stance(posture).contacts)
