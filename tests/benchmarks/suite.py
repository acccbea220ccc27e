"""The stances every side of the benchmarks is asked about.

Each stance has a name, a family, and builds its contacts afresh whenever asked, so that nothing a side keeps on them is ever
counted. Regions are polygons, verdicts are decided; numbers are fixed or seeded.
"""

from __future__ import annotations

import zlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

import socp_statics as ss

Array = NDArray[np.float64]

MASS = 60.0
HEIGHT = 0.8
UP = (0.0, 0.0, 1.0)
SOLE = (0.22, 0.13)
HAND = (0.12, 0.08)
HOAP2_SOLE = ((-0.04, -0.0315), (0.058, -0.0315), (0.058, 0.0315), (-0.04, 0.0315))
FAMILIES = ("flat", "sloped", "hands", "ladder")
GROWTH_POINTS = (3, 4, 8, 16, 32, 64, 128, 256, 512)

Build = Callable[[], list]


@dataclass(frozen=True)
class BenchmarkStance:
    """One stance of the suite.

    Attributes:
        name: Its name.
        family: "flat", "sloped", "hands", "ladder", or "growth" for the table against the number of points.
        build: Makes the contacts anew.
        spread: How far CoM positions go, times the reach of the contact points in their direction.
    """

    name: str
    family: str
    build: Build
    spread: float = 1.6

    def contacts(self) -> ss.ContactSet:
        """Contacts nothing has been asked about yet."""
        return ss.ContactSet(self.build())

    def stance(self, com: Sequence[float] | None = None) -> ss.Stance:
        """The contacts with a centre of mass, by default the first of `coms`."""
        return ss.Stance(self.contacts(), self.coms()[0] if com is None else com, MASS)

    def point_contacts(self) -> tuple[Array, Array, Array]:
        """Positions (n, 3) [m], normals (n, 3) and friction (n,) of the contact points, as peers take them."""
        contacts = self.build()
        points = np.vstack([c.points_W for c in contacts])
        normals = np.vstack([np.tile(c.normal_W, (len(c.points_W), 1)) for c in contacts])
        friction = np.concatenate([np.full(len(c.points_W), c.friction) for c in contacts])
        return points, normals, friction

    def coms(self, count: int = 8) -> Array:
        """Centres of mass in and out of balance in turn, shape (count, 3) [m]: the first ones stay the same for every count."""
        points = self.point_contacts()[0]
        rng = np.random.default_rng(zlib.crc32(self.name.encode()))
        middle = points.mean(axis=0)
        angle, share = (rng.uniform(size=(count, 2)) * (2 * np.pi, 1.0)).T
        away = np.column_stack([np.cos(angle), np.sin(angle)])
        reach = ((points - middle)[:, :2] @ away.T).max(axis=0)
        share = np.where(np.arange(count) % 2, 0.4 * self.spread * (1.5 + share), 0.8 * share)
        return np.column_stack([middle[:2] + (share * reach)[:, None] * away, np.full(count, middle[2] + HEIGHT)])


def _feet(rolls=(0.0, 0.0), pitches=(0.0, 0.0), mu=0.5, at=((0.0, 0.1, 0.0), (0.0, -0.1, 0.0)), size=SOLE) -> list:
    names = ("left_foot", "right_foot")
    return [
        ss.SurfaceContact(n, p, rpy=(r, q, 0.0), friction=mu, size=size) for n, p, r, q in zip(names, at, rolls, pitches, strict=True)
    ]


def _round_soles(corners: int, mu: float, rolls=(0.0, 0.0)) -> list:
    """Two oval soles with many corners."""
    angles = 2 * np.pi * np.arange(corners) / corners
    outline = np.column_stack([0.12 * np.cos(angles), 0.06 * np.sin(angles)])
    return [
        ss.SurfaceContact(n, (0.0, y, 0.0), rpy=(r, 0.0, 0.0), friction=mu, vertices=outline)
        for n, y, r in (("left_foot", 0.1, rolls[0]), ("right_foot", -0.1, rolls[1]))
    ]


