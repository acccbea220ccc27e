"""Posture optimisation: its optimality conditions from finite differences, no better posture nearby, closed forms, and the user's path."""

import json
import time
import tomllib

import cvxpy as cp
import numpy as np
import pytest
from torque_oracles import FOUR, INF, generate, legs, moved_posture

import socp_statics as ss
from socp_statics.cases.problem import load_problem, problem_from_tables
from socp_statics.cases.solve import solve
from socp_statics.cases.summary import summarise
from socp_statics.cli import main
from socp_statics.cones.choice import ConeChoice
from socp_statics.exceptions import InputError
from socp_statics.figures.optimized_posture import optimized_posture
from socp_statics.models.contact_forces_set import force_shape, force_values
from socp_statics.models.repeated_forces import repeated_forces
from socp_statics.optimization import optimise_posture
from socp_statics.postures.held_contacts import HeldContacts
from socp_statics.postures.moved import posture_on
from socp_statics.robots import load_robot
from socp_statics.statics import assemble

PUSH = ss.ExternalWrench(force=[15, 0, 0], point=[0, -0.039, 0.35], link="BODY_LINK1")
BENT = {f"{side}LEG_JOINT{k}": angle for side in "LR" for k, angle in ((3, -0.2), (4, 0.3), (5, -0.1))}
STEP = 1e-5


@pytest.fixture(scope="module")
def hoap2():
    return load_robot("hoap2")


def hands_on_the_wall(robot):
    return ss.pose(robot, BENT, FOUR, {name: 0.3 if "hand" in name else 0.5 for name in FOUR})


def found(robot, which):
    """A few optimisations, by name: (given posture, what is asked, the answer)."""
    posture, objective, more = {
        "squat margin": (generate("squat", robot), "margin", {"torque_limits": legs(2.0)}),
        "squat torque": (generate("squat", robot), "torque", {"torque_limits": legs(2.0)}),
        "single margin": (generate("single_stance", robot), "margin", {}),
        "wall margin": (hands_on_the_wall(robot), "margin", {"torque_limits": {"default": 0.7}, "external_wrenches": [PUSH]}),
        "wall torque": (hands_on_the_wall(robot), "torque", {"torque_limits": {"default": 1.0}, "external_wrenches": [PUSH]}),
        "wall sliding": (hands_on_the_wall(robot), "margin",
                         {"torque_limits": legs(2.0), "external_wrenches": [PUSH], "slide": ["left_hand", "right_hand"]}),
        "squat com": (generate("squat", robot), "com_margin", {}),
    }[which]  # fmt: skip
    return posture, more, optimise_posture(posture, objective, engine="clarabel", **more)


ALL = ("squat margin", "squat torque", "single margin", "wall margin", "wall torque", "wall sliding", "squat com")


def judged(posture, objective, more):
    """The objective, larger is better, by the toolkit's verdict on the posture alone."""
    settings = {key: value for key, value in more.items() if key != "slide"} | {"engine": "clarabel"}
    if objective == "margin":
        return ss.check_equilibrium(posture, **settings).margin
    if objective == "torque":
        limits = settings.pop("torque_limits")
        loads = settings.get("external_wrenches", ())
        return -ss.minimise_torque_use(posture.stance(external_wrenches=loads, torque_limits=limits)).objective
    return ss.trace_support_region(posture.stance(), **settings).com_margin


