"""``[posture]`` with ``generator = "contacts"``: explicit contacts with a centre of mass and no robot."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from socp_statics.cases.dotted import key_text
from socp_statics.cases.statement import Matrix3, Pair, Statement, Vector3
from socp_statics.contacts import ContactSet, ExternalWrench, Stance, contact_from_statement
from socp_statics.exceptions import InputError

TYPES = "point, surface, line, soft_finger, frictionless_point, frictionless_surface, handle"

Position = Annotated[Vector3, Field(description="three finite numbers [m]")]
Rotation = Annotated[Matrix3 | None, Field(description="a 3 x 3 rotation matrix of finite numbers")]
NormalForce = Annotated[Pair | None, Field(description="[lo, hi] in N with 0 <= lo <= hi")]
Size = Annotated[list[float] | None, Field(description="a list of lengths > 0 [m]")]
Corner = Annotated[list[float], Field(min_length=2, max_length=2)]
Corners = Annotated[list[Corner] | None, Field(description="a list of points [x, y] of finite numbers [m]")]
Torsion = Annotated[float | None, Field(gt=0, description="a finite length > 0 [m]")]
Shape = Annotated[Literal["elliptic", "box"] | None, Field(description="'elliptic' or 'box'")]
Component = Literal["fx", "fy", "fz", "mx", "my", "mz"]
Transmits = Annotated[list[Component] | None, Field(description="a list of components of fx, fy, fz, mx, my, mz")]
Limits = Annotated[dict[str, Pair] | None, Field(description="a table of component = [lo, hi] in N or N m")]
Gravity = Annotated[Vector3, Field(description="three finite numbers [m/s^2]")]
GRAVITY = [0.0, 0.0, -9.81]


class ContactStatement(Statement):
    """An entry of ``[[posture.contacts]]``; which keys go with which type is known to the contact classes."""

    name: str = Field(min_length=1, description="a name, at least one letter")
    type: str = Field(description=f"one of {TYPES}")
    position: Position
    rotation: Rotation = None
    normal: Vector3 | None = Field(None, description="three finite numbers, not all zero")
    rpy: Vector3 | None = Field(None, description="three finite numbers [rad]")
    friction: float | None = Field(None, ge=0, description="a finite number >= 0")
    normal_force: NormalForce = None
    size: Size = None
    vertices: Corners = None
    torsional_friction: Torsion = None
    shape: Shape = None
    transmits: Transmits = None
    limits: Limits = None

    @model_validator(mode="after")
    def _is_a_contact(self) -> Self:
        contact_from_statement(self.stated())
        return self

    def stated(self) -> dict[str, Any]:
        """The contact as stated, with the default shape of a soft finger."""
        entry = super().stated()
        return entry | {"shape": entry.get("shape", "elliptic")} if self.type == "soft_finger" else entry


class ExternalWrenchStatement(Statement):
    """An entry of ``[[posture.external_wrenches]]``: a load on the robot, world axes."""

    force: Vector3 = Field([0.0, 0.0, 0.0], description="three finite numbers [N]")
    moment: Vector3 = Field([0.0, 0.0, 0.0], description="three finite numbers [N m]")
    point: Vector3 | None = Field(None, description="three finite numbers [m], world axes")

    @model_validator(mode="after")
    def _is_a_load(self) -> Self:
        ExternalWrench(**self.stated())
        return self


class ContactsPosture(Statement):
    """``generator = "contacts"``."""

    generator: Literal["contacts"] = Field(description="a posture generator")
    mass: float = Field(gt=0, description="a finite number > 0 [kg]")
    com: Vector3 = Field(description="three finite numbers [m], the centre of mass")
    gravity: Gravity = GRAVITY
    inertia: Matrix3 | None = Field(None, description="a symmetric positive definite 3 x 3 matrix of finite numbers [kg m^2]")
    contacts: list[ContactStatement] = Field(min_length=1, description="a list of at least one [[posture.contacts]]")
    external_wrenches: list[ExternalWrenchStatement] = Field([], description="a list of [[posture.external_wrenches]]")

    @model_validator(mode="after")
    def _is_a_stance(self) -> Self:
        names = [contact.name for contact in self.contacts]
        try:
            contacts_stance(self.stated())
        except InputError as error:
            if error.field == "name" and error.name in names:
                last = len(names) - 1 - names[::-1].index(error.name)
                raise InputError(str(error), name=error.name, field=key_text(("contacts", last, "name"))) from error
            raise
        return self

    def stated(self) -> dict[str, Any]:
        """The posture with defaults filled in."""
        contacts = [contact.stated() for contact in self.contacts]
        return super().stated() | {"contacts": contacts}


def contacts_stance(posture: dict[str, Any]) -> Stance:
    """The stance of a posture whose generator is "contacts".

    Args:
        posture: The table with defaults filled in.

    Raises:
        InputError: Contacts or loads contradict each other.
    """
    return Stance(
        ContactSet(contact_from_statement(entry) for entry in posture["contacts"]),
        com=posture["com"],
        mass=posture["mass"],
        gravity=posture["gravity"],
        external_wrenches=tuple(ExternalWrench(**entry) for entry in posture["external_wrenches"]),
        inertia=posture.get("inertia"),
    )
