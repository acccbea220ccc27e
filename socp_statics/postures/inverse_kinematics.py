"""Inverse kinematics: the posture nearest to a reference whose contacts are exactly where they are asked to be."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.exceptions import InputError
from socp_statics.postures.placements import read_base, read_com, read_placements
from socp_statics.postures.posture import Posture, posture_at
from socp_statics.postures.reaching import Reaching, targets_of
from socp_statics.postures.soft_tasks import soft_start
from socp_statics.postures.starting_posture import laid_over
from socp_statics.postures.working_memory import working_memory
from socp_statics.robots import Robot
from socp_statics.spatial import Array

EXACT = 1e-9
POLISHED = 1e-13
POLISHING_STEPS = 12
ACCURACY = 1e-8
ITERATIONS = 50
APPROACH = 100
# bounds that least squares may start on, and what counts as on a joint limit [rad]
INSIDE, AT_ITS_LIMIT = 1e-6, 1e-4
NAMED = 3
SPREAD = 0.5


def reach(
    robot: Robot,
    placements: Mapping[str, Any],
    *,
    friction: float | Mapping[str, float] = 0.5,
    com: ArrayLike | None = None,
    base: Any = None,
    reference: Mapping[str, float] | ArrayLike | Posture | None = None,
    aligned: Sequence[str] = (),
    seed: int = 0,
    restarts: int = 3,
) -> Posture:
    """The posture near a reference whose contacts are where they are asked to be, to 1e-9 m and rad, within the joint limits.

    Minimises half the squared distance to the reference in the tangent space of the configurations (joints [rad], base [m, rad])
    subject to the placements, by SciPy's SLSQP with Pinocchio's Jacobians; what remains is taken out by Newton steps. Where that
    fails it starts again from Pink's soft tasks (with the extra ``ik``), then from seeded random postures. The answer is a local optimum.
    Bodies may cross each other and the environment: nothing checks collisions.

    Args:
        robot: The robot.
        placements: Contact name to its position [m] alone, or to ``(position, orientation)``; the orientation is a normal, shape (3,), or a
            rotation ``R_WC``, shape (3, 3). Surfaces and lines take their whole frame from it, level by default. Of a
            contact at a point it says what it touches and leaves the link free; without it the link decides.
        friction: Coulomb coefficient of all contacts, or by contact.
        com: Where the centre of mass has to be: (x, y) or (x, y, z) [m].
        base: Where the base has to be: a position [m], or ``(position, R_WB)``.
        reference: Joint angles to keep near, as in `pose`, or a posture, whose base counts as well; the robot's own by default [rad].
        aligned: Contacts at a point whose own normal has to point along the one they are given.
        seed: Of the random starts.
        restarts: How many random starts to try.

    Returns:
        The posture, in contact with all placements.

    Raises:
        InputError: An unknown contact, a wrong number, or no posture was found; then the sentence names what stays farthest from
            its place and the joints that are at their limits.
    """
    places, fixed_base = read_placements(robot, placements, aligned), read_base(base)
    if isinstance(reference, Posture):
        q0 = np.array(reference.q)
    else:
        q0 = laid_over(robot, robot.reference if reference is None else robot.angles(reference), places)
    reaching = Reaching(robot, q0, targets_of(robot, places, read_com(com), fixed_base))
    tried = []
    for start in _starts(reaching, seed, restarts):
        x = _polished(reaching, _nearest(reaching, start))
        if np.abs(reaching.residual(x)).max() <= EXACT:
            orientations = {name: place.rotation for name, place in places.items() if place.rotation is not None and place.fixed != "all"}
            if all(_outward(reaching, name, x) for name in aligned):
                return posture_at(robot, reaching.configuration(x), tuple(places), friction, orientations)
        tried.append(x)
    raise _cannot_reach(reaching, tried)


def _starts(reaching: Reaching, seed: int, restarts: int) -> Iterator[Array]:
    """Points to start from: the reference, what soft tasks make of it, random joint angles."""
    zero = np.clip(np.zeros(reaching.robot.pin_model.nv), reaching.lower, reaching.upper)
    yield zero
    soft = soft_start(reaching)
    if soft is not None:
        yield soft
    rng = np.random.default_rng(seed)
    lower, upper = np.maximum(reaching.lower, -np.pi), np.minimum(reaching.upper, np.pi)
    for _ in range(restarts):
        x = zero + SPREAD * rng.uniform(size=len(zero)) * (rng.uniform(lower, upper) - zero)
        x[:6] = 0.2 * rng.standard_normal(6)
        yield x


def _nearest(reaching: Reaching, start: Array) -> Array:
    """Where SLSQP ends, inside the joint limits."""
    from scipy.optimize import minimize

    found = minimize(
        lambda x: 0.5 * float(x @ x),
        start,
        jac=lambda x: x,
        method="SLSQP",
        bounds=list(zip(reaching.lower, reaching.upper, strict=True)),
        constraints={"type": "eq", "fun": reaching.residual, "jac": reaching.jacobian},
        options={"ftol": ACCURACY, "maxiter": ITERATIONS},
    )
    return np.clip(found.x, reaching.lower, reaching.upper) if np.isfinite(found.x).all() else start


def _polished(reaching: Reaching, x: Array) -> Array:
    """Shortest Newton steps of the joints that are not at their limits, as long as they help."""
    best, missing = x, np.abs(reaching.residual(x)).max()
    for _ in range(POLISHING_STEPS):
        if missing <= POLISHED or missing > 1e-2:
            break
        r, J = reaching.residual(best), reaching.jacobian(best)
        free = (best > reaching.lower) & (best < reaching.upper)
        step = np.zeros(len(best))
        step[free] = np.linalg.lstsq(J[:, free], -r, rcond=1e-12)[0]
        trial = np.clip(best + step, reaching.lower, reaching.upper)
        now = np.abs(reaching.residual(trial)).max()
        if now >= missing:
            break
        best, missing = trial, now
    return best


def _outward(reaching: Reaching, name: str, x: Array) -> bool:
    """Whether an aligned contact points along its normal and not against it."""
    import pinocchio

    target = next(target for target in reaching.targets if target.name == name)
    data = working_memory(reaching.robot)
    pinocchio.forwardKinematics(reaching.robot.pin_model, data, reaching.configuration(x))
    placed = pinocchio.updateFramePlacement(reaching.robot.pin_model, data, target.frame) * target.offset
    return float(placed.rotation[:, 2] @ target.goal.rotation[:, 2]) > 0.0


def _cannot_reach(reaching: Reaching, tried: Sequence[Array]) -> InputError:
    """The sentence that names what stays farthest from its place at the nearest approach, and the joints that hold it back."""
    from scipy.optimize import least_squares

    start = min(tried, key=lambda x: float(np.sum(reaching.residual(x) ** 2)))
    bounds = (reaching.lower - INSIDE, reaching.upper + INSIDE)
    x = least_squares(reaching.residual, np.clip(start, reaching.lower, reaching.upper), reaching.jacobian, bounds, max_nfev=APPROACH).x
    worst, miss, unit = reaching.worst(x)
    robot = reaching.robot
    what = f"contact '{worst}'" if worst in robot.frames else {"com": "the centre of mass", "base": "the base"}[worst]
    # a joint at its limit holds back where the residual would shrink beyond it
    pull = -reaching.jacobian(x).T @ reaching.residual(x)
    low, high = x < reaching.lower + AT_ITS_LIMIT, x > reaching.upper - AT_ITS_LIMIT
    held = np.where((low & (pull < 0.0)) | (high & (pull > 0.0)), np.abs(pull), 0.0)[6:]
    limits = ", ".join(robot.joints[k] for k in np.argsort(-held, kind="stable")[:NAMED] if held[k] > 0.0)
    why = f" with {limits} at the joint limit" if limits else ", its limbs are too short or its places contradict each other"
    message = f"robot '{robot.name}': cannot reach: {what} stays {miss:.3g} {unit} from its place{why}"
    return InputError(message, name=worst, field="placements")
