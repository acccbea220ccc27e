"""Proofs in exact arithmetic: the verifier against the cones of the toolkit, verdicts and regions proved, edits refused."""

import copy
import json
import subprocess
import sys
import time
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from sweeps.proofs import prove_all, table, violations

import socp_statics as ss
from socp_statics.cases.named_problems import problem_names
from socp_statics.cases.record import Record
from socp_statics.certificates import verify_proof as verifier
from socp_statics.certificates.exact_elimination import eliminate
from socp_statics.certificates.exact_statement import exact_statement, rationals
from socp_statics.cones import ConeChoice, FrictionCone, FrictionPyramid, SoftFingerCone
from socp_statics.engines import SINGLE

VERIFIER = Path(verifier.__file__)
PYRAMIDS = [("inscribed", 4, 0.3), ("circumscribed", 5), ("inscribed", 3), ("circumscribed", 16)]
CHOICES = [ConeChoice(), *(ConeChoice(*pyramid) for pyramid in PYRAMIDS)]
# All named problems of one robot or none that are solved within a moment; the sweeps and the slow robots are proved by hand.
CHEAP = [name for name in problem_names() if name.split("/")[0] in ("contacts", "degenerate", "push")]
SLOW = {
    f"contacts/{n}" for n in ("pymanoid_triple_stance", "stabilipy_three_points", "staggered_pitched_feet", "staggered_pitched_feet_grippy")
}
OPEN = ("boundary", "rank", "rounding")


def record_of(name, engine=SINGLE):
    problem = ss.load_problem(name)
    return json.loads(ss.solve(problem.case(0) if problem.sweep else problem, engine).to_json())


def contact_of(kind, mu=0.4, gamma=0.05, shape="elliptic"):
    if kind == "soft_finger":
        return ss.SoftFingerContact("c", (0, 0, 0), normal=(0, 0, 1), friction=mu, torsional_friction=gamma, shape=shape)
    return ss.PointContact("c", (0, 0, 0), normal=(0, 0, 1), friction=mu)


@pytest.mark.parametrize("choice", CHOICES, ids=str)
@pytest.mark.parametrize(("kind", "shape"), [("point", "elliptic"), ("soft_finger", "elliptic"), ("soft_finger", "box")])
def test_the_verifier_has_the_same_cones_and_dual_cones(choice, kind, shape):
    rng = np.random.default_rng(0)
    contact = contact_of(kind, shape=shape)
    if kind == "point":
        cone = FrictionCone(0.4) if choice.is_exact else FrictionPyramid(0.4, choice)
    else:
        cone = SoftFingerCone(0.4, 0.05, shape, choice)
    stance = ss.Stance(ss.ContactSet([contact]), (0, 0, 1), 1.0)
    statement = verifier.read_statement(verifier.Place(exact_statement(stance, choice), "statement"))
    F = rng.normal(size=(150, cone.dimension)) * [0.4, 0.4, 1.0, 0.05][: cone.dimension]
    U = rng.normal(size=(150, cone.dimension)) * [1.0, 1.0, 0.5, 10.0][: cone.dimension]
    exact_contact = statement.contacts[0]
    held = [verifier.in_cone(statement, exact_contact, [Fraction(float(v)) for v in f]) for f in F]
    opens = [verifier.in_dual(statement, exact_contact, [Fraction(float(v)) for v in u], Fraction(0)) for u in U]
    assert held == cone.contains(F).tolist() and opens == cone.dual().contains(U).tolist()
    assert 0 < sum(held) < 150 and 0 < sum(opens) < 150


def test_elimination_is_exact_and_says_when_there_is_no_solution():
    rng = np.random.default_rng(3)
    columns = [[Fraction(float(v)) for v in rng.normal(size=6)] for _ in range(6)]
    right = [Fraction(float(v)) for v in rng.normal(size=6)]
    x = eliminate(columns, right)
    assert [sum(c[i] * v for c, v in zip(columns, x, strict=True)) for i in range(6)] == right
    assert eliminate(columns[:5], right) is None
    tiny = [Fraction(0)] * 5 + [Fraction(1, 10**15)]
    assert eliminate([*columns[:5], tiny], right) is not None
    assert eliminate([*columns[:5], tiny], right, 5, 1e-3) is None


def test_floats_are_taken_as_the_rationals_they_are():
    assert rationals([0.1, 3, np.float64(-0.5), np.inf]) == ["3602879701896397/36028797018963968", "3", "-1/2", None]
    assert float(Fraction(rationals(0.1))) == 0.1


