"""Loads on top of a stance's own: what multiples of some unit loads add to its arrays."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from socp_statics.spatial import Array
from socp_statics.statics.statics_data import StaticsData


def with_load(data: StaticsData, P: Array, relief: Array, torque: Array, w: Array | float) -> StaticsData:
    """The arrays of a stance that also carries w scaled units of a load, or of several.

    Args:
        data: The stance's arrays.
        P: Wrench of one unit, shape (6,); of k loads, shape (6, k).
        relief: What one unit adds to the values of the limits, shape (nl,) or (nl, k).
        torque: What one unit takes from the joint torques, shape (n,) or (n, k).
        w: How much; of k loads, shape (k,).
    """
    torques = data.torques._replace(passive=data.torques.passive - np.dot(torque, w)) if len(torque) else data.torques
    return replace(data, load=data.load + np.dot(P, w), limit_values=data.limit_values + np.dot(relief, w), torques=torques)


def limit_relief(data: StaticsData, torque: Array) -> Array:
    """What one unit of a load adds to the values of the hard rows: nothing to handles, its torque to upper and lower limits.

    Args:
        data: The stance's arrays.
        torque: What one unit takes from the joint torques, shape (n,); of k loads, shape (n, k).

    Returns:
        Shape (nl,) or (nl, k).
    """
    limits = data.torques.limits
    ends = [torque[np.isfinite(limits[:, 1])], -torque[np.isfinite(limits[:, 0])]] if data.torques.limited else []
    return np.concatenate([np.zeros((data.handle_limits, *torque.shape[1:])), *ends])
