"""The sweep of wrench cones: seeded stances and random wrenches, consistency against verdicts, faces against linear programs.

    python tests/sweeps/wrench_cones.py [--stances 500] [--seed 0]

For every stance whose contacts have no bounds in newtons: exact cones and both pyramids; the wrench that balances its load and random
ones; the toolkit's verdict of the same question where it is decided, by a margin that is larger than 1e-6 W. Exit status 1 where
one contradicts another; how often double description was the wrong tool, and why, is reported.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections import Counter
from pathlib import Path

for library in ("OMP", "OPENBLAS", "MKL", "NUMBA"):
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")
sys.path.insert(0, str(Path(__file__).parents[1]))

import numpy as np  # noqa: E402
from random_stances import FAMILIES, SCALED, random_stance  # noqa: E402

import socp_statics as ss  # noqa: E402
from socp_statics.exceptions import InputError  # noqa: E402

BEYOND_DOUBT = 1e-6
REASONS = ("wrong tool for", "flat", "gave up", "hull", "same", "outside", "half-space", "equalities")


def questions(stance, rng):
    """The wrench that balances the stance's load about its mean contact point, and others near to it."""
    centre, size = stance.contacts.centre, stance.contacts.size
    weight = stance.mass * np.asarray(stance.gravity)
    load = np.concatenate([weight, np.cross(stance.com - centre, weight)])
    for w in stance.external_wrenches:
        load += np.concatenate([w.force, w.moment_about(centre)])
    W = np.linalg.norm(weight)
    units = W * np.array([0.5, 0.5, 0.5, 0.2 * size, 0.2 * size, 0.1 * size])
    yield -load
    for _ in range(2):
        yield -load + rng.normal(size=6) * units


def decided(stance, wrench, kind):
    """Whether the contacts can exert the wrench, None where the margin leaves it in doubt."""
    asked = ss.check_equilibrium(
        stance.contacts, stance.com, stance.mass, gravity=(0, 0, 0), cone=kind,
        external_wrenches=[{"force": -wrench[:3], "moment": -wrench[3:], "point": stance.contacts.centre}],
    )  # fmt: skip
    W = max(np.linalg.norm(wrench[:3]), np.linalg.norm(wrench[3:]) / stance.contacts.size)
    return None if asked.verdict == "undecided" or abs(asked.margin) < BEYOND_DOUBT * W else asked.stable


def checked(stance, kind, rng, count: Counter) -> list[str]:
    """Contradictions of one stance and one kind of cone."""
    cone = ss.body_wrench_cone(stance.contacts, cone=kind)
    wrong = []
    for k, wrench in enumerate(questions(stance, rng)):
        truth, answer = decided(stance, wrench, kind), cone.consistency(wrench)
        count["wrenches"] += 1
        count["inside"] += answer.consistent
        count["in doubt"] += truth is None
        count[f"by {answer.by}"] += kind != "exact"
        if kind != "exact" and answer.why:
            count[f"why: {next((word for word in REASONS if word in answer.why), answer.why)}"] += 1
        if truth is not None and truth != answer.consistent:
            wrong.append(f"wrench {k}, {kind}: verdict {truth}, consistency {answer.consistent} by {answer.by}, {answer.distance:.1e} N")
        if answer.separating is not None and cone.support(answer.separating) > 1e-8:
            wrong.append(f"wrench {k}, {kind}: the separating twist supports {cone.support(answer.separating):.1e}")
    return wrong


def main() -> int:
    """Run the sweep."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--stances", type=int, default=500)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    families, count, wrong, start = [*FAMILIES, *SCALED], Counter(), 0, time.process_time()
    for k in range(asked.stances):
        family, seed = families[k % len(families)], asked.seed + k // len(families)
        stance, rng = random_stance(seed, family), np.random.default_rng([seed, k])
        for kind in ("exact", "inscribed", "circumscribed"):
            try:
                found = checked(stance, kind, rng, count)
            except InputError:
                count["stances with bounds"] += kind == "exact"
                continue
            wrong += len(found)
            for sentence in found:
                print(f"{family}:{seed} {sentence}")
    print(f"{asked.stances} stances, {wrong} contradictions, {time.process_time() - start:.0f} s of CPU")
    for what, times in sorted(count.items()):
        print(f"  {what}: {times}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
