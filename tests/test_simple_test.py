"""The simple static test: the numbers of its failures, its proofs, and the lines of a record."""

from __future__ import annotations

import json

import numpy as np
import pytest
from random_stances import random_stance

import socp_statics as ss
from socp_statics.cli import main
from socp_statics.exceptions import InputError

SOLE = [(-0.04, -0.0315), (0.058, -0.0315), (0.058, 0.0315), (-0.04, 0.0315)]
MASS = 6.2431648
FLAT = [ss.SurfaceContact(n, (0, y, 0), normal=(0, 0, 1), friction=0.5, vertices=SOLE) for n, y in (("left", 0.039), ("right", -0.039))]
SLOPES = [
    ss.SurfaceContact(n, (0, y, 0), rpy=(r, 0, 0), friction=0.2, size=(0.1, 0.06))
    for n, y, r in (("left", 0.1, np.radians(15)), ("right", -0.1, -np.radians(15)))
]


def friction_used(answer):
    """Largest |f_t| / f_n of the feet on slopes."""
    forces = [foot.rotation.T @ check.force for foot, check in zip(SLOPES, answer.contacts, strict=True)]
    return max(np.hypot(f[0], f[1]) / f[2] for f in forces)


@pytest.mark.parametrize("inverse", ["pseudoinverse", "friction_weighted"])
def test_on_a_flat_floor_the_centres_of_pressure_leave_the_soles_at_half_their_width(inverse):
    holds = [ss.simple_static_test(FLAT, (0.0, y, 0.27), MASS, inverse=inverse).holds for y in (0.0, 0.0310, 0.0320, 0.0390)]
    assert holds == [True, True, False, False]
    failed = ss.simple_static_test(FLAT, (0.0, 0.039, 0.27), MASS, inverse=inverse)
    assert ss.check_equilibrium(FLAT, (0.0, 0.039, 0.27), MASS, engine="clarabel").verdict == "stable"
    assert [check.force[2] for check in failed.contacts] == pytest.approx([30.6, 30.6], abs=0.1)
    assert "left has its centre of pressure 7.3" in failed.reading and "mm outside the contact" in failed.reading
    y = [ss.simple_static_test(FLAT, (0.0, y, 0.27), MASS).holds for y in np.linspace(0.0314, 0.0318, 41)]
    assert 0.0314 + 1e-5 * sum(y) == pytest.approx(0.0315, abs=1e-4)


def test_the_pseudoinverse_depends_on_the_unit_of_length():
    com = (0.0, 0.032, 0.27)
    assert not ss.simple_static_test(FLAT, com, MASS).holds
    assert ss.simple_static_test(FLAT, com, MASS, length=0.05).holds


def test_weights_on_friction_as_printed_make_it_cheap_where_it_is_low():
    """Feet at +-15 deg, mu 0.2: |f_t| / f_n of the pseudoinverse, of weights mu as printed, of 1 / mu and of 1 / mu^2."""
    ask = lambda **k: ss.simple_static_test(SLOPES, (0, 0, 0.27), MASS, **k)  # noqa: E731
    soft = np.tile([True, True, False, False, False, True], 2)
    printed, inverse = ask(weights=np.where(soft, 0.2, 1.0)), ask(weights=np.where(soft, 5.0, 1.0))
    answers = [ask(), printed, inverse, ask(inverse="friction_weighted")]
    assert [friction_used(a) for a in answers] == pytest.approx([0.268, 1.34, 0.054, 0.011], abs=6e-4)
    assert [a.holds for a in answers] == [False, False, True, True]
    assert answers[0].reading.startswith("left slides: needs friction 0.2679, has 0.2")
    assert [a.inverse for a in answers] == ["pseudoinverse", "weighted", "weighted", "friction_weighted"]


@pytest.mark.parametrize("family", ["flat", "sloped", "feet_and_hands", "points", "mix", "loads", "tilted_gravity"])
def test_a_test_that_holds_proves_stability(family):
    for seed in range(8):
        stance = random_stance(seed, family)
        for inverse in ("pseudoinverse", "friction_weighted"):
            for kind in ("exact", "inscribed"):
                answer = ss.simple_static_test(stance, inverse=inverse, cone=kind)
                assert answer.balance < 1e-9 or not answer.holds
                if answer.holds:
                    assert ss.check_equilibrium(stance, engine="clarabel").verdict != "unstable"
                else:
                    assert answer.reading


def test_wrenches_are_those_of_the_pseudoinverse_and_balance_the_load():
    stance = random_stance(1, "feet_and_hands")
    answer = ss.simple_static_test(stance)
    force = sum(check.force for check in answer.contacts)
    assert np.allclose(force, -stance.mass * stance.gravity)
    moment = sum(
        check.moment + np.cross(contact.position - stance.com, check.force)
        for check, contact in zip(answer.contacts, stance.contacts, strict=True)
    )
    assert np.allclose(moment, 0.0, atol=1e-9 * stance.weight)


