"""StaticsData: the one bridge between mechanics and convex optimisation, plain arrays in scaled units."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from socp_statics.spatial import Array
from socp_statics.statics.joint_torques import NONE as NO_TORQUES
from socp_statics.statics.joint_torques import JointTorques
from socp_statics.statics.units import Units

Indices = NDArray[np.int_]


@dataclass(frozen=True, eq=False)
class StaticsData:
    """The convex set of a stance: ``{x : G x + L + D c = 0, forces in cones, bounds and limits}``.

    The unknown is ``x = (f_t, f_n, m_n, h)``: tangential forces at the points with friction (t1, t2 point by point), normal
    forces at all unilateral points, torsional moments at the soft fingers, components of the handles; all in contact frames.
    Points are ordered: circular cones (soft fingers of box type last), elliptic soft fingers, frictionless points.

    Attributes:
        units: What one is, in SI.
        circular: Number of points with the cone |f_t| <= mu f_n, boxes included.
        box: Number of box soft fingers, the last of the circular points.
        elliptic: Number of elliptic soft fingers.
        frictionless: Number of points that carry a normal force only.
        wrench_map: G, wrench of x about the origin in world axes, shape (6, nx).
        load: L, impressed wrench of gravity and external wrenches about the origin, shape (6,).
        com_load: D, change of the load per unit displacement of the centre of mass along world x and y, shape (6, 2).
        com: Centre of mass relative to the origin, shape (3,).
        friction: mu of the points with friction, shape (circular + elliptic,).
        torsion: gamma of the soft fingers, boxes first, shape (box + elliptic,).
        contact_of_point: Index of each point's contact, shape (points,).
        contact_of_handle: Index of each handle component's contact, shape (nh,).
        component_of_handle: Index of each handle component in (fx, fy, fz, mx, my, mz), shape (nh,).
        bounded: Indices of the contacts whose normal force is bounded, shape (nb,).
        bounds: Their ``[lo, hi]``, shape (nb, 2).
        limit_rows: H of the hard rows ``H x <= d``: handle limits, then torque limits, shape (nl, nx).
        limit_values: d, shape (nl,).
        limit_names: What each hard row limits, length nl.
        rotation: R_WC of each contact, shape (contacts, 3, 3).
        position: Position of each contact relative to the origin, shape (contacts, 3).
        point: Each point relative to the origin, shape (points, 3).
        names: Contact names.
        torques: Joint torques as a function of x, empty without a robot; their limits are among the hard rows.
    """

    units: Units
    circular: int
    box: int
    elliptic: int
    frictionless: int
    wrench_map: Array
    load: Array
    com_load: Array
    com: Array
    friction: Array
    torsion: Array
    contact_of_point: Indices
    contact_of_handle: Indices
    component_of_handle: Indices
    bounded: Indices
    bounds: Array
    limit_rows: Array
    limit_values: Array
    limit_names: tuple[str, ...]
    rotation: Array
    position: Array
    point: Array
    names: tuple[str, ...]
    torques: JointTorques = NO_TORQUES

    @property
    def points(self) -> int:
        """Number of unilateral contact points."""
        return self.circular + self.elliptic + self.frictionless

    @property
    def slipping(self) -> int:
        """Number of points with friction."""
        return self.circular + self.elliptic

    @property
    def tangential(self) -> slice:
        """Where f_t is in x."""
        return slice(0, 2 * self.slipping)

    @property
    def normal(self) -> slice:
        """Where f_n is in x."""
        return slice(2 * self.slipping, 2 * self.slipping + self.points)

    @property
    def torsional(self) -> slice:
        """Where m_n is in x."""
        start = 2 * self.slipping + self.points
        return slice(start, start + self.box + self.elliptic)

    @property
    def handle_limits(self) -> int:
        """Number of hard rows that are handle limits; the others are torque limits."""
        return len(self.limit_names) - int(self.torques.limits.size - (~np.isfinite(self.torques.limits)).sum())

    @property
    def handle(self) -> slice:
        """Where h is in x."""
        start = 2 * self.slipping + self.points + self.box + self.elliptic
        return slice(start, self.wrench_map.shape[1])
