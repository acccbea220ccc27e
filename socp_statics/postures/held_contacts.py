"""Postures on given contacts: which motions keep them in place, and the way back onto them after a motion."""

from __future__ import annotations

from collections.abc import Collection
from functools import cached_property

import numpy as np

from socp_statics.contacts.contact import Contact
from socp_statics.contacts.joint import basis
from socp_statics.exceptions import InputError
from socp_statics.postures.moved import contact_jacobians, moved_configuration, posture_on
from socp_statics.postures.posture import Posture
from socp_statics.registry import nearest
from socp_statics.spatial import Array

PLANAR = ("surface", "frictionless_surface", "line")
CLOSED = 1e-11
SINGULAR = 1e-7
ITERATIONS = 25
LONGEST = 1.0


class HeldContacts:
    """The contacts of a posture, which a motion has to keep: in place, or, where they may slide, in their plane.

    A contact in place keeps its position and the orientations that its wrench resists; a sliding one keeps what it resists without
    friction. The environment decides the normals: a fingertip may roll without changing its contact.

    Args:
        posture: The posture that says where the contacts are.
        sliding: Names of the contacts that may slide in their plane; a handle may slide along what it does not transmit.

    Raises:
        InputError: A name is no contact of the posture.
    """

    def __init__(self, posture: Posture, sliding: Collection[str] = ()):
        for name in sliding:
            if name not in posture.support:
                message = f"{name!r} is no contact of the posture{nearest(name, posture.support)}"
                raise InputError(message, name=name, field="slide")
        self.given, self.sliding = posture, frozenset(sliding)
        self._bases = {c.name: self._held(c) for c in posture.contacts}
        self.turning = {c.name: np.outer(c.normal_W, c.normal_W) * (c.type in PLANAR) for c in posture.contacts}

    def _held(self, contact: Contact) -> Array:
        """Directions in which the contact frame may not move, contact axes, shape (6, c)."""
        if contact.name in self.sliding:
            # an edge keeps its heading: with it, one row says that it stays in the plane
            return basis({*contact.hard, *({"mz"} if contact.type == "line" else ())})
        return basis({"fx", "fy", "fz", *contact.hard, *contact.soft})

    def jacobian(self, posture: Posture) -> Array:
        """Velocities in the held directions due to the tangent vector of the configuration, shape (c, nv)."""
        J = contact_jacobians(posture)
        return np.vstack([self._rows(c) @ J[c.name] for c in self.given.contacts])

    def _rows(self, contact: Contact) -> Array:
        return self._bases[contact.name].T @ np.kron(np.eye(2), contact.rotation.T)

    def motions(self, posture: Posture) -> Array:
        """Motions that keep the contacts, to first order; orthonormal with the base's displacement in units of the contacts' size.

        Args:
            posture: A posture on the contacts.

        Returns:
            Columns in the tangent of the configuration, shape (nv, m).
        """
        scaled = self.jacobian(posture) * self.scale
        _, sigma, Vt = np.linalg.svd(scaled)
        return self.scale[:, None] * Vt[int((sigma > SINGULAR).sum()) :].T

    @cached_property
    def scale(self) -> Array:
        """One unit of each tangent coordinate: the size of the contact set for the base's displacement, one for angles, shape (nv,)."""
        scale = np.ones(self.given.robot.pin_model.nv)
        scale[:3] = self.given.contacts.size
        return scale

    def gap(self, posture: Posture) -> Array:
        """How far the links are from the contacts in the held directions, shape (c,) [m, rad].

        Args:
            posture: A posture whose contacts ride on their links.
        """
        import pinocchio

        out = []
        for c in self.given.contacts:
            R, p = posture.contacts[c.name].rotation, posture.contacts[c.name].position
            away = np.concatenate([p - c.position, c.rotation @ pinocchio.log3(c.rotation.T @ R)])
            out.append(self._rows(c) @ away)
        return np.concatenate(out)

    def closed(self, posture: Posture, motion: Array) -> Posture | None:
        """The posture after a motion, brought back onto the contacts and into the joint limits by the least further motion.

        Args:
            posture: A posture on the contacts.
            motion: Tangent vector, shape (nv,).

        Returns:
            The posture, its contacts where the environment is; None where Newton's method finds none nearby.
        """
        robot = posture.robot
        q = moved_configuration(robot, posture.q, motion)
        for _ in range(ITERATIONS):
            riding = posture_on(self.given, q)
            gap, outside = self.gap(riding), np.clip(riding.angles, robot.lower, robot.upper) - riding.angles
            if max(float(np.abs(gap).max()), float(np.abs(outside).max())) <= CLOSED:
                return self._placed(riding)
            step = np.zeros(robot.pin_model.nv)
            step[6:] = outside
            free = np.ones(len(step), dtype=bool)
            free[6:] = (riding.angles > robot.lower + CLOSED) & (riding.angles < robot.upper - CLOSED)
            J = self.jacobian(riding)
            scaled = J[:, free] * self.scale[free]
            step[free] = self.scale[free] * np.linalg.lstsq(scaled, -gap - J @ step, rcond=SINGULAR)[0]
            size = float(np.linalg.norm(step / self.scale))
            q = moved_configuration(robot, q, step if size <= LONGEST else step * (LONGEST / size))
        return None

    def _placed(self, riding: Posture) -> Posture:
        """The posture with its contacts as the environment has them: only what slides has moved."""
        placed = {}
        for c in self.given.contacts:
            there, slides = riding.contacts[c.name], c.name in self.sliding
            rotation = there.rotation if slides and c.type in PLANAR else c.rotation
            placed[c.name] = c.placed(np.array(there.position if slides else c.position), np.array(rotation), c.friction)
        return posture_on(self.given, riding.q, placed)
