"""Many minimax forces at once: many loads on one contact set, or many contact sets."""

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
from socp_statics.optimization.compiled_minimax import LargestForces, compiled_largest_forces
from socp_statics.optimization.force_answer import ForceAnswer
from socp_statics.optimization.minimax_wrench import minimise_largest_wrench
from socp_statics.spatial import Array
from socp_statics.stability import EquilibriumAnswers
from socp_statics.stability.many import answered
from socp_statics.stability.questions import Questions, pieces, questions


class LargestForceAnswers(Sequence[ForceAnswer]):
    """Answers to many questions "how small can the largest force be?"; an item is the whole answer, made when it is asked for.

    Attributes:
        objective: Least possible largest force at a contact point, nan where nothing balances, shape (b,) [N].
        status: "solved", "infeasible" or "unbounded", shape (b,).
        engine: Name of the engine that answered, shape (b,).
        handovers: How many programs went to another engine, shape (b,).
        equilibrium: Verdicts and margins of the same loads; its items carry the certificates.
    """

    def __init__(self, question: Questions, equilibrium: EquilibriumAnswers, tried: NDArray[np.int_], found: LargestForces | None,
                 answers: dict[int, ForceAnswer]):  # fmt: skip
        self._question, self._tried, self._found, self._answers = question, tried, found, answers
        self._left = tuple(answers)
        self.equilibrium = equilibrium
        self.objective = np.full(len(equilibrium), np.nan)
        self.status = np.full(len(equilibrium), "infeasible", dtype="<U10")
        self.engine, self.handovers = equilibrium.engine.copy(), equilibrium.handovers.copy()
        if found is not None:
            settled = tried[found.settled]
            self.objective[settled] = found.value[found.settled] * question.loads[settled, 9]
            self.status[settled], self.engine[settled] = "solved", "kernel"
        for k, answer in answers.items():
            self.objective[k] = np.nan if answer.objective is None else answer.objective
            self.status[k], self.engine[k], self.handovers[k] = answer.status, answer.engine, answer.handovers

    def __len__(self) -> int:
        return len(self.objective)

    def __getitem__(self, i: Any) -> Any:
        if isinstance(i, slice):
            return [self[k] for k in range(*i.indices(len(self)))]
        k = range(len(self))[i]
        if k not in self._answers:
            self._answers[k] = _answer(self._question, k)
        return self._answers[k]

    @cached_property
    def forces(self) -> Array:
        """Optimal forces of many loads on one contact set, world axes, nan where there are none, shape (b, points, 3) [N].

        The points are those of ``contacts.points_W``.

        Raises:
            InputError: There are several contact sets; ask the items.
        """
        asked, contacts, found = self._question, self._question.one_set(), self._found
        out = np.full((len(self), len(contacts.points_W), 3), np.nan)
        if found is not None:
            out[self._tried[found.settled]] = asked.world_forces(found.forces, self._tried)[found.settled]
        for k in self._left:
            forces = self._answers[k].forces
            if forces is not None:
                out[k] = forces.force_W
        return out


def _answer(asked: Questions, k: int) -> ForceAnswer:
    """The whole answer of one load."""
    return minimise_largest_wrench(asked.stance(k), "force", "point", cone=asked.cone, form=asked.form, engine=asked.engine)


def minimise_largest_force_many(
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
) -> LargestForceAnswers:
    """Balancing forces whose largest norm is least, of many loads on one contact set, or of many contact sets.

    Args:
        contacts: One contact set; or a sequence of contact sets, stances or postures, one a question.
        coms: Centres of mass in world axes, shape (b, 3) [m]; a stance or posture brings its own.
        mass: Mass, one number or shape (b,) [kg]; may be left out as in `check_equilibrium`, forces are then per kilogram.
        cone: "exact", "inscribed" or "circumscribed", or a ConeChoice.
        sides: Sides of the pyramids.
        heading: Heading of the pyramids [rad].
        form: "socp" or "sdp".
        engine: "auto", the name of an engine, or several to be tried in turn.
        gravity: Acceleration of gravity in world axes, shape (3,) or (b, 3) [m/s^2].
        external_wrenches: Wrenches impressed on the robot in every question.
        loads: One more wrench for each question, force and moment about the world's origin, shape (b, 6) [N, N m].
        torque_limits: As in `minimise_largest_wrench`, where postures are given.
        threads: How many threads work at the same time; the answers do not depend on it.

    Returns:
        The answers of `minimise_largest_wrench` with measure "force" and level "point", in order.

    Raises:
        InputError: A number, name or choice is wrong.
        EngineError: No engine settled a program.
    """
    choice = cone_choice(cone, sides, heading)
    checked_threads(threads)
    wrenches = tuple(as_external_wrench(w) for w in external_wrenches)
    asked = questions(contacts, coms, mass, gravity, wrenches, loads, torque_limits, choice, form, engine)
    equilibrium = answered(asked, threads)
    left = equilibrium.verdict != "unstable"
    tried, found = np.flatnonzero(left), None
    if len(tried) and compiled_first(engine, form) and choice.is_exact and asked.points_only:

        def forces(part: Sequence[NDArray[np.int_]]) -> list[LargestForces]:
            return [compiled_largest_forces(*asked.chosen(part[0]))]

        each = in_chunks(forces, pieces(tried), 1, threads)
        found = LargestForces(*(np.concatenate(field) for field in zip(*each, strict=True)))
        left[tried[found.settled]] = False
    answers = {int(k): _answer(asked, int(k)) for k in np.flatnonzero(left)}
    return LargestForceAnswers(asked, equilibrium, tried, found, answers)