@pytest.mark.parametrize(
    ("contacts", "com", "reading"),
    [
        ([ss.PointContact("a", (0, 0.1, 0), normal=(0, 0, 1), friction=0.5), FLAT[1]], (0, 0.5, 0.5), "right has its centre of pressure"),
        ([ss.PointContact("toe", (0, 0, 0), normal=(0, 0, 1), friction=0.5)], (0.1, 0, 0.5), "the contacts cannot balance"),
        ([ss.PointContact(f"p{x}", (x, 0, 0), normal=(0, 0, 1), friction=9.0) for x in (-0.1, 0.1)], (0.5, 0, 0.5),
         "would have to pull with"),
        ([FLAT[0], ss.SurfaceContact("low", (0, -0.04, 0), normal=(0, 0, 1), friction=0.5, size=(0.1, 0.06), normal_force=(0, 20))],
         (0, 0, 0.3), "low carries fz = 30.62 N, outside [0, 20]"),
        ([FLAT[0], ss.Handle("bar", (0, 0, 0.5), normal=(0, 0, 1), transmits=["fz"], limits={"fz": (-5, 5)})], (0, 0.04, 0.3),
         "bar carries fz"),
    ],
)  # fmt: skip
def test_failures_are_said_in_words(contacts, com, reading):
    answer = ss.simple_static_test(contacts, com, MASS)
    assert not answer.holds and reading in answer.reading


def test_turning_and_spinning_are_said_in_words():
    twist = [{"moment": (0, 0, 4.0)}]
    assert (
        "left turns about its normal: moment -1.997 N m beside 0.07788 N of friction"
        in ss.simple_static_test(FLAT, (0, 0, 0.27), MASS, external_wrenches=twist).reading
    )
    fingers = [
        ss.SoftFingerContact(f"f{k}", (x, y, 0), normal=(0, 0, 1), friction=0.8, torsional_friction=0.01)
        for k, (x, y) in enumerate([(0.1, 0), (-0.1, 0.1), (-0.1, -0.1)])
    ]
    assert "spins: force and moment" in ss.simple_static_test(fingers, (0, 0, 0.2), MASS, external_wrenches=twist, length=10.0).reading


@pytest.mark.parametrize(
    ("more", "sentence"),
    [
        ({"inverse": "best"}, "inverse must be one of pseudoinverse, friction_weighted, got 'best'"),
        ({"weights": [1.0, 2.0]}, "weights must be 12 numbers"),
        ({"weights": np.zeros(12)}, "weights must be > 0"),
        ({"length": 0.0}, "length must be a finite number > 0"),
        ({"sides": 2, "cone": "inscribed"}, "sides must be a whole number >= 3"),
    ],
)
def test_wrong_input_is_one_sentence(more, sentence):
    with pytest.raises(InputError, match=sentence):
        ss.simple_static_test(FLAT, (0, 0, 0.3), MASS, **more)


def test_the_record_and_the_lines_of_solve(tmp_path, capsys):
    file = tmp_path / "record.json"
    assert main(["solve", "contacts/simple_test_leaning", "--json", str(file)]) == 0
    said = capsys.readouterr().out.splitlines()
    lines = [line for line in said if line.startswith("simple test")]
    assert (
        lines[0].startswith("simple test pseudoinverse fails: left_foot has its centre of pressure 3.4 mm outside")
        or "3.399 mm" in lines[0]
    )
    assert lines[1].startswith("simple test friction-weighted fails")
    record = json.loads(file.read_text())
    test = record["simple_test"]["pseudoinverse"]
    assert (
        record["verdict"] == "stable" and test["holds"] is False and [c["contact"] for c in test["contacts"]] == ["left_foot", "right_foot"]
    )
    assert test["contacts"][0]["moment"][0] / test["contacts"][0]["force"][2] == pytest.approx(0.0349, abs=1e-4)
    assert (
        main(["solve", "contacts/simple_test_leaning", "--set", "parameters.simple_test=false", "--set", "expect={}", "--json", "-"]) == 0
    )
    assert "simple_test" not in json.loads(capsys.readouterr().out)
    assert main(["show", "contacts/simple_test_leaning"]) == 0
    shown = capsys.readouterr().out
    assert "simple_test = true" in shown and "F = C^-W G_C" in shown


def test_a_word_for_simple_test_is_refused(capsys):
    assert main(["solve", "contacts/simple_test_leaning", "--set", "parameters.simple_test=perhaps"]) == 2
    assert capsys.readouterr().err.splitlines()[-1].endswith("parameters.simple_test must be true or false, got 'perhaps'")
