"""Exactly degenerate stances of one kilogram, fifteen kinds: here, and only here, may a verdict stay open by design."""

from __future__ import annotations

import numpy as np

from socp_statics.contacts import ContactSet, ExternalWrench, FrictionlessPointContact, PointContact, Stance, SurfaceContact

UP = (0.0, 0.0, 1.0)
GRAVITY = (0.0, 0.0, -9.81)


def _stance(contacts, com, **more) -> Stance:
    return Stance(ContactSet(contacts), com, 1.0, GRAVITY, **more)


def _feet(mu, **more):
    sides = (("left", 0.125), ("right", -0.125))
    return [SurfaceContact(n, [0, y, 0], normal=UP, friction=mu, size=(0.25, 0.125), **more) for n, y in sides]


def _mu(rng) -> float:
    return float(rng.choice([0.25, 0.5, 1.0, 2.0]))


def on_an_edge(rng):
    return _stance(_feet(_mu(rng)), [0.125, rng.choice([0.0, 0.0625, -0.125]), 0.5])


def on_a_corner(rng):
    return _stance(_feet(_mu(rng)), [-0.125, 0.1875, 0.5])


def over_one_of_two_points(rng):
    return _stance([PointContact(n, [0, y, 0], normal=UP, friction=_mu(rng)) for n, y in (("a", 0.25), ("b", -0.25))], [0, 0.25, 0.5])


def between_two_points(rng):
    return _stance(
        [PointContact(n, [0, y, 0], normal=UP, friction=_mu(rng)) for n, y in (("a", 0.25), ("b", -0.25))], [0, rng.uniform(-0.2, 0.2), 0.5]
    )


def beside_two_points_by_little(rng):
    points = [PointContact(n, [0, y, 0], normal=UP, friction=_mu(rng)) for n, y in (("a", 0.25), ("b", -0.25))]
    return _stance(points, [10.0 ** rng.uniform(-11, -8), 0.0, 0.5])


def over_one_point(rng):
    return _stance([PointContact("a", [0, 0, 0], normal=[0.25, 0, 1], friction=_mu(rng))], [0, 0, 0.5])


def on_a_row_of_points(rng):
    return _stance(
        [PointContact(f"p{k}", [0.125 * k, 0, 0], normal=UP, friction=_mu(rng)) for k in range(5)], [rng.uniform(-0.1, 0.6), 0, 0.5]
    )


def at_the_friction_angle(rng):
    mu = _mu(rng)
    return _stance([SurfaceContact("sole", [0, 0, 0], normal=[mu, 0, 1], friction=mu, size=(0.25, 0.25))], [0, 0, 0.0625])


def a_point_at_the_friction_angle(rng):
    mu = _mu(rng)
    return _stance([PointContact("a", [0, 0, 0], normal=[0, mu, 1], friction=mu)], [0, 0, 0.5])


def walls_at_the_friction_angle(rng):
    mu = _mu(rng)
    up = rng.choice([-1.0, 1.0])
    return _stance(
        [
            PointContact(f"{n}{k}", [x, y, 0], normal=[0, -np.sign(y), up * mu], friction=mu)
            for n, y in (("left", 0.5), ("right", -0.5))
            for k, x in enumerate((-0.125, 0.125))
        ],
        [0, 0, 0.25],
    )


def an_idle_wall(rng):
    wall = FrictionlessPointContact("wall", [0.125, 0, 0.5], normal=[-1, 0, 0])
    return _stance([*_feet(0.0), wall], [rng.choice([0.0, 0.0625, 0.125, 0.25]), 0, 0.5])


def no_friction_at_all(rng):
    return _stance(_feet(0.0), [rng.uniform(-0.2, 0.2), rng.uniform(-0.3, 0.3), 0.5])


def all_that_a_bound_allows(rng):
    half = 0.5 * 9.81
    return _stance(_feet(_mu(rng), normal_force=[(half, half), (half, 2 * half), (0, half)][int(rng.integers(3))]), [0, 0, 0.5])


def lifted_by_its_weight(rng):
    return _stance(_feet(_mu(rng)), [0, 0, 0.5], external_wrenches=(ExternalWrench(force=[0, 0, 9.81], point=[0, 0, 0.5]),))


def pushed_to_the_edge(rng):
    push = 9.81 * 0.25
    return _stance(_feet(2.0), [0, 0, 0.5], external_wrenches=(ExternalWrench(force=[push, 0, 0], point=[0, 0, 0.5]),))


PLANTED = (
    on_an_edge, on_a_corner, over_one_of_two_points, between_two_points, beside_two_points_by_little, over_one_point,
    on_a_row_of_points, at_the_friction_angle, a_point_at_the_friction_angle, walls_at_the_friction_angle, an_idle_wall,
    no_friction_at_all, all_that_a_bound_allows, lifted_by_its_weight, pushed_to_the_edge,
)  # fmt: skip
