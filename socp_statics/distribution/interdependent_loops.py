"""Interdependent loops (3.6.2): hands and feet touch the same world; the hands get the wrenches they are asked for, the feet the rest."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from socp_statics.contacts import ContactSet
from socp_statics.contacts.contact import COMPONENTS, Contact
from socp_statics.contacts.joint import constraint_basis
from socp_statics.contacts.numbers import vector
from socp_statics.distribution.dual_null_space import null_projector
from socp_statics.distribution.general_solution import direction_words
from socp_statics.distribution.generalized_inverses import RELATIVE_RANK, pseudoinverse
from socp_statics.distribution.loop_torques import component_slices
from socp_statics.exceptions import InputError
from socp_statics.registry import nearest
from socp_statics.spatial import Array

MET = 1e-9


class ReferencedSolution(NamedTuple):
    """A distribution in which some contacts have wrenches they were asked for.

    Attributes:
        components: All contact components, shape (c,) [N, N m].
        parameter: F_a, shape (c,).
        rank: Of N_H, the null-space projector's rows of the contacts with references.
        wanted: Number of reference components; the references are met whatever they are where the rank is as large.
        missed: Reference less what it became, shape (wanted,) [N, N m].
        words: What the contacts without references cannot make up for, empty where the rank is full.
    """

    components: Array
    parameter: Array
    rank: int
    wanted: int
    missed: Array
    words: str

    @property
    def met(self) -> bool:
        """Whether the references are met, to 1e-9 of the components."""
        return bool(np.abs(self.missed).max(initial=0.0) <= MET * max(1.0, float(np.abs(self.components).max(initial=0.0))))


def stacked_components(contacts: ContactSet, by_contact: Mapping[str, ArrayLike]) -> Array:
    """``F^c``, the components of all contacts in the order of the contacts.

    Implements (3.61).

    Args:
        contacts: The contacts: those with friction have all their components, frictionless ones their constrained ones.
        by_contact: Components of every contact, shape (c_k,) [N, N m].

    Returns:
        Shape (c,).

    Raises:
        InputError: A contact that is not there or left out, or the wrong number of components.
    """
    places = component_slices(contacts)
    for name in by_contact:
        _refuse_unknown(contacts, name)
    out = np.zeros(sum(part.stop - part.start for part in places.values()))
    for name, part in places.items():
        if name not in by_contact:
            raise InputError(f"contact '{name}': its components are missing", name=name, field="components")
        out[part] = _components(name, by_contact[name], part.stop - part.start)
    return out


def load_components(inverse: ArrayLike, wrench: ArrayLike) -> Array:
    """The component that carries the load: ``F^ext = C_cB^# F_B``; the whole is ``F^c = F^ext + F^n``.

    Implements (3.62).

    Args:
        inverse: C_cB^#, shape (c, 6).
        wrench: F_B, shape (6,) [N, N m].

    Returns:
        Shape (c,).
    """
    return np.asarray(inverse, dtype=float) @ np.asarray(wrench, dtype=float)


def internal_components(C: ArrayLike, F_a: ArrayLike, inverse: ArrayLike | None = None) -> Array:
    """The component without net wrench: ``F^n = N(C_cB) F_a`` for any contact components F_a.

    Implements (3.63).

    Args:
        C: C_cB, shape (6, c).
        F_a: Shape (c,) [N, N m].
        inverse: C_cB^#, shape (c, 6), the pseudoinverse by default.

    Returns:
        Shape (c,).
    """
    return null_projector(C, inverse) @ np.asarray(F_a, dtype=float)


def partition(contacts: ContactSet, chosen: Sequence[str], rows: ArrayLike) -> tuple[Array, Array]:
    """Rows over the components split into those of the other contacts (feet) and of the chosen ones (hands).

    Implements (3.64).

    Args:
        contacts: The contacts.
        chosen: Names of the hands.
        rows: C^# or N(C), first axis over the components, shape (c, ...).

    Returns:
        ``(rows_F, rows_H)``, each in the order of the contacts.

    Raises:
        InputError: A contact that is not there.
    """
    mine, rows = chosen_components(contacts, chosen), np.asarray(rows, dtype=float)
    return rows[~mine], rows[mine]


def reference_parameter(N_H: ArrayLike, reference: ArrayLike, load_H: ArrayLike) -> Array:
    """``F_a = N_H^+ (F_H^ref - C_H^# F_B)``: the parameter of the null space that gives the hands their references.

    Implements (3.65).

    Args:
        N_H: Rows of N(C) of the hands, shape (c_H, c).
        reference: F_H^ref, shape (c_H,) [N, N m].
        load_H: C_H^# F_B, what the hands carry without it, shape (c_H,) [N, N m].

    Returns:
        Shape (c,).
    """
    return pseudoinverse(N_H) @ (np.asarray(reference, dtype=float) - np.asarray(load_H, dtype=float))


def with_references(
    contacts: ContactSet, C: ArrayLike, wrench: ArrayLike, references: Mapping[str, ArrayLike], inverse: ArrayLike | None = None
) -> ReferencedSolution:
    """``[F_F; F_H]`` with ``F_H = F_H^ref`` and ``F_F = C_F^# F_B + N_F N_H^+ (F_H^ref - C_H^# F_B)``.

    Implements (3.66), corrected: ``N_H N_H^+ = E`` holds only where the other contacts can balance whatever the hands do (feet that carry a
    whole wrench, not frictionless ones); the rank is checked, and what is missed is said. The feet's share changes with the references:
    their cones have to be checked again.

    Args:
        contacts: All contacts.
        C: C_cB, shape (6, c).
        wrench: F_B, shape (6,) [N, N m].
        references: Components in the contact frame of the hands by name, shape (c_k,) [N, N m].
        inverse: C_cB^#, shape (c, 6), the pseudoinverse by default.

    Returns:
        The distribution.

    Raises:
        InputError: No reference, one of a contact that is not there, or of the wrong size.
    """
    C, F_B = np.asarray(C, dtype=float), np.asarray(wrench, dtype=float)
    sharp = pseudoinverse(C) if inverse is None else np.asarray(inverse, dtype=float)
    if not references:
        raise InputError("references: at least one contact's wrench is expected, got none", name="references", field="references")
    mine = chosen_components(contacts, list(references))
    places = component_slices(contacts)
    wanted = np.concatenate(
        [_components(name, references[name], places[name].stop - places[name].start) for name in contacts.names if name in references]
    )
    N = null_projector(C, sharp)
    load, N_H = load_components(sharp, F_B), partition(contacts, list(references), N)[1]
    U, s, _ = np.linalg.svd(N_H, full_matrices=True)
    rank = int((s > max(RELATIVE_RANK, 1e-9) * max(s.max(initial=0.0), 1.0)).sum())
    F_a = reference_parameter(N_H, wanted, load[mine])
    components = load + N @ F_a
    words = "" if rank == len(wanted) else _lost_words(contacts, references, U[:, rank:])
    return ReferencedSolution(components, F_a, rank, len(wanted), wanted - components[mine], words)


def reference_components(contact: Contact, value: ArrayLike) -> Array:
    """Components of a reference wrench in world axes, about the contact's position.

    Args:
        contact: The contact.
        value: A force, shape (3,) [N]; or force and moment, shape (6,) [N, N m].

    Returns:
        Shape (c_k,), in the contact frame.

    Raises:
        InputError: The wrong size, or a component that the contact does not transmit.
    """
    message = f"references: contact '{contact.name}' needs a force of 3 or a wrench of 6 finite numbers, got {value!r}"
    try:
        given = np.asarray(value, dtype=float)
    except (TypeError, ValueError) as error:
        raise InputError(message, name=contact.name, field="references") from error
    if given.shape not in ((3,), (6,)) or not np.isfinite(given).all():
        raise InputError(message, name=contact.name, field="references")
    wrench = np.concatenate([given, np.zeros(6 - given.size)])
    local = np.kron(np.eye(2), contact.rotation.T) @ wrench
    B = constraint_basis(contact)
    left = local - B @ (B.T @ local)
    worst = int(np.abs(left).argmax())
    if abs(left[worst]) > 1e-9 * max(1.0, float(np.abs(local).max())):
        message = f"references: contact '{contact.name}' does not transmit {COMPONENTS[worst]} in its frame, got {left[worst]:.4g}"
        raise InputError(message, name=contact.name, field="references")
    return B.T @ local


def chosen_components(contacts: ContactSet, chosen: Sequence[str]) -> NDArray[np.bool_]:
    """Which components belong to the chosen contacts, shape (c,)."""
    for name in chosen:
        _refuse_unknown(contacts, name)
    return np.concatenate([np.full(part.stop - part.start, name in chosen) for name, part in component_slices(contacts).items()])


def _refuse_unknown(contacts: ContactSet, name: str) -> None:
    if name not in contacts.names:
        raise InputError(f"references: contact '{name}' is not there{nearest(name, contacts.names)}", name=name, field="references")


def _components(name: str, value: ArrayLike, size: int) -> Array:
    return vector(name, "references", value, size)


def _lost_words(contacts: ContactSet, references: Mapping[str, ArrayLike], lost: Array) -> str:
    """The reference directions that no internal wrench changes, contact by contact."""
    labels = [
        f"{COMPONENTS[int(row)]} of {contact.name}"
        for contact in contacts
        if contact.name in references
        for row in np.flatnonzero(constraint_basis(contact).any(axis=1))
    ]
    return "; ".join(direction_words(column, labels) for column in lost.T)
