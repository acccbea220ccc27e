"""Seeded random stances of many families, with the centre of mass in and out of balance; made to give trouble."""

from __future__ import annotations

import numpy as np

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
from socp_statics.contacts.contact import contact_from_statement

FRICTIONS = (0.01, 0.1, 0.3, 0.5, 0.8, 1.2, 2.0)


def _tilted(rng, most: float) -> np.ndarray:
    """A unit vector at most an angle away from vertical."""
    a, b = rng.uniform(0, most), rng.uniform(0, 2 * np.pi)
    return np.array([np.sin(a) * np.cos(b), np.sin(a) * np.sin(b), np.cos(a)])


def _frame(n, rng) -> np.ndarray:
    """A right-handed contact frame of a normal with a random heading."""
    n = np.asarray(n, dtype=float) / np.linalg.norm(n)
    t = np.cross(n, np.eye(3)[int(np.argmin(np.abs(n)))])
    t /= np.linalg.norm(t)
    a = rng.uniform(0, 2 * np.pi)
    t1 = np.cos(a) * t + np.sin(a) * np.cross(n, t)
    return np.column_stack([t1, np.cross(n, t1), n])


def _mu(rng, least=0.01) -> float:
    return float(rng.choice([m for m in FRICTIONS if m >= least]))


def _foot(name, p, n, rng, mu, size=(0.2, 0.1), **more):
    return SurfaceContact(name, p, _frame(n, rng), friction=mu, size=size, **more)


def _com(rng, contacts, height: float, spread: float) -> np.ndarray:
    """A position in a random direction from the mean contact point, up to `spread` times as far as the points reach there."""
    P = np.vstack([c.points_W for c in contacts])
    mean = P.mean(axis=0)
    angle = rng.uniform(0, 2 * np.pi)
    d = np.array([np.cos(angle), np.sin(angle)])
    far = ((P - mean)[:, :2] @ d).max()
    return np.append(mean[:2] + rng.uniform(0, spread) * far * d, mean[2] + height)


def flat(rng):
    count = int(rng.integers(1, 4))
    contacts = [_foot(f"foot{k}", [*rng.uniform(-0.4, 0.4, 2), 0.0], [0, 0, 1], rng, _mu(rng)) for k in range(count)]
    return contacts, {"spread": 1.9}


def sloped(rng):
    contacts = [
        _foot(f"foot{k}", [*rng.uniform(-0.4, 0.4, 2), rng.uniform(0, 0.2)], _tilted(rng, 0.6), rng, _mu(rng, 0.3)) for k in range(2)
    ]
    return contacts, {"spread": 1.6}


def feet_and_hands(rng):
    contacts = [
        _foot(f"foot{k}", [rng.uniform(-0.1, 0.1), y, 0.0], _tilted(rng, 0.2), rng, _mu(rng, 0.3)) for k, y in enumerate((0.15, -0.15))
    ]
    for k in range(int(rng.integers(1, 3))):
        n = [-1.0, *rng.uniform(-0.5, 0.5, 2)]
        contacts.append(
            PointContact(f"hand{k}", [0.5, rng.uniform(-0.5, 0.5), rng.uniform(0.6, 1.2)], _frame(n, rng), friction=_mu(rng, 0.1))
        )
    return contacts, {"spread": 2.2}


def ladder(rng):
    contacts = [
        PointContact(f"rung{k}", [rng.uniform(-0.1, 0.1), y, 0.0], _frame(_tilted(rng, 0.5), rng), friction=_mu(rng, 0.3))
        for k, y in enumerate((0.2, -0.2))
    ]
    for k, y in enumerate((0.25, -0.25)):
        contacts.append(PointContact(f"top{k}", [0.6, y, 2.0], _frame([-1.0, 0.0, rng.uniform(-0.2, 0.4)], rng), friction=_mu(rng, 0.1)))
    return contacts, {"spread": 2.0}


def points(rng):
    count = int(rng.integers(3, 6))
    contacts = [
        PointContact(f"p{k}", rng.uniform(-0.5, 0.5, 3), _frame(_tilted(rng, rng.choice([0.4, 1.2])), rng), friction=_mu(rng, 0.1))
        for k in range(count)
    ]
    return contacts, {"spread": 1.3}


