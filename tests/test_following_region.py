"""The posture follows the CoM: contacts stay, limits hold, exits are bracketed, and what stops a ray is named."""

import json

import numpy as np
import pinocchio as pin
import pytest
from scipy.optimize import least_squares

import socp_statics as ss
from socp_statics.cases.problem import load_problem
from socp_statics.cli import main
from socp_statics.exceptions import EngineError, InputError
from socp_statics.following import ray as rays_module
from socp_statics.postures import GENERATORS, continuation
from socp_statics.postures.continuation import Continuation

WEAK = {"default": float("inf"), "?LEG_JOINT*": 2.0}
TOLERANCE = 1e-3
PROBLEM = """
model = "following_region"
[posture]
generator = "squat"
robot = "hoap2"
[posture.torque_limits]
default = inf
"?LEG_JOINT*" = 2.0
[parameters]
torque_limits = true
rays = 6
"""


def hoap2_posture(generator, **numbers):
    return GENERATORS.load(generator)(ss.load_robot("hoap2"), **numbers)


@pytest.fixture(scope="module")
def squat():
    return hoap2_posture("squat", knee=1.0)


@pytest.fixture(scope="module")
def free(squat):
    return ss.trace_following_region(squat, rays=12, tolerance=TOLERANCE)


@pytest.fixture(scope="module")
def weak(squat):
    return ss.trace_following_region(squat, rays=12, tolerance=TOLERANCE, torque_limits=WEAK)


@pytest.fixture(scope="module")
def wall():
    """Hands on a wall, four rays: joint limits stop some of them."""
    return ss.solve(load_problem("hoap2/following_hands_on_the_wall"))


def ends_of(region):
    return [end for ray in region.rays for end in (ray.attained, ray.beyond) if end is not None]


def contact_placement(robot, q, name):
    """Placement of a contact frame by Pinocchio alone."""
    data = robot.pin_model.createData()
    pin.framesForwardKinematics(robot.pin_model, data, q)
    frame = robot.frames[name]
    link = data.oMf[robot.pin_model.getFrameId(frame.frame, pin.FrameType.BODY)]
    return link * pin.SE3(np.array(frame.rotation), np.array(frame.position))


class TestPosturesOnTheWay:
    def test_contacts_stay_and_the_centre_of_mass_is_on_the_ray(self, squat, weak):
        robot = squat.robot
        for ray in weak.rays:
            for end in (ray.attained, ray.beyond):
                for name in squat.support:
                    here, there = (contact_placement(robot, q, name) for q in (squat.q, end.posture.q))
                    assert np.abs(pin.log6(here.actInv(there)).vector).max() < 1e-8
                com = pin.centerOfMass(robot.pin_model, robot.pin_model.createData(), np.array(end.posture.q))
                assert com[:2] == pytest.approx(squat.com_W[:2] + end.distance * ray.direction, abs=1e-8)
                assert (end.posture.angles >= robot.lower - 1e-12).all() and (end.posture.angles <= robot.upper + 1e-12).all()

    def test_the_record_alone_says_the_same(self, wall):
        """Every recorded posture, rebuilt from its angles and base: contacts to 1e-8, joint limits, CoM as recorded."""
        robot = ss.load_robot("hoap2")
        contacts = {c["name"]: c for c in wall["case"]["generated"]["contacts"]}
        ends = [wall["following"]["start"]]
        ends += [end for ray in wall["following"]["rays"] for end in (ray, ray["beyond"]) if end]
        for end in ends:
            angles = np.array([end["angles"][joint] for joint in robot.joints])
            assert (angles >= robot.lower - 1e-12).all() and (angles <= robot.upper + 1e-12).all()
            q = robot.configuration(angles, np.array(end["base"]["position"]), np.array(end["base"]["rotation"]))
            for name, contact in contacts.items():
                placed = contact_placement(robot, q, name)
                assert placed.translation == pytest.approx(contact["position"], abs=1e-8)
                if name.endswith("foot"):
                    assert placed.rotation == pytest.approx(np.array(contact["rotation"]), abs=1e-8)
            com = pin.centerOfMass(robot.pin_model, robot.pin_model.createData(), q)
            assert com == pytest.approx(end["position"], abs=1e-8) and end["height"] == end["position"][2]

    def test_each_is_the_nearest_to_the_seed(self, squat, free):
        """As near as what inverse kinematics finds for the same centre of mass from the seed itself."""
        placements = {c.name: (c.position, c.rotation) for c in squat.contacts}
        for ray in free.rays[::3]:
            end = ray.attained
            found = ss.reach(squat.robot, placements, com=end.posture.com_W[:2], reference=squat)
            followed, reached = (
                float(np.linalg.norm(pin.difference(squat.robot.pin_model, np.array(squat.q), np.array(posture.q))))
                for posture in (end.posture, found)
            )
            assert followed <= reached * (1 + 1e-6)

    def test_at_a_height(self, squat):
        region = ss.trace_following_region(squat, rays=3, height=0.235)
        assert region.height == 0.235 and region.start.posture.com_W == pytest.approx([*squat.com_W[:2], 0.235], abs=1e-9)
        for end in ends_of(region):
            assert end.posture.com_W[2] == pytest.approx(0.235, abs=1e-9)
        free = ends_of(ss.trace_following_region(squat, rays=3))
        assert not np.allclose([end.posture.com_W[2] for end in free], squat.com_W[2], atol=1e-5)


