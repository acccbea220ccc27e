"""How well forces keep their promises: balance, cones, bounds and hard rows, recomputed from the data."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from socp_statics.cones.choice import ConeChoice
from socp_statics.spatial import Array
from socp_statics.statics.statics_data import StaticsData


class ForceResiduals(NamedTuple):
    """Violations in units of W.

    Attributes:
        balance: Norm of the wrench that is left over.
        cone: Largest violation of a cone, bound or hard row.
    """

    balance: float
    cone: float


def force_residuals(data: StaticsData, cone: ConeChoice, x: Array) -> ForceResiduals:
    """Residuals of a point of the convex set.

    Args:
        data: The stance's arrays.
        cone: Exact cones or pyramids.
        x: Scaled unknowns, shape (nx,).

    Returns:
        Violation of balance and of everything else.
    """
    balance = float(np.linalg.norm(data.wrench_map @ x + data.load))
    f_t, f_n, m_n = x[data.tangential].reshape(-1, 2), x[data.normal], x[data.torsional]
    worst = [float(-f_n.min(initial=0.0))]
    soft = slice(data.circular - data.box, data.slipping)
    if data.slipping:
        grip = f_n[: data.slipping]
        m = data.friction * (1.0 if cone.kind == "exact" else cone.slope_factor())
        spin = np.zeros(data.slipping)
        spin[soft] = np.abs(m_n) / data.torsion
        elliptic = np.arange(data.slipping) >= data.circular
        if cone.kind == "exact":
            slide = np.where(elliptic, np.hypot(np.linalg.norm(f_t, axis=1), m * spin), np.linalg.norm(f_t, axis=1))
        else:
            slide = (f_t @ cone.face_normals().T).max(axis=1)
            slide = slide + np.where(elliptic & (cone.kind == "inscribed"), m * spin, 0.0)
        worst.append(float((slide - m * grip).max()))
        boxed = ~elliptic | (cone.kind == "circumscribed")
        worst.append(float(np.where(boxed & (spin > 0), spin - grip, 0.0).max()))
    for k, (lo, hi) in zip(data.bounded, data.bounds, strict=True):
        total = float(f_n[data.contact_of_point == k].sum())
        worst += [lo - total, total - hi]
    if len(data.limit_values):
        worst.append(float((data.limit_rows @ x - data.limit_values).max()))
    return ForceResiduals(balance, max(0.0, *worst))
