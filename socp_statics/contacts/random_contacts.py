"""Seeded random contacts of several families, with a centre of mass in and out of balance: populations to compare over.

Every family has normals that its name suggests; ``slope`` turns them away from there. Another friction or slope is another draw, also
with the same seed, so that the stances of a sweep are independent of each other and rates over them have the confidence they claim.
Contacts are turned about their normals at random: the heading of a pyramid, which is arbitrary, is random too.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from socp_statics.contacts.contact import Contact, PointContact, SurfaceContact
from socp_statics.contacts.numbers import scalar
from socp_statics.exceptions import InputError
from socp_statics.registry import nearest
from socp_statics.spatial import Array, cross

FRICTION, SLOPE = (0.2, 0.9), (0.0, 0.6)
SOLE = (0.22, 0.11)
REACH = 0.9
UP = np.array([0.0, 0.0, 1.0])
FEET = (("left_foot", 1.0), ("right_foot", -1.0))

Tilt = Callable[[Array], Array]
Makes = Callable[[np.random.Generator, Tilt, float], list[Contact]]


def random_contacts(family: str, seed: int, friction: float | None = None, slope: float | None = None) -> tuple[list[Contact], Array]:
    """Contacts of a family and a centre of mass.

    Args:
        family: One of `FAMILIES`.
        seed: Whole number >= 0; the same four arguments give the same contacts.
        friction: Coefficient of friction of every contact; drawn between 0.2 and 0.9 when not given.
        slope: Angle by which normals are turned away from those of the family [rad]; drawn between 0 and 0.6 when not given.

    Returns:
        The contacts, and the centre of mass in world axes, shape (3,) [m]: within 0.9 times the reach of the contact points about
        their mean, uniformly over the disc, up to 1 m above them.

    Raises:
        InputError: There is no such family, or a number is wrong.
    """
    checked_family(family)
    if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
        raise InputError(f"seed must be a whole number >= 0, got {seed!r}", field="seed")
    rng = np.random.default_rng([seed, *f"{family} {friction} {slope}".encode()])
    drawn = rng.uniform(*FRICTION), rng.uniform(*SLOPE)
    mu = drawn[0] if friction is None else scalar("random_contacts", "friction", friction, least=0.0, kind="posture")
    angle = drawn[1] if slope is None else scalar("random_contacts", "slope", slope, least=0.0, kind="posture")
    contacts = FAMILIES[family][1](rng, lambda normal: _turned(rng, normal, angle), float(mu))
    return contacts, _centre_of_mass(rng, contacts)


def checked_family(family: str) -> str:
    """The name, if there is such a family.

    Raises:
        InputError: There is none; the sentence offers near names.
    """
    if family not in FAMILIES:
        raise InputError(f"family {family!r} is not known{nearest(str(family), FAMILIES)}", name=str(family), field="family")
    return family


def _turned(rng: np.random.Generator, normal: Array, angle: float) -> Array:
    """A unit vector at an angle from a normal, towards a random side."""
    frame, towards = _frame(normal, rng.uniform(0.0, 2.0 * np.pi)), np.array([np.sin(angle), 0.0, np.cos(angle)])
    turned: Array = frame @ towards
    return turned


def _frame(normal: Array, turn: float) -> Array:
    """A right-handed contact frame, its t1 turned about the normal; columns t1, t2, n."""
    n = normal / np.linalg.norm(normal)
    t = cross(n, np.eye(3)[int(np.argmin(np.abs(n)))])
    t /= np.linalg.norm(t)
    t1 = np.cos(turn) * t + np.sin(turn) * cross(n, t)
    return np.column_stack([t1, cross(n, t1), n])


def _sole(rng: np.random.Generator, name: str, at: Array, normal: Array, mu: float) -> SurfaceContact:
    return SurfaceContact(name, at, _frame(normal, rng.uniform(0.0, 2.0 * np.pi)), friction=mu, size=SOLE)


def _point(rng: np.random.Generator, name: str, at: Array, normal: Array, mu: float) -> PointContact:
    return PointContact(name, at, _frame(normal, rng.uniform(0.0, 2.0 * np.pi)), friction=mu)


def _beside(rng: np.random.Generator, side: float) -> Array:
    """Where a foot stands: a stride of up to 0.3 m, 0.2 to 0.4 m apart."""
    return np.array([rng.uniform(-0.15, 0.15), side * rng.uniform(0.1, 0.2), 0.0])


def _centre_of_mass(rng: np.random.Generator, contacts: list[Contact]) -> Array:
    points = np.vstack([c.points_W for c in contacts])
    mean = points.mean(axis=0)
    reach = float(np.linalg.norm((points - mean)[:, :2], axis=1).max())
    radius, turn = REACH * reach * np.sqrt(rng.uniform()), rng.uniform(0.0, 2.0 * np.pi)
    return np.array([mean[0] + radius * np.cos(turn), mean[1] + radius * np.sin(turn), mean[2] + rng.uniform(0.0, 1.0)])


def _flat(rng: np.random.Generator, tilt: Tilt, mu: float) -> list[Contact]:
    normal = tilt(UP)
    down = normal[:2] / normal[2]
    places = [(name, _beside(rng, side)) for name, side in FEET]
    return [_sole(rng, name, at - [0.0, 0.0, float(down @ at[:2])], normal, mu) for name, at in places]


def _sloped_feet(rng: np.random.Generator, tilt: Tilt, mu: float) -> list[Contact]:
    return [_sole(rng, name, _beside(rng, side) + [0.0, 0.0, rng.uniform(0.0, 0.2)], tilt(UP), mu) for name, side in FEET]


def _feet_and_hands(rng: np.random.Generator, tilt: Tilt, mu: float) -> list[Contact]:
    contacts: list[Contact] = [_sole(rng, name, _beside(rng, side), tilt(UP), mu) for name, side in FEET]
    for name in ("left_hand", "right_hand")[: int(rng.integers(1, 3))]:
        at = np.array([rng.uniform(0.4, 0.6), rng.uniform(-0.4, 0.4), rng.uniform(0.7, 1.3)])
        contacts.append(_point(rng, name, at, tilt(np.array([-1.0, 0.0, 0.0])), mu))
    return contacts


def _points_on_walls(rng: np.random.Generator, tilt: Tilt, mu: float) -> list[Contact]:
    """Four limbs in a corner of two walls with a foothold each, as a climber's."""
    contacts: list[Contact] = []
    for name, wall in (("left", np.array([0.6, -0.8, 0.0])), ("right", np.array([0.6, 0.8, 0.0]))):
        along = np.array([wall[1], -wall[0], 0.0])
        for limb, low, high, lean in (("hand", 0.8, 1.4, 0.0), ("foot", -0.2, 0.2, 0.8)):
            at = -0.4 * wall + rng.uniform(-0.25, 0.25) * along + [0.0, 0.0, rng.uniform(low, high)]
            contacts.append(_point(rng, f"{name}_{limb}", at, tilt(wall + lean * UP), mu))
    return contacts


