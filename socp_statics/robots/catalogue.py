"""The robots that can be loaded by name."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from socp_statics.registry import Registry

if TYPE_CHECKING:
    from socp_statics.robots.robot import Robot

ROBOTS = Registry("robot", group="socp_statics.robots")
for _name, _line, _target in (
    (
        "hoap2",
        "Fujitsu HOAP-2, 25 joints, 6.243 kg; contacts left_foot, right_foot, left_hand, right_hand; torque limits are placeholders; "
        "numbers of the manufacturer's mass tables (github.com/hinataros/V6), joint ranges of Webots; BSD-2-Clause; "
        "soles 98 x 63 mm, hands are points",
        "catalogue:hoap2",
    ),
    (
        "talos",
        "PAL Robotics TALOS, 32 joints, 90.27 kg; contacts left_foot, right_foot, left_hand, right_hand; torque limits are those of the "
        "model; example-robot-data 5, extra robots; LGPL-3.0; soles 193 x 124 mm, hands are points",
        "humanoids:talos",
    ),
    (
        "g1",
        "Unitree G1, 29 joints, 33.34 kg; contacts left_foot, right_foot, left_hand, right_hand; torque limits are those of the model; "
        "example-robot-data 5, extra robots; BSD-3-Clause; soles 170 mm long and 50 to 60 mm wide, hands are points",
        "humanoids:g1",
    ),
    (
        "icub",
        "IIT iCub, 32 joints, 28.35 kg; contacts left_foot, right_foot, left_hand, right_hand; torque limits are those of the model; "
        "example-robot-data 5, extra robots; CC-BY-SA-4.0; soles octagons 156 mm long and 61 mm wide, hands are points",
        "humanoids:icub",
    ),
    (
        "romeo",
        "Aldebaran Romeo, 33 joints, 40.53 kg; contacts left_foot, right_foot, left_hand, right_hand; "
        "torque limits are those of the model, placeholders at the 2 joints that close its hands; "
        "example-robot-data 5, extra robots; BSD; soles hexagons 190 mm long and 109 mm wide, hands are points",
        "humanoids:romeo",
    ),
    (
        "anymal_c",
        "ANYbotics ANYmal C, 12 joints, 52.13 kg; contacts left_front_foot, right_front_foot, left_hind_foot, right_hind_foot; "
        "torque limits are those of the model; example-robot-data 5, extra robots; BSD-3-Clause; feet are points",
        "quadrupeds:anymal_c",
    ),
    (
        "solo12",
        "ODRI Solo12, 12 joints, 2.5 kg; contacts left_front_foot, right_front_foot, left_hind_foot, right_hind_foot; "
        "torque limits are placeholders; example-robot-data 5, extra robots; BSD-3-Clause; feet are points",
        "quadrupeds:solo12",
    ),
    (
        "hyq",
        "IIT HyQ, 12 joints, 86.77 kg; contacts left_front_foot, right_front_foot, left_hind_foot, right_hind_foot; "
        "torque limits are those of the model; example-robot-data 5, extra robots; Apache-2.0; feet are points",
        "quadrupeds:hyq",
    ),
    (
        "centauro",
        "IIT Centauro, 39 joints, 117.1 kg; contacts left_front_foot, right_front_foot, left_hind_foot, right_hind_foot, left_hand, "
        "right_hand; torque limits are those of the model; "
        "example-robot-data 5, extra robots; Apache-2.0; feet are points below the wheels, hands are points",
        "quadrupeds:centauro",
    ),
):
    ROBOTS.add(_name, _line, f"socp_statics.robots.{_target}")

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
