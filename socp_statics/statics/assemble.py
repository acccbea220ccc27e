"""From a stance to the arrays of its convex set."""

from __future__ import annotations

from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from socp_statics.contacts import Handle, SoftFingerContact, Stance
from socp_statics.contacts.contact import COMPONENTS, Contact
from socp_statics.spatial import Array, cross
from socp_statics.statics.joint_torques import joint_torques, limit_rows
from socp_statics.statics.statics_data import Indices, StaticsData
from socp_statics.statics.units import Units, units_of

CIRCULAR, BOX, ELLIPTIC, FRICTIONLESS = range(4)


class Structure(NamedTuple):
    """What stays the same while contacts move: order of the unknowns, and which contact each belongs to.

    Attributes:
        counts: Number of points that are circular, box, elliptic, frictionless.
        of_point: Index of each point's contact.
        in_plane: Points in their contact planes [m].
        of_handle: Index of each handle component's contact.
        component: Index of each handle component in the wrench.
        of_column: Index of each unknown's contact.
        bounded: Indices of the contacts whose normal force is bounded.
    """

    counts: tuple[int, int, int, int]
    of_point: Indices
    in_plane: Array
    of_handle: Indices
    component: Indices
    of_column: Indices
    bounded: Indices


def _group(contact: Contact) -> int:
    """Order of a contact's points in x."""
    if contact.frictionless:
        return FRICTIONLESS
    if isinstance(contact, SoftFingerContact):
        return BOX if contact.shape == "box" else ELLIPTIC
    return CIRCULAR


class _Key:
    """Contacts, compared by their structure alone."""

    def __init__(self, contacts: list[Contact]):
        self.contacts = contacts
        self._key: tuple[Any, ...] = tuple((c.structure, c.friction == 0.0) for c in contacts)
        self._hash = hash(self._key)

    def __hash__(self) -> int:
        return self._hash

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Key) and self._key == other._key


@lru_cache(maxsize=256)
def _structure(key: _Key) -> Structure:
    contacts = key.contacts
    unilateral = [k for k, c in enumerate(contacts) if c.unilateral]
    order = sorted(unilateral, key=lambda k: _group(contacts[k]))
    sizes = [len(contacts[k].points_C) for k in order]
    of_point = np.repeat(np.array(order, dtype=int), sizes)
    group = np.repeat(np.array([_group(contacts[k]) for k in order], dtype=int), sizes)
    counts = np.bincount(group, minlength=4)
    handles = [(k, COMPONENTS.index(word)) for k, c in enumerate(contacts) if isinstance(c, Handle) for word in c.transmits]
    of_handle = np.array([k for k, _ in handles], dtype=int)
    slipping = int(counts[:FRICTIONLESS].sum())
    soft = of_point[int(counts[CIRCULAR]) : slipping]
    return Structure(
        counts=tuple(int(n) for n in counts),  # type: ignore[arg-type]
        of_point=of_point,
        in_plane=np.vstack([contacts[k].points_C for k in order]) if order else np.zeros((0, 2)),
        of_handle=of_handle,
        component=np.array([i for _, i in handles], dtype=int),
        of_column=np.concatenate([np.repeat(of_point[:slipping], 2), of_point, soft, of_handle]),
        bounded=np.array([k for k in unilateral if contacts[k].normal_force is not None], dtype=int),
    )


def gravity_load(stance: Stance, units: Units) -> tuple[Array, Array, Array]:
    """Impressed wrench of gravity and external wrenches about the origin, in scaled units.

    Args:
        stance: The stance.
        units: Its units.

    Returns:
        Load, shape (6,); its change per unit displacement of the centre of mass along world x and y, shape (6, 2); the centre
        of mass relative to the origin, shape (3,).
    """
    weight = stance.mass / units.force * stance.gravity
    com = (stance.com - units.origin) / units.length
    load = np.empty(6)
    load[:3], load[3:] = weight, cross(com, weight)
    for wrench in stance.external_wrenches:
        load[:3] += wrench.force / units.force
        load[3:] += wrench.moment_about(units.origin) / (units.force * units.length)
    shift = np.zeros((6, 2))
    shift[4, 0], shift[5, 0] = -weight[2], weight[1]
    shift[3, 1], shift[5, 1] = weight[2], -weight[0]
    return load, shift, com


