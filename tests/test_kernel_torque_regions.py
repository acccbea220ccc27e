"""The compiled tracer of stances with limits: Clarabel's regions, witnesses re-checked by other means, batches, what it hands back."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from random_stances import random_stance
from rechecks import force_violations
from torque_oracles import FOUR, INF, braced, full_jacobian, generalised_gravity, generate, legs, point_jacobians

import socp_statics as ss
from socp_statics.cones.choice import ConeChoice
from socp_statics.engines.kernel.support_rows import point_rows, support_rows
from socp_statics.postures import pose
from socp_statics.regions.limited_tracing import trace_limited
from socp_statics.regions.polygon import distance
from socp_statics.regions.question import region_question
from socp_statics.robots import load_robot
from socp_statics.statics import assemble

EXACT = ConeChoice()
CONES = [EXACT, ConeChoice("inscribed", 5, 0.3), ConeChoice("circumscribed", 4)]
# Knee angle [rad] and limit of the leg joints [N m] to area [cm^2].
AREAS = {(1.0, 4.0): 135.60, (1.0, 3.0): 128.75, (1.0, 2.0): 99.43, (1.0, 1.5): 64.20,
         (2.0, 5.0): 131.08, (2.0, 3.0): 101.53, (2.0, 2.0): 55.48}  # fmt: skip
ASYMMETRIC = {"default": INF, "?LEG_JOINT*": 3.0, "RLEG_JOINT4": [-1.0, 2.5], "LLEG_JOINT6": 0.2, "LLEG_JOINT5": [-INF, 1.5]}


@pytest.fixture(scope="module")
def hoap2():
    return load_robot("hoap2")


@pytest.fixture(scope="module")
def half_squat(hoap2):
    return generate("squat", hoap2)


def compiled(contacts, cone=EXACT, tolerance=1e-3, height=0.0, torque_limits=False):
    """What the compiled tracer says, None where it leaves the question to the others."""
    return trace_limited(region_question(contacts, height, None, None, (), torque_limits), cone, tolerance)


def same_region(mine, theirs):
    assert mine is not None and mine.kind == theirs.kind == "polygon"
    assert (mine.engine, mine.handovers) == ("kernel", 0)
    near = 1e-8 * mine.size
    assert distance(theirs.outer, mine.inner).min() >= -near
    assert distance(mine.outer, theirs.inner).min() >= -near
    assert mine.relative_gap <= 1e-3 and mine.frozen == theirs.frozen
    if theirs.com_margin is None:
        assert mine.com_margin is None
    else:
        assert mine.com_margin == pytest.approx(theirs.com_margin, rel=3e-3, abs=near)


@pytest.mark.parametrize("knee, t", AREAS)
def test_squats_have_their_published_areas_and_clarabels_polygons(hoap2, knee, t):
    posture = generate("squat", hoap2, knee=knee)
    mine = compiled(posture, torque_limits=legs(t))
    same_region(mine, ss.trace_support_region(posture, engine="clarabel", torque_limits=legs(t)))
    for region in (mine, ss.trace_support_region(posture, engine="kernel", torque_limits=legs(t))):
        assert region.inner_area * 1e4 == pytest.approx(AREAS[knee, t], abs=0.06)
    assert mine.solves <= 40


@pytest.mark.parametrize("cone", CONES, ids=lambda c: c.kind)
@pytest.mark.parametrize("limits", [legs(2.0), ASYMMETRIC, {"default": INF, "?LEG_JOINT*": 2.5, "?ARM_JOINT*": 0.8}], ids=str)
def test_limits_of_all_kinds_with_every_cone(hoap2, half_squat, limits, cone):
    for posture in (half_squat, braced(hoap2, np.random.default_rng(34))):
        theirs = ss.trace_support_region(posture, engine="clarabel", cone=cone, torque_limits=limits)
        same_region(compiled(posture, cone, torque_limits=limits), theirs)


def test_loads_on_links_and_tilted_gravity(half_squat):
    push = ss.ExternalWrench((4.0, -3.0, 2.0), (0.1, 0.0, -0.2), (0.1, 0.0, 0.3), link="RARM_LINK4")
    stance = half_squat.stance((0.6, -0.4, -9.7), (push,), legs(3.0))
    mine = compiled(stance)
    same_region(mine, ss.trace_support_region(stance, engine="clarabel"))
    checked_corners(stance, mine, EXACT)


def test_bounded_feet_soft_fingers_and_handles():
    seen = {"bounded": 0, "soft_finger": 0, "handle": 0}
    for seed in range(60):
        stance = random_stance(seed, "mix")
        for cone in CONES:
            mine = compiled(stance, cone)
            if mine is None:
                continue
            same_region(mine, ss.trace_support_region(stance, engine=("clarabel", "cvxpy"), cone=cone))
            checked_corners(stance, mine, cone)
            seen["bounded"] += any(c.type != "handle" and c.normal_force is not None for c in stance.contacts)
            for kind in ("soft_finger", "handle"):
                seen[kind] += any(c.type == kind for c in stance.contacts)
    assert min(seen.values()) >= 6, seen


def test_equal_bounds_and_limited_grips():
    up = (0.0, 0.0, 1.0)
    left = ss.SurfaceContact("left", (0, 0.1, 0), normal=up, friction=0.5, size=(0.2, 0.1), normal_force=(150.0, 150.0))
    right = ss.SurfaceContact("right", (0, -0.1, 0), normal=up, friction=0.5, size=(0.2, 0.1))
    grip = ss.Handle("grip", (0.4, 0.0, 1.0), normal=(-1, 0, 0), transmits=("fx", "fy", "fz", "mx"),
                     limits={"fx": [-100, 60], "fz": [-80, 120], "fy": [-40, 40], "mx": [-5, 5]})  # fmt: skip
    stance = ss.Stance(ss.ContactSet([left, right, grip]), (0.0, 0.0, 0.8), 60.0)
    mine = compiled(stance)
    same_region(mine, ss.trace_support_region(stance, engine="clarabel"))
    checked_corners(stance, mine, EXACT)


def checked_corners(stance, region, cone):
    """Forces of every corner balance the load there, inside every cone, bound and limit."""
    assert len(region.inner_forces) == len(region.inner)
    for corner, forces in zip(region.inner, region.inner_forces, strict=True):
        there = ss.Stance(stance.contacts, (*corner, stance.com[2]), stance.mass, stance.gravity, stance.external_wrenches)
        balance, violation = force_violations(there, forces, cone)
        assert balance <= 1e-8 and violation <= 1e-7


@pytest.mark.parametrize("limits", [legs(4.0), legs(1.5), ASYMMETRIC], ids=str)
def test_corners_and_edges_by_the_robots_own_jacobians(half_squat, limits):
    region = compiled(half_squat, torque_limits=limits)
    stance = half_squat.stance(torque_limits=limits)
    checked_corners(stance, region, EXACT)
    lower, upper = half_squat.torque_limits(limits).T
    g, unit = generalised_gravity(half_squat), half_squat.mass * 9.81 * region.size
    for forces in region.inner_forces:
        tau = g[6:].copy()
        for entry in forces.entries():
            link = half_squat.robot.frames[entry["contact"]].frame
            tau -= (full_jacobian(half_squat, link, entry["point"])[:3].T @ entry["force"])[6:]
        assert (tau >= lower - 1e-7 * unit).all() and (tau <= upper + 1e-7 * unit).all()

    # Beyond an edge the load does more work than torques and contacts can take: none of them prevents the motion.
    centre, weight = half_squat.contacts.centre, half_squat.mass * np.array([0.0, 0.0, -9.81])
    joint_rates = region.witnesses.joint_rates()
    assert len(region.outer_multipliers) == len(region.outer) == len(joint_rates)
    limited = False
    for k, ((linear, angular), rates) in enumerate(zip(region.outer_multipliers, joint_rates, strict=True)):
        at_base = linear + np.cross(angular, half_squat.p_WB - centre)
        velocity = np.concatenate([half_squat.R_WB.T @ at_base, half_squat.R_WB.T @ angular, rates])
        speed = max(np.linalg.norm(linear), np.linalg.norm(angular) * region.size)
        for contact, _, J in point_jacobians(half_squat):
            v = contact.rotation.T @ J @ velocity
            assert v[2] - contact.friction * np.hypot(v[0], v[1]) >= -1e-7 * speed
        against = np.where(rates > 0, lower, upper)
        moving = np.abs(rates) * region.size > 1e-9 * speed
        assert np.isfinite(against[moving]).all()
        limited |= bool(moving.any())
        a, b = region.outer[k], region.outer[(k + 1) % len(region.outer)]
        power = []
        for xy in (a, b, a + (b - a)[[1, 0]] * [1, -1]):
            moved = np.cross([*(xy - half_squat.com_W[:2]), 0.0], weight)
            power.append((-g @ velocity + moved @ angular + against[moving] @ rates[moving]) / (half_squat.mass * 9.81))
        assert np.abs(power[:2]).max() <= 1e-6 * speed and power[2] > 0.0
    assert limited


def test_what_is_no_polygon_is_left_to_the_others(hoap2, half_squat):
    up = (0.0, 0.0, 1.0)
    grips = {"normal": up, "transmits": ("fx", "fy", "fz", "mx", "my", "mz")}
    bounded = [ss.PointContact(f"p{i}", (0.5 * i, 0, 0), normal=up, friction=0.5, normal_force=(0, 400)) for i in range(2)]
    gripped = [ss.SurfaceContact("foot", (0, 0, 0), normal=up, friction=0.5, size=(0.2, 0.1)), ss.Handle("grip", (0.3, 0, 1), **grips)]
    hanging = [ss.Handle("a", (0, 0.2, 1), limits={"fz": [-900, 900]}, **grips), ss.Handle("b", (0, -0.2, 1), **grips)]
    nothing = {"default": INF, "BODY_JOINT1": 1.0}
    cases = [(half_squat, nothing, "empty"), *((ss.Stance(ss.ContactSet(c), (0.0, 0.0, 0.5), 50.0), False, kind)
             for c, kind in ((bounded, "segment"), (gripped, "unbounded"), (hanging, "unbounded")))]  # fmt: skip
    for contacts, limits, kind in cases:
        assert compiled(contacts, torque_limits=limits) is None
        for engine in ("kernel", "clarabel"):
            assert ss.trace_support_region(contacts, engine=engine, torque_limits=limits).kind == kind, (kind, engine)


def test_single_equals_batch_whatever_the_threads(hoap2):
    postures = [generate("squat", hoap2, knee=knee) for knee in (0.6, 1.0, 1.4, 2.0)] + [pose(hoap2, {}, FOUR[:1])]
    batches = [ss.trace_support_regions(postures, threads=n, torque_limits=legs(3.0)) for n in (1, 2, 3)]
    alone = [ss.trace_support_region(p, torque_limits=legs(3.0)) for p in postures]
    for each in zip(*batches, alone, strict=True):
        first = each[0]
        assert first.kind == "polygon" and first.engine == "kernel"
        for other in each[1:]:
            assert other.inner.tobytes() == first.inner.tobytes() and other.outer.tobytes() == first.outer.tobytes()
            assert (other.solves, other.com_margin, other.relative_gap) == (first.solves, first.com_margin, first.relative_gap)
    mixed = [postures[1], postures[1].contacts, postures[1].stance(torque_limits=legs(2.0))]
    free, contacts, limited = ss.trace_support_regions(mixed, threads=2)
    assert free.inner_area == pytest.approx(contacts.inner_area, rel=1e-3) and limited.inner_area < free.inner_area


def test_the_record_has_every_witness(half_squat):
    record = ss.trace_support_region(half_squat, torque_limits=legs(2.0)).as_record()
    assert record["posture"] == "frozen"
    assert len(record["inner_forces"]) == len(record["inner"]) and len(record["outer_multipliers"]) == len(record["outer"])
    A, b = ss.trace_support_region(half_squat, torque_limits=legs(2.0)).halfplanes
    assert (np.array(record["inner"]) @ A.T <= b + 1e-12).all()


def test_the_interpreter_traces_the_same():
    code = """
