"""Programs taken to rounding from an approximate solution, and the stances of the sweep that needed it."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
from sweeps.checks import check_case
from sweeps.population import Case

from socp_statics.engines.conic_form import Cones, ConicData, cone_violation, cost_gradient
from socp_statics.engines.smoothing_newton import approached, finished, unit_of

CONES = {
    "orthant": Cones(1, 12, (), ()),
    "cones of 3": Cones(2, 0, (3, 3, 3, 3), ()),
    "cones of 3 and 4": Cones(2, 3, (3, 4, 3, 4), ()),
    "no equations": Cones(0, 4, (3, 3), ()),
}


def program(seed: int, cones: Cones, curved: bool) -> tuple[ConicData, np.ndarray, np.ndarray]:
    """A random program with a strictly complementary solution, and that solution."""
    rng = np.random.default_rng([seed, *(len(cones.soc), cones.nonneg)])
    m, n = cones.zero + cones.nonneg + sum(cones.soc), 6
    s, y = np.zeros(m), rng.normal(size=m)
    for i in range(cones.zero, cones.zero + cones.nonneg):
        s[i], y[i] = ((1.0, 0.0), (0.0, 1.0))[int(rng.integers(2))]
    at = cones.zero + cones.nonneg
    for k, d in enumerate(cones.soc):
        tail = rng.normal(size=d - 1)
        edge = np.concatenate([[np.linalg.norm(tail)], tail])
        inside = np.concatenate([[2.0 * edge[0]], tail])
        mirror = edge * np.concatenate([[1.0], -np.ones(d - 1)])
        s[at : at + d], y[at : at + d] = ((inside, 0.0 * edge), (0.0 * edge, inside), (edge, 0.7 * mirror))[k % 3]
        at += d
    A, x = rng.normal(size=(m, n)), rng.normal(size=n)
    P = np.diag(rng.uniform(0.0, 1.0, n)) if curved else np.zeros((n, n))
    return ConicData(sp.csc_array(P), -P @ x - A.T @ y, sp.csc_array(A), A @ x + s), x, y


@pytest.mark.parametrize("curved", [False, True], ids=["linear", "quadratic"])
@pytest.mark.parametrize("kind", CONES)
def test_what_is_nearly_solved_is_solved_to_rounding(kind, curved):
    cones = CONES[kind]
    for seed in range(4):
        data, x, y = program(seed, cones, curved)
        rng = np.random.default_rng(seed)
        near = x + 1e-3 * rng.normal(size=len(x)), y + 1e-3 * rng.normal(size=len(y))
        for unit in (unit_of(*near), 1.0, 30.0):
            found = finished(data, cones, *near, unit)
            assert found is not None
            x1, y1 = found
            assert np.abs(cost_gradient(data, x1, y1)).max() <= 1e-11
            assert cone_violation(data.b - data.A @ x1, cones, dual=False) <= 1e-11
            assert cone_violation(y1, cones, dual=True) <= 1e-11
            curve = float(x1 @ (data.P @ x1))
            assert float(data.q @ x1 + data.b @ y1) + curve == pytest.approx(0.0, abs=1e-9)


def test_what_has_no_solution_is_not_solved():
    cones = Cones(0, 2, (), ())
    contradiction = ConicData(sp.csc_array((1, 1)), np.array([1.0]), sp.csc_array([[1.0], [-1.0]]), np.array([0.0, -1.0]))
    found = finished(contradiction, cones, np.zeros(1), np.ones(2), 1.0)
    # Multipliers without end at best: whoever asks looks at the residuals.
    assert found is None or cone_violation(contradiction.b - contradiction.A @ found[0], cones, dual=False) > 0.1
    data, x, y = program(0, CONES["orthant"], False)
    assert finished(data, CONES["orthant"], np.full_like(x, np.nan), y, 1.0) is None
    wide = ConicData(sp.csc_array((700, 700)), np.zeros(700), sp.csc_array((1, 700)), np.zeros(1))
    assert finished(wide, Cones(0, 1, (), ()), np.zeros(700), np.zeros(1), 1.0) is None


@pytest.mark.parametrize("slope", [1e-10, 1e-9, 1e-3])
def test_an_optimum_far_along_a_valley_is_approached_from_inside_the_set(slope):
    # Forces (t, t, 0) on the edge of a cone can grow along z_0 up to 1e6, which is worth the slope only.
    cones = Cones(1, 1, (3,), ())
    G = np.array([[1.0, -1.0, 0.0], [1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]])
    data = ConicData(sp.csc_array((3, 3)), np.array([-slope, 0.0, 0.0]), sp.csc_array(G), np.array([0.0, 1e6, 0.0, 0.0, 0.0]))
    x, y = np.array([3.0, 3.0 + 1e-7, 1e-8]), np.zeros(5)
    x1, y1 = approached(data, cones, x, y, 1.0)
    assert cone_violation(data.b - data.A @ x1, cones, dual=False) <= 1e-14
    assert cone_violation(y1, cones, dual=True) <= 1e-14
    assert np.abs(cost_gradient(data, x1, y1)).max() <= slope + 1e-14


# Stances of the long sweep that were handed to another engine, or whose answers were too coarse; and why.
SETTLED = {
    "rays of what closes the force": ["grasp:4796", "climbing:1972", "mixed:7995"],
    "walls that nearly close the force": ["chimney:3057", "chimney:10804", "chimney:8825"],
    "slopes within a hair of the friction angle": ["steep:594", "steep:14775"],
    "points nearly on a line, with large multipliers": ["collinear:271", "collinear:8191", "collinear:11671", "collinear:15553"],
    "forces that a rough solution takes for none": ["collinear:13671", "parallel:1969", "parallel:2352", "thin:16278"],
    "large forces": ["duplicates:10712", "duplicates:19364"],
    "small frictions in rows of their own": ["mixed:12341", "mixed:15105"],
    "soft fingers of little torsion": ["mixed:4941"],
    "an optimum far along a valley that hardly falls": ["mixed:8327"],
    "braced by millions of weights": ["chimney:13593"],
    "a Newton step that is not finite": ["leaning:7000884"],
}


@pytest.mark.parametrize("stance", [s for stances in SETTLED.values() for s in stances])
def test_the_kernel_settles_what_the_sweep_found(stance):
    family, seed = stance.split(":")
    out = check_case(Case(family, int(seed)), "auto", batches=False)
    assert out.violations == []
    assert (out.engine, out.handovers, out.region_engine, out.region_handovers) == ("kernel", 0, "kernel", 0)


@pytest.mark.parametrize("seed", [1673, 10825])
def test_clarabel_is_taken_to_rounding_too(seed):
    out = check_case(Case("chimney", seed), "clarabel", batches=False)
    assert out.violations == []
