"""Forces that brace are no larger than what they hold needs."""

from __future__ import annotations

import numpy as np
import pytest
from plain_stances import pinch

from socp_statics.certificates import force_residuals
from socp_statics.certificates.bracing import LARGE, least_braced
from socp_statics.cones.choice import ConeChoice
from socp_statics.contacts import ContactSet, Stance
from socp_statics.statics import assemble

EXACT = ConeChoice()


def squeezed(force: float):
    """A pinch of friction 1 halfway between its fingers, each of them pushing with so many weights."""
    data = assemble(Stance(ContactSet(pinch()), (0.0, 0.0, 0.0), 60.0))
    x = np.zeros(6)
    x[data.normal] = force
    return data, x - np.linalg.lstsq(data.wrench_map, data.wrench_map @ x + data.load, rcond=None)[0]


@pytest.mark.parametrize("force", [1e6, 1e9, 1e12])
def test_a_pinch_needs_half_a_weight_from_each_finger(force):
    data, x = squeezed(force)
    less = least_braced(data, EXACT, x)
    assert (less[data.normal] >= 0.5).all() and (less[data.normal] <= 0.5 / 0.79).all()
    held = force_residuals(data, EXACT, less)
    assert held.cone == 0.0 and held.balance <= 1e-15


def test_what_forces_can_lose_is_kept_of_them():
    data, x = squeezed(1e8)
    less = least_braced(data, EXACT, x, reserve=0.25)
    assert (less[data.normal] >= 0.75).all() and (less[data.normal] <= 0.75 / 0.79).all()


def test_forces_that_are_not_large_stay_as_they_are():
    for force in (1.0, 0.5 * LARGE):
        data, x = squeezed(force)
        assert least_braced(data, EXACT, x) is x


def test_forces_outside_their_cones_stay_as_they_are():
    data, x = squeezed(1e6)
    assert least_braced(data, EXACT, -x) is not None
    assert (least_braced(data, EXACT, -x) == -x).all()
