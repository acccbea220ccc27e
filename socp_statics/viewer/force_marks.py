"""Arrows: contact forces, weight and loads to one scale; the velocities of the certified motion to another."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from socp_statics.colours import BLACK, GREY, PURPLE, VERMILLION
from socp_statics.contacts import Stance
from socp_statics.spatial import Array
from socp_statics.viewer.marks import Arrows, Lines
from socp_statics.viewer.motion import CertifiedMotion

FORCE_SHARE, VELOCITY_SHARE, THICKNESS = 0.45, 0.18, 0.005
NOTHING = 1e-3


def force_scale(forces: Iterable[Mapping[str, Any]], stance: Stance, extent: float) -> float:
    """Length of an arrow per newton [m/N]: the largest of weight, loads and contact forces has a fixed share of the scene.

    Args:
        forces: Contact forces, entries of a record.
        stance: What they act on.
        extent: How large the scene is [m].
    """
    vectors = [w.force for w in stance.external_wrenches] + [entry["force"] for entry in forces]
    largest = max([stance.weight, *(float(np.linalg.norm(vector)) for vector in vectors)])
    return FORCE_SHARE * extent / largest if largest > 0.0 else 0.0


def force_marks(forces: Iterable[Mapping[str, Any]], stance: Stance, extent: float, scale: float) -> list[Arrows]:
    """Contact forces, weight and loads from the points where they act.

    Args:
        forces: Entries of a record: "point" [m] and "force" [N].
        stance: What they act on.
        extent: How large the scene is [m].
        scale: Length of an arrow per newton [m/N].

    Returns:
        "forces/contacts", "forces/weight" and "forces/loads"; those of less than 1e-3 of the largest are left out.
    """
    entries = list(forces)
    loads = [w for w in stance.external_wrenches if w.point is not None and w.force.any()]
    kinds = (
        ("contacts", [e["point"] for e in entries], [e["force"] for e in entries], PURPLE),
        ("weight", [stance.com], [stance.mass * stance.gravity], GREY),
        ("loads", [w.point for w in loads], [w.force for w in loads], BLACK),
    )
    least = NOTHING * FORCE_SHARE * extent
    return [_arrows(f"forces/{kind}", points, scale * _rows(vectors), colour, extent, least) for kind, points, vectors, colour in kinds]


def motion_marks(motion: CertifiedMotion | None, extent: float) -> tuple[Arrows, Lines]:
    """Velocities of the contact points and of the centre of mass, and the axis of rotation; none without a motion.

    Args:
        motion: The certified motion, or None.
        extent: How large the scene is [m].
    """
    if motion is None:
        return Arrows("motion/velocities", _rows([]), _rows([]), VERMILLION, THICKNESS * extent), _axis(None, extent)
    fastest = float(np.linalg.norm(motion.velocities, axis=1).max())
    reach = VELOCITY_SHARE * extent / fastest if fastest > 0.0 else 0.0
    least = 0.02 * VELOCITY_SHARE * extent
    return _arrows("motion/velocities", motion.points, reach * motion.velocities, VERMILLION, extent, least), _axis(motion, extent)


def _axis(motion: CertifiedMotion | None, extent: float) -> Lines:
    pieces = np.zeros((0, 2, 3))
    if motion is not None and motion.turns:
        through, along = motion.axis()
        pieces = np.array([[through - 0.5 * extent * along, through + 0.5 * extent * along]])
    return Lines("motion/axis", pieces, VERMILLION, pixels=3.0)


def _arrows(name: str, tails: Any, ways: Array, colour: str, extent: float, least: float) -> Arrows:
    shown = np.linalg.norm(ways, axis=1) > least
    return Arrows(name, _rows(tails)[shown], ways[shown], colour, THICKNESS * extent)


def _rows(vectors: Any) -> Array:
    return np.asarray(vectors, dtype=float).reshape(-1, 3)
