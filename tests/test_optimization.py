"""Optimal forces against closed forms, duals in six unknowns solved by SciPy, and linear programs over pyramids."""

from __future__ import annotations

import numpy as np
import oracles
import pytest
from scipy.optimize import minimize

from socp_statics.certificates import MotionCertificate
from socp_statics.contacts import (
    ContactSet,
    ExternalWrench,
    FrictionlessSurfaceContact,
    Handle,
    PointContact,
    SoftFingerContact,
    Stance,
    SurfaceContact,
)
from socp_statics.exceptions import InputError
from socp_statics.optimization import minimise_largest_wrench, optimise_contact_forces

UP = (0.0, 0.0, 1.0)
MASS = 60.0
W = MASS * 9.81
SIZE = (0.22, 0.13)


def stance_of(contacts, com, **more):
    return Stance(ContactSet(contacts), com, MASS, **more)


def foot(name="foot", p=(0, 0, 0), mu=0.6, normal=UP, **more):
    return SurfaceContact(name, p, normal=normal, friction=mu, size=SIZE, **more)


def point(name, p, normal=UP, mu=0.5, **more):
    return PointContact(name, p, normal=normal, friction=mu, **more)


def feet(y=0.0):
    return stance_of([foot("left", (0, 0.1, 0)), foot("right", (0, -0.1, 0))], (0, y, 0.8))


def slope(degrees, mu):
    a = np.radians(degrees)
    return stance_of([foot("sole", mu=mu, normal=(np.sin(a), 0, np.cos(a)))], (0, 0, 0.4))


def chimney():
    sides = (("left", 0.4), ("right", -0.4))
    return stance_of([SurfaceContact(name, [0, y, 1], normal=(0, -y, 0), friction=0.5, size=[0.2, 0.1]) for name, y in sides], (0, 0, 1.0))


def tripod(tilt=0.3, mu=0.6, com=(0.02, -0.03, 0.5)):
    spots = [(0.3, 0, 0), (-0.2, 0.25, 0.1), (-0.2, -0.25, 0.05)]
    normals = [(-tilt, 0.1, 1), (0.2, -tilt, 1), (0.1, tilt, 1)]
    return stance_of([point(f"p{i}", p, n, mu) for i, (p, n) in enumerate(zip(spots, normals, strict=True))], com)


def wall_hand():
    return stance_of([foot("foot", mu=0.4), point("hand", (0.5, 0.1, 1.2), (-1, 0, 0.1), 0.3)], (0.14, 0.02, 0.8))


def roof():
    """Two soles that lean against each other."""
    return stance_of([foot("left", (0, 0.2, 0), 0.5, (0.1, -0.4, 1)), foot("right", (0.1, -0.2, 0.1), 0.4, (0, 0.5, 1))], (0.03, 0.01, 0.7))


# The least squares and minimax programs have duals in six unknowns (methods.md, section 1), built here from points and frictions.


def maps_and_load(stance):
    """Wrench maps of the point forces about the mean contact point, lengths over the size, and the load over the weight."""
    P = np.vstack([oracles.points_of(c) for c in stance.contacts])
    R = np.array([c.rotation for c in stance.contacts for _ in oracles.points_of(c)])
    mu = np.array([c.friction for c in stance.contacts for _ in oracles.points_of(c)])
    _, size, centre = oracles.scales(stance)
    A = np.array([np.vstack([r, np.cross((p - centre) / size, r.T).T]) for p, r in zip(P, R, strict=True)])
    load, _, _ = oracles.loads_of(stance, W, size, centre)
    return A, mu, load


def projected(v, mu):
    """Euclidean projection of rows (f_x, f_y, f_n) on their friction cones, and nothing else."""
    t, z = np.linalg.norm(v[:, :2], axis=1), v[:, 2]
    s = np.maximum(mu * t + z, 0.0) / (1 + mu**2)
    inside = t <= mu * z
    outside = np.column_stack([(mu * s / np.where(t > 0, t, 1.0))[:, None] * v[:, :2], s])
    return np.where(inside[:, None], v, np.where((mu * t <= -z)[:, None], 0.0, outside))