class TestExits:
    def test_both_sides_of_every_exit_are_judged_again(self, free, weak):
        for region, limits in ((free, False), (weak, WEAK)):
            for ray in region.rays:
                assert 0.0 < ray.beyond.distance - ray.distance <= TOLERANCE * (1 + 1e-9)
                inside, outside = (
                    ss.check_equilibrium(
                        ss.posture_at(end.posture.robot, end.posture.q, end.posture.support), torque_limits=limits, engine="clarabel"
                    )
                    for end in (ray.attained, ray.beyond)
                )
                assert inside.stable and outside.verdict == "unstable"
                assert inside.margin == pytest.approx(ray.attained.answer.margin, abs=1e-4)
                assert (outside.reason == "torque") == (ray.reason == "torque")

    def test_hands_that_would_leave_the_object_are_refused(self):
        with pytest.raises(ss.InputError, match="hold an object and would leave it"):
            ss.trace_following_region(hoap2_posture("hold_object", mass=1.0), rays=3)

    def test_on_a_flat_floor_without_limits_the_frozen_region_is_the_bound(self, squat, free):
        region = ss.trace_support_region(squat)
        base = ss.base_of_support(squat.contacts)
        for ray in free.rays:
            attained, beyond = (end.posture.com_W[:2] for end in (ray.attained, ray.beyond))
            assert region.contains(attained) and not region.contains(beyond)
            assert base.area == pytest.approx(region.inner_area, rel=1e-6)
            assert ray.reason == "equilibrium" and "tips about" in ray.reading and ray.joints == ()
        assert free.area <= region.outer_area

    def test_torque_limits_only_shrink(self, free, weak):
        assert (weak.distances <= free.distances + TOLERANCE).all() and weak.area < free.area
        assert set(weak.reasons) == {"equilibrium", "torque"}
        for ray in weak.rays:
            if ray.reason == "torque":
                assert ray.joints and all(joint[1:4] == "LEG" for joint in ray.joints) and ray.joints[0] in ray.reading
                assert ss.check_equilibrium(ray.beyond.posture).stable

    def test_knees_give_way_where_all_above_them_turns_harder(self, weak):
        """Leaning back in the plane of symmetry: gravity moments about the knee axes, added up link by link, straddle 2 x 2 N m."""
        ray = weak.rays[6]
        assert ray.direction == pytest.approx([-1, 0]) and set(ray.joints[:2]) == {"LLEG_JOINT4", "RLEG_JOINT4"}
        moments = []
        for end in (ray.attained, ray.beyond):
            model = end.posture.robot.pin_model
            data = model.createData()
            pin.forwardKinematics(model, data, np.array(end.posture.q))
            knees = [model.getJointId(f"{side}LEG_JOINT4") for side in "LR"]
            axis = np.mean([data.oMi[k].translation[0] for k in knees])
            below = {j for k in knees for j in model.subtrees[k]}
            above = [j for j in range(1, model.njoints) if j not in below]
            moments.append(sum(9.81 * model.inertias[j].mass * (axis - (data.oMi[j] * model.inertias[j].lever)[0]) for j in above))
        assert moments[0] <= 4.0 <= moments[1]

    def test_a_mirror_image_gets_the_mirrored_distances(self, free, weak):
        for region in (free, weak):
            k = len(region.rays)
            mirrored = region.distances[(k - np.arange(k)) % k]
            assert region.distances == pytest.approx(mirrored, abs=1e-9)

    def test_engines_agree(self, squat, weak):
        other = ss.trace_following_region(squat, rays=3, torque_limits=WEAK, engine="clarabel")
        assert other.distances == pytest.approx(weak.distances[::4], abs=TOLERANCE)

    def test_rays_that_joint_limits_stop(self, wall):
        """Least squares of another make, from the last posture, do not bring contacts and CoM where the ray would go on."""
        seed = load_problem("hoap2/following_hands_on_the_wall").stance().posture
        follows = Continuation(seed, with_height=False)
        stopped = [ray for ray in wall["following"]["rays"] if ray["reason"] == "joint limit"]
        assert stopped
        for ray in stopped:
            assert ray["beyond"] is None and ray["joints"] and "cannot reach" in ray["reading"] and "at the joint limit" in ray["reading"]
            angles = np.array([ray["angles"][joint] for joint in seed.robot.joints])
            q = seed.robot.configuration(angles, np.array(ray["base"]["position"]), np.array(ray["base"]["rotation"]))
            x = pin.difference(seed.robot.pin_model, np.array(seed.q), q)
            goal = seed.com_W[:2] + ray["stopped_at"] * np.array(ray["direction"])
            asked = follows._reaching
            bounds = (asked.lower - 1e-9, asked.upper + 1e-9)

            def missing(z, goal=goal, asked=asked):
                return asked.residual(z) - np.concatenate([np.zeros(len(asked.residual(z)) - 2), goal])

            best = least_squares(missing, np.clip(x, asked.lower, asked.upper), asked.jacobian, bounds, max_nfev=60)
            assert np.linalg.norm(best.fun) > 1e-5
            near = np.minimum(angles - seed.robot.lower, seed.robot.upper - angles)
            assert min(near[seed.robot.joint_index(joint)] for joint in ray["joints"]) < 0.05

    def test_limbs_that_are_too_short(self, squat):
        """Without joint limits a stretched arm stops the robot, and no joint is named."""
        model = squat.robot.pin_model.copy()
        model.lowerPositionLimit, model.upperPositionLimit = np.full(model.nq, -50.0), np.full(model.nq, 50.0)
        robot = ss.Robot.from_pinocchio(model, squat.robot.frames)
        hand = {f"{side}ARM_JOINT{k}": angle for side in "LR" for k, angle in ((1, 0.05), (4, -0.1))}
        posture = ss.pose(robot, hand, ["left_foot", "right_foot", "left_hand", "right_hand"], friction=5.0)
        region = ss.trace_following_region(posture, rays=3, tolerance=5e-3)
        assert "cannot reach" in region.reasons
        ray = next(ray for ray in region.rays if ray.reason == "cannot reach")
        assert ray.exit and ray.joints == () and ray.beyond is None and "cannot reach: " in ray.reading


