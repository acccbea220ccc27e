"""The meshes among a URDF's visuals, as far as their files are at hand; for viewing only."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from socp_statics.robots.urdf_text import UrdfText
from socp_statics.spatial import Array

PACKAGE = "package://"


@dataclass(frozen=True, eq=False)
class Mesh:
    """One mesh fixed to a link.

    Attributes:
        link: Name of the link (a frame of the Pinocchio model).
        file: Its file, which exists.
        scale: Of its coordinates along its own axes, shape (3,).
        position: Origin of the mesh in axes of the link, shape (3,) [m].
        rotation: Axes of the mesh in axes of the link, shape (3, 3).
    """

    link: str
    file: Path
    scale: Array
    position: Array
    rotation: Array


def mesh_visuals(urdf: UrdfText) -> tuple[Mesh, ...]:
    """The meshes of a URDF whose files are found, in the order of its links.

    A relative name starts at the folder of the URDF; ``package://name/rest`` is looked for in a folder called ``name`` that holds the
    URDF, or beside one that does.

    Args:
        urdf: A URDF whose links have names.

    Returns:
        The meshes; those whose files are not there are left out.

    Raises:
        InputError: A scale or placement is not made of finite numbers.
    """
    found = []
    for link in urdf.root.findall("link"):
        element = f"link '{link.get('name')}'"
        for visual in link.findall("visual"):
            mesh = visual.find("geometry/mesh")
            file = None if mesh is None else _file(mesh.get("filename", ""), Path(urdf.file).resolve().parent)
            if mesh is not None and file is not None:
                scale = urdf.numbers(element, mesh, "scale", 3, default="1 1 1")
                found.append(Mesh(link.get("name", ""), file, scale, *urdf.placement(element, visual)))
    return tuple(found)


def _file(name: str, folder: Path) -> Path | None:
    return next((path for path in _places(name, folder) if path.is_file()), None)


def _places(name: str, folder: Path) -> Iterator[Path]:
    if not name.startswith(PACKAGE):
        yield folder / name.removeprefix("file://")
        return
    package, _, rest = name.removeprefix(PACKAGE).partition("/")
    for above in (folder, *folder.parents):
        yield above / package / rest
        if above.name == package:
            yield above / rest