class TestOptimality:
    @pytest.mark.parametrize("which", ALL)
    def test_it_improves_and_says_so(self, hoap2, which):
        given, more, answer = found(hoap2, which)
        better = answer.before - answer.after if answer.objective == "torque" else answer.after - answer.before
        assert better > 1e-4 and answer.local_optimum and answer.reason is None and answer.optimality <= 1e-6
        sign = -1.0 if answer.objective == "torque" else 1.0
        assert sign * answer.before == pytest.approx(judged(given, answer.objective, more), abs=1e-5)
        assert sign * answer.after == pytest.approx(judged(answer.stance.posture, answer.objective, more), abs=1e-5)

    @pytest.mark.parametrize("which", ALL)
    def test_contacts_and_joint_limits_are_kept(self, hoap2, which):
        given, more, answer = found(hoap2, which)
        riding = moved_posture(answer.posture, np.zeros(31))
        for contact in given.contacts:
            here, link = answer.posture.contacts[contact.name], riding.contacts[contact.name]
            assert np.abs(here.position - link.position).max() < 1e-10
            if contact.type == "surface":
                assert np.abs(here.rotation - link.rotation).max() < 1e-10
            if contact.name in more.get("slide", ()):
                assert abs((here.position - contact.position) @ contact.normal_W) < 1e-10
                assert np.abs(here.normal_W - contact.normal_W).max() < 1e-10
            else:
                assert np.array_equal(here.position, contact.position) and np.array_equal(here.rotation, contact.rotation)
        assert (answer.posture.angles >= hoap2.lower - 1e-10).all() and (answer.posture.angles <= hoap2.upper + 1e-10).all()

    @pytest.mark.parametrize("which", ALL)
    def test_no_posture_nearby_is_better_to_first_order(self, hoap2, which):
        """Random motions along the contacts, brought back onto them: what they gain is of second order."""
        given, more, answer = found(hoap2, which)
        held = HeldContacts(given, more.get("slide", ()))
        motions, rng = held.motions(answer.posture), np.random.default_rng(50)
        unit = {"margin": answer.stance.weight, "torque": 1.0, "com_margin": 0.17}[answer.objective]
        best = judged(answer.posture, answer.objective, more)
        tried = 0
        for _ in range(12):
            z = rng.normal(size=motions.shape[1])
            step = 1e-3 * motions @ (z / np.linalg.norm(z))
            near = held.closed(answer.posture, step)
            if near is None:
                continue
            tried += 1
            assert judged(near, answer.objective, more) <= best + (1e-3 * 2e-6 + 2e-6 + 1e-9) * unit + 1e-3 * abs(best) * (
                answer.objective == "com_margin"
            )
        assert tried >= 10

    @pytest.mark.parametrize("which", [name for name in ALL if "com" not in name])
    def test_the_kkt_residual_by_finite_differences(self, hoap2, which):
        """The statics linearised anew by differences, in SI and without the toolkit's programs: they promise next to nothing."""
        given, more, answer = found(hoap2, which)
        held, posture = HeldContacts(given, more.get("slide", ())), answer.posture
        gain = promised_gain(answer, held)
        assert gain <= 2e-5, f"{which}: the linearised statics promise {gain:.2e}"
        assert posture.contacts.names == given.contacts.names

    def test_closed_forms(self, hoap2):
        W = hoap2.mass * 9.81
        assert found(hoap2, "squat margin")[2].after == pytest.approx(W / 8, rel=1e-5), "eight corners share the weight"
        assert found(hoap2, "single margin")[2].after == pytest.approx(W / 4, rel=1e-5), "four corners share the weight"
        assert found(hoap2, "squat torque")[2].after == pytest.approx(0.0, abs=1e-5), "straight legs need no torque"
        assert found(hoap2, "squat com")[2].after == pytest.approx(0.049, abs=1e-6), "half a sole"

    def test_it_is_fast_and_repeats_itself(self, hoap2):
        """Two seconds of this machine each at most; measured in processor time, as others use the machine too."""
        found(hoap2, "wall torque")
        for which in ("squat margin", "squat torque", "wall margin", "wall sliding", "wall torque"):
            start = time.process_time()
            one = found(hoap2, which)[2]
            assert time.process_time() - start < 2.0, which
            assert np.array_equal(one.posture.q, found(hoap2, which)[2].posture.q)


