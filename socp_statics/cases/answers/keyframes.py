"""``model = "keyframes"``: the verdict of every contact state and along every transition, and the first failure by name."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
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
    from socp_statics.postures.contact_states import keyframes_of
    from socp_statics.stability import check_equilibrium

    stated, posture = problem.posture, stance.posture
    if posture is None or stated["generator"] != "keyframes":
        raise InputError(f"model keyframes needs the generator keyframes, got {stated['generator']!r}", field="generator")
    frames = keyframes_of(posture.robot, stated["states"], stated["friction"], stated["at"])
    entries, worst = [], None
    for where, progress, sample in _samples(frames, problem.parameters["steps"]):
        here = robot_stance(sample, stated, problem.parameters["torque_limits"])
        found = check_equilibrium(here, cone=problem.cone, form=problem.parameters["form"], engine=engine)
        reading = None if found.certificate is None else found.certificate.as_record().get("reading")
        entries.append(
            {"where": where, "progress": progress, "support": list(sample.support), "verdict": found.verdict, "reason": found.reason,
             "margin": found.margin, "reading": reading}
        )  # fmt: skip
        if worst is None or (worst[1].verdict == "stable" and (found.verdict != "stable" or found.margin < worst[1].margin)):
            worst = (here, found)
    assert worst is not None
    failure = next((entry for entry in entries if entry["verdict"] != "stable"), None)
    return {**verdict_keys(worst[1], worst[0]), "keyframes": entries, "first_failure": failure, "stance": worst[0]}


ANSWER = Answer(KeyframesParameters, answer, RECORD_KEYS | {"keyframes": [KEYS], "first_failure": KEYS})
