"""What a batch asks: contact sets, the loads on each, and how; its arguments are checked here."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from socp_statics.cones.choice import ConeChoice
from socp_statics.contacts import Contact, ContactSet, ExternalWrench, Stance
from socp_statics.contacts.stance import GRAVITY_W, as_contact_set, stance_of
from socp_statics.exceptions import InputError
from socp_statics.spatial import Array
from socp_statics.statics.units import loads_row

CHUNK = 256


@dataclass(frozen=True, eq=False)
class Questions:
    """What is asked: contact sets, the loads on each, and how."""

    sets: list[ContactSet]
    items: NDArray[np.int_]
    loads: Array
    stances: Sequence[Stance] | None
    coms: Array
    masses: Array
    gravities: Array
    wrenches: tuple[ExternalWrench, ...]
    extra: Array | None
    cone: ConeChoice
    form: str
    engine: str | Sequence[str]

    def stance(self, k: int) -> Stance:
        """The stance of one load."""
        if self.stances is not None:
            return self.stances[k]
        own = () if self.extra is None else (ExternalWrench(self.extra[k, :3], self.extra[k, 3:], (0.0, 0.0, 0.0)),)
        contacts = self.sets[int(np.searchsorted(self.items, k, side="right")) - 1]
        return Stance(contacts, self.coms[k], float(self.masses[k]), self.gravities[k], (*self.wrenches, *own))

    @property
    def points_only(self) -> bool:
        """Whether nothing but friction and unilaterality limits the forces, so that the kernel's programs for points apply."""
        limited = self.stances is not None and any(s.torque_limits is not None for s in self.stances)
        return not limited and all(s.friction_points is not None for s in self.sets)

    def chosen(self, which: NDArray[np.int_]) -> tuple[list[ContactSet], NDArray[np.int_], Array]:
        """Contact sets, where the loads of each start, and the end, and the loads of some of the questions."""
        if len(self.sets) == 1:
            return self.sets, np.array([0, len(which)]), self.loads[which]
        return [self.sets[k] for k in which], np.arange(len(which) + 1), self.loads[which]

    def world_forces(self, multipliers: Array, which: NDArray[np.int_]) -> Array:
        """Forces of many loads on one contact set in world axes.

        Args:
            multipliers: Of the rows of the compiled programs, scaled, k loads one after the other.
            which: The k questions.

        Returns:
            Forces at ``contacts.points_W``, shape (k, points, 3) [N].

        Raises:
            InputError: There are several contact sets.
        """
        from socp_statics.engines.kernel.pyramids import unknowns

        contacts = self.one_set()
        points = contacts.friction_points
        assert points is not None
        x = unknowns(points, self.cone, multipliers.reshape(len(which), -1))
        slipping = int((points[:, 12] > 0.0).sum())
        local = np.zeros((len(which), len(points), 3))
        local[:, :slipping, :2] = x[:, : 2 * slipping].reshape(len(which), slipping, 2)
        local[:, :, 2] = x[:, 2 * slipping :]
        axes = points[:, 3:12].reshape(-1, 3, 3)
        out = np.empty_like(local)
        of_contact = [c.friction == 0.0 for c in contacts for _ in c.points_C]
        out[:, np.argsort(of_contact, kind="stable")] = np.einsum("bni,nij->bnj", local, axes) * self.loads[which, 9, None, None]
        return out

    def one_set(self) -> ContactSet:
        """The one contact set of all questions.

        Raises:
            InputError: There are several.
        """
        if len(self.sets) > 1:
            raise InputError("forces: there are several contact sets, ask each item for its forces", name="forces", field="forces")
        return self.sets[0]


def pieces(chosen: NDArray[np.int_]) -> list[NDArray[np.int_]]:
    """Questions in pieces for threads; pieces do not depend on the number of threads, so that neither do the answers."""
    return [chosen[a : a + CHUNK] for a in range(0, len(chosen), CHUNK)]