def promised_gain(answer, held):
    """What the linearised statics promise within a motion of length one, by central differences and cvxpy."""
    posture, stance = answer.posture, answer.stance
    data = assemble(stance)
    x = optimal_forces(answer, data)
    motions = held.motions(posture)
    slopes_w, slopes_t = [], []
    for m in motions.T:
        ends = []
        for sign in (1.0, -1.0):
            # off the contacts by a second-order gap, the same on both sides
            riding = moved_posture(posture, sign * STEP * m)
            places = {c.name: riding.contacts[c.name] if c.name in held.sliding else c for c in posture.contacts}
            kept = {c.name: c.placed(np.array(places[c.name].position), np.array(c.rotation), c.friction) for c in posture.contacts}
            near = posture_on(posture, riding.q, kept)
            moved = assemble(type(stance)(near.contacts, near.com_W, stance.mass, stance.gravity, stance.external_wrenches, None, near,
                                          stance.torque_limits))  # fmt: skip
            units = moved.units
            net = (moved.wrench_map @ x + moved.load) * units.wrench * np.repeat([data.units.force / units.force], 6)
            net[3:] += np.cross(units.origin - data.units.origin, net[:3])
            tau = moved.torques.of(x) * units.force * units.length
            ends.append((net / data.units.wrench, tau / (data.units.force * data.units.length)))
        slopes_w.append((ends[0][0] - ends[1][0]) / (2 * STEP))
        slopes_t.append((ends[0][1] - ends[1][1]) / (2 * STEP))
    A, B = np.array(slopes_w).T, np.array(slopes_t).T
    f, z, t = cp.Variable(len(x)), cp.Variable(motions.shape[1]), cp.Variable()
    reserve = t if answer.objective == "margin" else 0.0
    tangential, normal = cp.reshape(f[data.tangential], (2, data.slipping), order="F"), f[data.normal]
    limits, share = data.torques.limits, 1.0 if answer.objective == "margin" else -t
    tau = data.torques.passive - data.torques.map @ f + B @ z
    constraints = [data.wrench_map @ f + data.load + A @ z == 0, cp.norm(z) <= 1,
                   cp.SOC(cp.multiply(data.friction, normal - reserve), tangential, axis=0),
                   posture.angles + motions[6:] @ z <= np.maximum(posture.robot.upper, posture.angles),
                   posture.angles + motions[6:] @ z >= np.minimum(posture.robot.lower, posture.angles)]  # fmt: skip
    for end, sign in ((limits[:, 1], 1), (-limits[:, 0], -1)):
        finite = np.flatnonzero(np.isfinite(end))
        if len(finite):
            constraints.append(sign * tau[finite] <= cp.multiply(end[finite], share * np.ones(len(finite))))
    problem = cp.Problem(cp.Maximize(t), constraints)
    problem.solve(solver=cp.CLARABEL)
    now = answer.after / data.units.force if answer.objective == "margin" else -answer.after
    return float(problem.value) - now


def optimal_forces(answer, data):
    """Scaled unknowns of optimal forces, asked of cvxpy at the result."""
    f, t = cp.Variable(data.wrench_map.shape[1]), cp.Variable()
    margin = answer.objective == "margin"
    tangential, normal = cp.reshape(f[data.tangential], (2, data.slipping), order="F"), f[data.normal]
    constraints = [data.wrench_map @ f + data.load == 0,
                   cp.SOC(cp.multiply(data.friction, normal - (t if margin else 0.0)), tangential, axis=0)]  # fmt: skip
    tau = data.torques.passive - data.torques.map @ f
    for end, sign in ((data.torques.limits[:, 1], 1), (-data.torques.limits[:, 0], -1)):
        finite = np.flatnonzero(np.isfinite(end))
        if len(finite):
            constraints.append(sign * tau[finite] <= cp.multiply(end[finite], (1.0 if margin else -t) * np.ones(len(finite))))
    cp.Problem(cp.Maximize(t), constraints).solve(solver=cp.CLARABEL)
    return f.value


