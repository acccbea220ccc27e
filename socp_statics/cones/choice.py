"""Which cone a question is asked with: the exact one, or a pyramid inside or outside it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from numbers import Real

import numpy as np
from numpy.typing import NDArray

from socp_statics.exceptions import InputError

Array = NDArray[np.float64]

KINDS = ("exact", "inscribed", "circumscribed")


@dataclass(frozen=True)
class ConeChoice:
    """The exact friction cone, or one of its pyramids.

    Face j of a pyramid has the outward normal ``n_j = (cos a_j, sin a_j)`` in the contact plane, ``a_j = heading + 2 pi j / sides``.

    Args:
        kind: ``"exact"``, ``"inscribed"`` (never accepts a force that slides) or ``"circumscribed"`` (accepts some that do).
        sides: Number of faces, whole and at least 3; 4 when not given. Ignored and None for the exact cone.
        heading: Angle from t1 to the normal of the first face [rad]; 0 when not given. Ignored and None for the exact cone.

    Raises:
        InputError: Unknown kind (field ``cone``), or a wrong ``sides`` or ``heading``.
    """

    kind: str = "exact"
    sides: int | None = None
    heading: float | None = None

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise InputError(f"cone must be one of {', '.join(KINDS)}, got {self.kind!r}", field="cone")
        exact = self.kind == "exact"
        # A frozen dataclass offers no other way to store what was validated.
        object.__setattr__(self, "sides", None if exact else _whole_sides(4 if self.sides is None else self.sides))
        object.__setattr__(self, "heading", None if exact else _finite_heading(0.0 if self.heading is None else self.heading))

    @property
    def is_exact(self) -> bool:
        """Whether the cone is the exact one."""
        return self.kind == "exact"

    def as_record(self) -> dict[str, str | int | float | None]:
        """The ``cone`` entry of a record: kind, sides and heading [rad]."""
        return {"kind": self.kind, "sides": self.sides, "heading": self.heading}

    def face_normals(self) -> Array:
        """Outward normals of the faces in the contact plane.

        Returns:
            Unit rows ``(cos a_j, sin a_j)``, shape (sides, 2), in contact axes t1, t2.

        Raises:
            InputError: The cone is exact and has no faces.
        """
        sides, heading = self._pyramid()
        return _directions(heading + 2.0 * np.pi * np.arange(sides) / sides)

    def edge_directions(self) -> Array:
        """Directions of the edges in the contact plane; edge j lies between the faces j and j + 1.

        Returns:
            Unit rows at the angles ``a_j + pi / sides``, shape (sides, 2), in contact axes t1, t2.

        Raises:
            InputError: The cone is exact and has no edges.
        """
        sides, heading = self._pyramid()
        return _directions(heading + 2.0 * np.pi * (np.arange(sides) + 0.5) / sides)

    def slope_factor(self) -> float:
        """Slope of a face over the friction coefficient: ``cos(pi / sides)`` inscribed, 1 circumscribed.

        Raises:
            InputError: The cone is exact and has no faces.
        """
        sides, _ = self._pyramid()
        return math.cos(math.pi / sides) if self.kind == "inscribed" else 1.0

    def _pyramid(self) -> tuple[int, float]:
        if self.sides is None or self.heading is None:
            raise InputError("cone must be inscribed or circumscribed to have faces, got 'exact'", field="cone")
        return self.sides, self.heading


def cone_choice(cone: str | ConeChoice, sides: int | None = None, heading: float | None = None) -> ConeChoice:
    """The cone of a question's arguments.

    Args:
        cone: A ConeChoice, or its kind.
        sides: Number of faces, where the kind is given.
        heading: Heading [rad], where the kind is given.

    Returns:
        The choice.

    Raises:
        InputError: An unknown kind, or a wrong ``sides`` or ``heading``.
    """
    if isinstance(cone, ConeChoice):
        return cone
    return EXACT if cone == "exact" and sides is None and heading is None else ConeChoice(cone, sides, heading)


EXACT = ConeChoice()


def _whole_sides(sides: object) -> int:
    number = float(sides) if isinstance(sides, Real) and not isinstance(sides, bool) else math.nan
    if not number.is_integer() or number < 3.0:
        raise InputError(f"sides must be a whole number >= 3, got {sides!r}", field="sides")
    return int(number)


def _finite_heading(heading: object) -> float:
    if isinstance(heading, bool) or not isinstance(heading, Real) or not math.isfinite(float(heading)):
        raise InputError(f"heading must be a finite angle in radians, got {heading!r}", field="heading")
    return float(heading)


def _directions(angles: Array) -> Array:
    directions = np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    # The rounded cos(pi/2) would tilt the faces of the four-sided pyramid of the chapter by 6e-17.
    directions[np.abs(directions) < 4.0 * np.finfo(float).eps] = 0.0
    return directions
