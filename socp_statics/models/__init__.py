"""The questions of statics as conic programs, one a file, declared in cvxpy as the papers display them."""

from socp_statics.registry import Registry

MODELS = Registry("model", group="socp_statics.models")
for _name, _line in (
    ("equilibrium", "verdict, margin (normal-force reserve) and certificate"),
    ("contact_forces", "best contact forces: least squares, least normal force, or nearest to a reference"),
    ("minimax_wrench", "least possible largest contact load: force, normal, tangential, component or use of friction"),
    ("orin_oh", "least sum of local joint powers plus weighted largest normal force (Orin and Oh 1981)"),
    ("torque_feasibility", "least share of its torque limits that the worst joint has to use"),
    ("capability", "largest payload or push that contacts and motors allow"),
    ("support_region", "region of CoM positions in balance, between an inner and an outer polygon"),
    ("contact_load", "largest normal force of one contact over all horizontal CoM positions"),
    ("hard_rows", "least relaxation with which balance, handle limits and torque limits can be met"),
    ("posture_optimization", "how far a small motion of the posture raises its margin, or eases its torques"),
    ("disturbance", "largest disturbance of the load along a direction that can be balanced"),
    ("force_rule", "largest ball of disturbances that forces hold by an affine rule"),
    ("rule_check", "whether an affine force rule keeps every cone, exactly, by the S-lemma"),
    ("inscribed_ellipsoid", "largest ellipsoid inside a polytope of loads that can be balanced"),
    ("largest_reserve", "largest margin over all horizontal CoM positions"),
):
    MODELS.add(_name, _line, f"socp_statics.models.{_name}:MODEL")