def least_squares_by_dual(stance):
    """Forces of the least squares optimum in contact frames over the weight, shape (points, 3)."""
    A, mu, load = maps_and_load(stance)

    def value(y):
        f = projected(np.einsum("nij,i->nj", A, y), mu)
        return 0.5 * (f**2).sum() + load @ y, np.einsum("nij,nj->i", A, f) + load

    found = minimize(value, np.zeros(6), jac=True, method="BFGS", options={"gtol": 1e-11, "maxiter": 5000})
    assert np.abs(found.jac).max() < 1e-7
    return projected(np.einsum("nij,i->nj", A, found.x), mu)


def minimax_bound(stance):
    """Best lower bound of the largest force over the weight: max w'y / sum |P_i(-A_i' y)|."""
    A, mu, load = maps_and_load(stance)
    free = np.linalg.svd(load[None])[2][1:].T
    y0 = load / (load @ load)

    def total(z, smooth):
        f = projected(np.einsum("nij,i->nj", A, -(y0 + free @ z)), mu)
        length = np.sqrt((f**2).sum(axis=1) + smooth**2)
        return length.sum(), -free.T @ np.einsum("nij,nj->i", A, f / length[:, None])

    z = np.zeros(5)
    for smooth in 10.0 ** -np.arange(1, 10):
        z = minimize(total, z, args=(smooth,), jac=True, method="BFGS", options={"gtol": 1e-12, "maxiter": 2000}).x
    return 1.0 / total(z, 0.0)[0]


DUAL_STANCES = {"tripod": tripod(), "flat tripod": tripod(0.0, 0.2), "hand on a wall": wall_hand(), "roof": roof(), "feet": feet(0.05)}


@pytest.mark.parametrize("case", DUAL_STANCES)
def test_least_squares_equals_the_dual_in_six_unknowns(case):
    stance = DUAL_STANCES[case]
    f = least_squares_by_dual(stance)
    answer = optimise_contact_forces(stance)
    assert answer.status == "solved"
    assert answer.objective == pytest.approx(W**2 * (f**2).sum(), rel=1e-7)
    R = np.array([c.rotation for c in stance.contacts for _ in oracles.points_of(c)])
    np.testing.assert_allclose(answer.forces.force_W, W * np.einsum("nij,nj->ni", R, f), atol=1e-5 * W)
    assert max(answer.residuals.values()) <= 1e-7


@pytest.mark.parametrize("case", ["tripod", "hand on a wall", "roof"])
def test_the_largest_force_equals_the_bound_of_boyd_and_wegbreit(case):
    stance = DUAL_STANCES[case]
    answer = minimise_largest_wrench(stance, "force", "point")
    assert answer.objective == pytest.approx(W * minimax_bound(stance), rel=1e-6)
    assert answer.objective == pytest.approx(np.linalg.norm(answer.forces.force_W, axis=1).max(), rel=1e-7)


def test_any_dual_point_bounds_the_largest_force():
    A, mu, load = maps_and_load(roof())
    best = minimise_largest_wrench(roof(), "force", "point").objective / W
    for y in np.random.default_rng(0).normal(size=(50, 6)):
        y = y if load @ y > 0 else -y
        assert load @ y <= best * np.linalg.norm(projected(np.einsum("nij,i->nj", A, -y), mu), axis=1).sum() + 1e-12


# Force optimisation.


def test_least_squares_shares_the_weight_evenly():
    answer = optimise_contact_forces(feet())
    np.testing.assert_allclose(answer.forces.force_W, np.tile([0, 0, W / 8], (8, 1)), atol=1e-6 * W)
    assert answer.objective == pytest.approx(W**2 / 8)


def test_least_squares_counts_handle_forces():
    bars = [Handle("a", [0.5, 0, 1], normal=UP, transmits=["fx", "fy", "fz"]), Handle("b", [-0.5, 0, 1], normal=UP, transmits=["fz"])]
    held = stance_of(bars, (0, 0, 0.5))
    assert optimise_contact_forces(held).objective == pytest.approx(W**2 / 2)


