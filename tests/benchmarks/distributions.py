"""CPU time of all closed-form distributions of a posture, in batches of equal contacts and one by one.

Run as a program with ``OMP_NUM_THREADS=1``; nothing is asserted. The aim is 200 microseconds a posture for all methods together.
"""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

from socp_statics import PointContact, SurfaceContact, distribute_many
from socp_statics.contacts import ContactSet, Stance

AIM = 200.0
SOLE = {"friction": 0.5, "size": (0.1, 0.06)}


def contact_sets() -> dict[str, ContactSet]:
    """Two and three soles, soles and hands, four points."""
    soles = [SurfaceContact(f"sole{k}", (0.1 * k * k, 0.1 - 0.2 * k, 0.02 * k), rpy=(0.1 * k, -0.1, 0), **SOLE) for k in range(3)]
    hands = [PointContact(f"hand{k}", (0.4, 0.2 - 0.4 * k, 0.5), normal=(-1, 0, 0.3), friction=0.5) for k in range(2)]
    feet = [PointContact(f"foot{k}", (0.2 - 0.4 * (k % 2), 0.1 - 0.2 * (k // 2), 0), normal=(0, 0, 1), friction=0.6) for k in range(4)]
    sets = {"two soles": soles[:2], "three soles": soles, "two soles, two hands": [*soles[:2], *hands], "four point feet": feet}
    return {name: ContactSet(contacts) for name, contacts in sets.items()}


def placed(contacts: ContactSet, postures: int) -> tuple[np.ndarray, np.ndarray]:
    """Centres of mass and positions of a batch."""
    rng = np.random.default_rng(0)
    positions = np.array([c.position for c in contacts]) + 0.02 * rng.normal(size=(postures, len(contacts), 3))
    coms = positions.mean(axis=1) + 0.1 * rng.uniform(-1, 1, (postures, 3)) + [0, 0, 0.5]
    return coms, positions


def microseconds(work: Callable[[], object], count: int, repetitions: int) -> float:
    """Median CPU time of one of ``count`` pieces of work."""
    times = []
    for _ in range(repetitions):
        start = time.process_time()
        work()
        times.append(time.process_time() - start)
    return float(np.median(times)) / count * 1e6


def rows(postures: int = 2000, repetitions: int = 5) -> list[tuple[str, int, float, float, float]]:
    """Contacts, number of methods, microseconds a posture in a batch and alone, worst balance over W."""
    out = []
    for name, contacts in contact_sets().items():
        coms, positions = placed(contacts, postures)
        found = distribute_many(contacts, coms, 10.0, positions=positions)
        batch = microseconds(lambda c=contacts, x=coms, r=positions: distribute_many(c, x, 10.0, positions=r), postures, repetitions)
        few = [Stance(contacts, com, 10.0) for com in coms[: max(postures // 40, 1)]]
        alone = microseconds(lambda some=few: [distribute_many([stance]) for stance in some], len(few), repetitions)
        out.append((name, len(found.components), batch, alone, max(float(b.max()) for b in found.balance.values())))
    return out


if __name__ == "__main__":
    print(f"All closed-form distributions, microseconds of CPU a posture, aim {AIM:g} in a batch")
    print(f"{'contacts':<22}{'methods':>8}{'in a batch':>13}{'alone':>13}{'balance / W':>14}")
    for name, methods, batch, alone, balance in rows():
        print(f"{name:<22}{methods:>8}{batch:>13.1f}{alone:>13.1f}{balance:>14.1e}")