import socp_statics as ss
from socp_statics.regions.limited_tracing import trace_limited
from socp_statics.regions.question import region_question
foot = ss.SurfaceContact("foot", (0, 0, 0), normal=(0, 0, 1), friction=0.5, size=(0.2, 0.1), normal_force=(0.0, 700.0))
hand = ss.PointContact("hand", (0.4, 0.1, 0.2), normal=(-0.3, 0.0, 1.0), friction=0.5, normal_force=(0.0, 100.0))
stance = ss.Stance(ss.ContactSet([foot, hand]), (0.05, 0.0, 0.5), 50.0)
region = trace_limited(region_question(stance, 0.0, None, None, (), False), ss.ConeChoice(), 0.05)
print(region.kind, region.solves, region.inner_area, region.com_margin)
"""
    found = []
    for disabled in ("0", "1"):
        environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[1]), "NUMBA_DISABLE_JIT": disabled}
        done = subprocess.run([sys.executable, "-c", code], env=environment, check=True, capture_output=True, text=True)
        found.append(done.stdout.split())
    assert found[0][:2] == found[1][:2] and found[0][0] == "polygon"
    assert [float(v) for v in found[0][2:]] == pytest.approx([float(v) for v in found[1][2:]], rel=1e-7)


def test_rows_from_points_are_those_of_the_assembled_stance(hoap2):
    rng = np.random.default_rng(5)
    push = ss.ExternalWrench((4.0, -3.0, 2.0), (0.1, 0.0, -0.2), (0.1, 0.0, 0.3), link="RARM_LINK4")
    smooth = pose(hoap2, generate("squat", hoap2, knee=1.2).angles, FOUR[:2], friction={"left_foot": 0.0, "right_foot": 0.4})
    for posture in (generate("squat", hoap2), braced(hoap2, rng), smooth):
        for loads, gravity in (((), None), ((push,), (0.6, -0.4, -9.7))):
            stance = posture.stance(gravity, loads, ASYMMETRIC)
            for cone in CONES:
                one = point_rows(stance, region_question(stance, 0.0, None, None, (), False).load(), cone)
                two = support_rows(assemble(stance), cone)
                for name, mine, theirs in zip(one._fields, one, two, strict=True):
                    if np.asarray(mine).dtype.kind == "f":
                        assert mine == pytest.approx(theirs, rel=1e-10, abs=1e-12), name
                    else:
                        assert np.array_equal(mine, theirs), name


def test_rows_of_a_kind_of_contacts_are_made_once(hoap2):
    one, two = (support_rows(assemble(generate("squat", hoap2, knee=k).stance(torque_limits=legs(3.0))), EXACT) for k in (0.8, 1.2))
    assert one.value is two.value and one.column is two.column
    assert not np.array_equal(one.A, two.A)