@pytest.mark.parametrize("mu", [0.3, 0.8, 1.5])
def test_least_normal_force_in_a_groove(mu):
    groove = stance_of([point("left", (-0.3, 0, 0), (1, 0, 1), mu), point("right", (0.3, 0, 0), (-1, 0, 1), mu)], (0, 0, 0.2))
    assert optimise_contact_forces(groove, "normal_force").objective == pytest.approx(np.sqrt(2) * W / (1 + mu), rel=1e-7)


@pytest.mark.parametrize("kind", ["inscribed", "circumscribed"])
@pytest.mark.parametrize("case", ["tripod", "hand on a wall", "roof"])
def test_least_normal_force_over_pyramids_is_a_linear_program(case, kind):
    stance = DUAL_STANCES[case]
    model = oracles.linear_stance(stance, kind, 5, 0.3, stated=True)
    here = [(v, v) for v in model.com[:2]]
    wanted = oracles.solve(model, (0.0, 0.0), here, cost_z=-np.ones(model.A.shape[1]))
    got = optimise_contact_forces(stance, "normal_force", cone=kind, sides=5, heading=0.3)
    assert got.objective == pytest.approx(-wanted.fun * model.weight, rel=1e-7)


def test_a_reference_inside_the_set_is_reached():
    wanted = {w["contact"]: w["force"] for w in minimise_largest_wrench(roof(), "force", "contact").forces.wrenches()}
    answer = optimise_contact_forces(roof(), "reference", reference_forces=wanted)
    assert answer.objective == pytest.approx(0.0, abs=1e-10 * W**2)
    for wrench in answer.forces.wrenches():
        np.testing.assert_allclose(wrench["force"], wanted[wrench["contact"]], atol=1e-4 * W)


def test_a_reference_out_of_reach_is_approached_in_world_axes():
    wanted = {"sole": [30.0, -40.0, W + 120.0]}
    assert optimise_contact_forces(slope(10, 0.6), "reference", reference_forces=wanted).objective == pytest.approx(130.0**2, rel=1e-6)


def test_a_reference_of_one_foot_unloads_the_other():
    answer = optimise_contact_forces(feet(), "reference", reference_forces={"right": (0, 0, 0.3 * W)})
    assert [w["force"][2] / W for w in answer.forces.wrenches()] == pytest.approx([0.7, 0.3], abs=1e-6)


def test_bounds_shift_the_optimum():
    stance = stance_of([foot("left", (0, 0.1, 0)), foot("right", (0, -0.1, 0), normal_force=[0, 0.4 * W])], (0, 0, 0.8))
    answer = optimise_contact_forces(stance)
    assert [w["force"][2] / W for w in answer.forces.wrenches()] == pytest.approx([0.6, 0.4], abs=1e-6)
    # Both centres of pressure move by pairs of +-shift at the corners, which make up for the moment 0.02 m W.
    shift = 0.02 / (8 * 0.065)
    assert answer.objective == pytest.approx(W**2 * (0.6**2 / 4 + 0.4**2 / 4 + 8 * shift**2), rel=1e-7)


# Minimax.

