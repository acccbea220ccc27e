"""Forces that brace the robot between its contacts, made no larger than the balance needs.

Where an internal force lies inside the cones, forces may be as large as they like, and an interior-point method leaves them at a million
weights. Added up as numbers in newtons, these no longer show that they balance one.
"""

from __future__ import annotations

import numpy as np

from socp_statics.certificates.force_check import force_residuals
from socp_statics.cones.choice import ConeChoice
from socp_statics.spatial import Array
from socp_statics.statics.statics_data import StaticsData

# Forces beyond this, in units of W, are looked at: the rounding of their sum is still small beside what balances have to show.
LARGE = 1e5
# The share that is tried next, and the least that is told from none.
SMALLER, NOTHING = 0.8, 1e-15


def least_braced(data: StaticsData, cone: ConeChoice, x: Array, reserve: float = 0.0) -> Array:
    """Forces with hardly more of their internal part than the cones, bounds and limits ask for.

    Between the least balancing forces ``-G^+ L`` and the given ones lies an internal force. The set is convex, so that the shares of
    it that are admissible are an interval, which ends at the given forces: what is taken is hardly more than its least one.

    Args:
        data: The stance's arrays, with the load that the forces balance.
        cone: Exact cones or pyramids.
        x: Scaled unknowns, shape (nx,).
        reserve: Normal force that every point could lose, as it could before, scaled.

    Returns:
        Forces of the same kind, shape (nx,); the given ones where they are not large or nothing smaller is admissible.
    """
    if not np.abs(x).max(initial=0.0) > LARGE:
        return x
    G = data.wrench_map
    least = -np.linalg.lstsq(G, data.load, rcond=None)[0]
    internal = x - least
    internal = internal - np.linalg.lstsq(G, G @ internal, rcond=None)[0]
    spare = np.zeros(len(x))
    spare[data.normal] = reserve

    def admissible(share: float) -> bool:
        return force_residuals(data, cone, least + share * internal - spare).cone <= 0.0

    if not admissible(1.0):
        return x
    share = 1.0
    while share > NOTHING and admissible(SMALLER * share):
        share *= SMALLER
    return least + share * internal
