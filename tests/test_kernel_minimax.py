"""The kernel's minimax forces: against Clarabel on the declared model, the bound of Boyd and Wegbreit, and one by one."""

from __future__ import annotations

from functools import cache

import numpy as np
import oracles
import pytest
from rechecks import force_violations, motion_power
from sweeps.population import population, stance_of

import socp_statics as ss
from socp_statics.cones import ConeChoice
from socp_statics.optimization import minimise_largest_wrench
from socp_statics.optimization.compiled_minimax import COUNTS, compiled_largest_forces, compiled_minimax
from socp_statics.statics import assemble
from socp_statics.statics.units import loads_row, units_of

UP = (0.0, 0.0, 1.0)
MASS = 60.0
COUNT = 700


def sole(name, x, y, roll=0.0, mu=0.5, **more):
    return ss.SurfaceContact(name, (x, y, 0.0), rpy=(roll, 0.0, 0.0), friction=mu, size=(0.2, 0.1), **more)


FEET = ss.ContactSet([sole("left", 0.0, 0.1, 0.3), sole("right", 0.05, -0.1, -0.3)])


def coms(count=40, seed=0):
    rng = np.random.default_rng(seed)
    return rng.uniform(-1, 1, (count, 3)) * [0.2, 0.25, 0.1] + [0.0, 0.0, 0.6]


@cache
def stances():
    """Stances of points with friction of every family, size, place and weight of the sweep, with pushes."""
    return [s for s in map(stance_of, population(COUNT, 4)) if s.contacts.friction_points is not None]


@cache
def settled():
    """The stances that the compiled program settles, with what it finds."""
    out = []
    for stance in stances():
        load = np.array([[*loads_row(stance), *stance.com]])
        found = compiled_largest_forces([stance.contacts], np.array([0, 1]), load)
        if found.settled[0]:
            out.append((stance, found))
    return out


def full_rank(stance):
    """Whether point forces reach every wrench beyond doubt."""
    _, size, centre = oracles.scales(stance)
    columns = []
    for c in stance.contacts:
        for p in oracles.points_of(c):
            axes = np.asarray(c.rotation).T if c.friction > 0 else np.asarray(c.rotation).T[2:]
            columns += [np.concatenate([a, np.cross((p - centre) / size, a)]) for a in axes]
    values = np.linalg.svd(np.array(columns), compute_uv=False)
    return len(values) == 6 and values[-1] > 1e-3


def maps(stance):
    """Force axes and wrench maps of the points in the kernel's order, friction, and the load; in units of W and size."""
    W, size, centre = oracles.scales(stance)
    rows = stance.contacts.friction_points
    axes = rows[:, 3:12].reshape(-1, 3, 3)
    arms = (rows[:, :3] - centre) / size
    A = np.concatenate([axes, np.cross(arms[:, None], axes)], axis=2).transpose(0, 2, 1)
    load, _, _ = oracles.loads_of(stance, W, size, centre)
    return A, rows[:, 12], load


def projected(v, mu):
    """Euclidean projection of rows (f_1, f_2, f_n) on their friction cones, written anew from its closed form."""
    t, z = np.linalg.norm(v[:, :2], axis=1), v[:, 2]
    s = np.where(mu * t <= -z, 0.0, (mu * t + z) / (1 + mu**2))
    away = np.column_stack([(mu * s / np.maximum(t, 1e-300))[:, None] * v[:, :2], s])
    return np.where((t <= mu * z)[:, None], v, away)


def test_most_of_the_population_is_settled():
    """What is left has no full rank, no balance, or hardly any; masses, sizes and pushes are of every kind."""
    kept = {id(stance) for stance, _ in settled()}
    assert len(kept) >= 300
    masses = np.array([stance.mass for stance, _ in settled()])
    sizes = np.array([stance.contacts.size for stance, _ in settled()])
    assert masses.min() < 1e-2 and masses.max() > 1e5 and sizes.min() < 0.02 and sizes.max() > 50.0
    assert any(stance.external_wrenches for stance, _ in settled())
    left = []
    for stance in stances():
        if id(stance) not in kept and full_rank(stance):
            answer = ss.check_equilibrium(stance)
            if answer.verdict == "stable" and answer.margin > 1e-4 * units_of(stance).force and np.isfinite(answer.margin):
                left.append(stance)
    assert not left


