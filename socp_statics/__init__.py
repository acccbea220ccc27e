"""Statics of robots in contact by convex optimisation: exact friction cones, certified answers.

The public names are imported when they are first used; importing the package imports nothing beyond the standard library.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

_HOMES = {
    "StaticsError": "exceptions",
    "InputError": "exceptions",
    "EngineError": "exceptions",
    "PointContact": "contacts",
    "SurfaceContact": "contacts",
    "LineContact": "contacts",
    "SoftFingerContact": "contacts",
    "FrictionlessPointContact": "contacts",
    "FrictionlessSurfaceContact": "contacts",
    "Handle": "contacts",
    "ContactSet": "contacts",
    "ExternalWrench": "contacts",
    "Stance": "contacts",
    "ConeChoice": "cones",
    "contact_wrench_cone": "wrench_cones",
    "body_wrench_cone": "wrench_cones",
    "com_slice": "wrench_cones",
    "acceleration_slice": "wrench_cones",
    "simple_static_test": "stability",
    "check_equilibrium": "stability",
    "check_equilibrium_many": "stability",
    "check_strong_stability": "stability",
    "trace_support_region": "regions",
    "trace_support_regions": "regions",
    "support_function": "regions",
    "base_of_support": "regions",
    "com_margin_prices": "regions",
    "trace_following_region": "following",
    "optimise_contact_forces": "optimization",
    "minimise_largest_wrench": "optimization",
    "largest_payload": "optimization",
    "largest_push": "optimization",
    "minimise_largest_force_many": "optimization",
    "Robot": "robots",
    "ContactFrame": "robots",
    "load_robot": "robots",
    "Posture": "postures",
    "pose": "postures",
    "posture_at": "postures",
    "reach": "postures",
    "minimise_torque_use": "optimization",
    "optimise_posture": "optimization",
    "margin_gradient": "stability",
    "distribute": "optimization.wrench_distribution",
    "compare_distributions": "optimization.wrench_distribution",
    "internal_force_window": "optimization.internal_force_window",
    "distribute_many": "distribution",
    "general_solution": "distribution",
    "independent_loops": "distribution",
    "member_forces": "distribution",
    "contact_map": "statics",
    "contact_jacobian": "statics",
    "mixed_jacobian": "statics",
    "body_wrench": "statics",
    "net_wrench": "statics",
    "gravity_wrench": "statics",
    "gravity_torque": "statics",
    "static_torque": "statics",
    "lumped_torque": "statics",
    "torque_components": "statics.torque_components",
    "measure_robustness": "stability.robustness",
    "check_push_rule": "stability.robustness",
    "posture_types": "statics.posture_types",
    "load_problem": "cases.problem",
    "solve": "cases.solve",
    "Record": "cases.record",
    "compare": "comparison",
    "compare_records": "comparison",
    "prove": "cases.proving",
    "run": "runner",
    "load_results": "runner",
    "compare_regions": "comparison",
    "draw": "figures",
    "draw_robot": "figures",
    "draw_torques": "figures",
    "robot_views": "figures",
}

if TYPE_CHECKING:
    from socp_statics.cases.problem import load_problem as load_problem
    from socp_statics.cases.proving import prove as prove
    from socp_statics.cases.record import Record as Record
    from socp_statics.cases.solve import solve as solve
    from socp_statics.comparison import compare as compare
    from socp_statics.comparison import compare_records as compare_records
    from socp_statics.comparison import compare_regions as compare_regions
    from socp_statics.cones import ConeChoice as ConeChoice
    from socp_statics.contacts import ContactSet as ContactSet
    from socp_statics.contacts import ExternalWrench as ExternalWrench
    from socp_statics.contacts import FrictionlessPointContact as FrictionlessPointContact
    from socp_statics.contacts import FrictionlessSurfaceContact as FrictionlessSurfaceContact
    from socp_statics.contacts import Handle as Handle
    from socp_statics.contacts import LineContact as LineContact
    from socp_statics.contacts import PointContact as PointContact
    from socp_statics.contacts import SoftFingerContact as SoftFingerContact
    from socp_statics.contacts import Stance as Stance
    from socp_statics.contacts import SurfaceContact as SurfaceContact
    from socp_statics.distribution import distribute_many as distribute_many
    from socp_statics.distribution import general_solution as general_solution
    from socp_statics.distribution import independent_loops as independent_loops
    from socp_statics.distribution import member_forces as member_forces
    from socp_statics.exceptions import EngineError as EngineError
    from socp_statics.exceptions import InputError as InputError
    from socp_statics.exceptions import StaticsError as StaticsError
    from socp_statics.figures import draw as draw
    from socp_statics.figures import draw_robot as draw_robot
    from socp_statics.figures import draw_torques as draw_torques
    from socp_statics.figures import robot_views as robot_views
    from socp_statics.following import trace_following_region as trace_following_region
    from socp_statics.optimization import largest_payload as largest_payload
    from socp_statics.optimization import largest_push as largest_push
    from socp_statics.optimization import minimise_largest_force_many as minimise_largest_force_many
    from socp_statics.optimization import minimise_largest_wrench as minimise_largest_wrench
    from socp_statics.optimization import minimise_torque_use as minimise_torque_use
    from socp_statics.optimization import optimise_contact_forces as optimise_contact_forces
    from socp_statics.optimization import optimise_posture as optimise_posture
    from socp_statics.optimization.internal_force_window import internal_force_window as internal_force_window
    from socp_statics.optimization.wrench_distribution import compare_distributions as compare_distributions
    from socp_statics.optimization.wrench_distribution import distribute as distribute
    from socp_statics.postures import Posture as Posture
    from socp_statics.postures import pose as pose
    from socp_statics.postures import posture_at as posture_at
    from socp_statics.postures import reach as reach
    from socp_statics.regions import base_of_support as base_of_support
    from socp_statics.regions import com_margin_prices as com_margin_prices
    from socp_statics.regions import support_function as support_function
    from socp_statics.regions import trace_support_region as trace_support_region
    from socp_statics.regions import trace_support_regions as trace_support_regions
    from socp_statics.robots import ContactFrame as ContactFrame
    from socp_statics.robots import Robot as Robot
    from socp_statics.robots import load_robot as load_robot
    from socp_statics.runner import load_results as load_results
    from socp_statics.runner import run as run
    from socp_statics.stability import check_equilibrium as check_equilibrium
    from socp_statics.stability import check_equilibrium_many as check_equilibrium_many
    from socp_statics.stability import check_strong_stability as check_strong_stability
    from socp_statics.stability import margin_gradient as margin_gradient
    from socp_statics.stability import simple_static_test as simple_static_test
    from socp_statics.stability.robustness import check_push_rule as check_push_rule
    from socp_statics.stability.robustness import measure_robustness as measure_robustness
    from socp_statics.statics import body_wrench as body_wrench
    from socp_statics.statics import contact_jacobian as contact_jacobian
    from socp_statics.statics import contact_map as contact_map
    from socp_statics.statics import gravity_torque as gravity_torque
    from socp_statics.statics import gravity_wrench as gravity_wrench
    from socp_statics.statics import lumped_torque as lumped_torque
    from socp_statics.statics import mixed_jacobian as mixed_jacobian
    from socp_statics.statics import net_wrench as net_wrench
    from socp_statics.statics import static_torque as static_torque
    from socp_statics.statics.posture_types import posture_types as posture_types
    from socp_statics.statics.torque_components import torque_components as torque_components
    from socp_statics.wrench_cones import acceleration_slice as acceleration_slice
    from socp_statics.wrench_cones import body_wrench_cone as body_wrench_cone
    from socp_statics.wrench_cones import com_slice as com_slice
    from socp_statics.wrench_cones import contact_wrench_cone as contact_wrench_cone


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOMES})
