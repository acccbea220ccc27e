"""The natural units of a stance: forces in units of its load, lengths in units of its size, moments about its centre.

Conditioning then depends neither on where the robot stands nor on whether it weighs 10 g or 4000 t.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from socp_statics.contacts import Stance
from socp_statics.spatial import Array

# Share of W within which a margin of zero decides nothing.
BOUNDARY = 1e-7


@dataclass(frozen=True, eq=False)
class Units:
    """Scale of a stance.

    Attributes:
        force: W, the largest of the weight, the external forces and the external moments over the size; 1 N if all are zero [N].
        length: Largest distance between contact points, 1 m if there is none [m].
        origin: Mean contact point in world axes, shape (3,) [m].
    """

    force: float
    length: float
    origin: Array

    @property
    def wrench(self) -> Array:
        """What one scaled unit of each wrench component is, shape (6,) [N, N m]."""
        return np.repeat([self.force, self.force * self.length], 3)

    def twist_in_si(self, motion: Array) -> tuple[Array, Array]:
        """Linear velocity at the origin and angular velocity of a scaled motion.

        Args:
            motion: Dual of a scaled wrench, shape (6,).

        Returns:
            ``(v, w)`` such that a scaled unit of velocity is 1 m/s, shapes (3,) [m/s] and (3,) [rad/s].
        """
        return motion[:3].copy(), motion[3:] / self.length


def units_of(stance: Stance) -> Units:
    """The units of a stance, as the contract defines W and size."""
    size = stance.contacts.size
    loads = [stance.weight]
    for wrench in stance.external_wrenches:
        loads += [float(np.linalg.norm(wrench.force)), float(np.linalg.norm(wrench.moment)) / size]
    return Units(force=max(loads) or 1.0, length=size, origin=stance.contacts.centre)


def loads_row(stance: Stance) -> list[float]:
    """The load of a stance in SI, as the compiled programs read it.

    Args:
        stance: The stance.

    Returns:
        Force of gravity (3) [N], other impressed wrenches about the mean contact point (6) [N, N m], and W [N], 10 numbers.
    """
    # Python's floats, and neither size nor centre of the contacts where no wrench asks for them: every region and batch goes through here.
    g0, g1, g2 = stance.gravity.tolist()
    mass = stance.mass
    row = [mass * g0, mass * g1, mass * g2, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]
    if not stance.external_wrenches:
        return [*row, stance.weight or 1.0]
    units = units_of(stance)
    for wrench in stance.external_wrenches:
        for i, value in enumerate((*wrench.force, *wrench.moment_about(units.origin))):
            row[3 + i] += float(value)
    return [*row, units.force]
