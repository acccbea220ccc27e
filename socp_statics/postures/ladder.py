"""Generator: on a ladder, feet on two rungs, hands closed round two others."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.contacts.numbers import scalar
from socp_statics.exceptions import InputError
from socp_statics.postures.home import home
from socp_statics.postures.posture import Posture
from socp_statics.postures.scene import FEET, LEVEL, checked_hands, feet_apart, take_places
from socp_statics.robots import Robot
from socp_statics.robots.contact_frame import ContactFrame

GAP, REACH, BEHIND = 0.08, 0.1, 0.1
ACROSS = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])


def generate(
    robot: Robot,
    *,
    at: ArrayLike = (0.0, 0.0, 0.0),
    friction: float | Mapping[str, float] = 0.5,
    hands: Sequence[str] = ("left_hand", "right_hand"),
    inclination: float = 1.3,
    rung_gap: float | None = None,
    foot_rungs: Sequence[int] = (0, 1),
    hand_height: float | None = None,
    grip: float | None = None,
    com: Sequence[float] | None = None,
) -> Posture:
    """Feet on the rungs of a ladder, each on a line across its sole, hands closed round a rung or two above.

    A hand carries forces across its rung, not along it and no moments: a handle. The ladder leans away from the robot.

    Args:
        robot: A humanoid with feet and hands.
        at: The middle of the lowest rung in use, shape (3,) [m].
        friction: Coulomb coefficient of the feet, of both or by contact.
        hands: The hands that hold, the first by the hand rung, the second one rung above.
        inclination: Of the ladder from the floor, pi/2 is upright [rad].
        rung_gap: Between rungs along the ladder, 0.08 of the home height of the centre of mass by default [m].
        foot_rungs: Rung of the left and of the right foot, counted from the lowest.
        hand_height: Height of the hand rung above the lowest [m]; 0.1 of the home height of the centre of mass above the home place
            of the hands by default, moved to the nearest rung.
        grip: Largest force of a hand across its rung in each direction, unlimited by default [N].
        com: Centre of mass from ``at`` [m]; 0.1 of its home height behind the lowest rung by default.

    Returns:
        The posture.

    Raises:
        InputError: A wrong number, no hand, or the ladder cannot be reached.
    """
    names, standing = checked_hands(robot, hands, "ladder"), home(robot)
    size = float(standing.com_W[2])
    lean = scalar("ladder", "inclination", inclination, above=0.0, kind="generator")
    gap = GAP * size if rung_gap is None else scalar("ladder", "rung_gap", rung_gap, above=0.0, kind="generator")
    if len(foot_rungs) != 2:
        raise InputError(f"ladder: foot_rungs must be two whole numbers, got {foot_rungs!r}", name="ladder", field="foot_rungs")
    along = gap * np.array([np.cos(lean), 0.0, np.sin(lean)])
    level = standing.contacts[names[0]].position[2] + REACH * size if hand_height is None else scalar("ladder", "hand_height", hand_height)
    first = round(level / along[2])
    limits = {} if grip is None else {"limits": {key: [-grip, grip] for key in ("fx", "fz")}}
    frames = {name: _across_the_sole(robot.contact_frame(name)) for name in FEET}
    frames |= {name: _holding(robot.contact_frame(name), limits) for name in names}
    places = {}
    for (name, position), rung in zip(feet_apart(robot).items(), foot_rungs, strict=True):
        places[name] = (np.array([0.0, position[1], 0.0]) + rung * along, ACROSS)
    for k, name in enumerate(names):
        places[name] = (np.array([0.0, standing.contacts[name].position[1], 0.0]) + (first + k) * along, LEVEL)
    rough = friction if isinstance(friction, Mapping) else dict.fromkeys(FEET, friction)
    rough = {**rough, **dict.fromkeys(names, 0.0)}
    return take_places(robot.with_frames(frames), places, at=at, friction=rough, com=(-BEHIND * size, 0.0) if com is None else com)


def _across_the_sole(sole: ContactFrame) -> ContactFrame:
    """The line across the middle of a sole that lies on a rung; its first axis is the sole's second."""
    middle, width = sole.points_C.mean(axis=0), float(np.ptp(sole.points_C[:, 1]))
    R = np.asarray(sole.rotation)
    return ContactFrame(
        sole.name, sole.frame, "line", size=[width], position=sole.position + R @ [middle[0], middle[1], 0.0], rotation=R @ ACROSS
    )


def _holding(hand: ContactFrame, limits: Mapping[str, Mapping[str, list[float]]]) -> ContactFrame:
    """The hand closed round a rung that runs along y: forces along x and z."""
    return ContactFrame(
        hand.name, hand.frame, "handle", position=hand.position, rotation=hand.rotation, extra={"transmits": ["fx", "fz"], **limits}
    )
