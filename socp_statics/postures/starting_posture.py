"""Where inverse kinematics starts: the reference posture, laid over the places its contacts have to come to."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from socp_statics.postures.placements import Placement
from socp_statics.postures.posture import posture_at
from socp_statics.robots import Robot
from socp_statics.spatial import Array


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
    """The rotation that brings vectors nearest to others; about the vertical where they do not tell it all."""
    from scipy.spatial.transform import Rotation

    if min(np.linalg.matrix_rank(a, tol=1e-6), np.linalg.matrix_rank(b, tol=1e-6)) >= 2:
        return Rotation.align_vectors(b, a)[0].as_matrix()
    flat = np.array([1.0, 1.0, 0.0])
    sine, cosine = np.cross(a * flat, b * flat)[:, 2].sum(), (a * b)[:, :2].sum()
    return Rotation.from_rotvec([0.0, 0.0, np.arctan2(sine, cosine)]).as_matrix() if sine or cosine else np.eye(3)
