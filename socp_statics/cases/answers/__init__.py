"""The questions a problem can ask: one file for each model of the contract."""

from socp_statics.registry import Registry

ANSWERS = Registry("model", group="socp_statics.answers")
_HERE = "socp_statics.cases.answers"
ANSWERS.add("equilibrium", "can the stance be held: verdict, margin and certificate", f"{_HERE}.equilibrium:ANSWER")
ANSWERS.add(
    "contact_forces",
    "the best balancing contact forces: least squares, normal force, nearest to given ones, or Orin and Oh's power and peak",
    f"{_HERE}.contact_forces:ANSWER",
)
ANSWERS.add("minimax_wrench", "balancing contact forces whose largest measure is least", f"{_HERE}.minimax_wrench:ANSWER")
ANSWERS.add("support_region", "where the centre of mass may be: inner and outer polygon", f"{_HERE}.support_region:ANSWER")
ANSWERS.add(
    "torque_feasibility",
    "least share of its torque limits that the worst joint must use: feasible if <= 1",
    f"{_HERE}.torque_feasibility:ANSWER",
)
ANSWERS.add("capability", "the largest payload or push that contacts and motors allow", f"{_HERE}.capability:ANSWER")
ANSWERS.add(
    "posture_optimization",
    "a better posture on the same contacts: largest margin, CoM margin, or least worst share of the torque limits",
    f"{_HERE}.posture_optimization:ANSWER",
)
ANSWERS.add(
    "keyframes",
    "the verdict of contact states in turn and along the ways between them, the first failure named",
    f"{_HERE}.keyframes:ANSWER",
)
ANSWERS.add(
    "following_region",
    "how far the centre of mass goes along rays while the posture follows, and what stops it there",
    f"{_HERE}.following_region:ANSWER",
)
ANSWERS.add(
    "wrench_distribution",
    "contact wrenches by the chapter's inverses, the lever rule and programs, one method or all side by side",
    f"{_HERE}.wrench_distribution:ANSWER",
)
ANSWERS.add(
    "internal_force_window",
    "how much internal force keeps every contact in its cone and every torque in its limit",
    f"{_HERE}.internal_force_window:ANSWER",
)
ANSWERS.add(
    "robustness",
    "how much may go wrong before it no longer holds: pushes, CoM, tilt, friction, mass, contact placement",
    f"{_HERE}.robustness:ANSWER",
)
