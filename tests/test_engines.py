"""Conformance: every model by every engine, in every form and cone, on stances of every kind of contact."""

from __future__ import annotations

from functools import cache
from typing import Any

import cvxpy as cp
import numpy as np
import pytest
from programs import (
    BUILDERS,
    CONES,
    KINDS,
    VARIANTS,
    Question,
    lagrangian,
    margin_constraints,
    outside_cone,
    questions,
    stance_of_kind,
    turn,
)

from socp_statics.engines import ENGINES, engines_for
from socp_statics.engines.conic_form import ConicForm
from socp_statics.engines.reference import ReferenceEngine
from socp_statics.exceptions import EngineError, InputError
from socp_statics.models import MODELS
from socp_statics.models.contact_forces_set import force_shape
from socp_statics.models.program import ConicModel, Program
from socp_statics.statics import assemble

# (engine, model, form) that an engine does not solve.
SEMIDEFINITE = ("force_rule", "rule_check", "inscribed_ellipsoid")
REFUSED: set[tuple[str, str, str]] = {("kernel", model, "sdp") for model in MODELS.names()}
REFUSED |= {("kernel", model, "socp") for model in SEMIDEFINITE}


def engine_of(name: str):
    return engines_for(name)[0]


@cache
def solution(model: str, kind: str, cone: str, engine: str):
    asked = questions(model, kind, cone)[turn(model, kind, cone)]
    return engine_of(engine).compile(asked.model, asked.shape).solve(asked.values)


CONFORMANCE = [(m, kind, cone) for m in MODELS.names() for kind in KINDS for cone in CONES]


def test_every_model_has_programs_here():
    assert set(BUILDERS) == set(MODELS.names())


def test_every_variant_is_asked_somewhere():
    for model, wanted in VARIANTS.items():
        assert {turn(model, kind, cone) for kind in KINDS for cone in CONES} == set(wanted)


def test_engines_refuse_exactly_what_is_listed():
    refused = {(engine, model, form) for engine in ENGINES.names() for model in MODELS.names() for form in ("socp", "sdp")
               if not engine_of(engine).accepts(MODELS.load(model), form)}  # fmt: skip
    assert refused == REFUSED


def test_pyramids_have_one_form():
    data = assemble(stance_of_kind("all types"))
    for cone in ("inscribed", "circumscribed"):
        choice = CONES[cone][0]
        assert force_shape(data, choice, "sdp", 6) == force_shape(data, choice, "socp", 6)


@pytest.mark.parametrize("engine", ENGINES.names())
@pytest.mark.parametrize(("model", "kind", "cone"), CONFORMANCE)
def test_engines_agree_and_are_optimal(model, kind, cone, engine):
    if (engine, model, CONES[cone][1]) in REFUSED:
        pytest.skip("refused, as listed")
    got, wanted = solution(model, kind, cone, engine), solution(model, kind, cone, "cvxpy")
    assert got.status == wanted.status
    assert got.engine == engine
    if got.status == "solved":
        assert got.objective == pytest.approx(wanted.objective, rel=1e-7, abs=1e-7)
        assert got.bound == pytest.approx(got.objective, rel=1e-7, abs=1e-7)
        assert max(got.residuals) <= 1e-7


def test_the_suite_has_every_status():
    seen = {solution(m, kind, cone, "clarabel").status for m, kind, cone in CONFORMANCE}
    assert seen == {"solved", "infeasible", "unbounded"}


@pytest.mark.parametrize("model", MODELS.names())
@pytest.mark.parametrize("cone", CONES)
def test_programs_are_affine_in_their_parameters(model, cone):
    for kind in ("all types", "bounds"):
        for asked in questions(model, kind, cone).values():
            program = asked.model.declare(asked.shape)
            assert program.problem.is_dcp(dpp=True)
            assert set(program.parameters) <= set(asked.values)
            assert all(program.parameters[n].shape == np.shape(asked.values[n]) for n in program.parameters)


@pytest.mark.parametrize("engine", ENGINES.names())
def test_an_elliptic_finger_as_an_arrow_matrix_in_a_large_program(engine):
    if (engine, "contact_forces", "sdp") in REFUSED:
        pytest.skip("refused, as listed")
    asked = questions("contact_forces", "all types", "sdp")["least_squares"]
    exact = questions("contact_forces", "all types", "socp")["least_squares"]
    got, wanted = (engine_of(engine).compile(q.model, q.shape).solve(q.values) for q in (asked, exact))
    assert got.objective == pytest.approx(wanted.objective, rel=1e-7)


