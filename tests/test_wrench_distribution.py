"""Every method side by side: what is measured, the programs, the table of the command line, and wrong input."""

import json
from typing import get_args

import numpy as np
import pytest
from programs import KINDS, stance_of_kind
from random_postures import POSTURES, robot

import socp_statics as ss
from socp_statics.cases.answers import wrench_distribution as answers
from socp_statics.cases.problem import load_problem
from socp_statics.cases.solve import solve
from socp_statics.cli import main
from socp_statics.contacts import ContactSet, Handle, PointContact, Stance, SurfaceContact
from socp_statics.distribution import CLOSED_FORMS
from socp_statics.exceptions import EngineError, InputError
from socp_statics.optimization.wrench_distribution import METHODS, PROGRAMS
from socp_statics.optimization.wrench_reserve import wrench_reserve
from socp_statics.statics import assemble

UP, SOLE = (0, 0, 1), [[-0.04, -0.0315], [0.058, -0.0315], [0.058, 0.0315], [-0.04, 0.0315]]
FAST = ("clarabel", "cvxpy")
NAME = "chapter/noncoplanar_double_stance"


SLOPE = np.deg2rad(15)


def roof(roll=SLOPE, friction=0.2, com=(0.009, 0.01, 0.24)):
    feet = [
        SurfaceContact(name, (0, side * 0.039, 0), rpy=(side * roll, 0, 0), friction=friction, vertices=SOLE)
        for name, side in (("right_foot", -1), ("left_foot", 1))
    ]
    return Stance(ContactSet(feet), com, 6.2431648)


def test_methods_are_the_same_everywhere():
    assert tuple(CLOSED_FORMS) == answers.CLOSED and set(METHODS) == {*CLOSED_FORMS, *PROGRAMS}
    assert get_args(answers.Method) == ("all", *METHODS)
    assert set(answers.DISTRIBUTION_KEYS["distribution"]["methods"]) == set(METHODS)


def test_closed_forms_ignore_the_cones_and_programs_keep_them():
    compared = ss.compare_distributions(roof(), engine=FAST)
    assert list(compared.methods) == list(METHODS) and compared.equilibrium.stable
    for name, found in compared.methods.items():
        assert found.status == "solved"
        assert found.balance < (1e-12 if name in CLOSED_FORMS else 1e-8)
        assert np.allclose(sum(found.measures.normal_share.values()), 1.0)
        assert found.holds == (name in PROGRAMS or name == "friction_weighted")
        assert found.measures.cone_violation == (0.0 if found.holds else -found.measures.reserve)


def test_the_lever_rule_asks_the_tangent_of_the_slope_of_friction_and_an_internal_force_asks_nothing():
    found = ss.distribute(roof(), "statics_consistent", engine=FAST).measures
    assert found.friction_use["left_foot"] * 0.2 == pytest.approx(np.tan(np.deg2rad(15)), abs=1e-12)
    assert found.normal_share["left_foot"] == pytest.approx(0.049 / 0.078, abs=1e-12)
    assert abs(found.internal_forces["right_foot - left_foot"]) < 1e-12
    without = ss.minimise_largest_wrench(roof(friction=0.05), "friction_use", engine=FAST)
    assert without.objective == 0.0


def test_the_reserve_of_wrenches_is_that_of_their_corner_forces():
    stance = roof()
    data = assemble(stance)
    rng = np.random.default_rng(0)
    best = ss.check_equilibrium(stance, engine="clarabel")
    W = np.array([[*w["force"], *w["moment"]] for w in best.forces.wrenches()])
    local = np.array([np.kron(np.eye(2), c.rotation.T) @ F for c, F in zip(stance.contacts, W, strict=True)])
    choice = ss.ConeChoice()
    assert wrench_reserve(data, local, choice, "socp", "clarabel") == pytest.approx(best.margin, abs=1e-7)
    for _ in range(5):
        some = local + 2.0 * rng.normal(size=local.shape) * [1, 1, 1, 0.02, 0.02, 0.02]
        t = wrench_reserve(data, some, choice, "socp", "clarabel")
        less = some.copy()
        less[:, 2] -= 4 * 0.5
        less[:, 4] += 4 * 0.5 * 0.009
        assert wrench_reserve(data, less, choice, "socp", "clarabel") == pytest.approx(t - 0.5, abs=1e-6)


