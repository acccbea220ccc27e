"""Forces that a pyramid allows and the true cone does not: by how much?"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from socp_statics.contacts import ContactSet, SoftFingerContact
from socp_statics.spatial import Array
from socp_statics.statics import PointForces

# Of the largest force: what rounding leaves outside a cone is no violation.
ROUNDING = 1e-7


class Violation(NamedTuple):
    """How far forces are outside the true friction cones.

    Attributes:
        share: Largest tangential force of a point over what friction can hold there, minus 1; 0 where no cone is violated.
        force: Largest tangential force beyond what friction can hold, at any point [N].
        points: Number of points whose cone is violated; of a region at the corner where most are.
    """

    share: float
    force: float
    points: int


NONE = Violation(0.0, 0.0, 0)


def violation(contacts: ContactSet, forces: Iterable[PointForces]) -> Violation:
    """The worst of several choices of forces.

    Args:
        contacts: Contacts of the stance.
        forces: Forces at their points.
    """
    worst = NONE
    for one in forces:
        grip, held, scale = _grips(contacts, one)
        beyond = grip - held
        out = beyond > ROUNDING * scale
        if out.any():
            share = float((grip[out] / np.maximum(held[out], ROUNDING * scale)).max()) - 1.0
            worst = Violation(max(worst.share, share), max(worst.force, float(beyond.max())), max(worst.points, int(out.sum())))
    return worst


def _grips(contacts: ContactSet, forces: PointForces) -> tuple[Array, Array, float]:
    """Tangential force (and torsion) of every point with friction, what its cone holds, and the largest force component."""
    named = {c.name: c for c in contacts}
    grip, held = [], []
    for i, name in enumerate(forces.contact):
        contact = named[name]
        if contact.type == "handle" or contact.friction == 0.0:
            continue
        f = contact.rotation.T @ forces.force_W[i]
        slide, mu = float(np.hypot(f[0], f[1])), contact.friction
        if isinstance(contact, SoftFingerContact):
            spin = mu / contact.torsional_friction * abs(float(contact.rotation[:, 2] @ forces.moment_W[i]))
            slide = float(np.hypot(slide, spin)) if contact.shape == "elliptic" else max(slide, spin)
        grip.append(slide)
        held.append(mu * max(float(f[2]), 0.0))
    return np.array(grip), np.array(held), float(np.abs(forces.force_W).max(initial=0.0))