@pytest.mark.parametrize("kind", KINDS)
def test_forms_agree_between_pyramids(kind):
    socp, sdp, inner, outer = (solution("equilibrium", kind, cone, "clarabel").objective for cone in CONES)
    assert socp == pytest.approx(sdp, abs=1e-7)
    assert inner - 1e-8 <= socp <= outer + 1e-8


# Optimality of the margin program, independently of the engines' own residuals.


@pytest.mark.parametrize("engine", ENGINES.names())
@pytest.mark.parametrize("cone", CONES)
@pytest.mark.parametrize("kind", KINDS)
def test_named_multipliers_of_the_margin_are_optimal(kind, cone, engine):
    if (engine, "equilibrium", CONES[cone][1]) in REFUSED:
        pytest.skip("refused, as listed")
    n, constraints = margin_constraints(kind, cone)
    got = solution("equilibrium", kind, cone, engine)
    assert set(got.duals) == set(constraints)
    z = np.append(got.variables["x"], got.variables["t"])
    _, gradient = lagrangian(n, constraints, got.duals)
    gradient[n] -= 1.0
    assert np.abs(gradient).max() <= 1e-7
    for name, (k, c) in constraints.items():
        value, y = c(z[:n], z[n]), got.duals[name]
        assert outside_cone(k, value) <= 1e-8, name
        assert abs(y @ value.ravel("F" if k == "psd" else "C")) <= 1e-7, name
        if k != "zero":
            shaped = -y if k == "le" else y.reshape(value.shape)
            assert outside_cone(k, shaped) <= 1e-8, name


def test_bounds_that_matter_have_multipliers():
    for kind, name in (("bounds", "lower_bound"), ("upper bound", "upper_bound"), ("bounds", "equal_bound")):
        assert np.abs(solution("equilibrium", kind, "socp", "clarabel").duals[name]).max() > 0.01


# Infeasible and unbounded programs come with their proofs.


@pytest.mark.parametrize("engine", ["kernel", "clarabel"])
@pytest.mark.parametrize("cone", CONES)
def test_infeasible_comes_with_multipliers_that_prove_it(cone, engine):
    if (engine, "contact_forces", CONES[cone][1]) in REFUSED:
        pytest.skip("refused, as listed")
    asked = questions("contact_forces", "outside", cone)["normal_force"]
    got = engine_of(engine).compile(asked.model, asked.shape).solve(asked.values)
    assert got.status == "infeasible"
    n, constraints = margin_constraints("outside", cone)
    held = {name: c for name, c in constraints.items() if name != "cap"}
    value, gradient = lagrangian(n, held, got.duals)
    size = max(np.abs(y).max() for y in got.duals.values())
    assert value(np.zeros(n + 1)) > 1e-3 * size
    assert np.abs(gradient[:n]).max() <= 1e-8 * size
    for name, (k, c) in held.items():
        y = got.duals[name]
        shaped = y.reshape(c(np.zeros(n), 0.0).shape)
        assert k == "zero" or outside_cone(k, -shaped if k == "le" else shaped) <= 1e-9 * size


@pytest.mark.parametrize("engine", ENGINES.names())
def test_a_region_without_end_is_unbounded_along_its_ray(engine):
    asked = questions("support_region", "chimney", "socp")["open"]
    got = engine_of(engine).compile(asked.model, asked.shape).solve(asked.values)
    assert got.status == "unbounded"
    if got.variables:
        x, s = got.variables["x"], got.variables["s"]
        size = max(np.abs(x).max(), np.abs(s).max())
        assert np.dot(asked.values["direction"], s) > 1e-6 * size
        assert np.abs(asked.values["G"] @ x + asked.values["D"] @ s).max() <= 1e-8 * size


# Update and rebuild.

UPDATED = [(m, v, kind) for m, v in (("equilibrium", ""), ("contact_forces", "least_squares"), ("minimax_wrench", "force"),
           ("support_region", "clipped"), ("contact_load", "")) for kind in ("feet", "all types")]  # fmt: skip


# Programs of these whose forces are unique as well.
UNIQUE = {("equilibrium", "all types"), ("contact_forces", "feet"), ("contact_forces", "all types"), ("support_region", "all types")}


def parameters_of(asked: Question) -> dict[str, Any]:
    names = asked.model.declare(asked.shape).parameters
    return {name: value for name, value in asked.values.items() if name in names}