def test_reserves_without_end_and_without_hope():
    rail = Handle("rail", (0, 0, 1), rpy=(0, 0, 0), transmits=["fx", "fy", "fz", "mx", "my", "mz"], limits={"fz": [-10, 10]})
    held = Stance(ContactSet([rail]), (0, 0, 0.5), 0.5)
    data = assemble(held)
    F = np.zeros((1, 6))
    assert wrench_reserve(data, F, ss.ConeChoice(), "socp", "clarabel") == np.inf
    F[0, 2] = 11.0
    assert wrench_reserve(data, F, ss.ConeChoice(), "socp", "clarabel") == -np.inf
    point = Stance(ContactSet([PointContact("tip", (0, 0, 0), normal=UP, friction=0.5)]), (0, 0, 0.5), 1.0)
    F = np.array([[0, 0, 9.81, 1.0, 0, 0]])
    assert wrench_reserve(assemble(point), F, ss.ConeChoice(), "socp", "clarabel") == -np.inf


def test_the_quadratic_program_is_optimal_among_admissible_changes():
    stance = roof(com=(0.02, 0.015, 0.24))
    feet = stance.contacts
    units = assemble(stance).units
    for weight, cops in ((0.0, None), (1.0, None), (30.0, {"left_foot": [0.03, 0.01]})):
        found = ss.distribute(stance, "qp", cop_weight=weight, cops=cops, engine=FAST)
        frozen = ss.distribute(stance, "barycentric", engine=FAST).wrenches_C[:, 2] / units.force
        middle = np.mean(SOLE, axis=0)

        def cost(F, weight=weight, cops=cops, frozen=frozen, middle=middle):
            f = F / units.wrench
            total = (f**2).sum()
            for k, contact in enumerate(feet):
                x, y = np.array((cops or {}).get(contact.name, middle)) / units.length
                total += weight * ((f[k, 4] + x * f[k, 2]) ** 2 + (f[k, 3] - y * f[k, 2]) ** 2) / frozen[k] ** 2
            return total

        assert found.objective == pytest.approx(cost(found.wrenches_C), rel=1e-9)
        others = [ss.distribute(stance, m, engine=FAST) for m in ("least_squares", "minimax")]
        for other in others:
            direction = other.wrenches_C - found.wrenches_C
            assert cost(found.wrenches_C + 1e-4 * direction) >= cost(found.wrenches_C) - 1e-9
    far = ss.distribute(stance, "qp", cop_weight=1e4, cops={"left_foot": [0.03, 0.01]}, engine=FAST).measures.cop["left_foot"]
    near = ss.distribute(stance, "qp", cop_weight=0.0, engine=FAST).measures.cop["left_foot"]
    assert np.linalg.norm(np.subtract(far, [0.03, 0.01])) < np.linalg.norm(np.subtract(near, [0.03, 0.01]))


def test_with_its_weights_at_rest_the_quadratic_program_is_the_scaled_pseudoinverse_where_that_is_inside():
    stance = roof(roll=0.0, friction=0.5, com=(0.009, 0.005, 0.24))
    qp, closed = (ss.distribute(stance, m, cop_weight=0.0, engine=FAST) for m in ("qp", "scaled_pseudoinverse"))
    assert closed.holds and np.allclose(qp.wrenches_W, closed.wrenches_W, atol=1e-5)


def test_programs_are_those_of_the_other_models():
    stance = roof()
    least = ss.optimise_contact_forces(stance, "least_squares", engine=FAST)
    largest = ss.minimise_largest_wrench(stance, "force", "point", engine=FAST)
    assert ss.distribute(stance, "least_squares", engine=FAST).objective == pytest.approx(least.objective)
    assert ss.distribute(stance, "minimax", engine=FAST).objective == pytest.approx(largest.objective)


@pytest.mark.parametrize("cone", ["inscribed", "circumscribed"])
def test_pyramids_bracket_the_reserve(cone):
    exact = ss.distribute(roof(), "barycentric", engine=FAST).measures.reserve
    other = ss.distribute(roof(), "barycentric", cone=cone, sides=4, engine=FAST).measures.reserve
    assert other < exact + 1e-9 if cone == "inscribed" else other > exact - 1e-9