class TestFirstNothingHolds:
    def test_weak_knees_get_up(self, hoap2):
        answer = optimise_posture(generate("squat", hoap2), torque_limits={"default": INF, "?LEG_JOINT4": 1.0})
        assert answer.before == -INF and answer.given.reason == "torque"
        assert answer.found.verdict == "stable" and answer.after == pytest.approx(hoap2.mass * 9.81 / 8, rel=1e-5)

    def test_an_unstable_posture_is_brought_over_its_feet(self, hoap2):
        bowed = {f"{side}LEG_JOINT{k}": angle for side in "LR" for k, angle in ((3, -0.6), (5, 0.6))}
        leaning = ss.pose(hoap2, bowed | {"BODY_JOINT1": 0.3})
        answer = optimise_posture(leaning)
        assert answer.before < 0.0 < answer.after and answer.given.verdict == "unstable" and answer.found.verdict == "stable"

    def test_where_no_posture_keeps_the_limits(self, hoap2):
        answer = optimise_posture(generate("squat", hoap2), torque_limits={"default": INF, "?LEG_JOINT6": 0.0, "BODY_JOINT1": 1e-3,
                                                                            "?ARM_JOINT*": 1e-4})  # fmt: skip
        assert not answer.local_optimum or answer.after > 0.0

    def test_where_nothing_can_be_improved(self, hoap2):
        lifted = ss.pose(hoap2, {}, ["left_hand"], 0.5)
        answer = optimise_posture(lifted, "torque", torque_limits={"default": 9.0})
        assert answer.steps == 0 and not answer.local_optimum and answer.optimality is None
        assert answer.reason == "no contact forces balance the load within the torque limits" and answer.before == INF

    def test_an_infinite_margin_stays(self, hoap2):
        sideways = ss.pose(hoap2, {"LARM_JOINT2": 1.57, "RARM_JOINT2": -1.57}, FOUR, 0.8)
        answer = optimise_posture(sideways)
        assert answer.reason == "nothing limits the margin" and answer.after == INF and answer.steps == 0
        assert not answer.local_optimum and answer.optimality is None

    def test_a_region_without_edges(self, hoap2):
        posture = ss.pose(hoap2, {}, ["left_hand", "right_hand"], 0.5)
        answer = optimise_posture(posture, "com_margin")
        assert answer.reason == "the support region is no bounded polygon" and not answer.local_optimum


class TestHeldObjects:
    @pytest.mark.parametrize("objective", ["margin", "torque"])
    def test_hands_that_would_leave_the_object_are_refused(self, hoap2, objective):
        holding = generate("hold_object", hoap2, mass=1.0)
        with pytest.raises(InputError, match="ARM_LINK4 .*hold an object and would leave it"):
            optimise_posture(holding, objective, torque_limits={"default": 2.0})


