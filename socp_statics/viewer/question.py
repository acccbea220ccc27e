"""What is looked at: a problem with its answer, and the same question about a centre of mass that was moved."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.cases.answers import ANSWERS
from socp_statics.cases.answers.answer import RECORD_KEYS
from socp_statics.cases.answers.equilibrium import verdict_keys
from socp_statics.cases.answers.safety import safety_verdict
from socp_statics.cases.answers.support_region import agree
from socp_statics.cases.problem import Problem
from socp_statics.cases.record import Record
from socp_statics.contacts import Stance
from socp_statics.exceptions import InputError
from socp_statics.regions import SupportRegion, trace_support_region
from socp_statics.stability import check_equilibrium

TOLERANCE, COARSE = 1e-3, 0.1
# what a model adds to the common keys of a record and is still known where its centre of mass was moved
FOLLOWING = {"region", "com_margin", "safety", "objective"}


@dataclass(frozen=True, eq=False)
class Question:
    """A problem that was answered.

    Attributes:
        problem: A single problem.
        record: Its answer.
        engine: As for `socp_statics.cases.solve.solve`.
        stance: Its stance.
        region: Its support region; None where gravity has no vertical part.
    """

    problem: Problem
    record: Record
    engine: str | Sequence[str]
    stance: Stance
    region: SupportRegion | None

    def moved_to(self, xy_W: ArrayLike) -> tuple[Stance, Record]:
        """The same question with the centre of mass elsewhere at its height; a robot keeps its posture.

        Args:
            xy_W: Where the centre of mass is moved to, shape (2,) [m].

        Returns:
            The stance and its answer: the record of the problem with the keys that follow the centre of mass. A model that does not
            is answered with verdict and margin alone.

        Raises:
            EngineError: No engine settled a program.
        """
        stance = replace(self.stance, com=np.array([*np.asarray(xy_W, dtype=float), self.stance.com[2]]))
        answer = ANSWERS.load(self.problem.model)
        if answer.follows_com:
            keys = answer.compute(self.problem, stance, self.engine)
        else:
            settings = {"cone": self.problem.cone, "form": self.problem.parameters["form"], "engine": self.engine}
            keys = verdict_keys(check_equilibrium(stance, **settings), stance)
        region = None if self.region is None else traced(self.problem, stance, self.engine, COARSE)
        keys["com_margin"] = None if region is None else agree(region.com_margin, keys["verdict"])
        if "region" in self.record:
            keys["status"] = self.record["status"]
        if "safety" in self.record:
            keys["safety"] = safety_verdict(stance, keys["com_margin"], self.record["safety"]["offset"])
        gone = set() if answer.follows_com else set(answer.record_keys) - set(RECORD_KEYS) - FOLLOWING
        kept = {key: value for key, value in self.record.items() if key not in gone}
        return stance, _about(kept, keys, stance)


def ask(problem: Problem, record: Record, engine: str | Sequence[str]) -> Question:
    """The question of a problem and its answer.

    Args:
        problem: A single problem.
        record: Its record.
        engine: As for `socp_statics.cases.solve.solve`.

    Raises:
        EngineError: No engine settled the region.
    """
    stance = problem.stance()
    region = traced(problem, stance, engine, problem.parameters.get("tolerance", TOLERANCE))
    if region is not None and record["com_margin"] is None:
        record = Record(dict(record) | {"com_margin": agree(region.com_margin, record["verdict"])})
    return Question(problem, record, engine, stance, region)


def traced(problem: Problem, stance: Stance, engine: str | Sequence[str], tolerance: float) -> SupportRegion | None:
    """The support region of a stance of a problem; None where gravity has no vertical part.

    Args:
        problem: Its parameters.
        stance: The stance.
        engine: As for `socp_statics.cases.solve.solve`.
        tolerance: Of its area; the margin of the centre of mass does not depend on it.
    """
    try:
        return trace_support_region(stance, tolerance, cone=problem.cone, form=problem.parameters["form"], engine=engine)
    except InputError as error:
        if error.field == "gravity":
            return None
        raise


def _about(record: Mapping[str, Any], keys: Mapping[str, Any], stance: Stance) -> Record:
    """The record with other answers, and without what was expected of the first one."""
    case = record["case"]
    moved = case | {"generated": case["generated"] | {"com": stance.com}}
    return Record({**record, **keys, "case": moved, "expect": []})
