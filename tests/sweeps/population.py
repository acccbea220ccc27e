"""The seeded stances of the sweep: families of contacts, each at a random size, place and weight, and planted degenerate ones.

A family makes contacts about a metre in size and a centre of mass for a robot of one kilogram under 9.81 m/s^2; forces scale with the
weight, lengths with the size. `stance_of` makes one stance alone from the name of its family and its seed.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from random_stances import FAMILIES as ROOM
from random_stances import _frame as frame
from random_stances import _tilted as tilted
from random_stances import moved, random_stance, restated
from sweeps.planted import PLANTED

from socp_statics.contacts import (
    ContactSet,
    ExternalWrench,
    FrictionlessPointContact,
    FrictionlessSurfaceContact,
    Handle,
    LineContact,
    PointContact,
    SoftFingerContact,
    Stance,
    SurfaceContact,
)

WEIGHT = 9.81
# Shares of the weight; none is a whole share, which a single contact would have to carry exactly.
BOUNDS = (0.0, 0.09, 0.31, 0.87, 2.9, np.inf)


class Case(NamedTuple):
    """One stance of the population by name."""

    family: str
    seed: int

    def __str__(self) -> str:
        return f"{self.family}:{self.seed}"


def mu_of(rng, least: float = 0.0) -> float:
    """A coefficient of friction from 0 to 2; 0 itself, where it is allowed, one time in twelve."""
    if least == 0.0 and rng.random() < 1 / 12:
        return 0.0
    way = rng.integers(0, 3)
    if way == 0:
        return float(rng.uniform(least, 2.0))
    if way == 1:
        return float(max(least, 2.0 * 10.0 ** rng.uniform(-3, 0)))
    return float(rng.choice([m for m in (0.1, 0.3, 0.5, 0.8, 1.0, 2.0) if m >= least]))


def few(rng, most: int = 16) -> int:
    """A number of contacts, small ones more often."""
    return int(rng.integers(1, 1 + rng.choice([3, 4, 6, most])))


def sole(rng, name, position, normal, mu, length=None, **more):
    """A rectangle or another convex polygon."""
    a, b = (rng.uniform(0.02, 0.3, 2)) if length is None else length
    R = frame(normal, rng)
    if rng.random() < 0.6:
        return SurfaceContact(name, position, R, friction=mu, size=(a, b), **more)
    k = int(rng.integers(3, 8))
    angles = 2 * np.pi * (np.arange(k) + rng.uniform(-0.35, 0.35, k)) / k
    corners = 0.5 * np.column_stack([a * np.cos(angles), b * np.sin(angles)])
    return SurfaceContact(name, position, R, friction=mu, vertices=corners, **more)


def above(rng, contacts, spread: float, height=None) -> np.ndarray:
    """A CoM over a contact point or a random mixture of them, moved away from their mean by up to a factor."""
    P = np.vstack([c.points_W for c in contacts])
    mean = P.mean(axis=0)
    at = P[rng.integers(len(P))] if rng.random() < 0.6 else rng.dirichlet(np.full(len(P), 0.7)) @ P
    # Exactly over one point or two would be planted.
    aside = 0.1 * rng.normal(size=3) if len(P) <= 2 else 0.0
    com = mean + rng.uniform(0, spread) * (at - mean) + aside
    return np.append(com[:2], mean[2] + (rng.uniform(-0.3, 1.5) if height is None else height))


def points(rng):
    angle = rng.choice([0.0, 0.1, 0.4, 0.8, 1.5])
    one = mu_of(rng)
    contacts = [
        PointContact(f"p{k}", rng.uniform(-0.5, 0.5, 3) * [1, 1, rng.choice([0, 0.2, 1])], frame(tilted(rng, angle), rng),
                     friction=one if angle < 0.2 else mu_of(rng, 0.3))
        for k in range(max(few(rng), int(rng.choice([1, 3, 4]))))
    ]  # fmt: skip
    return contacts, above(rng, contacts, 2.2), {}


def soles(rng):
    angle = rng.choice([0.0, 0.0, 0.2, 0.5, 1.2])
    contacts = [
        sole(rng, f"s{k}", rng.uniform(-0.5, 0.5, 3) * [1, 1, rng.choice([0, 0.3])], tilted(rng, angle),
             mu_of(rng, 0.0 if angle < 0.3 else 0.2))
        for k in range(few(rng))
    ]  # fmt: skip
    return contacts, above(rng, contacts, 2.5), {}


def climbing(rng):
    """Feet on a floor or ledges and hands or soles on walls around."""
    contacts = [
        sole(rng, f"foot{k}", [*rng.uniform(-0.3, 0.3, 2), rng.uniform(0, 0.3)], tilted(rng, 0.5), mu_of(rng, 0.1))
        for k in range(int(rng.integers(1, 4)))
    ]
    for k in range(int(rng.integers(1, 6))):
        a = rng.uniform(0, 2 * np.pi)
        n = [-np.cos(a), -np.sin(a), rng.uniform(-0.6, 0.6)]
        p = [np.cos(a), np.sin(a), rng.uniform(0.3, 1.8)]
        if rng.random() < 0.7:
            contacts.append(PointContact(f"hand{k}", p, frame(n, rng), friction=mu_of(rng)))
        else:
            contacts.append(sole(rng, f"palm{k}", p, n, mu_of(rng)))
    return contacts, above(rng, contacts, 3.0, rng.uniform(0.2, 1.2)), {}


def grasp(rng):
    """Contacts all round an object, pushing inwards."""
    way = rng.normal(size=(int(rng.integers(2, 9)), 3))
    way /= np.linalg.norm(way, axis=1)[:, None]
    slant = rng.choice([0.0, 0.2, 0.6])
    contacts = []
    for k, d in enumerate(way):
        n, p = -d + slant * rng.uniform(-1, 1, 3), 0.5 * d
        contacts.append(
            PointContact(f"tip{k}", p, frame(n, rng), friction=mu_of(rng))
            if rng.random() < 0.8
            else sole(rng, f"pad{k}", p, n, mu_of(rng), (0.1, 0.1))
        )
    return contacts, rng.normal(size=3) * rng.choice([0.05, 0.3]), {}


def chimney(rng):
    """Two facing walls, nearly parallel or turned up or down about the friction angle."""
    mu = mu_of(rng, 0.05)
    edge = rng.choice([0.0, 1.0])
    tilt = edge * np.arctan(mu) + rng.choice([-1, 1]) * 10.0 ** rng.uniform(-6, -0.5)
    up = rng.choice([-1.0, 1.0])
    flat = rng.random() < 0.5
    contacts = []
    for side, y in (("left", 0.4), ("right", -0.4)):
        R = frame([0.0, -np.sign(y) * np.cos(tilt), up * np.sin(tilt)], rng)
        if flat:
            contacts.append(SurfaceContact(side, [0, y, rng.uniform(-0.2, 0.2)], R, friction=mu, size=rng.uniform(0.05, 0.4, 2)))
        else:
            contacts += [
                PointContact(f"{side}{k}", [rng.uniform(-0.2, 0.2), y, rng.uniform(-0.3, 0.3)], R, friction=mu)
                for k in range(int(rng.integers(1, 4)))
            ]
    return contacts, rng.uniform(-0.3, 0.3, 3), {}


def collinear(rng):
    """Points nearly on a line, the centre of mass within their thin hull or beside it."""
    off = 10.0 ** rng.uniform(-5, -1.5)
    count = int(rng.integers(3, 8))
    P = np.column_stack([np.linspace(-0.5, 0.5, count), off * rng.uniform(-1, 1, count), rng.choice([0, 0.1]) * rng.uniform(-1, 1, count)])
    turn = tilted(rng, 0.3) if rng.random() < 0.5 else None
    contacts = [
        PointContact(f"p{k}", p, frame(tilted(rng, 0.2) if turn is None else turn, rng), friction=mu_of(rng, 0.35))
        for k, p in enumerate(P)
    ]
    return contacts, above(rng, contacts, 2.5, 0.5), {}


def parallel(rng):
    """Nearly parallel normals and little friction, or none."""
    mu = float(rng.choice([0.0, 1e-3, 0.01, 0.3]))
    # Without friction, less would leave the load out of reach by too little to tell.
    angle = 10.0 ** rng.uniform(-6 if mu else -3, -2)
    contacts = []
    for k in range(few(rng, 8)):
        a, b = angle * rng.uniform(0.3, 1.0), rng.uniform(0, 2 * np.pi)
        p, n = rng.uniform(-0.5, 0.5, 3) * [1, 1, 0.1], [np.sin(a) * np.cos(b), np.sin(a) * np.sin(b), np.cos(a)]
        contacts.append(PointContact(f"p{k}", p, frame(n, rng), friction=mu) if rng.random() < 0.5 else sole(rng, f"s{k}", p, n, mu))
    return contacts, above(rng, contacts, 1.8), {}


def steep(rng):
    """Slopes and nearly vertical walls within a hair of the friction angle, all facing one way."""
    mu = mu_of(rng, 0.02)
    slope = np.arctan(mu) + rng.choice([-1, 1, -1]) * 10.0 ** rng.uniform(-6, -0.7)
    contacts = []
    for k in range(int(rng.integers(1, 5))):
        p, n = rng.uniform(-0.5, 0.5, 3), [np.sin(slope), 0.02 * rng.normal() * rng.choice([0, 1]), np.cos(slope)]
        p[2] = -np.tan(slope) * p[0] if rng.random() < 0.5 else p[2]
        contacts.append(
            PointContact(f"p{k}", p, frame(n, rng), friction=mu) if rng.random() < 0.4 else sole(rng, f"s{k}", p, n, mu)
        )
    return contacts, above(rng, contacts, 1.2, 0.3), {}


def duplicates(rng):
    """Points that repeat each other, and soles that share corners or lie on each other."""
    contacts, com, more = (points if rng.random() < 0.5 else soles)(rng)
    for k, c in enumerate(contacts[: int(rng.integers(1, 5))]):
        changes = {"name": f"again{k}"}
        if rng.random() < 0.5:
            # Side by side, or hardly apart.
            by = c.rectangle[0] if c.type == "surface" and c.rectangle else 10.0 ** rng.uniform(-6, -2)
            changes["position"] = (c.position + by * c.rotation[:, 0]).tolist()
        if rng.random() < 0.3 and c.friction > 0:
            changes["friction"] = mu_of(rng, 0.05)
        contacts.append(restated(c, **changes))
    return contacts[:16], com, more


def thin(rng):
    """Soles far longer than wide."""
    contacts = [
        sole(rng, f"s{k}", rng.uniform(-0.5, 0.5, 3) * [1, 1, 0.1], tilted(rng, 0.2), mu_of(rng, 0.25),
             (rng.uniform(0.1, 1.0), 10.0 ** rng.uniform(-5, -2)))
        for k in range(int(rng.integers(1, 4)))
    ]  # fmt: skip
    return contacts, above(rng, contacts, 2.2), {}


def lone(rng):
    """A single contact, mostly a sole."""
    n = tilted(rng, rng.choice([0.0, 0.3, 1.0]))
    if rng.random() < 0.15:
        contacts = [PointContact("p", [0, 0, 0], frame(n, rng), friction=mu_of(rng))]
    else:
        contacts = [sole(rng, "s", [0, 0, 0], n, mu_of(rng))]
    return contacts, above(rng, contacts, 2.0), {}


def hanging(rng):
    """Contacts from above, braced against a floor or not."""
    contacts = []
    for k in range(int(rng.integers(1, 4))):
        R = frame([*rng.uniform(-1, 1, 2), -rng.uniform(0.2, 1)], rng)
        contacts.append(PointContact(f"top{k}", [*rng.uniform(-0.4, 0.4, 2), 1.5], R, friction=mu_of(rng)))
    for k in range(int(rng.integers(0, 4))):
        contacts.append(sole(rng, f"foot{k}", [*rng.uniform(-0.4, 0.4, 2), 0], tilted(rng, 0.4), mu_of(rng, 0.1)))
    return contacts, above(rng, contacts, 2.0, 0.5), {}


def edges(rng):
    """Level contacts with the centre of mass a little inside or outside an edge of their hull."""
    mu = mu_of(rng, 0.05)
    angle = rng.uniform(0, 2 * np.pi)
    count = int(rng.integers(3, 9))
    ring = 2 * np.pi * (np.arange(count) + rng.uniform(-0.3, 0.3, count)) / count + angle
    P = 0.5 * np.column_stack([np.cos(ring), np.sin(ring), np.zeros(count)])
    contacts = [PointContact(f"p{k}", p, normal=(0, 0, 1), friction=mu) for k, p in enumerate(P)]
    k = int(rng.integers(count))
    a, b = P[k], P[(k + 1) % count]
    out = np.array([(b - a)[1], -(b - a)[0], 0.0]) / np.linalg.norm(b - a)
    com = a + rng.uniform(0.1, 0.9) * (b - a) + rng.choice([-1, 1]) * 10.0 ** rng.uniform(-5.5, -1) * out + [0, 0, rng.uniform(0, 1)]
    return contacts, com, {}


def pushed(rng):
    contacts, com, more = [points, soles, climbing][int(rng.integers(3))](rng)
    force = ExternalWrench(force=rng.normal(size=3) * WEIGHT * 10.0 ** rng.uniform(-2, 0.5), point=com + rng.uniform(-0.5, 0.5, 3))
    twist = ExternalWrench(moment=rng.normal(size=3) * WEIGHT * 10.0 ** rng.uniform(-2, 0))
    return contacts, com, more | {"external_wrenches": (force, twist)[int(rng.integers(2)) :][: int(rng.integers(1, 3))]}


def leaning(rng):
    contacts, com, more = [points, soles, climbing, chimney][int(rng.integers(4))](rng)
    return contacts, com, more | {"gravity": -WEIGHT * tilted(rng, rng.choice([0.1, 0.5, 1.2]))}


def mixed(rng):
    """Every kind of contact, with bounds and limits."""
    contacts = []
    for k in range(int(rng.integers(1, 8))):
        p, n, mu = rng.uniform(-0.5, 0.5, 3), tilted(rng, rng.choice([0.0, 0.3, 1.5])), mu_of(rng)
        bound = None if rng.random() < 0.7 else np.sort(WEIGHT * rng.choice(BOUNDS, 2, replace=rng.random() < 0.1)).tolist()
        if bound is not None:
            # Twice the same bound may be twice no bound.
            bound[0] = min(bound[0], WEIGHT * max(filter(np.isfinite, BOUNDS)))
        R, name = frame(n, rng), f"c{k}"
        kind = int(rng.integers(0, 9))
        if kind == 0:
            contacts.append(FrictionlessPointContact(name, p, R, normal_force=bound))
        elif kind == 1:
            contacts.append(FrictionlessSurfaceContact(name, p, R, size=rng.uniform(0.05, 0.3, 2), normal_force=bound))
        elif kind == 2:
            contacts.append(LineContact(name, p, R, friction=mu, size=[rng.uniform(0.05, 0.5)], normal_force=bound))
        elif kind in (3, 4):
            shape = "elliptic" if kind == 3 else "box"
            gamma = 10.0 ** rng.uniform(-3, -0.5)
            contacts.append(SoftFingerContact(name, p, R, friction=mu, torsional_friction=gamma, shape=shape, normal_force=bound))
        elif kind == 5:
            contacts.append(_handle(rng, name, p, R))
        elif kind == 6:
            contacts.append(PointContact(name, p, R, friction=mu, normal_force=bound))
        else:
            contacts.append(sole(rng, name, p * [1, 1, 0], [0, 0, 1], mu, normal_force=bound))
    return contacts, above(rng, contacts, 1.8), {}


def _handle(rng, name, p, R):
    words = [w for w in ("fx", "fy", "fz", "mx", "my", "mz") if rng.random() < 0.5] or ["fz"]
    limits = {}
    for word in words:
        if rng.random() < 0.7:
            most = WEIGHT * 10.0 ** rng.uniform(-2, 1)
            limits[word] = [(-most, most), (0.0, most), (-np.inf, most)][int(rng.integers(3))]
    return Handle(name, p, R, transmits=words, limits=limits)


# How many of a hundred stances are of each family.
SHARES = {
    points: 11, soles: 14, climbing: 9, grasp: 8, chimney: 6, collinear: 5, parallel: 5, steep: 6, duplicates: 4, thin: 3, lone: 3,
    hanging: 3, edges: 5, pushed: 4, leaning: 3,
}  # fmt: skip
FAMILIES = {f.__name__: f for f in SHARES} | {"mixed": mixed}
WEIGHTS = {f.__name__: share for f, share in SHARES.items()} | {"mixed": 6, "room": 2, "planted": 3}


def population(count: int, seed: int) -> list[Case]:
    """The stances of a sweep: the same families in the same shares, whatever the seed."""
    names, weights = list(WEIGHTS), np.array(list(WEIGHTS.values()), dtype=float)
    due, cases = np.zeros(len(names)), []
    for k in range(count):
        due += weights / weights.sum()
        i = int(np.argmax(due))
        due[i] -= 1.0
        cases.append(Case(names[i], seed * 1_000_000 + k))
    return cases


def stance_of(case: Case) -> Stance:
    """One stance of the population."""
    rng = np.random.default_rng([case.seed, *case.family.encode()])
    if case.family == "planted":
        stance = PLANTED[int(rng.integers(len(PLANTED)))](rng)
        # Half of them where and as large as they were made, to the last bit.
        return stance if rng.random() < 0.5 else _placed(rng, stance, case)
    if case.family == "room":
        stance = random_stance(case.seed, list(ROOM)[int(rng.integers(len(ROOM)))])
    else:
        contacts, com, more = FAMILIES[case.family](rng)
        stance = Stance(ContactSet(contacts), com, 1.0, **({"gravity": (0, 0, -WEIGHT)} | more))
    return _placed(rng, stance, case)


def _placed(rng, stance: Stance, case: Case) -> Stance:
    """The stance at a random size, heading, place and weight; forces scale with the weight."""
    if case.family != "planted" and rng.random() < 0.02:
        turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        turn *= np.linalg.det(turn)
    else:
        a = rng.uniform(0, 2 * np.pi)
        turn = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
    lone_point = len(stance.contacts.points_W) == 1
    scale = 1.0 if lone_point else 10.0 ** rng.uniform(-2, 2) / stance.contacts.size
    way = rng.normal(size=3)
    place = way / np.linalg.norm(way) * rng.choice([0.0, 10.0 ** rng.uniform(-1, 3)], p=[0.3, 0.7])
    shift = place - scale * turn @ stance.contacts.centre
    mass = 10.0 ** rng.uniform(-3, 6)
    there = moved(stance, scale=scale, shift=shift, turn=turn)
    factor = mass / stance.mass
    contacts = []
    for c in there.contacts:
        changes = {}
        if c.normal_force is not None:
            changes["normal_force"] = [factor * v for v in c.normal_force]
        if c.type == "handle":
            changes["limits"] = {word: (factor * lo, factor * hi) for word, (lo, hi) in c.limits.items()}
        contacts.append(restated(c, **changes) if changes else c)
    wrenches = tuple(ExternalWrench(force=factor * w.force, moment=factor * w.moment, point=w.point) for w in there.external_wrenches)
    return Stance(ContactSet(contacts), there.com, mass, there.gravity, wrenches)
