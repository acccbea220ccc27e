"""Certificates: motions in words and in watts on planted cases, and forces that break their promises."""

from __future__ import annotations

import numpy as np
import pytest
from rechecks import motion_power

from socp_statics.certificates import ForcesCertificate, force_residuals, motion_of
from socp_statics.certificates import motion_certificate as certificate_of_motion
from socp_statics.cones.choice import ConeChoice
from socp_statics.contacts import (
    ContactSet,
    ExternalWrench,
    FrictionlessPointContact,
    FrictionlessSurfaceContact,
    Handle,
    LineContact,
    PointContact,
    SoftFingerContact,
    Stance,
    SurfaceContact,
)
from socp_statics.stability import check_equilibrium
from socp_statics.statics import assemble

UP = (0.0, 0.0, 1.0)
EXACT = ConeChoice()
CHOICES = (EXACT, ConeChoice("inscribed", 5, 0.2), ConeChoice("circumscribed", 4))
SIZE = (0.22, 0.13)


def motion_certificate(data, cone, twist):
    """The certificate of a rigid motion of the whole robot."""
    return certificate_of_motion(data, cone, motion_of(data, twist))



def stance_of(contacts, com, mass=60.0, **more):
    return Stance(ContactSet(contacts), com, mass, **more)


def foot(name="foot", p=(0, 0, 0), mu=0.6, normal=UP, **more):
    return SurfaceContact(name, p, normal=normal, friction=mu, size=SIZE, **more)


def slope(degrees, mu):
    a = np.radians(degrees)
    return foot("sole", mu=mu, normal=(np.sin(a), 0, np.cos(a)))


def feet(com):
    return stance_of([foot("left", (0, 0.1, 0)), foot("right", (0, -0.1, 0))], com)


def walls(mu, tilt=0.0):
    """Two walls that face each other."""
    return [SurfaceContact("left_wall", [0, 0.4, 1], normal=(0, -1, tilt), friction=mu, size=[0.2, 0.1]),
            SurfaceContact("right_wall", [0, -0.4, 1], normal=(0, 1, tilt), friction=mu, size=[0.2, 0.1])]  # fmt: skip


def two_points(p=(0.3, 0, 0), q=(-0.3, 0, 0)):
    return [PointContact("toe", p, normal=UP, friction=0.7), PointContact("heel", q, normal=UP, friction=0.7)]


RAIL = Handle("rail", [0, 0, 1], normal=UP, transmits=["fx", "fy", "fz", "mx", "my", "mz"], limits={"fz": (-100, 100)})
BAR = Handle("bar", [0, 0, 1], normal=UP, transmits=["fx", "fy", "fz", "mx", "my"])

WALL_FOOT = PointContact("wall_foot", [0, 0, 0], normal=(1, 0, 0), friction=0.2)
TOE_ON_ICE = FrictionlessPointContact("toe", [0, 0, 0], normal=(1, 0, 0))


def hooks(transmits):
    """Two hands on a wall, the normal of their frames towards the robot."""
    return [Handle(f"{side}_hand", [0, y, 1.8], normal=(1, 0, 0), transmits=transmits) for side, y in (("left", 0.3), ("right", -0.3))]


