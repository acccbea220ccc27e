"""Quadrupeds of the catalogue that come with the extra ``robots``.

Feet are points: the foot frames of the models, whose normal is the z axis of that frame until a generator says what the foot stands on.
Where a foot ends in a ball, its frame lies at the centre of the ball or near it, so that the ground is one radius lower than the point.
"""

from __future__ import annotations

from functools import cache

from socp_statics.robots.contact_frame import ContactFrame
from socp_statics.robots.robot import Robot
from socp_statics.robots.robot_data import robot_from_data

LEGS = {"left_front": "LF", "right_front": "RF", "left_hind": "LH", "right_hind": "RH"}


@cache
def anymal_c() -> Robot:
    """ANYmal C. The foot frames lie 22.5 mm below the centre of a ball of 30 mm radius."""
    legs: dict[str, float] = {}
    for leg in LEGS.values():
        outward, forward = (-1.0 if leg[0] == "L" else 1.0), (1.0 if leg[1] == "F" else -1.0)
        legs |= {f"{leg}_HAA": 0.1 * outward, f"{leg}_HFE": 0.7 * forward, f"{leg}_KFE": -1.0 * forward}
    return robot_from_data(
        "anymal_c",
        "anymal_c_simple_description/urdf/anymal.urdf",
        [ContactFrame(f"{name}_foot", f"{leg}_FOOT", "point") for name, leg in LEGS.items()],
        source="ANYbotics ANYmal C, simplified",
        licence="BSD-3-Clause",
        reference=legs,
    )


@cache
def solo12() -> Robot:
    """Solo12. The foot frames lie at the centre of a foot of 16 mm radius; torque limits are the placeholder 1000 N m."""
    feet = {"left_front": "FL", "right_front": "FR", "left_hind": "HL", "right_hind": "HR"}
    legs: dict[str, float] = {}
    for leg in feet.values():
        outward, forward = (1.0 if leg[1] == "L" else -1.0), (1.0 if leg[0] == "F" else -1.0)
        legs |= {f"{leg}_HAA": 0.1 * outward, f"{leg}_HFE": 0.8 * forward, f"{leg}_KFE": -1.6 * forward}
    return robot_from_data(
        "solo12",
        "solo_description/robots/solo12.urdf",
        [ContactFrame(f"{name}_foot", f"{leg}_FOOT", "point") for name, leg in feet.items()],
        source="ODRI Solo12",
        licence="BSD-3-Clause",
        reference=legs,
        torque_limits_real=False,
        torque_limits_note="1000 N m on every joint of a robot of 2.5 kg",
    )


@cache
def hyq() -> Robot:
    """HyQ. The foot frames lie at the centre of a ball of 21.75 mm radius."""
    legs: dict[str, float] = {}
    for leg in (name.lower() for name in LEGS.values()):
        forward = 1.0 if leg[1] == "f" else -1.0
        legs |= {f"{leg}_haa_joint": -0.2, f"{leg}_hfe_joint": 0.75 * forward, f"{leg}_kfe_joint": -1.5 * forward}
    return robot_from_data(
        "hyq",
        "hyq_description/robots/hyq_no_sensors.urdf",
        [ContactFrame(f"{name}_foot", f"{leg.lower()}_foot", "point") for name, leg in LEGS.items()],
        source="IIT HyQ without sensors",
        licence="Apache-2.0",
        reference=legs,
    )


@cache
def centauro() -> Robot:
    """Centauro: four legs on wheels that are held, two arms.

    The contact frames lie at the lowest point of an upright wheel of 124 mm radius and move with the ankle, not with the wheel. Hands:
    the end of the arm, normal along the forearm.
    """
    legs = {"hip_yaw": 0.5, "hip_pitch": 1.37, "knee_pitch": 1.34, "ankle_pitch": -0.03, "ankle_yaw": -0.6}
    hind = {"hip_yaw": 1.28, "hip_pitch": 1.29, "knee_pitch": 1.71, "ankle_pitch": 0.43, "ankle_yaw": -1.3}
    arm = {1: 0.520149, 2: 0.320865, 3: 0.274669, 4: -2.23604, 5: 0.0500815, 6: -0.781461}
    reference: dict[str, float] = {}
    for number, sign, angles in ((1, -1.0, legs), (2, 1.0, legs), (3, 1.0, hind), (4, -1.0, hind)):
        reference |= {f"{joint}_{number}": sign * angle for joint, angle in angles.items()}
    for side, sign in ((1, 1.0), (2, -1.0)):
        reference |= {f"j_arm{side}_{k}": sign * angle if k in (2, 3, 5) else angle for k, angle in arm.items()}
    feet = {"left_front": 1, "right_front": 2, "left_hind": 3, "right_hind": 4}
    return robot_from_data(
        "centauro",
        "centauro_description/urdf/centauro.urdf",
        [
            *(ContactFrame(f"{name}_foot", f"contact_{number}", "point") for name, number in feet.items()),
            *(ContactFrame(f"{side}_hand", f"arm{number}_8", "point") for side, number in (("left", 1), ("right", 2))),
        ],
        source="IIT Centauro",
        licence="Apache-2.0",
        reference=reference,
    )