class TestFailures:
    def test_a_step_that_fails_is_no_exit(self, squat, monkeypatch):
        real = Continuation.step

        def step(self, here, com):
            return None if com[0] - squat.com_W[0] > 0.02 else real(self, here, com)

        monkeypatch.setattr(Continuation, "step", step)
        region = ss.trace_following_region(squat, rays=4)
        ray = region.rays[0]
        assert ray.reason == "step failure" and not ray.exit and "no exit" in ray.reading and ray.beyond is None
        assert ray.attained.answer.stable and 0.019 < ray.distance < ray.stopped_at
        assert region.reasons == {"equilibrium": 3, "step failure": 1}

    def test_another_start_takes_over_where_the_corrector_fails(self, squat, free, monkeypatch):
        step, resumed, taken = Continuation.step, Continuation.resumed, []

        def failing(self, here, com):
            return None if 0.0149 < com[0] - squat.com_W[0] < 0.0151 and not taken else step(self, here, com)

        def resuming(self, here, com):
            taken.append(com)
            return resumed(self, here, com)

        monkeypatch.setattr(Continuation, "step", failing)
        monkeypatch.setattr(Continuation, "resumed", resuming)
        monkeypatch.setattr(rays_module, "SMALLEST", 10.0)
        region = ss.trace_following_region(squat, rays=3)
        assert len(taken) == 1 and region.distances == pytest.approx(free.distances[::4], abs=TOLERANCE)

    def test_resuming(self, squat):
        follows = Continuation(squat, with_height=False)
        com = squat.com_W[:2] + [0.004, 0.0]
        straight, resumed = follows.step(follows.start, com), follows.resumed(follows.start, com)
        assert resumed.x == pytest.approx(straight.x, abs=1e-6)
        assert follows._found_by_reach(follows.start, com) == pytest.approx(straight.x, abs=1e-4)
        assert follows._found_by_reach(follows.start, (1.0, 0.0)) is None and follows.resumed(follows.start, (1.0, 0.0)) is None

    def test_a_ray_without_end(self, squat, monkeypatch):
        monkeypatch.setattr(rays_module, "MOST_STEPS", 3)
        with pytest.raises(EngineError, match="no exit along the ray"):
            ss.trace_following_region(squat, rays=3)