# Stance, the words for each contact (None: whatever), and words that the sentence must and must not have.
READINGS = {
    "right edge": (feet((0.0, -0.3, 0.8)), {"left": "opens", "right": "holds"}, ["tips about the right edge of right"], ["slides"]),
    "left edge": (feet((0.0, 0.3, 0.8)), {"left": "holds", "right": "opens"}, ["tips about the left edge of left"], ["slides"]),
    "front edges": (feet((0.3, 0.0, 0.8)), {"left": "holds", "right": "holds"},
                    ["tips about the front edge of left and the front edge of right"], ["slides", "opens"]),
    "back edges": (feet((-0.3, 0.0, 0.8)), {"left": "holds", "right": "holds"},
                   ["tips about the back edge of left and the back edge of right"], ["slides", "opens"]),
    "corner": (stance_of([PointContact("pole", [-0.3, -0.3, 0], normal=UP, friction=0.9), foot()], (0.15, -0.15, 0.8)), None,
               ["tips about the front right corner of foot and pole"], ["slides"]),
    "downhill": (stance_of([slope(30, 0.3)], (0.0, 0.0, 0.1)), {"sole": "slides"},
                 ["slides along (0.87, 0.00, -0.50) at sole"], ["tips", "opens"]),
    "two soles downhill": (stance_of([foot("left", (0, 0.1, 0), 0.2, (0, -0.5, 1)), foot("right", (0, -0.1, 0.05), 0.2, (0, -0.5, 1))],
                                     (0, 0, 0.2)), {"left": "slides", "right": "slides"},
                           ["slides along (0.00, -0.89, -0.45) at left and right"], ["tips"]),
    "pushed along the floor": (stance_of([foot()], (0, 0, 0.05), 10.0,
                                         external_wrenches=(ExternalWrench(force=(80, 0, 0), point=(0, 0, 0)),)),
                               {"foot": "slides"}, ["slides along +x at foot"], ["tips", "opens"]),
    "ceiling": (stance_of([foot("ceiling", (0, 0, 2), normal=(0, 0, -1))], (0, 0, 1.0)), {"ceiling": "opens"},
                ["falls along -z", "ceiling opens"], ["slides", "tips"]),
    "between walls": (stance_of(walls(0.0), (0, 0, 1.0)), {"left_wall": "slides", "right_wall": "slides"},
                      ["falls between left_wall and right_wall"], ["tips", "open"]),
    "between walls with friction": (stance_of(walls(0.01, -0.01), (0, 0, 1.0)), {"left_wall": "slides", "right_wall": "slides"},
                                    ["falls between left_wall and right_wall"], ["tips", "open"]),
    "between walls that lean away": (stance_of(walls(0.05, -0.1), (0, 0, 1.0)), {"left_wall": "opens", "right_wall": "opens"},
                                     ["falls along -z", "left_wall and right_wall open"], ["tips", "slides"]),
    "two points": (stance_of(two_points(), (0.0, 0.1, 0.5)), {"toe": "holds", "heel": "holds"},
                   ["turns about the line through toe and heel", "cannot resist"], ["slides", "opens"]),
    "line": (stance_of([LineContact("edge", [0, 0, 0], normal=UP, friction=0.5, size=[0.4])], (0.0, 0.1, 0.5)), {"edge": "holds"},
             ["turns about edge", "cannot resist"], []),
    "end of a line": (stance_of([LineContact("edge", [0, 0, 0], normal=UP, friction=0.5, size=[0.4])], (0.3, 0, 0.5)), {"edge": "holds"},
                      ["tips about the front end of edge"], ["slides"]),
    "spins": (stance_of([SoftFingerContact("finger", [0, 0, 0], normal=UP, friction=0.5, torsional_friction=0.01)], (0, 0, 0.3), 10.0,
                        external_wrenches=(ExternalWrench(moment=(0, 0, 3)),)), {"finger": "slides"},
              ["spins about the normal at finger"], []),
    "handle too weak": (stance_of([RAIL], (0, 0, 0.5)), {"rail": "slides"}, ["slides along -z at rail"], []),
    "handle turns": (stance_of([BAR], (0, 0, 0.5), 10.0, external_wrenches=(ExternalWrench(moment=(0, 0, -3)),)), {"bar": "holds"},
                     ["turns about bar", "cannot resist"], []),
    "frictionless slope": (stance_of([FrictionlessSurfaceContact("ice", [0, 0, 0], normal=(0.3, 0, 1), size=SIZE)], (0, 0, 0.05)),
                           {"ice": "slides"}, ["slides along (0.96, 0.00, -0.29) at ice"], []),
    "bound too low": (stance_of([foot(normal_force=[0, 300])], (0, 0, 0.5)), None, ["foot"], ["opens"]),
    "wall plate": (stance_of([SurfaceContact("plate", [1, 0, 1], normal=(-1, 0, 0), friction=0.8, size=[0.1, 0.2])], (0.9, 0, 1.0), 1.0,
                   external_wrenches=(ExternalWrench(force=(200, 0, 0), point=(0.9, 0, 1.3)),)), {"plate": "holds"},
                   ["tips about the upper edge of plate"], ["slides"]),
    "hooks that let go downwards": (stance_of([*hooks(("fx", "fz")), WALL_FOOT], (0.3, 0, 1.0)),
                                    {"left_hand": "slides", "right_hand": "slides", "wall_foot": "slides"},
                                    ["slides freely along -z at left_hand and right_hand", "slides along -z at wall_foot"],
                                    ["tips", "turns", "line through", "falls between"]),
    "hooks that hold": (stance_of([*hooks(("fx", "fy", "fz")), TOE_ON_ICE], (0.3, 0, 1.0), 10.0,
                                  external_wrenches=(ExternalWrench(force=(200, 0, 0), point=(0.3, 0, 1.0)),)),
                        {"left_hand": "holds", "right_hand": "holds", "toe": "opens"},
                        ["tips about the line through left_hand and right_hand", "toe opens"], ["slides"]),
    "prop opens": (stance_of([foot(), FrictionlessPointContact("prop", [0.5, 0, 0.5], normal=(-1, 0, 0))], (-0.3, 0, 0.8)),
                   {"foot": "holds", "prop": "opens"}, ["tips about the back edge of foot", "prop opens"], []),
}  # fmt: skip


