"""The text of a URDF: read once, its numbers checked where they stand, errors that name the file and the element."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from socp_statics.contacts.orientation import rotation_from_rpy
from socp_statics.exceptions import InputError
from socp_statics.registry import nearest
from socp_statics.spatial import Array


@dataclass(frozen=True)
class UrdfText:
    """A well-formed URDF.

    Attributes:
        file: The file as it was named, for error sentences.
        text: Its bytes, with line ends of one kind.
        root: The element ``<robot>``.
    """

    file: str
    text: bytes
    root: ElementTree.Element

    def wrong(self, element: str, sentence: str) -> InputError:
        """The error about one element, for example ``wrong("link 'foot'", "has a negative mass")``."""
        return InputError(f"robot file '{self.file}': {element} {sentence}", name=self.file, field=element)

    def numbers(self, element: str, tag: ElementTree.Element, key: str, count: int, default: str | None = None) -> Array:
        """The numbers of an attribute.

        Args:
            element: What the tag belongs to, for the error sentence.
            tag: The tag that has the attribute.
            key: The attribute.
            count: How many numbers are expected.
            default: Taken where the attribute is absent; without a default it must be there.

        Returns:
            Shape (count,).

        Raises:
            InputError: Absent, not that many, or not finite numbers.
        """
        words = "a finite number" if count == 1 else f"{count} finite numbers"
        written = tag.get(key, default)
        if written is None:
            raise self.wrong(element, f"has a <{tag.tag}> without {key}, {words} expected")
        try:
            values = np.array([float(word) for word in written.split()])
        except ValueError:
            values = np.array([np.nan])
        if len(values) != count or not np.isfinite(values).all():
            raise self.wrong(element, f"has a <{tag.tag}> whose {key} must be {words}, got {written!r}")
        return values

    def placement(self, element: str, parent: ElementTree.Element) -> tuple[Array, Array]:
        """Position [m], shape (3,), and rotation, shape (3, 3), of the ``<origin>`` in ``parent``; identity without one."""
        origin = parent.find("origin")
        if origin is None:
            return np.zeros(3), np.eye(3)
        position = self.numbers(element, origin, "xyz", 3, default="0 0 0")
        return position, rotation_from_rpy(self.numbers(element, origin, "rpy", 3, default="0 0 0"))


def read_urdf(path: str | Path) -> UrdfText:
    """Read a URDF.

    Args:
        path: The file.

    Returns:
        Its text and elements; nothing but the outermost element is checked yet.

    Raises:
        InputError: The file cannot be read, is not XML, or is not a URDF.
    """
    path, file = Path(path), str(path)

    def unreadable(sentence: str) -> InputError:
        return InputError(f"robot file '{file}' {sentence}", name=file, field="robot")

    try:
        text = path.read_bytes().replace(b"\r\n", b"\n")
    except FileNotFoundError as error:
        beside = sorted(other.name for other in path.parent.glob("*.urdf")) if path.parent.is_dir() else []
        near = nearest(path.name, beside)
        raise unreadable(f"does not exist{near if 'did you mean' in near else ', the path of a URDF is expected'}") from error
    except IsADirectoryError as error:
        raise unreadable("is a folder, a URDF file is expected") from error
    except (OSError, ValueError) as error:
        raise unreadable(f"cannot be read ({getattr(error, 'strerror', None) or error})") from error
    if not text.strip():
        raise unreadable("is empty, a URDF with the outermost element <robot> is expected")
    try:
        root = ElementTree.fromstring(text)
    except (ElementTree.ParseError, LookupError, ValueError) as error:
        raise unreadable(f"is not a URDF: as XML it is broken ({error})") from error
    own = root.tag.rpartition("}")[0] + "}" if root.tag.startswith("{") else ""
    for tag in root.iter():
        if isinstance(tag.tag, str) and "xacro}" in tag.tag:
            raise unreadable(f"is a xacro, <xacro:{tag.tag.rpartition('}')[2]}> must be expanded to plain URDF first")
        if own and isinstance(tag.tag, str):
            tag.tag = tag.tag.removeprefix(own)
    if root.tag != "robot":
        raise unreadable(f"is not a URDF: the outermost element must be <robot>, got <{root.tag}>")
    return UrdfText(file, text, root)
