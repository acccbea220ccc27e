"""Torque limits: what they are, verdicts and certificates with them, least use of torques."""

import math

import numpy as np
import pytest
from torque_oracles import INF, Linear, braced, check_motion, generate, legs, random_limits

import socp_statics as ss
from socp_statics.exceptions import InputError
from socp_statics.robots import Robot, load_robot


@pytest.fixture(scope="module")
def hoap2():
    return load_robot("hoap2")


@pytest.fixture(scope="module")
def half_squat(hoap2):
    return generate("squat", hoap2)


@pytest.fixture(scope="module")
def deep_squat(hoap2):
    return generate("squat", hoap2, knee=2.0)


def refused(call, name, *words):
    with pytest.raises(InputError) as caught:
        call()
    assert (caught.value.name, caught.value.field) == (name, "torque_limits")
    for word in words:
        assert word in str(caught.value)
    assert "\n" not in str(caught.value)


def with_motors(robot, efforts):
    model = robot.pin_model.copy()
    model.upperEffortLimit = np.r_[np.zeros(6), efforts]
    model.lowerEffortLimit = -np.r_[np.zeros(6), efforts]
    return Robot.from_pinocchio(model, robot.frames, name="motors")


class TestResolve:
    def test_exact_beats_pattern_beats_default(self, half_squat, hoap2):
        limits = half_squat.torque_limits({"default": 7.0, "?LEG_JOINT*": 4.0, "RLEG_JOINT4": [-3.0, 2.0]})
        by_joint = dict(zip(hoap2.joints, limits.tolist(), strict=True))
        assert by_joint.pop("RLEG_JOINT4") == [-3.0, 2.0]
        weaker = {joint for joint, ends in by_joint.items() if ends == [-4.0, 4.0]}
        assert weaker == {joint for joint in hoap2.joints if "LEG" in joint} - {"RLEG_JOINT4"}
        assert all(ends == [-7.0, 7.0] for joint, ends in by_joint.items() if "LEG" not in joint)
        assert limits.shape == (25, 2)

    def test_the_order_of_writing_does_not_matter(self, half_squat):
        given = {"default": 7.0, "?LEG_JOINT*": 4.0, "RLEG_JOINT4": [-3.0, 2.0]}
        back = dict(reversed(given.items()))
        assert half_squat.torque_limits(given) == pytest.approx(half_squat.torque_limits(back), abs=0)

    def test_an_exact_name_settles_two_patterns(self, half_squat):
        patterns = {"default": 9.0, "?LEG_JOINT4": 4.0, "R*_JOINT4": 3.0}
        refused(lambda: half_squat.torque_limits(patterns), "RLEG_JOINT4", "two patterns", "'?LEG_JOINT4'", "'R*_JOINT4'")
        limits = half_squat.torque_limits(patterns | {"RLEG_JOINT4": 2.0})
        by_joint = dict(zip(half_squat.robot.joints, limits[:, 1].tolist(), strict=True))
        assert [by_joint[j] for j in ("RLEG_JOINT4", "LLEG_JOINT4", "RARM_JOINT4", "LARM_JOINT4")] == [2.0, 4.0, 3.0, 9.0]

    def test_the_model_comes_last(self, hoap2):
        robot = with_motors(hoap2, np.arange(1.0, 26.0))
        posture = generate("joint_angles", robot)
        assert robot.torque_limits_real
        assert posture.torque_limits(True) == pytest.approx(np.outer(np.arange(1, 26), [-1, 1]))
        mixed = posture.torque_limits({"BODY_JOINT1": INF, "HEAD*": 0.5})
        assert mixed[:3].tolist() == [[-INF, INF], [-0.5, 0.5], [-0.5, 0.5]]
        assert mixed[3:] == pytest.approx(robot.torque_limits[3:], abs=0)

    def test_placeholders_are_refused_by_name(self, half_squat, hoap2):
        asks = (ss.check_equilibrium, ss.trace_support_region, ss.optimise_contact_forces, ss.minimise_largest_wrench)
        for ask in (*asks, ss.minimise_torque_use):
            refused(lambda ask=ask: ask(half_squat, torque_limits=True), hoap2.joints[0], *hoap2.joints, "placeholders")
        refused(lambda: half_squat.torque_limits({"?LEG*": 4.0, "?ARM*": 4.0}), "BODY_JOINT1", "HEAD_JOINT1", "HEAD_JOINT2")
        some = {"?LEG*": 4.0, "?ARM*": 4.0, "HEAD*": 1.0}
        with pytest.raises(InputError) as caught:
            half_squat.torque_limits(some)
        assert "BODY_JOINT1" in str(caught.value) and "LEG_JOINT" not in str(caught.value)
        half_squat.torque_limits(some | {"BODY_JOINT1": 9.0})

    def test_infinite_counts_as_given(self, half_squat):
        assert np.isinf(half_squat.torque_limits({"default": INF})).all()
        assert half_squat.torque_limits({"default": [-INF, 3.0]})[0].tolist() == [-INF, 3.0]
        free = ss.check_equilibrium(half_squat, torque_limits={"default": INF})
        assert free.margin == pytest.approx(ss.check_equilibrium(half_squat).margin, abs=1e-6)

    def test_unknown_joint(self, half_squat):
        refused(lambda: half_squat.torque_limits({"default": 9.0, "RLEG_JOINT7": 4.0}), "RLEG_JOINT7", "'RLEG_JOINT")
        refused(lambda: half_squat.torque_limits({"default": 9.0, "RKNEE": 4.0}), "RKNEE")

    def test_a_pattern_that_matches_nothing(self, half_squat):
        refused(lambda: half_squat.torque_limits({"default": 9.0, "?KNEE*": 4.0}), "?KNEE*", "matches no joint", "RLEG_JOINT4")
        refused(lambda: half_squat.torque_limits({"default": 9.0, "rleg*": 4.0}), "rleg*", "matches no joint")

    @pytest.mark.parametrize("key", ["default", "?LEG_JOINT*", "RLEG_JOINT4"])
    @pytest.mark.parametrize(
        "value", [[0.5, 2.0], [-2.0, -0.5], [3.0, -3.0], -4.0, math.nan, [math.nan, 1.0], [-1.0], [-1.0, 0.0, 1.0], "strong", None, True]
    )
    def test_wrong_intervals(self, half_squat, key, value):
        refused(lambda: half_squat.torque_limits({"default": 9.0} | {key: value}), key, key)

    def test_they_need_a_robot(self, half_squat):
        refused(lambda: ss.check_equilibrium(half_squat.contacts, (0, 0, 1), 6.0, torque_limits=legs(3.0)), "posture", "robot")
        bare = ss.Stance(half_squat.contacts, half_squat.com_W, half_squat.mass)
        refused(lambda: ss.trace_support_region(bare, torque_limits=legs(3.0)), "posture", "robot")
        refused(lambda: ss.minimise_torque_use(bare), "posture", "robot")
        refused(lambda: ss.minimise_torque_use(half_squat, torque_limits=False), "torque_limits")


