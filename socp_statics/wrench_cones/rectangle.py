"""The contact wrench cone of a rectangular sole in closed form."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.cones.choice import ConeChoice
from socp_statics.contacts import Contact, SurfaceContact
from socp_statics.contacts.numbers import vector
from socp_statics.exceptions import InputError
from socp_statics.spatial import Array, skew
from socp_statics.wrench_cones.forms import FaceForm, checked_length, units

SQUARE = 1e-9


class Rectangle(NamedTuple):
    """A rectangle in the contact plane.

    Attributes:
        centre: In contact axes t1, t2, shape (2,) [m].
        axis: Unit vector along its first edge, shape (2,).
        half: Half-lengths along the first edge and across it, shape (2,) [m].
    """

    centre: Array
    axis: Array
    half: Array


def rectangle_of(contact: Contact) -> Rectangle | None:
    """The rectangle of a sole, wherever it lies in the contact frame and however it is turned; None for any other contact.

    Args:
        contact: The contact.
    """
    if not isinstance(contact, SurfaceContact) or len(contact.vertices) != 4:
        return None
    corners = contact.vertices
    first, second = corners[1] - corners[0], corners[2] - corners[1]
    sides = np.array([np.linalg.norm(first), np.linalg.norm(second)])
    parallel = np.abs(corners[0] - corners[1] + corners[2] - corners[3]).max() <= SQUARE * sides.max()
    if not parallel or abs(first @ second) > SQUARE * sides[0] * sides[1]:
        return None
    return Rectangle(corners.mean(axis=0), first / sides[0], sides / 2)


def has_closed_form(contact: Contact, choice: ConeChoice) -> bool:
    """Whether the contact is a rectangle whose pyramids have four sides along its edges, or no friction.

    Args:
        contact: The contact.
        choice: Exact cones or pyramids.
    """
    sole = rectangle_of(contact)
    if sole is None:
        return False
    if contact.frictionless:
        return True
    if choice.sides != 4 or choice.heading is None:
        return False
    turn = (choice.heading - math.atan2(sole.axis[1], sole.axis[0])) / (math.pi / 2)
    return abs(turn - round(turn)) <= SQUARE


def rectangle_faces(contact: Contact, choice: ConeChoice, point_C: ArrayLike = (0.0, 0.0, 0.0), *, length: float = 1.0) -> FaceForm:
    """The 16 faces of the wrench cone of a rectangular sole, four-sided pyramids along its edges at the corners.

    Implements (3.13), (3.14).

    The printed formulas hold for wrenches about the centre of the sole in axes along its edges; here they are moved to any point
    and turned to the contact axes. Three corrections: ``f_z >= 0`` instead of ``> 0`` (the zero wrench belongs to the cone, and
    the other rows imply it); the limits of m_z are constraints beside the others, not definitions, eight rows once their absolute
    values are written out; mu is the slope of the pyramid's faces, which for an inscribed pyramid is mu / sqrt(2).

    Args:
        contact: A surface with four corners at right angles.
        choice: Four sides along the edges, inscribed or circumscribed; any choice without friction.
        point_C: Point that moments are taken about, in the contact frame, shape (3,) [m].
        length: Length that moments are divided by where wrenches are measured [m].

    Returns:
        Faces of wrenches in contact axes about the point, each so long that ``U F`` is the distance from it in the norm
        ``|(f, m / length)|``, shape (16, 6). Without friction f_x, f_y and m_z about the centre are equalities and four faces are left.

    Raises:
        InputError: No rectangle, or other pyramids than those the closed form is for.
    """
    name, unit = contact.name, units(6, checked_length(length))
    sole = rectangle_of(contact)
    if sole is None:
        message = f"contact '{name}': the closed form is for rectangular soles, this contact is none; use contact_wrench_cone(...).faces()"
        raise InputError(message, name=name, field="vertices")
    if not has_closed_form(contact, choice):
        message = f"contact '{name}': the closed form is for pyramids with four sides along the edges of the sole, got {choice}"
        raise InputError(message, name=name, field="sides")
    x, y = sole.half
    centred = _frictionless(x, y) if contact.frictionless else _rows(x, y, contact.friction * choice.slope_factor())
    to_centre = _to_centre(sole, vector(name, "point", point_C, 3))
    faces, equalities = (_scaled(np.array(rows, dtype=float).reshape(-1, 6) @ to_centre, unit) for rows in centred)
    if len(equalities):
        basis = np.linalg.qr((equalities * unit).T)[0].T
        inner = faces * unit
        faces = _scaled((inner - inner @ basis.T @ basis) / unit, unit)
        equalities = basis / unit
    return FaceForm(faces, equalities, float(length))


def _rows(x: float, y: float, mu: float) -> tuple[Sequence[Sequence[float]], Sequence[Sequence[float]]]:
    """Rows about the centre along the edges: (3.13), the tipping moments of (3.14), and its yaw limits."""
    signs = (1.0, -1.0)
    rows = [row for s in signs for row in ([s, 0, -mu, 0, 0, 0], [0, s, -mu, 0, 0, 0], [0, 0, -y, s, 0, 0], [0, 0, -x, 0, s, 0])]
    for turn, s, t in product(signs, signs, signs):
        # turn m_z + s (y f_x + turn mu m_x) + t (x f_y + turn mu m_y) <= mu (x + y) f_z
        rows.append([s * y, t * x, -mu * (x + y), turn * s * mu, turn * t * mu, turn])
    return rows, []


def _frictionless(x: float, y: float) -> tuple[Sequence[Sequence[float]], Sequence[Sequence[float]]]:
    rows = [row for s in (1.0, -1.0) for row in ([0, 0, -y, s, 0, 0], [0, 0, -x, 0, s, 0])]
    return rows, [[1, 0, 0, 0, 0, 0], [0, 1, 0, 0, 0, 0], [0, 0, 0, 0, 0, 1]]


def _to_centre(sole: Rectangle, point_C: Array) -> Array:
    """Matrix that takes a wrench about a point in contact axes to the centre of the sole in axes along its edges."""
    (c, s), centre = sole.axis, np.array([*sole.centre, 0.0])
    turned = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    T = np.eye(6)
    T[3:, :3] = skew(point_C - centre)
    return np.kron(np.eye(2), turned) @ T


def _scaled(rows: Array, unit: Array) -> Array:
    scaled: Array = rows / np.linalg.norm(rows * unit, axis=1, keepdims=True)
    return scaled
