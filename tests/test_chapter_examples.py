"""The examples of Section 3.6.5 against closed forms, virtual work and numbers computed without the toolkit's distributions."""

from itertools import combinations

import numpy as np
import pytest

from socp_statics.cases.problem import load_problem
from socp_statics.cases.solve import solve
from socp_statics.distribution import general_solution
from socp_statics.engines import SINGLE
from socp_statics.report_figures import figure_script
from socp_statics.statics import contact_map

HALF_WEIGHT = 6.2431648 * 9.81 / 2
SLOPE, MU = np.deg2rad(15.0), 0.2
FIVE_LINKS = ("RLEG_JOINT2", "RLEG_JOINT6", "LLEG_JOINT2", "LLEG_JOINT6")


def found(record):
    methods = record["distribution"]["methods"]
    return methods[next(iter(methods))]


def record_of(name, **values):
    problem = load_problem(name)
    return solve(problem.with_values(values, "a test's") if values else problem, SINGLE)


def fifth_order(knots, t):
    """10 s^3 - 15 s^4 + 6 s^5 from knot to knot of (time, value)."""
    for (t0, f0), (t1, f1) in zip(knots, knots[1:], strict=False):
        if t <= t1 + 1e-9:
            s = (t - t0) / (t1 - t0)
            return f0 + (f1 - f0) * (10 * s**3 - 15 * s**4 + 6 * s**5)
    raise AssertionError(t)


@pytest.mark.parametrize(
    ("name", "knots"),
    [
        ("chapter/five_link_sweep", [(0, 0), (1, -5), (3, 5), (4, 0)]),
        (
            "chapter/internal_force_slip",
            [(0, HALF_WEIGHT * np.tan(SLOPE)), (1, HALF_WEIGHT * np.tan(SLOPE)), (3, 0), (4, 0), (6, HALF_WEIGHT * np.tan(SLOPE)),
             (7, HALF_WEIGHT * np.tan(SLOPE))],
        ),
    ],
)  # fmt: skip
def test_sweeps_are_fifth_order_splines(name, knots):
    (values,) = load_problem(name).sweep.values()
    assert len(values) == 10 * knots[-1][0] + 1
    assert np.allclose(values, [fifth_order(knots, 0.1 * k) for k in range(len(values))], atol=1e-6)


def moved(posture, joint, step):
    """How far apart the soles of a robot whose pelvis stays are after one joint moved."""
    import pinocchio

    robot, q = posture.robot, posture.q.copy()
    model, data = robot.pin_model, robot.pin_model.createData()
    q[model.joints[model.getJointId(joint)].idx_q] += step
    pinocchio.forwardKinematics(model, data, q)
    pinocchio.updateFramePlacements(model, data)
    places = []
    for name in ("right_foot", "left_foot"):
        frame = robot.frames[name]
        place = data.oMf[robot.frame_id(frame.frame)]
        places.append(place.translation + place.rotation @ frame.position)
    return float(np.linalg.norm(places[0] - places[1]))


def test_five_link_torques_change_by_the_work_of_the_internal_force():
    problem = load_problem("chapter/five_link_sweep")
    cases = [problem.case(k) for k in (0, 10, 17, 30)]
    records = [solve(case, SINGLE) for case in cases]
    posture = cases[0].stance().posture
    f = np.array([found(r)["internal_forces"][0]["force"] for r in records])
    assert f[[1, 3]] == pytest.approx([-5.0, 5.0])
    for joint in FIVE_LINKS:
        tau = np.array([found(r)["torques"][joint] for r in records])
        # tension pulls the soles together: the motors hold against it with the change of their distance
        slope = (moved(posture, joint, 1e-6) - moved(posture, joint, -1e-6)) / 2e-6
        assert np.allclose(tau - tau[0], slope * (f - f[0]), atol=1e-6)


def test_at_the_height_of_the_ankles_only_the_hips_swing():
    record = record_of("chapter/five_link_at_the_ankles")
    still, torques = found(record_of("chapter/five_link_double_stance"))["torques"], found(record)["torques"]
    assert torques["RLEG_JOINT2"] - still["RLEG_JOINT2"] == pytest.approx(-5 * 0.2 * np.cos(np.deg2rad(5)), abs=3e-4)
    assert torques["RLEG_JOINT6"] == pytest.approx(still["RLEG_JOINT6"], abs=3e-4)


def test_feet_slip_where_the_internal_force_leaves_its_window():
    window = record_of("chapter/internal_force_window")["window"]
    ends = [HALF_WEIGHT * np.tan(SLOPE - np.arctan(MU)), HALF_WEIGHT * np.tan(SLOPE + np.arctan(MU))]
    assert [window["lower"]["value"], window["upper"]["value"]] == pytest.approx(ends, abs=1e-5)
    problem = load_problem("chapter/internal_force_slip")
    (values,) = problem.sweep.values()
    inside = []
    for k in range(18, 53, 2):
        record = solve(problem.case(k), SINGLE)
        assert found(record)["inside"] == (ends[0] < values[k] < ends[1]), values[k]
        use = abs(np.tan(SLOPE - np.arctan(values[k] / HALF_WEIGHT))) / MU
        assert found(record)["friction_use"]["left_foot"] == pytest.approx(use, abs=1e-5)
        inside.append(found(record)["inside"])
    assert inside[0] and not inside[8] and inside[-1]