def chimney(rng):
    tilt = rng.choice([0.0, 1e-6, 1e-3, 0.1, 0.5, 0.5, 0.8])
    mu = float(rng.choice([0.05, 0.1, 0.3, 0.8]))
    left = _frame([rng.uniform(-tilt, tilt), -1.0, rng.uniform(-tilt, tilt)], rng)
    right = _frame([rng.uniform(-tilt, tilt), 1.0, rng.uniform(-tilt, tilt)], rng)
    if rng.random() < 0.5:
        contacts = [
            SurfaceContact("left", [0, 0.4, 0.3], left, friction=mu, size=[0.2, 0.1]),
            SurfaceContact("right", [0, -0.4, 0], right, friction=mu, size=[0.2, 0.1]),
        ]
    else:
        contacts = [PointContact(f"left{k}", [x, 0.4, 0.2], left, friction=mu) for k, x in enumerate((-0.1, 0.1))]
        contacts += [PointContact(f"right{k}", [x, -0.4, rng.uniform(-0.3, 0.3)], right, friction=mu) for k, x in enumerate((-0.15, 0.1))]
    return contacts, {"height": rng.uniform(-0.3, 0.5), "spread": 1.0}


def near_vertical(rng):
    tilt = rng.choice([1e-8, 1e-6, 1e-4, 1e-2])
    contacts = [
        _foot(f"foot{k}", [*rng.uniform(-0.4, 0.4, 2), rng.uniform(0, 1e-3)], _tilted(rng, tilt), rng, rng.choice([0.01, 0.02, 0.3]))
        for k in range(2)
    ]
    return contacts, {"spread": 1.9}


def mix(rng):
    up = [0, 0, 1]
    contacts = [
        _foot(
            "foot",
            [0.0, 0.2, 0.0],
            _tilted(rng, 0.2),
            rng,
            _mu(rng, 0.3),
            normal_force=rng.choice([None, 1]) and [0, float(rng.uniform(100, 700))],
        )
    ]
    contacts.append(LineContact("edge", [0.1, -0.2, 0.0], _frame(_tilted(rng, 0.2), rng), friction=_mu(rng, 0.1), size=[0.15]))
    kind = int(rng.integers(0, 4))
    if kind == 0:
        contacts.append(
            SoftFingerContact(
                "finger", [0.4, 0, 0.9], _frame([-1, 0, 0.2], rng), friction=_mu(rng, 0.3), torsional_friction=0.03, shape="elliptic"
            )
        )
        contacts.append(SoftFingerContact("thumb", [-0.3, 0, 0.1], _frame(up, rng), friction=0.4, torsional_friction=0.02, shape="box"))
    elif kind == 1:
        limits = {"fx": (-80.0, 80.0), "fz": (0.0, 60.0)}
        contacts.append(
            Handle(
                "rail",
                [0.4, 0, 0.9],
                _frame(_tilted(rng, 1.5), rng),
                transmits=["fx", "fy", "fz", "mx"],
                limits=limits | {"fy": (-50.0, 50.0), "mx": (-3.0, 3.0)},
            )
        )
    elif kind == 2:
        contacts.append(FrictionlessPointContact("prop", [-0.3, 0, 0.2], _frame([0.4, 0, 1], rng)))
        contacts.append(FrictionlessSurfaceContact("plate", [0.3, 0.1, 0.3], _frame([-1, 0.1, 0.2], rng), size=[0.1, 0.1]))
    else:
        contacts.append(
            SoftFingerContact(
                "finger",
                [0.4, 0, 0.5],
                _frame(_tilted(rng, 0.8), rng),
                friction=_mu(rng, 0.3),
                torsional_friction=0.01,
                normal_force=[5.0, 200.0],
            )
        )
    return contacts, {"spread": 1.6}


def loads(rng):
    contacts, more = [flat, sloped][int(rng.integers(0, 2))](rng)
    push = ExternalWrench(force=rng.normal(size=3) * rng.choice([30, 200]), point=rng.uniform(-0.3, 0.3, 3) + [0, 0, 0.8])
    twist = ExternalWrench(moment=rng.normal(size=3) * 10)
    return contacts, more | {"external_wrenches": (push, twist)[: int(rng.integers(1, 3))], "spread": 0.5}


