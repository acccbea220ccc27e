"""``[posture]`` with ``generator = "random_contacts"``: seeded random contacts of a family and no robot."""

from __future__ import annotations

from functools import lru_cache
from typing import Any, Literal

from pydantic import Field, field_validator

from socp_statics.cases.posture_statements import GRAVITY, ExternalWrenchStatement, Gravity
from socp_statics.cases.statement import Statement
from socp_statics.contacts import ContactSet, ExternalWrench, Stance
from socp_statics.contacts.random_contacts import FAMILIES, FRICTION, SLOPE, checked_family, random_contacts

# a case of a sweep asks for its stance several times
_drawn = lru_cache(maxsize=64)(random_contacts)


class RandomContactsPosture(Statement):
    """``generator = "random_contacts"``: a family and a seed, and what is not to be drawn."""

    generator: Literal["random_contacts"] = Field(description="a posture generator")
    family: str = Field(description=f"one of {', '.join(FAMILIES)}")
    seed: int = Field(ge=0, description="a whole number >= 0")
    friction: float | None = Field(None, ge=0, description=f"a finite number >= 0; drawn between {FRICTION[0]} and {FRICTION[1]} without")
    slope: float | None = Field(None, ge=0, lt=1.5, description=f"an angle from 0 to 1.5 [rad]; drawn between 0 and {SLOPE[1]} without")
    mass: float = Field(60.0, gt=0, description="a finite number > 0 [kg]")
    gravity: Gravity = GRAVITY
    external_wrenches: list[ExternalWrenchStatement] = Field([], description="a list of [[posture.external_wrenches]]")

    @field_validator("family")
    @classmethod
    def _is_a_family(cls, value: str) -> str:
        return checked_family(value)


def random_stance(posture: dict[str, Any]) -> Stance:
    """The stance of a posture whose generator is "random_contacts".

    Args:
        posture: The table with defaults filled in.

    Raises:
        InputError: There is no such family.
    """
    contacts, com = _drawn(posture["family"], posture["seed"], posture.get("friction"), posture.get("slope"))
    wrenches = tuple(ExternalWrench(**entry) for entry in posture["external_wrenches"])
    return Stance(ContactSet(contacts), com, posture["mass"], posture["gravity"], wrenches)
