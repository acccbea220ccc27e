"""How far a configuration is from what inverse kinematics is asked for, and how that changes with it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from socp_statics.postures.placements import Placement
from socp_statics.postures.working_memory import working_memory
from socp_statics.robots import Robot
from socp_statics.spatial import Array, skew


@dataclass(frozen=True, eq=False)
class Target:
    """One thing that has to be somewhere.

    Attributes:
        name: Name of the contact, ``"com"`` or ``"base"``.
        frame: Index of the frame of the model; -1 for the centre of mass.
        offset: Placement of the contact frame in it, ``pinocchio.SE3``.
        goal: Where it has to be, ``pinocchio.SE3``.
        fixed: ``"all"``: position and orientation, six rows; ``"normal"``: position and normal, five; ``"nothing"``: position, three;
            of the centre of mass ``"xy"`` or ``"xyz"``.
    """

    name: str
    frame: int
    offset: Any
    goal: Any
    fixed: str

    @property
    def rows(self) -> int:
        """Number of equations."""
        return {"all": 6, "normal": 5, "nothing": 3, "xyz": 3, "xy": 2}[self.fixed]


@dataclass(eq=False)
class Reaching:
    """Residuals [m, rad] of all targets over the tangent space at a configuration: ``q(x) = integrate(q0, x)``.

    ``x`` has the six rates of the base first (body axes), then one entry a joint; a joint angle is that of ``q0`` plus its entry.

    Attributes:
        robot: The robot.
        q0: Configuration the tangent space is attached to, shape (nq,).
        targets: The targets.
        lower: Least x, shape (6 + n,); the base has no bounds.
        upper: Largest x, shape (6 + n,).
    """

    robot: Robot
    q0: Array
    targets: tuple[Target, ...]
    lower: Array = field(init=False)
    upper: Array = field(init=False)
    _at: bytes | None = field(init=False, default=None, repr=False)
    _known: tuple[Array, Array] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        angles, free = self.robot.joint_angles(self.q0), np.full(6, np.inf)
        self.lower = np.concatenate([-free, self.robot.lower - angles])
        self.upper = np.concatenate([free, self.robot.upper - angles])

    def configuration(self, x: Array) -> Array:
        """The configuration ``q(x)``, shape (nq,)."""
        import pinocchio

        return pinocchio.integrate(self.robot.pin_model, self.q0, x)

    def residual(self, x: Array) -> Array:
        """What is missing [m, rad], shape (m,)."""
        return self._evaluate(x)[0]

    def jacobian(self, x: Array) -> Array:
        """Its derivative along x, shape (m, 6 + n)."""
        return self._evaluate(x)[1]

    def com(self, x: Array) -> Array:
        """Centre of mass ``com_W``, shape (3,) [m]."""
        import pinocchio

        return pinocchio.centerOfMass(self.robot.pin_model, working_memory(self.robot), self.configuration(x), False).copy()

    def worst(self, x: Array) -> tuple[str, float, str]:
        """The target that misses most: its name, by how much, and the unit of that, "m" or "rad"."""
        return self.worst_in(self.residual(x))

    def worst_in(self, residual: Array) -> tuple[str, float, str]:
        """The target with the largest entry of a residual, shape (m,): its name, that entry, and the unit of it, "m" or "rad"."""
        size = np.abs(residual)
        row = int(size.argmax())
        for target in self.targets:
            if row < target.rows:
                # log6 has the translation first
                return target.name, float(size.max()), "m" if row < 3 else "rad"
            row -= target.rows
        raise AssertionError("more rows than the targets have")

    def _evaluate(self, x: Array) -> tuple[Array, Array]:
        here = x.tobytes()
        if here != self._at:
            self._known, self._at = self._compute(x), here
        return self._known

    def _compute(self, x: Array) -> tuple[Array, Array]:
        import pinocchio

        model, data = self.robot.pin_model, working_memory(self.robot)
        pinocchio.computeJointJacobians(model, data, self.configuration(x))
        if any(target.frame < 0 for target in self.targets):
            pinocchio.jacobianCenterOfMass(model, data, False)
        parts = [_com_rows(data, target) if target.frame < 0 else _frame_rows(model, data, target) for target in self.targets]
        r, J = np.concatenate([part[0] for part in parts]), np.vstack([part[1] for part in parts])
        # joints add up, the free flyer moves along the exponential
        J[:, :6] = J[:, :6] @ pinocchio.Jexp6(pinocchio.Motion(x[:6]))
        return r, J


def _com_rows(data: Any, target: Target) -> tuple[Array, Array]:
    return (data.com[0] - target.goal.translation)[: target.rows], data.Jcom[: target.rows]


def _frame_rows(model: Any, data: Any, target: Target) -> tuple[Array, Array]:
    import pinocchio

    placed = pinocchio.updateFramePlacement(model, data, target.frame) * target.offset
    J_F = pinocchio.getFrameJacobian(model, data, target.frame, pinocchio.LOCAL)
    J_C = target.offset.toActionMatrixInverse() @ J_F
    if target.fixed == "all":
        error = target.goal.actInv(placed)
        return pinocchio.log6(error).vector, pinocchio.Jlog6(error) @ J_C
    r, J = placed.translation - target.goal.translation, placed.rotation @ J_C[:3]
    if target.fixed == "nothing":
        return r, J
    across = target.goal.rotation[:, :2].T
    turned = across @ placed.rotation
    return np.concatenate([r, turned[:, 2]]), np.vstack([J, -turned @ skew((0.0, 0.0, 1.0)) @ J_C[3:]])


def targets_of(robot: Robot, placements: Mapping[str, Placement], com: Array | None, base: Placement | None) -> tuple[Target, ...]:
    """The targets of a question.

    Args:
        robot: The robot.
        placements: Where its contacts have to be.
        com: Where its centre of mass has to be, shape (2,) or (3,) [m], or None.
        base: Where its base has to be, or None.

    Returns:
        Contacts first, then centre of mass, then base.
    """
    import pinocchio

    found = []
    for name, placement in placements.items():
        frame = robot.frames[name]
        offset = pinocchio.SE3(np.array(frame.rotation), np.array(frame.position))
        found.append(Target(name, robot.frame_id(frame.frame, name), offset, _goal(placement), placement.fixed))
    if com is not None:
        goal = pinocchio.SE3(np.eye(3), np.array([*com, 0.0][:3]))
        found.append(Target("com", -1, pinocchio.SE3.Identity(), goal, "xy" if len(com) == 2 else "xyz"))
    if base is not None:
        found.append(Target("base", robot.frame_id(robot.base), pinocchio.SE3.Identity(), _goal(base), base.fixed))
    return tuple(found)


def _goal(placement: Placement) -> Any:
    import pinocchio

    rotation = np.eye(3) if placement.rotation is None else np.array(placement.rotation)
    return pinocchio.SE3(rotation, np.array(placement.position))
