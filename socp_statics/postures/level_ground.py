"""The check that contacts lie where a generator says they do: on one level plane."""

from __future__ import annotations

from socp_statics.exceptions import InputError
from socp_statics.postures.posture import Posture

# metres and 1 - cosine: some models have axes rounded to five digits
OFF_THE_PLANE, TILTED = 1e-5, 1e-9


def on_level_ground(posture: Posture, generator: str) -> Posture:
    """The posture, if all its contacts lie in the level plane of the first.

    Args:
        posture: The posture.
        generator: Who asks, for the error sentence.

    Returns:
        The same posture.

    Raises:
        InputError: A contact is off the plane or tilted; the sentence names it.
    """
    ground = posture.contacts[0].position[2]
    for contact in posture.contacts:
        height, tilt = float(contact.position[2] - ground), float(1.0 - contact.normal_W[2])
        if abs(height) > OFF_THE_PLANE:
            where = f"{abs(height) * 1e3:.3g} mm {'above' if height > 0 else 'below'} the ground"
        elif tilt > TILTED:
            where = "not level"
        else:
            continue
        message = f"contact '{contact.name}': {generator} puts its contacts on level ground, this one is {where}; joint_angles takes any"
        raise InputError(message, name=contact.name, field="support")
    return posture
