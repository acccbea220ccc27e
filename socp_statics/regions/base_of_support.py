"""The base of support: the hull of the contact points, seen from above; geometry only."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial import ConvexHull, QhullError

from socp_statics.contacts import Contact, ContactSet
from socp_statics.contacts.stance import as_contact_set
from socp_statics.regions import polygon
from socp_statics.regions.polygon import NARROW
from socp_statics.spatial import Array


@dataclass(frozen=True, eq=False)
class BaseOfSupport:
    """Hull of the contact points on the floor plan.

    Attributes:
        kind: "polygon", "segment" or "point".
        vertices: Counter-clockwise corners, shape (k, 2) [m].
    """

    kind: str
    vertices: Array

    @property
    def area(self) -> float:
        """Area, 0 unless it is a polygon [m^2]."""
        return polygon.area(self.vertices) if self.kind == "polygon" else 0.0

    def margin(self, xy: ArrayLike) -> Any:
        """Distance of positions, shape (..., 2), to the edge, minus the distance outside, shape (...) [m]."""
        return polygon.distance(self.vertices, xy)

    def contains(self, xy: ArrayLike) -> Any:
        """Whether positions, shape (..., 2), are inside or on the edge; booleans, shape (...)."""
        return self.margin(xy) >= 0.0


def base_of_support(contacts: ContactSet | Iterable[Contact]) -> BaseOfSupport:
    """The base of support of a set of contacts.

    Args:
        contacts: The contacts.

    Returns:
        A polygon; a segment or a point where the contact points are narrower than 1e-9 of their size.
    """
    contact_set = as_contact_set(contacts)
    points = contact_set.points_W[:, :2]
    centre, size = contact_set.centre[:2], contact_set.size
    local = (points - centre) / size
    away = np.linalg.norm(local[:, None] - local[None], axis=2)
    i, j = np.unravel_index(int(np.argmax(away)), away.shape)
    if away[i, j] < NARROW:
        return BaseOfSupport("point", points[:1].copy())
    try:
        hull = ConvexHull(local).vertices
    except QhullError:
        return BaseOfSupport("segment", points[[i, j]])
    if polygon.width(local[hull]) < NARROW:
        return BaseOfSupport("segment", points[[i, j]])
    return BaseOfSupport("polygon", points[hull])