@pytest.mark.parametrize("case", READINGS)
def test_the_reading_names_what_happens(case):
    stance, words, present, absent = READINGS[case]
    answer = check_equilibrium(stance)
    assert answer.verdict == "unstable"
    assert answer.forces is None
    certificate = answer.certificate
    assert set(certificate.contacts) == set(stance.contacts.names)
    assert set(certificate.contacts.values()) <= {"holds", "slides", "opens"}
    if words is not None:
        assert certificate.contacts == words
    for word in present:
        assert word in certificate.reading
    for word in absent:
        assert word not in certificate.reading


@pytest.mark.parametrize("choice", CHOICES, ids=lambda c: c.kind)
@pytest.mark.parametrize("case", READINGS)
def test_power_equals_an_independent_count(case, choice):
    stance = READINGS[case][0]
    answer = check_equilibrium(stance, cone=choice)
    if answer.verdict != "unstable":
        assert choice.kind == "circumscribed"
        return
    power, violation = motion_power(stance, answer.certificate, choice)
    assert power > 0
    assert answer.certificate.power == pytest.approx(power, rel=1e-9)
    assert violation <= 1e-7


def admissible_power(stance, certificate, rng):
    """Power of the load and of random admissible forces on a certificate's motion [W], exact cones."""

    def velocity(p):
        return certificate.linear + np.cross(certificate.angular, np.asarray(p) - certificate.point)

    w = certificate.angular
    power = stance.mass * stance.gravity @ velocity(stance.com)
    for load in stance.external_wrenches:
        power += load.moment @ w + (0.0 if load.point is None else load.force @ velocity(load.point))
    for c in stance.contacts:
        if not c.unilateral:
            for word in c.transmits:
                lo, hi = np.clip(c.limits.get(word, (-np.inf, np.inf)), -1e4, 1e4)
                axis = c.rotation[:, "xyz".index(word[1])]
                power += rng.uniform(lo, hi) * axis @ (velocity(c.position) if word[0] == "f" else w)
            continue
        lo, hi = (0.0, 1e4) if c.normal_force is None else np.clip(c.normal_force, 0, 1e4)
        share = rng.dirichlet(np.full(len(c.points_W), 0.3)) * rng.uniform(lo, hi)
        for p, f_n in zip(c.points_W, share, strict=True):
            angle, use = rng.uniform(0, 2 * np.pi), rng.choice([0.5, 1.0])
            spin = rng.choice([-1.0, 0.0, 1.0]) if c.type == "soft_finger" else 0.0
            slip = use * c.friction * (np.sqrt(1 - spin**2))
            force = c.rotation @ (f_n * np.array([slip * np.cos(angle), slip * np.sin(angle), 1.0]))
            power += force @ velocity(p)
            if spin:
                power += spin * c.torsional_friction * f_n * c.rotation[:, 2] @ w
    return power


