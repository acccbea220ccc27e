"""The kernel's conic solver: optimality, certificates and failures judged from the data of the program."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pytest
import scipy.sparse as sp
from programs import questions

from socp_statics.engines import engines_for

clarabel = pytest.importorskip("clarabel")
conic = pytest.importorskip("socp_statics.engines.kernel.conic")
engine = pytest.importorskip("socp_statics.engines.kernel.engine")

TOLERANCE = 1e-8


class Conic(NamedTuple):
    """minimise 1/2 x'Px + q'x subject to A x = b, G x + s = h, s in R+^orthant x second-order cones."""

    P: np.ndarray
    q: np.ndarray
    A: np.ndarray
    b: np.ndarray
    G: np.ndarray
    h: np.ndarray
    orthant: int
    soc: tuple[int, ...]


class Answer(NamedTuple):
    """What the solver says."""

    status: int
    steps: int
    x: np.ndarray
    y: np.ndarray
    z: np.ndarray
    s: np.ndarray
    objective: float
    bound: float


def prepared(c: Conic):
    rows = sp.csr_array(c.G)
    rows.eliminate_zeros()
    start, column = rows.indptr.astype(np.int64), rows.indices.astype(np.int64)
    return conic.prepare(c.P, np.ascontiguousarray(c.A), start, column, rows.data, c.orthant, np.array(c.soc, dtype=np.int64))


def solved(c: Conic, plan=None, limit=None) -> Answer:
    x, y, z, s = (np.full(k, np.nan) for k in (len(c.q), len(c.b), len(c.h), len(c.h)))
    plan = plan or prepared(c)
    status, steps = conic.solve(*plan, c.q, c.b, c.h, limit or conic.ITERATIONS, x, y, z, s)
    return Answer(status, steps, x, y, z, s, *conic.values(*plan))


def outside(v: np.ndarray, c: Conic) -> float:
    """How far a stacked vector is outside the cones."""
    worst, at = max(0.0, float(-v[: c.orthant].min(initial=0.0))), c.orthant
    for d in c.soc:
        worst = max(worst, float(np.linalg.norm(v[at + 1 : at + d]) - v[at]))
        at += d
    return worst


def inside(rng, orthant: int, soc: tuple[int, ...]) -> np.ndarray:
    """A point strictly inside the cones."""
    parts = [rng.uniform(0.1, 2.0, orthant)]
    for d in soc:
        v = rng.normal(size=d)
        v[0] = np.linalg.norm(v[1:]) + rng.uniform(0.1, 1.0)
        parts.append(v)
    return np.concatenate(parts)


def program(seed: int, n: int, p: int, orthant: int, soc: tuple[int, ...], *, quadratic=False, repeated=0, free=0) -> Conic:
    """A program with strictly feasible points on both sides; every cone touches a few unknowns, the last unknown is in all of them."""
    rng = np.random.default_rng(seed)
    m = orthant + sum(soc)
    G, at = np.zeros((m, n + free)), 0
    for d in [1] * orthant + list(soc):
        columns = [*rng.choice(n - 1, min(3, n - 1), replace=False), n - 1]
        G[at : at + d, columns] = rng.normal(size=(d, len(columns)))
        at += d
    A = rng.normal(size=(p, n + free))
    A = np.vstack([A, rng.normal(size=(repeated, p)) @ A])
    P = np.zeros(n + free)
    if quadratic:
        P[:n] = rng.uniform(0.0, 2.0, n) * (rng.random(n) < 0.7)
    x, y = rng.normal(size=n + free), rng.normal(size=p + repeated)
    return Conic(P, -(P * x + A.T @ y + G.T @ inside(rng, orthant, soc)), A, A @ x, G, G @ x + inside(rng, orthant, soc), orthant, soc)


def assert_optimal(c: Conic, got: Answer, tolerance=TOLERANCE):
    assert got.status == conic.SOLVED
    size_x = max(1.0, np.abs(c.b).max(initial=0.0), np.abs(c.h).max(initial=0.0))
    size_q = max(1.0, np.abs(c.q).max())
    assert np.abs(c.A @ got.x - c.b).max(initial=0.0) <= tolerance * size_x
    assert np.abs(c.G @ got.x + got.s - c.h).max(initial=0.0) <= tolerance * size_x
    assert np.abs(c.P * got.x + c.q + c.A.T @ got.y + c.G.T @ got.z).max() <= tolerance * size_q
    assert outside(got.s, c) == 0.0 == outside(got.z, c)
    value = 0.5 * c.P @ got.x**2 + c.q @ got.x
    assert got.objective == pytest.approx(value, rel=tolerance, abs=tolerance)
    assert abs(got.s @ got.z) <= tolerance * (1 + abs(value))
    assert got.bound == pytest.approx(value, rel=tolerance, abs=tolerance)


def by_clarabel(c: Conic):
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    cones: list[Any] = [clarabel.ZeroConeT(len(c.b))] * bool(len(c.b)) + [clarabel.NonnegativeConeT(c.orthant)] * bool(c.orthant)
    cones += [clarabel.SecondOrderConeT(d) for d in c.soc]
    rows = sp.csc_array(np.vstack([c.A, c.G]))
    return clarabel.DefaultSolver(sp.csc_array(np.diag(c.P)), c.q, rows, np.concatenate([c.b, c.h]), cones, settings).solve()


SHAPES = {
    "orthant": {"n": 8, "p": 2, "orthant": 14, "soc": ()},
    "cones of 3": {"n": 10, "p": 3, "orthant": 0, "soc": (3,) * 6},
    "cones of 3 and 4": {"n": 13, "p": 6, "orthant": 2, "soc": (3,) * 5 + (4,) * 4},
    "cones of every dimension": {"n": 14, "p": 3, "orthant": 3, "soc": (1, 2, 3, 4, 5, 9, 3, 3)},
    "no equality rows": {"n": 7, "p": 0, "orthant": 8, "soc": (3, 3, 4)},
    "repeated rows": {"n": 10, "p": 3, "orthant": 4, "soc": (3, 3, 4), "repeated": 2},
    "free unknowns": {"n": 9, "p": 5, "orthant": 5, "soc": (3, 3, 3), "free": 2},
    "free unknowns and repeated rows": {"n": 9, "p": 5, "orthant": 5, "soc": (3, 4, 3), "free": 3, "repeated": 2},
}


@pytest.mark.parametrize("quadratic", [False, True], ids=["linear", "quadratic"])
@pytest.mark.parametrize("shape", SHAPES)
def test_random_programs_are_solved_to_optimality(shape, quadratic):
    for seed in range(20):
        c = program(seed, quadratic=quadratic, **SHAPES[shape])
        before = [np.copy(v) for v in c]
        got = solved(c)
        assert_optimal(c, got)
        assert got.steps <= 20
        assert all(np.array_equal(a, b) for a, b in zip(before, c, strict=True))
        if seed < 5:
            other = by_clarabel(c)
            assert got.objective == pytest.approx(other.obj_val, rel=1e-6, abs=1e-6)


def test_unknowns_that_cones_cannot_tell_apart():
    for seed in range(10):
        c = program(seed, **SHAPES["cones of 3"])
        rng = np.random.default_rng(seed)
        # The last column of G is a combination of two others, those of A and q are not.
        G = np.hstack([c.G, (c.G[:, :2] @ [0.7, -1.3])[:, None]])
        A = np.hstack([c.A, rng.normal(size=(len(c.A), 1))])
        y, z = rng.normal(size=len(A)), inside(rng, c.orthant, c.soc)
        twin = c._replace(P=np.zeros(11), A=A, G=G, q=-(A.T @ y + G.T @ z))
        assert_optimal(twin, solved(twin))


def test_a_quadratic_cost_without_cones_is_a_linear_system():
    rng = np.random.default_rng(1)
    A, P, q = rng.normal(size=(2, 5)), rng.uniform(1, 2, 5), rng.normal(size=5)
    c = Conic(P, q, A, rng.normal(size=2), np.zeros((0, 5)), np.zeros(0), 0, ())
    got = solved(c)
    assert_optimal(c, got)
    exact = np.linalg.solve(np.block([[np.diag(P), A.T], [A, np.zeros((2, 2))]]), np.concatenate([-q, c.b]))
    np.testing.assert_allclose(got.x, exact[:5], atol=1e-8)


@pytest.mark.parametrize("shape", ["orthant", "cones of 3 and 4", "free unknowns"])
def test_badly_scaled_columns_and_rows(shape):
    for seed in range(20):
        c, rng = program(seed, **SHAPES[shape]), np.random.default_rng(seed)
        E = 10.0 ** rng.uniform(-4, 4, len(c.q))
        R = 10.0 ** rng.uniform(-3, 3, len(c.b))
        scaled = c._replace(q=c.q * E, A=R[:, None] * c.A * E, b=R * c.b, G=c.G * E, P=c.P * E**2)
        got, plain = solved(scaled), solved(c)
        assert got.status == conic.SOLVED
        assert got.objective == pytest.approx(plain.objective, rel=1e-7, abs=1e-7)
        assert np.abs((scaled.A @ got.x - scaled.b) / R).max() <= 1e-6
        assert outside(got.s, c) == 0.0 == outside(got.z, c)


def test_degenerate_vertices():
    """One point of friction carries everything: more boundaries meet than there are unknowns."""
    for seed in range(20):
        rng = np.random.default_rng(seed)
        points = 5
        G = np.zeros((3 * points, 4))
        for i in range(points):
            G[3 * i : 3 * i + 3] = -rng.normal(size=(3, 4))
            G[3 * i] = -np.abs(G[3 * i])
        # The dual solution uses one cone only, at its apex on the primal side; s is zero in three cones.
        s, z = np.zeros(3 * points), np.zeros(3 * points)
        for i in range(3, points):
            s[3 * i] = 1.0
        z[:3] = [1.0, 0.3, 0.2]
        x = rng.normal(size=4)
        c = Conic(np.zeros(4), -G.T @ z, np.zeros((0, 4)), np.zeros(0), G, G @ x + s, 0, (3,) * points)
        got = solved(c)
        assert_optimal(c, got)
        assert got.objective == pytest.approx(c.q @ x, abs=1e-8)


def infeasible(seed: int) -> Conic:
    c, rng = program(seed, **SHAPES["cones of 3 and 4"]), np.random.default_rng(seed)
    y, z = rng.normal(size=len(c.b)), inside(rng, c.orthant, c.soc)
    A = c.A.copy()
    A[0] = -(c.G.T @ z + A[1:].T @ y[1:]) / y[0]
    h = c.h - z * (c.b @ y + c.h @ z + 0.1) / (z @ z)
    return c._replace(A=A, h=h)


def unbounded(seed: int) -> Conic:
    c, rng = program(seed, **SHAPES["cones of 3 and 4"]), np.random.default_rng(seed)
    x = rng.normal(size=len(c.q))
    G = c.G - np.outer(c.G @ x + inside(rng, c.orthant, c.soc), x) / (x @ x)
    A = c.A - np.outer(c.A @ x, x) / (x @ x)
    point = rng.normal(size=len(c.q))
    return c._replace(G=G, A=A, q=c.q - x * (c.q @ x + 0.3) / (x @ x), b=A @ point, h=G @ point + inside(rng, c.orthant, c.soc))


def test_infeasible_programs_end_with_multipliers_that_prove_it():
    for seed in range(20):
        c = infeasible(seed)
        got = solved(c)
        assert got.status == conic.INFEASIBLE
        assert c.b @ got.y + c.h @ got.z == pytest.approx(-1.0, rel=1e-9)
        assert np.abs(c.A.T @ got.y + c.G.T @ got.z).max() <= 2e-9
        assert outside(got.z, c) <= 1e-12
        assert not got.x.any()


def test_unbounded_programs_end_with_a_direction():
    for seed in range(20):
        c = unbounded(seed)
        got = solved(c)
        assert got.status == conic.UNBOUNDED
        assert c.q @ got.x == pytest.approx(-1.0, rel=1e-9)
        assert np.abs(c.A @ got.x).max() <= 2e-9
        assert np.abs(c.G @ got.x + got.s).max() <= 2e-9
        assert outside(got.s, c) <= 1e-12
        assert not got.y.any()


def test_repeated_rows_that_contradict_each_other():
    c = program(0, **SHAPES["repeated rows"])
    b = c.b.copy()
    b[4] += 0.01
    got = solved(c._replace(b=b))
    assert got.status == conic.INFEASIBLE
    assert got.steps == 0
    assert b @ got.y == pytest.approx(-1.0)
    assert np.abs(c.A.T @ got.y).max() <= 1e-10
    assert not got.z.any()


def test_cost_along_unknowns_that_no_cone_sees():
    c = program(0, **SHAPES["free unknowns"])
    A = np.hstack([c.A, 2.0 * c.A[:, -1:]])
    G = np.hstack([c.G, np.zeros((len(c.G), 1))])
    bottomless = c._replace(P=np.append(c.P, 0.0), A=A, G=G, q=np.append(c.q, 2.0 * c.q[-1] + 0.1))
    got = solved(bottomless)
    assert got.status == conic.UNBOUNDED
    assert bottomless.q @ got.x == pytest.approx(-1.0)
    assert np.abs(A @ got.x).max() <= 1e-10
    assert np.abs(G @ got.x).max() <= 1e-10
    level = bottomless._replace(q=np.append(c.q, 2.0 * c.q[-1]))
    assert_optimal(level, solved(level))


def test_one_plan_serves_many_right_hand_sides():
    c, rng = program(3, **SHAPES["free unknowns and repeated rows"]), np.random.default_rng(3)
    plan = prepared(c)
    sizes = [len(part) for part in plan]
    for _ in range(20):
        x, y = rng.normal(size=len(c.q)), rng.normal(size=len(c.b))
        q = -(c.A.T @ y + c.G.T @ inside(rng, c.orthant, c.soc))
        other = c._replace(q=q, b=c.A @ x, h=c.G @ x + inside(rng, c.orthant, c.soc))
        got = solved(other, plan)
        assert_optimal(other, got)
        assert got.objective == solved(other).objective
    assert [len(part) for part in plan] == sizes


def test_the_same_question_has_the_same_bytes():
    for c in (program(5, quadratic=True, **SHAPES["cones of every dimension"]), infeasible(5), unbounded(5)):
        plan = prepared(c)
        first, other, again = solved(c, plan), solved(c._replace(q=-c.q), plan), solved(c, plan)
        fresh = solved(c)
        assert other.x.tobytes() != first.x.tobytes() or first.status != conic.SOLVED
        for v in ("x", "y", "z", "s"):
            assert getattr(first, v).tobytes() == getattr(again, v).tobytes() == getattr(fresh, v).tobytes()


def test_solving_allocates_nothing():
    from numba.core.runtime import _nrt_python, rtsys

    c = program(2, **SHAPES["cones of 3 and 4"])
    plan = prepared(c)
    solved(c, plan)
    _nrt_python.memsys_enable_stats()
    try:
        before = rtsys.get_allocation_stats()
        for _ in range(10):
            solved(c, plan)
        after = rtsys.get_allocation_stats()
    finally:
        _nrt_python.memsys_disable_stats()
    # What is counted are the nine arrays of each call as they are handed over; compiled code takes no memory of its own.
    assert after.alloc - before.alloc == 10 * 9


def test_what_is_not_finished_is_not_an_answer():
    c = program(4, **SHAPES["cones of 3"])
    got = solved(c, limit=2)
    assert got.status == conic.ITERATION_LIMIT
    assert got.steps == 2


def test_the_engine_names_its_failures(monkeypatch):
    asked = questions("equilibrium", "feet", "socp")[""]
    monkeypatch.setattr(conic, "ITERATIONS", 2)
    # What is left after two steps the finishing method still solves to rounding; without it, it is a failure.
    got = engines_for("kernel")[0].compile(asked.model, asked.shape).solve(asked.values)
    assert got.status == "solved" and max(got.residuals) <= TOLERANCE
    monkeypatch.setattr(engine.Session, "finish", lambda self, solution, slack: solution)
    got = engines_for("kernel")[0].compile(asked.model, asked.shape).solve(asked.values)
    assert (got.status, got.detail, got.steps) == ("failed", "iteration limit", 2)


def test_nothing_finite_is_not_an_answer():
    c = program(4, **SHAPES["cones of 3"])
    q = c.q.copy()
    q[0] = np.nan
    assert solved(c._replace(q=q)).status in (conic.ITERATION_LIMIT, conic.STALLED)