def tilted_gravity(rng):
    contacts, more = [flat, sloped, feet_and_hands][int(rng.integers(0, 3))](rng)
    return contacts, more | {"gravity": -9.81 * _tilted(rng, 0.4), "spread": 0.6, "height": 0.3}


def slivers(rng):
    """Contact points nearly on a line, so that the region is nearly a segment."""
    off = 10.0 ** rng.uniform(-8, -3)
    P = np.array([[-0.3, 0, 0], [0.3, 0, 0.1], [0.05, off, 0.02], [-0.1, -off, 0.0]])
    contacts = [
        PointContact(f"p{k}", p, _frame(_tilted(rng, 0.3), rng), friction=_mu(rng, 0.5)) for k, p in enumerate(P[: int(rng.integers(3, 5))])
    ]
    P = np.vstack([c.points_W for c in contacts])
    com = P.mean(axis=0) + rng.uniform(0, 3.0) * (rng.dirichlet(np.ones(len(P))) @ P - P.mean(axis=0)) + [0, 0, 0.5]
    return contacts, {"com": com}


SCALED = {"tiny": 0.02, "huge": 250.0, "far": 1.0, "light": 1.0, "heavy": 1.0}
FAMILIES = {
    f.__name__: f for f in (flat, sloped, feet_and_hands, ladder, points, chimney, near_vertical, mix, loads, tilted_gravity, slivers)
}


def random_stance(seed: int, family: str) -> Stance:
    """A stance of a family: one of FAMILIES, or of SCALED for an ordinary one of odd size, place or weight.

    Args:
        seed: Same seed, same stance.
        family: Its name.
    """
    rng = np.random.default_rng([seed, *family.encode()])
    base = FAMILIES.get(family) or [flat, sloped, feet_and_hands][int(rng.integers(0, 3))]
    contacts, more = base(rng)
    height, spread = more.pop("height", 0.8), more.pop("spread", 1.0)
    com = more.pop("com") if "com" in more else _com(rng, contacts, height, spread)
    mass = {"light": 1e-3, "heavy": 1e6}.get(family, 60.0)
    stance = Stance(ContactSet(contacts), com, mass, **more)
    if family in SCALED:
        away = np.array([1000.0, -800.0, 300.0]) if family == "far" else np.zeros(3)
        return moved(stance, scale=SCALED[family], shift=away)
    return stance


def restated(contact, **changes):
    """A contact with some of its statement changed."""
    return contact_from_statement(contact.statement() | changes)


def moved(stance: Stance, *, scale: float = 1.0, shift=(0.0, 0.0, 0.0), turn=None, mass: float | None = None) -> Stance:
    """The same stance elsewhere: lengths scaled, then turned by R, then shifted; moments scale with lengths."""
    R = np.eye(3) if turn is None else np.asarray(turn)
    shift = np.asarray(shift, dtype=float)
    contacts = []
    for c in stance.contacts:
        changes = {"position": (R @ c.position * scale + shift).tolist(), "rotation": (R @ c.rotation).tolist()}
        if c.type in ("surface", "frictionless_surface"):
            changes |= {"size": None, "vertices": (scale * c.vertices).tolist()}
        if c.type == "line":
            changes["size"] = [scale * c.length]
        if c.type == "soft_finger":
            changes["torsional_friction"] = scale * c.torsional_friction
        if c.type == "handle":
            changes["limits"] = {k: (v if k[0] == "f" else (scale * v[0], scale * v[1])) for k, v in c.limits.items()}
        contacts.append(restated(c, **changes))
    wrenches = tuple(
        ExternalWrench(force=R @ w.force, moment=scale * R @ w.moment, point=None if w.point is None else R @ w.point * scale + shift)
        for w in stance.external_wrenches
    )
    gravity = R @ stance.gravity
    return Stance(ContactSet(contacts), R @ stance.com * scale + shift, stance.mass if mass is None else mass, gravity, wrenches)
