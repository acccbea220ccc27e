"""Stances of closed forms and of the literature, shared by the region tests."""

import numpy as np

from socp_statics.contacts import PointContact, SurfaceContact

UP = [0, 0, 1]
SOLE = [[0.058, 0.0315], [-0.040, 0.0315], [-0.040, -0.0315], [0.058, -0.0315]]


def hoap2_soles(**more):
    return [
        SurfaceContact(n, [0, y, 0], normal=UP, friction=more.get("mu", 0.5), vertices=SOLE)
        for n, y in (("left", 0.039), ("right", -0.039))
    ]


def feet(mu=0.6):
    return [SurfaceContact(n, [0, y, 0], normal=UP, friction=mu, size=[0.22, 0.13]) for n, y in (("left", 0.1), ("right", -0.1))]


def wall(name, y, mu=0.6):
    return SurfaceContact(name, [0, y, 0], normal=[0, -np.sign(y), 0], friction=mu, size=[0.2, 0.1])


def pinch():
    return [
        PointContact("left", [0, 0.3, 0], normal=[0, -1, 0], friction=1.0),
        PointContact("right", [0, -0.3, 0], normal=[0, 1, 0], friction=1.0),
    ]


def three_points_tilted(angle, mu):
    s, c = np.sin(angle), np.cos(angle)
    return [
        PointContact(f"p{k}", [0.2 * np.cos(a), 0.2 * np.sin(a), 0], normal=[-s * np.cos(a), -s * np.sin(a), c], friction=mu)
        for k, a in enumerate(2 * np.pi / 3 * np.arange(3))
    ]


def directions(count, seed=0):
    a = np.random.default_rng(seed).uniform(0, 2 * np.pi, count)
    return np.column_stack([np.cos(a), np.sin(a)])
