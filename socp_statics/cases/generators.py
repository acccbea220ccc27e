"""The names that ``[posture] generator`` can have."""

from __future__ import annotations

from socp_statics.exceptions import InputError
from socp_statics.postures import GENERATORS
from socp_statics.registry import nearest

CONTACTS, RANDOM_CONTACTS = "contacts", "random_contacts"
WITHOUT_ROBOT = {
    CONTACTS: "explicit contacts, centre of mass and mass, no robot",
    RANDOM_CONTACTS: "seeded random contacts of a family, no robot (family, seed, friction, slope, mass)",
}


def describe_generators() -> dict[str, str]:
    """One line for each generator: those of contacts alone first, then those that pose a robot."""
    return {**WITHOUT_ROBOT, **GENERATORS.describe()}


def check_generator(name: object) -> str:
    """The name, if there is such a generator.

    Args:
        name: What the file says, None where it says nothing.

    Raises:
        InputError: It is no name, or not known; then the sentence offers near names.
    """
    known = list(describe_generators())
    if not isinstance(name, str):
        got = "it is missing" if name is None else f"got {name!r}"
        raise InputError(f"a name in quotes is expected, one of {', '.join(known)}; {got}", field="generator")
    if name not in known:
        raise InputError(f"posture generator {name!r} is not known{nearest(name, known)}", name=name, field="generator")
    return name
