"""Weights that let the friction coefficients decide how much of a load goes along the tangents."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from socp_statics.contacts import ContactSet
from socp_statics.contacts.joint import constraint_basis, hard_basis
from socp_statics.distribution.generalized_inverses import weighted_inverse
from socp_statics.exceptions import InputError
from socp_statics.spatial import Array


def friction_weights(contacts: ContactSet, exponent: float = 2.0, frictions: ArrayLike | None = None) -> Array:
    """The diagonal of W_mu: 1 for hard components, ``mu_k^-exponent`` for the soft ones f_x, f_y, m_z.

    Args:
        contacts: The contacts; components in their order.
        exponent: 1 or 2 are usual, 2 is that of the simple static test: the larger, the dearer is tangential force where friction is low.
        frictions: Coulomb coefficients instead of the contacts' own, shape (..., k), for a batch.

    Returns:
        Shape (..., c).

    Raises:
        InputError: An exponent that is not positive.
    """
    if not (np.isfinite(exponent) and exponent > 0):
        raise InputError(f"friction_exponent must be a finite number > 0, got {exponent:g}", name="weights", field="friction_exponent")
    mu = np.array([contact.friction for contact in contacts]) if frictions is None else np.asarray(frictions, dtype=float)
    columns = []
    for k, contact in enumerate(contacts):
        hard = (constraint_basis(contact).T @ hard_basis(contact)).any(axis=1)
        soft = np.where(mu[..., k] > 0.0, mu[..., k], 1.0) ** -exponent
        columns.append(np.where(hard, 1.0, soft[..., None]))
    return np.concatenate(columns, axis=-1)


def friction_weighted(C: ArrayLike, wrench: ArrayLike, weights: ArrayLike) -> Array:
    """``F^c = C^-Wmu F_e``: what is along the tangents is dear where friction is low.

    Implements (3.53), corrected: W_mu holds 1/mu (or 1/mu^2) for f_x, f_y and m_z, contact by contact as the map is; the printed mu makes
    tangential force cheap where friction is low. No weight keeps the forces inside their cones: an inequality is not linear.

    Args:
        C: Contact map, shape (..., 6, c).
        wrench: F_e, shape (..., 6) [N, N m].
        weights: Of `friction_weights`, shape (..., c).

    Returns:
        Shape (..., c) [N, N m].
    """
    return (weighted_inverse(C, weights) @ np.asarray(wrench, dtype=float)[..., None])[..., 0]
