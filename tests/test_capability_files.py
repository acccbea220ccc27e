"""Capabilities as users ask for them: lines, records, figures, programs shown, and wrong input in files and arguments."""

from __future__ import annotations

import json
import math
from dataclasses import replace

import pytest
from torque_oracles import generate

import socp_statics as ss
from socp_statics.cases.problem import load_problem
from socp_statics.cases.solve import solve
from socp_statics.cli import main
from socp_statics.exceptions import EngineError, InputError
from socp_statics.figures import save_figure
from socp_statics.robots import load_robot

ENGINE = ("clarabel", "cvxpy")


@pytest.fixture(scope="module")
def hoap2():
    return load_robot("hoap2")


def block():
    foot = ss.SurfaceContact("sole", (0, 0, 0), normal=(0, 0, 1), friction=0.5, size=(0.3, 0.2))
    return ss.Stance(ss.ContactSet([foot]), (0, 0, 0.2), 10.0)


def test_lines_record_and_figure(tmp_path, capsys):
    target, figure = tmp_path / "a.json", tmp_path / "a.png"
    assert main(["solve", "hoap2/payload_weak_knees", "--json", str(target), "--figure", str(figure)]) == 0
    said = capsys.readouterr().out
    assert "objective   payload of at most 1.04827 kg at BODY_LINK1 at [-0.06, -0.039, 0.3] m" in said
    assert "beyond it   LLEG_JOINT4 (-2 N m) and RLEG_JOINT4 (-2 N m) give way at the torque limit" in said
    assert "stopped by  LLEG_JOINT4 lower torque limit (+0.944 kg per N m)" in said
    assert "torque      LLEG_JOINT4 -2 N m, 100 % of its limit" in said
    record = json.loads(target.read_text())
    assert record["capability"]["torques"]["LLEG_JOINT4"] == pytest.approx(-2.0)
    assert record["torques"]["LLEG_JOINT4"] == pytest.approx(-1.445, abs=1e-3)  # without the payload
    assert record["prices"]["payload"]["torque_limits"]["LLEG_JOINT4"]["lower"] == pytest.approx(0.944, abs=1e-3)
    assert figure.stat().st_size > 5_000


def test_words_of_a_load_without_end(capsys):
    assert main(["solve", "contacts/push_that_jams"]) == 0
    said = capsys.readouterr().out
    assert "any push along (0.37, 0.00, -0.93) at [0.05, 0, 0.05] m: contact forces can grow with it without end" in said
    assert "stopped by" not in said


def test_figures_of_every_status(tmp_path):
    for name in ("contacts/payload_over_the_sole", "contacts/payload_on_a_slippery_slope", "contacts/payload_on_hooks"):
        problem = load_problem(name)
        save_figure(solve(problem, ENGINE), tmp_path / "a.svg")
        assert (tmp_path / "a.svg").stat().st_size > 3_000


def test_a_program_is_shown(capsys):
    assert main(["show", "hoap2/payload_weak_knees"]) == 0
    said = capsys.readouterr().out
    assert "G x + w P + L = 0" in said and "w >= 0" in said and "- w J_P' d" in said


BLOCK = """\
model = "capability"
[posture]
generator = "contacts"
mass = 10.0
com = [0, 0, 0.2]
[[posture.contacts]]
name = "sole"
type = "surface"
position = [0, 0, 0]
normal = [0, 0, 1]
friction = 0.5
size = [0.3, 0.2]
[parameters]
"""
SQUAT = 'model = "capability"\n[posture]\ngenerator = "squat"\nrobot = "hoap2"\n[posture.torque_limits]\ndefault = 5.0\n[parameters]\n'
BAD = [
    (BLOCK, "", "parameters.payload: exactly one of payload and push is expected, got neither"),
    (BLOCK, "payload = { point = [0, 0, 1] }\npush = { point = [0, 0, 1], direction = [1, 0, 0] }", "got payload and push"),
    (BLOCK, "payload = { }", "parameters.payload.point: is missing"),
    (BLOCK, "push = { point = [0, 0, 1] }", "parameters.push.direction is missing"),
    (BLOCK, "push = { point = [0, 0, 1], direction = [0, 0, 0] }", "parameters.push.direction: a direction that is not zero"),
    (BLOCK, 'payload = { point = [0, 0, 1], link = "hand" }', "parameters.payload.link: a link needs a robot"),
    (BLOCK, "payload = { point = [0, 1] }", "parameters.payload.point must be three finite numbers"),
    (BLOCK, "payload = { point = [0, 0, inf] }", "parameters.payload.point must be three finite numbers"),
    (BLOCK, "payload = { at = [0, 0, 1] }", "parameters.payload.at is not a known key"),
    (BLOCK, "payload = { point = [0, 0, 1] }\ntorque_limits = true", "torque limits need a robot"),
    (BLOCK.replace("mass = 10.0", "mass = -10.0"), "payload = { point = [0, 0, 1] }", "posture.mass must be a finite number > 0"),
    (BLOCK.replace("friction = 0.5", "friction = -0.5"), "payload = { point = [0, 0, 1] }", "friction"),
    (BLOCK.replace("com = [0, 0, 0.2]", "com = [0, 0, 0.2]\ngravity = [0, 0, 0]"), "payload = { point = [0, 0, 1] }", "no weight"),
    (SQUAT, 'payload = { link = "LARM_LINC4" }', "did you mean 'LARM_LINK4'"),
    (SQUAT, 'push = { link = "LARM_LINK4", direction = [0, 0] }', "parameters.push.direction must be three finite numbers"),
]


@pytest.mark.parametrize(("top", "parameters", "sentence"), BAD)
def test_wrong_input_is_one_sentence(top, parameters, sentence, tmp_path, capsys):
    path = tmp_path / "bad.toml"
    path.write_text(top + parameters + "\n")
    assert main(["solve", str(path)]) == 2
    last = capsys.readouterr().err.strip().splitlines()[-1]
    assert sentence in last and "bad.toml" in last and "Traceback" not in last


def test_wrong_arguments_are_refused(hoap2):
    squat = generate("squat", hoap2)
    refused = [
        (lambda: ss.largest_payload(block()), "the point of the payload is missing"),
        (lambda: ss.largest_push(block(), (0, 0, 0), (0, 0, 1)), "direction of a push must not be zero"),
        (lambda: ss.largest_push(block(), (1, 0), (0, 0, 1)), "direction"),
        (lambda: ss.largest_payload(block(), (0, math.nan, 0)), "point"),
        (lambda: ss.largest_payload(block(), (0, 0, 1), link="hand"), "link 'hand' of the payload needs a robot"),
        (lambda: ss.largest_payload(block(), (0, 0, 1), torque_limits=True), "torque_limits need a robot"),
        (lambda: ss.largest_payload(squat, link="HAND"), "link of the payload"),
        (lambda: ss.largest_payload(replace(block(), gravity=(0, 0, 0)), (0, 0, 1)), "no weight without gravity"),
        (lambda: ss.largest_payload(block(), (0, 0, 1), engine="simplex"), "engine 'simplex' is not known"),
    ]
    for ask, sentence in refused:
        with pytest.raises(InputError, match=sentence):
            ask()


def test_a_breakdown_is_not_an_answer(monkeypatch):
    from socp_statics.optimization import capability

    monkeypatch.setattr(capability, "motion_certificate", lambda *_: None)
    with pytest.raises(EngineError, match="the largest push was not settled .*does not check"):
        ss.largest_push(block(), (1, 0, 0), (0, 0, 0.2), engine=ENGINE)