@pytest.mark.parametrize("case", READINGS)
def test_no_admissible_force_prevents_the_motion(case):
    stance = READINGS[case][0]
    certificate = check_equilibrium(stance).certificate
    rng = np.random.default_rng(3)
    assert min(admissible_power(stance, certificate, rng) for _ in range(300)) >= certificate.power * (1 - 1e-6) - 1e-6


def test_what_holds_does_not_move_whatever_the_handles_transmit():
    """A sentence names an axis through contacts that hold, so their points must be at rest."""
    seen = {"holds": 0, "slides": 0}
    for seed in range(40):
        rng = np.random.default_rng(seed)
        some = [tuple(w for w in ("fx", "fy", "fz") if rng.random() < 0.7) or ("fz",) for _ in range(2)]
        hands = [Handle(f"hand{k}", rng.uniform(-1, 1, 3), normal=rng.normal(size=3), transmits=some[k]) for k in range(2)]
        toe = PointContact("toe", [0, 0, 0], normal=rng.normal(size=3), friction=0.5)
        stance = stance_of([*hands, toe], rng.uniform(-0.5, 0.5, 3))
        answer = check_equilibrium(stance)
        if answer.verdict != "unstable":
            continue
        certificate = answer.certificate
        at = np.array([*(c.position for c in stance.contacts), stance.com])
        speed = np.linalg.norm(certificate.linear + np.cross(certificate.angular, at - certificate.point), axis=1)
        for k, (name, word) in enumerate(certificate.contacts.items()):
            assert (speed[k] <= 2e-3 * speed.max()) == (word == "holds"), (seed, name)
            if name != "toe":
                seen[word] += 1
    assert min(seen.values()) >= 5


def test_a_certificate_is_scaled_and_can_be_recorded():
    stance = READINGS["front edges"][0]
    data = assemble(stance)
    answer = check_equilibrium(stance)
    record = answer.certificate.as_record()
    assert record["kind"] == "motion" and record["joints"] == {}
    assert set(record) == {"kind", "linear", "angular", "point", "joints", "power", "reading", "contacts"}
    size = data.units.length
    assert max(np.linalg.norm(record["linear"]), size * np.linalg.norm(record["angular"])) == pytest.approx(1.0)
    np.testing.assert_allclose(record["point"], stance.contacts.centre)
    twist = np.array([*record["linear"], *(size * np.array(record["angular"]))])
    again = motion_certificate(data, EXACT, 7.0 * twist)
    assert again.power == pytest.approx(record["power"])
    assert again.reading == record["reading"]


def test_forces_certify_a_stable_stance():
    answer = check_equilibrium(feet((0, 0, 0.8)))
    assert answer.certificate == ForcesCertificate()
    assert answer.certificate.as_record() == {"kind": "forces"}


def test_printed_certificates_say_what_they_certify():
    forces = repr(check_equilibrium(feet((0.0, 0.0, 0.8))).certificate)
    assert "forces that balance the load to" in forces and "keep every cone, bound and limit" in forces
    assert "are within 1.0e-09 of it of every cone" in repr(ForcesCertificate(1e-12, 1e-9))
    certificate = check_equilibrium(feet((0.3, 0.0, 0.8))).certificate
    assert certificate.reading in repr(certificate) and f"{certificate.power:.4g} W" in repr(certificate)


