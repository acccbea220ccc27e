"""A long check of the measures of robustness against sampled truth, on random stances of points, lines and surfaces.

Run ``python tests/sweeps/robustness.py --stances 200``: of every stable stance, disturbances inside each radius have to hold by an
independent conic program, and the tightest one just beyond the upper end must not. Exit status 1 if one contradicts. Of the other
stances of the suite, with handles, soft fingers and bounds, only that every question is settled.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from pathlib import Path

import numpy as np

sys.path[:0] = [str(Path(__file__).parents[1]), str(Path(__file__).parents[2])]

from random_stances import FAMILIES, SCALED, random_stance  # noqa: E402
from robustness_oracle import LENGTH, PLAIN, disturbed  # noqa: E402

from socp_statics.exceptions import EngineError  # noqa: E402
from socp_statics.stability.robustness import MEASURES, measure_robustness  # noqa: E402

SIZES = {"push": 2, "force": 3, "wrench": 6, "com": 3, "mass_and_com": 4, "tilt": 3}
ENGINE = ("clarabel", "cvxpy")


def contradictions(stance, found, rng, samples):
    """Sentences of what does not agree."""
    out = []
    for name, k in SIZES.items():
        m = found[name]
        if m.value is None or not np.isfinite(m.value) or m.value == 180.0:
            continue
        for _ in range(samples):
            u = rng.normal(size=k)
            u = np.append(u, 0.0) if name == "push" else u
            slack = disturbed(stance, name, u / np.linalg.norm(u), (1.0 - 1e-6) * m.value)
            if slack < -1e-6:
                out.append(f"{name} {m.value:.6g}: inside, slack {slack:.1e}")
        slack = disturbed(stance, name, np.asarray(m.direction), 1.003 * m.bracket[1] + 1e-4)
        if slack > 1e-6:
            out.append(f"{name} {m.bracket[1]:.6g}: beyond the upper end, slack {slack:.1e}")
    return out


def main() -> int:
    """Sweep, print, and say whether all agrees."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--stances", type=int, default=100)
    parser.add_argument("--samples", type=int, default=4)
    given = parser.parse_args()
    kinds, wrong, times = Counter(), 0, []
    families = [*FAMILIES, *SCALED]
    for seed in range(given.stances):
        family = families[seed % len(families)]
        stance, rng = random_stance(seed, family), np.random.default_rng(seed)
        start = time.process_time()
        try:
            found = measure_robustness(stance, measures=MEASURES, length=LENGTH, friction_intervals={"default": [0.1, 0.9]}, engine=ENGINE)
        except EngineError as error:
            wrong += 1
            print(f"{family} {seed}: {error}")
            continue
        times.append(time.process_time() - start)
        for name, measure in found.measures.items():
            kinds[name, measure.kind or "no reserve"] += 1
        if family in PLAIN and found.equilibrium.stable:
            for sentence in contradictions(stance, found, rng, given.samples):
                wrong += 1
                print(f"{family} {seed}: {sentence}")
    for (name, kind), count in sorted(kinds.items()):
        print(f"{name:20} {kind:12} {count}")
    print(f"{given.stances} stances, {wrong} contradictions or failures, CPU time median {np.median(times):.3f} s, most {max(times):.3f} s")
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
