"""``safety``: the verdict against an inner offset of the support region and of the base of support."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pydantic import Field

from socp_statics.cases.answers.answer import Parameters

if TYPE_CHECKING:
    from socp_statics.contacts import Stance

SAFETY_KEYS: dict[str, Any] = {"safety": {"offset": None, "in_region": None, "in_base": None}}


class SafetyParameters(Parameters):
    """``[parameters]`` of the models that may be asked for a safety zone."""

    safety: float | None = Field(None, ge=0, description="a finite length >= 0 [m]")


def safety_verdict(stance: Stance, com_margin: float | None, offset: float) -> dict[str, Any]:
    """Whether the CoM stays at least the offset away from the edges.

    Args:
        stance: The stance.
        com_margin: Distance of the CoM to the edge of the region, negative outside, None if the region is empty [m].
        offset: The inner offset [m].

    Returns:
        The record's ``safety``.
    """
    from socp_statics.regions import base_of_support

    base = base_of_support(stance.contacts)
    in_region = com_margin is not None and bool(com_margin >= offset)
    return {"offset": offset, "in_region": in_region, "in_base": bool(base.margin(stance.com[:2]) >= offset)}