def test_power_of_a_tipping_robot_is_the_weight_times_its_fall():
    answer = check_equilibrium(stance_of([foot()], (0.31, 0.0, 0.5)))
    c = answer.certificate
    v_com = c.linear + np.cross(c.angular, np.array([0.31, 0, 0.5]) - c.point)
    assert v_com[2] == pytest.approx(-0.2 * c.angular[1])
    assert c.power == pytest.approx(60 * 9.81 * 0.2 * c.angular[1])


def test_power_counts_what_a_limited_handle_and_a_bounded_contact_can_still_do():
    handle = check_equilibrium(READINGS["handle too weak"][0]).certificate
    assert handle.power == pytest.approx(60 * 9.81 - 100)
    bounded = check_equilibrium(READINGS["bound too low"][0]).certificate
    assert bounded.power == pytest.approx(60 * 9.81 - 300)


ON_A_FLOOR = stance_of([foot()], (0.0, 0.0, 0.5))
TWISTS = {
    "nothing": np.zeros(6),
    "not a number": np.full(6, np.nan),
    "infinite": np.full(6, np.inf),
    "into the floor": np.array([0, 0, -1.0, 0, 0, 0]),
    "sliding on the floor without weight doing work": np.array([1.0, 0, 0, 0, 0, 0]),
    "lifting off against the weight": np.array([0, 0, 1.0, 0, 0, 0]),
    "tipping over an edge inside of which the weight is": np.array([0, 0, 0.11 / np.hypot(*SIZE), 0, 1.0, 0]),
    "turning on the spot": np.array([0, 0, 0, 0, 0, 1.0]),
}


@pytest.mark.parametrize("motion", TWISTS)
def test_a_motion_that_forces_can_prevent_is_no_certificate(motion):
    assert motion_certificate(assemble(ON_A_FLOOR), EXACT, TWISTS[motion]) is None


def test_a_pyramid_with_an_odd_number_of_sides_resists_by_the_side_that_pushes_back():
    # Towards -x, against a motion along +x, the triangle reaches mu = 0.5; towards +x only half of it.
    triangle = ConeChoice("inscribed", 3, 0.0)
    held = stance_of([SurfaceContact("sole", [0, 0, 0], normal=UP, friction=0.5, size=[2, 1])], (0, 0, 0.1), gravity=(3.0, 0, -9.81))
    assert check_equilibrium(held, cone=triangle).verdict == "stable"
    for rise, wanted in ((0.26, False), (0.51, True)):
        steep = stance_of(held.contacts, (0, 0, 0.1), gravity=(6.0, 0, -9.81))
        found = motion_certificate(assemble(steep), triangle, np.array([1.0, 0, rise, 0, 0, 0]))
        assert (found is not None) == wanted


def test_sliding_downhill_is_prevented_by_enough_friction_only():
    for mu, wanted in ((0.3, True), (0.7, False)):
        a = np.radians(30)
        lift = 0.31 * np.array([np.sin(a), 0, np.cos(a)])
        twist = np.append(np.array([np.cos(a), 0, -np.sin(a)]) + lift, np.zeros(3))
        found = motion_certificate(assemble(stance_of([slope(30, mu)], (0, 0, 0.1))), EXACT, twist)
        assert (found is not None) == wanted


def test_an_unlimited_handle_prevents_every_motion_it_transmits():
    stance = stance_of([BAR], (0, 0, 0.5))
    for k in range(5):
        twist = np.zeros(6)
        twist[k] = -1.0
        assert motion_certificate(assemble(stance), EXACT, twist) is None


# Forces that break their promises, by how much, in units of W.

