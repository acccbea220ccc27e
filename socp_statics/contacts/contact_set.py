"""A set of contacts, and the geometry they share."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import cached_property

import numpy as np

from socp_statics.contacts.contact import Contact
from socp_statics.contacts.friction_points import friction_points
from socp_statics.exceptions import InputError
from socp_statics.spatial import Array

FEW = 64


class ContactSet:
    """An immutable sequence of contacts with unique names.

    Args:
        contacts: At least one contact.

    Attributes:
        friction_points: All points as an array where only friction limits their forces, else None; see `friction_points`.

    Raises:
        InputError: No contact, something that is not a contact, or a name that is used twice.
    """

    def __init__(self, contacts: Iterable[Contact]):
        if not isinstance(contacts, Iterable):
            raise InputError(f"contacts: a list of contacts is expected, got {contacts!r}", field="contacts")
        self._contacts = tuple(contacts)
        if not self._contacts:
            raise InputError("contacts: at least one contact is expected, got none", field="contacts")
        seen: set[str] = set()
        for contact in self._contacts:
            if not isinstance(contact, Contact):
                raise InputError(f"contacts: a contact is expected, got {contact!r}", field="contacts")
            if contact.name in seen:
                raise InputError(f"contact '{contact.name}': name is used twice, names must be unique", name=contact.name, field="name")
            seen.add(contact.name)
        self.friction_points = friction_points(self._contacts)

    def __iter__(self) -> Iterator[Contact]:
        return iter(self._contacts)

    def __len__(self) -> int:
        return len(self._contacts)

    def __getitem__(self, key: int | str) -> Contact:
        if isinstance(key, str):
            for contact in self._contacts:
                if contact.name == key:
                    return contact
            raise InputError(f"contact '{key}': no such contact, there are {', '.join(self.names)}", name=key)
        return self._contacts[key]

    def __repr__(self) -> str:
        return f"ContactSet([{', '.join(map(repr, self._contacts))}])"

    @property
    def names(self) -> tuple[str, ...]:
        """Names in order."""
        return tuple(contact.name for contact in self._contacts)

    @cached_property
    def points_W(self) -> Array:
        """All contact points, contact by contact, shape (n, 3) [m]."""
        return np.vstack([contact.points_W for contact in self._contacts])

    @cached_property
    def size(self) -> float:
        """Largest distance between contact points, 1 m if there is none [m]."""
        points = self.points_W - self.points_W[0]
        if len(points) <= FEW:
            apart = points[:, None] - points
            largest = float(np.sqrt((apart * apart).sum(axis=2).max()))
        else:
            # Imported here: few sets are large, and the import is slow.
            from scipy.spatial.distance import pdist

            largest = float(pdist(points).max())
        return largest if largest > 0.0 else 1.0

    @cached_property
    def centre(self) -> Array:
        """Mean contact point, world axes, shape (3,) [m]."""
        first = self.points_W[0]
        return first + (self.points_W - first).mean(axis=0)