def test_forces_satisfy_the_conditions_of_an_optimum():
    """Cones, balance, and a dual bound that meets the largest force; all recomputed from the contacts."""
    for stance, found in settled():
        A, mu, load = maps(stance)
        z = found.forces
        f = np.column_stack([mu * z[:, 1], mu * z[:, 2], z[:, 0]])
        largest = np.linalg.norm(f, axis=1).max()
        assert found.value[0] == pytest.approx(largest, rel=1e-12)
        assert (np.linalg.norm(f[:, :2], axis=1) - mu * f[:, 2]).max() <= 1e-8 * max(1.0, largest)
        assert np.abs(np.einsum("nij,nj->i", A, f) + load).max() <= 1e-8 * max(1.0, 1e-2 * largest)
        y = found.multipliers[0]
        reach = np.linalg.norm(projected(np.einsum("nij,i->nj", A, -y), mu), axis=1).sum()
        assert y @ load / reach == pytest.approx(largest, rel=1e-6)


def test_forces_agree_with_clarabel_on_the_declared_model():
    compared = 0
    for stance, found in settled():
        W = units_of(stance).force
        answer = minimise_largest_wrench(stance, engine=("clarabel", "cvxpy"))
        if answer.equilibrium.verdict == "undecided":
            continue
        assert answer.status == "solved"
        assert W * found.value[0] == pytest.approx(answer.objective, rel=1e-6, abs=1e-7 * W)
        compared += 1
    assert compared >= 300


def near_the_edge(share):
    """A stance whose centre of mass is a share of the size inside the edge of its region, outside where negative."""
    way = np.array([0.6, 0.8])
    at = ss.support_function(FEET, [way]).position[0] - share * FEET.size * way
    return ss.Stance(FEET, [*at, 0.5], MASS)


@pytest.mark.parametrize("share", [1e-3, 1e-4, 1e-5])
def test_loads_next_to_the_edge(share):
    stance = near_the_edge(share)
    answer, wanted = (minimise_largest_wrench(stance, engine=e) for e in ("kernel", "clarabel"))
    assert answer.engine == "kernel" and answer.status == "solved"
    assert answer.objective == pytest.approx(wanted.objective, rel=1e-5)
    assert minimise_largest_wrench(near_the_edge(-share)).status == "infeasible"


def test_infeasible_loads_carry_a_motion():
    some = [s for s in stances() if s.contacts.friction_points is not None][:250]
    many = ss.minimise_largest_force_many(some)
    lost = np.flatnonzero(many.status == "infeasible")
    assert len(lost) > 30
    for k in lost:
        answer = many[int(k)]
        assert answer.status == "infeasible" and answer.objective is None and answer.forces is None
        power, violation = motion_power(some[k], answer.equilibrium.certificate, ConeChoice())
        assert power > 0.0 and violation <= 1e-7
        assert many.equilibrium.verdict[k] == "unstable" and np.isnan(many.objective[k])


@pytest.mark.parametrize("measure", COUNTS)
def test_the_measures_of_points(measure):
    for com in coms(12, 3):
        stance = ss.Stance(FEET, com, MASS)
        answer, wanted = (minimise_largest_wrench(stance, measure, engine=e) for e in ("kernel", "clarabel"))
        assert answer.status == wanted.status and answer.engine == "kernel"
        if answer.status == "solved":
            assert answer.objective == pytest.approx(wanted.objective, rel=1e-6, abs=1e-6)
            assert max(force_violations(stance, answer.forces, ConeChoice())) <= 1e-8
            assert answer.residuals["gap"] <= 1e-8


