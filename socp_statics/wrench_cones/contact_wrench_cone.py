"""The wrench cone of one contact, in its contact frame."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial.distance import pdist

from socp_statics.cones.choice import ConeChoice, cone_choice
from socp_statics.contacts import Contact, SoftFingerContact
from socp_statics.contacts.numbers import vector
from socp_statics.exceptions import InputError
from socp_statics.spatial import skew
from socp_statics.wrench_cones.forms import checked_length
from socp_statics.wrench_cones.generators import generators_of
from socp_statics.wrench_cones.rectangle import has_closed_form, rectangle_faces
from socp_statics.wrench_cones.wrench_cone import WrenchCone


def contact_wrench_cone(
    contact: Contact,
    *,
    cone: str | ConeChoice = "exact",
    sides: int | None = None,
    heading: float | None = None,
    point_C: ArrayLike = (0.0, 0.0, 0.0),
    length: Any = None,
) -> WrenchCone:
    """The wrenches that a contact can exert on the robot: a convex sole through its corners, a line through its ends.

    Args:
        contact: Any contact without bounds in newtons.
        cone: "exact", "inscribed" or "circumscribed", or a ConeChoice.
        sides: Sides of the pyramids.
        heading: Heading of the pyramids [rad].
        point_C: Point that moments are taken about, in the contact frame, shape (3,) [m]; the contact's position by default.
        length: Length that moments are divided by where wrenches are measured [m]; by default the largest distance between the
            contact's points, gamma of a soft finger, else 1 m.

    Returns:
        The cone of ``[force; moment about point_C]`` in contact axes t1, t2, n. Its faces are those of (3.13)-(3.14) where the
        contact is a rectangle with four-sided pyramids along its edges.

    Raises:
        InputError: Not a contact, a wrong number or choice, or bounds in newtons, which leave no cone.
    """
    if not isinstance(contact, Contact):
        raise InputError(f"a contact is expected, got {contact!r}", field="contact")
    choice = cone_choice(cone, sides, heading)
    point = vector(contact.name, "point", point_C, 3)
    unit = _length_of(contact) if length is None else checked_length(length)
    X = np.eye(6)
    X[3:, :3] = -skew(point)
    generators = generators_of([contact], choice, [X])
    closed = rectangle_faces(contact, choice, point, length=unit) if has_closed_form(contact, choice) else None
    return WrenchCone(generators, choice, unit, (contact.name,), closed)


def _length_of(contact: Contact) -> float:
    if isinstance(contact, SoftFingerContact):
        return contact.torsional_friction
    return float(pdist(contact.points_C).max()) if len(contact.points_C) > 1 else 1.0
