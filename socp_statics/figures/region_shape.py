"""What a figure needs of a region, whether it comes as an answer object or out of a record."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from socp_statics.cones.choice import ConeChoice
from socp_statics.figures.quantities import area_text, length_text
from socp_statics.regions import SupportRegion
from socp_statics.spatial import Array


class RegionShape(NamedTuple):
    """A support region, ready to be drawn.

    Attributes:
        kind: "polygon", "segment", "point", "empty" or "unbounded".
        inner: Attained corners, counter-clockwise, shape (k, 2) [m].
        outer: Corners of a polygon that contains the region, shape (l, 2) [m].
        rays: Directions in which it has no end, unit vectors, shape (r, 2).
        area: Of the inner polygon [m^2].
        com_margin: Margin of its own centre of mass [m], inf, or None where it is not known.
        cone: Exact cones or pyramids.
        frozen: Whether torque limits count, for one posture.
    """

    kind: str
    inner: Array
    outer: Array
    rays: Array
    area: float
    com_margin: float | None
    cone: ConeChoice
    frozen: bool = False

    @property
    def words(self) -> str:
        """What the legend says: cones and area, or the length of a segment."""
        exact = self.cone.kind == "exact"
        name = ("torque-limited region" if self.frozen else "exact region") if exact else f"{self.cone.kind}, {self.cone.sides} sides"
        if self.kind == "polygon":
            return f"{name}, {area_text(self.area)}"
        if self.kind == "segment":
            return f"{name}, {length_text(float(np.linalg.norm(self.inner[-1] - self.inner[0])))} long"
        return f"{name}, {'a point' if self.kind == 'point' else self.kind}"


def shape_of_region(region: SupportRegion) -> RegionShape:
    """The shape of an answer object."""
    return RegionShape(region.kind, region.inner, region.outer, region.rays, region.inner_area, region.com_margin, region.cone,
                       region.frozen)  # fmt: skip


def shape_in_record(record: Mapping[str, Any]) -> RegionShape | None:
    """The shape of a record's region, None where it has none."""
    region, cone = record.get("region"), record["cone"]
    if not region:
        return None
    margin = record.get("com_margin")
    inner, outer, rays = (np.array(region[key], dtype=float).reshape(-1, 2) for key in ("inner", "outer", "rays"))
    choice = ConeChoice(cone["kind"], cone["sides"], cone["heading"])
    return RegionShape(region["kind"], inner, outer, rays, region["inner_area"], None if margin is None else float(margin), choice,
                       region.get("posture") == "frozen")  # fmt: skip
