"""``model = "keyframes"``: the verdict of every contact state and along every transition, and the first failure by name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from pydantic import Field

from socp_statics.cases.answers.answer import RECORD_KEYS, Answer, Parameters
from socp_statics.cases.answers.equilibrium import verdict_keys
from socp_statics.cases.robot_posture import robot_stance
from socp_statics.exceptions import InputError

if TYPE_CHECKING:
    from socp_statics.cases.problem import Problem
    from socp_statics.contacts import Stance
    from socp_statics.postures import Posture
    from socp_statics.postures.contact_states import Keyframes

KEYS = {"where": None, "progress": None, "support": [None], "verdict": None, "reason": None, "margin": None, "reading": None}


class KeyframesParameters(Parameters):
    """``[parameters]`` of a keyframes problem."""

    steps: int = Field(10, ge=1, description="a whole number >= 1")


def _frames(problem: Problem, posture: Posture) -> Keyframes:
    from socp_statics.postures.contact_states import keyframes_of

    return keyframes_of(posture.robot, *(problem.posture[key] for key in ("states", "friction", "at")))


def _samples(frames: Keyframes, steps: int) -> Iterator[tuple[str, float, Posture]]:
    """What is looked at in turn: its name, its progress and its posture; both ends of a transition belong to it."""
    for number, state in enumerate(frames.states):
        yield state.name, float(number), frames.postures[number]
        if number + 1 < len(frames.states):
            for step in range(steps + 1):
                share = step / steps
                yield f"{state.name} -> {frames.states[number + 1].name}", number + share, frames.between(number, share)


def answer(problem: Problem, stance: Stance, engine: str | Sequence[str]) -> dict[str, Any]:
    """Verdict and margin along the way; forces and certificate of the first failure, else of the least margin.

    Args:
        problem: Its parameters and states.
        stance: Its stance, of the robot that is asked about.
        engine: "auto", the name of an engine, or several to be tried in turn.

    Raises:
        InputError: The generator is not keyframes, or the way between two states cannot be reached.
    """
    # the answers are listed and problems validated without a solver: it is imported when one is solved
    from socp_statics.stability import check_equilibrium

    stated, posture = problem.posture, stance.posture
    if posture is None or stated["generator"] != "keyframes":
        raise InputError(f"model keyframes needs the generator keyframes, got {stated['generator']!r}", field="generator")
    frames = _frames(problem, posture)
    entries, found = [], []
    for where, progress, sample in _samples(frames, problem.parameters["steps"]):
        here = robot_stance(sample, stated, problem.parameters["torque_limits"])
        judged = check_equilibrium(here, cone=problem.cone, form=problem.parameters["form"], engine=engine)
        reading = None if judged.certificate is None else judged.certificate.as_record().get("reading")
        found.append((judged, here))
        entries.append(
            {"where": where, "progress": progress, "support": list(sample.support), "verdict": judged.verdict, "reason": judged.reason,
             "margin": judged.margin, "reading": reading}
        )  # fmt: skip
    worst = _worst(entries)
    failure = entries[worst] if entries[worst]["verdict"] != "stable" else None
    return {**verdict_keys(*found[worst]), "keyframes": entries, "first_failure": failure, "stance": found[worst][1]}


def _worst(entries: Sequence[Mapping[str, Any]]) -> int:
    """Number of the first failure, else of the least margin."""
    failed = [number for number, entry in enumerate(entries) if entry["verdict"] != "stable"]
    return failed[0] if failed else min(range(len(entries)), key=lambda number: float(entries[number]["margin"]))


def shown(problem: Problem, record: Mapping[str, Any]) -> Stance:
    """The stance of the posture that the forces of the record belong to."""
    assert problem.robot_posture is not None
    frames = _frames(problem, problem.robot_posture)
    samples = list(_samples(frames, problem.parameters["steps"]))
    return robot_stance(samples[_worst(record["keyframes"])][2], problem.posture, problem.parameters["torque_limits"])


ANSWER = Answer(KeyframesParameters, answer, RECORD_KEYS | {"keyframes": [KEYS], "first_failure": KEYS}, shown=shown)