@pytest.mark.parametrize("name", POSTURES)
def test_torques_belong_to_the_wrenches_and_the_worst_joint_is_named(name):
    posture = ss.pose(robot(name), robot(name).reference, friction=0.5)
    found = ss.distribute(posture, "barycentric", engine=FAST)
    least = ss.optimise_contact_forces(posture, "least_squares", engine=FAST)
    program = ss.distribute(posture, "least_squares", engine=FAST)
    assert program.measures.torques == pytest.approx(least.torques, abs=1e-6)
    assert abs(found.measures.worst_torque) == max(abs(t) for t in found.measures.torques.values())
    limits = {"default": np.inf, posture.robot.joints[3]: 0.5}
    limited = ss.distribute(posture, "barycentric", torque_limits=limits, engine=FAST).measures
    assert limited.worst_joint == posture.robot.joints[3]
    assert limited.worst_share == pytest.approx(abs(limited.torques[posture.robot.joints[3]]) / 0.5)


def test_a_method_that_does_not_suit_is_kept_with_its_reason():
    corners = [PointContact(f"p{x}{y}", (0.2 * x, 0.1 * y, 0), normal=UP, friction=0.5) for x in (1, -1) for y in (1, -1)]
    stance = Stance(ContactSet(corners), (0.05, 0.02, 0.3), 10.0)
    compared = ss.compare_distributions(stance, engine=FAST)
    assert compared["statics_consistent"].status == "unsuitable" and "here are 4" in compared["statics_consistent"].note
    assert compared["barycentric"].holds and compared["barycentric"].measures.cop == dict.fromkeys(stance.contacts.names)
    floating = ss.compare_distributions(Stance(stance.contacts, (0, 0, 0.3), 10.0, gravity=(0, 0, 0)), engine=FAST)
    assert floating["barycentric"].status == "unsuitable" and floating["qp"].status == "solved"


def test_far_from_the_origin_the_balance_keeps_its_digits():
    feet = [c.placed(c.position + [1e3, -2e3, 50.0], c.rotation, c.friction) for c in roof().contacts]
    compared = ss.compare_distributions(Stance(ContactSet(feet), (1000.009, -1999.99, 50.24), 6.2431648), list(CLOSED_FORMS), engine=FAST)
    near = ss.compare_distributions(roof(), list(CLOSED_FORMS), engine=FAST)
    for name in CLOSED_FORMS:
        assert compared[name].balance < 1e-12
        assert np.allclose(compared[name].wrenches_W, near[name].wrenches_W, atol=1e-7)


def test_an_unstable_stance_still_has_closed_forms():
    compared = ss.compare_distributions(roof(com=(0.009, 0.2, 0.24)), engine=FAST)
    assert compared.equilibrium.verdict == "unstable"
    for name, found in compared.methods.items():
        assert found.status == ("solved" if name in CLOSED_FORMS else "infeasible") and not found.holds


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"method": "pinv"}, "method 'pinv' is not known"),
        ({"method": ["qp"]}, "is not known"),
        ({"method": "qp", "references": {"left_foot": [0, 0, 1]}}, "takes no references"),
        ({"method": "qp", "cop_weight": -1.0}, "cop_weight must be"),
        ({"method": "qp", "cops": {"left_hand": [0, 0]}}, "contact 'left_hand' is not there"),
        ({"method": "qp", "cops": {"left_foot": [0, 0, 0]}}, "cops must be 2 numbers"),
        ({"method": "friction_weighted", "friction_exponent": 0.0}, "friction_exponent must be"),
    ],
)
def test_wrong_options_are_named(options, words):
    with pytest.raises(InputError, match=words):
        ss.distribute(roof(), engine=FAST, **options)
    if "method" in options and options["method"] == "pinv":
        with pytest.raises(InputError, match=words):
            ss.compare_distributions(roof(), ["pinv"])


def test_a_broken_program_is_no_answer():
    with pytest.raises((EngineError, InputError)):
        ss.distribute(roof(), "qp", engine="no such engine")


@pytest.fixture
def unexpecting(tmp_path, capsys):
    """The named problem as a file without its expectations, which belong to all methods at once."""
    main(["show", NAME, "--toml"])
    path = tmp_path / "valley.toml"
    path.write_text(capsys.readouterr().out.partition("[expect]")[0])
    return str(path)


