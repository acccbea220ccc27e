"""A start for inverse kinematics by Pink: all targets at once as soft tasks, a few steps of differential inverse kinematics."""

from __future__ import annotations

from importlib.util import find_spec

import numpy as np

from socp_statics.postures.reaching import Reaching
from socp_statics.spatial import Array

STEPS, GAIN, NEAR_THE_REFERENCE = 25, 0.7, 1e-3
SOLVER = "daqp"


def soft_start(reaching: Reaching) -> Array | None:
    """Where soft tasks lead from the reference.

    Args:
        reaching: What is asked for.

    Returns:
        A point of the tangent space within the joint limits, shape (6 + n,), or None without the extra ``ik``.
    """
    if any(find_spec(package) is None for package in ("pink", SOLVER)):
        return None
    import pink
    import pinocchio

    model = reaching.robot.pin_model.copy()
    tasks = [pink.tasks.PostureTask(cost=NEAR_THE_REFERENCE)]
    tasks[0].set_target(reaching.q0)
    for target in reaching.targets:
        if target.frame < 0:
            tasks.append(pink.tasks.ComTask(cost=(1.0, 1.0, 1.0 if target.fixed == "xyz" else 0.0)))
            tasks[-1].set_target(np.array(target.goal.translation))
            continue
        frame = model.frames[target.frame]
        name, placed = f"touching {target.name}", frame.placement * target.offset
        model.addFrame(pinocchio.Frame(name, frame.parentJoint, target.frame, placed, pinocchio.FrameType.OP_FRAME), False)
        turning = {"all": (1.0, 1.0, 1.0), "normal": (1.0, 1.0, 0.0), "nothing": 0.0}[target.fixed]
        tasks.append(pink.tasks.FrameTask(name, position_cost=1.0, orientation_cost=turning))
        tasks[-1].set_target(target.goal)
    configuration = pink.Configuration(model, model.createData(), reaching.q0)
    for task in tasks:
        task.gain = GAIN
    for _ in range(STEPS):
        velocity = pink.solve_ik(configuration, tasks, 1.0, solver=SOLVER, safety_break=False)
        configuration.integrate_inplace(velocity, 1.0)
    x = pinocchio.difference(reaching.robot.pin_model, reaching.q0, configuration.q)
    return np.clip(x, reaching.lower, reaching.upper)