@pytest.mark.parametrize("name", ["chapter/linkage_feet_and_hand", "chapter/linkage_feet_and_hands"])
def test_internal_forces_along_the_virtual_links_without_the_toolkit(name):
    record = record_of(name)
    place = {c["name"]: np.array(c["position"]) for c in record["case"]["generated"]["contacts"]}
    names = list(place)
    pairs = list(combinations(names, 2))
    V = np.zeros((3 * len(names), len(pairs)))
    for column, (a, b) in enumerate(pairs):
        e = (place[b] - place[a]) / np.linalg.norm(place[b] - place[a])
        V[3 * names.index(a) : 3 * names.index(a) + 3, column] = e
        V[3 * names.index(b) : 3 * names.index(b) + 3, column] = -e
    forces = {w["contact"]: w["force"] for w in record["wrenches"]}
    expected = np.linalg.lstsq(V, np.concatenate([forces[n] for n in names]), rcond=1e-9)[0]
    entries = found(record)["internal_forces"]
    assert [tuple(e["between"]) for e in entries] == pairs
    assert np.allclose([e["force"] for e in entries], expected, atol=1e-6)
    # the hands of one height and the feet lie in one plane: six members, but only five independent ones
    assert np.linalg.matrix_rank(V, tol=1e-6) == (3 if len(names) == 3 else 5)


def test_what_the_hands_press_their_own_loop_holds():
    pressed, loose = (record_of("chapter/two_loops_holding", **{"parameters.method": "barycentric", "posture.squeeze": f, "expect": {}})
                      for f in (5.0, 0.0))  # fmt: skip
    for a, b in zip(found(pressed)["wrenches"], found(loose)["wrenches"], strict=True):
        assert np.allclose(a["force"], b["force"], atol=1e-9) and np.allclose(a["moment"], b["moment"], atol=1e-9)
    change = {joint: found(pressed)["torques"][joint] - tau for joint, tau in found(loose)["torques"].items()}
    assert all(abs(tau) < 1e-9 for joint, tau in change.items() if "LEG" in joint or "BODY" in joint)
    assert max(abs(tau) for joint, tau in change.items() if "ARM" in joint) > 0.3


@pytest.mark.parametrize(("name", "constraints", "rank"), [("chapter/frictionless_floor", 6, 3), ("chapter/right_foot_holds", 9, 6)])
def test_constraints_of_the_feet_and_how_many_of_them_are_internal(name, constraints, rank):
    contacts = load_problem(name).stance().contacts
    C = contact_map(contacts, contacts.centre)
    solution = general_solution(C, np.array([0, 0, 1.0, 0, 0, 0]))
    assert C.shape[1] == constraints and solution.rank == rank and solution.internal == constraints - rank == 3


def test_what_slips_without_internal_force_needs_no_friction_with_it():
    zero, best = record_of("chapter/noncoplanar_zero_internal_force"), record_of("chapter/noncoplanar_optimal_internal_force")
    assert max(found(zero)["friction_use"].values()) * MU == pytest.approx(np.tan(SLOPE), rel=1e-9)
    assert best["objective"] * MU == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize(("name", "axes"), [("moments", (3, 4)), ("yaw", (0, 5))])
def test_sections_of_the_wrench_cone_of_fig_3_1_by_another_program(name, axes, monkeypatch):
    import cvxpy as cp

    script = figure_script("cones_and_wrench_cone")
    monkeypatch.setattr(script, "QUARTER", 5)
    mu, size = 0.5, (0.098, 0.063)
    rest = np.array([0, 0, 1, 0, 0, script._turn(mu, size) if name == "moments" else 0.0])
    corners = 0.5 * np.array([(x, y) for x in (1, -1) for y in (1, -1)]) * size
    for point in script._sections(mu, size)["exact"][name][:5]:
        f, reach = cp.Variable((4, 3)), cp.Variable()
        wrench = [*cp.sum(f, axis=0), corners[:, 1] @ f[:, 2], -corners[:, 0] @ f[:, 2], corners[:, 0] @ f[:, 1] - corners[:, 1] @ f[:, 0]]
        rows = [wrench[k] == rest[k] + (reach * point[axes.index(k)] if k in axes else 0.0) for k in range(6)]
        cp.Problem(cp.Maximize(reach), [cp.norm(f[:, :2], axis=1) <= mu * f[:, 2], *rows]).solve(solver="CLARABEL")
        assert float(reach.value) == pytest.approx(1.0, abs=1e-3)
