"""Humanoids of the catalogue that come with the extra ``robots``.

Soles are rectangles or hulls in the sole plane, read off the models' own collision geometry: the corners of what lies within 2 mm of the
lowest point, rounded inward to a millimetre (tests/test_catalogue.py reads them off again). Their t1 points forward, t2 to the left. Hands
are points whose normal points along the forearm towards the elbow, as for HOAP-2.
"""

from __future__ import annotations

from functools import cache

from socp_statics.robots.contact_frame import ContactFrame
from socp_statics.robots.robot import Robot
from socp_statics.robots.robot_data import mirrored, robot_from_data

SIDES = ("left", "right")
# columns t1, t2, n in axes of the link
AGAINST_X = ((0.0, 0.0, -1.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0))


def _rectangle(heel: float, toe: float, right: float, left: float) -> tuple[tuple[float, float], ...]:
    return ((toe, right), (toe, left), (heel, left), (heel, right))


@cache
def talos() -> Robot:
    """TALOS with fixed fingers.

    The sole frames lie in the sole plane. The mesh of the foot is rounded: its corners within 2 mm of the plane reach from -0.108 to
    0.096 m and +-0.062 m; the rectangle inside them is used. Hands: the plane of the fingertips of the closed
    gripper, 0.152 m below its base.
    """
    legs = {"leg_left_3_joint": -0.411354, "leg_left_4_joint": 0.859395, "leg_left_5_joint": -0.448041}
    arms = {"arm_left_1_joint": 0.25847, "arm_left_2_joint": 0.173046, "arm_left_4_joint": -0.9, "arm_left_7_joint": 0.1}
    return robot_from_data(
        "talos",
        "talos_data/robots/talos_reduced.urdf",
        [
            *(ContactFrame(f"{side}_foot", f"{side}_sole_link", vertices=_rectangle(-0.102, 0.091, -0.062, 0.062)) for side in SIDES),
            *(ContactFrame(f"{side}_hand", f"gripper_{side}_base_link", "point", position=(0.0, 0.0, -0.152)) for side in SIDES),
        ],
        source="PAL Robotics TALOS",
        licence="LGPL-3.0",
        reference=mirrored(legs | arms, "left", "right", ("arm_left_1_joint", "arm_left_2_joint")),
    )


@cache
def g1() -> Robot:
    """Unitree G1, 29 joints, rubber hands.

    The model touches the ground with four balls of 5 mm radius below each foot; their lowest points are the corners of the sole. Hands:
    the tip of the rubber hand, 0.132 m in front of its frame.
    """
    legs = {"left_hip_pitch_joint": -0.3, "left_knee_joint": 0.6, "left_ankle_pitch_joint": -0.3}
    arms = {"left_shoulder_pitch_joint": 0.1, "left_shoulder_roll_joint": 0.2, "left_elbow_joint": 0.6}
    sole = ((0.12, -0.03), (0.12, 0.03), (-0.05, 0.025), (-0.05, -0.025))
    return robot_from_data(
        "g1",
        "g1_description/urdf/g1_29dof_rev_1_0.urdf",
        [
            *(ContactFrame(f"{side}_foot", f"{side}_ankle_roll_link", vertices=sole, position=(0.0, 0.0, -0.035)) for side in SIDES),
            *(
                ContactFrame(f"{side}_hand", f"{side}_rubber_hand", "point", position=(0.132, 0.0, 0.0), rotation=AGAINST_X)
                for side in SIDES
            ),
        ],
        source="Unitree G1",
        licence="BSD-3-Clause",
        reference=mirrored(legs | arms, "left", "right", ("left_shoulder_roll_joint",)),
    )


@cache
def icub() -> Robot:
    """The iCub without fingers.

    The sole frames lie in the sole plane, x forward. The meshes of its feet are a quarter turn off (toes to the robot's right); turned back
    about the ankle their undersides are octagons from -0.029 to 0.127 m and 0.031 m to both sides. Hands: the frame in the palm.
    """
    outer = ((0.127, 0.003), (0.096, 0.030), (0.050, 0.031), (-0.011, 0.027), (-0.029, -0.001))
    left = (*outer, (-0.010, -0.028), (0.050, -0.030), (0.117, -0.022))
    soles = {"left": left, "right": tuple((x, -y) for x, y in left)}
    legs = {"l_hip_pitch": 0.35, "l_knee": -0.6, "l_ankle_pitch": -0.25}
    arms = {"l_shoulder_pitch": -0.3, "l_shoulder_roll": 0.35, "l_elbow": 0.9}
    return robot_from_data(
        "icub",
        "icub_description/robots/icub.urdf",
        [
            *(ContactFrame(f"{side}_foot", f"{side[0]}_sole", vertices=soles[side]) for side in SIDES),
            *(ContactFrame(f"{side}_hand", f"{side[0]}_gripper", "point", rotation=AGAINST_X) for side in SIDES),
        ],
        source="IIT iCub",
        licence="CC-BY-SA-4.0",
        reference=mirrored(legs | arms, "l_", "r_"),
    )


@cache
def romeo() -> Robot:
    """Romeo; the joints that close its hands have no torque limits (0 in the model).

    The sole frames lie 1 mm below the lowest point of the meshes of the feet. What lies within 2 mm of that point reaches from
    -0.073 to 0.117 m and further outward (0.061 m) than inward (0.048 m). Hands: the frame in the palm.
    """
    legs = {"LHipPitch": -0.4, "LKneePitch": 0.8, "LAnklePitch": -0.4}
    arms = {"LShoulderPitch": 1.2, "LShoulderYaw": 0.15, "LElbowRoll": -1.4, "LElbowYaw": -1.0}
    soles = {
        "left": ((0.117, -0.030), (0.117, 0.049), (0.084, 0.061), (-0.073, 0.040), (-0.073, -0.035), (0.084, -0.048)),
        "right": ((0.117, -0.049), (0.117, 0.030), (0.084, 0.048), (-0.073, 0.035), (-0.073, -0.040), (0.084, -0.061)),
    }
    return robot_from_data(
        "romeo",
        "romeo_description/urdf/romeo.urdf",
        [
            *(ContactFrame(f"{side}_foot", f"{side[0]}_sole", vertices=soles[side]) for side in SIDES),
            *(ContactFrame(f"{side}_hand", f"{side[0]}_gripper", "point", rotation=AGAINST_X) for side in SIDES),
        ],
        source="Aldebaran Romeo",
        licence="BSD",
        reference=mirrored(legs | arms, "L", "R", ("LShoulderYaw", "LElbowRoll", "LElbowYaw")),
        torque_limits_note="LHand and RHand, which close the fingers, have none in the model, the other 31 joints have",
    )