EVERYTHING = stance_of(
    [
        PointContact("point", [0, 0, 0], normal=UP, friction=0.5),
        SoftFingerContact("box", [1, 0, 0], normal=UP, friction=0.5, torsional_friction=0.2, shape="box"),
        SoftFingerContact("elliptic", [0, 1, 0], normal=UP, friction=0.5, torsional_friction=0.1),
        FrictionlessPointContact("ice", [1, 1, 0], normal=UP, normal_force=[0.2 * 588.6, 0.4 * 588.6]),
        Handle("bar", [0, 0, 1], normal=UP, transmits=["fx", "mz"], limits={"fx": (-58.86, 29.43)}),
    ],
    (0.5, 0.5, 1.0),
)
SQUARE = ConeChoice("inscribed", 4)
OUTSIDE = ConeChoice("circumscribed", 4)
# x = (f_t of point, box, elliptic; f_n of point, box, elliptic, ice; m_n of box, elliptic; fx, mz)
PLANTED = {
    "clean": (EXACT, {}, 0.0),
    "pulls": (EXACT, {6: -0.3}, 0.3),
    "ice pulls": (EXACT, {9: -0.1}, 0.3),
    "slips": (EXACT, {0: 0.3, 1: 0.4, 6: 0.6}, 0.2),
    "slips a pyramid": (SQUARE, {0: 0.3, 1: 0.4, 6: 0.6}, 0.4 - 0.3 * np.sqrt(0.5)),
    "inside a pyramid": (OUTSIDE, {0: 0.3, 1: 0.3, 6: 0.6}, 0.0),
    "box finger spins": (EXACT, {7: 0.5, 10: 0.2 * 0.6 / np.sqrt(3)}, 0.1),
    "box finger slips": (EXACT, {2: 0.4, 7: 0.5, 10: 0.2 * 0.5 / np.sqrt(3)}, 0.15),
    "elliptic finger does both": (EXACT, {4: 0.3, 8: 0.8, 11: -0.1 * 0.8 / np.sqrt(3)}, 0.1),
    "elliptic finger in its pyramid": (SQUARE, {4: 0.1, 8: 0.4, 11: -0.1 * 0.3 / np.sqrt(3)}, 0.1 + 0.5 * np.sqrt(0.5) * (0.3 - 0.4)),
    "elliptic finger outside": (OUTSIDE, {4: 0.2, 8: 0.4, 11: -0.1 * 0.5 / np.sqrt(3)}, 0.1),
    "bound too low": (EXACT, {9: 0.15}, 0.05),
    "bound too high": (EXACT, {9: 0.75}, 0.35),
    "handle pulls": (EXACT, {12: 0.09}, 0.04),
    "handle pushes": (EXACT, {12: -0.19}, 0.09),
    "an unlimited component": (EXACT, {13: 5.0}, 0.0),
}


@pytest.mark.parametrize("case", PLANTED)
def test_a_planted_violation_is_found_with_its_size(case):
    choice, entries, size = PLANTED[case]
    data = assemble(EVERYTHING)
    x = np.zeros(14)
    x[9] = 0.3
    for k, value in entries.items():
        x[k] = value
    assert force_residuals(data, choice, x).cone == pytest.approx(size, abs=1e-12)


def test_the_wrench_that_is_left_over_is_found_with_its_size():
    stance = stance_of(two_points((1, 0, 0), (0, 0, 0)), (0.5, 0, 0), 10.0)
    data = assemble(stance)
    balanced = np.array([0, 0, 0, 0, 0.5, 0.5])
    assert force_residuals(data, EXACT, balanced) == pytest.approx((0.0, 0.0), abs=1e-15)
    assert force_residuals(data, EXACT, balanced + [0, 0.3, 0, 0.3, 0.5, 0.5]).balance == pytest.approx(np.hypot(0.6, 1.0))
    moment = force_residuals(data, EXACT, balanced + [0, 0, 0, 0, 0.1, -0.1])
    assert moment.balance == pytest.approx(0.1)
    assert force_residuals(data, EXACT, np.zeros(6)).balance == pytest.approx(1.0)
