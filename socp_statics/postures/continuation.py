"""Continuation: the posture nearest to a reference, followed from one centre of mass to the next while the contacts stay."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from socp_statics.exceptions import InputError
from socp_statics.postures.inverse_kinematics import reach
from socp_statics.postures.moved import posture_on
from socp_statics.postures.placements import read_placements
from socp_statics.postures.posture import Posture
from socp_statics.postures.reaching import Reaching, targets_of
from socp_statics.spatial import Array

CORRECTIONS, ACTIVE_SETS, QUICK, THOROUGH = 15, 60, 40, 400
BY_ALL, WITHOUT_CURVATURE = 8, 8
SETTLED, PLACED, DIFFERENCE = 1e-7, 1e-10, 1e-6
MISSED = 1e-9
JUMP = 0.3
NOTICED, GAIN = 1e-3, 1e-3
REGULAR = 1e-16
Which = NDArray[np.bool_]


class Followed(NamedTuple):
    """A posture on the way.

    Attributes:
        x: Its place in the tangent space at the reference: six rates of the base, then one entry a joint, shape (6 + n,).
        y: Multipliers of placements and centre of mass, shape (m,).
    """

    x: Array
    y: Array


class Approach(NamedTuple):
    """How near a posture comes to a centre of mass that may be out of reach.

    Attributes:
        x: The nearest approach, shape (6 + n,).
        farthest: What stays farthest from its place: a contact or ``"com"``.
        miss: By how much [m, rad].
        unit: Of that: "m" or "rad".
        joints: Joints whose limits hold it back, the strongest first.
        settled: Whether no small motion comes nearer.
    """

    x: Array
    farthest: str
    miss: float
    unit: str
    joints: tuple[str, ...]
    settled: bool

    @property
    def out_of_reach(self) -> bool:
        """Whether contacts and centre of mass cannot all come to their places by small motions."""
        return self.settled and self.miss > MISSED


class Continuation:
    """Postures whose contacts stay where those of a reference are, while the centre of mass goes somewhere else.

    Every posture is a local minimum of half the squared distance to the reference in the tangent space at it, joints in rad (m where
    they slide) and the base in m and rad, over the contact placements, the position of the centre of mass and the joint limits.

    Args:
        reference: The posture to stay near; its contacts are the ones that stay. The environment decides the normals of contacts at a
            point, whose links are free to turn about them.
        with_height: Whether the height of the centre of mass is asked for too.
    """

    def __init__(self, reference: Posture, with_height: bool):
        robot, contacts = reference.robot, reference.contacts
        self.reference = reference
        self._friction = {c.name: c.friction for c in contacts}
        self._placements = {c.name: (c.position, c.rotation) for c in contacts}
        places = read_placements(robot, self._placements)
        self._orientations = {c.name: c.rotation for c in contacts if places[c.name].fixed != "all"}
        self._rows = 3 if with_height else 2
        self._reaching = Reaching(robot, np.array(reference.q), targets_of(robot, places, np.zeros(self._rows), None))
        start = np.zeros(robot.pin_model.nv)
        self.start = Followed(start, np.zeros(len(self._reaching.residual(start))))

    def com(self, x: Array) -> Array:
        """Centre of mass ``com_W`` at a point of the tangent space, shape (3,) [m]."""
        return self._reaching.com(x)

    def posture(self, x: Array) -> Posture:
        """The posture at a point of the tangent space of the reference, shape (6 + n,)."""
        return posture_on(self.reference, self._reaching.configuration(x), orientations=self._orientations)

    def step(self, here: Followed, com: ArrayLike) -> Followed | None:
        """The nearest posture with another centre of mass, from one that is not far away.

        Newton on the optimality conditions, active sets for the joint limits, second derivatives of the placements by differences at the
        start: the first iteration is the predictor.

        Args:
            here: Where to start.
            com: Centre of mass, its first two or three entries are asked for [m].

        Returns:
            Where placements hold to 1e-10 m and rad and the posture has settled to 1e-7; None where that did not happen, where it is no
            minimum, or where an entry of x would jump by more than 0.3.
        """
        reaching = self._reaching
        lower, upper, x, y = reaching.lower, reaching.upper, here.x, here.y
        B = self._curvature(x, y)
        wants = reaching.jacobian(x).T @ y
        low, high = wants < lower, wants > upper
        for _ in range(CORRECTIONS):
            r, J = self._missing(x, com), reaching.jacobian(x)
            found = _bounded_step(B, J, x, r, lower, upper, (low, high))
            if found is None:
                return None
            d, y, low, high = found
            x = np.clip(x + d, lower, upper)
            if np.abs(x - here.x).max() > JUMP:
                return None
            if np.abs(d).max() <= SETTLED and np.abs(self._missing(x, com)).max() <= PLACED:
                return Followed(x, y) if _is_minimum(B, J, ~(low | high)) else None
        return None

    def _curvature(self, x: Array, y: Array) -> Array:
        """Second derivatives of the distance less those of the placements times their multipliers, shape (6 + n, 6 + n)."""
        n = len(x)
        if not y.any():
            return np.eye(n)
        here, columns = self._reaching.jacobian(x).T @ y, np.empty((n, n))
        for k in range(n):
            beside = x.copy()
            beside[k] += DIFFERENCE
            columns[:, k] = (self._reaching.jacobian(beside).T @ y - here) / DIFFERENCE
        return np.eye(n) - 0.5 * (columns + columns.T)

    def approach(self, x: Array, com: ArrayLike, iterations: int = QUICK) -> Approach:
        """How near placements and centre of mass come to where they have to be, by least squares within the joint limits.

        Damped Gauss-Newton, then Newton: where limbs stretch, the curvature of the placements counts as much as their slope.

        Args:
            x: Where to start, shape (6 + n,).
            com: Centre of mass [m].
            iterations: How long to try; limbs that are stretched take many.

        Returns:
            The nearest approach, a local one, with what holds it back.
        """
        lower, upper, damping, settled = self._reaching.lower, self._reaching.upper, 1e-6, False
        near = np.clip(x, lower, upper)
        for k in range(iterations):
            r, J = self._missing(near, com), self._reaching.jacobian(near)
            pull, size = -J.T @ r, float(np.linalg.norm(r))
            free = ~((near <= lower) & (pull < 0.0) | (near >= upper) & (pull > 0.0))
            bending = np.eye(len(near)) - self._curvature(near, r) if k >= WITHOUT_CURVATURE else 0.0
            curvatures, directions = np.linalg.eigh((J.T @ J + bending)[np.ix_(free, free)])
            along, bent = directions.T @ pull[free], np.maximum(np.abs(curvatures), 1e-9)
            settled = k >= WITHOUT_CURVATURE and bool(along @ (along / bent) <= GAIN * size**2 and (curvatures >= -GAIN * size).all())
            if np.abs(r).max() <= PLACED or settled or damping > 1e6:
                break
            trial = near.copy()
            trial[free] += directions @ (along / (bent + damping))
            trial = np.clip(trial, lower, upper)
            if float(np.linalg.norm(self._missing(trial, com))) < size:
                near, damping = trial, max(damping / 10, 1e-12)
            else:
                damping *= 10
        r = self._missing(near, com)
        pull = -self._reaching.jacobian(near).T @ r / max(float(np.linalg.norm(r)), 1e-300)
        held = ((near <= lower) & (pull < -NOTICED)) | ((near >= upper) & (pull > NOTICED))
        order = [k for k in np.argsort(-np.round(np.abs(pull), 6), kind="stable") if held[k]]
        joints = tuple(self.reference.robot.joints[k - 6] for k in order)
        return Approach(near, *self._reaching.worst_in(r), joints, settled)

    def resumed(self, here: Followed, com: ArrayLike) -> Followed | None:
        """A step where `step` fails: from the nearest approach, then from what inverse kinematics finds.

        Args:
            here: Where `step` failed.
            com: Centre of mass [m].

        Returns:
            None where neither leads to a posture that this one moves into.
        """
        for start in (self._approached, self._found_by_reach):
            x = start(here, com)
            if x is None or np.abs(x - here.x).max() > JUMP:
                continue
            free = (x > self._reaching.lower) & (x < self._reaching.upper)
            y = np.linalg.lstsq(self._reaching.jacobian(x)[:, free].T, x[free], rcond=None)[0]
            there = self.step(Followed(x, np.asarray(y, dtype=float)), com)
            if there is not None and np.abs(there.x - here.x).max() <= JUMP:
                return there
        return None

    def _approached(self, here: Followed, com: ArrayLike) -> Array | None:
        approach = self.approach(here.x, com)
        return approach.x if approach.miss <= MISSED else None

    def _found_by_reach(self, here: Followed, com: ArrayLike) -> Array | None:
        import pinocchio

        robot, asked = self.reference.robot, np.asarray(com, dtype=float)[: self._rows]
        try:
            posture = reach(robot, self._placements, friction=self._friction, com=asked, reference=self.reference, restarts=0)
        except InputError:
            return None
        return pinocchio.difference(robot.pin_model, self._reaching.q0, posture.q)

    def _missing(self, x: Array, com: ArrayLike) -> Array:
        """Residuals of contacts and centre of mass; the target of `Reaching` is the origin."""
        r = self._reaching.residual(x).copy()
        r[-self._rows :] -= np.asarray(com, dtype=float)[: self._rows]
        return r


def _bounded_step(
    B: Array, J: Array, x: Array, r: Array, lower: Array, upper: Array, bound: tuple[Which, Which]
) -> tuple[Array, Array, Which, Which] | None:
    """The step d of least ``x'd + d'B d / 2`` with ``J d = -r`` and ``x + d`` between bounds, by active sets.

    All entries that are wrong change sides at once; where that goes round in circles, the first of them alone (Murty's rule).

    Args:
        B: Shape (n, n).
        J: Shape (m, n).
        x: Shape (n,).
        r: Shape (m,).
        lower: Shape (n,).
        upper: Shape (n,).
        bound: Which entries start at their lower and upper bounds, shapes (n,).

    Returns:
        The step, multipliers, and which entries end at their bounds; None where the sets did not settle.
    """
    low, high = bound
    m = len(r)
    for attempt in range(ACTIVE_SETS):
        free = ~(low | high)
        d = np.where(low, lower - x, np.where(high, upper - x, 0.0))
        k = int(free.sum())
        system = np.zeros((k + m, k + m))
        system[:k, :k], system[k:, :k], system[:k, k:] = B[np.ix_(free, free)], J[:, free], J[:, free].T
        system[range(k, k + m), range(k, k + m)] = -REGULAR
        try:
            solved = np.linalg.solve(system, np.concatenate([-(x + B @ d)[free], -r - J @ d]))
        except np.linalg.LinAlgError:
            return None
        d[free], y = solved[:k], -solved[k:]
        push = J.T @ y - x - B @ d
        wrong = (low & (push >= 0.0)) | (high & (push <= 0.0)) | (free & ((x + d < lower) | (x + d > upper)))
        if not wrong.any():
            return (d, y, low, high) if np.isfinite(d).all() else None
        if attempt >= BY_ALL:
            wrong[int(np.argmax(wrong)) + 1 :] = False
        low, high = np.where(wrong, free & (x + d < lower), low), np.where(wrong, free & (x + d > upper), high)
    return None


def _is_minimum(B: Array, J: Array, free: Which) -> bool:
    """Whether the curvature is positive along everything that keeps placements and active joint limits."""
    turned = np.linalg.qr(J[:, free].T, mode="complete")[0][:, len(J) :]
    try:
        np.linalg.cholesky(turned.T @ B[np.ix_(free, free)] @ turned)
    except np.linalg.LinAlgError:
        return False
    return True
