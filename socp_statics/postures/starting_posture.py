"""Where inverse kinematics starts: the reference posture, laid over the places its contacts have to come to."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from socp_statics.postures.placements import Placement
from socp_statics.postures.posture import posture_at
from socp_statics.robots import Robot
from socp_statics.spatial import Array

UNTOLD = 1e-6


def laid_over(robot: Robot, angles: Array, placements: Mapping[str, Placement]) -> Array:
    """The configuration with these joint angles whose contacts come nearest to their places, by least squares over contact points.

    Soles decide where there are any: hands are brought to their places by the joints. The base is turned about the vertical
    only where no sole and fewer than three points are placed.

    Args:
        robot: The robot.
        angles: Joint angles, shape (n,) [rad].
        placements: Where its contacts have to be.

    Returns:
        Shape (nq,).
    """
    soles = [name for name in placements if placements[name].fixed == "all"]
    names = soles or list(placements)
    here = posture_at(robot, robot.configuration(angles), names, {name: 0.0 for name in names})
    start, goal = [], []
    for contact in here.contacts:
        placement = placements[contact.name]
        rotation = contact.rotation if placement.rotation is None else placement.rotation
        points_C = contact.points_C if contact.name in soles else np.zeros((1, 2))
        start.append(contact.position + points_C @ contact.rotation[:, :2].T)
        goal.append(placement.position + points_C @ rotation[:, :2].T)
    a, b = np.vstack(start), np.vstack(goal)
    middle_a, middle_b = a.mean(axis=0), b.mean(axis=0)
    turned = _turn(a - middle_a, b - middle_b)
    return robot.configuration(angles, middle_b - turned @ middle_a, turned)


def _turn(a: Array, b: Array) -> Array:
    """The rotation that brings vectors nearest to others (Kabsch); about the vertical where they do not tell it all."""
    U, stretched, Vt = np.linalg.svd(b.T @ a)
    if stretched[1] > UNTOLD * stretched[0] > 0.0:
        return U @ np.diag([1.0, 1.0, np.sign(np.linalg.det(U @ Vt))]) @ Vt
    x, y = (a * b)[:, :2].sum(), a[:, 0] @ b[:, 1] - a[:, 1] @ b[:, 0]
    size = float(np.hypot(x, y))
    c, s = (x / size, y / size) if size > 0.0 else (1.0, 0.0)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
