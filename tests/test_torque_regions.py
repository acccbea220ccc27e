"""With joint torques and their limits: Orin and Oh's program, frozen regions."""

import math

import numpy as np
import pytest
from torque_oracles import INF, Linear, braced, full_jacobian, generalised_gravity, generate, legs

import socp_statics as ss
from socp_statics.exceptions import InputError
from socp_statics.regions import polygon
from socp_statics.robots import load_robot


@pytest.fixture(scope="module")
def hoap2():
    return load_robot("hoap2")


@pytest.fixture(scope="module")
def half_squat(hoap2):
    return generate("squat", hoap2)


@pytest.fixture(scope="module")
def deep_squat(hoap2):
    return generate("squat", hoap2, knee=2.0)


class TestOrinOh:
    @pytest.mark.parametrize("b", [0.0, 0.3, 1.0])
    def test_against_the_linear_program(self, hoap2, half_squat, b):
        rng = np.random.default_rng(36)
        for posture in (half_squat, braced(hoap2, rng)):
            for limits in (False, {"default": INF, "?LEG_JOINT*": 2.5}):
                rates = dict(zip(hoap2.joints, rng.normal(0, 1, 25).tolist(), strict=True))
                rates.pop("LLEG_JOINT3")
                answer = ss.optimise_contact_forces(
                    posture, "orin_oh", rates=rates, b=b, cone="circumscribed", sides=4, torque_limits=limits
                )
                expected = Linear(posture, "circumscribed", 4, limits or None).orin_oh(rates, b)
                if answer.status == "infeasible":
                    assert expected is None
                    continue
                assert answer.objective == pytest.approx(expected, rel=1e-6)
                normal = [e["force"] @ posture.contacts[e["contact"]].normal_W for e in answer.forces.entries()]
                stated = sum(abs(answer.torques[joint] * rate) for joint, rate in rates.items()) + b * max(normal)
                assert stated == pytest.approx(expected, rel=1e-5)

    def test_exact_cones_lie_between(self, hoap2):
        posture = braced(hoap2, np.random.default_rng(34))
        rates = dict.fromkeys(hoap2.joints, 1.0)
        exact = ss.optimise_contact_forces(posture, "orin_oh").objective
        assert Linear(posture, "circumscribed", 16).orin_oh(rates, 1.0) - 1e-6 <= exact
        assert exact <= Linear(posture, "inscribed", 16).orin_oh(rates, 1.0) + 1e-6
        assert ss.optimise_contact_forces(posture, "orin_oh", form="sdp").objective == pytest.approx(exact, rel=1e-5)
        assert ss.optimise_contact_forces(posture, "orin_oh", rates=rates, b=1.0).objective == pytest.approx(exact, rel=1e-6)

    def test_without_a_robot_only_the_largest_normal_force_counts(self, half_squat):
        bare = ss.Stance(half_squat.contacts, half_squat.com_W, half_squat.mass)
        peak = Linear(half_squat, "circumscribed", 4).orin_oh({}, 1.0)
        for b in (1.0, 2.5):
            answer = ss.optimise_contact_forces(bare, "orin_oh", b=b, cone="circumscribed")
            assert answer.objective == pytest.approx(b * peak, rel=1e-6) and answer.torques is None
        assert peak >= half_squat.mass * 9.81 / 8
        largest = ss.minimise_largest_wrench(bare, "normal", level="point", cone="circumscribed")
        assert largest.objective == pytest.approx(peak, rel=1e-6)

    @pytest.mark.parametrize(
        "numbers, field",
        [
            ({"rates": {"RLEG_JOINT7": 1.0}}, "rates"),
            ({"rates": {"RLEG_JOINT4": math.nan}}, "rates"),
            ({"b": -1.0}, "b"),
            ({"objective": "least_squares", "rates": {"RLEG_JOINT4": 1.0}}, "rates"),
            ({"objective": "normal_force", "b": 1.0}, "b"),
        ],
    )
    def test_errors(self, half_squat, numbers, field):
        with pytest.raises(InputError) as caught:
            ss.optimise_contact_forces(half_squat, **{"objective": "orin_oh"} | numbers)
        assert caught.value.field == field

    def test_rates_need_a_robot(self, half_squat):
        bare = ss.Stance(half_squat.contacts, half_squat.com_W, half_squat.mass)
        with pytest.raises(InputError, match="robot"):
            ss.optimise_contact_forces(bare, "orin_oh", rates={"RLEG_JOINT4": 1.0})


# Limit of the leg joints [N m] to area of the region [cm^2].
AREAS = {
    1.0: {9: 138.2, 5: 138.1, 4: 135.6, 3: 128.8, 2.5: 121.3, 2: 99.4, 1.5: 64.2},
    2.0: {9: 138.2, 5: 131.1, 4: 123.5, 3: 101.5, 2.5: 80.0, 2: 55.5, 1.5: 22.4},
}