@pytest.mark.parametrize("engine", ENGINES.names())
@pytest.mark.parametrize("cone", ["socp", "inscribed"])
@pytest.mark.parametrize(("model", "variant", "kind"), UPDATED)
def test_an_update_equals_a_rebuild(model, variant, kind, cone, engine):
    a, b = (questions(model, kind, cone, k)[variant] for k in (0.0, 1.0))
    assert a.shape == b.shape
    assert sum(not np.array_equal(a.values[n], b.values[n]) for n in a.values) >= 3
    compiled = engine_of(engine).compile(a.model, a.shape)
    first = compiled.solve(a.values)
    x_a, objective_a = np.array(first.variables["x"]), first.objective
    session = compiled.session(a.values)
    session.solve()
    updated, rebuilt = session.solve(**parameters_of(b)), compiled.solve(b.values)
    assert updated.status == rebuilt.status == "solved"
    assert updated.objective == pytest.approx(rebuilt.objective, abs=1e-9)
    assert max(updated.residuals) <= 1e-7
    again = session.solve(**parameters_of(a))
    assert again.objective == pytest.approx(objective_a, abs=1e-12)
    if (model, kind) in UNIQUE:
        assert np.abs(rebuilt.variables["x"] - x_a).max() > 1e-4
        np.testing.assert_allclose(updated.variables["x"], rebuilt.variables["x"], atol=1e-9)
        np.testing.assert_allclose(again.variables["x"], x_a, rtol=0, atol=1e-10)


@pytest.mark.parametrize("engine", ENGINES.names())
def test_an_update_keeps_statuses(engine):
    inside, outside = (questions("contact_forces", kind, "socp")["least_squares"] for kind in ("feet", "outside"))
    session = engine_of(engine).compile(inside.model, inside.shape).session(inside.values)
    statuses = [session.solve(load=asked.values["load"]).status for asked in (inside, outside, inside, outside)]
    assert statuses == ["solved", "infeasible"] * 2


@pytest.mark.parametrize("engine", ENGINES.names())
def test_the_same_question_has_the_same_bytes_whatever_came_before(engine):
    a, b = (questions("minimax_wrench", "feet", "inscribed", k)["force"] for k in (0.0, 1.0))
    compiled = type(engine_of(engine))().compile(a.model, a.shape)
    first, _, again = (compiled.solve(asked.values) for asked in (a, b, a))
    assert again.objective == first.objective
    assert again.variables["x"].tobytes() == first.variables["x"].tobytes()


@pytest.mark.parametrize("engine", ["kernel", "clarabel"])
def test_the_same_updates_have_the_same_bytes(engine):
    a, b = (questions("support_region", "all types", "socp", k)["clipped"] for k in (0.0, 1.0))
    compiled = engine_of(engine).compile(a.model, a.shape)
    runs = []
    for _ in range(2):
        session = compiled.session(a.values)
        runs.append([session.solve(**more).variables["x"].tobytes() for more in ({}, parameters_of(b), {"direction": (0.0, 1.0)})])
    assert runs[0] == runs[1]


@pytest.mark.parametrize("engine", ENGINES.names())
def test_new_directions_between_other_changes_equal_rebuilds(engine):
    a, b = (questions("support_region", "points", "socp", k)["clipped"] for k in (0.0, 1.0))
    compiled = engine_of(engine).compile(a.model, a.shape)
    session = compiled.session(a.values)
    values = dict(a.values)
    steps = [{"direction": (1.0, 0.0)}, {"direction": (0.0, -1.0)}, {"mu": b.values["mu"]}, {"direction": (-0.6, 0.8)},
             {"box": np.array([0.1, 0.2]), "load": b.values["load"]}, {"direction": (0.6, 0.8)}]  # fmt: skip
    for step in steps:
        values |= step
        updated, rebuilt = session.solve(**step), compiled.solve(values)
        assert updated.objective == pytest.approx(rebuilt.objective, abs=1e-9)
        assert updated.variable("s") == pytest.approx(updated.variables["s"])
        assert max(updated.residuals) <= 1e-7


@pytest.mark.parametrize("engine", ["kernel", "clarabel"])
def test_sessions_do_not_disturb_each_other(engine):
    a, b = (questions("equilibrium", "feet", "socp", k)[""] for k in (0.0, 1.0))
    compiled = engine_of(engine).compile(a.model, a.shape)
    one, two = compiled.session(a.values), compiled.session(b.values)
    before = one.solve()
    objective, t = before.objective, float(before.variables["t"])
    other = two.solve()
    assert other.objective != objective
    assert before.objective == objective == one.solve().objective
    assert float(before.variables["t"]) == t
    assert max(before.residuals) <= 1e-7


# What an answer costs, and what cannot be had.


