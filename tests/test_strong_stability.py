"""Weak and strong stability of one body: the cases of Section 3.7.1, witnesses checked without the toolkit, files and bad input."""

import json

import numpy as np
import pytest

import socp_statics as ss
from socp_statics.cli import main
from socp_statics.contacts import Stance
from socp_statics.stability.contact_modes import OPEN, SLIDE
from socp_statics.stability.mode_search import search_modes
from socp_statics.stability.mode_witness import violation
from socp_statics.stability.one_body import one_body
from socp_statics.stability.projected_forces import settled_by_projection
from socp_statics.stability.sliding_cells import divided_cell, first_cells, friction_rays, polygon_tips, sliding_groups
from socp_statics.statics import assemble

INERTIA, MASS, G = np.diag([4.0, 3.0, 1.0]), 60.0, 9.81


def stance(contacts, com, **more):
    return Stance(ss.ContactSet(contacts), com, MASS, **({"inertia": INERTIA} | more))


def label(*args, **more):
    return ss.check_strong_stability(stance(*args, **more), engine="clarabel")


def block(tilt, mu):
    n = np.array([-np.sin(tilt), 0.0, np.cos(tilt)])
    return stance([ss.SurfaceContact("sole", (0, 0, 0), normal=n, friction=mu, size=(0.3, 0.2))], 0.1 * n)


def feet(roll, mu):
    return [
        ss.SurfaceContact(n, (0, y, 0), rpy=(np.sign(y) * roll, 0, 0), friction=mu, size=(0.22, 0.13)) for n, y in (("l", 0.1), ("r", -0.1))
    ]


def between_walls(mu, inertia=INERTIA):
    sides = (("left", -0.3), ("right", 0.3))
    walls = [ss.SurfaceContact(n, (x, 0, 0), normal=(-np.sign(x), 0, 0), friction=mu, size=(0.2, 0.2)) for n, x in sides]
    return stance(walls, (0, 0, 0), inertia=inertia)


def obeys_the_laws(stance, witness):
    """Equation of motion, cones, complementarity and sliding friction of a witness, from its record alone."""
    record = json.loads(json.dumps(witness.as_record()))
    a, w = np.array(record["linear"]), np.array(record["angular"])
    force, moment = MASS * np.array(stance.gravity), np.zeros(3)
    contact = {c.name: c for c in stance.contacts}
    for entry in record["forces"]:
        c, f, arm = contact[entry["contact"]], np.array(entry["force"]), np.array(entry["point"]) - stance.com
        force, moment = force + f, moment + np.cross(arm, f)
        f_C, a_C = c.rotation.T @ f, c.rotation.T @ (a + np.cross(w, arm))
        slip = np.linalg.norm(a_C[:2])
        assert f_C[2] > -1e-6 and a_C[2] > -1e-8 and abs(f_C[2] * a_C[2]) < 1e-5
        assert np.linalg.norm(f_C[:2]) <= c.friction * f_C[2] + 1e-6
        assert np.linalg.norm(c.friction * f_C[2] * a_C[:2] + f_C[:2] * slip) < 1e-5
    assert force == pytest.approx(MASS * a, abs=1e-6) and moment == pytest.approx(stance.inertia @ w, abs=1e-6)
    assert np.hypot(np.linalg.norm(a), np.linalg.norm(w)) > 1e-3


def test_feet_on_a_floor_are_strong_without_an_inertia():
    answer = label(feet(0.0, 0.6), (0, 0, 0.8), inertia=None)
    assert (answer.strong, answer.by) == ("strong", "frictionless") and "proved" in answer.statement


@pytest.mark.parametrize("roll", [0.35, -0.35])
@pytest.mark.parametrize("mu", [0.05, 1.0])
def test_roof_and_valley_are_strong_at_any_friction(roll, mu):
    assert label(feet(roll, mu), (0, 0, 0.8), inertia=None).by == "frictionless"


@pytest.mark.parametrize(("tilt", "strong"), [(0.3, "strong"), (0.375, "strong"), (0.386, "not_strong"), (0.5, "not_strong")])
def test_a_block_on_a_slope_on_both_sides_of_the_friction_angle(tilt, strong):
    answer = ss.check_strong_stability(block(tilt, 0.4), engine="clarabel")
    assert answer.strong == strong and answer.by == ("contact_modes" if strong == "strong" else "verdict")
    assert answer.equilibrium.stable == (tilt < np.arctan(0.4))


