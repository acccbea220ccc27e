"""Verdicts and strong stability against rigid-body simulation: ``python -m tests.sweeps.mujoco_check [COUNT]``, one line a stance.

Every stance with |margin| above 2 % of W is simulated as one free body. Strongly stable ones have to stay (drift below
`mujoco_stances.CREEP` in a second), unstable ones to leave (kinetic energy grows). The early acceleration of their contact points is
compared with one computed from the same inertia: which contacts slide or open is judged, by how much they differ is shown. The angle
between that acceleration and the certificate is reported, not judged: a certificate is no forecast. Stances that are weakly stable
only run with and without preload.

Where accelerations are small, the impulse with which soft contacts take up the load at the start decides the direction of sliding, which
friction then opposes: their size differs, and the difference changes with a preload of a hundredth of a millimetre.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

import mujoco_stances as m  # noqa: E402

import socp_statics as ss  # noqa: E402

NEAR = 0.02
PRELOAD = 2e-4


def angle_to_certificate(stance, found, certificate) -> float:
    """Angle between an acceleration and the certificate's motion in the metric of the inertia [deg]."""
    v = certificate.linear + np.cross(certificate.angular, stance.com - certificate.point)

    def inner(a, b):
        return float(stance.mass * a[0] @ b[0] + a[1] @ stance.inertia @ b[1])

    a, b = (found.linear, found.angular), (v, certificate.angular)
    return float(np.degrees(np.arccos(np.clip(inner(a, b) / np.sqrt(inner(a, a) * inner(b, b)), -1, 1))))


def check(name, stance) -> tuple[str, str]:
    """Outcome ("agrees", "disagrees", "reported", "too near") and the line of one stance."""
    answer = ss.check_strong_stability(stance, engine="clarabel")
    weak = answer.equilibrium
    share = weak.margin / stance.weight
    head = f"{name:20} {weak.verdict:9} {100 * share:7.1f} % {answer.strong:10}"
    if abs(share) <= NEAR:
        return "too near", f"{head} margin below {100 * NEAR:g} % of W"
    run = m.simulate(stance)
    tail = f"drift {1e3 * run.drift:9.4f} mm, energy {run.energy[0]:.1e} then {run.energy[1]:.1e} J"
    if answer.strong == "strong":
        return "agrees" if run.stays else "disagrees", f"{head} {tail}"
    if weak.verdict == "unstable":
        found = m.acceleration(stance)
        if found is None:
            return "reported" if run.leaves else "disagrees", f"{head} {tail}; no acceleration was found to compare"
        told, seen = m.words(stance, m.at_points(stance, found)), m.words(stance, run.acceleration)
        apart, moved = m.difference(stance, found, run), ", ".join(map(" ".join, zip(stance.contacts.names, told, strict=True)))
        moved += "" if told == seen else f" (simulated: {', '.join(seen)})"
        angle = angle_to_certificate(stance, found, weak.certificate)
        words = f"{tail}; {moved}; acceleration differs by {100 * apart:.1f} %; {angle:.0f} deg to the certificate"
        return "disagrees" if not run.leaves else "agrees" if told == seen else "other motion", f"{head} {words}"
    loaded = m.simulate(stance, PRELOAD)
    words = f"{'stays' if run.stays else 'leaves'} without preload, {'stays' if loaded.stays else 'leaves'} with {1e3 * PRELOAD:g} mm of it"
    return "reported", f"{head} {tail}; {words}"


def main(count: int) -> int:
    outcomes: list[str] = []
    walls = [(f"between_walls-{k}", m.between_walls(np.random.default_rng([1, k]))) for k in range(6)]
    for name, stance in [*m.stances(count), *walls]:
        outcome, line = check(name, stance)
        outcomes.append(outcome)
        print(f"{outcome:12} {line}", flush=True)
    print(
        "; ".join(f"{word}: {outcomes.count(word)}" for word in sorted(set(outcomes))),
        f"; simulated: {len(outcomes) - outcomes.count('too near')}",
    )
    return int("disagrees" in outcomes)


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]) if len(sys.argv) > 1 else 100))
