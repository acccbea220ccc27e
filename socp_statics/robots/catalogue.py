"""The robots that can be loaded by name."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from socp_statics.registry import Registry

if TYPE_CHECKING:
    from socp_statics.robots.robot import Robot

ROBOTS = Registry("robot", group="socp_statics.robots")
ROBOTS.add(
    "hoap2",
    "Fujitsu HOAP-2, 25 joints, 6.243 kg; contacts left_foot, right_foot, left_hand, right_hand; torque limits are placeholders; "
    "numbers of the manufacturer's mass tables (github.com/hinataros/V6), joint ranges of Webots; BSD-2-Clause",
    "socp_statics.robots.catalogue:hoap2",
)

HEEL, TOE, HALF_WIDTH, ANKLE_HEIGHT = -0.040, 0.058, 0.0315, 0.037
FINGERTIP = 0.146


@cache
def hoap2() -> Robot:
    """HOAP-2 with the light torso.

    Feet are surfaces: the contact frame lies in the sole plane below the ankle, parallel to the foot, and the sole reaches further
    forward than back. Hands are points at the fingertip; their normal points along the forearm to the elbow, t2 is the forearm's y.
    """
    from socp_statics.robots.contact_frame import ContactFrame
    from socp_statics.robots.urdf import robot_from_urdf

    sole = ((TOE, -HALF_WIDTH), (TOE, HALF_WIDTH), (HEEL, HALF_WIDTH), (HEEL, -HALF_WIDTH))
    to_the_elbow = ((0.0, 0.0, -1.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0))
    sides = (("left", "L"), ("right", "R"))
    feet = [ContactFrame(f"{side}_foot", f"{letter}LEG_LINK6", vertices=sole, position=(0.0, 0.0, -ANKLE_HEIGHT)) for side, letter in sides]
    hands = [
        ContactFrame(f"{side}_hand", f"{letter}ARM_LINK4", "point", position=(FINGERTIP, 0.0, 0.0), rotation=to_the_elbow)
        for side, letter in sides
    ]
    return robot_from_urdf(
        Path(__file__).with_name("hoap2.urdf"),
        {frame.name: frame for frame in (*feet, *hands)},
        name="hoap2",
        source="manufacturer's mass tables and link lengths as in github.com/hinataros/V6 (misc/hoap2, share/model/skeleton); "
        "joint ranges of github.com/cyberbotics/webots (Hoap2.proto)",
        licence="BSD-2-Clause",
        torque_limits_real=False,
        reference={
            f"{letter}{joint}": angle
            for letter in "LR"
            for joint, angle in (("LEG_JOINT3", -0.4), ("LEG_JOINT4", 0.8), ("LEG_JOINT5", -0.4), ("ARM_JOINT1", 1.2), ("ARM_JOINT4", -0.8))
        },
        torque_limits_note="9 N m on every joint is the uniform value of a simulation model, not a datasheet value",
    )