def test_the_table_of_the_command_line(unexpecting, capsys):
    assert main(["solve", NAME, "--set", "parameters.method=all"]) == 0
    printed = capsys.readouterr().out
    for name in METHODS:
        assert f" {name} " in printed
    for word in ("share [%]", "CoP [mm]", "friction use", "outside cone [N]", "worst torque [N m]", "1.340 1.340", "62.8 37.2"):
        assert word in printed
    assert main(["solve", unexpecting, "--set", "parameters.method=qp", "--json", "-"]) == 0
    record = json.loads(capsys.readouterr().out)
    assert list(record["distribution"]["methods"]) == ["qp"] and record["objective"] == record["distribution"]["methods"]["qp"]["objective"]
    for given, shown in zip(record["wrenches"], record["distribution"]["methods"]["qp"]["wrenches"], strict=True):
        assert given["contact"] == shown["contact"] and given["force"] == pytest.approx(shown["force"], abs=1e-9)


@pytest.fixture(scope="module")
def record():
    return solve(load_problem(NAME), "clarabel")


@pytest.mark.parametrize("method", METHODS)
def test_every_method_of_the_record_carries_the_weight(method, record):
    weight = sum(w["force"][2] for w in record["distribution"]["methods"][method]["wrenches"])
    assert weight == pytest.approx(6.2431648 * 9.81, rel=1e-12 if method in CLOSED_FORMS else 1e-8)


def test_one_method_prints_its_own_wrenches(record, unexpecting, capsys):
    assert main(["solve", unexpecting, "--set", "parameters.method=pseudoinverse"]) == 0
    f_z = record["distribution"]["methods"]["pseudoinverse"]["wrenches"][0]["force"][2]
    printed = capsys.readouterr().out
    assert f"{f_z:.4g}] N, moment" in printed and "internal force left_foot - right_foot 0 N" in printed


@pytest.mark.parametrize(
    ("setting", "words"),
    [
        ("parameters.method=psuedoinverse", "parameters.method"),
        ("parameters.references={left_hand=[0,0,1]}", "references names 'left_hand', which is no contact"),
        ("parameters.references={left_foot=[0,0,1,2]}", "a force of 3 or a wrench of 6"),
        ("parameters.cops={left_foot=[0,0,0]}", "parameters.cops"),
        ("parameters.friction_exponent=-1", "parameters.friction_exponent"),
        ("parameters.cop_weight=-1", "parameters.cop_weight"),
    ],
)
def test_wrong_files_are_answered_in_one_sentence(setting, words, capsys):
    assert main(["solve", NAME, "--set", setting]) == 2
    assert words in capsys.readouterr().err.strip().splitlines()[-1]


def test_without_friction_a_valley_holds_and_a_slope_says_what_is_missing(unexpecting, capsys):
    assert main(["solve", unexpecting, "--set", "posture.friction=0"]) == 0
    assert "'left_foot' has 3 of 6 components" in capsys.readouterr().out
    pitched = ["--set", "posture.left=[0.2, 0.1]", "--set", "posture.right=[-0.2, 0.1]"]
    assert main(["solve", unexpecting, "--set", "posture.friction=0", *pitched]) == 0
    told = capsys.readouterr().out
    assert "the load cannot be balanced: the contacts (rank " in told and "status      infeasible" in told


TWO_POINTS = """model = "wrench_distribution"
[posture]
generator = "contacts"
mass = 60.0
com = [0.1, 0.2, 1.0]
[[posture.contacts]]
name = "left"
type = "point"
position = [0, 0.5, 0]
normal = [0, 0, 1]
friction = 0.5
[[posture.contacts]]
name = "right"
type = "point"
position = [0, -0.5, 0]
normal = [0, 0, 1]
friction = 0.5
"""


