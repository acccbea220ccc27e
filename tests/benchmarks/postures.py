"""Time of kinematics, assembly and verdicts of HOAP-2 postures over Pinocchio's own time for the same kinematics.

Run as a program; nothing is asserted. Verdicts are of the compiled engine (Clarabel, exact second-order cones). All medians over
the same seeded postures in one run.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Iterable

import numpy as np
import pinocchio

from socp_statics import check_equilibrium, load_robot, pose
from socp_statics.statics import assemble

POSTURES = 300
LIMITS = {"default": np.inf, "?LEG_JOINT*": 4.0}


def median_microseconds(work: Callable, arguments: Iterable) -> float:
    """Median time of a call over its arguments."""
    times = []
    for argument in arguments:
        start = time.perf_counter()
        work(argument)
        times.append(time.perf_counter() - start)
    return statistics.median(times) * 1e6


if __name__ == "__main__":
    robot = load_robot("hoap2")
    rng = np.random.default_rng(1)
    angles = [np.clip(0.02 * rng.standard_normal(25), robot.lower, robot.upper) for _ in range(POSTURES)]
    model, data = robot.pin_model, robot.pin_model.createData()
    feet = [robot.frame_id(robot.frames[name].frame) for name in ("left_foot", "right_foot")]
    configurations = [robot.configuration(a) for a in angles]

    def by_pinocchio(q: np.ndarray) -> None:
        """The kinematics a posture needs, without anything of ours."""
        pinocchio.computeJointJacobians(model, data, q)
        pinocchio.jacobianCenterOfMass(model, data, q)
        for index in feet:
            pinocchio.updateFramePlacement(model, data, index)
            pinocchio.getFrameJacobian(model, data, index, pinocchio.LOCAL_WORLD_ALIGNED)

    postures = [pose(robot, a) for a in angles]
    stances = [p.stance() for p in postures]
    check_equilibrium(postures[0], torque_limits=LIMITS)
    own = median_microseconds(by_pinocchio, configurations)
    posing, assembling = median_microseconds(lambda a: pose(robot, a), angles), median_microseconds(assemble, stances)
    print(f"HOAP-2, two feet, 8 contact points, {POSTURES} postures, median microseconds")
    print(f"{'Pinocchio alone':<44}{own:>9.1f}")
    print(f"{'pose() beyond Pinocchio':<44}{posing - own:>9.1f}")
    print(f"{'assemble()':<44}{assembling:>9.1f}")
    free = median_microseconds(check_equilibrium, postures)
    stable = [p for p in postures if check_equilibrium(p, torque_limits=LIMITS).stable]
    limited = median_microseconds(lambda p: check_equilibrium(p, torque_limits=LIMITS), stable)
    print(f"{'verdict without torque limits':<44}{free:>9.1f}")
    print(f"{f'verdict with 12 torque limits ({len(stable)} stable)':<44}{limited:>9.1f}")
