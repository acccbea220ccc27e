"""Space seen from an angle: parallel projection, so that equal lengths along one direction stay equal, and its three axes with a length."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from socp_statics.figures.marks import add_arrow
from socp_statics.figures.style import GREY
from socp_statics.spatial import Array

NAME = 1.22


class Axonometry(NamedTuple):
    """A parallel projection along a direction.

    Attributes:
        right: Unit vector that the drawing shows to the right, shape (3,).
        up: Unit vector that it shows upwards, shape (3,).
        toward: Unit vector to the reader, shape (3,).
    """

    right: Array
    up: Array
    toward: Array

    def flat(self, points: ArrayLike) -> Array:
        """Where points are on the drawing, shape (..., 3) -> (..., 2)."""
        return np.asarray(points, dtype=float) @ np.column_stack([self.right, self.up])


def seen_from(azimuth: float, elevation: float) -> Axonometry:
    """The projection for a reader who looks at the origin.

    Args:
        azimuth: Of the reader, from x to y [rad].
        elevation: Of the reader above the x-y plane, below pi/2 [rad].

    Returns:
        The projection; z is upright.
    """
    c, s = np.cos(azimuth), np.sin(azimuth)
    toward = np.array([c * np.cos(elevation), s * np.cos(elevation), np.sin(elevation)])
    right = np.array([-s, c, 0.0])
    return Axonometry(right, np.cross(toward, right), toward)


def add_axes_of_space(ax: Axes, view: Axonometry, origin: ArrayLike, lengths: ArrayLike, names: tuple[str, str, str]) -> Array:
    """Add three arrows along the axes, with names.

    Args:
        ax: The axes.
        view: The projection.
        origin: Where they start, shape (3,).
        lengths: Of the arrows, shape (3,).
        names: At their heads.

    Returns:
        The places of the names on the drawing, shape (3, 2).
    """
    start, places = np.asarray(origin, dtype=float), []
    for axis, length, name in zip(np.eye(3), np.asarray(lengths, dtype=float), names, strict=True):
        add_arrow(ax, view.flat(start), view.flat(start + length * axis), head_size=5.0, color=GREY, linewidth=0.7, zorder=1.0)
        places.append(view.flat(start + NAME * length * axis))
        ax.text(float(places[-1][0]), float(places[-1][1]), name, ha="center", va="center", fontsize=6.5, color=GREY, zorder=1.0)
    return np.array(places)
