"""Pyramids in the kernel beside points without friction: centres, closed-form vertices and forces are those of the other engines."""

import numpy as np
import pytest

import socp_statics as ss
from socp_statics.contacts import ContactSet, ExternalWrench, FrictionlessPointContact, Stance, SurfaceContact

CONES = [("inscribed", 4), ("circumscribed", 4), ("circumscribed", 7)]


def foot_and_prop():
    foot = SurfaceContact("foot", [0, 0.1, 0], normal=(0, 0, 1), friction=0.6, size=(0.2, 0.1))
    prop = FrictionlessPointContact("prop", [0.5, 0.3, 0.5], normal=(0.3, 0.1, 1))
    push = ExternalWrench(force=(20, -10, 30), point=(0.3, 0, 0.5))
    return Stance(ContactSet([foot, prop]), [0.02, 0.1, 0.8], 60.0, external_wrenches=(push,))


@pytest.mark.parametrize(("cone", "sides"), CONES)
def test_a_wrench_acts_where_it_is_whatever_shares_a_point(cone, sides):
    stance = foot_and_prop()
    (kernel,), (clarabel,) = (ss.check_equilibrium_many([stance], cone=cone, sides=sides, engine=e).margin for e in ("kernel", "clarabel"))
    assert kernel == pytest.approx(clarabel, abs=1e-6)
    a, b = (ss.trace_support_region(stance, 1e-4, cone=cone, sides=sides, engine=e) for e in ("kernel", "clarabel"))
    assert a.inner_area == pytest.approx(b.inner_area, rel=1e-6)
    assert a.inner.mean(axis=0) == pytest.approx(b.inner.mean(axis=0), abs=1e-4)


@pytest.mark.parametrize(("cone", "sides"), CONES)
def test_the_edge_of_a_pyramid_carries_no_weight_alone(cone, sides):
    stance = ss.load_problem("contacts/ladder").stance()
    for heading in (0.0, 0.4):
        a, b = (ss.trace_support_region(stance, cone=cone, sides=sides, heading=heading, engine=e) for e in ("kernel", "clarabel"))
        assert a.inner_area == pytest.approx(b.inner_area, rel=1e-6)
        for corner, forces in zip(a.inner, a.inner_forces, strict=True):
            weight = np.array([0.0, 0.0, -stance.weight])
            assert np.linalg.norm(forces.force_W.sum(axis=0) + weight) < 1e-6 * stance.weight
            moment = np.cross(forces.point_W, forces.force_W).sum(axis=0) + np.cross([*corner, 3.0], weight)
            assert np.linalg.norm(moment) < 1e-6 * stance.weight