@pytest.mark.parametrize("tilt", [0.4, 0.6])
def test_a_sliding_block_accelerates_as_in_the_textbook(tilt):
    body = one_body(block(tilt, 0.4), assemble(block(tilt, 0.4)))
    found = search_modes(body)
    linear, angular = body.in_si(found.witness.a)
    assert found.outcome == "moves" and (found.witness.mode == SLIDE).all()
    along = -G * (np.sin(tilt) - 0.4 * np.cos(tilt))
    assert linear == pytest.approx([along * np.cos(tilt), 0, along * np.sin(tilt)], abs=1e-8) and angular == pytest.approx(0, abs=1e-7)


@pytest.mark.parametrize("mu", [0.3, 1.0])
def test_between_vertical_walls_is_weak_and_not_strong(mu):
    peg = between_walls(mu)
    answer = ss.check_strong_stability(peg, engine="clarabel")
    assert answer.equilibrium.stable and answer.equilibrium.margin == np.inf and answer.strong == "not_strong" and answer.by == "witness"
    assert answer.witness.linear == pytest.approx([0, 0, -G], abs=1e-6)
    obeys_the_laws(peg, answer.witness)


@pytest.mark.parametrize("mu", [0.3, 1.0])
def test_a_foot_and_a_wall_hand_are_strong(mu):
    hand = ss.PointContact("hand", (0.5, 0, 1.2), normal=(-1, 0, 0), friction=mu)
    foot = ss.SurfaceContact("foot", (0, 0, 0), normal=(0, 0, 1), friction=mu, size=(0.22, 0.13))
    assert label([foot, hand], (0.2, 0, 0.8)).strong == "strong"


def test_a_foot_may_tip_away_from_a_ceiling_that_could_hold_it():
    contacts = [*feet(0.0, 0.6)[:1], ss.PointContact("hand", (0.3, 0.1, 1.8), normal=(0, 0, -1), friction=0.6)]
    braced = stance(contacts, (0.15, 0.1, 0.9))
    answer = ss.check_strong_stability(braced, engine="clarabel")
    assert answer.equilibrium.stable and answer.strong == "not_strong"
    obeys_the_laws(braced, answer.witness)


def test_a_heavier_turning_does_not_change_a_label_that_translation_decides():
    assert ss.check_strong_stability(between_walls(0.5, 10 * INERTIA), engine="clarabel").strong == "not_strong"


def push(variant, mu):
    problem = ss.load_problem(f"push/fig_3_9_{variant}")
    return problem.with_values({f"posture.contacts.{foot}.friction": mu for foot in ("support_foot", "pushing_foot")}).stance()


@pytest.mark.parametrize(("variant", "critical"), [("a", 12.0 / (6.0 * G)), ("b", 0.0183880)])
def test_where_the_pushing_task_stops_being_stable_and_strong(variant, critical):
    below, above = (ss.check_strong_stability(push(variant, mu), engine="clarabel") for mu in (0.99 * critical, 1.05 * critical))
    assert below.equilibrium.verdict == "unstable" and below.strong == "not_strong"
    assert above.equilibrium.verdict == "stable" and above.strong == "strong"


def test_low_friction_makes_the_pushing_task_weak_only():
    weak = ss.load_problem("push/fig_3_9_b_weak_only").stance()
    answer = ss.check_strong_stability(weak, engine="clarabel")
    assert answer.equilibrium.stable and answer.strong == "not_strong" and answer.witness.residual < 1e-9
    assert {answer.witness.contacts[foot] for foot in ("support_foot", "pushing_foot")} == {"slides"}


def test_cells_cover_all_motions_and_halves_are_parts():
    body = one_body(block(0.2, 0.5), assemble(block(0.2, 0.5)))
    (group,) = sliding_groups(body)
    rng, a = np.random.default_rng(0), np.random.default_rng(1).normal(size=6)
    tangential = body.point_rows[group.points, :2] @ a
    assert group.maps @ (group.rows @ a) == pytest.approx(tangential)
    cells = first_cells(group)
    for motion in rng.normal(size=(50, 3)):
        parts = [np.linalg.solve(cell.T, motion) for cell in cells]
        assert max(part.min() for part in parts) >= 0
        (inside,) = [cell for cell, part in zip(cells, parts, strict=True) if part.min() > 0]
        assert sum(np.linalg.solve(half.T, motion).min() > 0 for half in divided_cell(inside)) == 1