def test_resultants_of_single_points_are_points():
    tripod = [ss.PointContact(f"p{k}", (np.cos(a), np.sin(a), 0.0), normal=UP, friction=0.4) for k, a in enumerate((0.0, 2.0, 4.0))]
    stance = ss.Stance(ss.ContactSet(tripod), (0.1, 0.1, 1.0), MASS)
    point, contact = (minimise_largest_wrench(stance, "force", level) for level in ("point", "contact"))
    assert point.objective == contact.objective


def test_equal_shares_and_frictionless_points():
    """Many equal norms at the optimum; a point without friction beside others; a single sole."""
    flat = ss.ContactSet([sole("left", 0.0, 0.1), sole("right", 0.0, -0.1)])
    for contacts, points in ((flat, 8), (ss.ContactSet([sole("only", 0.0, 0.0)]), 4)):
        many = ss.minimise_largest_force_many(contacts, [[0.0, 0.0, 0.6]], mass=MASS)
        assert many.engine[0] == "kernel" and many.objective[0] == pytest.approx(MASS * 9.81 / points, rel=1e-8)
    prop = ss.ContactSet([sole("left", 0.0, 0.1, 0.3), ss.FrictionlessPointContact("prop", (0.3, -0.3, 0.0), normal=UP)])
    stance = ss.Stance(prop, (0.02, 0.08, 0.5), MASS)
    answer, wanted = (minimise_largest_wrench(stance, engine=e) for e in ("kernel", "clarabel"))
    assert compiled_minimax(stance, assemble(stance), "force") is not None
    assert answer.objective == pytest.approx(wanted.objective, rel=1e-7)


HANDED = {
    "one point": [ss.PointContact("p", (0, 0, 0), normal=UP, friction=0.5)],
    "two points": [ss.PointContact(f"p{k}", (x, 0, 0), normal=UP, friction=0.5) for k, x in enumerate((-0.1, 0.1))],
    "no friction": [ss.SurfaceContact("ice", (0, 0, 0), normal=UP, friction=0.0, size=(0.2, 0.2))],
    "a soft finger": [sole("foot", 0, 0), ss.SoftFingerContact("f", (0.2, 0, 0), normal=UP, friction=0.5, torsional_friction=0.01)],
    "a bound": [sole("foot", 0, 0, normal_force=(0.0, 900.0))],
}


@pytest.mark.parametrize("case", HANDED)
def test_what_the_compiled_program_leaves_is_answered_all_the_same(case):
    contacts = ss.ContactSet(HANDED[case])
    stance = ss.Stance(contacts, (0.0, 0.0, 0.5), MASS)
    assert compiled_minimax(stance, assemble(stance), "force") is None
    many = ss.minimise_largest_force_many(contacts, [stance.com], mass=MASS)
    wanted = minimise_largest_wrench(stance, engine=("clarabel", "cvxpy"))
    assert many.status[0] == wanted.status == "solved"
    assert many.objective[0] == pytest.approx(wanted.objective, rel=1e-7)
    assert np.linalg.norm(many.forces[0], axis=1).max() == pytest.approx(wanted.objective, rel=1e-6)


@pytest.mark.parametrize("more", [{}, {"cone": "inscribed"}, {"loads": np.tile([20.0, -10.0, 5.0, 1.0, 2.0, 0.5], (40, 1))}],
                         ids=["exact", "inscribed", "pushed"])  # fmt: skip
