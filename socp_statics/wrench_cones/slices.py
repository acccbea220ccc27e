"""Gravito-inertial slices of a body wrench cone: where the centre of mass may be, or how it may accelerate.

The contacts have to supply ``[m (a - g); (c - o) x m (a - g)]`` less what external wrenches supply: affine in the position c for a
chosen acceleration, and in the acceleration a for a given position. A slice is the set of those two numbers for which the wrench lies
in the cone. Its support function is a linear program: over two numbers where the cone has a face form, else over its rays.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import linprog

from socp_statics.contacts.numbers import scalar, vector
from socp_statics.contacts.stance import GRAVITY_W, ExternalWrench, as_external_wrench
from socp_statics.exceptions import EngineError, InputError
from socp_statics.spatial import Array, cross
from socp_statics.wrench_cones.forms import FaceForm, units, vectors
from socp_statics.wrench_cones.wrench_cone import WrenchCone

PRECISE = {"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10}
REACH = 10.0
NEW_CORNER = 1e-8
START = ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0))


@dataclass(frozen=True, eq=False)
class WrenchSlice:
    """``{x in R^2 : F_0 + D x in the cone}``, looked at inside a square.

    Attributes:
        cone: The body wrench cone, over pyramids.
        offset: F_0, shape (6,) [N, N m].
        slope: D, shape (6, 2).
        centre: Centre of the square, shape (2,).
        reach: Its half-side.
        unit: Unit of the two numbers.
    """

    cone: WrenchCone
    offset: Array
    slope: Array
    centre: Array
    reach: float
    unit: str

    def contains(self, x: ArrayLike, tolerance: float = 1e-8) -> Any:
        """Whether the wrench at x lies in the cone, inside the square or not.

        Args:
            x: Shape (2,) or (n, 2).
            tolerance: As in `WrenchCone.contains`.
        """
        return self.cone.contains(self.offset + vectors(x, 2, "x") @ self.slope.T, tolerance)

    def support(self, direction: ArrayLike) -> Array | None:
        """A point of the slice that lies furthest in a direction, inside the square; None where the slice is empty there.

        Args:
            direction: Shape (2,).

        Raises:
            InputError: Wrong shape (field ``direction``).
            EngineError: The linear program was not settled.
        """
        d = vectors(direction, 2, "direction")
        if d.ndim != 1:
            raise InputError(f"direction must have the shape (2,), got {d.shape}", field="direction")
        done = self._linear_program(d)
        if done.status == 2:
            return None
        if done.status != 0:
            raise EngineError(f"the slice of the wrench cone was not settled: {done.message}", name="slice")
        return np.asarray(self.centre + self.reach * done.x[:2])

    @cached_property
    def vertices(self) -> Array:
        """Corners, counter-clockwise, shape (k, 2): none where the slice is empty, two for a segment, one for a point."""
        found: list[Array] = []
        for d in START:
            x = self.support(d)
            if x is None:
                return np.zeros((0, 2))
            if not any(self._same(x, other) for other in found):
                found.append(x)
        k = 0
        while len(found) > 1 and k < len(found):
            a, b = found[k], found[(k + 1) % len(found)]
            outward = np.array([b[1] - a[1], a[0] - b[0]]) / np.linalg.norm(b - a)
            x = self.support(outward)
            if x is not None and outward @ (x - a) > NEW_CORNER * self.reach and not self._same(x, b):
                found.insert(k + 1, x)
            else:
                k += 1
        return np.array(found)

    @property
    def bounded(self) -> bool:
        """False where the square cuts the slice off."""
        return not (np.abs(self.vertices - self.centre) >= self.reach * (1.0 - NEW_CORNER)).any()

    @property
    def area(self) -> float:
        """Area of the slice inside the square [square of the unit]."""
        x, y = (self.vertices - self.centre).T
        return 0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))

    @property
    def by(self) -> str:
        """The word "faces" where the cone has a face form, "support" where the programs run over its rays."""
        return "support" if self._faces is None else "faces"

    @cached_property
    def _faces(self) -> FaceForm | None:
        try:
            return self.cone.faces()
        except (InputError, EngineError):
            return None

    def _linear_program(self, d: Array) -> Any:
        """Maximise ``d . x`` for x in units of the reach about the centre, wrenches in units of the largest."""
        unit = units(6, self.cone.length)
        offset, slope = (self.offset + self.slope @ self.centre) / unit, self.slope * self.reach / unit[:, None]
        size = max(float(np.abs(offset).max()), float(np.abs(slope).max()))
        offset, slope = offset / size, slope / size
        box = [(-1.0, 1.0)] * 2
        if self._faces is not None:
            U, E = self._faces.faces * unit, self._faces.equalities * unit
            return linprog(-d, U @ slope, -U @ offset, E @ slope, -E @ offset, box, method="highs", options=PRECISE)
        generators = self.cone.generators
        V, N = generators.rays() / unit, generators.lines / unit
        V, N = V / np.linalg.norm(V, axis=1, keepdims=True), N / np.linalg.norm(N, axis=1, keepdims=True)
        cost = np.concatenate([-d, np.zeros(len(V) + len(N))])
        balance = np.hstack([-slope, V.T, N.T])
        bounds = [*box, *[(0.0, None)] * len(V), *[(None, None)] * len(N)]
        return linprog(cost, A_eq=balance, b_eq=offset, bounds=bounds, method="highs", options=PRECISE)

    def _same(self, a: Array, b: Array) -> bool:
        return bool(np.abs(a - b).max() <= NEW_CORNER * self.reach)


def com_slice(
    cone: WrenchCone,
    point_W: ArrayLike,
    height: float,
    mass: float,
    *,
    gravity: ArrayLike = GRAVITY_W,
    acceleration: ArrayLike = (0.0, 0.0, 0.0),
    external_wrenches: Iterable[ExternalWrench | dict[str, Any]] = (),
) -> WrenchSlice:
    """Horizontal section of the positions of the centre of mass that the contacts can support while it accelerates.

    Args:
        cone: Of `body_wrench_cone`, over pyramids.
        point_W: The point the cone's moments are about, world axes, shape (3,) [m].
        height: z of the section [m]; matters where gravity less acceleration is not vertical.
        mass: [kg].
        gravity: g, shape (3,) [m/s^2].
        acceleration: a of the centre of mass, shape (3,) [m/s^2]; the angular momentum about it stays as it is.
        external_wrenches: Impressed on the robot, where they are.

    Returns:
        The slice [m], looked at within ten times the cone's length about the point.

    Raises:
        InputError: A wrong number, or an exact cone: `trace_support_region` with gravity g - a answers for those.
    """
    _refuse_exact(cone, "trace_support_region(contacts, gravity=g - a)")
    o, m, g, a = _checked(point_W, mass, gravity, acceleration)
    z = scalar("slice", "height", height, kind="wrench")
    force = m * (a - g)
    offset = np.concatenate([force, cross(np.array([0.0, 0.0, z - o[2]]) - [o[0], o[1], 0.0], force)])
    slope = np.zeros((6, 2))
    slope[3:] = np.column_stack([cross(axis, force) for axis in np.eye(3)[:2]])
    return WrenchSlice(cone, offset - _impressed(external_wrenches, o), slope, o[:2].copy(), REACH * cone.length, "m")


def acceleration_slice(
    cone: WrenchCone,
    point_W: ArrayLike,
    com: ArrayLike,
    mass: float,
    *,
    gravity: ArrayLike = GRAVITY_W,
    vertical: float = 0.0,
    external_wrenches: Iterable[ExternalWrench | dict[str, Any]] = (),
) -> WrenchSlice:
    """Horizontal accelerations of the centre of mass that the contacts can support where it is.

    Args:
        cone: Of `body_wrench_cone`, over pyramids.
        point_W: The point the cone's moments are about, world axes, shape (3,) [m].
        com: Centre of mass, shape (3,) [m].
        mass: [kg].
        gravity: g, shape (3,) [m/s^2].
        vertical: Acceleration along world z [m/s^2].
        external_wrenches: Impressed on the robot.

    Returns:
        The slice [m/s^2], looked at within ten times the magnitude of gravity; the angular momentum stays as it is.

    Raises:
        InputError: A wrong number, or an exact cone: `check_equilibrium` with gravity g - a answers for one acceleration.
    """
    _refuse_exact(cone, "check_equilibrium(contacts, com, mass, gravity=g - a)")
    o, m, g, a = _checked(point_W, mass, gravity, (0.0, 0.0, scalar("slice", "vertical", vertical, kind="wrench")))
    arm = vector("slice", "com", com, 3, kind="wrench") - o
    columns = np.vstack([np.eye(3), cross(arm, np.eye(3)).T]) * m
    offset = columns @ (a - g) - _impressed(external_wrenches, o)
    return WrenchSlice(cone, offset, columns[:, :2], np.zeros(2), REACH * (float(np.linalg.norm(g)) or 1.0), "m/s^2")


def _checked(point_W: ArrayLike, mass: float, gravity: ArrayLike, acceleration: ArrayLike) -> tuple[Array, float, Array, Array]:
    o = vector("slice", "point", point_W, 3, kind="wrench")
    g, a = (vector("slice", word, value, 3, kind="wrench") for word, value in (("gravity", gravity), ("acceleration", acceleration)))
    return o, scalar("slice", "mass", mass, above=0.0, kind="wrench"), g, a


def _impressed(wrenches: Iterable[ExternalWrench | dict[str, Any]], o: Array) -> Array:
    total = np.zeros(6)
    for wrench in (as_external_wrench(w) for w in wrenches):
        total += np.concatenate([wrench.force, wrench.moment_about(o)])
    return total


def _refuse_exact(cone: WrenchCone, instead: str) -> None:
    if cone.is_exact:
        message = f"cone must be inscribed or circumscribed to be sliced by linear programs, got 'exact'; ask {instead}"
        raise InputError(message, field="cone")
