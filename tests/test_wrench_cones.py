"""Contact wrench cones: closed form, double description and exact cones against linear programs that share no code."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from oracles import points_of, polygon_edges
from scipy.optimize import linprog

import socp_statics as ss
from socp_statics.exceptions import EngineError, InputError
from socp_statics.wrench_cones import combination, contact_wrench_cone, face_form, rectangle_faces, span_form
from socp_statics.wrench_cones.combination import nearest_combination

UP = (0, 0, 1)
OFF_CENTRE = [(0.12, 0.06), (-0.04, 0.06), (-0.04, -0.03), (0.12, -0.03)]
TURNED = [(0.03, 0.09), (-0.09, 0.01), (-0.06, -0.035), (0.06, 0.045)]
PENTAGON = [(0.1, 0.0), (0.04, 0.08), (-0.08, 0.05), (-0.07, -0.06), (0.05, -0.07)]


def sole(friction=0.5, **shape):
    return ss.SurfaceContact("foot", (0.3, -0.2, 0.1), rpy=(0.4, -0.3, 0.9), friction=friction, **(shape or {"size": (0.2, 0.1)}))


CONTACTS = {
    "rectangle": sole(),
    "off_centre": sole(vertices=OFF_CENTRE),
    "pentagon": sole(vertices=PENTAGON),
    "triangle": sole(vertices=PENTAGON[:3]),
    "line": ss.LineContact("edge", (0, 0, 0), normal=UP, friction=0.4, size=0.3),
    "point": ss.PointContact("hand", (0, 0, 0), normal=(1, 0, 0), friction=0.7),
    "finger": ss.SoftFingerContact("finger", (0, 0, 0), normal=UP, friction=0.6, torsional_friction=0.04),
    "box": ss.SoftFingerContact("thumb", (0, 0, 0), normal=UP, friction=0.6, torsional_friction=0.04, shape="box"),
    "slippery": ss.FrictionlessSurfaceContact("ice", (0, 0, 0), normal=UP, vertices=PENTAGON),
    "needle": ss.FrictionlessPointContact("needle", (0, 0, 0), normal=UP),
    "handle": ss.Handle("bar", (0, 0, 0), normal=UP, transmits=["fx", "fz", "mx", "mz"], limits={"fz": (0.0, np.inf)}),
}


def generators(contact, kind, sides, heading, point_C=(0.0, 0.0, 0.0)):
    """Rays and lines of a contact in its frame, built from the formulas of the contract alone."""
    if contact.type == "handle":
        axes = {word: np.eye(6)["fx fy fz mx my mz".split().index(word)] for word in contact.transmits}
        one_way = [word for word in axes if word in contact.limits]
        rays, lines = [axes[w] for w in one_way], [axes[w] for w in axes if w not in one_way]
    else:
        mu = contact.friction
        section = mu * polygon_edges(kind, sides, heading) if mu else np.zeros((1, 2))
        spins = [0.0]
        rays, lines = [], []
        if contact.type == "soft_finger":
            gamma = contact.torsional_friction
            spins = [gamma, -gamma]
            if contact.shape == "elliptic" and kind == "inscribed":
                rays += [np.array([0, 0, 1, 0, 0, s]) for s in spins]
                spins = [0.0]
        for p in (points_of(contact) - contact.position) @ contact.rotation:
            for x, y in section:
                rays += [np.concatenate([[x, y, 1.0], np.cross(p, [x, y, 1.0]) + [0, 0, s]]) for s in spins]
    move = np.eye(6)
    for i in range(3):
        move[3:, i] = np.cross(-np.asarray(point_C), np.eye(3)[i])
    return np.array(rays).reshape(-1, 6) @ move.T, np.array(lines).reshape(-1, 6) @ move.T


def is_combination(wrench, rays, lines):
    """Whether a wrench is a non-negative combination of rays plus lines, by HiGHS."""
    A = np.vstack([rays, lines]).T
    if not A.size:
        return not np.any(wrench)
    free = [(0, None)] * len(rays) + [(None, None)] * len(lines)
    return linprog(np.zeros(A.shape[1]), A_eq=A, b_eq=wrench, bounds=free, method="highs").status == 0


def wrenches_about(rng, rays, lines, count):
    """Wrenches that lie about as often inside as outside, none of them near the boundary by construction."""
    inside = (
        rng.exponential(size=(count, len(rays))) * (rng.random((count, len(rays))) < 0.5) @ rays
        + rng.normal(size=(count, len(lines))) @ lines
    )
    middle = rays.sum(axis=0) / max(len(rays), 1)
    scale = np.abs(np.vstack([rays, lines])).max(axis=0) + 1e-12
    return np.vstack([inside + 0.05 * middle, inside + rng.normal(size=(count, 6)) * scale])


@pytest.mark.parametrize("kind", ["inscribed", "circumscribed"])
@pytest.mark.parametrize(
    "contact", [sole(), sole(vertices=OFF_CENTRE), sole(friction=1.3, size=(0.05, 0.2))], ids=["centred", "off", "wide"]
)
def test_the_closed_form_agrees_with_a_linear_program_on_1500_wrenches(contact, kind):
    rng = np.random.default_rng(5)
    point = (0.03, -0.02, 0.1)
    cone = contact_wrench_cone(contact, cone=kind, point_C=point)
    form = cone.faces()
    assert form.faces.shape == (16, 6) and form.equalities.shape == (0, 6)
    rays, lines = generators(contact, kind, 4, 0.0, point)
    wrenches = wrenches_about(rng, rays, lines, 125)
    inside = form.excess(wrenches) <= 1e-9
    assert 40 < inside.sum() < 220
    assert [is_combination(w, rays, lines) for w in wrenches] == inside.tolist()
    assert (cone.contains(wrenches) == inside).all()


def test_lengths_that_change_places_are_found_out():
    rays, lines = generators(sole(), "circumscribed", 4, 0.0)
    wrenches = wrenches_about(np.random.default_rng(1), rays, lines, 60)
    swapped = contact_wrench_cone(sole(size=(0.1, 0.2)), cone="circumscribed").faces().excess(wrenches) <= 1e-9
    assert [is_combination(w, rays, lines) for w in wrenches] != swapped.tolist()


def test_a_rectangle_is_recognised_however_it_lies_and_is_turned():
    contact = sole(vertices=TURNED)
    heading = np.arctan2(0.08, 0.12)
    cone = contact_wrench_cone(contact, cone="inscribed", heading=heading + np.pi / 2)
    assert cone.closed_form is not None and len(cone.faces().faces) == 16
    rays, lines = generators(contact, "inscribed", 4, heading)
    assert cone.faces().excess(rays).max() < 1e-12
    assert (np.sum(np.abs(cone.faces().faces @ rays.T) < 1e-12, axis=1) >= 5).all()
    assert contact_wrench_cone(contact, cone="inscribed", heading=heading + 0.1).closed_form is None


def test_the_zero_wrench_belongs_to_the_cone_and_a_pull_does_not():
    cone = contact_wrench_cone(sole(), cone="inscribed")
    assert cone.contains(np.zeros(6)) and cone.faces().excess(np.zeros(6)) == 0.0
    assert not cone.contains([0, 0, -1, 0, 0, 0]) and cone.faces().excess([0, 0, -1, 0, 0, 0]) > 0.1


@pytest.mark.parametrize("point", [(0.0, 0.0, 0.0), (0.05, -0.1, 0.2)])
@pytest.mark.parametrize(
    ("kind", "sides", "heading"), [("inscribed", 4, 0.0), ("circumscribed", 4, 0.0), ("inscribed", 3, 0.4), ("circumscribed", 7, -1.0)]
)
@pytest.mark.parametrize("name", CONTACTS)
def test_both_forms_agree_with_each_other_and_with_linear_programs(name, kind, sides, heading, point):
    pytest.importorskip("cdd")
    contact = CONTACTS[name]
    cone = contact_wrench_cone(contact, cone=kind, sides=sides, heading=heading, point_C=point)
    form, span = cone.faces(), cone.spans()
    rays, lines = generators(contact, kind, sides, heading, point)
    scale = np.repeat([1.0, cone.length], 3)
    assert np.allclose(np.linalg.norm(form.faces * scale, axis=1), 1.0)
    assert np.allclose((form.equalities * scale) @ (form.equalities * scale).T, np.eye(len(form.equalities)))
    for row in np.vstack([rays / np.linalg.norm(rays / scale, axis=1, keepdims=True), lines, -lines, span.rays]):
        assert form.excess(row) < 1e-9
    # Every face is touched by the rays of a whole facet, and only extreme rays are kept.
    rank = 6 - len(form.equalities)
    for face in form.faces:
        touching = np.vstack([span.rays[np.abs(span.rays @ face) < 1e-9], span.lines]) / scale
        assert np.linalg.matrix_rank(touching, tol=1e-9) == rank - 1
    for k, ray in enumerate(span.rays):
        assert is_combination(ray, rays, lines)
        assert not is_combination(ray, np.delete(span.rays, k, axis=0), span.lines)
    if len(form.faces) <= 100:
        back = span_form(form.faces, form.equalities, length=cone.length)
        assert len(back.rays) == len(span.rays) and len(back.lines) == len(span.lines)
        if len(span.rays):
            assert np.abs((back.rays[:, None] - span.rays) / scale).max(axis=2).min(axis=0).max() < 1e-9
    rng = np.random.default_rng(2)
    wrenches = wrenches_about(rng, rays, lines, 6)
    expected = [is_combination(w, rays, lines) for w in wrenches]
    assert (cone.contains(wrenches)).tolist() == expected
    assert (form.excess(wrenches) <= 1e-8 * np.linalg.norm(wrenches / scale, axis=1)).tolist() == expected


@pytest.mark.parametrize("kind", ["inscribed", "circumscribed"])
@pytest.mark.parametrize("contact", [sole(), sole(vertices=OFF_CENTRE), sole(friction=0.0), sole(friction=0.0, vertices=OFF_CENTRE)])
def test_double_description_finds_the_faces_of_the_closed_form(contact, kind):
    pytest.importorskip("cdd")
    point = (0.02, 0.01, -0.3)
    cone = contact_wrench_cone(contact, cone=kind, point_C=point)
    closed = cone.faces()
    found = face_form(cone.generators.rays(), length=cone.length)
    assert len(closed.faces) == len(found.faces) and len(closed.equalities) == len(found.equalities)
    apart = np.abs((closed.faces[:, None] - found.faces) * np.repeat([1.0, cone.length], 3)).max(axis=2)
    assert apart.min(axis=0).max() < 1e-10 and apart.min(axis=1).max() < 1e-10


@pytest.mark.parametrize("sides", [4, 6, 8, 16])
def test_yaw_limits_follow_the_number_of_sides(sides):
    """A library kept the yaw rows of four sides for all: a square foot then takes up to 1.39 times the moment it can hold."""
    pytest.importorskip("cdd")
    foot = ss.SurfaceContact("foot", (0, 0, 0), normal=UP, friction=0.6, size=(0.2, 0.2))
    exact = 0.6 * np.hypot(0.1, 0.1)
    for kind in ("inscribed", "circumscribed"):
        cone = contact_wrench_cone(foot, cone=kind, sides=sides)
        form = cone.faces()
        yaw = np.array([0, 0, 1.0, 0, 0, 0]), np.array([0, 0, 0, 0, 0, 1.0])
        most = min(-(u @ yaw[0]) / (u @ yaw[1]) for u in form.faces if u @ yaw[1] > 1e-12)
        rays, _ = generators(foot, kind, sides, 0.0)
        program = linprog(-rays[:, 5], A_eq=rays[:, :5].T, b_eq=yaw[0][:5], method="highs")
        assert most == pytest.approx(-program.fun, rel=1e-9)
        assert (most <= exact * (1 + 1e-12)) if kind == "inscribed" else (most >= exact * (1 - 1e-12))
    round_ = contact_wrench_cone(foot)
    assert round_.contains([0, 0, 1, 0, 0, exact * (1 - 1e-7)]) and not round_.contains([0, 0, 1, 0, 0, exact * (1 + 1e-6)])


def test_equalities_are_equalities():
    """A library appended them to the inequalities: the square cut by x + y = 1 then kept the corner (0, 0)."""
    pytest.importorskip("cdd")
    # The square [0, 1]^2 and the line x + y = 1, made homogeneous.
    square = [[-1, 0, 0], [0, -1, 0], [1, 0, -1], [0, 1, -1]]
    span = span_form(square, [[1, 1, -1]])
    corners = sorted((np.round(r[:2] / r[2], 9) + 0.0).tolist() for r in span.rays)
    assert corners == [[0.0, 1.0], [1.0, 0.0]] and len(span.lines) == 0
    # A line contact transmits no moment about itself, to either side.
    for name in ("inscribed", "circumscribed"):
        cone = contact_wrench_cone(CONTACTS["line"], cone=name)
        form = cone.faces()
        assert len(form.equalities) == 1
        for sign in (1, -1):
            assert form.excess([0, 0, 1, sign * 1e-3, 0, 0]) > 1e-4 and not cone.contains([0, 0, 1, sign * 1e-3, 0, 0])


def test_redundant_rays_and_hidden_lines():
    pytest.importorskip("cdd")
    form = face_form([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1], [2, 0, 0], [0, 0, 0]])
    assert sorted(map(tuple, np.round(form.faces, 12) + 0.0)) == [(-1, 0, 0), (0, -1, 0), (0, 0, -1)]
    turned_back = face_form([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [5, 1, 0]])
    assert np.allclose(turned_back.faces, [[0, -1, 0]]) and np.allclose(np.abs(turned_back.equalities), [[0, 0, 1]])
    everything = face_form(np.vstack([np.eye(4), -np.eye(4)]))
    assert everything.faces.shape == (0, 4) and everything.equalities.shape == (0, 4)
    assert everything.excess(np.ones(4)) == -np.inf
    nothing = face_form(np.zeros((0, 3)))
    assert len(nothing.faces) == 0 and len(nothing.equalities) == 3
    assert np.allclose(face_form([[0, 2.0]]).faces, [[0, -1]])


def test_the_order_of_the_rays_does_not_matter():
    pytest.importorskip("cdd")
    rays, _ = generators(sole(vertices=PENTAGON), "inscribed", 5, 0.3)
    first, second = face_form(rays), face_form(rays[::-1])
    assert np.allclose(first.faces, second.faces, atol=1e-9)


@pytest.mark.parametrize("name", CONTACTS)
def test_the_support_function_of_the_exact_cone_lies_between_those_of_fine_pyramids(name):
    contact = CONTACTS[name]
    exact = contact_wrench_cone(contact)
    y = np.random.default_rng(4).normal(size=(50, 6)) / np.repeat([1.0, exact.length], 3)
    inner = contact_wrench_cone(contact, cone="inscribed", sides=400).support(y)
    outer = contact_wrench_cone(contact, cone="circumscribed", sides=400).support(y)
    middle = exact.support(y)
    assert (inner <= middle + 1e-9).all() and (middle <= outer + 1e-9).all()
    if name == "handle":
        assert np.isinf(middle).all()
    elif name not in ("finger", "box"):
        assert np.allclose(inner, outer, rtol=1e-3, atol=1e-3)
    assert exact.support(y[0]) == middle[0]


@pytest.mark.parametrize("name", CONTACTS)
def test_the_projection_on_the_exact_cone_meets_the_conditions_of_moreau(name):
    cone = contact_wrench_cone(CONTACTS[name], point_C=(0.01, 0.02, 0.05))
    scale = np.repeat([1.0, cone.length], 3)
    rng = np.random.default_rng(6)
    for F in rng.normal(size=(12, 6)) * scale * 10.0 ** rng.integers(-6, 7, (12, 1)):
        nearest = cone.project(F)
        size, rest = np.linalg.norm(F / scale), (F - nearest) / scale
        assert abs(rest @ (nearest / scale)) < 1e-9 * size**2
        assert cone.distance(F) == pytest.approx(np.linalg.norm(rest), abs=1e-12 * size)
        assert cone.distance(nearest) < 1e-8 * size
        twist = rest / scale / size
        if name == "handle":
            assert np.abs(cone.generators.lines @ twist).max() < 1e-12 and (cone.generators.half_lines @ twist).max() < 1e-12
        else:
            assert cone.support(twist) < 1e-9


def test_the_distance_from_the_exact_cone_agrees_with_a_conic_solver():
    cp = pytest.importorskip("cvxpy")
    rng = np.random.default_rng(8)
    for name in ("rectangle", "pentagon", "line", "finger", "box"):
        contact = CONTACTS[name]
        cone = contact_wrench_cone(contact)
        points = (points_of(contact) - contact.position) @ contact.rotation
        f, spin, F = cp.Variable((len(points), 3)), cp.Variable(), cp.Parameter(6)
        arms = [np.cross(p, np.eye(3)).T for p in points]
        force = cp.sum(f, axis=0)
        moment = sum(S @ f[i] for i, S in enumerate(arms)) + cp.hstack([0, 0, spin])
        away = cp.hstack([force, moment / cone.length]) - F
        gamma = getattr(contact, "torsional_friction", 0.0)
        rows = [cp.norm(f[:, :2], axis=1) <= contact.friction * f[:, 2], cp.abs(spin) <= gamma * cp.sum(f[:, 2])]
        if name == "finger":
            rows.append(cp.norm(cp.hstack([f[0, :2] / contact.friction, spin / gamma])) <= f[0, 2])
        program = cp.Problem(cp.Minimize(cp.norm(away)), rows)
        for _ in range(4):
            F.value = rng.normal(size=6) + [0, 0, 1, 0, 0, 0]
            program.solve(solver=cp.CLARABEL)
            assert cone.distance(F.value * np.repeat([1, cone.length], 3)) == pytest.approx(program.value, abs=1e-6)


@pytest.mark.parametrize("broken", ["wrong", "gives up"])
def test_an_answer_of_the_quick_least_squares_is_checked(monkeypatch, broken):
    """SciPy 1.17.1 returned, for one set of 48 rays of a stance, amounts that leave 0.339 where 0.195 is the least."""

    def nnls(A, b, **_):
        if broken == "gives up":
            raise RuntimeError
        return np.full(A.shape[1], 0.1), 0.0

    rng = np.random.default_rng(9)
    rays = rng.normal(size=(40, 6)) + [0, 0, 2, 0, 0, 0]
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    targets = rng.normal(size=(20, 6))
    expected = [nearest_combination(rays, t) @ rays for t in targets]
    monkeypatch.setattr(combination, "nnls", nnls)
    for target, nearest in zip(targets, expected, strict=True):
        rest = target - nearest_combination(rays, target) @ rays
        assert np.allclose(target - rest, nearest, atol=1e-12)
        assert (rays @ rest).max() < 1e-12 and abs(rest @ (target - rest)) < 1e-12


def test_without_the_extra_one_sentence_names_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "cdd", None)
    assert len(contact_wrench_cone(sole(), cone="inscribed").faces().faces) == 16
    cone = contact_wrench_cone(sole(vertices=PENTAGON), cone="inscribed")
    with pytest.raises(InputError, match=r"double description needs the extra \[cdd\]: pip install 'socp-statics\[cdd\]'"):
        cone.faces()
    answer = cone.consistency([0, 0, 1, 0, 0, 0])
    assert answer.consistent and answer.by == "support" and "[cdd]" in answer.why


def test_double_description_is_refused_where_it_is_the_wrong_tool():
    pytest.importorskip("cdd")
    with pytest.raises(InputError, match="wrong tool for 200 rays, at most 192 are expected; contains, distance and support"):
        contact_wrench_cone(sole(vertices=PENTAGON), cone="inscribed", sides=40).faces()
    needle = ss.SurfaceContact("foot", (0, 0, 0), normal=UP, friction=0.5, vertices=[(0, 0), (1, 0), (1, 1e-8), (0, 1e-8)])
    cone = contact_wrench_cone(needle, cone="inscribed", sides=5)
    with pytest.raises(EngineError, match="wrong tool here, the cone is flat but for a share of"):
        cone.faces()
    answer = cone.consistency([0, 0, 1, 0, 1, 0])
    assert not answer.consistent and answer.by == "support" and "flat" in answer.why
    assert answer.separating @ [0, 0, 1, 0, 1, 0] > 0.0 and cone.support(answer.separating) < 1e-9


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: contact_wrench_cone(sole(), cone="inscribed", sides=2), "sides must be a whole number >= 3, got 2"),
        (lambda: contact_wrench_cone(sole(), cone="round"), "cone must be one of"),
        (lambda: contact_wrench_cone("foot"), "a contact is expected, got 'foot'"),
        (lambda: contact_wrench_cone(sole(), point_C=(0, 0)), "contact 'foot': point must be 3 numbers"),
        (lambda: contact_wrench_cone(sole(), length=0.0), "length must be a finite number > 0"),
        (lambda: contact_wrench_cone(sole(vertices=[(0, 0), (1, 0), (0.2, 0.2), (0, 1)])), "contact 'foot': vertices must be convex"),
        (lambda: contact_wrench_cone(sole(normal_force=(0, 100), size=(1, 1))), "contact 'foot': normal_force bounds make no cone"),
        (
            lambda: contact_wrench_cone(ss.Handle("bar", (0, 0, 0), normal=UP, transmits=["fx"], limits={"fx": (-5, 5)})),
            "contact 'bar': limits.fx makes no cone",
        ),
        (lambda: contact_wrench_cone(sole()).contains([0, 0, 1]), r"wrench must have the shape \(6,\) or \(n, 6\), got \(3,\)"),
        (lambda: contact_wrench_cone(sole()).distance([0, 0, np.nan, 0, 0, 0]), "wrench must be finite"),
        (lambda: contact_wrench_cone(sole()).contains(np.zeros(6), tolerance=-1.0), "tolerance must be a finite number >= 0"),
        (lambda: contact_wrench_cone(sole()).support(np.zeros(5)), "direction must have the shape"),
        (lambda: contact_wrench_cone(sole()).faces(), "cone must be inscribed or circumscribed to have faces, got 'exact'"),
        (lambda: rectangle_faces(CONTACTS["line"], ss.ConeChoice("inscribed")), "contact 'edge': the closed form is for rectangular soles"),
        (lambda: rectangle_faces(sole(), ss.ConeChoice("inscribed", 6)), "contact 'foot': the closed form is for pyramids with four sides"),
        (lambda: rectangle_faces(sole(), ss.ConeChoice()), "contact 'foot': the closed form is for pyramids with four sides"),
        (lambda: face_form([1.0, 2.0]), "rays must be a matrix"),
        (lambda: face_form([[1.0, 2.0]], [[1.0]]), "lines must have the shape"),
        (lambda: face_form(np.eye(6), length=-1.0), "length must be a finite number > 0"),
    ],
)
def test_wrong_input_is_one_sentence(call, sentence):
    with pytest.raises(InputError, match=sentence):
        call()
