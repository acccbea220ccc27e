"""Many verdicts at once: many loads on one contact set, or many contact sets."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from socp_statics.cones.choice import ConeChoice, cone_choice
from socp_statics.contacts import ExternalWrench
from socp_statics.contacts.stance import as_external_wrench
from socp_statics.engines import compiled_first
from socp_statics.engines.threads import checked_threads, in_chunks
from socp_statics.spatial import Array
from socp_statics.stability.compiled_margin import Reserves, compiled_reserves
from socp_statics.stability.equilibrium import EquilibriumAnswer, check_equilibrium
from socp_statics.stability.questions import Questions, pieces, questions
from socp_statics.statics.units import BOUNDARY

VERDICTS = np.array(["unstable", "undecided", "stable"])


class EquilibriumAnswers(Sequence[EquilibriumAnswer]):
    """Answers to many questions "is it stable?"; an item is the whole answer, made when it is asked for.

    Attributes:
        verdict: "stable", "unstable" or "undecided", shape (b,).
        margin: Normal-force reserve, shape (b,) [N]; inf, -inf, or nan where the rank leaves it open.
        engine: Name of the engine that answered, shape (b,).
        handovers: How many programs went to another engine, shape (b,).
    """

    def __init__(self, question: Questions, margin: Array, verdict: NDArray[np.str_], reserves: list[Reserves],
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
            self._answers[k] = _answer(self._question, k)
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
        asked, contacts = self._question, self._question.one_set()
        out = np.full((len(self), len(contacts.points_W), 3), np.nan)
        found = [r.forces for r in self._reserves]
        if found:
            out[:] = asked.world_forces(np.concatenate(found), np.arange(len(self)))
        for k, answer in self._answers.items():
            if answer.forces is not None:
                out[k] = answer.forces.force_W
        out[~self.stable] = np.nan
        return out


def _answer(asked: Questions, k: int) -> EquilibriumAnswer:
    """The whole answer of one load."""
    return check_equilibrium(asked.stance(k), cone=asked.cone, form=asked.form, engine=asked.engine)


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
    asked = questions(contacts, coms, mass, gravity, wrenches, loads, torque_limits, choice, form, engine)
    return answered(asked, threads)


def answered(asked: Questions, threads: int) -> EquilibriumAnswers:
    """Verdicts and margins of a batch.

    Args:
        asked: The questions.
        threads: Number of threads.

    Raises:
        EngineError: No engine settled a program.
    """
    batch = len(asked.loads)
    margin, sign = np.full(batch, np.nan), np.ones(batch, dtype=int)
    left = np.ones(batch, dtype=bool)
    reserves: list[Reserves] = []
    if compiled_first(asked.engine, asked.form) and asked.points_only:

        def margins(part: Sequence[NDArray[np.int_]]) -> list[Reserves]:
            sets, items, loads = asked.chosen(part[0])
            return [compiled_reserves(sets, asked.cone, items, loads)]

        reserves = in_chunks(margins, pieces(np.arange(batch)), 1, threads)
        value = np.concatenate([r.margin for r in reserves]) if reserves else margin
        settled = np.concatenate([r.settled for r in reserves]) if reserves else ~left
        left = ~settled | (np.abs(value) < BOUNDARY)
        margin = value * asked.loads[:, 9]
        sign = np.where(value > 0.0, 2, 0)
    answers = {int(k): _answer(asked, int(k)) for k in np.flatnonzero(left)}
    verdict = VERDICTS[sign]
    for k, answer in answers.items():
        margin[k], verdict[k] = answer.margin, answer.verdict
    return EquilibriumAnswers(asked, margin, verdict, reserves, answers)