def test_batches_are_the_answers_one_by_one(more):
    places = coms()
    many = ss.minimise_largest_force_many(FEET, places, mass=MASS, **more)
    assert set(many.status) == {"solved", "infeasible"} and len(many) == 40 and len(many[3:5]) == 2
    assert set(many.engine) == {"kernel"} and not many.handovers.any()
    for k in range(40):
        alone = many[k]
        push = [ss.ExternalWrench(w[:3], w[3:], (0.0, 0.0, 0.0)) for w in more["loads"][k : k + 1]] if "loads" in more else []
        stance = ss.Stance(FEET, places[k], MASS, external_wrenches=push)
        wanted = minimise_largest_wrench(stance, cone=more.get("cone", "exact"), engine="clarabel")
        assert many.status[k] == alone.status == wanted.status
        if alone.status == "solved":
            assert many.objective[k] == pytest.approx(wanted.objective, rel=1e-6)
            assert many.objective[k] == pytest.approx(alone.objective, rel=1e-8)
            np.testing.assert_allclose(np.linalg.norm(many.forces[k], axis=1).max(), many.objective[k], rtol=1e-7)
            assert max(force_violations(stance, alone.forces, ConeChoice(more.get("cone", "exact")))) <= 1e-8
            np.testing.assert_allclose(many.forces[k], alone.forces.force_W, atol=1e-4)
        else:
            assert np.isnan(many.forces[k]).all()


def test_many_contact_sets_and_postures():
    sets = [ss.ContactSet([sole("a", 0.0, 0.1, 0.05 * k), sole("b", 0.0, -0.1)]) for k in range(5)]
    many = ss.minimise_largest_force_many(sets, coms(5, 2) * [0.3, 0.3, 1.0], mass=np.linspace(10, 50, 5))
    for k, com in enumerate(coms(5, 2) * [0.3, 0.3, 1.0]):
        wanted = minimise_largest_wrench(ss.Stance(sets[k], com, 10.0 + 10.0 * k), engine="clarabel")
        assert many.objective[k] == pytest.approx(wanted.objective, rel=1e-6)
    with pytest.raises(ss.InputError, match="several contact sets"):
        _ = many.forces
    robot = ss.load_robot("hoap2")
    posture = ss.pose(robot, np.zeros(len(robot.joints)), support=["left_foot", "right_foot"], friction=0.5)
    for limits in (False, {"default": 5.0}):
        both = ss.minimise_largest_force_many([posture, posture], torque_limits=limits)
        wanted = minimise_largest_wrench(posture, torque_limits=limits, engine="clarabel")
        assert both.status.tolist() == [wanted.status] * 2
        assert both[0].torques.keys() == wanted.torques.keys()
        assert both.objective == pytest.approx([wanted.objective] * 2, rel=1e-6)


def test_answers_do_not_depend_on_the_number_of_threads():
    places = coms(1200, 1)
    one, two = (ss.minimise_largest_force_many(FEET, places, mass=MASS, threads=n) for n in (1, 2))
    assert one.objective.tobytes() == two.objective.tobytes()
    assert one.forces.tobytes() == two.forces.tobytes()


def test_nothing_asked_is_nothing_answered():
    none = ss.minimise_largest_force_many(FEET, np.zeros((0, 3)), mass=MASS)
    assert len(none) == 0 and none.forces.shape == (0, 8, 3)


WRONG = [
    ({"coms": [[0.0, 0.0]]}, r"coms must be numbers of shape \(3\) or \(b, 3\), got shape \(1, 2\)"),
    ({"coms": None}, "coms is missing"),
    ({"mass": -3.0}, "mass must be > 0, entry 0 is -3.0"),
    ({"loads": "heavy"}, "loads must be numbers"),
    ({"threads": 0}, "threads must be a whole number"),
    ({"contacts": 3}, "a contact set or a sequence of them is expected"),
    ({"engine": "fast"}, "engine 'fast' is not known"),
    ({"cone": "round"}, "cone"),
]


@pytest.mark.parametrize(("change", "sentence"), WRONG, ids=lambda v: v if isinstance(v, str) else "")
def test_wrong_input_is_refused_by_name(change, sentence):
    arguments = {"contacts": FEET, "coms": [[0.0, 0.0, 0.5]], "mass": MASS} | change
    contacts, places, mass = (arguments.pop(k) for k in ("contacts", "coms", "mass"))
    with pytest.raises(ss.InputError, match=sentence):
        ss.minimise_largest_force_many(contacts, places, mass, **arguments)