class TestHeldContacts:
    def test_motions_keep_the_contacts(self, hoap2):
        posture = hands_on_the_wall(hoap2)
        held = HeldContacts(posture)
        assert held.motions(posture).shape == (31, 31 - 12 - 6), "feet hold six each, fingertips may roll"
        for m in held.motions(posture).T:
            assert np.abs(held.gap(moved_posture(posture, 1e-6 * m))).max() < 1e-10

    def test_what_the_robot_holds_is_kept(self, hoap2):
        holding, rng = generate("hold_object", hoap2, mass=1.0), np.random.default_rng(53)
        near = HeldContacts(holding).closed(holding, 0.1 * rng.normal(size=31) / np.sqrt(31))
        assert near.loads == holding.loads and len(near.loads) == 2

    def test_sliding_hands_have_four_more(self, hoap2):
        posture = hands_on_the_wall(hoap2)
        assert HeldContacts(posture, ["left_hand", "right_hand"]).motions(posture).shape[1] == 13 + 4
        assert HeldContacts(posture, ["left_foot"]).motions(posture).shape[1] == 13 + 3

    def test_motions_too_long_are_brought_back_or_refused(self, hoap2):
        posture, rng = hands_on_the_wall(hoap2), np.random.default_rng(52)
        held, back = HeldContacts(posture), 0
        for _ in range(10):
            near = held.closed(posture, 0.3 * rng.normal(size=31) / np.sqrt(31))
            if near is not None:
                back += 1
                assert np.abs(held.gap(moved_posture(near, np.zeros(31)))).max() < 1e-10
        assert back >= 8

    def test_copies_of_a_set_are_independent(self, hoap2):
        finger = ss.SoftFingerContact("finger", (0.3, 0, 0.1), normal=(-0.3, 0, 1), friction=0.5, torsional_friction=0.03, shape="box")
        soft = ss.SoftFingerContact("soft", (-0.3, 0, 0.1), normal=(0.3, 0, 1), friction=0.4, torsional_friction=0.02)
        foot = ss.SurfaceContact("foot", (0, 0, 0), normal=(0, 0, 1), friction=0.6, size=(0.2, 0.1), normal_force=(0.0, 400.0))
        bar = ss.Handle("bar", (0, 0.3, 1), rpy=(0, 0, 0), transmits=["fx", "fz"], limits={"fx": (-50.0, 60.0)})
        data = assemble(ss.Stance(ss.ContactSet([finger, soft, foot, bar]), (0, 0, 0.5), 60.0))
        shape, values = force_shape(data, ConeChoice(), "socp", 6), force_values(data, ConeChoice(), np.eye(6))
        both, rng = repeated_forces(shape, values, 3), np.random.default_rng(53)
        assert sorted(both.columns.ravel()) == list(range(both.shape.columns)) and both.shape.columns == 3 * shape.columns
        x = rng.normal(size=(3, shape.columns))
        whole = np.zeros(both.shape.columns)
        whole[both.columns] = x
        assert np.allclose((both.values["G"] @ whole).reshape(3, 6), x @ values["G"].T)
        assert np.allclose((both.values["H"] @ whole).reshape(3, -1), x @ values["H"].T)
        f_n = whole[2 * both.shape.slipping :][: both.shape.points]
        own = x[:, data.normal]
        assert np.allclose((both.values["S_upper"] @ f_n).reshape(3, -1), own @ values["S_upper"].T)
        assert np.allclose(np.sort(both.values["mu"]), np.sort(np.tile(values["mu"], 3)))


GOOD = """\
model = "posture_optimization"

[posture]
generator = "squat"
robot = "hoap2"

[posture.torque_limits]
default = inf
"?LEG_JOINT*" = 2.0

[parameters]
torque_limits = true
objective = "margin"
"""

WRONG = {
    "no robot": None,
    "unknown objective": ('"margin"', '"comfort"', ["parameters.objective", "'margin', 'com_margin' or 'torque'", "'comfort'"]),
    "torque without limits": ('torque_limits = true\nobjective = "margin"', 'objective = "torque"',
                              ["parameters.objective", "torque_limits = true is expected"]),
    "torque without a finite limit": ('"?LEG_JOINT*" = 2.0\n\n[parameters]\ntorque_limits = true\nobjective = "margin"',
                                      '\n[parameters]\ntorque_limits = true\nobjective = "torque"', ["at least one finite limit"]),
    "unknown contact slides": ('objective = "margin"', 'slide = ["left_fot"]',
                               ["parameters.slide[0]", "'left_fot'", "did you mean 'left_foot'"]),
    "unknown key": ('objective = "margin"', "steps = 3", ["parameters.steps is not a known key"]),
}  # fmt: skip


