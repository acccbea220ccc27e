"""Stances with one number changed: what a price is the derivative with respect to, stated through the public statements of contacts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from random_stances import restated

from socp_statics.contacts import ContactSet, Stance
from socp_statics.postures import pose
from socp_statics.robots.contact_frame import ContactFrame


def changed_contact(contact, price, h: float):
    """A contact with the number of a price changed by h (bounds and limits widened by it)."""
    match price.kind:
        case "friction":
            return restated(contact, friction=contact.friction + h)
        case "torsional_friction":
            return restated(contact, torsional_friction=contact.torsional_friction + h)
        case "displacement":
            return restated(contact, position=(contact.position + h * np.eye(3)["xyz".index(price.end)]).tolist())
        case "normal_force":
            lo, hi = contact.normal_force
            return restated(contact, normal_force={"lower": [lo - h, hi], "upper": [lo, hi + h], "equal": [lo + h, hi + h]}[price.end])
        case "handle_limits":
            word, end = price.end.split(".")
            lo, hi = contact.limits[word]
            return restated(contact, limits=dict(contact.limits) | {word: [lo - h, hi] if end == "lower" else [lo, hi + h]})
    raise KeyError(price.kind)


def changed(stance: Stance, price, h: float) -> Stance:
    """A stance without a robot with the number of a price changed by h."""
    return replace(stance, contacts=ContactSet([changed_contact(c, price, h) if c.name == price.name else c for c in stance.contacts]))


def changed_posture(posture, limits: dict[str, tuple[float, float]], price, h: float):
    """A posture and its torque limits with the number of a price changed by h.

    A contact that moves is another contact frame on the same link; the robot stays where it is.
    """
    if price.kind == "torque_limits":
        lower, upper = limits[price.name]
        return posture, limits | {price.name: (lower - h, upper) if price.end == "lower" else (lower, upper + h)}
    names = [c.name for c in posture.contacts]
    friction = {c.name: c.friction for c in posture.contacts}
    first = posture.contacts[0]
    if price.kind == "friction":
        friction[price.name] += h
        return pose(posture.robot, posture.angles, names, friction, first.position), limits
    delta = h * np.eye(3)["xyz".index(price.end)]
    frame: ContactFrame = posture.robot.frames[price.name]
    R_WF = next(c for c in posture.contacts if c.name == price.name).rotation @ frame.rotation.T
    moved = replace(frame, position=frame.position + R_WF.T @ delta)
    at = first.position + (delta if price.name == first.name else 0.0)
    return pose(posture.robot.with_frames({price.name: moved}), posture.angles, names, friction, at), limits


def step(price, force: float, length: float) -> float:
    """How far to change the number of a price for a central difference, in a stance of this load and size."""
    if price.kind in ("torsional_friction", "displacement"):
        return 1e-5 * length
    return 1e-5 * {"1": 1.0, "N": force, "N m": force * length}[price.per]