@pytest.mark.parametrize("method", ["all", "pseudoinverse", "friction_weighted", "barycentric", "qp", "least_squares", "minimax"])
def test_a_load_that_no_wrenches_balance_is_an_answer_with_the_motion(method, tmp_path):
    path, out = tmp_path / "two.toml", tmp_path / "record.json"
    path.write_text(TWO_POINTS)
    assert main(["solve", str(path), "--set", f"parameters.method={method}", "--json", str(out)]) == 0
    record = json.loads(out.read_text())
    assert (record["status"], record["verdict"], record["margin"]) == ("infeasible", "unstable", "-inf")
    assert record["objective"] is None and record["forces"] == record["wrenches"] == []
    motion = record["certificate"]
    velocity = [np.add(motion["linear"], np.cross(motion["angular"], np.subtract((0, y, 0), motion["point"]))) for y in (0.5, -0.5)]
    assert np.abs(velocity).max() < 1e-12, "it turns about the line of the two points"
    fall = np.add(motion["linear"], np.cross(motion["angular"], np.subtract((0.1, 0.2, 1.0), motion["point"])))
    assert motion["power"] == pytest.approx(-60.0 * 9.81 * fall[2]) and motion["power"] > 0
    for name, found in record["distribution"]["methods"].items():
        if name == "statics_consistent":
            assert found["status"] == "unsuitable"
        else:
            assert found["status"] == "infeasible" and "rank 5 of 6) give no moment about y" in found["note"] and "wrenches" not in found


@pytest.mark.parametrize("method", ["all", "pseudoinverse", "qp"])
def test_a_load_outside_the_cones_leaves_what_ignores_them(method, tmp_path):
    path, out = tmp_path / "two.toml", tmp_path / "record.json"
    push = '[[posture.external_wrenches]]\nforce = [0, 500.0, 0]\npoint = [0, 0.2, 1.0]\n'
    path.write_text(TWO_POINTS.replace("com = [0.1", "com = [0.0") + push)
    assert main(["solve", str(path), "--set", f"parameters.method={method}", "--json", str(out)]) == 0
    record = json.loads(out.read_text())
    assert record["verdict"] == "unstable" and record["certificate"]["kind"] == "motion"
    assert record["status"] == ("infeasible" if method == "qp" else "solved")
    for name, found in record["distribution"]["methods"].items():
        if name in PROGRAMS:
            assert found["status"] == "infeasible" and "no forces inside the cones" in found["note"]
        elif name != "statics_consistent":
            total = np.sum([w["force"] for w in found["wrenches"]], axis=0)
            assert np.allclose(total, [0, -500.0, 60 * 9.81]) and not found["inside"]
            used = [use == "inf" or use > 1 for use in found["friction_use"].values()]
            assert any(used) or min(found["normal_force"].values()) < 0


def test_references_that_the_others_cannot_make_up_for_are_infeasible():
    points = [PointContact(name, (0, y, 0), normal=(0, 0, 1), friction=0.5) for name, y in (("a", 0.5), ("b", -0.5))]
    found = ss.distribute(Stance(ContactSet(points), (0, 0, 1), 60), "barycentric", references={"a": [0, 0, 400.0]})
    assert found.status == "infeasible" and "with the references met" in found.note and found.wrenches_W is None


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("cone", ["exact", "inscribed"])
def test_on_every_kind_of_contact_the_best_margin_is_the_reserve_of_its_wrenches(kind, cone):
    stance = stance_of_kind(kind)
    best = ss.check_equilibrium(stance, cone=cone, engine="clarabel")
    if best.forces is None:
        assert best.verdict == "unstable", "only then there are no wrenches to judge"
        return
    W = np.array([[*w["force"], *w["moment"]] for w in best.forces.wrenches()])
    local = np.array([np.kron(np.eye(2), c.rotation.T) @ F for c, F in zip(stance.contacts, W, strict=True)])
    found, W_1 = wrench_reserve(assemble(stance), local, best.cone, "socp", "clarabel"), assemble(stance).units.force
    assert found > 0 if best.margin == np.inf else found == pytest.approx(best.margin, abs=1e-6 * W_1)


@pytest.mark.parametrize("kind", KINDS)
def test_on_every_kind_of_contact_what_suits_balances(kind):
    stance = stance_of_kind(kind)
    compared = ss.compare_distributions(stance, engine=FAST)
    for name, found in compared.methods.items():
        if found.status == "solved":
            assert found.balance < (1e-12 if name in CLOSED_FORMS else 1e-8)
            assert found.holds or name in CLOSED_FORMS
        else:
            assert found.note and (name == "statics_consistent" or not compared.equilibrium.stable)