def test_rays_contain_the_exact_friction_of_their_cell():
    from scipy.optimize import nnls

    rng, disc = np.random.default_rng(2), polygon_tips(np.arange(8) * np.pi / 4)
    for _ in range(50):
        images = rng.normal(size=(3, 2))
        rays = friction_rays(0.7, images, disc)
        v = rng.uniform(size=3) @ images
        exact = np.append(-0.7 * v / np.linalg.norm(v), 1.0)
        assert nnls(rays.T, exact)[1] < 1e-9


def test_projection_finds_rest_where_there_is_nothing_else():
    body = one_body(block(0.2, 0.5), assemble(block(0.2, 0.5)))
    found = settled_by_projection(body)
    assert np.abs(found.a).max() < 1e-6 and violation(body, found.a, found.x, {}) < 1e-6 and not (found.mode == OPEN).all()


def test_the_inertia_of_a_robot_is_that_of_its_locked_bodies():
    import pinocchio

    robot = ss.load_robot("hoap2")
    posture = ss.pose(robot, {"LLEG_JOINT4": 0.5, "RLEG_JOINT4": 0.5})
    model, data = robot.pin_model, robot.pin_model.createData()
    pinocchio.forwardKinematics(model, data, posture.q)
    total = np.zeros((3, 3))
    for placement, body in zip(data.oMi, model.inertias, strict=True):
        arm = placement.act(body.lever) - posture.com_W
        total += placement.rotation @ body.inertia @ placement.rotation.T + body.mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    assert posture.inertia_W == pytest.approx(total, abs=1e-9)


def test_solve_shows_the_label_and_records_the_witness(capsys, tmp_path):
    assert main(["solve", "push/fig_3_9_b_weak_only", "--json", str(tmp_path / "r.json")]) == 0
    said = capsys.readouterr().out
    assert "weak/strong weakly stable and weakly unstable, not strongly stable" in said
    record = json.loads((tmp_path / "r.json").read_text())
    assert record["strong"] == "not_strong" and record["strong_by"]["by"] == "witness" and len(record["strong_witness"]["linear"]) == 3
    assert main(["solve", "push/fig_3_9_a", "--json", "-"]) == 0
    assert json.loads(capsys.readouterr().out)["strong"] == "strong"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["contacts/foot_and_wall_hand", "--set", "parameters.strong=true"], "inertia is missing"),
        (["push/fig_3_9_a", "--set", "parameters.cone=inscribed"], "cone = 'exact' is expected"),
        (
            ["push/hoap2_a_holds", "--set", "parameters.torque_limits=true", "--set", "parameters.strong=true"],
            "torque_limits = false is expected",
        ),
        (["push/fig_3_9_a", "--set", "parameters.strong=yes"], "parameters.strong"),
    ],
)
def test_bad_input_is_one_sentence(arguments, words, capsys):
    assert main(["solve", *arguments]) == 2
    assert words in capsys.readouterr().err.strip().splitlines()[-1]


def test_soft_fingers_are_left_undecided():
    finger = [
        ss.SoftFingerContact(f"f{x}", (x, 0, 0), normal=(-np.sign(x), 0, 0), friction=0.8, torsional_friction=0.02) for x in (-0.1, 0.1)
    ]
    assert label(finger, (0, 0, 0), inertia=None).by in ("soft_finger", "verdict")


def test_torque_limits_are_refused():
    posture = ss.pose(ss.load_robot("hoap2"), {})
    with pytest.raises(ss.InputError, match="torque_limits = false"):
        ss.check_strong_stability(posture.stance(torque_limits={"default": 5.0}))


def test_limited_handles_and_bounded_soles_are_gone_through():
    n = (-np.sin(0.2), 0.0, np.cos(0.2))
    foot = ss.SurfaceContact("foot", (0, 0, 0), normal=n, friction=0.5, size=(0.22, 0.13), normal_force=[0, 560])
    grip = ss.Handle("grip", (0.3, 0, 1.2), normal=(0, 0, 1), transmits=["fx", "fz"], limits={"fx": [-100, 100], "fz": [-50, 50]})
    answer = label([foot, grip], (0.05, 0, 0.8))
    assert (answer.strong, answer.by) == ("strong", "contact_modes")
