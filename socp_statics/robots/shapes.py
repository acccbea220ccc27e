"""Primitive shapes of a robot, for drawing and viewing: the boxes, cylinders and spheres among its URDF's visuals."""

from __future__ import annotations

from dataclasses import dataclass

from socp_statics.robots.urdf_text import UrdfText
from socp_statics.spatial import Array

PRIMITIVES = {"box": (("size", 3),), "cylinder": (("radius", 1), ("length", 1)), "sphere": (("radius", 1),)}


@dataclass(frozen=True, eq=False)
class Shape:
    """One primitive shape fixed to a link.

    Attributes:
        link: Name of the link (a frame of the Pinocchio model).
        kind: ``"box"``, ``"cylinder"`` (axis along its z) or ``"sphere"``.
        size: Full lengths (x, y, z) of a box, (radius, length) of a cylinder, (radius,) of a sphere [m].
        position: Centre of the shape in axes of the link, shape (3,) [m].
        rotation: Axes of the shape in axes of the link, shape (3, 3).
    """

    link: str
    kind: str
    size: tuple[float, ...]
    position: Array
    rotation: Array


def primitive_shapes(urdf: UrdfText) -> tuple[Shape, ...]:
    """The primitive shapes of a URDF, in the order of its links; meshes are left out.

    Args:
        urdf: A URDF whose links have names.

    Returns:
        The shapes.

    Raises:
        InputError: A size or placement is not made of finite numbers, or a size is not > 0.
    """
    found = []
    for link in urdf.root.findall("link"):
        element = f"link '{link.get('name')}'"
        for visual in link.findall("visual"):
            for kind, lengths in PRIMITIVES.items():
                primitive = visual.find(f"geometry/{kind}")
                if primitive is None:
                    continue
                size = tuple(float(x) for key, count in lengths for x in urdf.numbers(element, primitive, key, count))
                if min(size) <= 0:
                    raise urdf.wrong(element, f"visual {kind} must have sizes > 0, got {list(size)}")
                found.append(Shape(link.get("name", ""), kind, size, *urdf.placement(element, visual)))
    return tuple(found)
