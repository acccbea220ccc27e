"""Random postures of robots that are installed: joints anywhere inside their limits, contacts where the kinematics put them."""

from __future__ import annotations

from functools import cache

import numpy as np

import socp_statics as ss
from socp_statics.postures import posture_at

SUPPORT = ("left_foot", "right_foot", "left_hand", "right_hand")


def _installed() -> list[str]:
    try:
        import example_robot_data  # noqa: F401
    except ImportError:
        return ["hoap2"]
    return ["hoap2", "talos"]


POSTURES = _installed()


@cache
def robot(name):
    return ss.load_robot(name)


def random_posture(name, seed, support=SUPPORT, spread=0.5, friction=0.5):
    """A posture with joints in the middle part of their ranges."""
    machine, rng = robot(name), np.random.default_rng(seed)
    low, high = np.maximum(machine.lower, -1.5), np.minimum(machine.upper, 1.5)
    middle = 0.5 * (low + high)
    q = middle + spread * rng.uniform(-0.5, 0.5, len(low)) * (high - low)
    return ss.pose(machine, np.clip(q, machine.lower, machine.upper), support=support, friction=friction)


def moved_contact(posture, name, step):
    """Displacement and small rotation of a contact's link point when the joints move by a small step and the base stays, shape (6,)."""
    import pinocchio

    q = pinocchio.integrate(posture.robot.pin_model, posture.q, np.concatenate([np.zeros(6), step]))
    machine = posture.robot
    frame = machine.frames[name]
    other = posture_at(machine, q, posture.support, friction=0.5)
    R0, p0 = posture.link_placement(frame.frame)
    R1, p1 = other.link_placement(frame.frame)
    point = R0.T @ (posture.contacts[name].position - p0)
    return np.concatenate([p1 + R1 @ point - posture.contacts[name].position, pinocchio.log3(R1 @ R0.T)])
