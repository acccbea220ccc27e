"""The scene of a question: what stays, and what follows the centre of mass."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from socp_statics.cases.record import Record
from socp_statics.contacts import Stance
from socp_statics.spatial import Array
from socp_statics.viewer.acting import acting
from socp_statics.viewer.body import body_extent, body_marks, struts
from socp_statics.viewer.contact_marks import cone_marks, contact_marks
from socp_statics.viewer.floor_marks import base_marks, com_marks, floor_height, region_marks
from socp_statics.viewer.force_marks import force_marks, force_scale, motion_marks
from socp_statics.viewer.marks import Arrows, Lines, Mark
from socp_statics.viewer.motion import CertifiedMotion, Placement, still_bodies
from socp_statics.viewer.question import Question

LAYERS = {
    "body": "robot",
    "contacts": "contacts",
    "cones": "friction cones",
    "forces": "forces",
    "region": "support region",
    "base": "base of support",
    "com": "centre of mass",
    "motion": "certified motion",
}


class Scene(NamedTuple):
    """The scene of a question.

    Attributes:
        origin: About which the scene is drawn, world axes, shape (3,) [m].
        extent: Diagonal of what it shows [m].
        floor: Height of the floor [m].
        still: What stays while the centre of mass moves.
        scale: Length of an arrow per newton [m/N].
    """

    origin: Array
    extent: float
    floor: float
    still: tuple[Mark, ...]
    scale: float


class Following(NamedTuple):
    """What follows the centre of mass.

    Attributes:
        com: The centre of mass, shape (3,) [m].
        bodies: Where the bodies are.
        marks: Arrows and lines; the same names every time, some of them empty.
        motion: The certified motion of an unstable answer, or of one whose load cannot be larger, else None.
    """

    com: Array
    bodies: dict[str, Placement]
    marks: tuple[Arrows | Lines, ...]
    motion: CertifiedMotion | None


def scene_of(question: Question) -> Scene:
    """The scene of a question, without what follows the centre of mass.

    Args:
        question: The question with its answer.
    """
    stance = question.stance
    shown = body_extent(stance)
    extent = float(np.linalg.norm(np.ptp(shown, axis=0)))
    extent = max(extent, stance.contacts.size if len(stance.contacts.points_W) > 1 else 0.0) or 1.0
    still = [
        *body_marks(stance, extent),
        *contact_marks(stance.contacts, extent),
        *cone_marks(stance.contacts, extent, question.problem.cone),
        *region_marks(question.region, stance.contacts, extent),
        *base_marks(stance.contacts, extent),
    ]
    acts = acting(stance, question.record)
    return Scene(
        origin=0.5 * (shown.min(axis=0) + shown.max(axis=0)),
        extent=extent,
        floor=floor_height(stance.contacts),
        still=tuple(still),
        scale=force_scale(acts.forces, acts.stance, extent),
    )


def following(scene: Scene, stance: Stance, record: Record) -> Following:
    """What follows the centre of mass, for one of its positions.

    Args:
        scene: The scene.
        stance: The stance with the centre of mass there.
        record: Its answer.
    """
    acts = acting(stance, record)
    motion = None if acts.motion is None else CertifiedMotion(acts.motion, stance)
    marks: list[Arrows | Lines] = [
        *com_marks(stance.com, stance.contacts, scene.extent),
        *force_marks(acts.forces, acts.stance, scene.extent, scene.scale),
        *motion_marks(motion, scene.extent),
    ]
    if stance.posture is None:
        marks.append(struts(stance))
    return Following(stance.com, still_bodies(stance), tuple(marks), motion)
