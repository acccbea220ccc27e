"""What acts in an answer: the forces and the motion that are drawn."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from socp_statics.contacts import ExternalWrench, Stance


class Acting(NamedTuple):
    """What acts on a stance.

    Attributes:
        stance: The stance with all its loads.
        forces: Contact forces, entries of the record: "point" [m] and "force" [N].
        motion: The certificate where it is a motion, else None.
    """

    stance: Stance
    forces: Sequence[Mapping[str, Any]]
    motion: Mapping[str, Any] | None


def acting(stance: Stance, record: Mapping[str, Any]) -> Acting:
    """What acts in an answer; in that of a capability at its largest load, with the motion that stops more.

    Args:
        stance: The stance.
        record: Its answer.
    """
    limit = record.get("capability") or {}
    if not limit.get("beyond"):
        certificate = record["certificate"] or {}
        return Acting(stance, record["forces"], certificate if certificate.get("kind") == "motion" else None)
    force = record["objective"] * limit["newtons"] * np.array(limit["direction"])
    load = ExternalWrench(force=force, point=limit["point"])
    return Acting(replace(stance, external_wrenches=(*stance.external_wrenches, load)), limit["forces"], limit["beyond"])
