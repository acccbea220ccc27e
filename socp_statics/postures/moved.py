"""Postures derived from one another: other configurations on the same contacts, and how their points move."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from socp_statics.contacts import ContactSet
from socp_statics.contacts.contact import Contact
from socp_statics.exceptions import InputError
from socp_statics.postures.posture import Posture, configured
from socp_statics.robots import Robot
from socp_statics.spatial import Array, skew


def moved_configuration(robot: Robot, q: Array, motion: Array) -> Array:
    """``q (+) motion``, shape (nq,)."""
    import pinocchio

    return np.array(pinocchio.integrate(robot.pin_model, q, motion))


def posture_on(
    posture: Posture,
    q: Array,
    placed: Mapping[str, Contact] | None = None,
    orientations: Mapping[str, Array] | None = None,
) -> Posture:
    """The posture of another configuration of the same robot on the same contacts, with the same loads.

    Args:
        posture: Says which contacts touch, with which friction, and what the robot holds.
        q: Pinocchio configuration, shape (nq,); joints outside their limits are not refused.
        placed: Contacts that stay as they are: the environment decides where they are, and the kinematics agree. The others go where
            their links are.
        orientations: As in `posture_at`.

    Returns:
        The posture.
    """
    riding = configured(posture.robot, q, {c.name: c.friction for c in posture.contacts}, orientations or {})
    contacts = ContactSet([(placed or {}).get(c.name, c) for c in riding.contacts])
    return replace(riding, contacts=contacts, loads=posture.loads)


def whole_jacobian(posture: Posture, point_W: Array, jacobian: Array) -> Array:
    """A Jacobian with the base fixed, extended by the base: velocity of a point due to the tangent vector of the configuration.

    Args:
        posture: The posture.
        point_W: The point, world axes, shape (3,) [m].
        jacobian: Velocity due to joint rates with the base fixed, ``[linear]`` or ``[linear; angular]``, shape (3 or 6, n).

    Returns:
        Shape (3 or 6, nv).
    """
    R = posture.R_WB
    base = np.zeros((6, 6))
    base[:3, :3] = base[3:, 3:] = R
    base[:3, 3:] = -skew(np.asarray(point_W) - posture.p_WB) @ R
    return np.hstack([base[: len(jacobian)], jacobian])


def contact_jacobians(posture: Posture) -> dict[str, Array]:
    """Velocity ``[linear; angular]`` of each contact frame due to the tangent vector of the configuration, world axes, shapes (6, nv)."""
    return {c.name: whole_jacobian(posture, c.position, posture.jacobian[c.name]) for c in posture.contacts}


def require_derivatives(robot: Robot) -> None:
    """Refuse robots whose derivatives Pinocchio does not know.

    Raises:
        InputError: A joint mimics another; the sentence names it.
    """
    model = robot.pin_model
    mimics = [model.names[i] for i in range(2, model.njoints) if "Mimic" in model.joints[i].shortname()]
    if mimics:
        message = f"robot '{robot.name}': joint '{mimics[0]}' mimics another, and gradients need joints that move on their own"
        raise InputError(message, name=mimics[0], field="robot")


def require_free_hands(posture: Posture) -> None:
    """Refuse postures that hold an object where nothing would keep the hands on it while the joints move.

    Raises:
        InputError: The posture has loads of its own.
    """
    if posture.loads:
        names = " and ".join(dict.fromkeys(str(wrench.link) for wrench in posture.loads))
        message = f"robot '{posture.robot.name}': {names} hold an object and would leave it: a posture that holds nothing is expected"
        raise InputError(message, name="posture", field="posture")
