"""Which contacts of a robot touch, and how rough they are."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from socp_statics.exceptions import InputError
from socp_statics.robots import Robot


def checked_support(robot: Robot, support: Sequence[str]) -> tuple[str, ...]:
    """The names of the contacts that touch.

    Args:
        robot: The robot.
        support: Names of its contacts; a single one may be a word.

    Raises:
        InputError: None, an unknown one, or one named twice.
    """
    names = (support,) if isinstance(support, str) else tuple(support)
    if not names:
        raise InputError(f"robot '{robot.name}': support must name at least one contact", name=robot.name, field="support")
    for name in names:
        robot.contact_frame(name)
        if names.count(name) > 1:
            raise InputError(f"robot '{robot.name}': support names {name!r} twice", name=name, field="support")
    return names


def checked_friction(robot: Robot, names: tuple[str, ...], friction: float | Mapping[str, float]) -> dict[str, float]:
    """The friction coefficient of every contact that touches, in their order.

    Args:
        robot: The robot.
        names: The contacts that touch.
        friction: One for all, or by contact.

    Raises:
        InputError: A contact that does not touch, or one that is missing; the numbers are judged by the contacts.
    """
    if not isinstance(friction, Mapping):
        return dict.fromkeys(names, friction)
    for name in friction:
        if name not in names:
            message = f"robot '{robot.name}': friction names {name!r}, which is not in support ({', '.join(names)})"
            raise InputError(message, name=str(name), field="friction")
    for name in names:
        if name not in friction:
            raise InputError(f"robot '{robot.name}': friction of {name!r} is missing", name=name, field="friction")
    return {name: friction[name] for name in names}
