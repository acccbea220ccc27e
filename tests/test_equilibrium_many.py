"""Many verdicts at once are the verdicts one by one."""

from __future__ import annotations

import numpy as np
import pytest
from random_stances import random_stance

import socp_statics as ss

G = 9.81


def sole(name, x, y, roll=0.0, mu=0.5, **more):
    return ss.SurfaceContact(name, (x, y, 0.0), rpy=(roll, 0.0, 0.0), friction=mu, size=(0.2, 0.1), **more)


FEET = ss.ContactSet([sole("left", 0.0, 0.1, 0.3), sole("right", 0.05, -0.1, -0.3)])


def coms(count=40, seed=0):
    rng = np.random.default_rng(seed)
    return rng.uniform(-1, 1, (count, 3)) * [0.2, 0.25, 0.1] + [0.0, 0.0, 0.6]


@pytest.mark.parametrize("cone", ["exact", "inscribed", "circumscribed"])
def test_batches_agree_with_clarabel_one_by_one(cone):
    places = coms()
    many = ss.check_equilibrium_many(FEET, places, mass=60.0, cone=cone)
    alone = [ss.check_equilibrium(FEET, c, 60.0, cone=cone, engine="clarabel") for c in places]
    assert many.verdict.tolist() == [a.verdict for a in alone]
    assert np.abs(many.margin - [a.margin for a in alone]).max() <= 1e-8 * 60.0 * G
    assert set(many.engine) == {"kernel"} and not many.handovers.any()
    assert 0.2 < many.stable.mean() < 0.8


@pytest.mark.parametrize("cone", ["exact", "inscribed", "circumscribed"])
def test_forces_balance_and_stay_in_their_cones(cone):
    places = coms()
    many = ss.check_equilibrium_many(FEET, places, mass=60.0, cone=cone)
    forces = many.forces
    assert forces.shape == (40, 8, 3)
    assert np.isnan(forces[~many.stable]).all()
    for f, c, margin in zip(forces[many.stable], places[many.stable], many.margin[many.stable], strict=True):
        assert np.abs(f.sum(axis=0) - [0, 0, 60.0 * G]).max() <= 1e-8 * 60.0 * G
        assert np.abs(np.cross(FEET.points_W - c, f).sum(axis=0)).max() <= 1e-8 * 60.0 * G
        normals = np.repeat([contact.normal_W for contact in FEET], 4, axis=0)
        f_n = (f * normals).sum(axis=1)
        assert f_n.min() >= margin - 1e-6
        slope = 0.5 * (1.0 if cone != "circumscribed" else np.sqrt(2.0))
        assert (np.linalg.norm(f - f_n[:, None] * normals, axis=1) - slope * (f_n - margin)).max() <= 1e-6


def test_an_item_is_the_whole_answer():
    many = ss.check_equilibrium_many(FEET, coms(), mass=60.0)
    assert len(many) == 40 and len(many[3:7]) == 4
    for i in (0, 5, -1):
        assert many[i].margin == pytest.approx(many.margin[i], abs=1e-7)
        assert many[i].verdict == many.verdict[i]
    unstable = many[int(np.flatnonzero(~many.stable)[0])]
    assert unstable.certificate.kind if hasattr(unstable.certificate, "kind") else unstable.certificate.power > 0
    with pytest.raises(IndexError):
        many[40]


@pytest.mark.parametrize("family", ["flat", "sloped", "feet_and_hands", "points", "near_vertical", "loads", "tilted_gravity", "ladder",
                                    "chimney", "mix", "far", "tiny", "huge", "light", "heavy"])  # fmt: skip
def test_stances_of_every_family(family):
    stances = [random_stance(seed, family) for seed in range(6)]
    many = ss.check_equilibrium_many(stances)
    alone = [ss.check_equilibrium(s, engine=("clarabel", "cvxpy")) for s in stances]
    assert many.verdict.tolist() == [a.verdict for a in alone]
    for stance, a, margin in zip(stances, alone, many.margin, strict=True):
        W = max([stance.weight, *(np.linalg.norm(w.force) for w in stance.external_wrenches)])
        assert a.margin == margin or margin == pytest.approx(a.margin, abs=2e-8 * W, rel=1e-7)


def test_many_contact_sets_with_a_centre_of_mass_each():
    sets = [ss.ContactSet([sole("a", 0.0, 0.1, 0.001 * k), sole("b", 0.0, -0.1)]) for k in range(9)]
    places = coms(9)
    many = ss.check_equilibrium_many(sets, places, mass=np.linspace(10, 90, 9))
    for k in range(9):
        alone = ss.check_equilibrium(sets[k], places[k], 10.0 + 10.0 * k, engine="clarabel")
        assert many.margin[k] == pytest.approx(alone.margin, abs=1e-6)
    with pytest.raises(ss.InputError, match="several contact sets"):
        _ = many.forces