class TestAsAUser:
    @pytest.mark.parametrize("fault", [name for name in WRONG if WRONG[name]])
    def test_wrong_input(self, fault):
        before, after, words = WRONG[fault]
        assert before in GOOD
        with pytest.raises(InputError) as caught:
            solve(problem_from_tables(tomllib.loads(GOOD.replace(before, after)), "posture"))
        assert all(word in str(caught.value) for word in words), str(caught.value)

    def test_wrong_input_without_a_robot(self, hoap2):
        tables = dict(load_problem("contacts/flat_double_stance").raw) | {"model": "posture_optimization", "parameters": {}, "expect": {}}
        with pytest.raises(InputError, match=r"parameters.*needs? a robot|with a robot"):
            problem_from_tables(tables, "feet")
        with pytest.raises(InputError, match="contacts alone have no joints"):
            optimise_posture(ss.Stance([ss.PointContact("p", (0, 0, 0), normal=(0, 0, 1), friction=0.5)], (0, 0, 1), 6.0))
        with pytest.raises(InputError, match="objective must be one of"):
            optimise_posture(generate("squat", hoap2), "torqe")
        with pytest.raises(InputError, match="at least one finite limit"):
            optimise_posture(generate("squat", hoap2), "torque")
        with pytest.raises(InputError, match="did you mean 'left_hand'"):
            optimise_posture(hands_on_the_wall(hoap2), slide=["left_hnd"])

    def test_nothing_free_to_move(self, tmp_path):
        inertial = "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>"
        path = tmp_path / "block.urdf"
        path.write_text(f"<robot name='block'><link name='base'>{inertial}</link></robot>")
        block = load_robot(path, frames={"sole": {"frame": "base", "type": "surface", "size": [0.2, 0.1]}})
        with pytest.raises(InputError, match="nothing is free to move: the contacts sole hold every joint"):
            optimise_posture(ss.pose(block, {}, ["sole"]))

    @pytest.mark.parametrize("name", ["squat_optimised", "weak_knees_get_up", "squat_eased", "hands_choose_the_wall"])
    def test_the_record(self, name, tmp_path, capsys):
        file, picture = tmp_path / "record.json", tmp_path / "picture.png"
        assert main(["solve", f"hoap2/{name}", "--json", str(file), "--figure", str(picture)]) == 0
        printed = capsys.readouterr().out
        assert "optimised" in printed and "local optimum" in printed and " to " in printed and picture.stat().st_size > 10_000
        record = json.loads(file.read_text())
        optimized = record["optimized"]
        assert record["objective"] == optimized["objective_after"] and optimized["local_optimum"] and optimized["optimality"] <= 1e-6
        given = load_problem(f"hoap2/{name}").robot_posture
        assert list(record["case"]["generated"]["angles"].values()) == given.angles.tolist()
        posture = optimized_posture(record, given)
        assert np.allclose(posture.com_W, optimized["com"], atol=1e-10)
        again = moved_posture(posture, np.zeros(31))
        assert all(np.allclose(again.contacts[c.name].position, c.position, atol=1e-9) for c in posture.contacts)
        for made, answer in ((record["case"]["generated"], record), (optimized, optimized)):
            if answer["verdict"] == "stable":
                assert max(rechecked(record["case"]["posture"], made, answer["forces"], given.mass)) < 1e-6 * given.mass * 9.81

    def test_without_a_gain_the_summary_says_why(self):
        tables = tomllib.loads(GOOD.replace('generator = "squat"', 'generator = "joint_angles"\nsupport = ["left_hand"]\nfriction = 0.5'))
        text = summarise(solve(problem_from_tables(tables, "hanging")))
        assert "no local optimum" in text or "margin from" in text

    def test_show_says_what_is_free(self, capsys):
        assert main(["show", "hoap2/hands_choose_the_wall"]) == 0
        shown = capsys.readouterr().out
        assert "contacts(q) = given" in shown and "free to slide in their planes: left_hand, right_hand" in shown
        assert main(["show", "hoap2/squat_eased"]) == 0
        assert "s lower_j <= tau_j" in capsys.readouterr().out


def rechecked(stated, made, forces, mass):
    """Balance about the centre of mass, and the worst violation of a cone, of a posture's forces [N, N m]."""
    com = np.array(made["com"])
    force, moment, worst = np.array([0, 0, -9.81 * mass]), np.zeros(3), 0.0
    for load in stated["external_wrenches"]:
        force, moment = force + load["force"], moment + np.cross(np.array(load["point"]) - com, load["force"])
    contacts = {entry["name"]: entry for entry in made["contacts"]}
    for entry in forces:
        f, contact = np.array(entry["force"]), contacts[entry["contact"]]
        force, moment = force + f, moment + np.cross(np.array(entry["point"]) - com, f)
        local = np.array(contact["rotation"]).T @ f
        worst = max(worst, float(np.hypot(*local[:2]) - contact["friction"] * local[2]))
    return np.linalg.norm(force), np.linalg.norm(moment), worst