def _tripod(radius: float, tilt: float, mu: float) -> list:
    """Three points tilted towards the middle."""
    s, c = np.sin(tilt), np.cos(tilt)
    angles = 2 * np.pi * np.arange(3) / 3
    return [
        ss.PointContact(f"p{k}", (radius * np.cos(a), radius * np.sin(a), 0.0), normal=(-s * np.cos(a), -s * np.sin(a), c), friction=mu)
        for k, a in enumerate(angles)
    ]


def _rough(count: int, seed: int, tilt: float, mu: float) -> list:
    """Points on rough ground."""
    rng = np.random.default_rng(seed)
    contacts = []
    for k in range(count):
        a, b = rng.uniform(0.0, tilt), rng.uniform(0.0, 2 * np.pi)
        normal = (np.sin(a) * np.cos(b), np.sin(a) * np.sin(b), np.cos(a))
        contacts.append(ss.PointContact(f"p{k}", rng.uniform((-0.4, -0.3, -0.05), (0.4, 0.3, 0.05)), normal=normal, friction=mu))
    return contacts


def _steps(rolls, mu: float) -> list:
    """Four soles on stones."""
    return [
        ss.SurfaceContact(f"sole{i}", (0.02 * i, 0.2 * i, 0.03 * i), rpy=(r, 0.1 * r, 0.0), friction=mu, size=(0.2, 0.1))
        for i, r in enumerate(rolls)
    ]


def _hand(name: str, at, normal, mu: float, size=None):
    if size is None:
        return ss.PointContact(name, at, normal=normal, friction=mu)
    return ss.SurfaceContact(name, at, normal=normal, friction=mu, size=size)


def _staggered_soles() -> list:
    """Soles of HOAP-2 pitched towards each other, one ahead of and below the other."""
    return [
        ss.SurfaceContact(n, p, rpy=(0.0, q, 0.0), friction=0.3, vertices=HOAP2_SOLE)
        for n, p, q in (("left_foot", (0.05, 0.039, -0.02), 0.436), ("right_foot", (-0.05, -0.039, 0.0), -0.436))
    ]


def _hands(size=None) -> list:
    """Two hands against walls in front."""
    return [_hand("left_hand", (0.5, 0.25, 1.1), (-1.0, 0.0, 0.2), 0.5, size),
            _hand("right_hand", (0.5, -0.25, 1.0), (-1.0, 0.2, 0.1), 0.5, size)]  # fmt: skip


def _pymanoid_double() -> list:
    return _feet((0.4, -0.4), at=((0.2, 0.15, 0.1), (-0.2, -0.195, 0.0)), size=(0.24, 0.13))


def _pymanoid_triple() -> list:
    feet = _feet((0.4701, -0.7124), at=((0.5779, 0.3871, 0.1023), (0.0, -0.3187, 0.0576)), size=(0.24, 0.13))
    hand = ss.SurfaceContact(
        "left_hand", (0.6544, 0.3917, 1.0263), rpy=(1.3382, -0.2331, -0.7726), friction=0.5, size=(0.24, 0.13)
    )
    return [*feet, hand]


def _stabilipy() -> list:
    rows = (("right_foot", (-0.1, 0.4, 0.0), (0.0, 0.3, 1.0)), ("left_foot", (0.0, -0.4, 0.1), (0.0, -0.3, 1.0)),
            ("hand", (0.5, 0.0, 0.8), (1.0, 0.0, 1.0)))  # fmt: skip
    return [ss.PointContact(name, at, normal=normal, friction=0.5) for name, at, normal in rows]


def _line(name: str, at, rotation, mu: float, length: float):
    return ss.LineContact(name, at, rotation, friction=mu, size=[length])


ACROSS = ((0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0))


def _valley(mu: float) -> list:
    s = np.sqrt(0.5)
    return [
        ss.LineContact("left_foot", (0.0, 0.2, 0.0), normal=(0.0, -s, s), friction=mu, size=[0.2]),
        ss.LineContact("right_foot", (0.0, -0.2, 0.0), normal=(0.0, s, s), friction=mu, size=[0.2]),
    ]


