"""The posture that an optimisation found, from its record."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from socp_statics.contacts import contact_from_statement
from socp_statics.postures import Posture
from socp_statics.postures.moved import posture_on


def optimized_posture(record: Mapping[str, Any], given: Posture | None) -> Posture | None:
    """The result of a posture optimisation.

    Args:
        record: The record.
        given: The posture it started from.

    Returns:
        The posture; None where the record has none.
    """
    found = record.get("optimized")
    if found is None or given is None:
        return None
    robot = given.robot
    angles = np.array([found["angles"][joint] for joint in robot.joints])
    position, rotation = (np.array(found["base"][key], dtype=float) for key in ("position", "rotation"))
    contacts = {entry["name"]: contact_from_statement(entry) for entry in found["contacts"]}
    return posture_on(given, robot.configuration(angles, position, rotation), contacts)
