"""The proof sweep: verdicts of thousands of seeded stances, many next to the boundary, proved in exact arithmetic.

    python tests/sweeps/proofs.py [--stances 5000] [--near 500] [--seed 0] [--engine auto] [--workers 2]
    python tests/sweeps/proofs.py --only FAMILY:SEED | near:FAMILY:SEED

Of the stances, `--near` have a margin between 1e-7 and 1e-6 W in size. Every verdict with a margin beyond 1e-7 W of a stance whose smallest
nonzero scaled singular value is above 1e-6 has to be proved; only the planted stances, which are degenerate to the last bit so that
rounding decides, may stay open. Exit status 1 where one is not proved or a proof contradicts its verdict.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import sys
import time
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import NamedTuple

for library in ("OMP", "OPENBLAS", "MKL", "NUMBA"):
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")
sys.path.insert(0, str(Path(__file__).parents[1]))

import numpy as np  # noqa: E402
from sweeps.band import near_boundary  # noqa: E402
from sweeps.population import Case, population, stance_of  # noqa: E402

import socp_statics as ss  # noqa: E402
from socp_statics.certificates.verify_proof import verify  # noqa: E402
from socp_statics.statics import assemble  # noqa: E402
from socp_statics.statics.wrench_range import SINGULAR  # noqa: E402

BOUNDARY, CONDITIONED = 1e-7, 1e-6
CHUNK = 20
# Most stances have exact cones; pyramids of several sides in turn.
CONES = [
    {},
    {},
    {"cone": "inscribed", "sides": 4},
    {},
    {"cone": "circumscribed", "sides": 7, "heading": 0.3},
    {},
    {"cone": "inscribed", "sides": 5},
]


class Proved(NamedTuple):
    """What became of one stance; ``owed``: whether it has to be proved; ``seconds``: of the process, for the proof alone."""

    name: str
    group: str
    verdict: str
    outcome: str
    owed: bool
    points: int
    seconds: float

    @property
    def proved(self) -> bool:
        """Whether its verdict is proved."""
        return self.outcome.startswith("proved")


def prove_case(case: Case, near: bool, engine: str) -> Proved | None:
    """Ask for a verdict and prove it; None where a stance has no neighbour at the boundary, or no engine an answer."""
    stance, asked = stance_of(case), CONES[case.seed % len(CONES)] | {"engine": engine}
    name, group = (f"near:{case}", "near") if near else (str(case), "planted" if case.family == "planted" else "population")
    if near:
        found = near_boundary(stance, np.random.default_rng(case.seed), **asked)
        if found is None:
            return None
        stance, answer = found
    else:
        try:
            answer = ss.check_equilibrium(stance, **asked)
        except ss.EngineError as error:
            return Proved(name, group, "none", f"no answer: {error}", False, 0, 0.0)
    data = assemble(stance)
    singular = np.linalg.svd(data.wrench_map, compute_uv=False)
    sound = bool(singular[singular > SINGULAR].min(initial=np.inf) > CONDITIONED) and group != "planted"
    owed = sound and answer.verdict != "undecided" and abs(answer.margin) > BOUNDARY * data.units.force
    start = time.process_time()
    try:
        proof = ss.prove(answer, engine)
        seconds = time.process_time() - start
        if proof.proved:
            verify(json.loads(proof.to_json()))
    except ss.StaticsError as error:
        return Proved(name, group, answer.verdict, f"CONTRADICTION: {error}", owed, data.points, 0.0)
    outcome = "proved" if proof.verdict == answer.verdict and proof.proved else str(proof.reason)
    if proof.proved and proof.shift:
        outcome = "proved with the CoM moved"
    return Proved(name, group, answer.verdict, outcome, owed, data.points, seconds)


def _chunk(cases: list[Case], near: bool, engine: str) -> list[Proved | None]:
    return [prove_case(case, near, engine) for case in cases]


def prove_all(stances: int, near: int, seed: int, engine: str, workers: int) -> list[Proved]:
    """Prove the verdicts of a sweep: ``near`` next to the boundary, the rest as the population has them."""
    plain = population(stances - near, seed)
    sources = [case for case in population(8 * near + 200, seed + 1) if case.family != "planted"]
    with ProcessPoolExecutor(workers, mp_context=multiprocessing.get_context("spawn")) if workers > 1 else _Here() as pool:
        coming = [pool.submit(_chunk, plain[k : k + CHUNK], False, engine) for k in range(0, len(plain), CHUNK)]
        found = [one for part in coming for one in part.result() if one is not None]
        at: list[Proved] = []
        for k in range(0, len(sources), CHUNK * workers):
            parts = [sources[k + i * CHUNK : k + (i + 1) * CHUNK] for i in range(workers)]
            for part in [pool.submit(_chunk, part, True, engine) for part in parts]:
                at += [one for one in part.result() if one is not None]
            if len(at) >= near:
                break
    return found + at[:near]


class _Here:
    """A pool of this process alone."""

    def __enter__(self):
        return self

    def __exit__(self, *_):
        return None

    def submit(self, work, *arguments):
        result = work(*arguments)
        return type("Done", (), {"result": staticmethod(lambda: result)})


def violations(found: list[Proved]) -> list[str]:
    """What does not hold, each with the name of its stance."""
    bad = [p for p in found if (p.owed and not p.proved) or p.outcome.startswith("CONTRADICTION")]
    return [f"{p.name}: {p.verdict}, {p.outcome}" for p in bad]


def table(found: list[Proved]) -> list[str]:
    """Counts by group, verdict and outcome, and the times."""
    count = Counter((p.group, p.verdict, p.outcome.split(":")[0]) for p in found)
    lines = [f"{number:6d}  {group:<10}  {verdict:<9}  {outcome}" for (group, verdict, outcome), number in sorted(count.items())]
    eight = [1e3 * p.seconds for p in found if p.points == 8 and p.proved]
    if eight:
        lines.append(f"process time of a proof with 8 points: median {np.median(eight):.1f} ms, largest {max(eight):.1f} ms")
    owed = [p.proved for p in found if p.owed]
    return [*lines, f"{len(owed)} verdicts have to be proved, {sum(owed)} are"]


def main(arguments: list[str] | None = None) -> int:
    """Run the sweep and print what it found."""
    parser = argparse.ArgumentParser(description="Prove the verdicts of seeded random stances in exact arithmetic.")
    parser.add_argument("--stances", type=int, default=5000)
    parser.add_argument("--near", type=int, default=500)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--engine", default="auto")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--only", help="prove one stance alone, FAMILY:SEED or near:FAMILY:SEED")
    given = parser.parse_args(arguments)
    if given.only:
        *rest, family, seed = given.only.split(":")
        print(prove_case(Case(family, int(seed)), rest == ["near"], given.engine))
        return 0
    found = prove_all(given.stances, given.near, given.seed, given.engine, given.workers)
    bad = violations(found)
    near = sum(p.group == "near" for p in found)
    print(f"{len(found)} stances, {near} of them next to the boundary, seed {given.seed}, engine {given.engine}")
    print(*table(found), *bad, f"{len(bad)} violations", sep="\n")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
