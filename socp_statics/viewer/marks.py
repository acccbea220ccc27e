"""What a 3-D scene is made of: plain arrays with names, without any viewer; the page turns them into nodes.

A name is a path: a mark below a `Frame` is placed by it and has coordinates of that frame, all others have world coordinates.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from socp_statics.spatial import Array


class Frame(NamedTuple):
    """A body that moves as one.

    Attributes:
        name: Its path, for example ``"robot/LLEG_JOINT1"``.
        position: Of its origin, world axes, shape (3,) [m].
        rotation: Its axes in the world, shape (3, 3).
    """

    name: str
    position: Array
    rotation: Array


class Solid(NamedTuple):
    """A surface of triangles.

    Attributes:
        name: Its path.
        vertices: Shape (n, 3) [m].
        faces: Indices of vertices, counter-clockwise seen from outside, shape (m, 3).
        colour: As ``"#RRGGBB"``.
        opacity: 1 for a body, less for what others are seen through.
        flat: Whether faces keep their edges, as those of a box; else they are shaded as one smooth surface.
    """

    name: str
    vertices: Array
    faces: Array
    colour: str
    opacity: float = 1.0
    flat: bool = False


class Arrows(NamedTuple):
    """Vectors drawn to a scale.

    Attributes:
        name: Its path.
        tails: Where they start, shape (n, 3) [m].
        ways: From tail to head as drawn, shape (n, 3) [m].
        colour: As ``"#RRGGBB"``.
        thickness: Radius of the shafts [m].
    """

    name: str
    tails: Array
    ways: Array
    colour: str
    thickness: float


class Lines(NamedTuple):
    """Straight pieces of line.

    Attributes:
        name: Its path.
        pieces: From where to where, shape (n, 2, 3) [m].
        colour: As ``"#RRGGBB"``.
        pixels: Width on the screen.
    """

    name: str
    pieces: Array
    colour: str
    pixels: float = 2.0


class Name(NamedTuple):
    """A word beside a place.

    Attributes:
        name: Its path.
        text: The word.
        position: Shape (3,) [m].
    """

    name: str
    text: str
    position: Array


Mark = Frame | Solid | Arrows | Lines | Name


def path(*parts: str) -> str:
    """The name of a mark from its parts, which may be called anything: a slash in one of them does not part it."""
    return "/".join(part.replace("/", "|") for part in parts)


def closed(corners: Array) -> Array:
    """The pieces of a closed line through corners, shape (k, 3) -> (k, 2, 3)."""
    return np.stack([corners, np.roll(corners, -1, axis=0)], axis=1)


def dashed(pieces: Array, dash: float) -> Array:
    """Lines cut into dashes with gaps as long as these; every line begins and ends with a dash.

    Args:
        pieces: Shape (n, 2, 3) [m].
        dash: About how long a dash is [m].

    Returns:
        Shape (m, 2, 3) [m].
    """
    out = []
    for start, end in pieces:
        count = 2 * max(int(np.linalg.norm(end - start) / (2.0 * dash)), 0) + 1
        at = np.linspace(0.0, 1.0, count + 1)
        ends = start + at[:, None] * (end - start)
        out += [ends[k : k + 2] for k in range(0, count, 2)]
    return np.array(out).reshape(-1, 2, 3)