def questions(contacts: Any, coms: Any, mass: Any, gravity: Any, wrenches: tuple[ExternalWrench, ...], loads: Any, torque_limits: Any,
               cone: ConeChoice, form: str, engine: str | Sequence[str]) -> Questions:  # fmt: skip
    """Check the arguments of a batch and lay the loads side by side.

    Args:
        contacts: One contact set; or a sequence of contact sets, stances or postures, one a question.
        coms: Centres of mass, shape (b, 3) [m].
        mass: Mass, one number or shape (b,) [kg].
        gravity: Acceleration of gravity, shape (3,) or (b, 3) [m/s^2].
        wrenches: Wrenches impressed in every question.
        loads: One more wrench for each question about the world's origin, shape (b, 6) [N, N m].
        torque_limits: As in `check_equilibrium`, where postures are given.
        cone: Exact cones or pyramids.
        form: "socp" or "sdp".
        engine: "auto", the name of an engine, or several to be tried in turn.

    Raises:
        InputError: A number or what is asked about is wrong, in words that name it.
    """
    if _brings_com(contacts):
        contacts = [contacts]
    several = not isinstance(contacts, ContactSet) and not _is_one_set(contacts)
    if several:
        given = list(contacts)
        if given and _brings_com(given[0]):
            if coms is not None or loads is not None:
                what = "coms" if coms is not None else "loads"
                raise InputError(f"{what}: stances and postures bring their own, pass their contacts instead", name=what, field=what)
            stances = [stance_of(one, None, mass, gravity, wrenches, torque_limits) for one in given]
            return _of_stances(stances, cone, form, engine)
        sets = [as_contact_set(one) for one in given]
    else:
        sets = [as_contact_set(contacts)]
    if coms is None:
        raise InputError("coms is missing, give the centres of mass, shape (b, 3)", name="coms", field="coms")
    places = _numbers(coms, (3,), len(sets) if several else None, "coms")
    batch = len(places)
    if torque_limits is not False:
        raise InputError("torque_limits need a robot, contacts alone have no joints", name="torque_limits", field="torque_limits")
    if mass is None and (sets or wrenches):
        for one in sets:
            stance_of(one, (0.0, 0.0, 0.0), None, None, (*wrenches, *(() if loads is None else (ExternalWrench(),))))
    masses = _numbers(1.0 if mass is None else mass, (), batch, "mass")
    if (masses <= 0.0).any():
        bad = int(np.flatnonzero(masses <= 0.0)[0])
        raise InputError(f"mass must be > 0, entry {bad} is {masses[bad]}", name="mass", field="mass")
    gravities = _numbers(GRAVITY_W if gravity is None else gravity, (3,), batch, "gravity")
    extra = None if loads is None else _numbers(loads, (6,), batch, "loads")
    items = np.arange(len(sets) + 1) if several else np.array([0, batch])
    rows = np.zeros((batch, 13))
    rows[:, :3] = masses[:, None] * gravities
    rows[:, 9] = np.linalg.norm(rows[:, :3], axis=1)
    rows[:, 10:] = places
    if wrenches or extra is not None:
        _impress(rows, sets, items, wrenches, extra)
    rows[rows[:, 9] == 0.0, 9] = 1.0
    return Questions(sets, items, rows, None, places, masses, gravities, wrenches, extra, cone, form, engine)


def _numbers(value: Any, shape: tuple[int, ...], batch: int | None, name: str) -> Array:
    """Numbers of one question or of all, repeated for all, shape (b, ...).

    Raises:
        InputError: The shape is wrong or a number is not finite.
    """
    words = f"({', '.join(str(n) for n in shape)}) or (b{''.join(f', {n}' for n in shape)})" if shape else "one number or (b,)"
    try:
        array = np.array(value, dtype=float)
    except (TypeError, ValueError) as error:
        raise InputError(f"{name} must be numbers of shape {words}, got {value!r}", name=name, field=name) from error
    if array.shape == shape and batch is not None:
        array = np.broadcast_to(array, (batch, *shape)).copy()
    if array.ndim != len(shape) + 1 or array.shape[1:] != shape or (batch is not None and len(array) != batch):
        count = "" if batch is None else f" with b = {batch}"
        raise InputError(f"{name} must be numbers of shape {words}{count}, got shape {np.shape(value)}", name=name, field=name)
    if not np.isfinite(array).all():
        bad = int(np.flatnonzero(~np.isfinite(array).reshape(len(array), -1).all(axis=1))[0])
        raise InputError(f"{name} must be finite, entry {bad} is {array[bad].tolist()}", name=name, field=name)
    return array


def _impress(
    rows: Array, sets: list[ContactSet], items: NDArray[np.int_], wrenches: tuple[ExternalWrench, ...], extra: Array | None
) -> None:
    """Add the external wrenches to the rows, moments about each set's mean contact point, and what they are to W."""
    of_item = np.repeat(np.arange(len(sets)), np.diff(items))
    centre = np.array([s.centre for s in sets])[of_item]
    size = np.array([s.size for s in sets])[of_item]
    for wrench in wrenches:
        rows[:, 3:6] += wrench.force
        rows[:, 6:9] += np.array([wrench.moment_about(s.centre) for s in sets])[of_item]
        moment = float(np.linalg.norm(wrench.moment))
        rows[:, 9] = np.maximum(rows[:, 9], np.maximum(float(np.linalg.norm(wrench.force)), moment / size))
    if extra is not None:
        force = extra[:, :3]
        rows[:, 3:6] += force
        rows[:, 6:9] += extra[:, 3:] - np.cross(centre, force)
        norms = np.maximum(np.linalg.norm(force, axis=1), np.linalg.norm(extra[:, 3:], axis=1) / size)
        rows[:, 9] = np.maximum(rows[:, 9], norms)


def _of_stances(stances: list[Stance], cone: ConeChoice, form: str, engine: str | Sequence[str]) -> Questions:
    """One question a stance."""
    batch = len(stances)
    rows = np.zeros((batch, 13))
    for row, stance in zip(rows, stances, strict=True):
        row[:] = *loads_row(stance), *stance.com
    none = np.zeros((0, 3))
    sets = [s.contacts for s in stances]
    return Questions(sets, np.arange(batch + 1), rows, stances, none, np.zeros(0), none, (), None, cone, form, engine)


def _brings_com(one: Any) -> bool:
    """Whether contacts come with a centre of mass: a stance or a posture."""
    return isinstance(one, Stance) or hasattr(one, "com_jacobian")


def _is_one_set(contacts: Any) -> bool:
    """Whether this is one set of contacts and not a sequence of sets."""
    if not isinstance(contacts, Sequence):
        raise InputError(f"contacts: a contact set or a sequence of them is expected, got {contacts!r}", name="contacts", field="contacts")
    return bool(contacts) and isinstance(contacts[0], Contact)