def test_a_seeded_part_of_the_sweep_is_proved():
    found = prove_all(90, 10, 20, "clarabel", 1)
    assert len(found) == 90 and violations(found) == []
    assert {p.verdict for p in found if p.group == "near"} == {"stable", "unstable"}
    owed = sum(p.owed for p in found)
    assert owed > 80 and table(found)[-1] == f"{owed} verdicts have to be proved, {owed} are"


def test_a_sweep_that_leaves_a_verdict_open_is_a_violation():
    (one, *_) = prove_all(1, 0, 20, "clarabel", 1)
    assert violations([one._replace(outcome="rounding: why", owed=True)]) == [f"{one.name}: {one.verdict}, rounding: why"]
    assert violations([one._replace(outcome="CONTRADICTION: x", owed=False)])


@pytest.mark.parametrize("name", [name for name in CHEAP if name not in SLOW])
def test_named_problems_are_proved_or_left_open_with_a_reason(name):
    record = record_of(name)
    proof = ss.prove(record, SINGLE)
    assert proof.verdict in (record["verdict"], "undecided")
    if proof.verdict == "undecided":
        assert proof.reason.split(":")[0] in OPEN
    if record["verdict"] == "undecided" and record["reason"]:
        assert proof.reason.startswith(record["reason"])
    assert proof.region == ("proved" if "region" in record else None), proof.region_reason
    if proof.proved or proof.region == "proved":
        said = verifier.verify(json.loads(proof.to_json()))
        assert proof.verdict in said or not proof.proved


def test_every_kind_of_contact_and_load_is_among_them():
    records = [ss.load_problem(name).case(0) for name in CHEAP if name not in SLOW]
    contacts = [c for problem in records if problem.posture["generator"] == "contacts" for c in problem.posture["contacts"]]
    assert {c["type"] for c in contacts} >= {"point", "surface", "line", "soft_finger", "handle"}
    assert any(c.get("normal_force") for c in contacts) and any(c.get("limits") for c in contacts)
    assert {problem.cone.kind for problem in records} == {"exact", "inscribed", "circumscribed"}
    assert any(problem.posture.get("external_wrenches") for problem in records)


@pytest.mark.parametrize("name", ["hoap2/weak_knees", "torque/talos_region", "torque/hoap2_knees"])
def test_torque_limits_are_proved_with_the_jacobians_in_the_file(name):
    record = record_of(name)
    proof = ss.prove(record, SINGLE)
    assert proof.verdict == record["verdict"] and proof.region in (None, "proved")
    assert len(record.get("region", {}).get("outer_joint_rates", [])) == len(record.get("region", {}).get("outer", []))
    joints = proof.document["statement"]["joints"]
    assert joints["names"] and set(joints["jacobians"]) == {c["name"] for c in record["case"]["generated"]["contacts"]}
    edited = copy.deepcopy(proof.document)
    worst = max(record["torques"], key=lambda joint: abs(record["torques"][joint])) if proof.verdict == "stable" else joints["names"][0]
    k = joints["names"].index(worst) if worst in joints["names"] else 0
    edited["statement"]["joints"]["passive"][k] = str(Fraction(joints["passive"][k]) + 10**6)
    with pytest.raises(verifier.Refuted):
        verifier.verify(edited)


def test_idle_contacts_have_no_force_and_decide_nothing():
    record = record_of("contacts/idle_wall")
    proof = ss.prove(record, SINGLE)
    assert record["idle"] == ["wall"] or record["idle"]
    for name in record["idle"]:
        assert all(Fraction(v) == 0 for point in proof.document["forces"][name] for v in point)
    assert proof.verdict == record["verdict"]


def test_a_load_out_of_reach_by_rounding_is_met_with_a_displaced_com():
    turn = np.linalg.qr(np.random.default_rng(4).normal(size=(3, 3)))[0]
    turn *= np.linalg.det(turn)
    places = np.array([[0.3, 0, 0], [-0.4, 0.1, 0.0]])
    points = [ss.PointContact(f"p{k}", turn @ p, rotation=turn, friction=0.5) for k, p in enumerate(places)]
    com = turn @ np.array([0.0, 3 / 70, 0.5])
    stance = ss.Stance(ss.ContactSet(points), com, 7.0, tuple(turn @ np.array([0, 0, -9.81])))
    answer = ss.check_equilibrium(stance, engine="clarabel")
    proof = ss.prove(answer, "clarabel")
    assert answer.verdict == proof.verdict == "stable"
    assert 0.0 < proof.shift <= 1e-12 * stance.contacts.size
    assert "moved by less than 1e-12" in verifier.verify(json.loads(proof.to_json()))
    edited = json.loads(proof.to_json())
    edited["shift"][0] = "1/1000"
    with pytest.raises(verifier.Refuted, match="shift"):
        verifier.verify(edited)