class TestTheCorrector:
    def test_bounded_steps_are_optimal(self):
        """Balance of gradients, signs of the multipliers of bounds, on random programs."""
        rng = np.random.default_rng(0)
        for _ in range(40):
            n, m = 12, 4
            J, root = rng.standard_normal((m, n)), rng.standard_normal((n, n))
            B, x = np.eye(n) + 0.1 * root @ root.T, rng.uniform(-0.3, 0.3, n)
            lower, upper = np.full(n, -0.4), np.full(n, 0.4)
            r = -J @ (rng.uniform(-0.3, 0.3, n) - x)
            none = np.zeros(n, dtype=bool)
            d, y, low, high = continuation._bounded_step(B, J, x, r, lower, upper, (none, none))
            gradient = x + B @ d - J.T @ y
            assert J @ d == pytest.approx(-r, abs=1e-9)
            assert (x + d >= lower - 1e-9).all() and (x + d <= upper + 1e-9).all()
            assert np.abs(gradient[~(low | high)]).max(initial=0) < 1e-9
            assert (gradient[low] >= -1e-9).all() and (gradient[high] <= 1e-9).all()

    def test_curvature_against_differences_of_the_optimality_conditions(self, squat):
        follows = Continuation(squat, with_height=True)
        here = follows.step(follows.start, squat.com_W + [0.005, 0.003, 0.0])
        B, e = follows._curvature(here.x, here.y), 1e-5

        def gradient(x):
            return x - follows._reaching.jacobian(x).T @ here.y

        for k in (0, 4, 6, 12, 20, 28):
            unit = np.eye(len(here.x))[k]
            assert B[:, k] == pytest.approx((gradient(here.x + e * unit) - gradient(here.x - e * unit)) / (2 * e), abs=1e-4)

    def test_a_saddle_is_no_minimum(self):
        J = np.array([[1.0, 0.0, 0.0]])
        free = np.ones(3, dtype=bool)
        assert continuation._is_minimum(np.diag([-1.0, 1.0, 1.0]), J, free)
        assert not continuation._is_minimum(np.diag([1.0, -1.0, 1.0]), J, free)