def _ladder_lines(foot: float, wall: float) -> list:
    """A ladder: its foot on the floor, its top against a wall."""
    top = ss.LineContact("wall", (1.2, 0.0, 4.0), normal=(-1.0, 0.0, 0.0), friction=wall, size=[0.4])
    return [_line("floor", (0.0, 0.0, 0.0), ACROSS, foot, 0.4), top]


def _on_a_ladder(mu: float, slope: float, hands: float) -> list:
    """Feet on a rung, hands on the rails of a steep ladder: points."""
    s, c = np.sin(slope), np.cos(slope)
    feet = [ss.PointContact(f"foot{k}", (0.0, y, 0.0), normal=(-s, 0.0, c), friction=mu) for k, y in enumerate((0.12, -0.12))]
    grip = [ss.PointContact(f"hand{k}", (0.35, y, 1.3), normal=(-np.cos(hands), 0.0, np.sin(hands)), friction=mu)
            for k, y in enumerate((0.2, -0.2))]  # fmt: skip
    return feet + grip


def _climber_on_a_ladder(mu: float) -> list:
    """Two feet and two hands, each along a piece of a rung: eight points."""
    feet = [_line(f"foot{k}", (0.0, y, 0.3 * k), ACROSS, mu, 0.1) for k, y in enumerate((0.12, -0.12))]
    hands = [ss.LineContact(f"hand{k}", (0.4, y, 1.5 + 0.3 * k), normal=(-0.8, 0.0, 0.6), friction=mu, size=[0.08])
             for k, y in enumerate((-0.15, 0.15))]  # fmt: skip
    return feet + hands


SUITE = (
    BenchmarkStance("flat_tripod", "flat", lambda: _tripod(0.25, 0.0, 0.5)),
    BenchmarkStance("flat_foot", "flat", lambda: _feet()[:1]),
    BenchmarkStance("flat_feet", "flat", _feet),
    BenchmarkStance("flat_feet_apart", "flat", lambda: _feet(mu=0.8, at=((0.15, 0.25, 0.0), (-0.15, -0.25, 0.0)))),
    BenchmarkStance("flat_octagons", "flat", lambda: _round_soles(8, 0.5)),
    BenchmarkStance("flat_ovals", "flat", lambda: _round_soles(32, 0.5)),
    BenchmarkStance("tilted_tripod", "sloped", lambda: _tripod(0.1, np.pi / 6, 0.3)),
    BenchmarkStance("steep_tripod", "sloped", lambda: _tripod(0.3, 0.8, 0.6)),
    BenchmarkStance("valley", "sloped", lambda: _valley(0.5)),
    BenchmarkStance("roof", "sloped", lambda: _feet((-0.35, 0.35))),
    BenchmarkStance("stones", "sloped", lambda: _feet((0.35, -0.35), (0.1, -0.1), at=((0.0, 0.15, 0.0), (0.05, -0.15, 0.06)))),
    BenchmarkStance("staggered_pitched", "sloped", _staggered_soles),
    BenchmarkStance("pymanoid_double", "sloped", _pymanoid_double),
    BenchmarkStance("round_roof", "sloped", lambda: _round_soles(12, 0.4, (-0.3, 0.3))),
    BenchmarkStance("four_stones", "sloped", lambda: _steps((-0.35, -0.1, 0.15, 0.35), 0.5)),
    BenchmarkStance("rough_5", "sloped", lambda: _rough(5, 1, 0.6, 0.4)),
    BenchmarkStance("rough_8", "sloped", lambda: _rough(8, 2, 0.6, 0.5)),
    BenchmarkStance("rough_24", "sloped", lambda: _rough(24, 3, 0.5, 0.5)),
    BenchmarkStance("rough_48", "sloped", lambda: _rough(48, 4, 0.4, 0.6)),
    BenchmarkStance("rough_64", "sloped", lambda: _rough(64, 5, 0.5, 0.3)),
    BenchmarkStance("stabilipy", "hands", _stabilipy),
    BenchmarkStance("foot_and_palm", "hands", lambda: [*_feet()[:1], _hand("hand", (0.5, 0.1, 1.1), (-1.0, 0.0, 0.2), 0.5, HAND)]),
    BenchmarkStance("feet_and_hand", "hands", lambda: [*_feet(mu=0.6), _hand("hand", (0.5, 0.2, 1.1), (-1.0, 0.0, 0.1), 0.4)]),
    BenchmarkStance("feet_and_palm", "hands", lambda: [*_feet((0.2, -0.2)), _hand("hand", (0.5, 0.2, 1.1), (-1.0, 0.0, 0.1), 0.5, HAND)]),
    BenchmarkStance("pymanoid_triple", "hands", _pymanoid_triple),
    BenchmarkStance("feet_and_hands", "hands", lambda: [*_feet(), *_hands()]),
    BenchmarkStance("feet_and_palms", "hands", lambda: [*_feet((0.1, -0.1)), *_hands(HAND)]),
    BenchmarkStance("ladder", "ladder", lambda: _ladder_lines(0.4, 0.2)),
    BenchmarkStance("on_a_ladder", "ladder", lambda: _on_a_ladder(0.4, 0.0, 0.4)),
    BenchmarkStance("steep_ladder", "ladder", lambda: _on_a_ladder(0.6, 0.2, 0.2)),
    BenchmarkStance("climber", "ladder", lambda: _climber_on_a_ladder(0.4)),
)  # fmt: skip


