"""Many verdicts at once: many loads on one contact set, or many contact sets."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from socp_statics.cones.choice import ConeChoice, cone_choice
from socp_statics.contacts import Contact, ContactSet, ExternalWrench, Stance
from socp_statics.contacts.stance import GRAVITY_W, as_contact_set, as_external_wrench, stance_of
from socp_statics.engines import compiled_first
from socp_statics.engines.threads import checked_threads, in_chunks
from socp_statics.exceptions import InputError
from socp_statics.spatial import Array
from socp_statics.stability.compiled_margin import Reserves, compiled_reserves
from socp_statics.stability.equilibrium import EquilibriumAnswer, check_equilibrium
from socp_statics.statics.units import BOUNDARY, loads_row

CHUNK = 256
VERDICTS = np.array(["unstable", "undecided", "stable"])


class EquilibriumAnswers(Sequence[EquilibriumAnswer]):
    """Answers to many questions "is it stable?"; an item is the whole answer, made when it is asked for.

    Attributes:
        verdict: "stable", "unstable" or "undecided", shape (b,).
        margin: Normal-force reserve, shape (b,) [N]; inf, -inf, or nan where the rank leaves it open.
        engine: Name of the engine that answered, shape (b,).
        handovers: How many programs went to another engine, shape (b,).
    """

    def __init__(self, question: _Questions, margin: Array, verdict: NDArray[np.str_], reserves: list[Reserves | None],
                 answers: dict[int, EquilibriumAnswer]):  # fmt: skip
        self._question, self._reserves, self._answers = question, reserves, answers
        self.margin, self.verdict = margin, verdict
        self.engine = np.full(len(margin), "kernel", dtype="<U16")
        self.handovers = np.zeros(len(margin), dtype=int)
        for i, answer in answers.items():
            self.engine[i], self.handovers[i] = answer.engine, answer.handovers

    def __len__(self) -> int:
        return len(self.margin)

    def __getitem__(self, i: Any) -> Any:
        if isinstance(i, slice):
            return [self[k] for k in range(*i.indices(len(self)))]
        k = range(len(self))[i]
        if k not in self._answers:
            self._answers[k] = self._question.answer(k)
        return self._answers[k]

    @property
    def stable(self) -> NDArray[np.bool_]:
        """Where the verdict is "stable", shape (b,)."""
        return self.verdict == "stable"

    @cached_property
    def forces(self) -> Array:
        """Balancing forces of many loads on one contact set, world axes, nan where there are none, shape (b, points, 3) [N].

        The points are those of ``contacts.points_W``.

        Raises:
            InputError: There are several contact sets; ask the items.
        """
        return self._question.forces(self._reserves, self._answers, self.verdict)


@dataclass(frozen=True, eq=False)
class _Questions:
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

    def answer(self, k: int) -> EquilibriumAnswer:
        """The whole answer of one load."""
        return check_equilibrium(self.stance(k), cone=self.cone, form=self.form, engine=self.engine)

    def forces(self, reserves: list[Reserves | None], answers: dict[int, EquilibriumAnswer], verdict: NDArray[np.str_]) -> Array:
        """See `EquilibriumAnswers.forces`."""
        from socp_statics.engines.kernel.pyramids import unknowns

        if len(self.sets) > 1:
            raise InputError("forces: there are several contact sets, ask each item for its forces", name="forces", field="forces")
        contacts = self.sets[0]
        out = np.full((len(verdict), len(contacts.points_W), 3), np.nan)
        found = [r for r in reserves if r is not None]
        points = contacts.friction_points
        if found and points is not None:
            rows = sum(len(r.margin) for r in found)
            x = unknowns(points, self.cone, np.concatenate([r.forces for r in found]).reshape(rows, -1))
            slipping = int((points[:, 12] > 0.0).sum())
            normal = x[:, 2 * slipping :]
            local = np.zeros((rows, len(points), 3))
            local[:, :slipping, :2] = x[:, : 2 * slipping].reshape(rows, slipping, 2)
            local[:, :, 2] = normal
            axes = points[:, 3:12].reshape(-1, 3, 3)
            world = np.einsum("bni,nij->bnj", local, axes) * self.loads[:, 9, None, None]
            of_contact = [c.friction == 0.0 for c in contacts for _ in c.points_C]
            out[:, np.argsort(of_contact, kind="stable")] = world
        for k, answer in answers.items():
            if answer.forces is not None:
                out[k] = answer.forces.force_W
        out[verdict != "stable"] = np.nan
        return out


def check_equilibrium_many(
    contacts: Any,
    coms: ArrayLike | None = None,
    mass: ArrayLike | None = None,
    *,
    cone: str | ConeChoice = "exact",
    sides: int | None = None,
    heading: float | None = None,
    form: str = "socp",
    engine: str | Sequence[str] = "auto",
    gravity: ArrayLike | None = None,
    external_wrenches: Iterable[ExternalWrench | dict[str, Any]] = (),
    loads: ArrayLike | None = None,
    torque_limits: Any = False,
    threads: int = 1,
) -> EquilibriumAnswers:
    """Verdicts and margins of many loads on one contact set, or of many contact sets.

    Args:
        contacts: One contact set; or a sequence of contact sets, stances or postures, one a question.
        coms: Centres of mass in world axes, shape (b, 3) [m]; a stance or posture brings its own.
        mass: Mass, one number or shape (b,) [kg]; may be left out as in `check_equilibrium`.
        cone: "exact", "inscribed" or "circumscribed", or a ConeChoice.
        sides: Sides of the pyramids.
        heading: Heading of the pyramids [rad].
        form: "socp" or "sdp".
        engine: "auto", the name of an engine, or several to be tried in turn.
        gravity: Acceleration of gravity in world axes, shape (3,) or (b, 3) [m/s^2].
        external_wrenches: Wrenches impressed on the robot in every question.
        loads: One more wrench for each question, force and moment about the world's origin, shape (b, 6) [N, N m].
        torque_limits: As in `check_equilibrium`, where postures are given.
        threads: How many threads work at the same time; the answers do not depend on it.

    Returns:
        The answers, in order.

    Raises:
        InputError: A number, name or choice is wrong.
        EngineError: No engine settled a program.
    """
    choice = cone_choice(cone, sides, heading)
    checked_threads(threads)
    wrenches = tuple(as_external_wrench(w) for w in external_wrenches)
    asked = _questions(contacts, coms, mass, gravity, wrenches, loads, torque_limits, choice, form, engine)
    batch = len(asked.loads)
    margin, sign = np.full(batch, np.nan), np.ones(batch, dtype=int)
    left = np.ones(batch, dtype=bool)
    reserves: list[Reserves | None] = []
    limited = asked.stances is not None and any(s.torque_limits is not None for s in asked.stances)
    if compiled_first(engine, form) and not limited and all(s.friction_points is not None for s in asked.sets):
        reserves = list(in_chunks(lambda part: [_piece(asked, part)], _pieces(asked), 1, threads))
        value = np.concatenate([r.margin for r in reserves if r is not None]) if reserves else margin
        settled = np.concatenate([r.settled for r in reserves if r is not None]) if reserves else ~left
        left = ~settled | (np.abs(value) < BOUNDARY)
        margin = value * asked.loads[:, 9]
        sign = np.where(value > 0.0, 2, 0)
    answers = {int(k): asked.answer(int(k)) for k in np.flatnonzero(left)}
    verdict = VERDICTS[sign]
    for k, answer in answers.items():
        margin[k], verdict[k] = answer.margin, answer.verdict
    return EquilibriumAnswers(asked, margin, verdict, reserves, answers)


def _pieces(asked: _Questions) -> list[tuple[int, int]]:
    """Ranges of questions: of one contact set's loads, or of contact sets."""
    total = len(asked.loads)
    return [(a, min(a + CHUNK, total)) for a in range(0, total, CHUNK)]


