"""Postures: robots whose kinematics are done, and the generators that make them, one a file."""

from socp_statics.postures.inverse_kinematics import reach as reach
from socp_statics.postures.posture import Posture as Posture
from socp_statics.postures.posture import pose as pose
from socp_statics.postures.posture import posture_at as posture_at
from socp_statics.registry import Registry

GENERATORS = Registry("posture generator", group="socp_statics.postures")
for _name, _line in (
    ("joint_angles", "joint angles as they are given, any robot (angles)"),
    ("standing", "upright with straight legs (arms)"),
    ("squat", "both knees bent, hips and ankles at minus half of it (knee, arms)"),
    ("single_stance", "on one foot, leaning over it (knee, lean, lift, arms)"),
    ("rolled_feet", "legs apart by hip roll, feet flat (angle, arms)"),
):
    GENERATORS.add(_name, _line, f"socp_statics.postures.{_name}:generate")
