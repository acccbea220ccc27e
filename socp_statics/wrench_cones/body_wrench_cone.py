"""The wrench cone of the composite rigid body: what all contacts together can exert on the robot."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.cones.choice import ConeChoice, cone_choice
from socp_statics.contacts.numbers import vector
from socp_statics.contacts.stance import as_contact_set
from socp_statics.spatial import skew
from socp_statics.wrench_cones.forms import checked_length
from socp_statics.wrench_cones.generators import generators_of
from socp_statics.wrench_cones.wrench_cone import WrenchCone


def body_wrench_cone(
    contacts: Any,
    point_W: ArrayLike | None = None,
    *,
    cone: str | ConeChoice = "exact",
    sides: int | None = None,
    heading: float | None = None,
    length: Any = None,
) -> WrenchCone:
    """The CRB wrench cone: the sum of the contact wrench cones, moved to one point in world axes.

    Implements (3.77), corrected: the cone is the Minkowski sum of the contacts' cones, their transported rays side by side
    (``C_cC U^S``), as the chapter's own span form says; their intersection, as its text says, would not even hold the weight on a
    flat double stance. A wrench in it is contact-consistent (`WrenchCone.consistency`).

    Args:
        contacts: Contacts without bounds in newtons; or a Stance or a Posture, whose contacts they are.
        point_W: Point that moments are taken about, for example the centre of mass, world axes, shape (3,) [m]; the mean contact
            point by default.
        cone: "exact", "inscribed" or "circumscribed", or a ConeChoice.
        sides: Sides of the pyramids.
        heading: Heading of the pyramids [rad].
        length: Length that moments are divided by where wrenches are measured [m]; the size of the contact set by default.

    Returns:
        The cone of ``[force; moment about point_W]`` in world axes, reactions of the environment on the robot.

    Raises:
        InputError: A wrong number or choice, or bounds in newtons, which leave no cone.
    """
    contact_set, choice = as_contact_set(getattr(contacts, "contacts", contacts)), cone_choice(cone, sides, heading)
    point = contact_set.centre if point_W is None else vector("contacts", "point", point_W, 3, kind="stance")
    transports = []
    for contact in contact_set:
        T = np.eye(6)
        T[3:, :3] = skew(contact.position - point)
        transports.append(T @ np.kron(np.eye(2), contact.rotation))
    unit = contact_set.size if length is None else checked_length(length)
    return WrenchCone(generators_of(list(contact_set), choice, transports), choice, unit, contact_set.names)