class TestRegions:
    @pytest.mark.parametrize("knee", AREAS)
    def test_published_areas_are_nested(self, hoap2, knee):
        posture = generate("squat", hoap2, knee=knee)
        larger = ss.trace_support_region(posture)
        assert not larger.frozen and "posture" not in larger.as_record()
        assert larger.inner_area * 1e4 == pytest.approx(138.18, abs=0.01)
        for t, area in AREAS[knee].items():
            region = ss.trace_support_region(posture, tolerance=1e-3, torque_limits=legs(t))
            assert region.kind == "polygon" and region.frozen
            assert region.as_record()["posture"] == "frozen"
            assert region.inner_area * 1e4 == pytest.approx(area, abs=0.2)
            assert region.outer_area * 1e4 == pytest.approx(area, abs=0.2)
            A, b = larger.halfplanes
            assert (region.inner @ A.T <= b + 1e-9).all()
            larger = region

    def test_support_function_by_linear_programs(self, hoap2, half_squat):
        rng = np.random.default_rng(37)
        asymmetric = {"default": INF, "?LEG_JOINT*": 3.0, "RLEG_JOINT4": [-1.0, 2.5], "LLEG_JOINT6": 0.2}
        for limits in (legs(2.0), asymmetric):
            region = ss.trace_support_region(half_squat, tolerance=1e-4, torque_limits=limits)
            inner, outer = (Linear(half_squat, kind, 16, limits) for kind in ("inscribed", "circumscribed"))
            for angle in rng.uniform(0, 2 * np.pi, 6):
                d = np.array([np.cos(angle), np.sin(angle)])
                assert (region.inner @ d).max() <= outer.reach(d) + 1e-8
                assert (region.outer @ d).max() >= inner.reach(d) - 1e-8

    @pytest.mark.parametrize("kind", ["inscribed", "circumscribed"])
    def test_regions_of_pyramids_are_the_linear_program(self, hoap2, kind):
        posture = braced(hoap2, np.random.default_rng(34))
        limits = {"default": INF, "?LEG_JOINT*": 2.5, "?ARM_JOINT*": 0.8}
        region = ss.trace_support_region(posture, tolerance=1e-4, torque_limits=limits, cone=kind, sides=4)
        assert region.kind == "polygon"
        oracle = Linear(posture, kind, 4, limits)
        for angle in np.arange(6) + 0.3:
            d = np.array([np.cos(angle), np.sin(angle)])
            reach = oracle.reach(d)
            assert (region.inner @ d).max() - 1e-7 <= reach <= (region.outer @ d).max() + 1e-7

    def test_corners_are_attained_inside_the_limits(self, half_squat):
        region = ss.trace_support_region(half_squat, torque_limits=legs(2.0))
        weight = half_squat.mass * 9.81
        for corner, forces in zip(region.inner, region.inner_forces, strict=True):
            tau, moment = generalised_gravity(half_squat)[6:], np.zeros(3)
            for entry in forces.entries():
                link = half_squat.robot.frames[entry["contact"]].frame
                tau = tau - (full_jacobian(half_squat, link, entry["point"])[:3].T @ entry["force"])[6:]
                moment += np.cross(entry["point"], entry["force"])
            mine = [k for k, joint in enumerate(half_squat.robot.joints) if "LEG" in joint]
            assert np.abs(tau[mine]).max() <= 2.0 + 1e-6
            assert moment[:2] == pytest.approx([corner[1] * weight, -corner[0] * weight], abs=1e-6)

    def test_the_verdict_agrees_with_the_region(self, half_squat, deep_squat):
        for posture, t in ((half_squat, 1.4), (half_squat, 1.5), (deep_squat, 2.0), (deep_squat, 3.0)):
            region = ss.trace_support_region(posture, torque_limits=legs(t))
            verdict = ss.check_equilibrium(posture, torque_limits=legs(t)).verdict
            assert (region.com_margin is not None and region.com_margin > 0) == (verdict == "stable")

    def test_nothing_left(self, half_squat):
        region = ss.trace_support_region(half_squat, torque_limits={"default": INF, "BODY_JOINT1": 1.0})
        assert region.kind == "empty" and region.frozen and region.com_margin is None

    def test_forms_agree(self, half_squat):
        one, two = (ss.trace_support_region(half_squat, 1e-3, torque_limits=legs(2.0), form=form) for form in ("socp", "sdp"))
        assert one.inner_area == pytest.approx(two.inner_area, rel=2e-3)
        assert polygon.distance(one.outer, two.inner).min() >= -1e-7