ALPHA = np.radians(20)
CLOSED_FORMS = {
    "flat, normal, point": (stance_of([foot()], (0, 0, 0.8)), "normal", "point", W / 4),
    "flat, normal, contact": (stance_of([foot()], (0, 0, 0.8)), "normal", "contact", W),
    "flat, force, point": (stance_of([foot()], (0, 0, 0.8)), "force", "point", W / 4),
    "flat, force, contact": (stance_of([foot()], (0, 0, 0.8)), "force", "contact", W),
    "flat, tangential, point": (stance_of([foot()], (0, 0, 0.8)), "tangential", "point", 0.0),
    "flat, tangential, contact": (stance_of([foot()], (0, 0, 0.8)), "tangential", "contact", 0.0),
    "flat, component, point": (stance_of([foot()], (0, 0, 0.8)), "component", "point", W / 4),
    "flat, component, contact": (stance_of([foot()], (0, 0, 0.8)), "component", "contact", W),
    "flat, friction_use, point": (stance_of([foot()], (0, 0, 0.8)), "friction_use", "point", 0.0),
    "flat, friction_use, contact": (stance_of([foot()], (0, 0, 0.8)), "friction_use", "contact", 0.0),
    "slope, normal": (slope(20, 0.6), "normal", "point", W * np.cos(ALPHA) / 4),
    "slope, force": (slope(20, 0.6), "force", "point", W / 4),
    "slope, tangential, point": (slope(20, 0.6), "tangential", "point", W * np.sin(ALPHA) / 4),
    "slope, tangential, contact": (slope(20, 0.6), "tangential", "contact", W * np.sin(ALPHA)),
    "slope, component": (slope(20, 0.6), "component", "contact", W * np.cos(ALPHA)),
    "slope, friction_use, point": (slope(20, 0.6), "friction_use", "point", np.tan(ALPHA) / 0.6),
    "slope, friction_use, contact": (slope(20, 0.6), "friction_use", "contact", np.tan(ALPHA) / 0.6),
    "two feet, normal, point": (feet(), "normal", "point", W / 8),
    "two feet, force, contact": (feet(), "force", "contact", W / 2),
    "lever": (stance_of([point("a", (0.3, 0, 0)), point("b", (-0.3, 0, 0))], (0.1, 0, 0.5)), "force", "point", W * 2 / 3),
    "handles": (stance_of([Handle("a", [0.2, 0, 1], normal=UP, transmits=["fx", "fy", "fz"]),
                           Handle("b", [-0.4, 0, 1], normal=UP, transmits=["fx", "fy", "fz"])], (0.1, 0, 0)),
                "force", "contact", W * 5 / 6),
    "frictionless has no tangential force": (stance_of([FrictionlessSurfaceContact("ice", [0, 0, 0], normal=UP, size=SIZE)], (0, 0, 0.5)),
                                             "tangential", "point", 0.0),
    "frictionless uses no friction": (stance_of([FrictionlessSurfaceContact("ice", [0, 0, 0], normal=UP, size=SIZE)], (0, 0, 0.5)),
                                      "friction_use", "point", 0.0),
    "pushed": (stance_of([foot()], (0, 0, 0), external_wrenches=(ExternalWrench(force=(0, 100.0, 0), point=(0, 0, 0)),)),
               "friction_use", "contact", 100 / (0.6 * W)),
}  # fmt: skip


@pytest.mark.parametrize("form", ["socp", "sdp"])
@pytest.mark.parametrize("case", CLOSED_FORMS)
def test_minimax_equals_its_closed_form(case, form):
    stance, measure, level, wanted = CLOSED_FORMS[case]
    answer = minimise_largest_wrench(stance, measure, level, form=form)
    assert answer.status == "solved"
    scale = 1.0 if measure == "friction_use" else W
    assert answer.objective == pytest.approx(wanted, abs=(2e-6 if measure == "friction_use" else 1e-7) * scale)
    assert answer.residuals["balance"] <= 1e-7 and answer.residuals["cone"] <= 1e-7
    assert largest(answer, stance, measure, level) <= answer.objective + 2e-6 * scale


def largest(answer, stance, measure, level):
    """The measure of an answer's forces, counted again; moments are left to the closed forms."""
    worst = 0.0
    entries = answer.forces.entries() if level == "point" else answer.forces.wrenches()
    for entry in entries:
        contact = stance.contacts[entry["contact"]]
        f = contact.rotation.T @ np.array(entry["force"])
        tangential = float(np.linalg.norm(f[:2])) if contact.friction > 0 else 0.0
        value = {"force": float(np.linalg.norm(f)), "component": float(np.abs(f).max()), "tangential": tangential}
        value |= {"normal": 0.0, "friction_use": 0.0}
        if contact.unilateral:
            value["normal"] = float(f[2])
            value["friction_use"] = tangential / (contact.friction * f[2]) if contact.friction > 0 and f[2] > 1e-6 * W else 0.0
        worst = max(worst, value[measure])
    return worst


@pytest.mark.parametrize(("length", "wanted"), [(0.02, 2.5 * W), (0.05, W), (1.0, W)])
def test_component_divides_moments_by_a_length(length, wanted):
    stance = stance_of([foot()], (0.05, 0, 0.8))
    assert minimise_largest_wrench(stance, "component", "contact", length=length).objective == pytest.approx(wanted, rel=1e-7)


