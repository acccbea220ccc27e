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
    ("sloped_feet", "each foot on a plane of its own (left, right: roll and pitch; spread, com)"),
    ("stairs", "one foot a step above the other (rise, tread, upper, com)"),
    ("wall_brace", "hands against a wall of any inclination (hands, distance, inclination, height, turn, spread, com)"),
    ("table_lean", "leaning on a table with the hands (hands, distance, height, com)"),
    ("chimney", "feet on slopes that face each other, hands against walls to the sides (hands, slope, width, height, spread, com)"),
    ("push", "pushing with the hands, Fig. 3.9 A or B (variant, force, hands, stride, slope, rise, pushing_leg, distance, height, com)"),
    ("ladder", "feet on rungs, hands closed round others (hands, inclination, rung_gap, foot_rungs, hand_height, grip, com)"),
    ("hold_object", "an object between the hands (hands, mass, width, forward, height, grip_friction, squeeze, spread, com)"),
    ("quadruped_stance", "on three or four point feet, on slopes or steps (slope, steps, stretch, lift, com)"),
    ("random_joint_angles", "seeded random joint angles around the neutral ones, any robot (seed, spread)"),
    ("random_reachable", "seeded random slopes, a hand on a wall (seed, slope, hand)"),
    ("keyframes", "between contact states in turn (states, progress)"),
):
    GENERATORS.add(_name, _line, f"socp_statics.postures.{_name}:generate")
