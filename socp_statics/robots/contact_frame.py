"""What a robot can touch with: a contact frame fixed to a frame of its URDF."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from socp_statics.contacts import CONTACT_TYPES, Contact, contact_from_statement
from socp_statics.contacts.numbers import scalar, vector
from socp_statics.contacts.orientation import contact_rotation
from socp_statics.exceptions import InputError
from socp_statics.registry import nearest
from socp_statics.spatial import Array

WITHOUT_FRICTION = ("frictionless_point", "frictionless_surface", "handle")
SHAPE_KEYS = ("size", "vertices", "normal_force", "torsional_friction", "shape", "transmits", "limits")


@dataclass(frozen=True, eq=False)
class ContactFrame:
    """A contact frame C fixed to a frame F of the robot: columns t1, t2, n; n points from the environment into the robot.

    Args:
        name: Name of the contact, for example ``"left_foot"``.
        frame: Name of the URDF link (or other frame) F.
        type: The contract's word for the kind of contact, ``"surface"`` by default.
        size: Full lengths of a surface along t1 and t2, or the length of a line [m].
        vertices: Corners of a surface in the contact plane instead of ``size``, shape (k, 2) [m].
        position: Origin ``p_FC`` of the contact frame, in axes of F, shape (3,) [m]; zero by default.
        rotation: ``R_FC``, shape (3, 3); identity by default.
        extra: Other keys of that type of contact: normal_force, torsional_friction, shape, transmits, limits.

    Raises:
        InputError: A key is missing, not known for this type, or its value is wrong.
    """

    name: str
    frame: str
    type: str = "surface"
    size: Any = None
    vertices: Any = None
    position: Any = None
    rotation: Any = None
    extra: Mapping[str, Any] = field(default_factory=dict)
    _pattern: Contact = field(init=False, repr=False)

    def __post_init__(self) -> None:
        set_ = object.__setattr__
        if not isinstance(self.frame, str) or not self.frame:
            message = f"contact '{self.name}': frame must be the name of a link of the robot, got {self.frame!r}"
            raise InputError(message, name=str(self.name), field="frame")
        for key in self.extra:
            if key not in SHAPE_KEYS[2:]:
                message = f"contact '{self.name}': {key} is not a key of a contact frame{nearest(str(key), SHAPE_KEYS)}"
                raise InputError(message, name=self.name, field=str(key))
        set_(self, "position", vector(self.name, "position", np.zeros(3) if self.position is None else self.position, 3))
        rotation = np.eye(3) if self.rotation is None else contact_rotation(self.name, self.rotation, None, None)
        rotation.setflags(write=False)
        set_(self, "rotation", rotation)
        keys = {"size": self.size, "vertices": self.vertices, **self.extra}
        given = {key: value for key, value in keys.items() if value is not None}
        trial = {"name": self.name, "type": self.type, "position": self.position, "rotation": rotation} | given
        set_(self, "_pattern", contact_from_statement(trial if self.type in WITHOUT_FRICTION else trial | {"friction": 1.0}))
        set_(self, "extra", dict(self.extra))

    @classmethod
    def from_statement(cls, name: str, keys: Mapping[str, Any]) -> ContactFrame:
        """A contact frame from a table ``[posture.frames.<name>]``.

        Args:
            name: Name of the contact.
            keys: ``frame``, ``type``, the keys of that type, and optionally ``position`` and ``rotation`` relative to the frame.

        Raises:
            InputError: A key is missing, not known, or its value is wrong.
        """
        if not isinstance(keys, Mapping):
            raise InputError(f"contact '{name}': a table with frame and type is expected, got {keys!r}", name=name, field="frames")
        known = ("frame", "type", "position", "rotation", *SHAPE_KEYS)
        for key in keys:
            if key not in known:
                raise InputError(f"contact '{name}': {key} is not a key of a contact frame{nearest(str(key), known)}", name=name, field=key)
        for key, what in (("frame", "the name of a link of the robot"), ("type", f"one of {', '.join(CONTACT_TYPES)}")):
            if key not in keys:
                raise InputError(f"contact '{name}': {key} is missing, {what} is expected", name=name, field=key)
        own = {key: keys[key] for key in ("frame", "type", "size", "vertices", "position", "rotation") if key in keys}
        return cls(name, **own, extra={key: keys[key] for key in SHAPE_KEYS[2:] if key in keys})

    @property
    def at_a_point(self) -> bool:
        """Whether it touches at one point or grips there: what it touches then decides the axes, however the link is turned."""
        return len(self.points_C) == 1

    @property
    def points_C(self) -> Array:
        """Contact points in the contact plane, shape (k, 2) [m]."""
        return self._pattern.points_C

    def contact(self, R_WF: Array, p_WF: Array, friction: float | None = None, R_WC: Array | None = None) -> Contact:
        """The contact where the kinematics put its frame.

        Args:
            R_WF: Orientation of the URDF frame, shape (3, 3).
            p_WF: Its origin, world axes, shape (3,) [m].
            friction: Coulomb coefficient >= 0; not used by handles and frictionless types.
            R_WC: Orientation of the contact where the environment decides it, shape (3, 3).

        Returns:
            The contact at ``p_WC = p_WF + R_WF p_FC``, by default with ``R_WC = R_WF R_FC``.

        Raises:
            InputError: Friction is missing or wrong.
        """
        pattern = self._pattern
        mu = pattern.friction if self.type in WITHOUT_FRICTION else scalar(self.name, "friction", friction, least=0.0)
        return pattern.placed(p_WF + R_WF @ self.position, R_WF @ self.rotation if R_WC is None else R_WC, mu)

    def statement(self) -> dict[str, Any]:
        """The keys that state this frame again, as plain lists and numbers."""
        keys = {key: value for key, value in self._pattern.statement().items() if key not in ("name", "friction")}
        return {"frame": self.frame, **keys}