def _piece(asked: _Questions, part: Sequence[tuple[int, int]]) -> Reserves:
    """Margins of a range of questions."""
    ((first, last),) = part
    if len(asked.sets) == 1:
        return compiled_reserves(asked.sets, asked.cone, np.array([0, last - first]), asked.loads[first:last])
    return compiled_reserves(asked.sets[first:last], asked.cone, np.arange(last - first + 1), asked.loads[first:last])


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


def _questions(contacts: Any, coms: Any, mass: Any, gravity: Any, wrenches: tuple[ExternalWrench, ...], loads: Any, torque_limits: Any,
               cone: ConeChoice, form: str, engine: str | Sequence[str]) -> _Questions:  # fmt: skip
    """Check the arguments and lay the loads side by side."""
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
    return _Questions(sets, items, rows, None, places, masses, gravities, wrenches, extra, cone, form, engine)


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


def _of_stances(stances: list[Stance], cone: ConeChoice, form: str, engine: str | Sequence[str]) -> _Questions:
    """One question a stance."""
    batch = len(stances)
    rows = np.zeros((batch, 13))
    for row, stance in zip(rows, stances, strict=True):
        row[:] = *loads_row(stance), *stance.com
    none = np.zeros((0, 3))
    sets = [s.contacts for s in stances]
    return _Questions(sets, np.arange(batch + 1), rows, stances, none, np.zeros(0), none, (), None, cone, form, engine)


def _brings_com(one: Any) -> bool:
    """Whether contacts come with a centre of mass: a stance or a posture."""
    return isinstance(one, Stance) or hasattr(one, "com_jacobian")


def _is_one_set(contacts: Any) -> bool:
    """Whether this is one set of contacts and not a sequence of sets."""
    if not isinstance(contacts, Sequence):
        raise InputError(f"contacts: a contact set or a sequence of them is expected, got {contacts!r}", name="contacts", field="contacts")
    return bool(contacts) and isinstance(contacts[0], Contact)
