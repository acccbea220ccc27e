"""Verdicts and areas of many stances with the exact cone and with pyramids, asked in batches or read from records."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from socp_statics.cases.dotted import parse_key
from socp_statics.cases.hashing import canonical_json
from socp_statics.cases.problem import Problem
from socp_statics.comparison.pyramids import PYRAMIDS, SIDES, checked_sides
from socp_statics.cones.choice import EXACT, ConeChoice
from socp_statics.contacts import Stance
from socp_statics.exceptions import InputError
from socp_statics.regions import trace_support_regions
from socp_statics.spatial import Array
from socp_statics.stability import check_equilibrium_many

# A key with more values than this, a swept range and a seed repeat: they are no circumstances to compare by.
MOST_VALUES = 24
SEED = "seed"
REGION_TOLERANCE = 1e-3
CONE_KEYS = ("cone", "sides", "heading")
Key = tuple[str, int]


class Judged(NamedTuple):
    """All stances of a population with one cone.

    Attributes:
        verdict: "stable", "unstable", "undecided", or "" where it was not asked, shape (n,).
        area: Of the support region [m^2], inf where it has no end, nan where it is not known, shape (n,). In batches it is asked for
            where the exact region is a polygon.
    """

    verdict: NDArray[np.str_]
    area: Array


class Population(NamedTuple):
    """Many stances with the exact cone and with pyramids.

    Attributes:
        circumstances: What the stances are compared by: a word such as "friction" and the value for each stance, shape (n,).
        exact: With the exact cone.
        pyramids: By kind and number of sides.
        engines: Names of the engines that answered, and how many verdicts each.
    """

    circumstances: dict[str, NDArray[Any]]
    exact: Judged
    pyramids: dict[Key, Judged]
    engines: dict[str, int]

    def __len__(self) -> int:
        return len(self.exact.verdict)


def judge_problem(problem: Problem, sides: Sequence[int] = SIDES, *, threads: int = 1) -> Population:
    """Every case of a sweep with the exact cone and with pyramids, in batches.

    Args:
        problem: A problem with a ``[sweep]``; its own cone is not asked for, its heading is that of all pyramids.
        sides: Numbers of sides.
        threads: How many threads work at the same time; the answers do not depend on it.

    Raises:
        InputError: The sweep changes the cone, or a case is wrong.
        EngineError: No engine settled a program.
    """
    for key in problem.sweep:
        if parse_key(key, "sweep")[-1] in CONE_KEYS:
            message = f"{problem.label}: sweep key {key} changes the cone, which a comparison does itself; sweep other keys"
            raise InputError(message, name=key, field="sweep")
    stances: list[Stance] = []
    chosen: list[Mapping[str, Any]] = []
    for case in problem.cases():
        stances.append(case.stance())
        chosen.append({"posture": case.posture, "parameters": case.parameters})
    keys = [key for key, values in problem.sweep.items() if not isinstance(values, range)]
    circumstances = _circumstances(keys, [[_looked_up(one, parse_key(key, "sweep")) for one in chosen] for key in keys])
    return judge_stances(stances, circumstances, sides, heading=problem.parameters.get("heading") or 0.0, threads=threads)


def judge_stances(
    stances: Sequence[Stance], circumstances: Mapping[str, Sequence[Any]], sides: Sequence[int] = SIDES, *, heading: float = 0.0,
    threads: int = 1,
) -> Population:  # fmt: skip
    """Stances with the exact cone and with pyramids, in batches.

    Args:
        stances: The stances.
        circumstances: What they are compared by, one value for each stance.
        sides: Numbers of sides.
        heading: Of the pyramids [rad].
        threads: How many threads work at the same time; the answers do not depend on it.

    Raises:
        EngineError: No engine settled a program.
    """
    upright = np.array([abs(s.gravity[2]) > 1e-9 * float(np.linalg.norm(s.gravity)) for s in stances])
    engines: dict[str, int] = {}

    def judged(cone: ConeChoice, with_area: NDArray[np.bool_]) -> Judged:
        found = check_equilibrium_many(stances, cone=cone, threads=threads)
        for name in found.engine.tolist():
            engines[name] = engines.get(name, 0) + 1
        area, which = np.full(len(stances), np.nan), np.flatnonzero(with_area)
        regions = trace_support_regions([stances[int(k)] for k in which], REGION_TOLERANCE, cone=cone, threads=threads)
        for k, region in zip(which, regions, strict=True):
            area[k] = np.inf if region.kind == "unbounded" else 0.5 * (region.inner_area + region.outer_area)
        return Judged(found.verdict, area)

    exact = judged(EXACT, upright)
    bounded = np.isfinite(exact.area) & (exact.area > 0.0)
    pyramids = {(kind, n): judged(ConeChoice(kind, n, heading), bounded) for n in checked_sides(sides) for kind in PYRAMIDS}
    return Population({key: np.array(values) for key, values in circumstances.items()}, exact, pyramids, engines)


def judge_records(records: Iterable[Mapping[str, Any]], by: Sequence[str] = ("family", "friction", "slope")) -> Population:
    """The same from records, of runs with ``parameters.cone`` (and ``sides``) set or swept.

    Records of one posture with different cones are one stance; stances without a record of the exact cone are left out.

    Args:
        records: An iterable of records; nothing else of them is kept.
        by: Keys of ``[posture]`` to compare by, dotted; those that no record has, or that take more than 24 values, are left out.

    Raises:
        InputError: No record has the exact cone, or none a pyramid.
    """
    seen: dict[str, dict[Key, tuple[str, float]]] = {}
    stated: dict[str, list[Any]] = {}
    engines: dict[str, int] = {}
    for record in records:
        case, cone = record["case"], record["cone"]
        others = {key: value for key, value in case["parameters"].items() if key not in CONE_KEYS}
        key = canonical_json([record["model"], case["posture"], others])
        seen.setdefault(key, {})[cone["kind"], cone["sides"] or 0] = (record["verdict"], _area_in(record))
        stated[key] = [_looked_up(case["posture"], parse_key(word)) for word in by]
        engines[record["engine"]] = engines.get(record["engine"], 0) + 1
    stances = [key for key, found in seen.items() if ("exact", 0) in found]
    cones = sorted({cone for key in stances for cone in seen[key]} - {("exact", 0)}, key=lambda c: (c[1], PYRAMIDS.index(c[0])))
    if not stances or not cones:
        missing = "the exact cone" if not stances else "a pyramid beside the exact cone"
        raise InputError(f"records: at least one with {missing} is expected to compare, got none", name="records", field="cone")

    def judged(cone: Key) -> Judged:
        found = [seen[key].get(cone, ("", np.nan)) for key in stances]
        return Judged(np.array([verdict for verdict, _ in found]), np.array([area for _, area in found]))

    values = [[stated[key][i] for key in stances] for i in range(len(by))]
    circumstances = {key: np.array(column) for key, column in _circumstances(list(by), values).items()}
    return Population(circumstances, judged(("exact", 0)), {cone: judged(cone) for cone in cones}, engines)


def _area_in(record: Mapping[str, Any]) -> float:
    region = record.get("region")
    if not region:
        return np.nan
    return np.inf if region["kind"] == "unbounded" else 0.5 * (region["inner_area"] + region["outer_area"])


def _looked_up(table: Any, parts: Sequence[str | int]) -> Any:
    """The value at a dotted key, list entries by name or index; None where there is none."""
    for part in parts:
        if isinstance(table, list) and isinstance(part, str):
            table = next((entry for entry in table if isinstance(entry, Mapping) and entry.get("name") == part), None)
        else:
            try:
                table = table[part]
            except (KeyError, IndexError, TypeError):
                return None
    return table


def _circumstances(keys: Sequence[str], values: Sequence[Sequence[Any]]) -> dict[str, list[Any]]:
    """Keys with two to a few dozen values, by their last part."""
    out: dict[str, list[Any]] = {}
    for key, column in zip(keys, values, strict=True):
        words = [value if isinstance(value, int | float | str) else canonical_json(value) for value in column]
        last = str(parse_key(key)[-1])
        if last != SEED and any(value is not None for value in column) and 2 <= len(set(words)) <= MOST_VALUES:
            out[last if last not in out else key] = words
    return out
