"""The disturbances that can be balanced, asked one direction at a time: a point with forces, a half-space with a motion."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from socp_statics.certificates import MotionCertificate, force_residuals, motion_certificate, motion_of
from socp_statics.cones.choice import ConeChoice
from socp_statics.engines.engine import Engine
from socp_statics.engines.solution import SOLVED, Solution
from socp_statics.exceptions import EngineError
from socp_statics.models.contact_forces_set import force_shape, force_values
from socp_statics.models.disturbance import MODEL, DisturbanceShape
from socp_statics.spatial import Array
from socp_statics.stability.robustness.disturbances import Disturbance
from socp_statics.statics import StaticsData, wrench_range
from socp_statics.statics.added_load import with_load

ACCEPTED = 1e-8
OUT_OF_REACH = 1e-9
# Farthest disturbance looked at, in units of W, and the share of it beyond which the clip is what stops it.
FAR = 1e3
EDGE = 0.999
# How far beyond the limit its motion is certified, as a share of the limit or of W: the least that rounding allows.
BEYOND = (1e-7, 1e-6, 1e-5, 1e-4)
ENDLESS = 1e-6


class Support(NamedTuple):
    """A direction, the farthest disturbance found along it, and how far no disturbance that can be balanced goes.

    Attributes:
        direction: Unit vector, shape (k,).
        point: A disturbance that can be balanced, shape (k,).
        height: ``direction . z`` is at most this.
        solution: Forces and multipliers behind both.
        clipped: Whether only the clip stopped it.
    """

    direction: Array
    point: Array
    height: float
    solution: Solution
    clipped: bool


class LoadSlice:
    """The set of disturbances that can be balanced, in one session of one engine.

    Args:
        data: The stance's arrays.
        disturbance: In coordinates that all matter (`Disturbance.seen`).
        cone: Exact cones or pyramids.
        form: "socp" or "sdp".
        engine: The engine.
        total: Limit of the sum of the contacts' force magnitudes, scaled; None for no limit.

    Attributes:
        coordinates: k.
        queries: How many programs were solved.
        unreachable: A direction that no contact force resists, shape (k,), or None.
    """

    def __init__(self, data: StaticsData, disturbance: Disturbance, cone: ConeChoice, form: str, engine: Engine,
                 total: float | None = None):  # fmt: skip
        self.data, self.disturbance, self.cone, self.form, self.engine = data, disturbance, cone, form, engine
        self.B, self.relief = disturbance.wrench, disturbance.relief(data)
        self.coordinates = self.B.shape[1]
        self.queries = 0
        reach = wrench_range(data.wrench_map)
        self._basis = reach.basis
        self.unreachable = _unreachable(reach.null.T @ self.B)
        contacts = 0 if total is None else len(data.names)
        shape = DisturbanceShape(force_shape(data, cone, form, reach.rank), self.coordinates, contacts)
        self._values = force_values(data, cone, reach.basis) | {
            "B": reach.basis.T @ self.B,
            "R": self.relief,
            "clip": np.array(FAR),
            "direction": np.eye(self.coordinates)[0] if self.coordinates else np.zeros(0),
        }
        if total is not None:
            self._values |= {"F_contact": resultant_map(data), "total": np.array(total)}
        self._session = engine.compile(MODEL, shape).session(self._values)
        self.clip = FAR

    def clip_at(self, distance: float) -> None:
        """Look at disturbances up to a distance only."""
        self.clip = distance
        self._session.solve(clip=np.array(distance))

    def support(self, direction: Array) -> Support:
        """One query.

        Raises:
            EngineError: The engine did not settle it, or its forces do not check.
        """
        self.queries += 1
        solution = self._session.solve(direction=direction)
        if solution.status != SOLVED:
            raise EngineError(f"engine {self.engine.name} did not settle a disturbance: {solution.detail}", name=self.engine.name)
        z, x = solution.variables["z"], solution.variables["x"]
        held = force_residuals(self.at(z), self.cone, x)
        if max(held) > ACCEPTED * max(1.0, float(np.abs(x).max(initial=0.0))):
            raise EngineError(f"engine {self.engine.name} left a residual of {max(held):.1e} W in a disturbance", name=self.engine.name)
        height = max(float(direction @ z), solution.bound)
        return Support(direction, z, height, solution, height >= EDGE * self.clip)

    def at(self, z: Array) -> StaticsData:
        """The stance's arrays with a disturbance."""
        return with_load(self.data, self.B, self.relief, self.disturbance.torque, z)

    def beyond(self, disturbance: Callable[[float], Array], support: Support) -> MotionCertificate | None:
        """The motion that nothing can prevent just beyond a half-space.

        Args:
            disturbance: How far beyond, as a share -> the disturbance there.
            support: The half-space.

        Returns:
            The motion; None where rounding is larger than the farthest tried.
        """
        duals = support.solution.duals
        for share in BEYOND:
            at = self.at(disturbance(share))
            found = motion_certificate(at, self.cone, motion_of(at, self._basis @ duals["balance"], duals.get("limits")))
            if found is not None:
                return found
        return None

    def unresisted(self, z: Array) -> MotionCertificate | None:
        """The motion of a disturbance that no contact force resists."""
        at, reach = self.at(z), wrench_range(self.data.wrench_map)
        return motion_certificate(at, self.cone, motion_of(at, reach.null @ (reach.null.T @ at.load)))

    def endless(self, directions: Array) -> bool:
        """Whether disturbances along all of some unit directions can grow without end.

        Without load, and with bounds and limits of zero, forces that balance a disturbance may be multiplied by anything.
        """
        bounds = np.where(np.isfinite(self.data.bounds), 0.0, self.data.bounds)
        free = replace(self.data, load=np.zeros(6), bounds=bounds, limit_values=np.zeros_like(self.data.limit_values))
        cone = LoadSlice(free, self.disturbance, self.cone, self.form, self.engine)
        cone.clip_at(1.0)
        return all(float(direction @ cone.support(direction).point) > 1.0 - ENDLESS for direction in directions)


def resultant_map(data: StaticsData) -> Array:
    """Force of each contact in world axes as a linear map of x, shape (3 contacts, nx)."""
    F = np.zeros((len(data.names), 3, data.wrench_map.shape[1]))
    slipping = np.repeat(data.contact_of_point[: data.slipping], 2)
    owner = np.concatenate([slipping, data.contact_of_point, -np.ones(data.box + data.elliptic, dtype=int), data.contact_of_handle])
    for k in range(len(data.names)):
        F[k][:, owner == k] = data.wrench_map[:3, owner == k]
    return F.reshape(-1, F.shape[2])


def _unreachable(missed: Array) -> Array | None:
    """The direction whose wrench is farthest out of reach of the contacts, if it is."""
    if not missed.size:
        return None
    _, s, Vt = np.linalg.svd(missed, full_matrices=False)
    return Vt[0] if s[0] > OUT_OF_REACH else None