def test_what_no_displacement_mends_is_left_open_by_rank():
    """Frictionless feet on a floor that is level but for the last bits carry no load whose direction is not theirs."""
    feet = [ss.FrictionlessSurfaceContact(n, (0, y, 0), normal=(1e-17, 3e-17, 1), size=(0.2, 0.1)) for n, y in (("a", 0.1), ("b", -0.1))]
    answer = ss.check_equilibrium(feet, (0, 0, 0.5), 10.0, engine="clarabel")
    assert answer.verdict == "stable"
    proof = ss.prove(answer, "clarabel")
    assert proof.verdict == "undecided" and proof.reason.startswith("rank")
    with pytest.raises(verifier.Refuted, match="undecided"):
        verifier.verify(json.loads(proof.to_json()))


def edited(record, path, change):
    out = copy.deepcopy(record)
    *way, last = path
    place = out
    for key in way:
        place = place[key]
    place[last] = change(place[last]) if callable(change) else change
    return out


def dotted(value):
    return ".".join(map(str, value)) if isinstance(value, tuple) else None


RECORDS = {"stable": "contacts/flat_double_stance", "unstable": "contacts/slope_block_slides"}
EDITS = [
    ("stable", ("forces", 2, "force", 2), lambda v: v + 0.01, "forces"),
    ("stable", ("forces", 2, "point", 0), lambda v: v + 1e-5, r"forces\[2\].point"),
    ("stable", ("forces", 0, "contact"), "nobody", "forces"),
    ("stable", ("wrenches", 1, "force", 0), lambda v: v + 0.01, r"wrenches\[1\].force"),
    ("stable", ("verdict",), "unstable", "verdict"),
    ("stable", ("hash",), lambda v: "0" + v[1:] if v[0] != "0" else "1" + v[1:], "hash"),
    ("stable", ("cone", "kind"), "inscribed", "cone"),
    ("stable", ("model",), "equilibrium", "model"),
    ("stable", ("margin",), lambda v: v * 1.001, "margin"),
    ("stable", ("case", "posture", "mass"), 61.0, "hash"),
    ("stable", ("case", "posture", "contacts", 0, "friction"), 0.7, "hash"),
    ("stable", ("case", "generated", "contacts", 1, "friction"), 0.5, r"case.generated.contacts\[1\].friction"),
    ("stable", ("case", "generated", "com", 0), lambda v: v + 1e-6, r"case.generated.com\[0\]"),
    ("stable", ("case", "generated", "contacts", 0, "rotation", 0, 0), 0.99, r"contacts\[0\].rotation\[0\]\[0\]"),
    ("stable", ("region", "inner", 1, 0), lambda v: v - 1e-3, r"region.inner\[1\]"),
    ("stable", ("region", "inner_forces", 0, 0, 2), lambda v: v * 1.01, r"region.inner\[0\]"),
    ("stable", ("region", "outer", 2, 1), lambda v: v * 0.99, r"region.outer"),
    ("stable", ("region", "inner_area"), lambda v: v * 1.001, "region.inner_area"),
    ("stable", ("region", "outer_multipliers", 1), [0.0, 0.0, -1.0, 0.0, 0.0, 0.0], r"region.outer_multipliers\[1\]"),
    ("unstable", ("certificate", "linear", 2), lambda v: v - 0.1, "certificate"),
    ("unstable", ("certificate", "power"), lambda v: 2 * v, "certificate.power"),
    ("unstable", ("verdict",), "stable", "verdict"),
    ("unstable", ("margin",), "-inf", "margin"),
]  # fmt: skip


@pytest.fixture(scope="module")
def records():
    return {kind: record_of(name) for kind, name in RECORDS.items()}