def test_many_loads_and_many_gravities():
    rng = np.random.default_rng(3)
    loads, gravities = rng.normal(size=(8, 6)) * 30, rng.normal(size=(8, 3)) * 0.4 + [0, 0, -G]
    places = coms(8)
    more = {"external_wrenches": [{"force": [5.0, 0.0, 0.0], "point": [0.0, 0.0, 1.0]}]}
    many = ss.check_equilibrium_many(FEET, places, mass=40.0, loads=loads, gravity=gravities, **more)
    for k in range(8):
        own = {"force": loads[k, :3], "moment": loads[k, 3:], "point": [0.0, 0.0, 0.0]}
        wrenches = [*more["external_wrenches"], own]
        answer = ss.check_equilibrium(FEET, places[k], 40.0, gravity=gravities[k], external_wrenches=wrenches, engine="clarabel")
        assert many.verdict[k] == answer.verdict
        assert many.margin[k] == pytest.approx(answer.margin, abs=1e-5)
        assert many[k].margin == pytest.approx(answer.margin, abs=1e-5)


def test_contacts_with_bounds_are_answered_one_by_one():
    bounded = ss.ContactSet([sole("left", 0.0, 0.1, normal_force=(10.0, 400.0)), sole("right", 0.0, -0.1)])
    places = coms(5)
    many = ss.check_equilibrium_many(bounded, places, mass=60.0)
    alone = [ss.check_equilibrium(bounded, c, 60.0, engine="clarabel") for c in places]
    assert many.verdict.tolist() == [a.verdict for a in alone]
    assert many.margin == pytest.approx([a.margin for a in alone], abs=1e-5)
    assert many.forces.shape == (5, 8, 3)


def test_the_boundary_is_decided_as_by_single_calls():
    flat = ss.ContactSet([sole("left", 0.0, 0.1), sole("right", 0.0, -0.1)])
    places = np.array([[0.1, 0.0, 0.5], [0.0, 0.15, 0.5], [0.0, 0.0, 0.5], [0.3, 0.0, 0.5]])
    many = ss.check_equilibrium_many(flat, places, mass=60.0)
    assert many.verdict.tolist() == [ss.check_equilibrium(flat, c, 60.0, engine="clarabel").verdict for c in places]
    assert many.verdict[0] == "undecided" and many[0].reason == "boundary"


def test_postures_bring_centre_of_mass_mass_and_torques():
    robot = ss.load_robot("hoap2")
    posture = ss.pose(robot, np.zeros(len(robot.joints)), support=["left_foot", "right_foot"], friction=0.5)
    many = ss.check_equilibrium_many([posture, posture])
    assert many.margin == pytest.approx([ss.check_equilibrium(posture, engine="clarabel").margin] * 2, abs=1e-6)
    limited = ss.check_equilibrium_many([posture], torque_limits={"default": 5.0})
    assert limited.verdict[0] == ss.check_equilibrium(posture, torque_limits={"default": 5.0}, engine="clarabel").verdict
    assert limited[0].torque_limits


def test_answers_do_not_depend_on_the_number_of_threads():
    places = coms(1500, 1)
    one, two = (ss.check_equilibrium_many(FEET, places, mass=60.0, threads=n) for n in (1, 2))
    assert one.margin.tobytes() == two.margin.tobytes()
    assert one.forces.tobytes() == two.forces.tobytes()


@pytest.mark.parametrize("engine", ["kernel", "clarabel"])
def test_engines_can_be_named(engine):
    many = ss.check_equilibrium_many(FEET, coms(3), mass=60.0, engine=engine)
    assert set(many.engine) == {engine}


WRONG = [
    ({"coms": [[0.0, 0.0]]}, r"coms must be numbers of shape \(3\) or \(b, 3\), got shape \(1, 2\)"),
    ({"coms": None}, "coms is missing"),
    ({"coms": [[0.0, 0.0, np.nan]]}, r"coms must be finite, entry 0 is \[0.0, 0.0, nan\]"),
    ({"mass": [1.0, 2.0]}, r"mass must be numbers of shape one number or \(b,\) with b = 1"),
    ({"mass": -3.0}, "mass must be > 0, entry 0 is -3.0"),
    ({"gravity": [0.0, 1.0]}, "gravity must be numbers"),
    ({"loads": [[1.0, 2.0, 3.0]]}, "loads must be numbers"),
    ({"loads": "heavy"}, "loads must be numbers"),
    ({"mass": None, "loads": [[1.0, 0, 0, 0, 0, 0]]}, "mass is missing"),
    ({"torque_limits": True}, "torque_limits need a robot"),
    ({"threads": 0}, "threads must be a whole number"),
    ({"contacts": 3}, "a contact set or a sequence of them is expected"),
    ({"engine": "fast"}, "engine 'fast' is not known"),
    ({"cone": "round"}, "cone"),
]


@pytest.mark.parametrize(("change", "sentence"), WRONG, ids=lambda v: v if isinstance(v, str) else "")
def test_wrong_input_is_refused_by_name(change, sentence):
    arguments = {"contacts": FEET, "coms": [[0.0, 0.0, 0.5]], "mass": 60.0} | change
    contacts, places, mass = (arguments.pop(k) for k in ("contacts", "coms", "mass"))
    with pytest.raises(ss.InputError, match=sentence):
        ss.check_equilibrium_many(contacts, places, mass, **arguments)


def test_nothing_asked_is_nothing_answered():
    none = ss.check_equilibrium_many(FEET, np.zeros((0, 3)), mass=60.0)
    assert len(none) == 0 and none.margin.shape == (0,)
    with pytest.raises(ss.InputError, match="stances and postures bring their own"):
        ss.check_equilibrium_many([ss.Stance(FEET, (0, 0, 1), 1.0)], [[0.0, 0.0, 1.0]])