@pytest.mark.parametrize("engine", ENGINES.names())
def test_residuals_are_computed_when_asked_for(engine, monkeypatch):
    asked = questions("equilibrium", "points", "socp")[""]
    compiled = engine_of(engine).compile(asked.model, asked.shape)
    calls = []
    inner = ConicForm.residuals
    monkeypatch.setattr(ConicForm, "residuals", lambda self, *a: calls.append(1) or inner(self, *a))
    got = compiled.solve(asked.values)
    assert got.status == "solved" and got.objective > 0 and len(got.variables["x"]) and len(got.duals["balance"])
    assert not calls
    assert got.residuals == got.residuals
    assert len(calls) == 1


def test_residuals_see_a_planted_error():
    asked = questions("equilibrium", "points", "socp")[""]
    form = ConicForm(asked.model.declare(asked.shape))
    got = engine_of("clarabel").compile(asked.model, asked.shape).solve(asked.values)
    data = form.data(form.parameter_vector(asked.values))
    z, y = form.primal_vector(got.variables), form.conic_multipliers(got.duals)
    assert max(form.residuals(data, z, y)) <= 1e-9
    for name, array, column in (("primal", z, form.variable_index["x"][0]), ("dual", y, form.dual_index["balance"][0])):
        wrong = array.copy()
        wrong[column] += 1e-3
        found = form.residuals(data, wrong if name == "primal" else z, wrong if name == "dual" else y)
        assert getattr(found, name) > 1e-5
        assert found.gap > 0


FOR_SCS = [("equilibrium", "points", "sdp"), ("equilibrium", "handle", "sdp"), ("equilibrium", "feet", "socp"),
           ("contact_forces", "elliptic", "sdp"), ("minimax_wrench", "points", "socp"), ("support_region", "feet", "socp")]  # fmt: skip


@pytest.mark.parametrize(("model", "kind", "cone"), FOR_SCS)
def test_another_solver_agrees(model, kind, cone):
    pytest.importorskip("scs")
    asked = questions(model, kind, cone)[turn(model, kind, cone)]
    got = ReferenceEngine(solver="SCS").compile(asked.model, asked.shape).solve(asked.values)
    assert got.status == "solved"
    assert got.detail.startswith("SCS")
    assert got.objective == pytest.approx(solution(model, kind, cone, "clarabel").objective, abs=1e-5)
    assert max(got.residuals) <= 1e-5


def test_an_unknown_engine_is_wrong_input():
    with pytest.raises(InputError, match="engine 'mosek' is not known; known: auto, kernel, clarabel, cvxpy") as caught:
        engines_for("mosek")
    assert caught.value.field == "engine"


def test_a_solver_that_is_not_installed_is_named():
    with pytest.raises(EngineError, match="solver NO_SUCH_SOLVER is not installed") as caught:
        ReferenceEngine(solver="NO_SUCH_SOLVER")
    assert caught.value.name == "NO_SUCH_SOLVER"


def test_auto_tries_the_kernel_first():
    assert [e.name for e in engines_for("auto")] == ["kernel", "clarabel", "cvxpy"]
    assert engines_for("auto")[2] is engine_of("cvxpy")


def test_engines_can_be_named_in_another_order():
    assert [e.name for e in engines_for(("clarabel", "kernel"))] == ["clarabel", "kernel"]
    with pytest.raises(InputError, match="at least one of"):
        engines_for(())


def test_engines_that_do_not_take_a_form_are_left_out():
    assert [e.name for e in engines_for("auto", "sdp")] == ["clarabel", "cvxpy"]
    with pytest.raises(InputError, match="engine kernel does not take programs in form 'sdp'"):
        engines_for("kernel", "sdp")


def test_the_kernel_says_what_it_does_not_take():
    asked = questions("equilibrium", "points", "sdp")[""]
    with pytest.raises(EngineError, match="the kernel takes no semidefinite cones, equilibrium in this shape has 3"):
        engine_of("kernel").compile(asked.model, asked.shape)
    x = cp.Variable(2, name="x")
    cost = cp.quad_form(x, np.array([[2.0, 1.0], [1.0, 2.0]]))
    one = x >= 1
    product = ConicModel("product", lambda shape: Program(cp.Problem(cp.Minimize(cost), [one]), {"x": x}, {"one": one}))
    with pytest.raises(EngineError, match="the kernel takes no products of different unknowns in a cost, product has some"):
        engine_of("kernel").compile(product, 0)


@pytest.mark.parametrize("engine", ["kernel", "clarabel"])
def test_a_value_of_the_wrong_shape_is_a_breakdown(engine):
    asked = questions("equilibrium", "points", "socp")[""]
    compiled = engine_of(engine).compile(asked.model, asked.shape)
    with pytest.raises(EngineError, match="parameter load has shape"):
        compiled.solve({**asked.values, "load": np.zeros(5)})