@lru_cache(maxsize=128)
def assemble(stance: Stance) -> StaticsData:
    """Wrench map, cones, bounds and loads of a stance, in units of W and size about the mean contact point.

    Verdict, region and prices of one stance ask for the same arrays, which nobody changes: they are kept for a while.

    Args:
        stance: Contacts, centre of mass, mass, gravity and external wrenches; torque limits where forces have to respect them.

    Returns:
        The arrays of the convex set.
    """
    units = units_of(stance)
    contacts = list(stance.contacts)
    s = _structure(_Key(contacts))
    rotation = np.array([c.rotation for c in contacts])
    position = (np.array([c.position for c in contacts]) - units.origin) / units.length
    R = rotation[s.of_point]
    point = position[s.of_point] + (R[:, :, :2] @ (s.in_plane / units.length)[:, :, None])[:, :, 0]
    G = _wrench_map(s, rotation, position, R, point)
    load, shift, com = gravity_load(stance, units)
    rows, values, labels = _handle_limits(contacts, s, units, G.shape[1])
    torques = joint_torques(stance, units, G, s.of_column, position)
    if stance.torque_limits is not None:
        torque_rows, torque_values, joints = limit_rows(torques)
        rows, values, labels = np.vstack([rows, torque_rows]), np.concatenate([values, torque_values]), (*labels, *joints)
    friction = np.array([c.friction for c in contacts])
    slipping = sum(s.counts[:FRICTIONLESS])
    soft = s.of_point[s.counts[CIRCULAR] : slipping]
    bounds = [contacts[k].normal_force for k in s.bounded]
    return StaticsData(
        units=units,
        circular=s.counts[CIRCULAR] + s.counts[BOX],
        box=s.counts[BOX],
        elliptic=s.counts[ELLIPTIC],
        frictionless=s.counts[FRICTIONLESS],
        wrench_map=G,
        load=load,
        com_load=shift,
        com=com,
        friction=friction[s.of_point[:slipping]],
        torsion=np.array([contacts[k].torsional_friction for k in soft], dtype=float) / units.length,  # type: ignore[attr-defined]
        contact_of_point=s.of_point,
        contact_of_handle=s.of_handle,
        component_of_handle=s.component,
        bounded=s.bounded,
        bounds=np.array(bounds, dtype=float).reshape(-1, 2) / units.force,
        limit_rows=rows,
        limit_values=values,
        limit_names=labels,
        rotation=rotation,
        position=position,
        point=point,
        names=stance.contacts.names,
        torques=torques,
    )


def _wrench_map(s: Structure, rotation: Array, position: Array, R: Array, point: Array) -> Array:
    """G: the wrench of a unit of each unknown about the origin, shape (6, nx)."""
    slipping, points = sum(s.counts[:FRICTIONLESS]), len(s.of_point)
    soft = slice(s.counts[CIRCULAR], slipping)
    forces = 2 * slipping + points
    G = np.zeros((6, len(s.of_column)))
    axes = np.empty((forces, 3))
    axes[: 2 * slipping] = R[:slipping, :, :2].transpose(0, 2, 1).reshape(-1, 3)
    axes[2 * slipping :] = R[:, :, 2]
    arms = np.empty((forces, 3))
    arms[: 2 * slipping : 2] = arms[1 : 2 * slipping : 2] = point[:slipping]
    arms[2 * slipping :] = point
    G[:3, :forces] = axes.T
    G[3:, :forces] = cross(arms, axes).T
    spins = slipping - soft.start
    if spins:
        G[3:, forces : forces + spins] = R[soft, :, 2].T
    for j, (k, i) in enumerate(zip(s.of_handle, s.component, strict=True), start=forces + spins):
        axis = rotation[k, :, i % 3]
        if i < 3:
            G[:3, j], G[3:, j] = axis, cross(position[k], axis)
        else:
            G[3:, j] = axis
    return G


def _handle_limits(contacts: list[Contact], s: Structure, units: Units, columns: int) -> tuple[Array, Array, tuple[str, ...]]:
    """Hard rows of the finite handle limits: component <= hi and -component <= -lo."""
    rows, values, labels = [], [], []
    first = columns - len(s.of_handle)
    for j, (k, i) in enumerate(zip(s.of_handle, s.component, strict=True)):
        contact, word = contacts[k], COMPONENTS[i]
        assert isinstance(contact, Handle)
        scale = units.force if i < 3 else units.force * units.length
        lo, hi = contact.limits.get(word, (-np.inf, np.inf))
        for sign, end in ((1.0, hi), (-1.0, -lo)):
            if np.isfinite(end):
                row = np.zeros(columns)
                row[first + j] = sign
                rows.append(row)
                values.append(end / scale)
                labels.append(f"{contact.name}.{word}")
    return np.array(rows).reshape(-1, columns), np.array(values), tuple(labels)