class TestVerdict:
    def test_reason(self, hoap2, half_squat):
        assert ss.check_equilibrium(half_squat, torque_limits=legs(2.0)).verdict == "stable"
        weak = ss.check_equilibrium(half_squat, torque_limits=legs(1.0))
        assert (weak.verdict, weak.reason) == ("unstable", "torque")
        assert "LEG_JOINT4" in weak.certificate.reading and "torque limit" in weak.certificate.reading
        assert weak.forces is None and weak.torques is None
        tipping = generate("single_stance", hoap2, lean=0.0)
        for t in (9.0, 1.0):
            answer = ss.check_equilibrium(tipping, torque_limits=legs(t))
            assert (answer.verdict, answer.reason) == ("unstable", None)

    def test_limits_and_torques_are_in_the_answer(self, half_squat):
        answer = ss.check_equilibrium(half_squat, torque_limits=legs(2.0))
        assert answer.torque_limits["LLEG_JOINT1"] == pytest.approx((-2.0, 2.0), abs=1e-12)
        assert answer.torque_limits["BODY_JOINT1"] == (-INF, INF)
        for joint, tau in answer.torques.items():
            lower, upper = answer.torque_limits[joint]
            assert lower - 1e-6 <= tau <= upper + 1e-6
        assert ss.check_equilibrium(half_squat).torque_limits is None

    def test_limits_of_a_stance(self, half_squat):
        stance = half_squat.stance(torque_limits=legs(1.0))
        assert ss.check_equilibrium(stance).reason == "torque"
        assert ss.check_equilibrium(stance, torque_limits=legs(2.0)).stable
        assert ss.minimise_torque_use(stance).objective > 1.0

    def test_random_postures(self, hoap2):
        """Verdict, margin and reason against linear programs, certificates from scratch."""
        rng = np.random.default_rng(30)
        seen = {"stable": 0, "torque": 0, None: 0}
        for _ in range(24):
            posture = braced(hoap2, rng)
            limits = random_limits(hoap2, rng, float(rng.uniform(0.2, 1.5)))
            limited, free = ss.check_equilibrium(posture, torque_limits=limits), ss.check_equilibrium(posture)
            assert limited.margin <= free.margin + 1e-6
            inner, outer = (Linear(posture, kind, 12, limits).margin() for kind in ("inscribed", "circumscribed"))
            if limited.margin == -INF:
                assert inner is None
            elif inner is not None:
                assert inner - 1e-5 <= limited.margin <= outer + 1e-5
            seen[limited.verdict if limited.stable else limited.reason] += 1
            if limited.stable:
                assert limited.reason is None and outer > 0
                continue
            assert limited.reason == ("torque" if free.stable else None)
            check_motion(posture, limits, limited.certificate, rng)
            if limited.reason == "torque":
                assert limited.certificate.joints
        assert min(seen["stable"], seen["torque"]) >= 3, seen

    @pytest.mark.parametrize("kind", ["exact", "inscribed", "circumscribed"])
    @pytest.mark.parametrize(
        "name, numbers, limits",
        [
            ("squat", {"knee": 2.0}, legs(1.0)),
            ("squat", {}, legs(1.2)),
            ("squat", {}, {"default": INF, "RLEG_JOINT4": [-0.2, 9.0], "LLEG_JOINT4": [-0.5, 9.0]}),
            ("standing", {}, {"default": INF, "BODY_JOINT1": 1.0}),
            ("single_stance", {}, {"default": 9.0, "LLEG_JOINT2": [0.0, 1.0], "LLEG_JOINT6": 0.1}),
            ("single_stance", {"lean": 0.0}, legs(0.5)),
        ],
    )
    def test_certificates(self, hoap2, name, numbers, limits, kind):
        posture = generate(name, hoap2, **numbers)
        answer = ss.check_equilibrium(posture, torque_limits=limits, cone=kind)
        assert answer.verdict == "unstable"
        if kind == "exact":
            check_motion(posture, limits, answer.certificate, np.random.default_rng(31))
        assert set(answer.certificate.contacts) == set(posture.support)
        assert answer.certificate.joints or answer.reason is None
        for joint in answer.certificate.joints:
            assert np.isfinite(answer.torque_limits[joint]).any()

    def test_certificate_with_a_load_on_a_link(self, half_squat):
        load = ss.ExternalWrench((-3.0, 1.0, -8.0), (0.1, 0.2, 0.0), (0.05, -0.1, 0.3), link="RARM_LINK4")
        limits = {"default": INF, "RARM_JOINT*": 0.3, "?LEG*": 9.0}
        assert ss.check_equilibrium(half_squat, torque_limits=limits).stable
        answer = ss.check_equilibrium(half_squat, torque_limits=limits, external_wrenches=[load])
        assert answer.reason == "torque"
        assert set(answer.certificate.joints) <= {joint for joint in half_squat.robot.joints if "RARM" in joint}
        check_motion(half_squat, limits, answer.certificate, np.random.default_rng(32), [load])

    @pytest.mark.parametrize(
        "name, numbers, limits",
        [
            ("squat", {}, {"default": 9.0, "?LEG_JOINT*": 0.5717098128109023}),
            ("squat", {}, {"default": 2.25, "?LEG_JOINT*": 0.75}),
            ("squat", {}, {"default": 9.0, "BODY_JOINT1": [-9.0, 0.0]}),
            ("squat", {"knee": 2.0}, {"default": 1.9812484529476297}),
            ("squat", {"knee": 2.0}, {"default": 9.0, "?LEG_JOINT*": 0.4426381918224515}),
        ],
    )
    def test_hard_rows_that_cannot_be_met(self, hoap2, name, numbers, limits):
        posture = generate(name, hoap2, **numbers)
        assert Linear(posture, "circumscribed", 4, limits).margin() is None
        answer = ss.check_equilibrium(posture, torque_limits=limits)
        assert (answer.verdict, answer.reason, answer.margin) == ("unstable", "torque", -INF)
        check_motion(posture, limits, answer.certificate, np.random.default_rng(38))

    def test_margin_grows_with_the_limits(self, half_squat, deep_squat):
        for posture in (half_squat, deep_squat):
            margins = [ss.check_equilibrium(posture, torque_limits=legs(t)).margin for t in (1.0, 1.5, 2.0, 2.5, 3.0, 5.0, 9.0)]
            margins.append(ss.check_equilibrium(posture).margin)
            assert all(a <= b + 1e-6 for a, b in zip(margins, margins[1:], strict=False))
            assert margins[0] < 0 < margins[-1]

    def test_forms_agree(self, half_squat):
        for t in (1.2, 2.0):
            one, two = (ss.check_equilibrium(half_squat, torque_limits=legs(t), form=form) for form in ("socp", "sdp"))
            assert (one.verdict, one.reason) == (two.verdict, two.reason)
            assert one.margin == pytest.approx(two.margin, abs=1e-5)