def _soles_of_points(count: int) -> list:
    """Points of two pitched soles: the corners first, then more and more points between them, which change nothing."""
    corners = [(x, y) for x, y in ((-0.1, 0.05), (0.1, -0.05), (-0.1, -0.05), (0.1, 0.05))]
    angles = (0.35, -0.35)
    contacts = []
    for k in range(count):
        foot, j = k % 2, k // 2
        # Fractions of a Halton sequence, away from the edges.
        x, y = corners[j] if j < 4 else (0.18 * (_radical(j, 2) - 0.5), 0.09 * (_radical(j, 3) - 0.5))
        s, c = np.sin(angles[foot]), np.cos(angles[foot])
        at = ((0.05, -0.05)[foot] + c * x, (0.1, -0.1)[foot] + y, (-0.02, 0.0)[foot] - s * x)
        contacts.append(ss.PointContact(f"p{k}", at, normal=(s, 0.0, c), friction=0.35))
    return contacts


def _radical(index: int, base: int) -> float:
    """Radical inverse of a whole number, between 0 and 1."""
    value, share = 0.0, 1.0 / base
    while index:
        index, digit = divmod(index, base)
        value, share = value + digit * share, share / base
    return value


def _oval_of_points(count: int) -> list:
    """Points on an oval of hilly ground: the same outline, more and more finely seen."""
    contacts = []
    for k in range(count):
        a = 2 * np.pi * (k + 0.3) / count
        tilt, heading = 0.35 * np.sin(2 * a), a + 0.8 * np.cos(a)
        normal = (np.sin(tilt) * np.cos(heading), np.sin(tilt) * np.sin(heading), np.cos(tilt))
        at = (0.3 * np.cos(a), 0.2 * np.sin(a), 0.05 * np.sin(3 * a))
        contacts.append(ss.PointContact(f"p{k}", at, normal=normal, friction=0.5))
    return contacts


GROWING = {"soles": _soles_of_points, "oval": _oval_of_points}


def growth(family: str, count: int) -> BenchmarkStance:
    """A stance of a family that exists for every number of points.

    Args:
        family: "soles", whose region is the same from 8 points on, or "oval", whose region gets rounder with every point.
        count: Number of points.
    """
    return BenchmarkStance(f"{family}_{count}", "growth", partial(GROWING[family], count))


def eight_points() -> tuple[BenchmarkStance, ...]:
    """The stances of eight points with one coefficient of friction, which every peer can be asked about."""
    chosen = []
    for stance in SUITE:
        points, _, friction = stance.point_contacts()
        if len(points) == 8 and len(set(friction)) == 1:
            chosen.append(stance)
    return tuple(chosen)
