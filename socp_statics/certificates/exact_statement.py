"""What a proof is about: a stance as rational numbers, ready for the verifier."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np

from socp_statics.cones.choice import ConeChoice
from socp_statics.contacts import Contact, Handle, SoftFingerContact, Stance
from socp_statics.statics.joint_torques import passive_torque


def rationals(value: Any) -> Any:
    """Numbers as the texts "p/q" of a proof file, exactly: a float is a rational; infinite ends become None.

    Args:
        value: A number, or nested sequences or arrays of numbers.
    """
    if isinstance(value, Fraction):
        return str(value)
    if isinstance(value, float | int | np.floating | np.integer):
        return str(Fraction(float(value))) if np.isfinite(value) else None
    return [rationals(entry) for entry in value]


def exact_statement(stance: Stance, cone: ConeChoice) -> dict[str, Any]:
    """The statement of a proof file.

    The model is that of the floats: rotation matrices, face normals and the factor of the slope of a pyramid are taken as they are in
    memory, neither orthonormal nor cosines to the last bit. Joints are those whose torque is limited.

    Args:
        stance: The stance; with torque limits its posture brings Jacobians and passive torques (gravity less external wrenches).
        cone: Exact cones or pyramids.
    """
    kind: dict[str, Any] = {"kind": cone.kind}
    if not cone.is_exact:
        kind |= {"faces": rationals(cone.face_normals()), "slope": rationals(cone.slope_factor())}
    wrenches = [
        {"force": rationals(w.force), "moment": rationals(w.moment), "point": rationals(np.zeros(3) if w.point is None else w.point)}
        for w in stance.external_wrenches
    ]
    return {
        "contacts": [_contact(contact) for contact in stance.contacts],
        "cone": kind,
        "com": rationals(stance.com),
        "mass": rationals(stance.mass),
        "gravity": rationals(stance.gravity),
        "external_wrenches": wrenches,
        "joints": _joints(stance),
    }


def limited_joints(stance: Stance) -> list[int]:
    """Indices of the joints whose torque is limited."""
    return [] if stance.torque_limits is None else np.flatnonzero(np.isfinite(stance.torque_limits).any(axis=1)).tolist()


def _contact(contact: Contact) -> dict[str, Any]:
    table: dict[str, Any] = {
        "name": contact.name,
        "type": contact.type,
        "position": rationals(contact.position),
        "rotation": rationals(contact.rotation),
    }
    if isinstance(contact, Handle):
        limits = [contact.limits.get(word, (-np.inf, np.inf)) for word in contact.transmits]
        return table | {"transmits": list(contact.transmits), "limits": rationals(limits)}
    table |= {"points": rationals(contact.points_C), "friction": rationals(contact.friction)}
    if isinstance(contact, SoftFingerContact):
        table |= {"torsional_friction": rationals(contact.torsional_friction), "shape": contact.shape}
    return table | ({} if contact.normal_force is None else {"normal_force": rationals(contact.normal_force)})


def _joints(stance: Stance) -> dict[str, Any]:
    joints = limited_joints(stance)
    if not joints:
        return {"names": [], "limits": [], "passive": [], "jacobians": {}}
    posture = stance.posture
    return {
        "names": [posture.robot.joints[k] for k in joints],
        "limits": rationals(stance.torque_limits[joints]),  # type: ignore[index]
        "passive": rationals(passive_torque(stance)[joints]),
        "jacobians": {c.name: rationals(posture.jacobian[c.name][:, joints]) for c in stance.contacts},
    }