class TestLeastUse:
    @pytest.mark.parametrize("name, numbers", [("squat", {}), ("squat", {"knee": 2.0}), ("single_stance", {}), ("rolled_feet", {})])
    def test_at_most_one_exactly_where_not_unstable(self, hoap2, name, numbers):
        posture = generate(name, hoap2, **numbers)
        critical = ss.minimise_torque_use(posture, torque_limits=legs(1.0)).objective
        for t in (0.2, 1.0, 2.0, 4.0, 9.0, critical * (1 - 1e-4), critical * (1 + 1e-4)):
            use = ss.minimise_torque_use(posture, torque_limits=legs(t))
            answer = ss.check_equilibrium(posture, torque_limits=legs(t))
            assert use.status == "solved"
            assert (use.objective <= 1.0) == (answer.verdict != "unstable")
            assert answer.reason == (None if use.objective <= 1.0 else "torque")
            assert use.objective == pytest.approx(critical / t, rel=1e-5)
            worst = max(abs(tau) / t for joint, tau in use.torques.items() if "LEG" in joint)
            assert worst == pytest.approx(use.objective, abs=1e-6)

    def test_bracket_by_linear_programs(self, hoap2):
        rng = np.random.default_rng(33)
        solved = 0
        for _ in range(12):
            posture, size = braced(hoap2, rng), float(rng.uniform(0.5, 4.0))
            limits = random_limits(hoap2, rng, size)
            answer = ss.minimise_torque_use(posture, torque_limits=limits)
            inner, outer = (Linear(posture, kind, 16, limits).least_use() for kind in ("inscribed", "circumscribed"))
            if answer.status == "infeasible":
                assert inner is None and answer.objective is None
                assert ss.check_equilibrium(posture).verdict == "unstable"
                continue
            solved += 1
            assert outer - 1e-6 <= answer.objective
            if inner is not None:
                assert answer.objective <= inner + 1e-6
            verdict = ss.check_equilibrium(posture, torque_limits=limits).verdict
            assert (answer.objective <= 1.0) == (verdict != "unstable")
            shares = []
            for joint, tau in answer.torques.items():
                lower, upper = answer.torque_limits[joint]
                shares.append(tau / upper if tau > 0 else tau / lower)
            assert max(shares) == pytest.approx(answer.objective, abs=1e-5)
        assert solved >= 6

    @pytest.mark.parametrize("kind, sides", [("inscribed", 4), ("circumscribed", 4), ("inscribed", 6), ("circumscribed", 5)])
    def test_pyramids_are_the_linear_program(self, hoap2, half_squat, kind, sides):
        rng = np.random.default_rng(34)
        limits = random_limits(hoap2, rng, 2.0)
        for posture in (half_squat, braced(hoap2, rng)):
            answer = ss.minimise_torque_use(posture, torque_limits=limits, cone=kind, sides=sides)
            assert answer.objective == pytest.approx(Linear(posture, kind, sides, limits).least_use(), rel=1e-6)

    def test_it_is_inverse_to_the_scale_of_the_limits(self, half_squat):
        limits = {"default": 9.0, "?LEG_JOINT*": 3.0}
        one = ss.minimise_torque_use(half_squat, torque_limits=limits).objective
        for k in (0.25, 3.0, 40.0):
            scaled = {joint: k * t for joint, t in limits.items()}
            assert ss.minimise_torque_use(half_squat, torque_limits=scaled).objective == pytest.approx(one / k, rel=1e-5)

    def test_zero_limits_are_hard_rows(self, half_squat):
        limits = {"default": INF, "?LEG_JOINT*": 3.0}
        without = ss.minimise_torque_use(half_squat, torque_limits=limits)
        zero = limits | {"LLEG_JOINT4": [-3.0, 0.0], "LLEG_JOINT6": 0.0, "RLEG_JOINT2": [0.0, 3.0]}
        if without.torques["LLEG_JOINT4"] > 0:
            zero["LLEG_JOINT4"] = [0.0, 3.0]
        kept = ss.minimise_torque_use(half_squat, torque_limits=zero)
        assert kept.objective >= without.objective - 1e-7
        assert abs(kept.torques["LLEG_JOINT6"]) < 1e-6 and kept.torques["RLEG_JOINT2"] > -1e-6
        assert kept.objective == pytest.approx(ss.minimise_torque_use(half_squat, torque_limits=zero, form="sdp").objective, rel=1e-5)
        inner, outer = (Linear(half_squat, kind, 16, zero).least_use() for kind in ("inscribed", "circumscribed"))
        assert outer - 1e-6 <= kept.objective <= inner + 1e-6

    def test_a_zero_limit_that_cannot_be_kept(self, half_squat):
        limits = {"default": 9.0, "BODY_JOINT1": 0.0}
        answer = ss.minimise_torque_use(half_squat, torque_limits=limits)
        assert (answer.status, answer.objective, answer.forces) == ("infeasible", None, None)
        assert answer.equilibrium.reason == "torque"
        assert Linear(half_squat, "circumscribed", 4, limits).least_use() is None
        check_motion(half_squat, limits, answer.equilibrium.certificate, np.random.default_rng(35))
        # The waist carries the trunk one way only: a zero on the other side does not matter.
        tau = ss.check_equilibrium(half_squat).torques["BODY_JOINT1"]
        sides = {True: [0.0, 9.0], False: [-9.0, 0.0]}
        assert ss.minimise_torque_use(half_squat, torque_limits=limits | {"BODY_JOINT1": sides[tau > 0]}).objective < 1.0
        wrong = ss.minimise_torque_use(half_squat, torque_limits=limits | {"BODY_JOINT1": sides[tau < 0]})
        assert wrong.status == "infeasible"

    def test_asymmetric_limits(self, half_squat):
        one = ss.minimise_torque_use(half_squat, torque_limits={"default": INF, "?LEG_JOINT4": 3.0})
        signs = {joint: one.torques[joint] > 0 for joint in ("LLEG_JOINT4", "RLEG_JOINT4")}
        assert len(set(signs.values())) == 1
        weak = {joint: [-1.0, 3.0] if up else [-3.0, 1.0] for joint, up in signs.items()}
        strong = {joint: [-9.0, 1.0] if up else [-1.0, 9.0] for joint, up in signs.items()}
        for limits, k in ((weak, 1.0), (strong, 3.0)):
            answer = ss.minimise_torque_use(half_squat, torque_limits={"default": INF} | limits)
            assert answer.objective == pytest.approx(k * one.objective, rel=1e-5)

    def test_no_limits_at_all_use_nothing(self, half_squat):
        assert ss.minimise_torque_use(half_squat, torque_limits={"default": INF}).objective == 0.0

    def test_nothing_balances(self, hoap2):
        answer = ss.minimise_torque_use(generate("single_stance", hoap2, lean=0.0), torque_limits=legs(9.0))
        assert (answer.status, answer.objective) == ("infeasible", None)
        assert answer.equilibrium.verdict == "unstable" and answer.equilibrium.reason is None

    def test_forms_agree(self, hoap2):
        posture = braced(hoap2, np.random.default_rng(34))
        values = [ss.minimise_torque_use(posture, torque_limits={"default": 2.0}, form=form).objective for form in ("socp", "sdp")]
        assert values[0] == pytest.approx(values[1], rel=1e-5)
