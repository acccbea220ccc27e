"""From a stance to the arrays of its convex set."""

from __future__ import annotations

import numpy as np

from socp_statics.contacts import Handle, SoftFingerContact, Stance
from socp_statics.contacts.contact import COMPONENTS, Contact
from socp_statics.spatial import Array
from socp_statics.statics.joint_torques import joint_torques, limit_rows
from socp_statics.statics.statics_data import StaticsData
from socp_statics.statics.units import Units, units_of


def _group(contact: Contact) -> int:
    """Order of a contact's points in x: circular, box, elliptic, frictionless."""
    if contact.frictionless:
        return 3
    if isinstance(contact, SoftFingerContact):
        return 1 if contact.shape == "box" else 2
    return 0


def _directions(arm: Array, axes: Array) -> Array:
    """Wrenches of unit forces along axes at arms, shape (6, n): rows force, moment about the origin."""
    return np.vstack([axes.T, np.cross(arm, axes).T])


def gravity_load(stance: Stance, units: Units) -> tuple[Array, Array, Array]:
    """Impressed wrench of gravity and external wrenches about the origin, in scaled units.

    Args:
        stance: The stance.
        units: Its units.

    Returns:
        Load, shape (6,); its change per unit displacement of the centre of mass along world x and y, shape (6, 2); the centre
        of mass relative to the origin, shape (3,).
    """
    weight = stance.mass * stance.gravity / units.force
    com = (stance.com - units.origin) / units.length
    load = np.concatenate([weight, np.cross(com, weight)])
    for wrench in stance.external_wrenches:
        load[:3] += wrench.force / units.force
        load[3:] += wrench.moment_about(units.origin) / (units.force * units.length)
    shift = np.vstack([np.zeros((3, 2)), np.cross(np.eye(3)[:2], weight).T])
    return load, shift, com


def assemble(stance: Stance) -> StaticsData:
    """Wrench map, cones, bounds and loads of a stance, in units of W and size about the mean contact point.

    Args:
        stance: Contacts, centre of mass, mass, gravity and external wrenches.

    Returns:
        The arrays of the convex set.
    """
    units = units_of(stance)
    contacts = list(stance.contacts)
    rotation = np.array([c.rotation for c in contacts])
    position = np.array([(c.position - units.origin) / units.length for c in contacts])
    unilateral = [k for k, c in enumerate(contacts) if c.unilateral]
    order = sorted(unilateral, key=lambda k: _group(contacts[k]))
    sizes = [len(contacts[k].points_C) for k in order]
    of_point = np.repeat(np.array(order, dtype=int), sizes)
    group = np.repeat(np.array([_group(contacts[k]) for k in order], dtype=int), sizes)
    counts = np.bincount(group, minlength=4)
    in_plane = np.vstack([contacts[k].points_C for k in order]) / units.length if order else np.zeros((0, 2))
    R = rotation[of_point]
    point = position[of_point] + np.einsum("nij,nj->ni", R[:, :, :2], in_plane)
    slipping, box, elliptic = int(counts[:3].sum()), int(counts[1]), int(counts[2])

    tangents = R[:slipping, :, :2].transpose(0, 2, 1).reshape(-1, 3)
    G_t = _directions(np.repeat(point[:slipping], 2, axis=0), tangents)
    G_n = _directions(point, R[:, :, 2])
    soft = slice(int(counts[0]), slipping)
    G_m = np.vstack([np.zeros((3, box + elliptic)), R[soft, :, 2].T])

    handles = [(k, COMPONENTS.index(word)) for k, c in enumerate(contacts) if isinstance(c, Handle) for word in c.transmits]
    of_handle = np.array([k for k, _ in handles], dtype=int)
    component = np.array([i for _, i in handles], dtype=int)
    axes = rotation[of_handle, :, component % 3] if handles else np.zeros((0, 3))
    forces = (component < 3)[:, None]
    G_h = np.where(forces.T, _directions(position[of_handle], axes), np.vstack([np.zeros_like(axes.T), axes.T]))
    G = np.hstack([G_t, G_n, G_m, G_h])

    load, shift, com = gravity_load(stance, units)
    bounded = [k for k in unilateral if contacts[k].normal_force is not None]
    rows, values, labels = _handle_limits(contacts, handles, units, G.shape[1])
    of_column = np.concatenate([np.repeat(of_point[:slipping], 2), of_point, of_point[soft], of_handle])
    torques = joint_torques(stance, units, G, of_column, position)
    if stance.torque_limits is not None:
        torque_rows, torque_values, joints = limit_rows(torques)
        rows, values, labels = np.vstack([rows, torque_rows]), np.concatenate([values, torque_values]), (*labels, *joints)
    return StaticsData(
        units=units,
        circular=int(counts[:2].sum()),
        box=box,
        elliptic=elliptic,
        frictionless=int(counts[3]),
        wrench_map=G,
        load=load,
        com_load=shift,
        com=com,
        friction=np.array([contacts[k].friction for k in of_point[:slipping]], dtype=float),
        torsion=np.array([contacts[k].torsional_friction / units.length for k in of_point[soft]], dtype=float),  # type: ignore[attr-defined]
        contact_of_point=of_point,
        contact_of_handle=of_handle,
        component_of_handle=component,
        bounded=np.array(bounded, dtype=int),
        bounds=np.array([contacts[k].normal_force for k in bounded], dtype=float).reshape(-1, 2) / units.force,
        limit_rows=rows,
        limit_values=values,
        limit_names=labels,
        rotation=rotation,
        position=position,
        point=point,
        names=stance.contacts.names,
        torques=torques,
    )


def _handle_limits(
    contacts: list[Contact], handles: list[tuple[int, int]], units: Units, columns: int
) -> tuple[Array, Array, tuple[str, ...]]:
    """Hard rows of the finite handle limits: component <= hi and -component <= -lo."""
    rows, values, labels = [], [], []
    first = columns - len(handles)
    for j, (k, i) in enumerate(handles):
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
