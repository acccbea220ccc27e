"""Where the robot touches: soles, edges, points and handles with their names, what carries them, and their friction cones."""

from __future__ import annotations

import numpy as np

from socp_statics.colours import GROUND, ORANGE, SOLE_LINE
from socp_statics.cones import FrictionCone
from socp_statics.cones.choice import ConeChoice
from socp_statics.cones.friction_pyramid import FrictionPyramid
from socp_statics.contacts import Contact, ContactSet
from socp_statics.spatial import Array
from socp_statics.viewer.marks import Lines, Mark, Name, Solid, closed, path
from socp_statics.viewer.solids import ball, box, cone, fan, placed

CONE_SHARE, PLATE_SHARE, DOT_SHARE, LIFT = 0.13, 0.12, 0.009, 0.0015
CONE_SIDES = 48
CONE_OPACITY, PLATE_OPACITY = 0.2, 0.6
LEVEL = 1e-6


def contact_marks(contacts: ContactSet, extent: float) -> list[Mark]:
    """Contacts with their names, and plates behind those that no floor carries.

    Args:
        contacts: The contacts.
        extent: How large the scene is [m].
    """
    lowest = float(contacts.points_W[:, 2].min())
    out: list[Mark] = []
    for contact in contacts:
        points, here = contact.points_W, path("contacts", contact.name)
        middle = points.mean(axis=0)
        if len(points) > 1:
            out.append(Lines(f"{here}/outline", closed(points) if len(points) > 2 else points[None], SOLE_LINE, pixels=3.0))
        else:
            dot = ball(DOT_SHARE * extent) if contact.unilateral else box(np.full(3, 3.0 * DOT_SHARE * extent))
            out.append(Solid(f"{here}/point", *placed(dot, contact.rotation, middle), SOLE_LINE))
        on_floor = contact.normal_W[2] > 1.0 - LEVEL and points[:, 2].min() < lowest + LEVEL * extent
        if contact.unilateral and not on_floor:
            out.append(Solid(f"{here}/carrier", *_plate(contact, extent), GROUND, opacity=PLATE_OPACITY))
        out.append(Name(f"{here}/name", contact.name, middle))
    return out


def _plate(contact: Contact, extent: float) -> tuple[Array, Array]:
    """A rectangle in the contact plane, a hair behind it."""
    rim = PLATE_SHARE * extent
    low, high = contact.points_C.min(axis=0) - rim, contact.points_C.max(axis=0) + rim
    corners = np.array([[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]])
    behind = np.column_stack([corners, np.full(4, -LIFT * extent)])
    return fan(contact.position + behind @ contact.rotation.T)


def cone_marks(contacts: ContactSet, extent: float, choice: ConeChoice) -> list[Mark]:
    """The friction cones at the contact points, of their true angle and as far as a fixed slant length.

    Contacts without friction have their normal; handles have no cone. Where pyramids are asked for, their edges are drawn over the
    exact cone.

    Args:
        contacts: The contacts.
        extent: How large the scene is [m].
        choice: Exact cones or pyramids.
    """
    out: list[Mark] = []
    slant = CONE_SHARE * extent
    for contact in contacts:
        if not contact.unilateral:
            continue
        for k, apex in enumerate(contact.points_W):
            here = path("cones", contact.name, str(k))
            rim = _rim(FrictionCone(contact.friction).generators(CONE_SIDES), contact, apex, slant)
            if len(rim) < 3:
                out.append(Lines(f"{here}/normal", np.array([[apex, rim[0]]]), ORANGE))
                continue
            out.append(Solid(f"{here}/cone", *cone(apex, rim), ORANGE, opacity=CONE_OPACITY))
            out.append(Lines(f"{here}/rim", closed(rim), ORANGE, pixels=1.5))
            if not choice.is_exact:
                corners = _rim(FrictionPyramid(contact.friction, choice).generators(), contact, apex, slant)
                edges = np.stack([np.broadcast_to(apex, corners.shape), corners], axis=1)
                out.append(Lines(f"{here}/pyramid", np.vstack([edges, closed(corners)]), ORANGE, pixels=2.5))
    return out


def _rim(generators: Array, contact: Contact, apex: Array, slant: float) -> Array:
    """Ends of the edges of a cone, cut off where the exact cone has its slant length, shape (k, 3) [m]."""
    height = slant / float(np.hypot(1.0, contact.friction))
    return apex + height * generators @ contact.rotation.T
