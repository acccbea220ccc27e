"""The non-negative combination of rays that comes nearest to a vector."""

from __future__ import annotations

import numpy as np
from scipy.optimize import lsq_linear, nnls

from socp_statics.spatial import Array

OPTIMAL = 1e-9


def nearest_combination(rays: Array, target: Array) -> Array:
    """Amounts a >= 0 for which ``|target - rays' a|`` is least.

    SciPy's non-negative least squares is quick and, now and then, wrong without a word; where its answer does not meet the
    conditions of the optimum, the slower bounded-variable least squares answers.

    Args:
        rays: Unit rays, shape (r, d).
        target: Of length about one, shape (d,).

    Returns:
        Shape (r,).
    """
    if not len(rays):
        return np.zeros(0)
    amounts = _polished(rays, target, _quick(rays, target))
    if _optimal(rays, target, amounts):
        return amounts
    slow = lsq_linear(rays.T, target, bounds=(0.0, np.inf), method="bvls", tol=1e-14, max_iter=20 * len(rays))
    return _polished(rays, target, np.where(slow.active_mask < 0, 0.0, np.maximum(slow.x, 0.0)))


def distance_of_span(rays: Array, target: Array) -> float:
    """Distance of a vector from the cone that rays span.

    Args:
        rays: Unit rays, shape (r, d).
        target: Of length about one, shape (d,).
    """
    return float(np.linalg.norm(target - nearest_combination(rays, target) @ rays))


def _quick(rays: Array, target: Array) -> Array:
    try:
        return np.asarray(nnls(rays.T, target, maxiter=100 * len(rays))[0])
    except RuntimeError:
        return np.zeros(len(rays))


def _polished(rays: Array, target: Array, amounts: Array) -> Array:
    """The same rays in amounts that do not suffer from normal equations."""
    used = amounts > 0.0
    refined = np.zeros(len(rays))
    refined[used] = np.linalg.lstsq(rays[used].T, target)[0]
    closer = np.linalg.norm(target - refined @ rays) < np.linalg.norm(target - amounts @ rays)
    return refined if closer and refined.min() >= 0.0 else amounts


def _optimal(rays: Array, target: Array, amounts: Array) -> bool:
    """Whether no ray gains and those in use are orthogonal to the rest."""
    gains = rays @ (target - amounts @ rays)
    return bool(gains.max() <= OPTIMAL and np.abs(amounts * gains).max() <= OPTIMAL)