class TestRefusals:
    @pytest.mark.parametrize(
        ("keys", "words"),
        [
            ({"rays": 2}, "rays must be a whole number >= 3, got 2"),
            ({"rays": 4.0}, "rays must be a whole number"),
            ({"tolerance": 0.0}, "tolerance must be a length > 0"),
            ({"tolerance": 0.2}, "tolerance must be a length > 0 and <= 0.1"),
            ({"tolerance": float("nan")}, "tolerance"),
            ({"step": 1e-4}, "step must be a length from the tolerance"),
            ({"height": 0.6}, "height: the posture cannot be followed from 0.2412 m to 0.6 m, it ends at 0.2"),
            ({"height": float("inf")}, "height"),
            ({"cone": "square"}, "cone"),
            ({"torque_limits": {"NO_JOINT": 1.0}}, "NO_JOINT"),
            ({"torque_limits": {"default": float("inf"), "?LEG_JOINT4": 1.0}}, "the seed of a following region must be stable.*give way"),
        ],
    )
    def test_wrong_questions(self, squat, keys, words):
        with pytest.raises(InputError, match=words):
            ss.trace_following_region(squat, **keys)

    def test_no_robot(self):
        foot = ss.SurfaceContact("foot", (0, 0, 0), normal=(0, 0, 1), friction=0.6, size=(0.2, 0.1))
        for thing in (ss.ContactSet([foot]), ss.Stance(ss.ContactSet([foot]), (0, 0, 0.5), 10.0)):
            with pytest.raises(InputError, match="a following region needs a robot"):
                ss.trace_following_region(thing)

    @pytest.mark.parametrize(
        ("change", "words"),
        [
            ("parameters.rays=2", "parameters.rays must be a whole number >= 3"),
            ("parameters.tolerance=0.0", "parameters.tolerance must be a length > 0"),
            ("parameters.step=1e-4", "parameters.step"),
            ("parameters.height=low", "parameters.height must be 'free' or a finite height"),
            ("parameters.height=0.6", "parameters.height: height: the posture cannot be followed"),
            ("posture.knee=0.0", "parameters"),
        ],
    )
    def test_on_the_command_line(self, change, words, capsys):
        extra = ["--set", "posture.torque_limits.default=0.01"] if change.startswith("posture") else []
        assert main(["solve", "hoap2/following_half_squat_2", "--set", change, *extra]) == 2
        said = capsys.readouterr().err.strip().splitlines()
        assert len(said) == 1 and (words in said[0] or "seed of a following region" in said[0])

    def test_contacts_alone_on_the_command_line(self, capsys):
        assert main(["solve", "contacts/flat_double_stance", "--set", "model=following_region"]) == 2
        assert "parameters.rays: a following region needs a robot" in capsys.readouterr().err


class TestTheUsersPath:
    def test_record_summary_and_figure(self, tmp_path, capsys):
        record_file, figure_file = tmp_path / "record.json", tmp_path / "figure.svg"
        problem_file = tmp_path / "weak.toml"
        problem_file.write_text(PROBLEM)
        assert main(["solve", str(problem_file), "--json", str(record_file), "--figure", str(figure_file)]) == 0
        said, record = capsys.readouterr().out, json.loads(record_file.read_text())
        following = record["following"]
        assert "following   6 rays" in said and "attained along the rays only, height free" in said and "stopped by" in said
        assert following["height"] == "free" and following["step"] == 5e-3 and "seed posture" in following["objective"]
        assert len(following["rays"]) == len(following["polygon"]) == 6
        assert record["region"]["posture"] == "frozen" and record["verdict"] == "stable" and record["forces"]
        for ray, corner in zip(following["rays"], following["polygon"], strict=True):
            assert corner == pytest.approx(np.array(following["centre"]) + ray["distance"] * np.array(ray["direction"]))
            assert ray["margin"] > 0 and ray["verdict"] == "stable" and ray["beyond"]["verdict"] == "unstable"
            assert ray["beyond"]["certificate"]["kind"] == "motion"
        assert figure_file.stat().st_size > 1000

    def test_figure_says_that_rays_are_rays(self, weak):
        axes = ss.draw(weak)
        words = [text.get_text() for legend in axes.figure.legends for text in legend.get_texts()]
        assert any("along 12 rays only" in word for word in words)
        assert any("stopped by a torque limit" in word for word in words) and any("contacts and load" in word for word in words)
        again = ss.draw(weak, axes)
        assert again is axes
