"""What the sweep's checks read of a stance, worked out again from positions and rotations, in units of W and the size.

Positions are taken relative to the first contact before anything is added to them, so that a stance a kilometre away loses nothing.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

COMPONENTS = ("fx", "fy", "fz", "mx", "my", "mz")


class Grip(NamedTuple):
    """One component of a handle: its contact, its wrench about the centre, shape (6,), and its limits, all scaled."""

    contact: int
    wrench: np.ndarray
    lo: float
    hi: float


class Layout(NamedTuple):
    """Scaled numbers of a stance; n contact points of unilateral contacts, in the order of the contacts.

    Attributes:
        W: Unit of force [N].
        size: Unit of length [m].
        anchor: Position of the first contact, world axes, shape (3,) [m].
        centre: Mean contact point relative to the anchor [m].
        points: Relative to the centre, scaled, shape (n, 3).
        owner: Contact of each point, shape (n,).
        frames: Contact frame of each point, shape (n, 3, 3).
        friction: Of each point, shape (n,).
        torsion: Scaled torsional friction of each point, 0 where it has none, shape (n,).
        elliptic: Whether force and moment share one cone, shape (n,).
        bounds: Least and largest normal force of each contact, scaled, by index; only where it is bounded.
        grips: Components of handles.
        load: Wrench on the robot about the centre, shape (6,).
        com_load: Its change with the CoM's x and y, shape (6, 2).
        com: Centre of mass, relative to the centre, scaled.
    """

    W: float
    size: float
    anchor: np.ndarray
    centre: np.ndarray
    points: np.ndarray
    owner: np.ndarray
    frames: np.ndarray
    friction: np.ndarray
    torsion: np.ndarray
    elliptic: np.ndarray
    bounds: dict[int, tuple[float, float]]
    grips: list[Grip]
    load: np.ndarray
    com_load: np.ndarray
    com: np.ndarray

    def scaled(self, position_W) -> np.ndarray:
        """World positions relative to the centre, scaled, shape (..., 3)."""
        return (np.asarray(position_W, dtype=float) - self.anchor - self.centre) / self.size


def corners_of(contact) -> np.ndarray:
    """Contact points in the contact plane, shape (k, 2) [m]."""
    if contact.type in ("surface", "frictionless_surface"):
        return np.asarray(contact.vertices)
    if contact.type == "line":
        return np.array([[0.5 * contact.length, 0.0], [-0.5 * contact.length, 0.0]])
    return np.zeros((1, 2))


def layout(stance) -> Layout:
    """The numbers of a stance."""
    contacts = list(stance.contacts)
    anchor = np.asarray(contacts[0].position)
    corners = [corners_of(c) for c in contacts]
    R = np.array([c.rotation for c in contacts])
    everything = np.vstack([c.position - anchor + xy @ r[:, :2].T for c, xy, r in zip(contacts, corners, R, strict=True)])
    apart = everything[:, None] - everything
    size = float(np.sqrt((apart * apart).sum(axis=2).max())) or 1.0
    centre = everything.mean(axis=0)
    weight = stance.mass * np.asarray(stance.gravity)
    sizes = [np.linalg.norm(weight)]
    for w in stance.external_wrenches:
        sizes += [np.linalg.norm(w.force), np.linalg.norm(w.moment) / size]
    W = float(max(sizes)) or 1.0

    of_point = np.repeat(np.arange(len(contacts)), [len(xy) for xy in corners])
    pushing = np.array([c.type != "handle" for c in contacts])[of_point]
    owner = of_point[pushing]
    friction = np.array([c.friction for c in contacts])
    soft = np.array([c.type == "soft_finger" and c.friction > 0 for c in contacts])
    gamma = np.array([c.torsional_friction if s else 0.0 for c, s in zip(contacts, soft, strict=True)]) / size
    elliptic = np.array([s and c.shape == "elliptic" for c, s in zip(contacts, soft, strict=True)])
    bounds = {
        k: (c.normal_force[0] / W, c.normal_force[1] / W)
        for k, c in enumerate(contacts)
        if c.type != "handle" and c.normal_force is not None
    }
    local = lambda p: (np.asarray(p) - anchor - centre) / size  # noqa: E731
    com = local(stance.com)
    load, com_load = _loads(stance, weight / W, com, local, W, size)
    return Layout(
        W, size, anchor, centre, (everything[pushing] - centre) / size, owner, R[owner], friction[owner], gamma[owner], elliptic[owner],
        bounds, _grips(contacts, local, W, size), load, com_load, com,
    )  # fmt: skip


def _loads(stance, g, com, local, W: float, size: float) -> tuple[np.ndarray, np.ndarray]:
    load = np.concatenate([g, np.cross(com, g)])
    for w in stance.external_wrenches:
        arm = np.zeros(3) if w.point is None else local(w.point)
        load += np.concatenate([w.force, np.cross(arm, w.force) + np.asarray(w.moment) / size]) / W
    return load, np.vstack([np.zeros((3, 2)), np.cross(np.eye(3)[:2], g).T])


def _grips(contacts, local, W: float, size: float) -> list[Grip]:
    grips = []
    for k, c in enumerate(contacts):
        for word in c.transmits if c.type == "handle" else ():
            axis = np.asarray(c.rotation)[:, "xyz".index(word[1])]
            wrench = np.concatenate([axis, np.cross(local(c.position), axis)] if word[0] == "f" else [np.zeros(3), axis])
            lo, hi = c.limits.get(word, (-np.inf, np.inf))
            unit = W if word[0] == "f" else W * size
            grips.append(Grip(k, wrench, lo / unit, hi / unit))
    return grips