def test_component_looks_at_the_contact_frame_and_at_spinning():
    finger = SoftFingerContact("finger", [0, 0, 0], normal=UP, friction=0.5, torsional_friction=0.1)
    stance = stance_of([finger], (0, 0, 0.3), external_wrenches=(ExternalWrench(moment=(0, 0, 20.0)),))
    assert minimise_largest_wrench(stance, "component", "point", length=0.01).objective == pytest.approx(2000.0, rel=1e-6)


@pytest.mark.parametrize("level", ["point", "contact"])
def test_friction_use_of_a_chimney_is_an_infimum(level):
    answer = minimise_largest_wrench(chimney(), "friction_use", level)
    assert answer.status == "unbounded"
    assert answer.objective == pytest.approx(0.0, abs=2e-6)


def test_friction_use_over_pyramids_measures_the_same_ratio():
    for kind in ("inscribed", "circumscribed"):
        answer = minimise_largest_wrench(slope(20, 0.6), "friction_use", "contact", cone=kind, sides=8)
        assert answer.objective == pytest.approx(np.tan(ALPHA) / 0.6, abs=2e-6)


def test_friction_use_is_one_at_the_boundary_of_slipping():
    assert minimise_largest_wrench(slope(20, np.tan(ALPHA) * 1.0001), "friction_use").objective == pytest.approx(1 / 1.0001, abs=3e-6)


# What cannot be had.


ASKED = {
    "least_squares": optimise_contact_forces,
    "reference": lambda s: optimise_contact_forces(s, "reference", reference_forces={"left": [0, 0, 1]}),
    "force": minimise_largest_wrench,
    "friction_use": lambda s: minimise_largest_wrench(s, "friction_use"),
}


@pytest.mark.parametrize("ask", ASKED.values(), ids=ASKED)
def test_an_unstable_stance_is_infeasible_with_its_motion(ask):
    answer = ask(feet(0.4))
    assert answer.status == "infeasible"
    assert answer.objective is None and answer.forces is None
    assert answer.equilibrium.verdict == "unstable"
    assert isinstance(answer.equilibrium.certificate, MotionCertificate)
    assert "left" in answer.equilibrium.certificate.reading


def test_a_slope_too_steep_is_infeasible_for_friction_use():
    answer = minimise_largest_wrench(slope(40, 0.6), "friction_use")
    assert answer.status == "infeasible"
    assert "slides" in answer.equilibrium.certificate.reading


@pytest.mark.parametrize(("ask", "field"), [
    (lambda: optimise_contact_forces(feet(), "least_norm"), "objective"),
    (lambda: optimise_contact_forces(feet(), "reference"), "reference_forces"),
    (lambda: optimise_contact_forces(feet(), reference_forces={"left": [0, 0, 1]}), "reference_forces"),
    (lambda: optimise_contact_forces(feet(), "reference", reference_forces={"middle": [0, 0, 1]}), "reference_forces"),
    (lambda: optimise_contact_forces(feet(), "reference", reference_forces={"left": [0, 1]}), "reference_forces"),
    (lambda: optimise_contact_forces(feet(), engine="mosek"), "engine"),
    (lambda: optimise_contact_forces(feet(), cone="round"), "cone"),
    (lambda: minimise_largest_wrench(feet(), "torque"), "measure"),
    (lambda: minimise_largest_wrench(feet(), "force", "robot"), "level"),
    (lambda: minimise_largest_wrench(feet(), "component", length=0.0), "length"),
    (lambda: minimise_largest_wrench(feet(), cone="inscribed", sides=2), "sides"),
])  # fmt: skip
def test_wrong_questions_name_the_field(ask, field):
    with pytest.raises(InputError) as caught:
        ask()
    assert caught.value.field == field
    assert field in str(caught.value)


@pytest.mark.parametrize("ask", [lambda f: optimise_contact_forces(feet(), form=f), lambda f: minimise_largest_wrench(feet(), form=f)])
def test_an_unknown_form_is_wrong_input(ask):
    with pytest.raises(InputError, match="form"):
        ask("lp")
