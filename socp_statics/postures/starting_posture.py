"""Where inverse kinematics starts: the reference posture, laid over the places its contacts have to come to."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from socp_statics.postures.placements import Placement
from socp_statics.postures.working_memory import working_memory
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
    import pinocchio

    soles = [name for name in placements if placements[name].fixed == "all"]
    model, data = robot.pin_model, working_memory(robot)
    pinocchio.forwardKinematics(model, data, robot.configuration(angles))
    start, goal = [], []
    for name in soles or placements:
        frame, placement = robot.frames[name], placements[name]
        F = pinocchio.updateFramePlacement(model, data, robot.frame_id(frame.frame, name))
        points_C = frame.points_C if soles else np.zeros((1, 2))
        start.append(F.translation + (frame.position + points_C @ frame.rotation[:, :2].T) @ F.rotation.T)
        goal.append(placement.position + (points_C @ placement.rotation[:, :2].T if placement.rotation is not None else 0.0))
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