@pytest.mark.parametrize(("kind", "path", "change", "where"), EDITS, ids=dotted)
def test_an_edited_record_fails_and_says_where(records, kind, path, change, where):
    record = edited(records[kind], path, change)
    assert record != records[kind]
    with pytest.raises(ss.StaticsError, match=where) as caught:
        ss.prove(record, SINGLE)
    assert not isinstance(caught.value, ss.InputError)


def test_an_unedited_record_does_not(records):
    for kind, record in records.items():
        assert ss.prove(Record(record), SINGLE).verdict == kind


def test_corners_whose_forces_are_not_accurate_enough_are_solved_for_anew(records):
    record = copy.deepcopy(records["stable"])
    rng = np.random.default_rng(6)
    for corner in record["region"]["inner_forces"]:
        for force in corner:
            force[:] = (np.array(force) + 1e-6 * rng.normal(size=3)).tolist()
    proof = ss.prove(record, SINGLE)
    assert proof.region == "proved"
    size = 2 * np.hypot(0.11, 0.165)
    assert 0.0 < proof.pulled <= 1e-8 * size and proof.pushed <= 1e-8 * size


PROOF_EDITS = [
    ("stable", ("forces", "left_foot", 0, 2), lambda v: str(Fraction(v) + Fraction(1, 10**30)), "forces: .* balance"),
    ("stable", ("statement", "com", 0), lambda v: str(Fraction(v) + Fraction(1, 10**30)), "forces: .* balance"),
    ("stable", ("statement", "mass"), "61", "balance"),
    ("stable", ("statement", "contacts", 0, "position", 1), "0", "balance"),
    ("stable", ("statement", "contacts", 0, "points", 0, 0), "1/5", "balance"),
    ("stable", ("statement", "contacts", 0, "normal_force"), ["0", "1"], "left_foot: the normal force is outside its bounds"),
    ("stable", ("region", "inner", 0, 0), "1/5", r"region.corners\[0\].com"),
    ("stable", ("region", "corners", 1, "com", 0), lambda v: str(Fraction(v) + Fraction(1, 10**15)), r"region.corners\[1\]: .* balance"),
    ("stable", ("region", "outer", 0, 0), "1/20", r"region.outer\[\d\]"),
    ("stable", ("region", "edges", 0, "linear", 2), "-1", r"region.edges\[0\]"),
    ("unstable", ("motion", "linear", 2), "-1", "motion"),
    ("unstable", ("statement", "contacts", 0, "friction"), "2", "motion: forces at .* can prevent"),
    ("unstable", ("statement", "gravity"), ["0", "0", "1"], "motion: load, forces and torques need not"),
]  # fmt: skip


@pytest.mark.parametrize(("kind", "path", "change", "where"), PROOF_EDITS, ids=dotted)
def test_an_edited_proof_is_refuted_and_says_where(records, kind, path, change, where):
    document = json.loads(ss.prove(records[kind], SINGLE).to_json())
    verifier.verify(document)
    with pytest.raises(verifier.Refuted, match=where):
        verifier.verify(edited(document, path, change))


def test_a_pyramid_takes_its_faces_and_its_slope_from_the_file():
    record = record_of("contacts/slope_block_inscribed")
    document = ss.prove(record, SINGLE).document
    cone = document["statement"]["cone"]
    choice = ss.ConeChoice(**record["cone"])
    assert [[float(Fraction(v)) for v in face] for face in cone["faces"]] == choice.face_normals().tolist()
    assert float(Fraction(cone["slope"])) == choice.slope_factor()
    verifier.verify(document)


def test_the_proof_of_eight_points_takes_milliseconds(records):
    stance = ss.load_problem(RECORDS["stable"]).stance()
    answer = ss.check_equilibrium(stance, engine="clarabel")
    ss.prove(answer, "clarabel")
    start = time.process_time()
    for _ in range(5):
        ss.prove(answer, "clarabel")
    # an order of magnitude above what it takes, 10 ms; the sweep reports the time
    assert (time.process_time() - start) / 5 < 0.1


def test_the_verifier_needs_the_standard_library_only(tmp_path, records):
    alone = tmp_path / "verify_proof.py"
    alone.write_text(VERIFIER.read_text())
    proof = tmp_path / "proof.json"
    proof.write_text(ss.prove(records["unstable"], SINGLE).to_json())
    done = subprocess.run([sys.executable, "-I", "-S", str(alone), str(proof)], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (0, f"{proof}: proved unstable\n")
    assert len(VERIFIER.read_text().splitlines()) <= 400