def _chimney(rng: np.random.Generator, tilt: Tilt, mu: float) -> list[Contact]:
    """Two soles against one wall, back and hand against the wall that faces it."""
    contacts: list[Contact] = []
    for name, side in FEET:
        at = np.array([0.45, side * rng.uniform(0.1, 0.2), rng.uniform(-0.2, 0.2)])
        contacts.append(_sole(rng, name, at, tilt(np.array([-1.0, 0.0, 0.4])), mu))
    for name in ("back", "hand"):
        at = np.array([-0.45, rng.uniform(-0.3, 0.3), rng.uniform(0.0, 0.8)])
        contacts.append(_point(rng, name, at, tilt(np.array([1.0, 0.0, 0.0])), mu))
    return contacts


def _general_soles(rng: np.random.Generator, tilt: Tilt, mu: float) -> list[Contact]:
    """Three soles in general position, each leaning by half a radian before the slope is added."""
    places = [np.array([*rng.uniform(-0.4, 0.4, 2), rng.uniform(0.0, 0.5)]) for _ in range(3)]
    return [_sole(rng, f"sole_{k}", at, tilt(_turned(rng, UP, 0.5)), mu) for k, at in enumerate(places)]


def _general_points(rng: np.random.Generator, tilt: Tilt, mu: float) -> list[Contact]:
    """Three to five points in general position, each leaning by 0.4 rad before the slope is added."""
    count = int(rng.integers(3, 6))
    places = [rng.uniform(-0.4, 0.4, 3) for _ in range(count)]
    return [_point(rng, f"point_{k}", at, tilt(_turned(rng, UP, 0.4)), mu) for k, at in enumerate(places)]


FAMILIES: dict[str, tuple[str, Makes]] = {
    "flat": ("two soles on one plane, inclined by the slope", _flat),
    "sloped_feet": ("two soles, each on a slope of its own", _sloped_feet),
    "feet_and_hands": ("two soles and one or two hands on a wall", _feet_and_hands),
    "points_on_walls": ("hands and feet, points, in the corner of two walls", _points_on_walls),
    "chimney": ("two soles against a wall, back and hand against the facing one", _chimney),
    "general_soles": ("three soles in general position", _general_soles),
    "general_points": ("three to five points in general position", _general_points),
}
