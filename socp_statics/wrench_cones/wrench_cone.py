"""A wrench cone: the sum of the cones of point forces, each with its lever arm, and of what handles transmit."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.cones.choice import ConeChoice
from socp_statics.exceptions import EngineError, InputError
from socp_statics.spatial import Array
from socp_statics.wrench_cones.double_description import extreme_rays, face_form
from socp_statics.wrench_cones.forms import FaceForm, SpanForm, units, vectors
from socp_statics.wrench_cones.generators import Generators
from socp_statics.wrench_cones.nearest_point import nearest_point


class Consistency(NamedTuple):
    """Whether a wrench can be exerted by the contacts, and what says so.

    Attributes:
        consistent: Whether the wrench lies in the (closed) cone.
        distance: From the cone, ``|(f, m / length)|``, 0 inside [N].
        separating: Where it is outside, a twist y with ``y . F > 0`` and ``y . G <= 0`` for every wrench G of the cone, of unit
            length in the dual norm, shape (6,); else None.
        by: "faces" where the face form was looked at, "support" where a supporting plane was sought instead.
        why: Why there is no face form to look at, or None.
    """

    consistent: bool
    distance: float
    separating: Array | None
    by: str
    why: str | None


@dataclass(frozen=True, eq=False)
class WrenchCone:
    """All wrenches that forces inside their friction cones add up to; convex, closed, apex at zero.

    The exact cone has no finite number of faces: it is known through the forces at the contact points, of which a sole's corners
    and a line's ends span it without loss. A cone over pyramids has faces and rays.

    Wrenches are ``[force; moment]`` in the axes and about the point that the cone was built for, and are measured by
    ``|(f, m / length)|`` [N].

    Attributes:
        generators: The point forces and handle components that span the cone.
        choice: Exact cones or pyramids.
        length: Length that moments are divided by [m].
        contacts: Names of the contacts.
        closed_form: Its faces, where a formula has them.
    """

    generators: Generators = field(repr=False)
    choice: ConeChoice
    length: float
    contacts: tuple[str, ...]
    closed_form: FaceForm | None = field(default=None, repr=False)

    @property
    def is_exact(self) -> bool:
        """Whether friction cones are exact; without friction every cone is."""
        return self.choice.is_exact and not self.generators.polyhedral

    def support(self, direction: ArrayLike) -> float | Array:
        """Support function of the section of unit normal force: the largest ``y . F`` where all normal forces add up to 1 N.

        The support function of the cone itself says only 0 or inf; this one is its polar cone's signed measure: a twist y does work
        <= 0 on every wrench of the cone if and only if this is <= 0. Closed form, exact for exact cones.

        Args:
            direction: Twists y, shape (6,) or (n, 6).

        Returns:
            One float or shape (n,) [N times the unit of y]; inf where a handle lets ``y . F`` grow alone, -inf where only handles
            are there and hold none of it.

        Raises:
            InputError: Wrong shape (field ``direction``).
        """
        y = vectors(direction, 6, "direction")
        values = np.array([self.generators.support(row) for row in np.atleast_2d(y)])
        return values if y.ndim == 2 else float(values[0])

    def project(self, wrench: ArrayLike) -> Array:
        """The nearest wrench of the cone in the norm ``|(f, m / length)|``.

        Args:
            wrench: Shape (6,) or (n, 6) [N, N m].

        Returns:
            Same shape.

        Raises:
            InputError: Wrong shape (field ``wrench``).
            EngineError: The projection did not converge.
        """
        F = vectors(wrench, 6)
        unit = units(6, self.length)
        nearest = np.array([nearest_point(self._scaled, row / unit) * unit for row in np.atleast_2d(F)])
        return nearest if F.ndim == 2 else np.asarray(nearest[0])

    def distance(self, wrench: ArrayLike) -> float | Array:
        """Distance ``|(f, m / length)|`` from the cone, 0 inside.

        Args:
            wrench: Shape (6,) or (n, 6) [N, N m].

        Returns:
            One float or shape (n,) [N].

        Raises:
            InputError: Wrong shape (field ``wrench``).
            EngineError: The projection did not converge.
        """
        F = vectors(wrench, 6)
        away = np.linalg.norm((F - self.project(F)) / units(6, self.length), axis=-1)
        return away if F.ndim == 2 else float(away)

    def contains(self, wrench: ArrayLike, tolerance: float = 1e-8) -> bool | np.ndarray:
        """Whether wrenches lie in the (closed) cone.

        Args:
            wrench: Shape (6,) or (n, 6) [N, N m].
            tolerance: Distance outside that is still accepted, as a share of ``|(f, m / length)|``, >= 0.

        Returns:
            One bool or shape (n,).

        Raises:
            InputError: Wrong shape or tolerance (fields ``wrench``, ``tolerance``).
            EngineError: The projection did not converge.
        """
        F = vectors(wrench, 6)
        allowed = _checked_share(tolerance) * np.linalg.norm(F / units(6, self.length), axis=-1)
        inside = np.asarray(self.distance(F)) <= allowed
        return inside if F.ndim == 2 else bool(inside)

    def faces(self) -> FaceForm:
        """The face form: closed where there is a formula, else by double description.

        Returns:
            Rows so long that ``U F`` is the distance from the face [N].

        Raises:
            InputError: The cone is exact, has too many rays, or the extra ``[cdd]`` is missing.
            EngineError: The cone is too degenerate for double description.
        """
        return self._face_form if self.closed_form is None else self.closed_form

    def spans(self) -> SpanForm:
        """The span form: extreme rays only, of unit length in ``|(f, m / length)|``, and lines.

        Returns:
            The rays that the faces meet in.

        Raises:
            InputError: The cone is exact, has too many rays, or the extra ``[cdd]`` is missing.
            EngineError: The cone is too degenerate for double description.
        """
        return extreme_rays(self.generators.rays(), self.faces())

    def consistency(self, wrench: ArrayLike, tolerance: float = 1e-8) -> Consistency:
        """Whether a wrench is contact-consistent, by faces where the cone has them, else by a supporting plane.

        Double description is the wrong tool for exact cones, for very many rays and for degenerate cones; then, as without the extra
        ``[cdd]``, the plane that separates the wrench is found from the nearest point of the cone, and `why` says so. Data are never
        perturbed.

        Args:
            wrench: Shape (6,) [N, N m].
            tolerance: As in `contains`.

        Returns:
            The answer.

        Raises:
            InputError: Wrong shape or tolerance (fields ``wrench``, ``tolerance``).
            EngineError: The projection did not converge.
        """
        F = vectors(wrench, 6)
        if F.ndim != 1:
            raise InputError(f"wrench must have the shape (6,), got {F.shape}", field="wrench")
        unit = units(6, self.length)
        rest = (F - self.project(F)) / unit
        distance, allowed = float(np.linalg.norm(rest)), _checked_share(tolerance) * float(np.linalg.norm(F / unit))
        try:
            form, why = self.faces(), None
        except (InputError, EngineError) as error:
            form, why = None, str(error)
        consistent = distance <= allowed if form is None else bool(form.excess(F) <= allowed)
        separating = None if consistent or distance == 0.0 else rest / distance / unit
        return Consistency(consistent, 0.0 if consistent else distance, separating, "support" if form is None else "faces", why)

    @cached_property
    def _scaled(self) -> Generators:
        return self.generators.scaled(units(6, self.length))

    @cached_property
    def _face_form(self) -> FaceForm:
        if self.is_exact:
            message = "cone must be inscribed or circumscribed to have faces, got 'exact': the exact wrench cone is round"
            raise InputError(message, field="cone")
        return face_form(self.generators.rays(), self.generators.lines, length=self.length)


def _checked_share(tolerance: object) -> float:
    if isinstance(tolerance, bool) or not isinstance(tolerance, int | float | np.floating) or not 0.0 <= float(tolerance) < np.inf:
        raise InputError(f"tolerance must be a finite number >= 0, got {tolerance!r}", field="tolerance")
    return float(tolerance)
