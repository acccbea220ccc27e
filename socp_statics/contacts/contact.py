"""Contacts: where the robot touches its environment, and what each touch can transmit.

The contact frame C has its origin at the contact's position, columns t1, t2 along the contact plane and n along the normal,
which points from the environment into the robot. Forces are reactions: environment on robot.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cached_property
from typing import Any, ClassVar, Self

import numpy as np

from socp_statics.contacts.numbers import interval, scalar, vector
from socp_statics.contacts.orientation import contact_rotation
from socp_statics.contacts.polygon import convex_polygon, rectangle
from socp_statics.exceptions import InputError
from socp_statics.spatial import Array

COMPONENTS = ("fx", "fy", "fz", "mx", "my", "mz")


class Contact:
    """What all contacts share; immutable.

    Attributes:
        name: Unique name within a ContactSet.
        type: The contract's word for the kind of contact.
        position: Origin of the contact frame ``p_WC``, world axes, shape (3,) [m].
        rotation: ``R_WC`` with columns t1, t2, n, shape (3, 3).
        friction: Coulomb coefficient, 0 for a frictionless contact.
        points_C: Contact points in the contact plane, shape (k, 2) [m].
        normal_force: Bounds ``(lo, hi)`` of the resultant normal force [N], or None.
    """

    type: ClassVar[str]
    unilateral: ClassVar[bool] = True
    _hard: tuple[str, ...] = ("fz",)
    _soft: ClassVar[tuple[str, ...]] = ("fx", "fy")
    name: str
    position: Array
    rotation: Array
    friction: float
    points_C: Array
    normal_force: tuple[float, float] | None

    def __init__(self, name: str, position: Any, rotation: Any, normal: Any, rpy: Any, friction: Any, normal_force: Any):
        if not isinstance(name, str) or not name:
            raise InputError(f"contact {name!r}: name must be a non-empty string", name=str(name), field="name")
        fixed = {
            "name": name,
            "position": vector(name, "position", position, 3),
            "rotation": contact_rotation(name, rotation, normal, rpy),
            "friction": scalar(name, "friction", friction, least=0.0),
            "normal_force": None if normal_force is None else interval(name, "normal_force", normal_force, least=0.0),
        }
        self._freeze(**fixed)

    def _freeze(self, **attributes: Any) -> None:
        for key, value in attributes.items():
            if isinstance(value, np.ndarray):
                value.setflags(write=False)
            object.__setattr__(self, key, value)

    def __setattr__(self, key: str, value: Any) -> None:
        raise AttributeError(f"a contact is immutable: cannot set {key!r} of '{self.name}'")

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.name!r}, position={self.position.tolist()}, friction={self.friction:g})"

    def placed(self, position: Array, rotation: Array, friction: float) -> Self:
        """The same contact somewhere else; placement and friction are taken as they are, checked and orthonormal."""
        other = object.__new__(type(self))
        position.setflags(write=False)
        rotation.setflags(write=False)
        other.__dict__.update(self.__dict__, position=position, rotation=rotation, friction=friction)
        return other

    @cached_property
    def structure(self) -> tuple[Any, ...]:
        """What does not change when the contact is placed elsewhere: its type, its points and its limits."""
        bounds = None if self.normal_force is None else "bounded"
        return (self.type, self.points_C.tobytes(), bounds, *self._shape_key())

    def _shape_key(self) -> tuple[Any, ...]:
        return ()

    @property
    def frictionless(self) -> bool:
        """True where only normal forces are transmitted."""
        return self.friction == 0.0

    @property
    def normal_W(self) -> Array:
        """Unit normal in world axes, shape (3,)."""
        return self.rotation[:, 2]

    @property
    def points_W(self) -> Array:
        """Contact points in world axes, shape (k, 3) [m]."""
        return self.position + self.points_C @ self.rotation[:, :2].T

    @property
    def hard(self) -> tuple[str, ...]:
        """Wrench components transmitted without slip, whatever the friction: the hard constraint directions."""
        return self._hard

    @property
    def soft(self) -> tuple[str, ...]:
        """Wrench components that stem from friction: the soft constraint directions."""
        return () if self.frictionless else self._soft

    def _shape(self) -> dict[str, Any]:
        """The keys that only this type of contact has."""
        return {}

    def statement(self) -> dict[str, Any]:
        """The contact as an entry of ``[[posture.contacts]]`` that can be stated again."""
        entry: dict[str, Any] = {
            "name": self.name,
            "type": self.type,
            "position": self.position.tolist(),
            "rotation": self.rotation.tolist(),
        }
        if self.type not in ("frictionless_point", "frictionless_surface", "handle"):
            entry["friction"] = self.friction
        if self.normal_force is not None:
            entry["normal_force"] = list(self.normal_force)
        return entry | self._shape()


class PointContact(Contact):
    """A point with Coulomb friction, (3.9)."""

    type = "point"

    def __init__(self, name: str, position: Any, rotation: Any = None, *, normal: Any = None, rpy: Any = None, friction: Any,
                 normal_force: Any = None):  # fmt: skip
        super().__init__(name, position, rotation, normal, rpy, friction, normal_force)
        self._freeze(points_C=np.zeros((1, 2)))


class FrictionlessPointContact(Contact):
    """A point that transmits its normal force only."""

    type = "frictionless_point"

    def __init__(self, name: str, position: Any, rotation: Any = None, *, normal: Any = None, rpy: Any = None, normal_force: Any = None):
        super().__init__(name, position, rotation, normal, rpy, 0.0, normal_force)
        self._freeze(points_C=np.zeros((1, 2)))


class SurfaceContact(Contact):
    """A flat convex sole; the forces at its corners span its wrench cone exactly.

    Args:
        size: Full lengths along t1 and t2 of a rectangle centred on the contact frame [m]; or
        vertices: Corners in the contact plane, convex, in order round it, shape (k, 2) [m].
    """

    type = "surface"
    _hard = ("fz", "mx", "my")
    _soft = ("fx", "fy", "mz")
    vertices: Array
    rectangle: tuple[float, float] | None

    def __init__(self, name: str, position: Any, rotation: Any = None, *, normal: Any = None, rpy: Any = None, friction: Any,
                 normal_force: Any = None, size: Any = None, vertices: Any = None):  # fmt: skip
        super().__init__(name, position, rotation, normal, rpy, friction, normal_force)
        if (size is None) == (vertices is None):
            had = "both" if size is not None else "none"
            raise InputError(f"contact '{name}': exactly one of size and vertices is expected, got {had}", name=name, field="size")
        if size is not None:
            lengths = vector(name, "size", size, 2)
            if (lengths <= 0).any():
                raise InputError(f"contact '{name}': size must be two lengths > 0, got {lengths.tolist()}", name=name, field="size")
            sides = (float(lengths[0]), float(lengths[1]))
            corners = rectangle(*sides)
        else:
            sides, corners = None, convex_polygon(name, vertices)
        self._freeze(points_C=corners, vertices=corners, rectangle=sides)

    def _shape(self) -> dict[str, Any]:
        return {"size": list(self.rectangle)} if self.rectangle else {"vertices": self.vertices.tolist()}


class FrictionlessSurfaceContact(SurfaceContact):
    """A flat sole without friction, (3.7): normal force and the two tangential moments."""

    type = "frictionless_surface"

    def __init__(self, name: str, position: Any, rotation: Any = None, *, normal: Any = None, rpy: Any = None,
                 normal_force: Any = None, size: Any = None, vertices: Any = None):  # fmt: skip
        super().__init__(name, position, rotation, normal=normal, rpy=rpy, friction=0.0, normal_force=normal_force, size=size,
                         vertices=vertices)  # fmt: skip


class LineContact(Contact):
    """An edge along t1; the forces at its two ends span its wrench cone exactly.

    Args:
        size: ``[length]``, full length along t1 [m].
    """

    type = "line"
    _hard = ("fz", "my")
    _soft = ("fx", "fy", "mz")
    length: float

    def __init__(self, name: str, position: Any, rotation: Any = None, *, normal: Any = None, rpy: Any = None, friction: Any,
                 normal_force: Any = None, size: Any):  # fmt: skip
        super().__init__(name, position, rotation, normal, rpy, friction, normal_force)
        length = float(vector(name, "size", np.atleast_1d(np.asarray(size, dtype=object)), 1)[0])
        if length <= 0:
            raise InputError(f"contact '{name}': size must be one length > 0, got {length:g}", name=name, field="size")
        self._freeze(points_C=np.array([[length / 2, 0.0], [-length / 2, 0.0]]), length=length)

    def _shape(self) -> dict[str, Any]:
        return {"size": [self.length]}


class SoftFingerContact(Contact):
    """A point that also transmits a moment about its normal, (3.11).

    Args:
        torsional_friction: gamma > 0 [m]: |m_z| <= gamma f_n.
        shape: ``"elliptic"`` couples force and moment, |(f_x, f_y, (mu/gamma) m_z)| <= mu f_n; ``"box"`` does not.
    """

    type = "soft_finger"
    _soft = ("fx", "fy", "mz")
    torsional_friction: float
    shape: str

    def __init__(self, name: str, position: Any, rotation: Any = None, *, normal: Any = None, rpy: Any = None, friction: Any,
                 normal_force: Any = None, torsional_friction: Any, shape: str = "elliptic"):  # fmt: skip
        super().__init__(name, position, rotation, normal, rpy, friction, normal_force)
        if shape not in ("elliptic", "box"):
            raise InputError(f"contact '{name}': shape must be 'elliptic' or 'box', got {shape!r}", name=name, field="shape")
        gamma = scalar(name, "torsional_friction", torsional_friction, above=0.0)
        self._freeze(points_C=np.zeros((1, 2)), torsional_friction=gamma, shape=shape)

    def _shape(self) -> dict[str, Any]:
        return {"torsional_friction": self.torsional_friction, "shape": self.shape}

    def _shape_key(self) -> tuple[Any, ...]:
        return (self.shape,)


class Handle(Contact):
    """A bilateral joint, for example a hand closed round a bar, (3.6).

    Args:
        transmits: Wrench components in the contact frame, of "fx", "fy", "fz", "mx", "my", "mz".
        limits: ``{component: (lo, hi)}``, forces [N], moments about the position [N m]; unlimited where absent.
    """

    type = "handle"
    unilateral = False
    transmits: tuple[str, ...]
    limits: dict[str, tuple[float, float]]

    def __init__(self, name: str, position: Any, rotation: Any = None, *, normal: Any = None, rpy: Any = None, transmits: Any,
                 limits: Any = None):  # fmt: skip
        super().__init__(name, position, rotation, normal, rpy, 0.0, None)
        words = [transmits] if isinstance(transmits, str) or not isinstance(transmits, Iterable) else list(transmits)
        unknown = [word for word in words if word not in COMPONENTS]
        if unknown or not words or len(set(words)) != len(words):
            what = f"got {unknown[0]!r}" if unknown else "got none" if not words else "one is named twice"
            message = f"contact '{name}': transmits must name components of {', '.join(COMPONENTS)}, {what}"
            raise InputError(message, name=name, field="transmits")
        if not isinstance(limits or {}, Mapping):
            raise InputError(f"contact '{name}': limits must be a table of component = [lo, hi], got {limits!r}", name=name, field="limits")
        bounds = {key: interval(name, f"limits.{key}", value) for key, value in (limits or {}).items()}
        for key in bounds:
            if key not in words:
                message = f"contact '{name}': limits.{key} limits a component that is not in transmits"
                raise InputError(message, name=name, field=f"limits.{key}")
        ordered = tuple(c for c in COMPONENTS if c in words)
        self._freeze(points_C=np.zeros((1, 2)), transmits=ordered, _hard=ordered, limits=bounds)

    def _shape(self) -> dict[str, Any]:
        limits = {"limits": {key: list(value) for key, value in self.limits.items()}} if self.limits else {}
        return {"transmits": list(self.transmits)} | limits

    def _shape_key(self) -> tuple[Any, ...]:
        return self.transmits


CONTACT_TYPES: dict[str, type[Contact]] = {
    cls.type: cls
    for cls in (PointContact, SurfaceContact, LineContact, SoftFingerContact, FrictionlessPointContact, FrictionlessSurfaceContact, Handle)
}


def contact_from_statement(statement: dict[str, Any]) -> Contact:
    """A contact from an entry of ``[[posture.contacts]]``.

    Args:
        statement: The keys of the contract; ``type`` chooses the class.

    Returns:
        The contact.

    Raises:
        InputError: A key is missing, not known for this type, or its value is wrong.
    """
    keys = dict(statement)
    name, kind = str(keys.pop("name", "")), keys.pop("type", None)
    if not isinstance(kind, str) or kind not in CONTACT_TYPES:
        raise InputError(f"contact '{name}': type must be one of {', '.join(CONTACT_TYPES)}, got {kind!r}", name=name, field="type")
    cls = CONTACT_TYPES[kind]
    if kind.startswith("frictionless") and keys.get("friction", 0) == 0:
        keys.pop("friction", None)
    code = cls.__init__.__code__
    known = set(code.co_varnames[2 : code.co_argcount + code.co_kwonlyargcount])
    for key in keys:
        if key not in known:
            raise InputError(f"contact '{name}': {key} is not a key of a {kind} contact", name=name, field=key)
    optional = {*(cls.__init__.__kwdefaults__ or {}), "name", "rotation", "return"}
    needed = [key for key in cls.__init__.__annotations__ if key not in optional]
    for key in needed:
        if key not in keys:
            raise InputError(f"contact '{name}': {key} is missing, a {kind} contact needs it", name=name, field=key)
    return cls(name, **keys)
