"""What a figure draws of a record."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from socp_statics.cones.choice import KINDS, ConeChoice
from socp_statics.contacts import ContactSet, contact_from_statement
from socp_statics.contacts.stance import GRAVITY_W
from socp_statics.figures.draw_following import FollowingShape, following_in_record
from socp_statics.figures.region_shape import RegionShape, shape_in_record, shape_of_region
from socp_statics.figures.torque_use import JointTorque, torque_uses
from socp_statics.postures import Posture
from socp_statics.regions import SupportRegion
from socp_statics.spatial import Array


class Answer(NamedTuple):
    """What can be drawn of a record; world axes, SI.

    Attributes:
        contacts: The contacts.
        com: Centre of mass, shape (3,) [m].
        weight: Mass times gravity, shape (3,) [N].
        loads: External forces, entries of the stated posture.
        forces: Contact forces, entries of the record.
        motion: The certificate where it is a motion.
        shapes: Regions by the kind of their cones.
        asked: The region of the cones that were asked for.
        torques: Joint torques with their limits.
        posture: The robot, where there is one.
        following: How far the posture follows its centre of mass, where that was asked.
    """

    contacts: ContactSet
    com: Array
    weight: Array
    loads: list[dict[str, Any]]
    forces: list[Mapping[str, Any]]
    motion: Mapping[str, Any] | None
    shapes: dict[str, RegionShape]
    asked: RegionShape | None
    torques: list[JointTorque]
    posture: Posture | None
    following: FollowingShape | None

    @property
    def com_margin(self) -> float | None:
        """Margin of the centre of mass in the region of the cones that were asked for [m]."""
        return None if self.asked is None else self.asked.com_margin


def answer_of(record: Mapping[str, Any], regions: Mapping[str, SupportRegion] | None, posture: Posture | None = None) -> Answer:
    """What a record holds that can be drawn, with regions and the posture that were found beside it."""
    case = record["case"]
    generated, stated = case["generated"], case.get("posture", {})
    following = following_in_record(record)
    # beside a star of rays, pyramids would only be in the way of the region of the frozen posture
    shapes = {kind: shape_of_region(region) for kind, region in (regions or {}).items() if following is None}
    own = shape_in_record(record)
    if own is not None:
        shapes[own.cone.kind] = own
    cone = record["cone"]
    asked = own or next((s for s in shapes.values() if s.cone == ConeChoice(cone["kind"], cone["sides"], cone["heading"])), None)
    # A capability is drawn at its largest load, with the motion that stops more.
    limit = record.get("capability") or {}
    at_limit = bool(limit.get("beyond"))
    certificate = limit["beyond"] if at_limit else record.get("certificate") or {}
    loads = [w for w in stated.get("external_wrenches", []) if w.get("point") is not None and any(w.get("force", ()))]
    if at_limit:
        force = record["objective"] * limit["newtons"] * np.array(limit["direction"])
        loads += [{"force": force.tolist(), "point": limit["point"]}] if force.any() else []
    mass = float(generated["mass"])
    return Answer(
        contacts=ContactSet(contact_from_statement(entry) for entry in generated["contacts"]),
        com=np.array(generated["com"], dtype=float),
        weight=mass * np.array(stated.get("gravity", GRAVITY_W), dtype=float),
        loads=loads,
        forces=list((limit if at_limit else record).get("forces") or []),
        motion=certificate if certificate.get("kind") == "motion" else None,
        shapes={kind: shapes[kind] for kind in KINDS if kind in shapes},
        asked=asked,
        torques=torque_uses({**record, "torques": limit["torques"]} if at_limit else record) if record.get("torques") else [],
        posture=posture,
        following=following,
    )
