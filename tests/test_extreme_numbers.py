"""Numbers far from those of a robot: what is asked is well posed, so that it is answered, by hand and by every engine alike."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
from plain_stances import UP, feet

from socp_statics import check_equilibrium, trace_support_region
from socp_statics.cases.problem import load_problem, problem_from_tables
from socp_statics.cases.solve import solve
from socp_statics.contacts import ContactSet, PointContact, SoftFingerContact, Stance, SurfaceContact
from socp_statics.engines.conic_form import Cones, ConicData
from socp_statics.engines.equilibration import equilibrated
from socp_statics.optimization import minimise_largest_wrench

W = 60.0 * 9.81


def slope(friction: float, angle: float = np.pi / 6) -> Stance:
    """A block that leans on a slope by one point under its centre of mass."""
    normal = [-np.sin(angle), 0.0, np.cos(angle)]
    return Stance(ContactSet([PointContact("block", [0, 0, 0], normal=normal, friction=friction)]), (0.0, 0.0, 0.5), 60.0)


def on_a_corner(friction: float) -> Stance:
    """A foot on the floor and two hands on two walls."""
    return Stance(
        ContactSet([
            SurfaceContact("foot", [0, 0, 0], normal=UP, friction=0.6, size=[0.22, 0.13]),
            PointContact("hand", [0.5, 0.1, 1.0], normal=[-1, 0, 0.1], friction=friction),
            PointContact("other_hand", [0.1, 0.5, 1.2], normal=[0, -1, 0.1], friction=friction),
        ]), (0.02, 0.01, 0.8), 60.0,
    )  # fmt: skip


def on_soft_fingers(friction: float) -> Stance:
    """Two tilted soft fingers and a point."""
    return Stance(
        ContactSet([
            SoftFingerContact("a", [0.3, 0, 0], normal=[-0.3, 0, 1], friction=friction, torsional_friction=0.02),
            SoftFingerContact("b", [-0.3, 0.1, 0], normal=[0.2, 0, 1], friction=friction, torsional_friction=0.02),
            PointContact("c", [0, -0.4, 0], normal=UP, friction=friction),
        ]), (0.02, 0.01, 0.8), 60.0,
    )  # fmt: skip


@pytest.mark.parametrize("friction", [1.0, 1e3, 1e6, 1e8])
@pytest.mark.parametrize("engine", ["auto", "kernel", "clarabel"])
def test_a_block_on_a_slope_uses_the_tangent_of_its_angle(friction, engine):
    answer = minimise_largest_wrench(slope(friction), "friction_use", engine=engine)
    assert answer.status == "solved"
    assert answer.objective * friction == pytest.approx(np.tan(np.pi / 6), abs=2e-6)


@pytest.mark.parametrize("engine", ["auto", "kernel", "clarabel"])
@pytest.mark.parametrize("friction", [1e6, 1e8])
@pytest.mark.parametrize(("measure", "level"), [("normal", "point"), ("force", "point"), ("tangential", "point"), ("force", "contact")])
def test_beyond_some_friction_more_of_it_changes_nothing(friction, measure, level, engine):
    stance = on_a_corner(friction)
    value = minimise_largest_wrench(stance, measure, level, engine=engine).objective
    # A larger cone allows no less, and hardly more: walls press with W over the friction at least.
    nearly = minimise_largest_wrench(on_a_corner(1e4), measure, level, engine=engine).objective
    assert value <= nearly + 1e-8 * W
    assert value == pytest.approx(nearly, abs=1e-3 * W)


@pytest.mark.parametrize("measure", ["normal", "force", "tangential", "friction_use"])
def test_soft_fingers_of_any_friction_are_answered(measure):
    values = [minimise_largest_wrench(on_soft_fingers(mu), measure).objective * (mu if measure == "friction_use" else 1.0)
              for mu in (1e4, 1e6, 1e8)]  # fmt: skip
    assert np.ptp(values) <= 1e-3 * max(W if measure != "friction_use" else 1.0, max(values))


def test_regions_of_any_friction_are_traced():
    areas = [trace_support_region(on_a_corner(mu)).inner_area for mu in (1e4, 1e8)]
    assert areas[1] == pytest.approx(areas[0], rel=2e-3)


@pytest.mark.parametrize("off", [0.0, 1000.0])
@pytest.mark.parametrize("mass", [1e-3, 1e6])
@pytest.mark.parametrize("friction", [1e-9, 0.6, 1e8])
def test_two_level_feet_hold_a_rectangle_whatever_their_numbers(friction, mass, off):
    contacts = ContactSet([
        SurfaceContact(c.name, c.position + [off, -off, 0.1 * off], normal=UP, friction=friction, size=[0.22, 0.13]) for c in feet()
    ])  # fmt: skip
    com = (off + 0.01, -off, 0.8 + 0.1 * off)
    region = trace_support_region(contacts, mass=mass)
    assert region.inner_area == pytest.approx(0.22 * 0.33, rel=1e-3)
    answer = check_equilibrium(contacts, com, mass)
    assert answer.stable
    # Eight corners; 1 cm to the front of the middle the rear four carry (1 - 0.01 / 0.11) / 8 of the weight each.
    assert answer.margin == pytest.approx(mass * 9.81 * (1.0 - 0.01 / 0.11) / 8.0, rel=1e-6)


def test_a_region_beyond_the_clipping_square_has_no_prices():
    tables = {**load_problem("contacts/unbounded_one_way").raw}
    tables.pop("expect", None)
    posture = {**tables["posture"]}
    posture["contacts"] = [{**c, "normal_force": [1e7, float("inf")]} for c in posture["contacts"]]
    record = solve(problem_from_tables({**tables, "posture": posture}, "beyond"))
    assert (record["status"], record["region"]["kind"]) == ("solved", "unbounded")
    assert len(record["region"]["inner"]) == 0


@pytest.mark.parametrize("seed", range(4))
def test_equilibration_is_exact_and_levels_entries(seed):
    rng = np.random.default_rng(seed)
    cones = Cones(2, 3, (3, 4), ())
    size = 10.0 ** rng.uniform(-8, 8, (12, 1)) * 10.0 ** rng.uniform(-3, 3, (1, 6))
    size[5:8], size[8:] = size[5], size[8]
    A = rng.normal(size=(12, 6)) * size
    data = ConicData(sp.csc_array(np.diag(rng.uniform(size=6))), rng.normal(size=6), sp.csc_array(A), rng.normal(size=12))
    own = equilibrated(data, cones)
    scaled = np.abs(own.data.A.toarray())
    most = np.array([scaled[i].max() for i in range(5)] + [scaled[5:8].max(), scaled[8:].max()])
    assert (most <= 2.0).all() and (scaled.max(axis=0) <= 2.0).all()
    assert (own.rows[5:8] == own.rows[5]).all() and (own.rows[8:] == own.rows[8]).all()
    x, y = rng.normal(size=6), rng.normal(size=12)
    assert all((a == b).all() for a, b in zip(own.leave(*own.enter(x, y)), (x, y), strict=True))
    x1, y1 = own.enter(x, y)
    assert own.data.A @ x1 == pytest.approx(own.rows * (data.A @ x), rel=1e-12)
    assert own.data.A.T @ y1 == pytest.approx(own.columns * (data.A.T @ y), rel=1e-12)


LEANING = 0.2


def nearly_on_a_line(off: float) -> Stance:
    """Two points and a better one between them that is higher by ``off``; gravity leans across the line, the CoM along with it."""
    contacts = ContactSet([
        PointContact("end", [-0.5, 0, 0], normal=UP, friction=0.5),
        PointContact("middle", [0, 0, off], normal=UP, friction=2.0),
        PointContact("other_end", [0.5, 0, 0], normal=UP, friction=0.5),
    ])  # fmt: skip
    gravity = 9.81 * np.array([0.0, np.sin(LEANING), -np.cos(LEANING)])
    return Stance(contacts, (0.0, -np.tan(LEANING), 1.0), 60.0, gravity=gravity)


@pytest.mark.parametrize("engine", ["auto", "kernel", "clarabel"])
@pytest.mark.parametrize("off", [0.0, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-2])
def test_a_point_off_a_line_carries_nothing_across_it_however_near_it_is(off, engine):
    answer = check_equilibrium(nearly_on_a_line(off), engine=engine)
    # Across the line only the ends hold, unless the middle is exactly on it: N - 3 t >= F / mu of who holds.
    holding = 0.5 if off else 2.0
    assert answer.margin / W == pytest.approx((np.cos(LEANING) - np.sin(LEANING) / holding) / 3, abs=1e-8)
